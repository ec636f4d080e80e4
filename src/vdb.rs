//! What reading and writing OpenVDB share: numbers of its files and the shape of its trees.
//!
//! A tree of 32^3, 16^3 and 8^3 children; leaves are blocks of 8^3 voxels, x slowest. First comes the topology of
//! the whole tree, then the values of its leaves (`openvdb/io/Archive.cc`, `tree/*Node.h`, `io/Compression.h`).

use glam::IVec3;

/// What files begin with.
pub const MAGIC: u64 = 0x5644_4220;
/// Bits of the compression of a grid: zip, only active values are written, Blosc.
pub const ZIP: u32 = 1;
/// Only active values are written.
pub const ACTIVE_MASK: u32 = 2;
/// Blosc.
#[cfg(feature = "import")]
pub const BLOSC: u32 = 4;
/// How values tell which of them are there: all inactive ones are the background.
pub const ONLY_ACTIVE: u8 = 0;
/// Upper nodes of a tree.
pub const UPPER: Level = Level { children: 5, voxels: 7 };
/// Lower nodes.
pub const LOWER: Level = Level { children: 4, voxels: 3 };
/// Voxels of an upper node along an axis.
#[cfg(feature = "export")]
pub const UPPER_EDGE: i32 = 4096;

/// Inner nodes of one height: base two logarithms of children along each axis, and of voxels along the edge of a
/// child.
#[derive(Debug, Clone, Copy)]
pub struct Level {
    children: u32,
    voxels: u32,
}

impl Level {
    /// Place in a node's array of the child that holds a voxel.
    #[cfg(feature = "export")]
    pub fn place(self, voxel: IVec3) -> usize {
        let mask = (1 << self.children) - 1;
        let [x, y, z] = voxel.to_array().map(|i| (i >> self.voxels & mask) as usize);
        (x << (2 * self.children)) | (y << self.children) | z
    }

    /// First voxel of the child at a place of the array, from that of the node.
    #[cfg(feature = "import")]
    pub fn first(self, place: usize) -> IVec3 {
        let mask = (1 << self.children) - 1;
        let child = [place >> (2 * self.children), place >> self.children, place].map(|i| (i & mask) as i32);
        IVec3::from(child) << self.voxels as i32
    }

    /// Children of a node.
    pub fn count(self) -> usize {
        1 << (3 * self.children)
    }

    /// Voxels along the edge of a child.
    #[cfg(feature = "import")]
    pub fn edge(self) -> i32 {
        1 << self.voxels
    }
}
