//! The field of a layer: numbers on a square that repeats, made on the CPU from a seed.
//!
//! A Gaussian field with a power spectrum and the distance to the walls of random cells are mixed, and
//! each texel then has its rank: the share of all texels that are lower. So is the part of the square
//! where the field is above 1 - c just c, whatever the mixture. Stretching takes place in the spectrum and
//! in the metric of the cells, so that the square repeats along x and z whichever way it is stretched.

use std::sync::{Arc, Mutex, OnceLock};

use half::f16;
use rayon::prelude::*;

use super::layer_field::mixture;
use crate::{
    frame::Shared,
    gpu,
    scene::{Cover, Layer},
};

/// Texels along an edge.
pub(super) const TEXELS: usize = 1024;
/// Squares along an edge of the finest peaks on a device: `LAYER_SQUARES` of `shaders/medium/layer.wgsl`.
pub(crate) const SQUARES: usize = 64;
/// Tiles that are kept.
const MOST_KNOWN: usize = 8;

/// What a tile is made from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Key {
    pub seed: u32,
    pub stretch: f64,
    pub heading_deg: f64,
    pub cells: f64,
    map: Option<Map>,
}

/// A painted map, and how often heaps repeat themselves along its edge and it along a period.
#[derive(Debug, Clone)]
struct Map {
    cover: Arc<Cover>,
    repeats: [usize; 2],
}

impl PartialEq for Map {
    fn eq(&self, other: &Self) -> bool {
        self.repeats == other.repeats && (Arc::ptr_eq(&self.cover, &other.cover) || self.cover == other.cover)
    }
}

/// A texel: the field from 0 to 1, its slopes along x and z by tile, its deviation within the texel.
type Texel = [f32; 4];

/// The field of a layer.
#[derive(Debug)]
pub(crate) struct Tile {
    key: Key,
    /// By mip, finest first.
    levels: Vec<Vec<Texel>>,
    /// Greatest values of the field in a texel and those around it, by mip.
    peaks: Vec<Vec<f32>>,
    /// Greatest slope, by tile.
    pub steepest: f32,
    /// Values that equal shares of it are below, from the least to the greatest.
    quantiles: Vec<f32>,
}

/// Made from the same, they are the same.
impl PartialEq for Tile {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl Tile {
    /// That of `layer`; the same for all layers that differ in nothing but size, place and coverage.
    pub fn of(layer: &Layer) -> Shared<Self> {
        static KNOWN: OnceLock<Mutex<Vec<Shared<Tile>>>> = OnceLock::new();
        let &Layer { seed, stretch, heading_deg, cells, .. } = layer;
        let map = layer
            .map
            .as_ref()
            .and_then(|map| Some(Map { cover: map.cover()?.clone(), repeats: map.repeats(layer.scale) }));
        let heaps = map.is_some().then(|| Self::of(&Layer { map: None, ..layer.clone() }));
        let key = Key { seed, stretch, heading_deg, cells, map };
        let known = KNOWN.get_or_init(Default::default);
        let mut known = known.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(tile) = known.iter().find(|tile| tile.key == key) {
            return tile.clone();
        }
        let tile = Shared::new(Self::new(key, heaps.as_deref()));
        known.truncate(MOST_KNOWN - 1);
        known.insert(0, tile.clone());
        tile
    }

    /// With a map, of the field of `heaps` without it.
    fn new(key: Key, heaps: Option<&Self>) -> Self {
        let ranks = match (&key.map, heaps) {
            (Some(map), Some(heaps)) => painted(&heaps.levels[0], map),
            _ => ranks(&mixture(&key)),
        };
        let quantiles = quantiles(&ranks);
        let finest: Vec<Texel> = (0..ranks.len()).map(|i| with_slopes(&ranks, i)).collect();
        let steepest = finest.iter().map(|t| t[1].hypot(t[2])).fold(0.0, f32::max);
        let levels: Vec<_> = std::iter::successors(Some(finest), |level| coarser(level)).collect();
        let first = wider(&ranks, TEXELS);
        let peaks = std::iter::successors(Some(first), |level| higher(level)).collect();
        Self { key, levels, peaks, steepest, quantiles }
    }

    /// The greatest value of the field in a square of texels of mip `mip`, which repeat.
    pub fn peak(&self, mip: usize, x: i64, z: i64) -> f32 {
        let mip = mip.min(self.peaks.len() - 1);
        let size = (TEXELS >> mip) as i64;
        self.peaks[mip][(z.rem_euclid(size) * size + x.rem_euclid(size)) as usize]
    }

    /// The value that this share of it is below.
    pub fn quantile(&self, share: f64) -> f64 {
        let place = share.clamp(0.0, 1.0) * (self.quantiles.len() - 1) as f64;
        let first = (place as usize).min(self.quantiles.len() - 2);
        let [low, high] = [0, 1].map(|i| f64::from(self.quantiles[first + i]));
        low + (high - low) * (place - first as f64)
    }

    /// The share of it that is above a value.
    pub fn above(&self, value: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.quantile(middle) > value { high = middle } else { low = middle }
        }
        1.0 - high
    }

    /// Uploads the field with its mips, and its peaks by square.
    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> TileTextures {
        let first = (TEXELS / SQUARES).ilog2() as usize;
        let peaks: Vec<f32> = self.peaks[first..].concat();
        TileTextures {
            field: gpu::view(&fields(device, queue, &[self])),
            peaks: gpu::storage_buffer(device, "layer peaks", &peaks),
        }
    }
}

/// A tile on a device.
#[derive(Clone)]
pub(crate) struct TileTextures {
    pub field: wgpu::TextureView,
    pub peaks: wgpu::Buffer,
}

/// The fields of some tiles with their mips, as layers of a texture.
pub(super) fn fields(device: &wgpu::Device, queue: &wgpu::Queue, tiles: &[&Tile]) -> wgpu::Texture {
    let size = TEXELS as u32;
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("layer field"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: tiles.len() as u32 },
        mip_level_count: size.ilog2() + 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (z, tile) in (0..).zip(tiles) {
        for (mip_level, level) in (0..).zip(&tile.levels) {
            let texels: Vec<_> = level.iter().map(|texel| texel.map(f16::from_f32)).collect();
            let edge = size >> mip_level;
            let origin = wgpu::Origin3d { x: 0, y: 0, z };
            queue.write_texture(
                wgpu::TexelCopyTextureInfo { mip_level, origin, ..texture.as_image_copy() },
                bytemuck::cast_slice(&texels),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(8 * edge),
                    rows_per_image: None,
                },
                wgpu::Extent3d { width: edge, height: edge, depth_or_array_layers: 1 },
            );
        }
    }
    texture
}

/// The share of all values that are below each.
fn ranks(values: &[f64]) -> Vec<f32> {
    let mut order: Vec<u32> = (0..values.len() as u32).collect();
    order.par_sort_unstable_by(|&a, &b| {
        values[a as usize].total_cmp(&values[b as usize]).then_with(|| a.cmp(&b))
    });
    let mut ranks = vec![0.0; values.len()];
    for (place, i) in order.into_iter().enumerate() {
        ranks[i as usize] = ((place as f64 + 0.5) / values.len() as f64) as f32;
    }
    ranks
}

/// A field that is above 1 - c on the share c that is painted. Ranks of heaps are by a power of theirs, so that on the whole
/// just the mean of the map is covered, whatever heaps lie where.
fn painted(heaps: &[Texel], map: &Map) -> Vec<f32> {
    let [along, maps] = map.repeats;
    let cover = map.cover.squares(TEXELS);
    // Its middle is at a corner of the period.
    let place = |x: usize, times: usize, from: usize| (x * times + from) % TEXELS;
    let at = |i: usize, times: usize, from: usize| {
        place(i / TEXELS, times, from) * TEXELS + place(i % TEXELS, times, from)
    };
    let pairs: Vec<(f32, f32)> =
        (0..TEXELS * TEXELS).map(|i| (heaps[at(i, along, 0)][0], cover[at(i, maps, TEXELS / 2)])).collect();
    // A texel is covered where the power is below this.
    let mut powers: Vec<f32> = pairs.iter().map(|(rank, cover)| (1.0 - cover).ln() / rank.ln()).collect();
    let mean = pairs.iter().map(|&(_, cover)| f64::from(cover)).sum::<f64>() / powers.len() as f64;
    let clear = (((1.0 - mean) * powers.len() as f64).round() as usize).min(powers.len() - 1);
    let (lower, &mut most, _) = powers.select_nth_unstable_by(clear, f32::total_cmp);
    let least = lower.iter().copied().fold(0.0, f32::max);
    // As it is, where that will do: where all is white or black.
    let power = 1_f32.max(least).min(most);
    pairs.into_iter().map(|(rank, cover)| rank.powf(power) - (1.0 - cover)).collect()
}

/// Values that equal shares of a field are below.
fn quantiles(values: &[f32]) -> Vec<f32> {
    const PARTS: usize = 256;
    let mut sorted = values.to_vec();
    sorted.par_sort_unstable_by(f32::total_cmp);
    (0..=PARTS).map(|i| sorted[(i * (sorted.len() - 1)) / PARTS]).collect()
}

/// A texel of the finest level.
fn with_slopes(ranks: &[f32], i: usize) -> Texel {
    let (x, z) = (i % TEXELS, i / TEXELS);
    let at = |x: usize, z: usize| ranks[(z % TEXELS) * TEXELS + x % TEXELS];
    let before = TEXELS - 1;
    let by_tile = 0.5 * TEXELS as f32;
    let slopes = [at(x + 1, z) - at(x + before, z), at(x, z + 1) - at(x, z + before)];
    [ranks[i], by_tile * slopes[0], by_tile * slopes[1], 0.0]
}

/// The level after: means of four, and the deviation of what they hold.
fn coarser(level: &[Texel]) -> Option<Vec<Texel>> {
    fours(level, |four| {
        let mean = |of: &dyn Fn(&Texel) -> f32| four.iter().map(|&t| of(t)).sum::<f32>() / 4.0;
        let value = mean(&|t| t[0]);
        let square = mean(&|t| (t[0] - value).powi(2) + t[3] * t[3]);
        [value, mean(&|t| t[1]), mean(&|t| t[2]), square.sqrt()]
    })
}

/// The level after: the highest of four.
fn higher(level: &[f32]) -> Option<Vec<f32>> {
    fours(level, |four| four.iter().fold(0.0, |most: f32, &&value| most.max(value)))
}

fn fours<T>(level: &[T], of: impl Fn([&T; 4]) -> T) -> Option<Vec<T>> {
    let size = (level.len() as f64).sqrt() as usize;
    let half = size / 2;
    let four = |i: usize| {
        let first = 2 * (i / half) * size + 2 * (i % half);
        of([0, 1, size, size + 1].map(|step| &level[first + step]))
    };
    (half > 0).then(|| (0..half * half).map(four).collect())
}

/// The highest value at a texel and around it: no place between the texels' middles has a higher one.
fn wider(values: &[f32], size: usize) -> Vec<f32> {
    let highest = |i: usize| {
        let (x, z) = (i % size, i / size);
        let around = (0..9).map(|k| ((z + size + k / 3 - 1) % size) * size + (x + size + k % 3 - 1) % size);
        around.map(|j| values[j]).fold(0.0, f32::max)
    };
    (0..values.len()).into_par_iter().map(highest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::CoverMap;

    #[test]
    fn the_field_is_above_a_level_on_the_share_that_the_level_leaves() {
        let tile = Tile::of(&Layer::default());
        for coverage in [0.1_f32, 0.5, 0.93] {
            let above = tile.levels[0].iter().filter(|texel| texel[0] > 1.0 - coverage).count();
            let share = above as f32 / (TEXELS * TEXELS) as f32;
            assert!((share - coverage).abs() < 1e-5, "{share} of {coverage}");
        }
    }

    #[test]
    fn a_painted_field_covers_the_mean_of_its_map() {
        // Black, white, a ramp, and a map that is as small as a heap.
        let ramp = (0..64 * 64).map(|i| (i % 64) as f32 / 63.0).collect();
        let halves = (0..4).map(|i| (i % 2) as f32).collect();
        for (width, values, size) in
            [(2, halves, 3e4), (64, ramp, 2e4), (1, vec![0.3], 1e3), (1, vec![1.0], 1e4)]
        {
            let cover = Cover::new(width, values).unwrap();
            let mean = cover.mean();
            let map = CoverMap { size, ..CoverMap::default() }.with_cover(cover);
            let tile = Tile::of(&Layer { coverage: 1.0, map: Some(map), ..Layer::default() });
            let above = tile.levels[0].iter().filter(|texel| texel[0] > 0.0).count();
            let share = above as f64 / (TEXELS * TEXELS) as f64;
            assert!((share - mean).abs() < 1e-3, "{share} of {mean}");
            assert!((tile.above(0.0) - mean).abs() < 5e-3, "{} of {mean}", tile.above(0.0));
        }
    }

    #[test]
    fn coarse_levels_keep_mean_and_deviation() {
        let tile = Tile::of(&Layer::default());
        let [mean, .., deviation] = tile.levels[TEXELS.ilog2() as usize][0];
        assert!((mean - 0.5).abs() < 1e-3, "{mean}");
        assert!((deviation - 1.0 / 12_f32.sqrt()).abs() < 1e-3, "{deviation}");
    }

    #[test]
    fn no_texel_is_above_its_peak() {
        let tile = Tile::of(&Layer::default());
        for (i, texel) in tile.levels[0].iter().enumerate() {
            let (x, z) = ((i % TEXELS) as i64, (i / TEXELS) as i64);
            assert!((0..6).all(|mip| texel[0] <= tile.peak(mip, x >> mip, z >> mip)), "{x} {z}");
        }
    }
}
