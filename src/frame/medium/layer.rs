//! A layer as the shaders see it: a height field that repeats.

use glam::{DVec3, dvec3};

use super::layer_tile::{TEXELS, Tile};
use crate::{
    frame::Shared,
    gpu::Role,
    scene::{self, Cloud},
};

/// The medium as a layer.
pub(crate) const LAYER: Role<'static> = ("medium", include_str!("../../../shaders/medium/layer.wgsl"));

/// `Layer` of `shaders/lib/layer.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LayerUniform {
    pub(crate) rim: f32,
    pub(crate) top: f32,
    pub(crate) bottom: f32,
    pub(crate) ground: f32,
    pub(crate) frequency: f32,
    pub(crate) texel: f32,
    pub(crate) begin: f32,
    pub(crate) rise: f32,
    pub(crate) steepest: f32,
    pub(crate) extinction: f32,
    pub(crate) boundary: f32,
    pub(crate) wispiness: f32,
}

/// The field over which a sheet comes to be as thick as it is, at its rims.
const SHEET_RISE: f64 = 0.12;
/// Roundness of heaps: that of `shaders/lib/layer.wgsl`.
const ROUND: f64 = 1.0;

/// The shape of a layer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LayerShape {
    pub uniform: LayerUniform,
    pub tile: Shared<Tile>,
    /// Length after which it repeats itself, m.
    pub period: f64,
    /// A corner of a period in the world, m, at half the layer's height.
    anchor: DVec3,
}

impl LayerShape {
    /// That of `cloud`, above ground at the altitude `ground`, m; none where it covers nothing.
    pub fn new(cloud: &Cloud, ground: f64) -> Option<Self> {
        let layer = cloud.layer.as_ref().filter(|layer| layer.coverage > 0.0)?;
        let (tile, period) = (Tile::of(layer), layer.period());
        let bottom = layer.bulge * layer.thickness;
        let top = layer.thickness - bottom;
        let middle = layer.base + 0.5 * layer.thickness;
        let rise = rise(layer);
        let slope = f64::from(tile.steepest) / period;
        let steepest = slope.hypot(rise * steepest_fill(top).max(steepest_fill(bottom)));
        let uniform = LayerUniform {
            rim: (layer.base + bottom - middle) as f32,
            top: top as f32,
            bottom: bottom as f32,
            ground: (ground - middle) as f32,
            frequency: (1.0 / period) as f32,
            texel: (period / TEXELS as f64) as f32,
            begin: (1.0 - layer.coverage) as f32,
            rise: rise as f32,
            steepest: steepest as f32,
            extinction: (cloud.droplets.extinction() * layer.density) as f32,
            boundary: cloud.edge.boundary as f32,
            wispiness: cloud.edge.wispiness as f32,
        };
        let anchor = dvec3(layer.offset[0], middle, layer.offset[1]);
        Some(Self { uniform, tile, period, anchor })
    }

    /// The corner of a period that is nearest to `eye`, in the world, m: where its frame has its origin. A
    /// layer is the same seen from each.
    pub fn origin_near(&self, eye: DVec3) -> DVec3 {
        let away = ((eye - self.anchor) / self.period).round().with_y(0.0);
        self.anchor + self.period * away
    }

    /// Its corner that no eye moves.
    pub fn anchor(&self) -> DVec3 {
        self.anchor
    }

    /// Half the extent of a period of it, m.
    pub fn half(&self) -> DVec3 {
        let height = f64::from(self.uniform.top + self.uniform.bottom);
        0.5 * dvec3(self.period, height, self.period)
    }
}

impl LayerShape {
    /// Whether a ray from `height` in the layer's frame, m, meets it before the ground over an earth of half the
    /// curvature `bend`, 1/m, where it goes up by `slope` each metre: `layer_span` of `shaders/lib/layer.wgsl` is there.
    pub fn is_met(&self, height: f32, slope: f32, bend: f32) -> bool {
        let LayerUniform { rim, top, bottom, ground, .. } = self.uniform;
        let bend = f64::from(bend * (1.0 - slope * slope)).max(1e-13);
        let below = |level: f32| below(f64::from(height) - f64::from(level), slope.into(), bend);
        let Some((enters, leaves)) = below(rim + top) else { return false };
        let ground = below(ground).map_or(f64::INFINITY, |(enters, _)| enters);
        let end = if ground > 0.0 { leaves.min(ground) } else { leaves };
        let start = enters.max(0.0);
        match below(rim - bottom) {
            Some((enters, leaves)) if (enters..leaves).contains(&start) => leaves < end,
            _ => start < end,
        }
    }
}

/// Distances between which o + d t + b t^2 is below 0.
fn below(o: f64, d: f64, b: f64) -> Option<(f64, f64)> {
    let square = d * d - 4.0 * b * o;
    if square <= 0.0 {
        return None;
    }
    let q = -0.5 * (d + square.sqrt().copysign(d));
    let (first, second) = (q / b, if q == 0.0 { 0.0 } else { o / q });
    Some((first.min(second), first.max(second)))
}

/// By how much the field of a layer is above where its cover begins where it is at its thickest. A sheet that
/// covers all has no rims.
fn rise(layer: &scene::Layer) -> f64 {
    let sheet = SHEET_RISE * (1.0 - layer.coverage);
    (sheet + layer.heaps * (layer.coverage.sqrt() - sheet)).max(1e-6)
}

/// The steepest slope of what heights of heaps that are `height` m high need of the field, 1/m.
fn steepest_fill(height: f64) -> f64 {
    (1.0 + 2.0 * ROUND) / (1.0 + ROUND) / height.max(1e-3)
}
