//! What `flipbook`, `sixway` and `impostor` have in common.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{
    super::{
        camera::CameraOption,
        color::ColorOptions,
        numbers::{above_zero, at_least_zero},
        picture::QualityName,
        tone::{ToneOptions, told},
    },
    Source, ending,
};
use crate::{
    Error, Result,
    export::{
        Course, Notes, Picture, Studio, Subject, atlas, bled, write_beauty, write_beauty_noted, write_png,
    },
    files::check_place,
    render::{Film, metered_alone},
    scene::Scene,
};

/// The cloud and its tiles.
#[derive(Debug, Args)]
pub(super) struct Sprite {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    pub tone: ToneOptions,
    #[command(flatten)]
    pub color: ColorOptions,
    /// File to write, .png or .exr; further maps of it have its name and an underscore.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Name or number, from 0, of the cloud; all clouds where left out.
    #[arg(long, value_name = "NAME")]
    cloud: Option<String>,
    /// How much work to put in: final where left out.
    #[arg(long, value_enum)]
    quality: Option<QualityName>,
    /// Edge of a tile, pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = 256, value_parser = clap::value_parser!(u32).range(8..=4096))]
    pub tile: u32,
}

/// How the cloud changes from tile to tile.
#[derive(Debug, Args)]
pub(super) struct Frames {
    /// Tiles across the atlas; left out, it is as near to a square as it can be.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    columns: Option<u32>,
    /// Way of the noise through the cloud, once round a circle: billows form and dissolve, and the last
    /// frame leads into the first. Left out, it is two of the largest billows; 0 keeps the shape.
    #[arg(long, value_name = "METRES", value_parser = at_least_zero)]
    travel: Option<f64>,
    /// How often the cloud turns about the vertical, in light that stands still.
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(i32).range(-64..=64))]
    pub turns: i32,
    /// Seconds of the scene that go by: its wind carries the cloud through the noise. Frames don't close to a
    /// loop then, and the noise goes round no circle.
    #[arg(long, value_name = "S", value_parser = above_zero, conflicts_with = "travel")]
    seconds: Option<f64>,
}

/// A sprite's scene, subject and studio.
pub(super) struct Stage {
    pub kind: &'static str,
    pub scene: Scene,
    tone: ToneOptions,
    notes: Notes,
    pub subject: Subject,
    pub studio: Studio,
}

impl Sprite {
    /// Opens all that is needed for an atlas of `columns` by `rows` tiles, to be written into `files`.
    pub fn stage(&self, seen: &CameraOption, [columns, rows]: [u32; 2], files: &[PathBuf]) -> Result<Stage> {
        let kind = ending(&self.output, &["png", "exr"])?;
        match kind {
            "exr" => self.tone.refuse_for("EXR")?,
            _ => self.color.refuse_for("PNG")?,
        }
        let edge = self.tile * columns.max(rows);
        if edge > Film::WIDEST {
            return Err(Error::Argument(format!(
                "{columns} by {rows} tiles of {} pixels are {edge} pixels across, more than {}: take fewer \
                 or smaller ones",
                self.tile,
                Film::WIDEST
            )));
        }
        files.iter().try_for_each(|file| check_place(file))?;
        let scene = seen.see(self.source.scene()?)?;
        let subject = Subject::new(&scene, self.cloud.as_deref())?;
        let mut studio = Studio::new(&self.source.gpu()?, 2, false);
        studio.renderer().settings.quality = self.quality.unwrap_or(QualityName::Final).quality();
        Ok(Stage { kind, subject, studio, scene, tone: self.tone.clone(), notes: self.color.notes() })
    }

    /// The output's name with `map` behind it.
    pub fn named(&self, map: &str) -> PathBuf {
        let mut name = self.output.file_stem().unwrap_or_default().to_owned();
        name.push(format!("_{map}"));
        if let Some(ending) = self.output.extension() {
            name.push(".");
            name.push(ending);
        }
        self.output.with_file_name(name)
    }
}

impl Frames {
    /// No word may be without effect for so many frames.
    pub fn check(&self, frames: u32) -> Result<()> {
        let given = [
            ("--travel", self.travel.is_some()),
            ("--turns", self.turns != 0),
            ("--seconds", self.seconds.is_some()),
        ];
        let problem = match (given.into_iter().find(|(_, given)| *given), self.columns) {
            (Some((word, _)), _) if frames == 1 => {
                format!("{word} is for several frames: give --frames 2 or more, or leave it out")
            }
            (_, Some(columns)) if columns > frames => {
                format!("--columns {columns} is more than the {frames} frames: give {frames} at most")
            }
            _ => return Ok(()),
        };
        Err(Error::Argument(problem))
    }

    pub fn columns(&self, frames: u32) -> u32 {
        self.columns.unwrap_or_else(|| atlas::columns(frames))
    }

    pub fn course(&self, scene: &Scene) -> Course {
        let circle = if self.seconds.is_some() { 0.0 } else { 2.0 * scene.largest_billows() };
        let travel = self.travel.unwrap_or(circle);
        Course { travel, turns: self.turns, seconds: self.seconds.unwrap_or(0.0) }
    }
}

impl Stage {
    /// Writes light: tone-mapped where the file is a PNG, and exposed by all tiles together. Tells how.
    pub fn write_light(&mut self, path: &Path, picture: &Picture) -> Result<String> {
        if self.kind == "exr" {
            return write_beauty_noted(path, picture, &self.notes).map(|()| String::new());
        }
        let metered = self.tone.is_metered(&self.scene).then(|| metered_alone(picture));
        let gpu = self.studio.gpu().clone();
        let tone = self.tone.tone(&self.scene, metered);
        let bytes = picture.finished(&gpu, self.studio.renderer(), tone)?;
        write_png(path, size(picture), &bytes, true)?;
        Ok(metered.map_or_else(String::new, |metered| format!(", {}", told(metered))))
    }

    /// Writes shares from 0 to 1, as they are in both kinds of files, and those of the nearest pixels that are
    /// seen where none is.
    pub fn write_shares(&self, path: &Path, picture: &Picture) -> Result<()> {
        let picture = bled(picture);
        match self.kind {
            "exr" => write_beauty(path, &picture),
            _ => write_png(path, size(&picture), &atlas::bytes(&picture), true),
        }
    }
}

pub(super) fn size(picture: &Picture) -> [u32; 2] {
    [picture.width as u32, picture.height as u32]
}
