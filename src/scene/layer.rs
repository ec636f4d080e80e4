//! A layer: a sheet or a deck of heaps that goes on to the horizon.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, COORDINATE, Limits};
use super::{CoverMap, Noise};
use crate::Result;

const SHARE: Limits = Limits::new(0.0, 1.0, "");
const THICKNESS: Limits = Limits::new(1.0, 2e4, "metres");
const SCALE: Limits = Limits::new(10.0, 1e5, "metres");
const STRETCH: Limits = Limits::new(1.0, 20.0, "");
const HEADING: Limits = Limits::new(-360.0, 360.0, "degrees");
const DENSITY: Limits = Limits::new(0.0, 100.0, "");
/// Size of the largest billows where none is told, as a share of the scale.
const BILLOWS: f64 = 0.3;
const BULGE: Limits = Limits::new(0.0, 0.9, "");

/// The shape of a cloud without an end: a sheet, a deck of heaps, streaks. It repeats itself every
/// [`Layer::PERIOD`] of its `scale`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Layer {
    /// Altitude of its lowest point, metres.
    #[schemars(range(min = COORDINATE.min, max = COORDINATE.max), extend("unit" = COORDINATE.unit))]
    pub base: f64,
    /// From its lowest to its highest point, metres, 1 to 20000.
    #[schemars(range(min = THICKNESS.min, max = THICKNESS.max), extend("unit" = THICKNESS.unit))]
    pub thickness: f64,
    /// Share of the sky that it covers, seen from straight below, 0 (none is there) to 1, no unit.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub coverage: f64,
    /// From one heap or streak to the next, metres, 10 to 100000.
    #[schemars(range(min = SCALE.min, max = SCALE.max), extend("unit" = SCALE.unit))]
    pub scale: f64,
    /// How many times as long as wide its heaps are, 1 to 20, no unit.
    #[schemars(range(min = STRETCH.min, max = STRETCH.max))]
    pub stretch: f64,
    /// Which way they are long, degrees clockwise from north, -360 to 360.
    #[schemars(range(min = HEADING.min, max = HEADING.max), extend("unit" = HEADING.unit))]
    pub heading_deg: f64,
    /// 0 is a sheet, equally thick but for its rims, 1 is all heaps, no unit.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub heaps: f64,
    /// 0 is torn as by chance, 1 is in cells side by side, no unit.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub cells: f64,
    /// Share of the thickness that is below its rims, 0 (flat below) to 0.9, no unit.
    #[schemars(range(min = BULGE.min, max = BULGE.max))]
    pub bulge: f64,
    /// Extinction over that of the droplets, 0 to 100, no unit.
    #[schemars(range(min = DENSITY.min, max = DENSITY.max))]
    pub density: f64,
    /// Shift [x, z], metres; the wind adds to it.
    #[schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    pub offset: [f64; 2],
    /// Any whole number, 0 to 4294967295: other seeds give other layers of the same kind.
    pub seed: u32,
    /// What of the sky it covers, as painted: where the map is white, as much as `coverage` says, and where it is darker, as much
    /// less. With a `coverage` of 1 the painted value is the share that is covered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<CoverMap>,
}

impl Default for Layer {
    fn default() -> Self {
        Self {
            base: 1200.0,
            thickness: 300.0,
            coverage: 0.7,
            scale: 900.0,
            stretch: 1.0,
            heading_deg: 0.0,
            heaps: 1.0,
            cells: 0.8,
            bulge: 0.15,
            density: 1.0,
            offset: [0.0; 2],
            seed: 0,
            map: None,
        }
    }
}

impl Layer {
    /// After so many times its scale it repeats itself, along x and along z.
    pub const PERIOD: f64 = 12.0;

    /// Length after which it repeats itself along x and along z, m: with a map as this does, and heaps are fitted to it.
    pub fn period(&self) -> f64 {
        let [_, maps] = self.map.as_ref().map_or([1; 2], |map| map.repeats(self.scale));
        self.map.as_ref().map_or(Self::PERIOD * self.scale, |map| map.size * maps as f64)
    }

    /// Size of the largest billows of its edge, m, where `noise` shapes that.
    pub fn billows(&self, noise: &Noise) -> f64 {
        let most = BILLOWS * self.scale;
        noise.scale.unwrap_or((0.6 * self.thickness).min(most)).min(self.scale)
    }

    /// The way along which it is long, a unit vector, times the logarithm of how many times as long as wide.
    pub(crate) fn lengthening(&self) -> DVec3 {
        let heading = self.heading_deg.to_radians();
        self.stretch.ln() * DVec3::new(heading.sin(), 0.0, -heading.cos())
    }

    /// Moves it by `offset`, m.
    pub(super) fn shift(&mut self, offset: DVec3) {
        self.base += offset.y;
        self.offset[0] += offset.x;
        self.offset[1] += offset.z;
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("base").number(self.base, COORDINATE)?;
        at.field("thickness").number(self.thickness, THICKNESS)?;
        at.field("coverage").number(self.coverage, SHARE)?;
        at.field("scale").number(self.scale, SCALE)?;
        at.field("stretch").number(self.stretch, STRETCH)?;
        at.field("heading_deg").number(self.heading_deg, HEADING)?;
        at.field("heaps").number(self.heaps, SHARE)?;
        at.field("cells").number(self.cells, SHARE)?;
        at.field("bulge").number(self.bulge, BULGE)?;
        at.field("density").number(self.density, DENSITY)?;
        at.field("offset").numbers(&self.offset, COORDINATE)?;
        self.map.as_ref().map_or(Ok(()), |map| map.check(at.field("map"), self.scale))
    }
}
