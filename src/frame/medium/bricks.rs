//! Bricks of a grid, finer and coarser ones.
//!
//! The grid is cut into bricks of [`CELLS`] cells, of which those are stored that hold anything, at the corners of
//! their cells, as shares of the greatest value. Each coarser level has half as many points along each axis; a point
//! weighs 1/4, 1/2 and 1/4 of its neighbours along each, so that all levels hold the same matter. The index tells each
//! brick's greatest value.

use std::{
    collections::{HashMap, HashSet},
    sync::{Arc, Mutex, OnceLock, PoisonError, Weak},
};

use glam::{IVec3, UVec3, Vec3};
use half::f16;
use rayon::prelude::*;

use super::atlas::{VolumeTextures, fill_atlas, slots, texel_of};
use crate::{
    frame::Shared,
    gpu,
    scene::{Grid, Volume, voxel},
};

/// Cells along the edge of a brick, its corners, and levels: `shaders/lib/volume.wgsl`.
pub(crate) const CELLS: u32 = 8;
pub(super) const CORNERS: u32 = CELLS + 1;
pub(crate) const LEVELS: usize = 8;
/// Texels of a brick.
const TEXELS: usize = (CORNERS * CORNERS * CORNERS) as usize;
/// Most bricks of an atlas, which the index can number and a texture holds: 730 MiB of them.
const MOST_BRICKS: usize = 1 << 19;
/// Most entries of an index: 128 MiB of them.
const MOST_ENTRIES: u32 = 1 << 25;

/// Points of a level, in blocks of 8^3, z fastest, from its first brick on.
pub(super) type Blocks = HashMap<[i32; 3], Box<[f32; 512]>>;

/// A level of bricks.
#[derive(Debug)]
struct Level {
    size: UVec3,
    /// Where its bricks begin in the index.
    first: u32,
    blocks: Blocks,
}

/// The bricks of a grid.
#[derive(Debug)]
pub(crate) struct Bricks {
    grid: Weak<Grid>,
    /// Number of the voxel at the least corner of the first brick.
    base: IVec3,
    levels: Vec<Level>,
    pub(super) index: Vec<u32>,
    /// Level and place of each brick.
    pub(super) stored: Vec<(u32, IVec3)>,
    /// The greatest value.
    pub(super) most: f32,
}

impl PartialEq for Bricks {
    fn eq(&self, other: &Self) -> bool {
        self.grid.ptr_eq(&other.grid)
    }
}

impl Bricks {
    /// Those of `grid`; the same for all volumes that have it.
    ///
    /// # Errors
    /// The rest of a sentence about the volume, where there are too many.
    pub fn of(grid: &Arc<Grid>) -> Result<Shared<Self>, String> {
        static KNOWN: OnceLock<Mutex<Vec<Shared<Bricks>>>> = OnceLock::new();
        let known = KNOWN.get_or_init(Default::default);
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        // Of grids that nobody has any more nothing is kept.
        known.retain(|bricks| bricks.grid.strong_count() > 0);
        let own = Arc::downgrade(grid);
        if let Some(bricks) = known.iter().find(|bricks| bricks.grid.ptr_eq(&own)) {
            return Ok(bricks.clone());
        }
        let bricks = Shared::new(Self::new(grid)?);
        known.push(bricks.clone());
        Ok(bricks)
    }

    /// Those of `grid`, for whoever keeps them.
    pub(super) fn new(grid: &Arc<Grid>) -> Result<Self, String> {
        let first = Volume::reach(grid).0.map(|i| i.div_euclid(CELLS as i32));
        let blocks: Blocks = grid
            .blocks
            .iter()
            .map(|block| ((block.index - first).to_array(), block.values.clone()))
            .collect();
        let mut bricks = Self {
            grid: Arc::downgrade(grid),
            base: CELLS as i32 * first,
            levels: Vec::new(),
            index: Vec::new(),
            stored: Vec::new(),
            most: grid.most,
        };
        let mut blocks = Some(blocks);
        while let Some(own) = blocks.take() {
            let size = bricks.push(&own)?;
            let is_last = bricks.levels.len() + 1 == LEVELS || size.max_element() <= 1;
            blocks = (!is_last).then(|| coarser(&own));
            let first = bricks.index.len() as u32 - size.element_product();
            bricks.levels.push(Level { size, first, blocks: own });
        }
        Ok(bricks)
    }

    /// Adds the bricks of a level to index and list; tells how many there are along each axis.
    fn push(&mut self, blocks: &Blocks) -> Result<UVec3, String> {
        let last = blocks.keys().fold(IVec3::ZERO, |most, at| most.max(IVec3::from(*at)));
        let size = (last + 1).as_uvec3();
        // A brick has the first points of its neighbours, too.
        let touched = |at: &[i32; 3]| {
            let at = IVec3::from(*at);
            (0..8).map(move |i| (at - IVec3::new(i & 1, i >> 1 & 1, i >> 2)).to_array())
        };
        let touched: HashSet<[i32; 3]> = blocks.keys().flat_map(touched).collect();
        let mut touched: Vec<IVec3> =
            touched.into_iter().map(IVec3::from).filter(|at| at.cmpge(IVec3::ZERO).all()).collect();
        touched.sort_by_key(|at| [at.z, at.y, at.x]);
        let most: Vec<f32> =
            touched.par_iter().map(|at| texels(blocks, *at).into_iter().fold(0.0, f32::max)).collect();
        let begin = self.index.len();
        let entries = u64::from(size.x) * u64::from(size.y) * u64::from(size.z) + begin as u64;
        if entries > MOST_ENTRIES.into() {
            return Err(format!(
                "is {} x {} x {} bricks of 8 voxels large, more than a picture's index holds: export it coarser",
                size.x, size.y, size.z
            ));
        }
        self.index.resize(entries as usize, 0);
        for (at, most) in touched.into_iter().zip(most).filter(|(_, most)| *most > 0.0) {
            if self.stored.len() == MOST_BRICKS {
                return Err(format!(
                    "has more than {MOST_BRICKS} bricks of 8 voxels that are not empty, more than a picture holds: export \
                     it coarser"
                ));
            }
            let place = at.as_uvec3();
            let share = (255.0 * most / self.most).ceil().clamp(1.0, 255.0) as u32;
            let entry = begin + ((place.z * size.y + place.y) * size.x + place.x) as usize;
            self.index[entry] = share << 24 | self.stored.len() as u32;
            self.stored.push((self.levels.len() as u32, at));
        }
        Ok(size)
    }

    /// The greatest value between two places among the bricks, as a share of the greatest of all; no less than that.
    pub fn most_between(&self, low: Vec3, high: Vec3) -> f32 {
        let Some(level) = self.levels.first() else { return 0.0 };
        let last = level.size.as_ivec3() - 1;
        let low = low.floor().as_ivec3().max(IVec3::ZERO);
        let high = high.floor().as_ivec3().min(last);
        let mut most = 0;
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let place = IVec3::new(x, y, z).as_uvec3();
                    let entry = level.first + (place.z * level.size.y + place.y) * level.size.x + place.x;
                    most = most.max(self.index[entry as usize] >> 24);
                }
            }
        }
        most as f32 / 255.0
    }

    /// The points of the finest level.
    pub(super) fn finest(&self) -> Blocks {
        self.levels.first().map(|level| level.blocks.clone()).unwrap_or_default()
    }

    /// Number of the voxel at the least corner of the first brick.
    pub fn base(&self) -> IVec3 {
        self.base
    }

    /// How many levels there are, the finest included.
    pub fn levels(&self) -> u32 {
        self.levels.len() as u32
    }

    /// Bricks of the atlas along each axis.
    pub fn slots(&self) -> UVec3 {
        slots(self.stored.len())
    }

    /// A texel's share of the atlas along each axis.
    pub fn texel(&self) -> Vec3 {
        texel_of(self.slots())
    }

    /// Size and place in the index of each level.
    pub fn table(&self) -> [[u32; 4]; LEVELS] {
        let row = |level: &Level| [level.size.x, level.size.y, level.size.z, level.first];
        std::array::from_fn(|i| self.levels.get(i).map(row).unwrap_or_default())
    }

    /// Memory of atlas and index on a device, bytes.
    pub fn bytes(&self) -> u64 {
        let texels = u64::from((self.slots() * CORNERS).element_product());
        2 * texels + 4 * self.index.len() as u64
    }

    /// Uploads atlas and index.
    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> VolumeTextures {
        self.upload_as(device, queue, wgpu::TextureFormat::R16Float, |level, at| self.halves(level, at))
    }

    /// Uploads atlas and index, where `brick` tells the texels of a brick of a level, x fastest.
    pub(super) fn upload_as(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        brick: impl Fn(u32, IVec3) -> Vec<f16> + Sync,
    ) -> VolumeTextures {
        let numbered = |i: usize| brick(self.stored[i].0, self.stored[i].1);
        VolumeTextures {
            atlas: fill_atlas(device, queue, format, self.stored.len(), numbered),
            index: gpu::storage_buffer(device, "volume index", &self.index),
        }
    }

    /// The texels of a brick as shares of the greatest value, x fastest.
    pub(super) fn halves(&self, level: u32, at: IVec3) -> Vec<f16> {
        let scale = 1.0 / self.most;
        texels(&self.levels[level as usize].blocks, at)
            .into_iter()
            .map(|v| f16::from_f32(scale * v))
            .collect()
    }
}

/// The corners of the cells of a brick, x fastest.
pub(super) fn texels(blocks: &Blocks, brick: IVec3) -> [f32; TEXELS] {
    let edge = CELLS as i32;
    let near: [_; 8] = std::array::from_fn(|i| {
        let i = i as i32;
        blocks.get(&(brick + IVec3::new(i & 1, i >> 1 & 1, i >> 2)).to_array())
    });
    let mut texels = [0.0; TEXELS];
    for (i, texel) in texels.iter_mut().enumerate() {
        let i = i as i32;
        let corners = CORNERS as i32;
        let at = IVec3::new(i % corners, i / corners % corners, i / (corners * corners));
        let beyond = at / edge;
        let block = near[(beyond.x + 2 * beyond.y + 4 * beyond.z) as usize];
        *texel = block.map_or(0.0, |block| block[voxel(at)]);
    }
    texels
}

/// The level after: each point is what it and its neighbours are, by 1/4, 1/2 and 1/4 along each axis.
fn coarser(blocks: &Blocks) -> Blocks {
    let edge = CELLS as i32;
    // Points at the walls of a block reach into the next one.
    let around = |at: &[i32; 3]| {
        let at = IVec3::from(*at);
        (0..8).map(move |i| {
            let step = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            ((at + step).map(|i| i.div_euclid(2))).to_array()
        })
    };
    let wanted: HashSet<[i32; 3]> = blocks.keys().flat_map(around).collect();
    let value = |p: IVec3| {
        let block = blocks.get(&p.map(|i| i.div_euclid(edge)).to_array());
        block.map_or(0.0, |block| block[voxel(p)])
    };
    let made = wanted.into_par_iter().filter_map(|index| {
        let first = edge * IVec3::from(index);
        let mut own = Box::new([0.0; 512]);
        for (i, to) in own.iter_mut().enumerate() {
            let at = first + IVec3::new(i as i32 >> 6, i as i32 >> 3 & 7, i as i32 & 7);
            for k in 0..27 {
                let step = IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                let weight = 0.125 * 0.5_f32.powi(step.abs().element_sum());
                *to += weight * value(2 * at + step);
            }
        }
        own.iter().any(|value| *value > 0.0).then_some((index, own))
    });
    made.collect()
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::*;

    /// A grid of some blobs and loose voxels.
    fn grid() -> Arc<Grid> {
        let size = [40, 23, 31];
        let value = |i: u32| {
            let at = [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])].map(f64::from);
            let p = DVec3::from(at);
            let blob = (1.0 - p.distance(DVec3::new(12.0, 9.0, 20.0)) / 9.0).max(0.0);
            (blob + if i.is_multiple_of(911) { 0.5 } else { 0.0 }) as f32
        };
        let values = (0..size.iter().product()).map(value);
        Arc::new(Grid::dense("density".to_owned(), DAffine3::IDENTITY, size, values).unwrap())
    }

    #[test]
    fn every_level_holds_the_same_matter() {
        let bricks = Bricks::of(&grid()).unwrap();
        assert!(bricks.levels.len() >= 3);
        let sum =
            |level: &Level| level.blocks.values().flat_map(|b| b.iter()).map(|v| f64::from(*v)).sum::<f64>();
        let whole = sum(&bricks.levels[0]);
        for (i, level) in bricks.levels.iter().enumerate() {
            // Where a level begins it has no point before its first.
            let share = sum(level) * 8_f64.powi(i as i32) / whole;
            assert!((share - 1.0).abs() < 0.01, "{i}: {share}");
        }
    }

    #[test]
    fn no_point_of_a_brick_is_above_what_the_index_tells_and_all_points_are_stored() {
        let grid = grid();
        let bricks = Bricks::of(&grid).unwrap();
        let mut found = 0;
        let table = bricks.table();
        for (at, value) in grid.filled() {
            let place = at - bricks.base;
            let brick = (place / CELLS as i32).as_uvec3();
            let [x, y, _, first] = table[0];
            let entry = bricks.index[(first + (brick.z * y + brick.y) * x + brick.x) as usize];
            assert!(entry != 0 && (entry >> 24) as f32 / 255.0 * grid.most >= value);
            let (level, own) = bricks.stored[(entry & 0xff_ffff) as usize];
            assert_eq!((level, own), (0, brick.as_ivec3()));
            let inside = place - CELLS as i32 * own;
            let texel = (inside.z * 9 + inside.y) * 9 + inside.x;
            let stored = bricks.halves(level, own)[texel as usize].to_f32() * grid.most;
            assert!((stored - value).abs() <= 6e-4 * value.max(1e-3), "{at}: {stored} for {value}");
            found += 1;
        }
        assert_eq!(found, grid.count);
    }
}
