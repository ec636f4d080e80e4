//! The noise volume: octaves of a power law on a lattice that repeats, made once, on the CPU.
//!
//! Kol reads one octave from each mip level of a volume of white noise, ten reads a
//! sample [K 3.74]. Here pairs of octaves are summed beforehand, so that two reads give eight
//! octaves, and the mip chain is left for what it is good at: leaving out what a pixel
//! cannot show. One volume serves all clouds: a seed moves the place where it is read.

use std::sync::{Arc, OnceLock};

use glam::{DVec3, Vec3};
use half::f16;
use noise::permutationtable::{NoiseHasher, PermutationTable};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{RngCore, SeedableRng},
};
use rayon::prelude::*;

use crate::gpu;

/// Texels along an edge of the volume.
pub const SIZE: u32 = 128;
/// Lattice cells along an edge, for each octave: the volume repeats exactly.
pub(super) const CELLS: [u32; 4] = [4, 8, 16, 32];
/// Surface dimension whose power law holds within a pair of octaves; between pairs it is the scene's.
const DIMENSION: f64 = 2.35;
/// Standard deviation of a channel; what is beyond [-1, 1] is cut.
const DEVIATION: f32 = 0.5;
/// How far wisps are curled, in cells of their first octave.
const CURL: f64 = 0.7;

/// A texel: billows of octaves 1 and 2, of 3 and 4, wisps of all four, nothing yet.
type Texel = [f32; 4];

/// Billows and wisps in [-1, 1], in order x, y, z: each with mean 0.
pub fn bake() -> Vec<Texel> {
    let gain = 2_f64.powf(DIMENSION - 3.0) as f32;
    let billows = [0, 1, 2, 3].map(|octave| normalised(billows(octave)));
    let pair = |a: &[f32], b: &[f32]| told(a.iter().zip(b).map(|(a, b)| a + gain * b).collect());
    let (coarse, fine) = (pair(&billows[0], &billows[1]), pair(&billows[2], &billows[3]));
    let wisps = told(wisps(gain));
    (0..coarse.len()).map(|i| [coarse[i], fine[i], wisps[i], 0.0]).collect()
}

/// With the deviation of a channel.
fn told(values: Vec<f32>) -> Vec<f32> {
    normalised(values).into_iter().map(|value| (DEVIATION * value).clamp(-1.0, 1.0)).collect()
}

/// Rounded heaps with sharp valleys: how near the nearest of random points is, one of which is in each
/// cell of a lattice (Worley 1996).
fn billows(octave: usize) -> Vec<f32> {
    let cells = CELLS[octave];
    let lattice = Points::new(octave as u64, cells);
    // Texels of a cell along x share its neighbours.
    let run = SIZE / cells;
    let mut values = vec![0.0; SIZE.pow(3) as usize];
    values.par_chunks_mut(run as usize).enumerate().for_each(|(i, texels)| {
        let i = i as u32;
        lattice.nearest([i % cells * run, i / cells % SIZE, i / (cells * SIZE)], texels);
        texels.iter_mut().for_each(|square| *square = -*square);
    });
    values
}

/// Random points, one in each cell of a lattice that repeats, and a cell more at either end.
struct Points {
    cells: u32,
    /// Within their cells.
    points: Vec<Vec3>,
    /// What leads from the first of a cell's neighbours to each, and where it is, those beside the cell first.
    around: [(usize, Vec3); 27],
}

impl Points {
    fn new(seed: u64, cells: u32) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut unit = || random.next_u32() as f32 / 2_f32.powi(32);
        let once: Vec<Vec3> = (0..cells.pow(3)).map(|_| Vec3::new(unit(), unit(), unit())).collect();
        let edge = cells + 2;
        let point = |i: u32| {
            let [x, y, z] = [i, i / edge, i / (edge * edge)].map(|i| (i % edge + cells - 1) % cells);
            once[((z * cells + y) * cells + x) as usize]
        };
        let mut around = std::array::from_fn(|i| [i as u32 % 3, i as u32 / 3 % 3, i as u32 / 9]);
        around.sort_by_key(|[x, y, z]| [x, y, z].into_iter().filter(|&&d| d != 1).count());
        let around = around.map(|[x, y, z]| {
            let offset = Vec3::new(x as f32, y as f32, z as f32) - 1.0;
            (((z * edge + y) * edge + x) as usize, offset)
        });
        Self { cells, points: (0..edge.pow(3)).map(point).collect(), around }
    }

    /// Squares of the distances, in cells, of a row of texels of one cell from the points nearest to them.
    fn nearest(&self, texel: [u32; 3], row: &mut [f32]) {
        let (edge, step) = (self.cells + 2, self.cells as f32 / SIZE as f32);
        let cell = texel.map(|x| x * self.cells / SIZE);
        let within = Vec3::from([0, 1, 2].map(|i| (texel[i] as f32 + 0.5) * step - cell[i] as f32));
        let first = ((cell[2] * edge + cell[1]) * edge + cell[0]) as usize;
        let mut farthest = f32::INFINITY;
        row.fill(farthest);
        for (place, offset) in &self.around {
            let p = self.points[first + place] + offset - within;
            let (y, z) = (p.y * p.y, p.z * p.z);
            if y + z >= farthest {
                continue;
            }
            farthest = 0.0;
            for (k, nearest) in row.iter_mut().enumerate() {
                let x = p.x - k as f32 * step;
                let square = x * x + y + z;
                if square < *nearest {
                    *nearest = square;
                }
                if *nearest > farthest {
                    farthest = *nearest;
                }
            }
        }
    }
}

/// Gradient noise (Perlin 1985, 2002) on a lattice that repeats.
struct Gradients {
    cells: i32,
    gradients: Vec<DVec3>,
}

/// Gradients are as long as the root of 2: their noise is at most half the root of 3.
const TO_ONE: f64 = 1.154_700_538_379_251_5;

impl Gradients {
    fn new(seed: u32, cells: u32) -> Self {
        let (table, cells) = (PermutationTable::new(seed), cells as isize);
        let corner = |i: isize| table.hash(&[i % cells, i / cells % cells, i / (cells * cells)]);
        let gradients = (0..cells.pow(3)).map(|i| gradient(corner(i))).collect();
        Self { cells: cells as i32, gradients }
    }

    /// From -1 to 1, at a point in cells.
    fn at(&self, p: DVec3) -> f64 {
        let low = p.floor();
        let within = p - low;
        let both = |x: f64| {
            let low = (x as i32).rem_euclid(self.cells);
            [low, if low + 1 == self.cells { 0 } else { low + 1 }]
        };
        let (x, y, z) = (both(low.x), both(low.y), both(low.z));
        let corner = |i: usize, j: usize, k: usize| {
            let g = &self.gradients[((z[k] * self.cells + y[j]) * self.cells + x[i]) as usize];
            g.x * (within.x - i as f64) + g.y * (within.y - j as f64) + g.z * (within.z - k as f64)
        };
        let (u, v, w) = (smooth(within.x), smooth(within.y), smooth(within.z));
        let edge = |i: usize, j: usize| between(corner(i, j, 0), corner(i, j, 1), w);
        let side = |i: usize| between(edge(i, 0), edge(i, 1), v);
        (between(side(0), side(1), u) * TO_ONE).clamp(-1.0, 1.0)
    }
}

fn between(a: f64, b: f64, share: f64) -> f64 {
    a + share * (b - a)
}

/// From 0 to 1 without slope or bend at either end (Perlin 2002).
fn smooth(x: f64) -> f64 {
    x * x * x * (x * (x * 6.0 - 15.0) + 10.0)
}

/// The gradient of a hash: towards the middle of one of the twelve edges of a cube, four of them twice.
fn gradient(hash: usize) -> DVec3 {
    const EDGES: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 9, 11];
    let edge = EDGES[hash % EDGES.len()];
    let sign = |bit: usize| if edge >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let (a, b) = (sign(0), sign(1));
    match edge >> 2 {
        0 => DVec3::new(a, b, 0.0),
        1 => DVec3::new(a, 0.0, b),
        _ => DVec3::new(0.0, a, b),
    }
}

/// Veils: the sheets on which gradient noise goes through zero, curled by noise of their size.
fn wisps(gain: f32) -> Vec<f32> {
    let curls = [11, 12, 13].map(|seed| Gradients::new(seed, CELLS[0]));
    let octaves: Vec<Gradients> =
        (20..).zip(CELLS).map(|(seed, cells)| Gradients::new(seed, cells)).collect();
    let value = |i: u32| {
        let texel = DVec3::new(f64::from(i % SIZE), f64::from(i / SIZE % SIZE), f64::from(i / (SIZE * SIZE)));
        let place = (texel + 0.5) / f64::from(SIZE);
        let first = f64::from(CELLS[0]) * place;
        let curl = curls.each_ref().map(|curl| curl.at(first));
        let curled = place + CURL / f64::from(CELLS[0]) * DVec3::from(curl);
        let (mut sum, mut amplitude) = (0.0, 1.0);
        for octave in &octaves {
            sum -= amplitude * octave.at(f64::from(octave.cells) * curled).abs() as f32;
            amplitude *= gain;
        }
        sum
    };
    (0..SIZE.pow(3)).into_par_iter().map(value).collect()
}

/// Mean 0, variance 1.
fn normalised(values: Vec<f32>) -> Vec<f32> {
    let count = values.len() as f64;
    let mean = values.iter().map(|&x| f64::from(x)).sum::<f64>() / count;
    let variance = values.iter().map(|&x| (f64::from(x) - mean).powi(2)).sum::<f64>() / count;
    let scale = 1.0 / variance.sqrt().max(1e-12);
    values.into_iter().map(|x| ((f64::from(x) - mean) * scale) as f32).collect()
}

/// Uploads the baked noise with its mip chain, as half floats.
pub(crate) fn upload(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::Texture {
    let texture = gpu::texture(
        device,
        &gpu::TextureDesc {
            label: "noise",
            size: [SIZE; 3],
            mips: SIZE.ilog2() + 1,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::empty(),
        },
    );
    for (mip, texels) in (0..).zip(levels().iter()) {
        write_level(queue, &texture, mip, SIZE >> mip, texels);
    }
    texture
}

/// The noise as textures take it, finest level first.
type Levels = Arc<Vec<Vec<[f16; 4]>>>;

/// The noise with its mip chain, baked once: each renderer, path tracer and voxel grid takes its own copy
/// to the device.
fn levels() -> Levels {
    static KNOWN: OnceLock<Levels> = OnceLock::new();
    let halves = |level: &Vec<Texel>| level.iter().map(|texel| texel.map(f16::from_f32)).collect();
    let coarser = |level: &Vec<Texel>| {
        let size = level.len().ilog2() / 3;
        (size > 0).then(|| halved(level, 1 << (size - 1)))
    };
    KNOWN
        .get_or_init(|| {
            Arc::new(std::iter::successors(Some(bake()), coarser).map(|level| halves(&level)).collect())
        })
        .clone()
}

fn write_level(queue: &wgpu::Queue, texture: &wgpu::Texture, mip: u32, size: u32, texels: &[[f16; 4]]) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: mip,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        bytemuck::cast_slice(texels),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * size), rows_per_image: Some(size) },
        wgpu::Extent3d { width: size, height: size, depth_or_array_layers: size },
    );
}

/// Means of eight texels, for an edge of `size` texels.
fn halved(level: &[Texel], size: u32) -> Vec<Texel> {
    let at = |x: u32, y: u32, z: u32| level[((z * 2 * size + y) * 2 * size + x) as usize];
    let mean = |i: u32| {
        let (x, y, z) = (2 * (i % size), 2 * (i / size % size), 2 * (i / (size * size)));
        let mut sum = [0.0; 4];
        for corner in 0..8 {
            let texel = at(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
            sum.iter_mut().zip(texel).for_each(|(sum, value)| *sum += value);
        }
        sum.map(|sum| sum / 8.0)
    };
    (0..size.pow(3)).into_par_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(values: impl Iterator<Item = f32>) -> f64 {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + f64::from(x), count + 1.0));
        sum / count
    }

    /// The volume, baked once for all of these tests.
    fn baked() -> &'static [Texel] {
        static BAKED: OnceLock<Vec<Texel>> = OnceLock::new();
        BAKED.get_or_init(bake)
    }

    fn variance(level: &[Texel], channel: usize) -> f64 {
        mean(level.iter().map(|texel| texel[channel] * texel[channel]))
    }

    #[test]
    fn each_channel_has_mean_zero_the_set_deviation_and_stays_in_range() {
        for channel in 0..3 {
            let values = || baked().iter().map(|texel| texel[channel]);
            // What is beyond two deviations is cut: of these skewed channels up to 0.04 of the mean.
            assert!(mean(values()).abs() < 0.03, "channel {channel}: mean {}", mean(values()));
            let deviation = variance(baked(), channel).sqrt();
            assert!((deviation - f64::from(DEVIATION)).abs() < 0.04, "channel {channel}: {deviation}");
            assert!(values().all(|x| (-1.0..=1.0).contains(&x)));
        }
        assert!(baked().iter().all(|texel| texel[3] == 0.0));
    }

    #[test]
    fn few_texels_are_cut() {
        for channel in 0..3 {
            let cut = baked().iter().filter(|texel| texel[channel].abs() >= 1.0).count();
            let share = cut as f64 / baked().len() as f64;
            assert!(share < 0.06, "channel {channel}: {share}");
        }
    }

    #[test]
    fn noise_repeats_without_a_seam() {
        // Neighbours across a face differ as neighbours inside do, whichever face.
        let at = |place: [u32; 3]| baked()[((place[2] * SIZE + place[1]) * SIZE + place[0]) as usize];
        let step = |a: u32, b: u32, axis: usize, channel: usize| {
            let squares = (0..SIZE * SIZE).map(|i| {
                let place = |along: u32| {
                    let mut place = [i % SIZE, i / SIZE, along];
                    place.rotate_right((axis + 1) % 3);
                    at(place)[channel]
                };
                (place(a) - place(b)).powi(2)
            });
            mean(squares).sqrt()
        };
        for (axis, channel) in (0..3).flat_map(|axis| (0..3).map(move |channel| (axis, channel))) {
            let inside: f64 = (0..SIZE - 1).step_by(5).map(|x| step(x, x + 1, axis, channel)).sum::<f64>()
                / f64::from((SIZE - 1).div_ceil(5));
            let across = step(SIZE - 1, 0, axis, channel);
            // Faces are walls of the lattice of each octave: where slopes break there.
            assert!(across < 1.5 * inside, "axis {axis}, channel {channel}: {across} for {inside}");
        }
    }

    #[test]
    fn fine_channels_lose_more_by_each_mip_level_than_coarse_ones() {
        let mut level = baked().to_vec();
        let mut before = [1.0; 3];
        for mip in 1..4 {
            level = halved(&level, SIZE >> mip);
            let left = [0, 1, 2].map(|channel| variance(&level, channel) / variance(baked(), channel));
            assert!((0..3).all(|channel| left[channel] < before[channel]), "{mip}: {left:?}");
            // Octaves 1 and 2; all four; 3 and 4.
            assert!(left[0] > left[2] && left[2] > left[1], "{mip}: {left:?}");
            before = left;
        }
        // Eight texels are a quarter of a cell of octave 1, and two cells of octave 4.
        assert!(before[0] > 0.6 && before[1] < 0.1, "{before:?}");
    }

    #[test]
    fn the_volume_is_baked_once_with_all_its_levels() {
        let (one, again) = (levels(), levels());
        assert!(Arc::ptr_eq(&one, &again));
        let sizes: Vec<_> = one.iter().map(Vec::len).collect();
        let wanted: Vec<_> = (0..=SIZE.ilog2()).map(|mip| (SIZE as usize >> mip).pow(3)).collect();
        assert_eq!(sizes, wanted);
    }

    #[test]
    fn baking_gives_the_same_every_time() {
        assert_eq!(bake(), baked());
    }
}
