//! How far a picture of the viewport has come.

use serde::{Deserialize, Serialize};

use crate::render::Quality;

/// How far the picture has come.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// As it was drawn while something moved.
    Moving,
    /// Every pixel, in preview quality.
    Preview,
    /// Final quality: as `nephos render` draws it.
    #[default]
    Final,
}

impl Stage {
    /// The quality that it is drawn in.
    pub fn quality(self) -> Quality {
        match self {
            Self::Moving => Quality::DRAFT,
            Self::Preview => Quality::PREVIEW,
            Self::Final => Quality::FINAL,
        }
    }

    /// The name of that quality.
    pub fn name(self) -> &'static str {
        match self {
            Self::Moving => "draft",
            Self::Preview => "preview",
            Self::Final => "final",
        }
    }
}
