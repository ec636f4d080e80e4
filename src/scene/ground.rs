//! What is below the clouds.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    GroundPicture,
    validate::{At, COORDINATE, Limits},
};
use crate::Result;

const ALBEDO: Limits = Limits::new(0.0, 1.0, "");
const VARIATION: Limits = Limits::new(0.0, 1.0, "");
const FIELDS: Limits = Limits::new(10.0, 1e5, "metres");
const WIND: Limits = Limits::new(0.0, 20.0, "metres per second");

/// The ground below: a plane that reflects light. Under an atmosphere it is round as the Earth to the eye, and hides
/// what is below and behind it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Ground {
    /// Linear RGB share of the light that the ground reflects, each 0 to 1: land
    /// 0.1, sea 0.05, sand 0.3, fresh snow 0.9.
    #[schemars(inner(range(min = ALBEDO.min, max = ALBEDO.max)))]
    pub albedo: [f64; 3],
    /// Height of the ground, the y of its plane, metres.
    #[schemars(range(min = COORDINATE.min, max = COORDINATE.max), extend("unit" = COORDINATE.unit))]
    pub altitude: f64,
    /// What it looks like from above, under an atmosphere. Clouds are lit by ground of its albedo, whatever it is.
    pub kind: GroundKind,
}

/// What the ground looks like.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum GroundKind {
    /// The same everywhere and from all sides.
    #[default]
    Even,
    /// Fields and woods, whose mean is the albedo.
    Land(Land),
    /// Water under wind, which mirrors the sky and glitters before the sun. What it reflects beyond 0.05 comes out of
    /// the water, with the albedo's colour. Of clouds it mirrors the light alone.
    Water(Water),
    /// A picture from above, and even ground around it.
    Picture(GroundPicture),
}

/// Fields and woods.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Land {
    /// How much they differ, 0 to 1: 0 is even ground, 1 has woods of half the mean beside stubble of twice the mean.
    #[schemars(range(min = VARIATION.min, max = VARIATION.max))]
    pub variation: f64,
    /// Width of a field, metres, 10 to 100000; woods are some six times as wide.
    #[schemars(range(min = FIELDS.min, max = FIELDS.max), extend("unit" = FIELDS.unit))]
    pub field_width: f64,
}

/// Water under wind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Water {
    /// Speed of the wind over it, metres per second, 0 to 20: the more, the wider the sun's glitter.
    #[schemars(range(min = WIND.min, max = WIND.max), extend("unit" = WIND.unit))]
    pub wind: f64,
}

impl Default for Ground {
    /// Land without snow. The mean is the average ground reflectance 0.1 of Bruneton
    /// and Neyret (2008); its warm tint, soil between grass, is a matter of taste.
    fn default() -> Self {
        Self { albedo: [0.12, 0.11, 0.07], altitude: 0.0, kind: GroundKind::Even }
    }
}

impl Default for Land {
    fn default() -> Self {
        Self { variation: 0.6, field_width: 400.0 }
    }
}

impl Default for Water {
    fn default() -> Self {
        Self { wind: 5.0 }
    }
}

impl Ground {
    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("albedo").numbers(&self.albedo, ALBEDO)?;
        at.field("altitude").number(self.altitude, COORDINATE)?;
        self.kind.check(at.field("kind"))
    }
}

impl GroundKind {
    /// The picture that it is of.
    pub fn picture(&self) -> Option<&GroundPicture> {
        match self {
            Self::Picture(picture) => Some(picture),
            _ => None,
        }
    }

    pub(crate) fn picture_mut(&mut self) -> Option<&mut GroundPicture> {
        match self {
            Self::Picture(picture) => Some(picture),
            _ => None,
        }
    }

    fn check(&self, at: At) -> Result<()> {
        match self {
            Self::Even => Ok(()),
            Self::Land(land) => {
                let at = at.field("land");
                at.field("variation").number(land.variation, VARIATION)?;
                at.field("field_width").number(land.field_width, FIELDS)
            }
            Self::Picture(picture) => picture.check(at.field("picture")),
            Self::Water(water) => at.field("water").field("wind").number(water.wind, WIND),
        }
    }
}
