//! A volume as the shaders see it: bricks of its grid, and where they lie in a frame.

use std::collections::HashMap;

use glam::{DAffine3, DVec3, IVec3, Vec3, Vec4};

use super::{
    EllipsoidUniform,
    bricks::{Bricks, CELLS, LEVELS},
};
use crate::{
    Error, Result,
    frame::Shared,
    gpu::Role,
    scene::{Cloud, Ellipsoid, Volume},
};

/// The medium as a volume.
pub(crate) const VOLUME: Role<'static> = ("medium", include_str!("../../../shaders/medium/volume.wgsl"));

/// Parts along the longest edge of a volume that proxies stand for.
const PARTS: i32 = 10;

/// `Volume` of `shaders/lib/volume.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct VolumeUniform {
    pub(crate) row_x: Vec4,
    pub(crate) row_y: Vec4,
    pub(crate) row_z: Vec4,
    pub(crate) texel: Vec3,
    pub(crate) extinction: f32,
    pub(crate) slots: [u32; 2],
    pub(crate) voxel: f32,
    pub(crate) count: u32,
    pub(crate) widest: f32,
    /// 1 where a texel holds several fields, else 0.
    pub(crate) mixed: u32,
    padding: [f32; 2],
    pub(crate) levels: [[u32; 4]; LEVELS],
}

/// A volume that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VolumeShape {
    pub bricks: Shared<Bricks>,
    pub uniform: VolumeUniform,
    /// The box around it, m.
    bounds: (Vec3, Vec3),
}

impl VolumeShape {
    /// The volume of a cloud, in a frame whose origin is at `origin`.
    ///
    /// # Errors
    /// Where it was not read, or has more bricks than a device holds.
    pub fn new(volume: &Volume, origin: DVec3) -> Result<Self> {
        let grid = volume.grid()?;
        let bricks = Bricks::of(grid)
            .map_err(|problem| Error::Argument(format!("the volume `{}` {problem}", volume.file)))?;
        let frame = DAffine3::from_translation(-origin);
        // Voxels' middles are corners of cells.
        let cells = DAffine3::from_translation(bricks.base().as_dvec3())
            * DAffine3::from_scale(DVec3::splat(CELLS.into()));
        let bricks_from_frame = (frame * volume.world_from_voxels(grid) * cells).inverse();
        let rows = bricks_from_frame.matrix3.transpose();
        let row = |axis: DVec3, at: f64| axis.extend(at).as_vec4();
        let shift = bricks_from_frame.translation;
        let edges = volume.world_from_voxels(grid).matrix3;
        let voxel = [edges.x_axis, edges.y_axis, edges.z_axis].map(DVec3::length);
        let slots = bricks.slots();
        let uniform = VolumeUniform {
            row_x: row(rows.x_axis, shift.x),
            row_y: row(rows.y_axis, shift.y),
            row_z: row(rows.z_axis, shift.z),
            texel: bricks.texel(),
            extinction: (volume.extinction * f64::from(grid.most)) as f32,
            slots: [slots.x, slots.y],
            voxel: voxel.into_iter().fold(f64::INFINITY, f64::min) as f32,
            count: bricks.levels(),
            widest: voxel.into_iter().fold(0.0, f64::max) as f32,
            mixed: 0,
            padding: [0.0; 2],
            levels: bricks.table(),
        };
        let (low, high) = volume.bounds().unwrap_or_default();
        Ok(Self { bricks, uniform, bounds: ((low - origin).as_vec3(), (high - origin).as_vec3()) })
    }

    /// The box around it, in its frame, m.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// One of these bricks, whose box is `bounds`, m.
    pub(super) fn new_of(bricks: Shared<Bricks>, uniform: VolumeUniform, bounds: (Vec3, Vec3)) -> Self {
        Self { bricks, uniform, bounds }
    }

    /// Its uniform with other bricks on the same grid.
    pub(super) fn uniform_of(&self, bricks: &Bricks) -> VolumeUniform {
        VolumeUniform {
            texel: bricks.texel(),
            slots: [bricks.slots().x, bricks.slots().y],
            count: bricks.levels(),
            levels: bricks.table(),
            ..self.uniform
        }
    }

    /// The part of a box in its frame that its bricks may be in.
    pub fn clip(&self, low: Vec3, high: Vec3) -> (Vec3, Vec3) {
        let (own_low, own_high) = self.bounds;
        (low.max(own_low), high.min(own_high))
    }

    /// The greatest extinction in a ball, 1/m: never too small.
    pub fn most_within(&self, center: Vec3, radius: f32) -> f32 {
        let rows = [self.uniform.row_x, self.uniform.row_y, self.uniform.row_z];
        let place = Vec3::from(rows.map(|row| row.dot(center.extend(1.0))));
        let half = Vec3::from(rows.map(|row| row.truncate().length() * radius)) + 1e-3;
        self.uniform.extinction * self.bricks.most_between(place - half, place + half)
    }

    /// Ellipsoids that hold all of it, in a frame whose origin is at `origin`: who asks which parts of a picture or a
    /// box it is in, asks them. Each is as dense as what it holds is at the most.
    pub fn proxies(&self, cloud: &Cloud, volume: &Volume, origin: DVec3) -> Vec<EllipsoidUniform> {
        let Some(grid) = volume.read_grid() else { return Vec::new() };
        let world = volume.world_from_voxels(grid);
        let (low, high) = Volume::reach(grid);
        let edge = ((high - low).max_element() / PARTS).max(4);
        let mut parts = HashMap::<[i32; 3], (IVec3, IVec3, f32)>::new();
        for (at, value) in grid.filled() {
            let part = ((at - low) / edge).to_array();
            let known = parts.entry(part).or_insert((at, at, value));
            *known = (known.0.min(at), known.1.max(at), known.2.max(value));
        }
        let mut parts: Vec<_> = parts.into_iter().collect();
        parts.sort_by_key(|(part, _)| *part);
        let axes = world.matrix3;
        let lengths = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
        let turned =
            glam::DMat3::from_cols(axes.x_axis / lengths.x, axes.y_axis / lengths.y, axes.z_axis / lengths.z);
        // A mirrored or skewed grid has no rotation: balls hold its parts as well.
        let straight = (turned * turned.transpose()).abs_diff_eq(glam::DMat3::IDENTITY, 1e-9);
        let rotation = straight.then(|| {
            let sign = turned.determinant().signum();
            glam::DQuat::from_mat3(&glam::DMat3::from_cols(
                turned.x_axis,
                turned.y_axis,
                sign * turned.z_axis,
            ))
        });
        let proxy = |(_, (first, last, most)): &([i32; 3], (IVec3, IVec3, f32))| {
            let half = 0.5 * (*last - *first).as_dvec3() + 1.0;
            let center = world.transform_point3(0.5 * (*first + *last).as_dvec3());
            let radii = match rotation {
                Some(_) => 3_f64.sqrt() * half * lengths,
                None => DVec3::splat(half.dot(lengths)),
            };
            let mut ellipsoid = Ellipsoid::new(center, radii);
            ellipsoid.orientation = rotation.unwrap_or_default();
            let mut proxy = EllipsoidUniform::new(cloud, &ellipsoid, origin, f64::INFINITY);
            // What is between voxels is no denser than they are.
            proxy.extinction = (volume.extinction * f64::from(*most)) as f32;
            proxy
        };
        parts.iter().map(proxy).collect()
    }
}
