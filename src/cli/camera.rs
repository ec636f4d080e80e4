//! Another camera than the scene's: what all commands share whose pictures are taken by one.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::{Result, import::MovingCamera, scene::Scene};

/// A camera of another file.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct CameraOption {
    /// Take the camera of a glTF file instead of the scene's: FILE or, of several, FILE#NAME. Where it is
    /// animated, it is where it is at the time of the frame.
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
}

impl CameraOption {
    /// The scene as that camera sees it at the scene's time; the scene itself where none was named.
    pub fn see(&self, scene: Scene) -> Result<Scene> {
        match &self.camera {
            Some(file) => Ok(scene.seen_by(camera_of(file)?.at(scene.time))),
            None => Ok(scene),
        }
    }

    /// The same over time: with its ways, where it moves.
    pub fn see_over_time(&self, scene: Scene, fps: f64) -> Result<Scene> {
        let Some(file) = &self.camera else { return Ok(scene) };
        let camera = camera_of(file)?;
        match camera.length() {
            0.0 => Ok(scene.seen_by(camera.at(0.0))),
            length => scene.seen_over_time(fps, length, |time| camera.at(time)),
        }
    }
}

/// The camera of `FILE` or `FILE#NAME`; names of files and of cameras may hold `#`, too.
fn camera_of(named: &Path) -> Result<MovingCamera> {
    let text = named.to_string_lossy();
    let parts = text.match_indices('#').map(|(at, _)| (Path::new(&text[..at]), &text[at + 1..]));
    let mut parts = parts.filter(|(file, _)| file.is_file() && !named.exists());
    match parts.next() {
        Some((file, name)) => MovingCamera::read(file, Some(name)),
        None => MovingCamera::read(named, None),
    }
}
