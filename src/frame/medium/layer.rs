//! A layer as the shaders see it: a height field that repeats.

use glam::{DVec3, dvec3};

use super::layer_tile::{TEXELS, Tile};
use crate::{frame::Shared, gpu::Role, scene::Cloud};

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
    pub(crate) sheet: f32,
    pub(crate) flat: f32,
    pub(crate) round: f32,
    pub(crate) steepest: f32,
    pub(crate) extinction: f32,
    pub(crate) boundary: f32,
    pub(crate) wispiness: f32,
    padding: f32,
}

/// The field over which a sheet comes to be as thick as it is, at its rims, of what it does not cover: one that covers
/// all has no rims.
const SHEET_RISE: f64 = 0.12;
/// Roundness of heaps whose edge is all billows, and all wisps.
const ROUND: [f64; 2] = [1.0, 0.02];

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
        // Heaps of a sky that is hardly covered are low.
        let rise = layer.coverage.sqrt();
        let sheet = (SHEET_RISE * (1.0 - tile.above(1.0 - layer.coverage))).max(1e-6);
        let (flat, wispy) = (1.0 - layer.heaps, cloud.edge.wispiness);
        let round = ROUND[0] + (ROUND[1] - ROUND[0]) * wispy;
        let slope = f64::from(tile.steepest) / period;
        let upright = if flat > 0.0 { rise.max(sheet / flat) } else { rise };
        let steepest = slope.hypot(upright * steepest_fill(round) / top.min(bottom.max(1e-2 * top)));
        let uniform = LayerUniform {
            rim: (layer.base + bottom - middle) as f32,
            top: top as f32,
            bottom: bottom as f32,
            ground: (ground - middle) as f32,
            frequency: (1.0 / period) as f32,
            texel: (period / TEXELS as f64) as f32,
            begin: (1.0 - layer.coverage) as f32,
            rise: rise as f32,
            sheet: sheet as f32,
            flat: flat as f32,
            round: round as f32,
            steepest: steepest as f32,
            extinction: (cloud.droplets.extinction() * layer.density) as f32,
            boundary: cloud.edge.boundary as f32,
            wispiness: cloud.edge.wispiness as f32,
            padding: 0.0,
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

    /// From where to where on its way, m, a ray from `height` in the layer's frame, m, may meet it before the ground over an earth
    /// of half the curvature `bend`, 1/m, where it goes up by `slope` each metre: `layer_span` of `shaders/lib/layer.wgsl` is
    /// there.
    pub fn met(&self, height: f32, slope: f32, bend: f32) -> Option<[f32; 2]> {
        let LayerUniform { rim, top, bottom, ground, .. } = self.uniform;
        let bend = f64::from(bend * (1.0 - slope * slope)).max(1e-13);
        let below = |level: f32| below(f64::from(height) - f64::from(level), slope.into(), bend);
        let (enters, leaves) = below(rim + top)?;
        let ground = below(ground).map_or(f64::INFINITY, |(enters, _)| enters);
        let end = if ground > 0.0 { leaves.min(ground) } else { leaves };
        let start = enters.max(0.0);
        // Below its lower side it is not.
        let start = match below(rim - bottom) {
            Some((enters, leaves)) if (enters..leaves).contains(&start) => leaves,
            _ => start,
        };
        (start < end).then_some([start as f32, end as f32])
    }

    /// Whether there may be something of it over a square, one of `squares` along a period, between two heights in its
    /// frame, m.
    pub fn reaches(&self, square: [f64; 2], squares: f64, [low, high]: [f32; 2]) -> bool {
        let LayerUniform { rim, begin, .. } = self.uniform;
        let mip = (TEXELS as f64 / squares).log2().round() as usize;
        let peak = self.tile.peak(mip, square[0].floor() as i64, square[1].floor() as i64);
        let nearest = 0_f32.clamp(low - rim, high - rim);
        f64::from(peak - begin) >= self.need(nearest.into())
    }

    /// Share of the plan that it covers.
    pub fn covered(&self) -> f64 {
        self.tile.above(self.uniform.begin.into())
    }

    /// How far the field is above where the cover begins where this share of what is covered has less.
    pub fn excess(&self, share: f64) -> f64 {
        let place = 1.0 - self.covered() * (1.0 - share);
        (self.tile.quantile(place) - f64::from(self.uniform.begin)).max(0.0)
    }

    /// Heights of the upper and the lower side above and below the rims, m, where the field is `excess` above where the cover
    /// begins: `layer_heights` of `shaders/lib/layer.wgsl`, of the sheet or the heaps.
    pub fn heights(&self, excess: f64) -> [f64; 2] {
        let LayerUniform { top, bottom, rise, sheet, flat, round, .. } = self.uniform;
        let round = f64::from(round);
        let shares = |rise: f32| {
            let fill = (excess / f64::from(rise)).clamp(0.0, 1.0);
            let g = (fill * (fill + 2.0 * round)).sqrt();
            [g / (1.0 + 2.0 * round).sqrt(), g / (g * g + 2.0).sqrt() / lower(round)]
        };
        let (heaps, sheet) = (shares(rise), shares(sheet));
        std::array::from_fn(|side| {
            f64::from([top, bottom][side]) * heaps[side].max(f64::from(flat) * sheet[side])
        })
    }

    /// How far above where the cover begins the field must be for cloud at a height above the rims: the least that
    /// `layer_need` of `shaders/lib/layer.wgsl` tells of the sheet and the heaps.
    fn need(&self, height: f64) -> f64 {
        let LayerUniform { top, bottom, rise, sheet, flat, round, .. } = self.uniform;
        let round = f64::from(round);
        let part = |rise: f32, share: f32| {
            let most = f64::from(share * if height > 0.0 { top } else { bottom }).max(1e-3);
            let share = height.abs() / most;
            if share > 1.0 {
                return f64::INFINITY;
            }
            let g = if height > 0.0 {
                share * (1.0 + 2.0 * round).sqrt()
            } else {
                let r = share * lower(round);
                r * (2.0 / (1.0 - r * r)).sqrt()
            };
            f64::from(rise) * g * g / (round.hypot(g) + round)
        };
        part(rise, 1.0).min(part(sheet, flat))
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

/// `layer_lower` of `shaders/lib/layer.wgsl`.
fn lower(round: f64) -> f64 {
    ((1.0 + 2.0 * round) / (3.0 + 2.0 * round)).sqrt()
}

/// The steepest slope of `layer_fill` of `shaders/lib/layer.wgsl`, which both sides have at their most height.
fn steepest_fill(round: f64) -> f64 {
    let lower = lower(round);
    let left = 1.0 - lower * lower;
    let below = (2.0 / left).sqrt() * lower / left * (1.0 + 2.0 * round).sqrt() / (1.0 + round);
    below.max((1.0 + 2.0 * round) / (1.0 + round))
}
