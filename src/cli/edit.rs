//! `nephos edit`: the editor in a window.

use std::path::PathBuf;

use clap::Args;

use crate::{Result, editor};

/// Edit a scene in a window; also what the program does alone, on a desktop.
#[derive(Debug, Default, Args)]
pub struct Edit {
    /// Scene file to open.
    scene: Option<PathBuf>,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

impl Edit {
    /// Opens the window; returns when it is closed.
    ///
    /// # Errors
    /// Where there is no window or no adapter to be had.
    pub fn run(self) -> Result<()> {
        editor::run(self.scene, self.adapter, super::jobs::program())
    }
}
