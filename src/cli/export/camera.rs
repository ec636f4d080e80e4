//! `nephos export camera`: the scene's camera for 3-D programs.

use std::path::PathBuf;

use clap::Args;

use super::{
    super::numbers::{above_zero, number},
    ending,
};
use crate::{Result, export::write_camera, scene::Scene};

/// Write the scene's camera as glTF, which Blender, Houdini, Unreal, Unity and Godot import.
///
/// Metres, Y up; Blender turns it to Z up by itself. `nephos render --camera` takes such files back.
#[derive(Debug, Args)]
pub struct Camera {
    /// Scene file; `-` reads the standard input.
    scene: PathBuf,
    /// The moment to take, seconds since the scene's start; the scene's own `time` where left out.
    #[arg(long, value_name = "S", value_parser = number)]
    time: Option<f64>,
    /// Camera to write: .glb or .gltf.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Width over height of the pictures that it is for.
    #[arg(long, value_name = "RATIO", default_value_t = 16.0 / 9.0, value_parser = above_zero)]
    aspect: f64,
}

impl Camera {
    pub(super) fn run(self) -> Result<()> {
        ending(&self.output, &["glb", "gltf"])?;
        let scene = Scene::load(&self.scene).map_err(|error| error.in_file(&self.scene))?;
        let scene = scene.posed(self.time.unwrap_or(scene.time));
        write_camera(&self.output, &scene.camera(), self.aspect)
    }
}
