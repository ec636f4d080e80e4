//! What values of options are called on the command line.

use std::{path::Path, sync::LazyLock};

use clap::{ValueEnum, builder::PossibleValue};

use crate::{
    Error, Result,
    export::LayerKind,
    render::{Quality, Transport},
};

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(in crate::cli) enum QualityName {
    Draft,
    Preview,
    Final,
}

impl QualityName {
    pub(in crate::cli) fn quality(self) -> Quality {
        match self {
            Self::Draft => Quality::DRAFT,
            Self::Preview => Quality::PREVIEW,
            Self::Final => Quality::FINAL,
        }
    }
}

/// A model of light, or none for the path tracer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TransportName(pub Option<Transport>);

impl ValueEnum for TransportName {
    fn value_variants<'a>() -> &'a [Self] {
        static ALL: LazyLock<Vec<TransportName>> =
            LazyLock::new(|| Transport::all().map(Some).chain([None]).map(TransportName).collect());
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self.0 {
            Some(transport) => PossibleValue::new(transport.name()).help(transport.about()),
            None => PossibleValue::new("path")
                .help("Truth by Monte Carlo: slow, without bias, with noise that --spp lowers"),
        })
    }
}

/// A value as the command line writes it.
pub(in crate::cli) fn word(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

impl ValueEnum for LayerKind {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Light, Self::Distance, Self::Normal, Self::Depth, Self::Position, Self::Motion, Self::Clouds]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, what) = match self {
            Self::Light => {
                ("light", "What the beauty is the sum of, and the light of clouds by what it comes from")
            }
            Self::Distance => ("distance", "depth.Z: distance from the eye, metres"),
            Self::Normal => ("normal", "Which way the cloud faces"),
            Self::Depth => ("depth", "planar.Z: distance along the camera's axis, metres"),
            Self::Position => ("position", "Where in the world what is seen is, metres"),
            Self::Motion => ("motion", "How far it goes until the next frame, pixels right and up"),
            Self::Clouds => ("clouds", "Cryptomatte: which clouds there are, and how much each one hides"),
        };
        Some(PossibleValue::new(name).help(what))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cli) enum Format {
    Png,
    Exr,
}

impl Format {
    pub(in crate::cli) fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match extension.as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(Error::Argument(format!(
                "`{}` ends in neither .png nor .exr: name one of these, the ending says what is written",
                path.display()
            ))),
        }
    }
}
