//! The noise volume: made once per seed, on the CPU, from the gradient and cellular
//! noise of the crate `noise` on a lattice that repeats.
//!
//! Kol reads one octave from each mip level of a volume of white noise, ten reads a
//! sample [K 3.74]. Here three octaves are summed beforehand, so that two reads give six
//! octaves, and the mip chain is left for what it is good at: leaving out what a pixel
//! cannot show.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{DQuat, DVec3, Vec4};
use half::f16;
use noise::{
    Vector3,
    core::{
        perlin::perlin_3d,
        worley::{ReturnType, distance_functions::euclidean_squared, worley_3d},
    },
    permutationtable::{NoiseHasher, PermutationTable},
};
use rayon::prelude::*;

use crate::{gpu, scene};

/// Texels along an edge of the volume.
pub const SIZE: u32 = 64;
/// Lattice cells along an edge, for each octave: the volume repeats exactly.
const CELLS: [u32; 3] = [4, 8, 16];
/// Amplitude of each octave in proportion to the one before.
const GAIN: f32 = 0.5;
/// Standard deviation of the sum of octaves; what is beyond [-1, 1] is cut.
const DEVIATION: f32 = 0.55;

/// `NoiseFrame` of `shaders/lib/noise.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct NoiseFrame {
    pub(crate) coarse_x: Vec4,
    pub(crate) coarse_y: Vec4,
    pub(crate) coarse_z: Vec4,
    pub(crate) fine_x: Vec4,
    pub(crate) fine_y: Vec4,
    pub(crate) fine_z: Vec4,
    pub(crate) fine_weight: f32,
    pub(crate) texels_per_metre: f32,
    pub(crate) frequency: f32,
    pub(crate) padding: f32,
}

/// Ratio of the fine look-up's frequency to the coarse one's [K 3.4.6].
pub(crate) const FINE: f64 = 8.0;

impl NoiseFrame {
    /// The look-up for a cloud whose frame has its origin at `origin` in the world. The
    /// volume's periods are taken out here, in double precision.
    pub fn new(noise: &scene::Noise, origin: DVec3) -> Self {
        let period = noise.scale * f64::from(CELLS[0]);
        // The noise turns one way, the place that is looked up the other.
        let turned = noise.rotation.inverse();
        // The fine octaves are turned against the coarse ones, so that their lattices
        // do not line up, and slide along a diagonal as the noise evolves.
        let apart = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.9);
        let slide = DVec3::new(0.36, 0.8, 0.48) * noise.evolution;
        let coarse = rows(turned, period, origin - noise.offset);
        let fine = rows(apart * turned, period / FINE, origin - noise.offset - slide);
        Self {
            coarse_x: coarse[0],
            coarse_y: coarse[1],
            coarse_z: coarse[2],
            fine_x: fine[0],
            fine_y: fine[1],
            fine_z: fine[2],
            fine_weight: noise.detail as f32,
            texels_per_metre: (f64::from(SIZE) / period) as f32,
            frequency: (1.0 / noise.scale) as f32,
            padding: 0.0,
        }
    }
}

fn rows(turn: DQuat, period: f64, origin: DVec3) -> [Vec4; 3] {
    let start = turn * origin / period;
    [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
        let row = turn.inverse() * axis / period;
        row.extend(start.dot(axis).rem_euclid(1.0)).as_vec4()
    })
}

/// Billows and wisps in [-1, 1], in order x, y, z: mean 0, each octave normalised.
pub fn bake(seed: u32) -> Vec<[f32; 2]> {
    let wisps = sum_octaves(seed, perlin_3d);
    let billows = sum_octaves(seed.wrapping_add(1), |point, hasher| {
        -worley_3d(hasher, euclidean_squared, ReturnType::Distance, point)
    });
    billows.into_iter().zip(wisps).map(|(billow, wisp)| [billow, wisp]).collect()
}

/// The permutation table of the crate, on a lattice that repeats.
struct Periodic {
    table: PermutationTable,
    period: isize,
}

impl NoiseHasher for Periodic {
    fn hash(&self, cell: &[isize]) -> usize {
        let mut wrapped = [0; 3];
        for (wrapped, coordinate) in wrapped.iter_mut().zip(cell) {
            *wrapped = coordinate.rem_euclid(self.period);
        }
        self.table.hash(&wrapped)
    }
}

fn sum_octaves(seed: u32, noise: impl Fn(Vector3<f64>, &Periodic) -> f64 + Sync) -> Vec<f32> {
    let mut sum = vec![0.0; (SIZE * SIZE * SIZE) as usize];
    for (octave, cells) in CELLS.into_iter().enumerate() {
        let table = PermutationTable::new(seed.wrapping_mul(31).wrapping_add(octave as u32));
        let hasher = Periodic { table, period: cells as isize };
        let amplitude = GAIN.powi(octave as i32);
        let values = normalised(octave_values(cells, |point| noise(point, &hasher)));
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += amplitude * value);
    }
    normalised(sum).into_iter().map(|value| (DEVIATION * value).clamp(-1.0, 1.0)).collect()
}

fn octave_values(cells: u32, noise: impl Fn(Vector3<f64>) -> f64 + Sync) -> Vec<f32> {
    let step = f64::from(cells) / f64::from(SIZE);
    (0..SIZE * SIZE * SIZE)
        .into_par_iter()
        .map(|i| {
            let texel = [i % SIZE, i / SIZE % SIZE, i / (SIZE * SIZE)];
            noise(Vector3::from(texel.map(|x| (f64::from(x) + 0.5) * step))) as f32
        })
        .collect()
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
pub(crate) fn upload(device: &wgpu::Device, queue: &wgpu::Queue, seed: u32) -> wgpu::Texture {
    let texture = gpu::texture(
        device,
        &gpu::TextureDesc {
            label: "noise",
            size: [SIZE; 3],
            mips: SIZE.ilog2() + 1,
            format: wgpu::TextureFormat::Rg16Float,
            usage: wgpu::TextureUsages::empty(),
        },
    );
    for (mip, texels) in (0..).zip(levels(seed).iter()) {
        write_level(queue, &texture, mip, SIZE >> mip, texels);
    }
    texture
}

/// The noise as textures take it, finest level first.
type Levels = Arc<Vec<Vec<[f16; 2]>>>;

/// Noise of the seeds asked for lately: each renderer, path tracer and voxel grid takes its own copy
/// to the device.
static KNOWN: Mutex<Vec<(u32, Levels)>> = Mutex::new(Vec::new());
const MOST_KNOWN: usize = 4;

/// The noise of a seed with its mip chain, baked once for as long as it is known.
fn levels(seed: u32) -> Levels {
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, levels)) = known.iter().find(|(other, _)| *other == seed) {
        return levels.clone();
    }
    let halves = |level: &Vec<[f32; 2]>| level.iter().map(|texel| texel.map(f16::from_f32)).collect();
    let coarser = |level: &Vec<[f32; 2]>| {
        let size = level.len().ilog2() / 3;
        (size > 0).then(|| halved(level, 1 << (size - 1)))
    };
    let levels: Levels =
        Arc::new(std::iter::successors(Some(bake(seed)), coarser).map(|level| halves(&level)).collect());
    known.truncate(MOST_KNOWN - 1);
    known.insert(0, (seed, levels.clone()));
    levels
}

fn write_level(queue: &wgpu::Queue, texture: &wgpu::Texture, mip: u32, size: u32, texels: &[[f16; 2]]) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: mip,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        bytemuck::cast_slice(texels),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size), rows_per_image: Some(size) },
        wgpu::Extent3d { width: size, height: size, depth_or_array_layers: size },
    );
}

/// Means of eight texels, for an edge of `size` texels.
fn halved(level: &[[f32; 2]], size: u32) -> Vec<[f32; 2]> {
    let at = |x: u32, y: u32, z: u32| level[((z * 2 * size + y) * 2 * size + x) as usize];
    let mean = |i: u32| {
        let (x, y, z) = (2 * (i % size), 2 * (i / size % size), 2 * (i / (size * size)));
        let mut sum = [0.0; 2];
        for corner in 0..8 {
            let texel = at(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
            sum = [sum[0] + texel[0], sum[1] + texel[1]];
        }
        sum.map(|sum| sum / 8.0)
    };
    (0..size * size * size).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(values: impl Iterator<Item = f32>) -> f64 {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + f64::from(x), count + 1.0));
        sum / count
    }

    #[test]
    fn noise_has_mean_zero_the_set_deviation_and_stays_in_range() {
        let noise = bake(3);
        for channel in 0..2 {
            let values = || noise.iter().map(|texel| texel[channel]);
            assert!(mean(values()).abs() < 0.03, "clipping may shift the mean a little");
            let deviation = mean(values().map(|x| x * x)).sqrt();
            assert!((deviation - f64::from(DEVIATION)).abs() < 0.04, "{deviation}");
            assert!(values().all(|x| (-1.0..=1.0).contains(&x)));
        }
    }

    #[test]
    fn noise_turns_about_its_offset_the_way_a_cloud_turns() {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.7);
        let still = scene::Noise { offset: DVec3::new(40.0, -7.0, 90.0), ..scene::Noise::default() };
        let turned = scene::Noise { rotation: turn, ..still.clone() };
        let looked_up = |noise: &scene::Noise, p: DVec3| {
            let frame = NoiseFrame::new(noise, DVec3::ZERO);
            let rows = [frame.coarse_x, frame.coarse_y, frame.coarse_z];
            rows.map(|row| row.dot(p.as_vec3().extend(1.0)).rem_euclid(1.0))
        };
        let p = DVec3::new(100.0, 30.0, -20.0);
        let carried = still.offset + turn * (p - still.offset);
        for (a, b) in looked_up(&still, p).into_iter().zip(looked_up(&turned, carried)) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }

    #[test]
    fn noise_repeats_without_a_seam() {
        // Neighbours across the edge differ as neighbours inside do.
        let noise = bake(3);
        let at = |x: u32, y: u32, z: u32| noise[((z * SIZE + y) * SIZE + x) as usize];
        let step = |a: u32, b: u32, channel: usize| {
            let squares = (0..SIZE * SIZE).map(|i| {
                let (y, z) = (i % SIZE, i / SIZE);
                (at(a, y, z)[channel] - at(b, y, z)[channel]).powi(2)
            });
            mean(squares).sqrt()
        };
        for channel in 0..2 {
            let inside: f64 =
                (0..SIZE - 1).map(|x| step(x, x + 1, channel)).sum::<f64>() / f64::from(SIZE - 1);
            let across = step(SIZE - 1, 0, channel);
            assert!(across < 1.5 * inside, "channel {channel}: {across} across the seam, {inside} inside");
        }
    }

    #[test]
    fn each_octave_halves_in_amplitude() {
        // What a mip level takes away lies between its octaves: variance falls with each.
        let mut level = bake(3);
        let mut size = SIZE;
        let variance = |level: &[[f32; 2]]| mean(level.iter().map(|texel| texel[1] * texel[1]));
        let whole = variance(&level);
        for expected in [1.0, 0.93, 0.75] {
            let share = variance(&level) / whole;
            assert!((share - expected).abs() < 0.15, "{share} for {expected} at {size}");
            size /= 2;
            level = halved(&level, size);
        }
    }

    #[test]
    fn noise_of_a_seed_is_baked_once_with_all_its_levels() {
        let (one, again, other) = (levels(91), levels(91), levels(92));
        assert!(Arc::ptr_eq(&one, &again) && one != other);
        let sizes: Vec<_> = one.iter().map(|level| level.len().ilog2() / 3).collect();
        assert_eq!(sizes, [6, 5, 4, 3, 2, 1, 0]);
    }

    #[test]
    fn seeds_differ_and_repeat() {
        assert_eq!(bake(5), bake(5));
        assert_ne!(bake(5), bake(6));
    }

    #[test]
    fn lookup_far_from_the_origin_keeps_its_precision() {
        let noise = scene::Noise { scale: 100.0, ..Default::default() };
        let period = noise.scale * f64::from(CELLS[0]);
        let near = NoiseFrame::new(&noise, DVec3::new(10.0, 20.0, 30.0));
        let far = NoiseFrame::new(&noise, DVec3::new(10.0 + 1e4 * period, 20.0, 30.0 - 1e4 * period));
        assert!((near.coarse_x.w - far.coarse_x.w).abs() < 1e-5);
        assert!((near.coarse_z.w - far.coarse_z.w).abs() < 1e-5);
    }
}
