//! `nephos export`: files for other programs, one file a kind.

mod camera;
mod flipbook;
mod impostor;
mod shadow;
mod sixway;
mod sky;
mod sprite;
mod volume;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::{
    numbers::number,
    open,
    sequence::frames::{Frames, numbered, set_fps},
    terminal,
};
use crate::{
    Error, Result,
    gpu::Gpu,
    scene::{Movement, Scene},
};

/// Write a scene for other programs: volumes, sky maps, sprites, cameras.
#[derive(Debug, Args)]
pub struct Export {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, Subcommand)]
enum Kind {
    Volume(volume::Volume),
    Sky(sky::Sky),
    Shadow(shadow::Shadow),
    Sixway(sixway::Sixway),
    Flipbook(flipbook::Flipbook),
    Impostor(impostor::Impostor),
    Camera(camera::Camera),
}

impl Export {
    /// Writes what was asked for.
    ///
    /// # Errors
    /// Where the scene, the arguments, the adapter or the file are not good.
    pub fn run(self) -> Result<()> {
        match self.kind {
            Kind::Volume(export) => export.run(),
            Kind::Sky(export) => export.run(),
            Kind::Shadow(export) => export.run(),
            Kind::Sixway(export) => export.run(),
            Kind::Flipbook(export) => export.run(),
            Kind::Impostor(export) => export.run(),
            Kind::Camera(export) => export.run(),
        }
    }
}

/// What every export takes.
#[derive(Debug, Args)]
struct Source {
    /// Scene file; `-` reads the standard input.
    scene: PathBuf,
    /// The moment to take, seconds since the scene's start; the scene's own `time` where left out.
    #[arg(long, value_name = "S", value_parser = number)]
    time: Option<f64>,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

impl Source {
    /// The scene as it is at that moment.
    fn scene(&self) -> Result<Scene> {
        let moment = |scene: Scene| {
            // A moment has no tracks that tell it.
            let auto_exposure = Some(scene.is_metered());
            Ok(Scene { auto_exposure, ..scene.at(self.time.unwrap_or(scene.time))? })
        };
        Scene::load(&self.scene).and_then(moment).map_err(|error| error.in_file(&self.scene))
    }

    /// The scene at its frames, by their numbers.
    fn moments(&self, frames: Option<&Frames>, fps: Option<f64>) -> Result<Vec<(i32, Scene)>> {
        let in_file = |error: Error| error.in_file(&self.scene);
        let mut scene = Scene::load(&self.scene).map_err(in_file)?;
        let fps = set_fps(&mut scene, fps).map_err(in_file)?;
        let all = numbered(&scene, frames, fps, &self.scene)?;
        all.into_iter().map(|(number, time)| Ok((number, scene.at(time).map_err(in_file)?))).collect()
    }

    /// How far clouds go in a frame from that moment on, and the frames of a second.
    fn movement(&self) -> Result<(Movement, f64)> {
        let in_file = |error: Error| error.in_file(&self.scene);
        let mut scene = Scene::load(&self.scene).map_err(in_file)?;
        let fps = set_fps(&mut scene, None).map_err(in_file)?;
        let time = self.time.unwrap_or(scene.time);
        Ok((scene.movement(time, 1.0 / fps).map_err(in_file)?, fps))
    }

    /// The same from each of the frames on.
    fn movements(&self, frames: Option<&Frames>, fps: Option<f64>) -> Result<Vec<(Movement, f64)>> {
        let in_file = |error: Error| error.in_file(&self.scene);
        let mut scene = Scene::load(&self.scene).map_err(in_file)?;
        let fps = set_fps(&mut scene, fps).map_err(in_file)?;
        let all = numbered(&scene, frames, fps, &self.scene)?;
        all.into_iter()
            .map(|(_, time)| Ok((scene.movement(time, 1.0 / fps).map_err(in_file)?, fps)))
            .collect()
    }

    fn gpu(&self) -> Result<Gpu> {
        open(self.adapter.as_deref())
    }
}

/// Does work that tells the share done, under a bar.
fn shares<T>(message: &'static str, work: impl FnOnce(&mut dyn FnMut(f64)) -> Result<T>) -> Result<T> {
    let bar = terminal::share(message);
    let done = work(&mut |share| bar.set(share));
    bar.finish();
    done
}

/// The ending of a file's name, in small letters, where it is one of `endings`.
fn ending<'a>(path: &Path, endings: &[&'a str]) -> Result<&'a str> {
    let found = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    endings.iter().find(|ending| **ending == found).copied().ok_or_else(|| {
        let list: Vec<_> = endings.iter().map(|ending| format!(".{ending}")).collect();
        Error::Argument(format!(
            "`{}` does not end in {}: name one of these, the ending says what is written",
            path.display(),
            list.join(" or ")
        ))
    })
}
