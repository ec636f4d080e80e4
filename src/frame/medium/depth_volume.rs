//! A cloud's depth below its boundary, baked into a sparse volume when its shape changes, so that a
//! sample asks one texel instead of each ellipsoid. Of meshes it is all there is: `mesh` bakes it.
//!
//! Space around the cloud is cut into bricks of [`CELLS`] cells. Bricks that no ellipsoid reaches into are
//! empty, and tell how far other bricks are, so that rays jump; bricks within the core of the densest
//! ellipsoid are homogeneous; the others are stored at the corners of their cells, in an atlas. Where
//! lumps meet, depth is interpolated over one cell.

use std::ops::RangeInclusive;

use glam::{UVec3, Vec3};

use super::{BodyUniform, EllipsoidUniform};
use crate::gpu::{self, ComputeProgram, Role, TextureDesc};

/// The module that fills the role of the medium.
pub(crate) const DEPTH_VOLUME: Role<'static> =
    ("medium", include_str!("../../../shaders/medium/depth_volume.wgsl"));

/// Cells along the edge of a brick, and its corners: `shaders/lib/depth_volume.wgsl`.
pub(crate) const CELLS: u32 = 8;
const CORNERS: u32 = CELLS + 1;
/// Most bricks of an atlas: 24 MiB of it.
pub(super) const MOST_STORED: usize = 4096;
/// Most bricks along an axis.
pub(super) const LONGEST: u32 = 96;
/// A cell's edge as a share of the smallest radius of most lumps (the lower quartile), at best and at worst.
const FINEST: f32 = 1.0 / 6.0;
const COARSEST: f32 = 0.5;
/// Most entries of the lists of all bricks: 16 MiB.
const MOST_ENTRIES: f32 = (1 << 22) as f32;
/// From one size of bricks to the next larger one that is tried.
const COARSER: f32 = 1.2;
/// Kinds of bricks, in the two highest bits of an entry.
pub(super) const CORE: u32 = 1 << 30;
pub(super) const STORED: u32 = 2 << 30;
/// Farthest that an empty brick tells others to be.
const FARTHEST: u32 = 8;

/// `DepthVolume` of `shaders/lib/depth_volume.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct DepthVolumeUniform {
    pub(crate) low: Vec3,
    pub(crate) brick: f32,
    pub(crate) size: UVec3,
    pub(crate) core: f32,
    pub(crate) texel: Vec3,
    pub(crate) boundary: f32,
    pub(crate) slots: [u32; 2],
    pub(crate) power: f32,
    pub(crate) reach: f32,
}

/// `Brick` of `shaders/depth_bake.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BrickUniform {
    pub(crate) place: UVec3,
    pub(crate) first: u32,
    pub(crate) count: u32,
    padding: [u32; 3],
}

/// What is to be baked.
pub(crate) struct Plan {
    /// Least corner, and edge of a brick, m.
    low: Vec3,
    brick: f32,
    /// Bricks along each axis.
    size: UVec3,
    /// By brick, x fastest.
    index: Vec<u32>,
    stored: Vec<BrickUniform>,
    candidates: Vec<u32>,
}

/// A baked volume on the device.
pub(crate) struct DepthVolume {
    /// But for the extinction of what is homogeneous, which is that of one medium of the shape.
    pub uniform: DepthVolumeUniform,
    pub index: wgpu::Buffer,
    pub atlas: wgpu::TextureView,
}

impl DepthVolume {
    /// Records the baking of `ellipsoids` by their plan.
    pub fn bake(
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        program: &ComputeProgram,
        (ellipsoids, body): (&[EllipsoidUniform], &BodyUniform),
        plan: &Plan,
    ) -> Self {
        let slots = slots(plan.stored.len());
        let size = (slots * CORNERS).to_array();
        let uniform = DepthVolumeUniform {
            low: plan.low,
            brick: plan.brick,
            size: plan.size,
            core: densest(ellipsoids),
            texel: UVec3::from(size).as_vec3().recip(),
            // Depths are told no finer than a cell.
            boundary: usual_boundary(ellipsoids).max(plan.brick / CELLS as f32),
            slots: [slots.x, slots.y],
            power: body.power,
            reach: body.reach,
        };
        let buffer = gpu::uniform_buffer(device, "depth volume", &uniform);
        let format = wgpu::TextureFormat::Rgba16Float;
        let usage = wgpu::TextureUsages::STORAGE_BINDING;
        let atlas = gpu::view(&gpu::texture(
            device,
            &TextureDesc { label: "depth atlas", size, mips: 1, format, usage },
        ));
        let buffers = [
            gpu::storage_buffer(device, "bricks", &plan.stored),
            gpu::storage_buffer(device, "ellipsoids of bricks", &plan.candidates),
            gpu::storage_buffer(device, "ellipsoids", ellipsoids),
        ];
        let mut resources = vec![Some(buffer.as_entire_binding())];
        resources.extend(buffers.iter().map(|buffer| Some(buffer.as_entire_binding())));
        resources.push(Some(wgpu::BindingResource::TextureView(&atlas)));
        let group = program.bind(device, &resources);
        let groups = (plan.stored.len() as u32 * CORNERS.pow(3)).div_ceil(64);
        let rows = groups.div_ceil(MOST_GROUPS).max(1);
        program.dispatch(encoder, &[&group], [groups.div_ceil(rows), rows, 1], None);
        Self { uniform, index: gpu::storage_buffer(device, "depth index", &plan.index), atlas }
    }

    /// Memory of its atlas and index, bytes.
    pub fn bytes(&self) -> u64 {
        let texels = |view: &wgpu::TextureView| {
            let size = view.texture().size();
            u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers)
        };
        8 * texels(&self.atlas) + self.index.size()
    }
}

/// Workgroups that one row of a dispatch may have.
const MOST_GROUPS: u32 = 65535;

fn densest(ellipsoids: &[EllipsoidUniform]) -> f32 {
    ellipsoids.iter().fold(0.0, |most, e| e.extinction.max(most))
}

/// Thickness of the boundary that steps go by, m: of all ellipsoids' the lower quartile, none thicker
/// than its ellipsoid is wide.
fn usual_boundary(ellipsoids: &[EllipsoidUniform]) -> f32 {
    let mut all: Vec<f32> = ellipsoids.iter().map(|e| e.boundary.min(2.0 * e.smallest_radius())).collect();
    let place = all.len() / 4;
    if all.is_empty() { 1.0 } else { *all.select_nth_unstable_by(place, f32::total_cmp).1 }
}

/// How many bricks an atlas has along each axis, for at least `count`.
fn slots(count: usize) -> UVec3 {
    let edge = (count.max(1) as f64).cbrt().ceil() as u32;
    UVec3::new(edge, edge, (count.max(1) as u32).div_ceil(edge * edge))
}

impl Plan {
    /// The finest bricks of which an atlas holds all that must be stored, of a cloud that ends below the height
    /// `level`, m; none where their cells would be too coarse to tell most lumps.
    pub fn new(ellipsoids: &[EllipsoidUniform], level: f32) -> Option<Self> {
        let (mut low, high) = EllipsoidUniform::bounds(ellipsoids);
        low.y = low.y.max(level.min(high.y));
        let extent = (high - low).max(Vec3::splat(1e-3));
        let mut radii: Vec<f32> = ellipsoids.iter().map(EllipsoidUniform::smallest_radius).collect();
        let quantile = radii.len() / 4;
        let usual =
            if radii.is_empty() { 1.0 } else { *radii.select_nth_unstable_by(quantile, f32::total_cmp).1 };
        let coarsest = COARSEST * CELLS as f32 * usual;
        let mut brick = (CELLS as f32 * FINEST * usual).max(extent.max_element() / LONGEST as f32);
        while brick <= coarsest {
            if entries(ellipsoids, brick) <= MOST_ENTRIES {
                let mut plan = Self::of(ellipsoids, level, (low, extent), brick);
                if plan.stored.len() <= MOST_STORED {
                    tell_distances(&mut plan.index, plan.size);
                    return Some(plan);
                }
            }
            brick *= COARSER;
        }
        None
    }

    fn of(ellipsoids: &[EllipsoidUniform], level: f32, (low, extent): (Vec3, Vec3), brick: f32) -> Self {
        let size = (extent / brick).ceil().as_uvec3().max(UVec3::ONE);
        let lists = lists(ellipsoids, low, brick, size);
        let core = densest(ellipsoids);
        // Where the base is displaced, all is stored.
        let above = level + ellipsoids.iter().map(|e| e.boundary).fold(0.0, f32::max);
        let mut plan =
            Self { low, brick, size, index: Vec::new(), stored: Vec::new(), candidates: Vec::new() };
        for (i, list) in lists.iter().enumerate() {
            let place = place(size, i);
            let corner = low + brick * place.as_vec3();
            let fills = |&e: &u32| {
                let e = &ellipsoids[e as usize];
                e.extinction == core && e.core_holds(corner, brick)
            };
            let reached =
                list.iter().any(|&e| ellipsoids[e as usize].reaches(corner + 0.5 * brick, 0.867 * brick));
            plan.index.push(if !reached {
                0
            } else if corner.y >= above && list.iter().any(fills) {
                CORE
            } else {
                let first = plan.candidates.len() as u32;
                plan.candidates.extend(list);
                let count = list.len() as u32;
                plan.stored.push(BrickUniform { place, first, count, padding: [0; 3] });
                STORED | (plan.stored.len() as u32 - 1)
            });
        }
        plan
    }
}

/// Has empty bricks of an index tell how many bricks away others are, at least: each round looks one brick farther.
pub(super) fn tell_distances(index: &mut [u32], size: UVec3) {
    let empty: Vec<bool> = index.iter().map(|&entry| entry < CORE).collect();
    let mut distance: Vec<u32> = empty.iter().map(|&empty| if empty { FARTHEST } else { 0 }).collect();
    for _ in 0..FARTHEST {
        let before = distance.clone();
        for (i, far) in distance.iter_mut().enumerate().filter(|(_, far)| **far > 0) {
            let nearest = around(place(size, i), size).map(|at| before[number(size, at)]).min();
            *far = (nearest.unwrap_or(0) + 1).min(*far);
        }
    }
    for (entry, far) in index.iter_mut().zip(distance).filter(|(entry, _)| **entry < CORE) {
        *entry = far;
    }
}

/// Entries that lists of bricks of this edge, m, have at the most.
fn entries(ellipsoids: &[EllipsoidUniform], brick: f32) -> f32 {
    ellipsoids.iter().map(|e| (2.0 * e.half() / brick + 2.0).element_product()).sum()
}

/// Ellipsoids that reach into each brick or come as near as a cell, so that depths there are those
/// outside of the nearest one.
fn lists(ellipsoids: &[EllipsoidUniform], low: Vec3, brick: f32, size: UVec3) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); size.element_product() as usize];
    let margin = brick / CELLS as f32;
    for (i, e) in ellipsoids.iter().enumerate() {
        let reach = |corner: Vec3| ((corner - low) / brick).floor().max(Vec3::ZERO).as_uvec3().min(size - 1);
        let (first, last) = (reach(e.center - e.half() - margin), reach(e.center + e.half() + margin));
        for at in cells(first, last) {
            let middle = low + brick * (at.as_vec3() + 0.5);
            if e.reaches(middle, 0.867 * brick + margin) {
                lists[number(size, at)].push(i as u32);
            }
        }
    }
    lists
}

pub(super) fn number(size: UVec3, at: UVec3) -> usize {
    ((at.z * size.y + at.y) * size.x + at.x) as usize
}

pub(super) fn place(size: UVec3, number: usize) -> UVec3 {
    let number = number as u32;
    UVec3::new(number % size.x, number / size.x % size.y, number / (size.x * size.y))
}

pub(super) fn cells(first: UVec3, last: UVec3) -> impl Iterator<Item = UVec3> {
    let span = |a: u32, b: u32| -> RangeInclusive<u32> { a..=b };
    span(first.z, last.z).flat_map(move |z| {
        span(first.y, last.y).flat_map(move |y| span(first.x, last.x).map(move |x| UVec3::new(x, y, z)))
    })
}

/// A brick and its neighbours.
fn around(at: UVec3, size: UVec3) -> impl Iterator<Item = UVec3> {
    cells(at.saturating_sub(UVec3::ONE), (at + 1).min(size - 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;
    use glam::DVec3;

    const NO_LEVEL: f32 = -1e30;

    fn heap() -> Vec<EllipsoidUniform> {
        let scene = Preset::Congestus.scene(1);
        let cloud = &scene.clouds[0];
        cloud
            .ellipsoids
            .iter()
            .map(|e| EllipsoidUniform::new(cloud, e, DVec3::new(0.0, 1500.0, 0.0), 100.0))
            .collect()
    }

    #[test]
    fn every_point_of_an_ellipsoid_is_in_a_brick_that_is_not_empty_and_knows_it() {
        let ellipsoids = heap();
        let plan = Plan::new(&ellipsoids, NO_LEVEL).unwrap();
        assert!(plan.stored.len() <= MOST_STORED && plan.stored.len() > 100, "{}", plan.stored.len());
        for i in 0..4000u32 {
            let t = (f64::from(i) + 0.5) / 4000.0;
            let (z, a) = (1.0 - 2.0 * t, 2.399_963 * f64::from(i));
            let u = 0.99 * DVec3::new((1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z);
            let which = i as usize % ellipsoids.len();
            let e = &ellipsoids[which];
            let rows = [e.row_x, e.row_y, e.row_z];
            let p = rows
                .iter()
                .zip(u.to_array())
                .fold(e.center, |p, (row, u)| p + row.truncate() / (row.w * row.w) * u as f32);
            let at = ((p - plan.low) / plan.brick).floor().as_uvec3();
            let entry = plan.index[number(plan.size, at)];
            assert!(entry >= CORE, "{p} is in an empty brick");
            if entry >= STORED {
                let brick = &plan.stored[(entry & (CORE - 1)) as usize];
                let list = &plan.candidates[brick.first as usize..][..brick.count as usize];
                assert_eq!(brick.place, at);
                assert!(list.contains(&(which as u32)));
            }
        }
    }

    #[test]
    fn empty_bricks_are_as_far_from_others_as_they_tell() {
        let plan = Plan::new(&heap(), NO_LEVEL).unwrap();
        let mut told = 0;
        for (i, &entry) in plan.index.iter().enumerate().filter(|(_, entry)| **entry < CORE) {
            let at = place(plan.size, i);
            let far = UVec3::splat(entry - 1);
            let clear = cells(at.saturating_sub(far), (at + far).min(plan.size - 1));
            assert!(clear.into_iter().all(|at| plan.index[number(plan.size, at)] < CORE), "{at}: {entry}");
            told = told.max(entry);
        }
        assert!(told > 1, "else nothing is jumped over");
    }
}
