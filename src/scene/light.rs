//! Lights beside the sun: a moon, an artist's key or rim light, lightning in a cloud.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Sun;
use super::validate::{At, COORDINATE, Limits};
use crate::Result;

/// Most lights beside the sun: each has the clouds marched once more.
pub const MAX_LIGHTS: usize = 4;

const IRRADIANCE: Limits = Limits::new(0.0, 1e6, "");
const RADIUS: Limits = Limits::new(1.0, 1e5, "metres");

/// A light beside the sun. Light adds up: a scene with two lights is the sum of its pictures with each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Light {
    /// A name for people, and for the layers of EXR files: `light.NAME`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// What shines.
    pub source: LightSource,
    /// Whether it is switched off.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hidden: bool,
}

/// What shines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LightSource {
    /// A second sun, such as a moon: it lights air, ground and clouds, has a disc and casts shadows. A full moon has
    /// the irradiance of the sun times 0.0000025.
    Moon(Sun),
    /// A light of the artist's, such as a key or a rim light: from one side on clouds alone, which have its
    /// irradiance as it is, whatever air is above them. It has no disc.
    Key(Sun),
    /// A flash in a cloud: it shines from all points of a ball to all sides, and what scatters it is the cloud that
    /// it is in. It is not seen itself.
    Lightning(Lightning),
}

/// A ball that shines to all sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Lightning {
    /// Its centre [x, y, z], metres.
    #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    pub position: DVec3,
    /// Its radius, metres, 1 to 100000.
    #[schemars(range(min = RADIUS.min, max = RADIUS.max), extend("unit" = RADIUS.unit))]
    pub radius: f64,
    /// Linear RGB irradiance, each 0 to 1000000, that it would have at its radius were the air clear, in the unit of
    /// the sun's: its power over the area of its ball.
    #[schemars(inner(range(min = IRRADIANCE.min, max = IRRADIANCE.max)))]
    pub irradiance: [f64; 3],
}

impl Default for Lightning {
    /// Two hundred metres wide and about as bright as the sun there, bluish: what is around it is white, the rest of a
    /// cloud of a kilometre glows.
    fn default() -> Self {
        Self { position: DVec3::new(0.0, 1500.0, 0.0), radius: 100.0, irradiance: [0.9, 1.0, 1.3] }
    }
}

impl Light {
    /// What it is called: its name, or what it is and its `number` among the lights.
    pub fn label(&self, number: usize) -> String {
        if self.name.is_empty() { format!("{}{}", self.source.kind(), number + 1) } else { self.name.clone() }
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        let source = at.field("source");
        match &self.source {
            LightSource::Moon(sun) => sun.check(source.field("moon")),
            LightSource::Key(sun) => sun.check(source.field("key")),
            LightSource::Lightning(flash) => flash.check(source.field("lightning")),
        }
    }
}

impl LightSource {
    /// What it is, in a word, as files write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Moon(_) => "moon",
            Self::Key(_) => "key",
            Self::Lightning(_) => "lightning",
        }
    }

    /// Where it stands and how bright it is, if it is far away.
    pub fn as_sun_mut(&mut self) -> Option<&mut Sun> {
        match self {
            Self::Moon(sun) | Self::Key(sun) => Some(sun),
            Self::Lightning(_) => None,
        }
    }

    /// Linear RGB irradiance.
    pub fn irradiance(&self) -> [f64; 3] {
        match self {
            Self::Moon(sun) | Self::Key(sun) => sun.irradiance,
            Self::Lightning(flash) => flash.irradiance,
        }
    }
}

impl Lightning {
    fn check(&self, at: At) -> Result<()> {
        at.field("position").numbers(&self.position.to_array(), COORDINATE)?;
        at.field("radius").number(self.radius, RADIUS)?;
        at.field("irradiance").numbers(&self.irradiance, IRRADIANCE)
    }
}

/// What files call the light of the sun and of the sky.
const TAKEN: [&str; 2] = ["sun", "sky"];

fn is_usual(character: char) -> bool {
    character.is_ascii_alphanumeric() || " -_".contains(character)
}

/// Checks the lights of a scene at `at`.
pub(super) fn check(lights: &[Light], at: At) -> Result<()> {
    if lights.len() > MAX_LIGHTS {
        return Err(at.problem(format!(
            "{} lights are too many: expected at most {MAX_LIGHTS} beside the sun",
            lights.len()
        )));
    }
    for (i, light) in lights.iter().enumerate() {
        let at = at.index(i);
        light.check(at)?;
        let (name, label) = (at.field("name"), light.label(i));
        if let Some(found) = label.chars().find(|c| !is_usual(*c)) {
            return Err(name.problem(format!(
                "`{label}` has `{}`, which names of layers in EXR files can't have: take letters without accents, \
                 digits, spaces, `-` and `_`",
                found.escape_debug()
            )));
        }
        let others = lights[..i].iter().enumerate().map(|(number, other)| other.label(number));
        if others.chain(TAKEN.map(str::to_owned)).any(|other| other == label) {
            return Err(name.problem(format!("another light is called `{label}`: give it a name of its own")));
        }
    }
    Ok(())
}
