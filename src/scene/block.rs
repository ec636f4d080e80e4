//! Blocks of voxels, of which sparse volumes are made: the leaves of OpenVDB.

use glam::IVec3;

/// Voxels along the edge of a block.
pub const BLOCK_EDGE: i32 = 8;
/// Voxels of a block.
pub const BLOCK_VOXELS: usize = 512;

/// A block of 8 by 8 by 8 voxels.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Number of the block along each axis: its first voxel has [`BLOCK_EDGE`] times that.
    pub index: IVec3,
    /// A number of each voxel, z fastest: mean extinction in 1/m where we made it.
    pub values: Box<[f32; BLOCK_VOXELS]>,
}

impl Block {
    /// Voxels above 0: their numbers and values.
    pub fn filled(&self) -> impl Iterator<Item = (IVec3, f32)> {
        let first = BLOCK_EDGE * self.index;
        let place = move |i: usize| first + IVec3::new(i as i32 >> 6, i as i32 >> 3 & 7, i as i32 & 7);
        let voxels = self.values.iter().enumerate();
        voxels.filter(|(_, value)| **value > 0.0).map(move |(i, value)| (place(i), *value))
    }
}

/// Place of a voxel among the values of its block.
pub(crate) fn voxel(at: IVec3) -> usize {
    let [x, y, z] = at.to_array().map(|i| i.rem_euclid(BLOCK_EDGE) as usize);
    64 * x + 8 * y + z
}
