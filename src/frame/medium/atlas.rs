//! Bricks on a device: an atlas of them, and their index, of one grid or of several.

use glam::{UVec3, Vec3};
use half::f16;
use rayon::prelude::*;

use super::bricks::{Bricks, CORNERS};
use crate::gpu::{self, TextureDesc};

/// The index of the bricks of some grids, one after the other: where that of each begins, and its entries, which number
/// bricks in the atlas of all.
pub(crate) fn index_of(all: &[&Bricks]) -> (Vec<u32>, Vec<u32>) {
    let (mut firsts, mut entries, mut before) = (Vec::new(), Vec::new(), 0);
    for bricks in all {
        firsts.push(entries.len() as u32);
        let own = bricks.index.iter();
        entries.extend(own.map(|&entry| if entry == 0 { 0 } else { entry + before }));
        before += bricks.stored.len() as u32;
    }
    (firsts, entries)
}

/// How many bricks of some grids their common atlas has along each axis.
pub(crate) fn slots_of(all: &[&Bricks]) -> UVec3 {
    slots(all.iter().map(|bricks| bricks.stored.len()).sum())
}

/// The common atlas of the bricks of some grids.
pub(crate) fn atlas(device: &wgpu::Device, queue: &wgpu::Queue, all: &[&Bricks]) -> wgpu::TextureView {
    let stored: Vec<_> = all.iter().flat_map(|of| of.stored.iter().map(move |brick| (*of, *brick))).collect();
    let brick = |i: usize| {
        let (of, (level, at)) = stored[i];
        of.halves(level, at)
    };
    fill_atlas(device, queue, wgpu::TextureFormat::R16Float, stored.len(), brick)
}

/// An atlas of `count` bricks in texels of `format`; `brick` tells those of each by its number, x fastest.
pub(super) fn fill_atlas(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    format: wgpu::TextureFormat,
    count: usize,
    brick: impl Fn(usize) -> Vec<f16> + Sync,
) -> wgpu::TextureView {
    let slots = slots(count);
    let size = slots * CORNERS;
    let channels = u32::from(format.components());
    let (label, usage) = ("volume atlas", wgpu::TextureUsages::empty());
    let desc = TextureDesc { label, size: size.to_array(), mips: 1, format, usage };
    let atlas = gpu::texture(device, &desc);
    let (row, rows) = (slots.x as usize, CORNERS as usize);
    let edge = rows * channels as usize;
    // A row of bricks at a time: what is under way stays small.
    for first in (0..count).step_by(row) {
        let bricks: Vec<_> = (first..count.min(first + row)).into_par_iter().map(&brick).collect();
        let width = row * edge;
        let mut texels = vec![f16::ZERO; width * rows * rows];
        for (i, brick) in bricks.iter().enumerate() {
            for (line, values) in brick.chunks_exact(edge).enumerate() {
                let at = line * width + i * edge;
                texels[at..at + edge].copy_from_slice(values);
            }
        }
        let number = (first / row) as u32;
        let origin =
            wgpu::Origin3d { x: 0, y: CORNERS * (number % slots.y), z: CORNERS * (number / slots.y) };
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..atlas.as_image_copy() },
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(2 * channels * size.x),
                rows_per_image: Some(CORNERS),
            },
            wgpu::Extent3d { width: size.x, height: CORNERS, depth_or_array_layers: CORNERS },
        );
    }
    gpu::view(&atlas)
}

/// A volume on a device.
#[derive(Clone)]
pub(crate) struct VolumeTextures {
    pub atlas: wgpu::TextureView,
    pub index: wgpu::Buffer,
}

/// A texel's share of an atlas of so many bricks along each axis.
pub(crate) fn texel_of(slots: UVec3) -> Vec3 {
    (slots * CORNERS).as_vec3().recip()
}

/// How many bricks an atlas has along each axis, for at least `count`.
pub(super) fn slots(count: usize) -> UVec3 {
    let count = count.max(1) as u32;
    let edge = f64::from(count).cbrt().ceil() as u32;
    UVec3::new(edge, edge, count.div_ceil(edge * edge))
}
