//! `nephos export sky`: the whole sky around the camera.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{
    super::{
        camera::CameraOption,
        color::ColorOptions,
        picture::{QualityName, word},
        terminal,
        tone::{ToneOptions, told},
    },
    Source, ending, shares,
};
use crate::{
    Error, Result,
    export::{
        FACES, Notes, Picture, Studio, cube_faces, equirectangular, meter_around, write_beauty_noted,
        write_hdr, write_ktx2, write_png,
    },
    files::check_place,
    scene::{Scene, Tone},
};

/// Write the sky around the camera's position, clouds, sun and ground, for a game's backdrop or a
/// film's light dome.
///
/// Faces of a cube are called px, nx, py, ny, pz, nz and follow one another in that order, as Direct3D, Vulkan,
/// Unity and Unreal have them: +x is east, +y up, +z north. An equirectangular map has north in the middle
/// and east to the right of it.
#[derive(Debug, Args)]
pub struct Sky {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    camera: CameraOption,
    #[command(flatten)]
    tone: ToneOptions,
    #[command(flatten)]
    color: ColorOptions,
    /// Map to write: .exr and .hdr hold linear light, .png is tone-mapped, .ktx2 is a cube map in BC6H
    /// with mip levels that GPUs take as it is.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// How the sphere is laid out: equirectangular where left out, but a .ktx2 file always holds the faces
    /// of a cube.
    #[arg(long, value_enum)]
    layout: Option<Layout>,
    /// How much work to put in: final where left out.
    #[arg(long, value_enum)]
    quality: Option<QualityName>,
    /// Height of the map, pixels: a face's edge for cubes. 1024 for equirectangular maps, 512 for cubes.
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(4..=4096))]
    size: Option<u32>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Layout {
    /// Longitude across, latitude upwards, twice as wide as high.
    Equirectangular,
    /// Six files, one a face: NAME.px.EXT to NAME.nz.EXT.
    Cubemap,
    /// One file with the six faces of a cube side by side.
    Strip,
}

impl Sky {
    pub(super) fn run(self) -> Result<()> {
        let kind = ending(&self.output, &["exr", "hdr", "png", "ktx2"])?;
        let layout = self.layout(kind)?;
        if kind != "exr" {
            self.color.refuse_for(&format!("a .{kind} file"))?;
        }
        if kind != "png" {
            self.tone.refuse_for(&format!("a .{kind} file"))?;
        }
        self.files(kind, layout).iter().try_for_each(|file| check_place(file))?;
        let scene = self.camera.see(self.source.scene()?)?;
        let mut studio = Studio::new(&self.source.gpu()?, 2, true);
        studio.renderer().settings.quality = self.quality.unwrap_or(QualityName::Final).quality();
        let tone = self.exposed(kind, &mut studio, &scene)?;
        let notes = self.color.notes();
        if layout == Layout::Equirectangular {
            let map = equirectangular(&mut studio, &scene, self.size.unwrap_or(1024))?;
            return write(&self.output, kind, &mut studio, (tone, &notes), &map);
        }
        let size = self.size.unwrap_or(512);
        if kind == "ktx2" && !size.is_multiple_of(4) {
            return Err(Error::Argument(format!("--size {size} is no multiple of 4, as BC6H needs it")));
        }
        let faces = shares("rendering", |progress| cube_faces(&mut studio, &scene, size, progress))?;
        match layout {
            _ if kind == "ktx2" => write_ktx2(&self.output, &faces),
            Layout::Strip => {
                write(&self.output, kind, &mut studio, (tone, &notes), &Picture::in_rows(&faces, 6))
            }
            _ => self
                .files(kind, layout)
                .iter()
                .zip(&faces)
                .try_for_each(|(file, face)| write(file, kind, &mut studio, (tone, &notes), face)),
        }
    }

    /// What is written: faces have files of their own, but for KTX 2.
    fn files(&self, kind: &str, layout: Layout) -> Vec<PathBuf> {
        if layout != Layout::Cubemap || kind == "ktx2" {
            return vec![self.output.clone()];
        }
        FACES.iter().map(|(name, ..)| self.output.with_extension(format!("{name}.{kind}"))).collect()
    }

    /// How all faces become pictures for screens: one exposure, by the whole sphere. Tells it.
    fn exposed(&self, kind: &str, studio: &mut Studio, scene: &Scene) -> Result<Tone> {
        if kind != "png" || !self.tone.is_metered(scene) {
            return Ok(self.tone.tone(scene, None));
        }
        let metered = meter_around(studio, scene)?;
        terminal::print(&format!("{}: {}\n", self.output.display(), told(metered)))?;
        Ok(self.tone.tone(scene, Some(metered)))
    }

    /// As asked for, where a file of this kind can hold it.
    fn layout(&self, kind: &str) -> Result<Layout> {
        match (kind, self.layout) {
            ("ktx2", Some(layout @ (Layout::Equirectangular | Layout::Strip))) => {
                Err(Error::Argument(format!(
                    "--layout {} is not for .ktx2 files, which hold the faces of a cube: leave it out, or write .exr, \
                 .hdr or .png",
                    word(layout)
                )))
            }
            ("ktx2", _) => Ok(Layout::Cubemap),
            (_, layout) => Ok(layout.unwrap_or(Layout::Equirectangular)),
        }
    }
}

fn write(
    path: &Path,
    kind: &str,
    studio: &mut Studio,
    (tone, notes): (Tone, &Notes),
    picture: &Picture,
) -> Result<()> {
    match kind {
        "exr" => write_beauty_noted(path, picture, notes),
        "hdr" => write_hdr(path, picture),
        _ => {
            let gpu = studio.gpu().clone();
            let bytes = picture.finished(&gpu, studio.renderer(), tone)?;
            write_png(path, [picture.width as u32, picture.height as u32], &bytes, false)
        }
    }
}
