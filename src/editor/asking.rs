//! What the editor asks before it goes on.

use std::path::PathBuf;

use super::{choosing::Choosing, dialogs::Shortcuts, palette::Palette, recovery::Kept};
use crate::scene::Preset;

/// What is open over everything else.
#[derive(Debug)]
pub(super) enum Dialog {
    Welcome,
    Recover(Vec<Kept>),
    Unsaved(Then),
    Changed,
    Overwrite(Option<Then>),
    Choosing(Choosing, Option<Then>),
    Job,
    Palette(Palette),
    Shortcuts(Shortcuts),
    About,
}

/// What is done once there is nothing to lose.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Then {
    New,
    NewFrom(Preset),
    ChooseFile,
    Open(PathBuf),
    Close,
}
