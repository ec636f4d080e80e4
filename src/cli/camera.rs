//! Another camera than the scene's: what all commands share whose pictures are taken by one.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::{
    Result,
    import::read_camera,
    scene::{Camera, Scene},
};

/// A camera of another file.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct CameraOption {
    /// Take the camera of a glTF file instead of the scene's: FILE or, of several, FILE#NAME.
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
}

impl CameraOption {
    /// The scene as that camera sees it; the scene itself where none was named.
    pub fn see(&self, scene: Scene) -> Result<Scene> {
        match &self.camera {
            Some(file) => Ok(scene.seen_by(camera_of(file)?)),
            None => Ok(scene),
        }
    }
}

/// The camera of `FILE` or `FILE#NAME`; names of files and of cameras may hold `#`, too.
fn camera_of(named: &Path) -> Result<Camera> {
    let text = named.to_string_lossy();
    let parts = text.match_indices('#').map(|(at, _)| (Path::new(&text[..at]), &text[at + 1..]));
    let mut parts = parts.filter(|(file, _)| file.is_file() && !named.exists());
    match parts.next() {
        Some((file, name)) => read_camera(file, Some(name)),
        None => read_camera(named, None),
    }
}
