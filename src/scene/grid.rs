//! A volume as a file has it: numbers on a grid, sparse, and where that lies.

use std::collections::HashMap;

use glam::{DAffine3, DVec3, IVec3};

use super::block::{BLOCK_EDGE, BLOCK_VOXELS, Block, voxel};

/// Most voxels along an axis, of what is not empty.
pub const MOST_ALONG: i32 = 2048;
/// Negative values no larger than this share of the greatest one are what filters leave, and count as none.
const UNDERSHOOT: f32 = 0.01;

/// A field of numbers that are 0 or more, such as density, in blocks of 8^3 voxels; 0 where there is no block.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Its name in the file.
    pub name: String,
    /// What the file says of its values' unit; empty where it says nothing.
    pub quantity: String,
    /// From numbers of voxels (their middles are at whole ones) to the file's own lengths.
    pub place: DAffine3,
    /// Blocks that hold anything.
    pub blocks: Vec<Block>,
    /// Numbers of the first and the last voxel that is not 0.
    pub bounds: (IVec3, IVec3),
    /// The greatest value.
    pub most: f32,
    /// Voxels that are not 0.
    pub count: usize,
    /// Sum of all values.
    pub total: f64,
    /// Negative values that were taken as 0.
    pub clamped: usize,
    /// Of all that is in it and where that lies: files of one name may hold another.
    pub fingerprint: u64,
}

impl Grid {
    /// A grid of `blocks`, no two of which are in one place.
    ///
    /// # Errors
    /// Where there is nothing in it, or what is no density, as the rest of a sentence about the file.
    pub fn new(
        name: String,
        quantity: String,
        place: DAffine3,
        mut blocks: Vec<Block>,
    ) -> Result<Self, String> {
        let values = || blocks.iter().flat_map(|block| block.values.iter());
        let unknown = values().filter(|value| !value.is_finite()).count();
        if unknown > 0 {
            return Err(format!(
                "has {unknown} values in `{name}` that are no numbers (NaN or infinite): export it without them"
            ));
        }
        let (least, most) = values().fold((0.0f32, 0.0f32), |(low, high), &v| (low.min(v), high.max(v)));
        let clamped = values().filter(|value| **value < 0.0).count();
        if -least > UNDERSHOOT * most {
            return Err(format!(
                "has {clamped} negative values in `{name}`, down to {least}: that is no density. Choose another grid, or, \
                 where it holds distances to a surface, convert it to a fog volume first"
            ));
        }
        let inverse = place.inverse();
        if !(place.is_finite() && inverse.is_finite()) || place.matrix3.determinant() == 0.0 {
            return Err(format!("has a transform of `{name}` that makes it flat: export it with another"));
        }
        for value in blocks.iter_mut().flat_map(|block| block.values.iter_mut()) {
            *value = value.max(0.0);
        }
        blocks.retain(|block| block.values.iter().any(|value| *value > 0.0));
        blocks.sort_by_key(|block| block.index.to_array());
        let mut grid = Self {
            name,
            quantity,
            place,
            blocks,
            bounds: (IVec3::ZERO, IVec3::ZERO),
            most,
            count: 0,
            total: 0.0,
            clamped,
            fingerprint: 0,
        };
        grid.fingerprint = grid.fingerprinted();
        let bounds = grid.filled().map(|(at, _)| (at, at)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        grid.bounds = bounds.ok_or_else(|| {
            format!("has nothing above 0 in `{}`: there is nothing to draw; choose another grid", grid.name)
        })?;
        let size = grid.size();
        if size.max_element() > MOST_ALONG {
            return Err(format!(
                "has {} x {} x {} voxels in `{}`, and a volume has at most {MOST_ALONG} along an axis: export it coarser",
                size.x, size.y, size.z, grid.name
            ));
        }
        let sum =
            |(count, total): (usize, f64), (_, value): (IVec3, f32)| (count + 1, total + f64::from(value));
        (grid.count, grid.total) = grid.filled().fold((0, 0.0), sum);
        Ok(grid)
    }

    /// A grid of all voxels of a box from number 0 on, x fastest: where there are `size` of them.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn dense(
        name: String,
        place: DAffine3,
        size: [u32; 3],
        values: impl Iterator<Item = f32>,
    ) -> Result<Self, String> {
        let mut blocks = HashMap::<[i32; 3], Box<[f32; BLOCK_VOXELS]>>::new();
        let [width, height, _] = size.map(|n| n as usize);
        for (i, value) in values.enumerate().filter(|(_, value)| *value != 0.0) {
            let at =
                IVec3::new((i % width) as i32, (i / width % height) as i32, (i / (width * height)) as i32);
            let index = at.map(|i| i.div_euclid(BLOCK_EDGE));
            blocks.entry(index.to_array()).or_insert_with(|| Box::new([0.0; BLOCK_VOXELS]))[voxel(at)] =
                value;
        }
        let blocks = blocks.into_iter().map(|(index, values)| Block { index: index.into(), values });
        Self::new(name, String::new(), place, blocks.collect())
    }

    /// The same without its values: what is told of it.
    #[must_use]
    pub fn outline(&self) -> Self {
        Self { blocks: Vec::new(), name: self.name.clone(), quantity: self.quantity.clone(), ..*self }
    }

    /// Of all its numbers.
    fn fingerprinted(&self) -> u64 {
        let place = self.place.to_cols_array().into_iter().map(f64::to_bits);
        let blocks = self.blocks.iter().flat_map(|block| {
            let index = block.index.to_array().map(|i| u64::from(i.cast_unsigned()));
            index.into_iter().chain(block.values.iter().map(|value| u64::from(value.to_bits())))
        });
        fingerprint(place.chain(blocks))
    }

    /// Voxels along each axis, of what is not empty.
    pub fn size(&self) -> IVec3 {
        let (first, last) = self.bounds;
        last.saturating_sub(first).saturating_add(IVec3::ONE)
    }

    /// Edges of a voxel, in the file's lengths.
    pub fn voxel(&self) -> DVec3 {
        let axes = self.place.matrix3;
        DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length())
    }

    /// Memory of its values, bytes.
    pub fn bytes(&self) -> usize {
        self.blocks.len() * size_of::<[f32; BLOCK_VOXELS]>()
    }

    /// Numbers and values of voxels that are not 0.
    pub fn filled(&self) -> impl Iterator<Item = (IVec3, f32)> {
        self.blocks.iter().flat_map(Block::filled)
    }
}

/// FNV-1a over words.
pub(super) fn fingerprint(words: impl IntoIterator<Item = u64>) -> u64 {
    let step = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    words.into_iter().fold(0xcbf2_9ce4_8422_2325, step)
}
