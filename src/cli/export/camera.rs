//! `nephos export camera`: the scene's camera for 3-D programs.

use std::path::PathBuf;

use clap::Args;

use super::{
    super::{
        numbers::{above_zero, number},
        sequence::frames::{self, Frames, numbered, set_fps},
    },
    ending,
};
use crate::{
    Error, Result,
    export::{write_camera, write_moving_camera},
    scene::Scene,
};

/// Write the scene's camera as glTF, which Blender, Houdini, Unreal, Unity and Godot import.
///
/// Metres, Y up; Blender turns it to Z up by itself. `nephos render --camera` takes such files back. With `--animated`
/// or `--frames` it moves as in the scene, with a key a frame; frame 1 is at 0 seconds.
#[derive(Debug, Args)]
pub struct Camera {
    /// Scene file; `-` reads the standard input.
    scene: PathBuf,
    /// The moment to take, seconds since the scene's start; the scene's own `time` where left out.
    #[arg(long, value_name = "S", value_parser = number)]
    time: Option<f64>,
    /// Let it move, over all of the timeline.
    #[arg(long, conflicts_with = "time")]
    animated: bool,
    /// Let it move over these frames, such as 1-240.
    #[arg(long, value_name = "RANGE", conflicts_with = "time")]
    frames: Option<Frames>,
    /// Keys per second, such as 24 or 24000/1001; the timeline's where left out, or else 24.
    #[arg(long, value_name = "N", value_parser = frames::rate)]
    fps: Option<f64>,
    /// Camera to write: .glb, or .gltf of one that stands still.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Width over height of the pictures that it is for.
    #[arg(long, value_name = "RATIO", default_value_t = 16.0 / 9.0, value_parser = above_zero)]
    aspect: f64,
}

impl Camera {
    pub(super) fn run(self) -> Result<()> {
        ending(&self.output, &["glb", "gltf"])?;
        let mut scene = Scene::load(&self.scene).map_err(|error| error.in_file(&self.scene))?;
        if self.animated || self.frames.is_some() {
            let fps = set_fps(&mut scene, self.fps).map_err(|error| error.in_file(&self.scene))?;
            return self.moving(&scene, fps);
        }
        if let Some(fps) = self.fps {
            return Err(Error::Argument(format!(
                "--fps {fps} is for cameras that move: add --animated or --frames"
            )));
        }
        let scene = scene.posed(self.time.unwrap_or(scene.time));
        write_camera(&self.output, &scene.camera(), self.aspect)
    }

    fn moving(&self, scene: &Scene, fps: f64) -> Result<()> {
        let frames = numbered(scene, self.frames.as_ref(), fps, &self.scene)?;
        // In a loop times begin anew, keys go on.
        let key = |(number, time): (i32, f64)| (f64::from(number - 1) / fps, scene.posed(time).camera());
        let mut keys: Vec<_> = frames.into_iter().map(key).collect();
        keys.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        write_moving_camera(&self.output, &keys, self.aspect)
    }
}
