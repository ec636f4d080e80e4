//! How scene light becomes a picture for screens.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The curve from scene light to what a screen shows. EXR files hold scene light itself and
/// have none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ToneCurve {
    /// Like film: more contrast in the middle, highlights roll off.
    Filmic,
    /// Less contrast: shades in bright clouds stay apart.
    Soft,
    /// None: what is brighter than white is cut, for measuring and for other tools.
    Linear,
    /// Keeps hue and the texture of bright clouds: low suns turn orange and rose, not yellow.
    Natural,
    /// The same with the contrast of a photograph.
    #[default]
    Photo,
}

/// Exposure and curve of a picture for screens.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tone {
    /// Exposure in stops.
    pub stops: f64,
    /// The curve.
    pub curve: ToneCurve,
}

impl Tone {
    /// The same for light of which 1 stands for so much.
    #[must_use]
    pub fn in_unit(self, unit: f32) -> Self {
        Self { stops: self.stops + f64::from(unit).log2(), ..self }
    }
}
