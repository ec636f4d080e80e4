//! The wind.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, Limits};
use crate::Result;

const SPEED: Limits = Limits::new(-1e3, 1e3, "metres per second");

/// The wind that carries the clouds, each with the noise of its own; a cloud that has none drifts through the
/// scene's, which stands still in the world.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Wind {
    /// Where the air goes [x, y, z], metres per second, each -1000 to 1000: x to the
    /// east, y up, z to the south. After `time` seconds the clouds have drifted
    /// `time` times as far.
    #[schemars(with = "[f64; 3]", inner(range(min = SPEED.min, max = SPEED.max)), extend("unit" = SPEED.unit))]
    pub velocity: DVec3,
    /// How much faster it goes each kilometre above the lowest base of all clouds [x, y, z], metres per
    /// second, each -1000 to 1000. Towers lean with it as time goes by, and high clouds overtake low ones.
    #[serde(skip_serializing_if = "is_none")]
    #[schemars(with = "[f64; 3]", inner(range(min = SPEED.min, max = SPEED.max)), extend("unit" = SPEED.unit))]
    pub shear: DVec3,
}

fn is_none(shear: &DVec3) -> bool {
    *shear == DVec3::ZERO
}

impl Wind {
    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("velocity").numbers(&self.velocity.to_array(), SPEED)?;
        at.field("shear").numbers(&self.shear.to_array(), SPEED)
    }
}
