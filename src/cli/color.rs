//! What the numbers of files that hold light mean: what all commands share that write some.

use clap::{Args, ValueEnum};

use super::numbers::above_zero;
use crate::{
    Error, Result,
    export::{ColorSpace, Header, Notes},
};

/// Colours of EXR files.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct ColorOptions {
    /// Primaries and white of the light in EXR files: rec709 where left out.
    #[arg(long, value_name = "SPACE", value_enum)]
    color_space: Option<SpaceName>,
    /// Luminance of the light 1, 1, 1 in candelas per square metre, for the header of EXR files; it changes no
    /// pixel.
    #[arg(long, value_name = "NITS", value_parser = above_zero)]
    white_luminance: Option<f64>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SpaceName {
    /// Linear light of the primaries of Rec. 709 and sRGB, white D65.
    Rec709,
    /// ACEScg: linear light of the primaries AP1, white of ACES.
    Acescg,
}

impl ColorOptions {
    /// Refuses words about light where `file`, such as "PNG", holds none.
    ///
    /// # Errors
    /// [`Error::Argument`] with the first of them.
    pub fn refuse_for(&self, file: &str) -> Result<()> {
        let given = [
            ("--color-space", self.color_space.is_some()),
            ("--white-luminance", self.white_luminance.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((word, _)) => Err(Error::Argument(format!(
                "{word} says what the light in .exr files is, and {file} holds none: leave it out"
            ))),
            None => Ok(()),
        }
    }

    /// What the header says of the light.
    pub fn header(&self) -> Header {
        let color = match self.color_space {
            Some(SpaceName::Acescg) => ColorSpace::AcesCg,
            _ => ColorSpace::Rec709,
        };
        Header { color: Some(color), white_luminance: self.white_luminance, ..Header::default() }
    }

    /// The same as notes of a file.
    pub fn notes(&self) -> Notes {
        Notes { header: self.header(), ..Notes::default() }
    }
}
