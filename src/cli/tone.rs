//! How light becomes a picture for screens: what all commands share that make some.

use clap::{Args, ValueEnum};

use crate::{
    Error, Result,
    scene::{Scene, Tone, ToneCurve},
};

/// Exposure and curve of pictures for screens.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct ToneOptions {
    /// Exposure in stops instead of the scene's (not for files that hold the light itself); with auto exposure
    /// it comes on top of what is metered.
    #[arg(long, value_name = "STOPS", value_parser = stops)]
    exposure: Option<f64>,
    /// Whether the light of the clouds tells the exposure, instead of what the scene says (not for files that
    /// hold the light itself).
    #[arg(long, value_name = "SWITCH", value_enum)]
    auto_exposure: Option<Switch>,
    /// Curve from light to the screen instead of the scene's (not for files that hold the light itself).
    #[arg(long, value_name = "CURVE", value_enum)]
    tone: Option<ToneName>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Switch {
    On,
    Off,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ToneName {
    /// Keeps hue and the texture of bright clouds, with the contrast of a photograph.
    Photo,
    /// Keeps hue and the texture of bright clouds.
    Natural,
    /// Like film: more contrast in the middle, highlights roll off.
    Filmic,
    /// Less contrast: shades in bright clouds stay apart.
    Soft,
    /// None: what is brighter than white is cut.
    Linear,
}

impl From<ToneName> for ToneCurve {
    fn from(name: ToneName) -> Self {
        match name {
            ToneName::Photo => Self::Photo,
            ToneName::Natural => Self::Natural,
            ToneName::Filmic => Self::Filmic,
            ToneName::Soft => Self::Soft,
            ToneName::Linear => Self::Linear,
        }
    }
}

/// Stops that a scene may have.
fn stops(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(stops) if (-20.0..=20.0).contains(&stops) => Ok(stops),
        _ => Err("give stops from -20 to 20".to_owned()),
    }
}

impl ToneOptions {
    /// Refuses words about screens where `file`, such as "EXR", is not for them.
    ///
    /// # Errors
    /// [`Error::Argument`] with the first of them.
    pub fn refuse_for(&self, file: &str) -> Result<()> {
        let given = [
            ("--exposure", self.exposure.is_some()),
            ("--auto-exposure", self.auto_exposure.is_some()),
            ("--tone", self.tone.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((word, _)) => Err(Error::Argument(format!(
                "{word} is for pictures of screens, and {file} holds the light itself: leave it out"
            ))),
            None => Ok(()),
        }
    }

    /// Whether pictures of `scene` are exposed by the light of their clouds.
    pub fn is_metered(&self, scene: &Scene) -> bool {
        self.auto_exposure.map_or_else(|| scene.is_metered(), |switch| switch == Switch::On)
    }

    /// Tone of `scene`, at its own time, where `metered` is what auto exposure adds, in stops.
    pub fn tone(&self, scene: &Scene, metered: Option<f64>) -> Tone {
        let own = scene.posed(scene.time).tone();
        Tone {
            stops: self.exposure.unwrap_or(own.stops) + metered.unwrap_or(0.0),
            curve: self.tone.map_or(own.curve, ToneCurve::from),
        }
    }
}

/// What was metered, as it is told.
pub(super) fn told(metered: f64) -> String {
    format!("auto exposure {metered:+.2} stops")
}
