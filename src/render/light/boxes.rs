//! The box around a cloud whose columns lie along the light: where its maps and volumes are.

use glam::{Vec3, Vec3Swizzles};

use crate::frame::medium::{EllipsoidUniform, Medium};

/// `LightBox` of `shaders/lib/light_box.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightBox {
    pub(crate) corner: Vec3,
    pub(crate) texel: f32,
    pub(crate) row_u: Vec3,
    pub(crate) length: f32,
    pub(crate) row_v: Vec3,
    pub(crate) repeat: f32,
    pub(crate) row_w: Vec3,
    padding_w: f32,
    pub(crate) edge_u: Vec3,
    padding_edge_u: f32,
    pub(crate) edge_v: Vec3,
    padding_edge_v: f32,
    pub(crate) along: Vec3,
    padding_along: f32,
}

/// Voxels across a layer's box over those along it, and the least of them.
const FLATTER: u32 = 16;
const LEAST_ALONG: u32 = 16;
/// Least share of the way along columns of a layer's box that goes down or up.
const FLATTEST: f32 = 0.03;
/// Share of the layer's height by which its box is higher.
const MARGIN: f32 = 0.05;
/// Most periods in a row: those beyond shade the far ground alone.
const MOST_TILES: f64 = 33.0;

/// Rows of the map to metres across and along a box whose columns lean: two axes of the
/// frame with the lean taken out, and the way along the light.
#[derive(Clone, Copy)]
struct Lean {
    across: [Vec3; 2],
    rows: [Vec3; 3],
}

impl Lean {
    /// Slices across the axis that light crosses a box of this half-extent by fastest.
    fn new(half: Vec3, along: Vec3) -> Self {
        let ways =
            [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (axis, half.dot(axis) / along.dot(axis).abs().max(1e-6)));
        let (through, _) =
            ways.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a }).unwrap_or((Vec3::Y, 0.0));
        let across = [through.yzx(), through.zxy()];
        let way = through / along.dot(through);
        let rows = [across[0] - along.dot(across[0]) * way, across[1] - along.dot(across[1]) * way, way];
        Self { across, rows }
    }
}

impl LightBox {
    /// The tightest box around `own` with columns along `along`, one texel of
    /// `resolution` wider on each side.
    pub(super) fn new(own: &[EllipsoidUniform], along: Vec3, resolution: u32) -> Self {
        let half =
            [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| extent(own, axis)).map(|(low, high)| 0.5 * (high - low));
        let Lean { across, rows } = Lean::new(half.into(), along);
        let ranges = rows.map(|row| extent(own, row));
        let texels = [0, 1].map(|i| (ranges[i].1 - ranges[i].0) / (resolution - 2) as f32);
        let margin = texels[0].max(texels[1]).min(ranges[2].1 - ranges[2].0);
        let sizes = texels.map(|texel| texel * resolution as f32);
        let (start, length) = (ranges[2].0 - 0.5 * margin, ranges[2].1 - ranges[2].0 + margin);
        let corner =
            (ranges[0].0 - texels[0]) * across[0] + (ranges[1].0 - texels[1]) * across[1] + start * along;
        Self {
            corner,
            texel: texels[0].max(texels[1]),
            row_u: rows[0] / sizes[0],
            length,
            row_v: rows[1] / sizes[1],
            row_w: rows[2] / length,
            edge_u: sizes[0] * across[0],
            edge_v: sizes[1] * across[1],
            along,
            ..bytemuck::Zeroable::zeroed()
        }
    }

    /// The same box in a frame whose origin is at `-offset` of its own, m.
    pub(in crate::render) fn moved(mut self, offset: Vec3) -> Self {
        self.corner += offset;
        self
    }

    /// Periods in a row that reach `reach` metres to each side, of a box that has any.
    pub(in crate::render) fn tiles(&self, reach: f64) -> u32 {
        let period = f64::from(self.repeat * self.edge_u.length());
        if self.repeat > 0.0 { (2.0 * (reach / period).ceil() + 1.0).min(MOST_TILES) as u32 } else { 1 }
    }

    /// Which way columns go in the box around a medium in light along `along`.
    pub(super) fn way(medium: &Medium, along: Vec3) -> Vec3 {
        if medium.layer.is_some() { steepened(along) } else { along }
    }

    /// The box around a medium with columns along `along`.
    pub(super) fn around(medium: &Medium, along: Vec3, resolution: u32) -> Self {
        match &medium.layer {
            Some(layer) => Self::of_layer(layer.half().as_vec3(), along, resolution),
            None => Self::new(&medium.ellipsoids, along, resolution),
        }
    }

    /// The box around a period of a layer of this half-extent, that repeats as the layer does; one texel wider on each
    /// side, so that what is between texels is known there, too. Columns are no flatter than [`FLATTEST`].
    fn of_layer(half: Vec3, along: Vec3, resolution: u32) -> Self {
        let along = steepened(along);
        let lean = [along.x, along.z].map(|across| across / along.y);
        let rows = [Vec3::new(1.0, -lean[0], 0.0), Vec3::new(0.0, -lean[1], 1.0)];
        let texel = 2.0 * half.x / (resolution - 2) as f32;
        let size = texel * resolution as f32;
        let through = 2.0 * half.y / along.y.abs();
        let start = -0.5 * (1.0 + MARGIN) * through;
        let length = (1.0 + MARGIN) * through;
        Self {
            corner: (-half.x - texel) * Vec3::X + (-half.x - texel) * Vec3::Z + start * along,
            texel,
            row_u: rows[0] / size,
            length,
            row_v: rows[1] / size,
            repeat: (resolution - 2) as f32 / resolution as f32,
            row_w: Vec3::Y / (along.y * length),
            edge_u: size * Vec3::X,
            edge_v: size * Vec3::Z,
            along,
            ..bytemuck::Zeroable::zeroed()
        }
    }

    pub(super) fn voxels(&self, resolution: u32) -> [u32; 3] {
        if self.repeat > 0.0 {
            return [resolution, resolution, (resolution / FLATTER).max(LEAST_ALONG)];
        }
        let along = (self.length / self.texel).ceil() as u32;
        [resolution, resolution, along.clamp(resolution / 4, 2 * resolution)]
    }
}

/// The same direction, no flatter than [`FLATTEST`].
fn steepened(along: Vec3) -> Vec3 {
    let steep = along.y.abs().max(FLATTEST).copysign(if along.y > 0.0 { 1.0 } else { -1.0 });
    along.with_y(steep).normalize()
}

fn extent(ellipsoids: &[EllipsoidUniform], axis: Vec3) -> (f32, f32) {
    ellipsoids.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), e| {
        let (center, half) = (e.center.dot(axis), e.support(axis));
        (low.min(center - half), high.max(center + half))
    })
}
