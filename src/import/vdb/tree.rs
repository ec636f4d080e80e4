//! The tree of a grid: its nodes, then the values of its leaves.

use std::collections::HashMap;

use glam::IVec3;

use super::super::bytes::{Bytes, Problem};
use super::codec::{NODE_MASKS, Packing, is_on};
use crate::{
    scene::{BLOCK_EDGE, BLOCK_VOXELS, Block},
    vdb::{LOWER, Level, UPPER},
};

/// Bytes of the mask of a leaf.
const LEAF_MASK: usize = BLOCK_VOXELS / 8;
/// Coordinates that are no mistake.
const FARTHEST: i32 = 1 << 28;
/// Most blocks of a grid: 4 GiB of them.
const MOST_BLOCKS: usize = 1 << 21;

/// Blocks by their numbers.
type Blocks = HashMap<[i32; 3], Box<[f32; BLOCK_VOXELS]>>;

/// A tree under way.
pub(super) struct Tree<'a> {
    pub packing: Packing,
    /// First voxels of leaves, in the order of the file.
    leaves: Vec<IVec3>,
    blocks: Blocks,
    bytes: Bytes<'a>,
}

impl<'a> Tree<'a> {
    /// Reads the tree whose numbers are packed so, from behind its transform on; gives what is not 0.
    ///
    /// The background is read into `packing` first.
    pub fn read(bytes: Bytes<'a>, packing: Packing) -> Result<(Vec<Block>, Bytes<'a>), Problem> {
        let mut tree = Self { packing, leaves: Vec::new(), blocks: Blocks::new(), bytes };
        tree.bytes.u32()?; // Buffers.
        tree.packing.background = packing.number.read(&mut tree.bytes)?;
        let background = tree.packing.background;
        if background != 0.0 {
            return Err(format!(
                "has the value {background} wherever it tells no other: that is no fog, but distances to a surface or the \
                 like. Convert it to a fog volume (in Houdini: Convert VDB), or choose another grid"
            ));
        }
        let (tiles, nodes) = (tree.bytes.u32()?, tree.bytes.u32()?);
        for _ in 0..tiles {
            tree.corner()?;
            let value = packing.number.read(&mut tree.bytes)?;
            tree.bytes.byte()?;
            if value != 0.0 {
                return Err(
                    "has the same value over 4096 voxels and more along each axis: export it coarser"
                        .to_owned(),
                );
            }
        }
        for _ in 0..nodes {
            let origin = tree.corner()?;
            tree.inner(UPPER, origin)?;
        }
        for leaf in std::mem::take(&mut tree.leaves) {
            tree.leaf(leaf)?;
        }
        let blocks = tree.blocks.into_iter();
        let block = |(index, values): ([i32; 3], _)| Block { index: index.into(), values };
        Ok((blocks.map(block).collect(), tree.bytes))
    }

    fn corner(&mut self) -> Result<IVec3, Problem> {
        let corner = IVec3::new(self.bytes.i32()?, self.bytes.i32()?, self.bytes.i32()?);
        let near = |i: i32| (-FARTHEST..FARTHEST).contains(&i) && i % BLOCK_EDGE == 0;
        if corner.to_array().into_iter().all(near) {
            return Ok(corner);
        }
        Err(format!(
            "has voxels at {corner}: it is damaged, or lies too far from its origin; export it again"
        ))
    }

    /// Topology of an inner node, with values that fill all of a child.
    fn inner(&mut self, level: Level, origin: IVec3) -> Result<(), Problem> {
        let mask = level.count() / 8;
        let (children, active) = (self.bytes.take(mask)?, self.bytes.take(mask)?);
        let others = || (0..level.count()).filter(|i| !is_on(children, *i));
        let all = self.packing.version >= NODE_MASKS;
        let count = if all { level.count() } else { others().count() };
        let values = self.packing.values(&mut self.bytes, count, active)?;
        for (n, i) in others().enumerate() {
            let value = values.get(if all { i } else { n }).copied().unwrap_or_default();
            if value != 0.0 {
                self.fill(level, origin + level.first(i), value)?;
            }
        }
        for i in (0..level.count()).filter(|i| is_on(children, *i)) {
            let child = origin + level.first(i);
            if level.edge() > BLOCK_EDGE {
                self.inner(LOWER, child)?;
            } else {
                self.bytes.take(LEAF_MASK)?;
                self.leaves.push(child);
            }
        }
        Ok(())
    }

    /// Fills all of a child with a value.
    fn fill(&mut self, level: Level, first: IVec3, value: f32) -> Result<(), Problem> {
        let count = level.edge() / BLOCK_EDGE;
        for i in 0..count.pow(3) {
            let at = IVec3::new(i / (count * count), i / count % count, i % count);
            self.put(first / BLOCK_EDGE + at, Box::new([value; BLOCK_VOXELS]))?;
        }
        Ok(())
    }

    fn put(&mut self, index: IVec3, values: Box<[f32; BLOCK_VOXELS]>) -> Result<(), Problem> {
        if self.blocks.len() >= MOST_BLOCKS {
            return Err(format!(
                "has more than {} million voxels that are not empty: export it coarser",
                MOST_BLOCKS * BLOCK_VOXELS / 1_000_000
            ));
        }
        self.blocks.insert(index.to_array(), values);
        Ok(())
    }

    fn leaf(&mut self, origin: IVec3) -> Result<(), Problem> {
        let active = self.bytes.take(LEAF_MASK)?;
        let mut buffers = 1;
        if self.packing.version < NODE_MASKS {
            self.bytes.take(12)?; // Its origin once more.
            buffers = self.bytes.byte()?;
        }
        let values = self.packing.values(&mut self.bytes, BLOCK_VOXELS, active)?;
        for _ in 1..buffers {
            self.packing.values(&mut self.bytes, BLOCK_VOXELS, active)?;
        }
        if values.iter().any(|value| *value != 0.0) {
            let mut block = Box::new([0.0; BLOCK_VOXELS]);
            block.iter_mut().zip(values).for_each(|(to, from)| *to = from);
            self.put(origin / BLOCK_EDGE, block)?;
        }
        Ok(())
    }
}
