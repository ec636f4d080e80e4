//! The noise that shapes the boundaries.

use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, COORDINATE, Limits};
use crate::Result;

const SCALE: Limits = Limits::new(0.1, 1e5, "metres");
const DETAIL: Limits = Limits::new(0.0, 1.0, "");

/// The fractal noise that shapes the boundaries of all clouds. It stands in the
/// world: a cloud that drifts through it changes its billows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Any whole number, 0 to 4294967295: other seeds give other billows of the same kind.
    pub seed: u32,
    /// Size of the largest billows, metres, 0.1 to 100000. About twice the thickness
    /// of the boundary looks natural.
    #[schemars(range(min = SCALE.min, max = SCALE.max), extend("unit" = SCALE.unit))]
    pub scale: f64,
    /// Strength of the fine billows against the large ones, 0 (none) to 1, no unit.
    #[schemars(range(min = DETAIL.min, max = DETAIL.max))]
    pub detail: f64,
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
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            seed: 0,
            scale: 120.0,
            detail: 0.5,
            offset: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            evolution: 0.0,
        }
    }
}

impl Noise {
    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("scale").number(self.scale, SCALE)?;
        at.field("detail").number(self.detail, DETAIL)?;
        at.field("offset").position(self.offset)?;
        at.field("rotation").rotation(self.rotation)?;
        at.field("evolution").number(self.evolution, COORDINATE)
    }
}
