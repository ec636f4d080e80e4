//! The noise that shapes the boundaries.

use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Bounds;
use super::validate::{At, COORDINATE, Limits};
use super::whole::whole;
use crate::Result;

const SCALE: Limits = Limits::new(0.1, 1e5, "metres");
const RATE: Limits = Limits::new(-600.0, 600.0, "per minute");
const TIMES: Limits = Limits::new(-1e6, 1e6, "");
const DETAIL: Limits = Limits::new(0.0, 1.0, "");
const DIMENSION: Limits = Limits::new(2.0, 2.9, "");
/// Size of the largest billows where none is told, as a share of the cloud's size.
const SHARE: f64 = 0.16;

/// The fractal noise that shapes the boundary of a cloud: a power law over all octaves that a
/// pixel can see. A cloud's own drifts with it; the scene's stands in the world, so that a cloud that
/// drifts through it changes its billows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Any whole number, 0 to 4294967295: other seeds give other billows of the same kind.
    #[serde(deserialize_with = "whole")]
    #[schemars(with = "u32", range(min = 0, max = u32::MAX))]
    pub seed: u32,
    /// Size of the largest billows, metres, 0.1 to 100000: 0.16 of the cloud's size where left out, that
    /// is the cube root of the box around it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = SCALE.min, max = SCALE.max), extend("unit" = SCALE.unit))]
    pub scale: Option<f64>,
    /// Strength of billows finer than a sixteenth of the largest, 0 (none) to 1 (twice the power
    /// law's), no unit; 0.5, by the power law, where left out.
    #[schemars(range(min = DETAIL.min, max = DETAIL.max))]
    pub detail: f64,
    /// Dimension of the surface that the power law makes, 2 (smooth) to 2.9 (ragged), no unit: each octave
    /// has 2^(dimension - 3) of the amplitude of the one before. Clouds have 2.35 (Lovejoy 1982).
    #[schemars(range(min = DIMENSION.min, max = DIMENSION.max))]
    pub dimension: f64,
    /// Shift of the noise [x, y, z], metres. Animate it to let the billows wander.
    #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    pub offset: DVec3,
    /// Rotation of the noise about the point `offset`, a quaternion [x, y, z, w]; made unit
    /// length on loading.
    #[schemars(with = "[f64; 4]")]
    pub rotation: DQuat,
    /// Distance by which the fine billows slid against the coarse ones, metres.
    /// Animate it to let the edges boil.
    #[schemars(range(min = COORDINATE.min, max = COORDINATE.max), extend("unit" = COORDINATE.unit))]
    pub evolution: f64,
    /// How often a minute its billows make way for others while they rise and roll, -600 to 600: 0 stands still, less
    /// than 0 sinks. Real ones of a hundred metres last for some minutes, in time-lapse for seconds.
    #[serde(skip_serializing_if = "is_still")]
    #[schemars(range(min = RATE.min, max = RATE.max), extend("unit" = RATE.unit))]
    pub rate: f64,
    /// How far it has come at the scene's start; left out where that is the beginning.
    #[serde(skip_serializing_if = "Renewed::is_none")]
    pub renewed: Renewed,
}

/// How often billows have made way for others.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Renewed {
    /// So often since it was as noise that stands still, -1000000 to 1000000, no unit.
    #[schemars(range(min = TIMES.min, max = TIMES.max))]
    pub times: f64,
    /// After so many it is as it was at the start, 0 to 4294967295; never where 0.
    #[serde(deserialize_with = "whole")]
    #[schemars(with = "u32", range(min = 0, max = u32::MAX))]
    pub round: u32,
}

impl Noise {
    /// How far billows are from where they are in `other`, m, to `radius` m from the middle that they turn about; never near where they
    /// are of another kind. Those that make way for others are carried by their size each time.
    pub(crate) fn distance_to(&self, other: &Self, radius: f64) -> f64 {
        let like = Self {
            offset: other.offset,
            rotation: other.rotation,
            evolution: other.evolution,
            renewed: other.renewed,
            ..self.clone()
        };
        if like != *other || self.renewed.round != other.renewed.round {
            return f64::INFINITY;
        }
        let size = self.scale.unwrap_or(radius);
        (self.offset - other.offset).length()
            + radius * self.rotation.angle_between(other.rotation)
            + (self.evolution - other.evolution).abs()
            + size * (self.renewed.times - other.renewed.times).abs()
    }
}

impl Renewed {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

fn is_still(rate: &f64) -> bool {
    *rate == 0.0
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            seed: 0,
            scale: None,
            detail: 0.5,
            dimension: 2.35,
            offset: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            evolution: 0.0,
            rate: 0.0,
            renewed: Renewed::default(),
        }
    }
}

impl Noise {
    /// Size of the largest billows of a cloud in a box, m.
    pub fn scale_in(&self, (low, high): Bounds) -> f64 {
        let size = (high - low).element_product().cbrt();
        self.scale.unwrap_or((SHARE * size).clamp(SCALE.min, SCALE.max))
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        if let Some(scale) = self.scale {
            at.field("scale").number(scale, SCALE)?;
        }
        at.field("detail").number(self.detail, DETAIL)?;
        at.field("dimension").number(self.dimension, DIMENSION)?;
        at.field("offset").position(self.offset)?;
        at.field("rotation").rotation(self.rotation)?;
        at.field("evolution").number(self.evolution, COORDINATE)?;
        at.field("rate").number(self.rate, RATE)?;
        at.field("renewed").field("times").number(self.renewed.times, TIMES)
    }
}
