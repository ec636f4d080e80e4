//! `nephos new`: a scene to start from.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser, ValueParser};

use super::numbers::seed;
use super::terminal::print;
use crate::scene::{Preset, Scene};
use crate::{Error, Result};

/// Write a new scene file from a preset.
#[derive(Debug, Args)]
pub struct New {
    /// Kind of cloud.
    #[arg(long, value_name = "NAME", value_parser = preset_parser())]
    preset: Preset,
    /// Any whole number: other seeds give other clouds of the same kind.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// File to write; the standard output where left out or `-`.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite FILE where it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

impl New {
    /// Writes the scene.
    ///
    /// # Errors
    /// [`Error::Argument`] where the file exists and may not be overwritten,
    /// [`Error::File`] where it cannot be written.
    pub fn run(self) -> Result<()> {
        let scene = self.preset.scene(self.seed);
        match self.output.as_deref().filter(|path| *path != Path::new("-")) {
            None => print(&scene.to_json()),
            Some(path) => write(path, &scene, self.force),
        }
    }
}

/// Takes the names of the presets, lists them in the help, offers the nearest one.
fn preset_parser() -> ValueParser {
    PossibleValuesParser::new(Preset::ALL.map(Preset::name)).try_map(|name| name.parse::<Preset>()).into()
}

fn write(path: &Path, scene: &Scene, force: bool) -> Result<()> {
    if !force && path.exists() {
        return Err(Error::Argument(format!(
            "`{}` exists: give another name, or --force to overwrite it",
            path.display()
        )));
    }
    scene.save(path)
}
