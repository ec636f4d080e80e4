//! The air around the clouds.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, Limits};
use crate::Result;

const RADIANCE: Limits = Limits::new(0.0, 1e6, "");
const HAZE: Limits = Limits::new(0.0, 20.0, "");
const OZONE: Limits = Limits::new(0.0, 20.0, "");

/// The light of the sky and what is seen behind the clouds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Sky {
    /// The Earth's atmosphere, lit by the sun.
    Atmosphere(Atmosphere),
    /// The same light from every direction above and below the horizon.
    Uniform {
        /// Linear RGB radiance, each 0 to 1000000, in the unit of the sun's irradiance per steradian.
        #[schemars(inner(range(min = RADIANCE.min, max = RADIANCE.max)))]
        radiance: [f64; 3],
    },
    /// No light but the sun's, and black behind the clouds.
    None,
}

/// What the air holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Atmosphere {
    /// Multiplies an aerosol of 0.0044 per kilometre at the ground, 0 to 20, no unit: 0 is pure air, 2.5 that of
    /// Antarctica, 6 clean continental air, in which one sees 97 km, 17 average continental air, 44 km.
    #[schemars(range(min = HAZE.min, max = HAZE.max))]
    pub haze: f64,
    /// Multiplies the ozone, 0 to 20, no unit. It keeps the zenith blue at dusk.
    #[schemars(range(min = OZONE.min, max = OZONE.max))]
    pub ozone: f64,
}

impl Default for Sky {
    fn default() -> Self {
        Self::Atmosphere(Atmosphere::default())
    }
}

impl Default for Atmosphere {
    fn default() -> Self {
        Self { haze: 6.0, ozone: 1.0 }
    }
}

impl Sky {
    pub(super) fn check(&self, at: At) -> Result<()> {
        match self {
            Self::Atmosphere(air) => air.check(at.field("atmosphere")),
            Self::Uniform { radiance } => {
                let uniform = at.field("uniform");
                uniform.field("radiance").numbers(radiance, RADIANCE)
            }
            Self::None => Ok(()),
        }
    }
}

impl Atmosphere {
    fn check(&self, at: At) -> Result<()> {
        at.field("haze").number(self.haze, HAZE)?;
        at.field("ozone").number(self.ozone, OZONE)
    }
}
