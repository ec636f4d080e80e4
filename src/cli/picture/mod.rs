//! How pictures are drawn and written: what `nephos render` and `nephos sequence` share.

mod checks;
mod layers;
mod names;

use std::path::Path;

use clap::Args;

use super::{
    color::ColorOptions,
    numbers::{above_zero, share},
    open, stopped,
    tone::ToneOptions,
};
use crate::{
    Error, Result,
    export::{self, Header, LayerKind, Notes, Picture, Shutter},
    gpu::{Gpu, Timing},
    reference::Estimate,
    render::{Film, Frame, Quality, Renderer, Transport},
    scene::{Movement, Scene},
};
use names::TransportName;
pub(super) use names::{Format, QualityName, word};

/// What a picture is like.
#[derive(Debug, Clone, Args)]
pub struct PictureOptions {
    /// Width, pixels.
    #[arg(long, default_value_t = 960, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub(super) width: u32,
    /// Height, pixels.
    #[arg(long, default_value_t = 540, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub(super) height: u32,
    /// How much work to put in: final where left out. Path traced pictures have no quality.
    #[arg(long, value_enum)]
    quality: Option<QualityName>,
    /// How light inside clouds is found.
    #[arg(long, value_enum, default_value_t = TransportName(Some(Transport::default())))]
    transport: TransportName,
    /// Samples of each pixel, for `--transport path`: 96 where nothing else ends the picture.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..=1_000_000))]
    pub(super) spp: Option<u32>,
    /// Relative noise that is low enough, for `--transport path`: 0.02 is 2 %.
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(super) noise: Option<f64>,
    /// Time after which the picture is written as it is, for `--transport path`.
    #[arg(long, value_name = "S", value_parser = above_zero)]
    pub(super) seconds: Option<f64>,
    /// Rays across each pixel, for smooth edges; where left out, 2 in final quality and else 1. The picture
    /// may have 8192 rays across.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    supersample: Option<u32>,
    #[command(flatten)]
    pub(super) tone: ToneOptions,
    #[command(flatten)]
    color: ColorOptions,
    /// Write layers beside the beauty (EXR only): light, distance and normal, or those of the list behind
    /// `=`, such as --layers=light,depth,motion.
    #[arg(long, value_name = "LIST", value_enum, num_args = 0..=1, require_equals = true, value_delimiter = ',',
        default_missing_values = ["light", "distance", "normal"])]
    pub(super) layers: Option<Vec<LayerKind>>,
    /// Motion blur: the share of a frame for which the shutter is open, 0.5 being half of it; the frame's time is in the
    /// middle.
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(super) shutter: Option<f64>,
    /// Pictures that are averaged where the shutter is open or the camera has an aperture, 16 where left out; 1 is a
    /// pinhole.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: Option<u32>,
    /// Leave the sky out: clouds on a transparent ground.
    #[arg(long)]
    pub(super) transparent: bool,
    /// Ask each ellipsoid of every cloud: those of 256 and more are else drawn from a volume of
    /// depths.
    #[arg(long)]
    exact: bool,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
}

/// What draws: it outlives pictures, and what one leaves the next need not do again.
pub(super) struct Painter {
    pub gpu: Gpu,
    pub renderer: Renderer,
}

/// One picture to be drawn into a file.
pub(super) struct Job<'a> {
    /// What it shows, at its own time.
    pub scene: &'a Scene,
    /// The same as the device takes it: [`PictureOptions::frame`].
    pub frame: Frame,
    /// Frames per second.
    pub fps: f64,
    /// What is seen in the next frame, and how far clouds go until then, where that is asked for.
    pub next: Option<(Frame, Movement)>,
    /// What auto exposure adds to the scene's exposure, stops: [`PictureOptions::meter`].
    pub metered: Option<f64>,
    pub output: &'a Path,
    /// Whether a path traced picture goes on with what `output` holds.
    pub resume: bool,
    /// Whether a path traced picture is written on the way, too.
    pub keep: bool,
    /// What the file tells beside the pixels.
    pub notes: Notes,
}

/// A drawn picture, and what path tracing knows of it.
pub(super) struct Drawn {
    pub picture: Picture,
    pub estimate: Option<Estimate>,
    /// Whether it was stopped on the way.
    pub stopped: bool,
}

impl Painter {
    /// Whether passes are timed and work is counted from now on.
    pub fn count(&mut self, on: bool) {
        self.renderer.settings.counting = on;
        self.renderer.timing = on.then(|| Timing::new(&self.gpu));
    }
}

impl PictureOptions {
    /// What files of such pictures tell, as far as it is the same for all.
    pub fn notes(&self) -> Notes {
        self.color.notes()
    }

    /// What the file of a job tells: also by which camera, and how exposed, the scene is seen.
    fn noted(&self, job: &Job<'_>) -> Notes {
        let posed = job.scene.posed(job.scene.time);
        let aspect = f64::from(self.width) / f64::from(self.height);
        let header = Header {
            shutter: Some(Shutter { camera: posed.camera(), aspect }),
            exposure: Some(posed.exposure),
            ..job.notes.header.clone()
        };
        Notes { header, ..job.notes.clone() }
    }

    /// Opens the adapter.
    ///
    /// # Errors
    /// [`Error::Adapter`] where there is none of that name.
    pub fn painter(&self) -> Result<Painter> {
        let gpu = open(self.adapter.as_deref())?;
        Ok(Painter { renderer: self.renderer(&gpu), gpu })
    }

    /// A scene at its own time, with as many pixels as rays are wanted.
    ///
    /// # Errors
    /// Where the scene is not good.
    pub fn frame(&self, scene: &Scene) -> Result<Frame> {
        self.film().frame(scene)
    }

    fn renderer(&self, gpu: &Gpu) -> Renderer {
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
        renderer.settings.quality = self.quality().quality();
        if self.exact {
            renderer.settings.bake_from = u32::MAX;
        }
        // What is drawn beside a path traced picture has no clouds.
        renderer.settings.transport = self.transport.0.unwrap_or_default();
        renderer
    }

    /// Draws a picture and writes it, whole or not at all.
    ///
    /// # Errors
    /// Where the device or the file are not good.
    pub fn draw_to_file(
        &self,
        painter: &mut Painter,
        job: &Job<'_>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Option<Estimate>> {
        let unwritten =
            |error| stopped(error, || format!("nothing was written to `{}`", job.output.display()));
        if let Some(kinds) = &self.layers {
            return self.draw_layers(painter, job, kinds, progress).map_err(unwritten).map(|()| None);
        }
        let drawn = self.draw(painter, job, progress).map_err(unwritten)?;
        self.write(painter, job, &drawn).map_err(unwritten)?;
        match drawn.estimate {
            Some(estimate) if drawn.stopped => Err(Error::Stopped { kept: kept(job.output, &estimate) }),
            estimate => Ok(estimate),
        }
    }

    /// Draws a picture; writes nothing but what a path traced one keeps on the way.
    ///
    /// # Errors
    /// Where the device is not good, or the picture to go on with.
    pub fn draw(&self, painter: &mut Painter, job: &Job<'_>, progress: &mut dyn FnMut(f64)) -> Result<Drawn> {
        if self.traces_paths() {
            return self.trace(painter, job, progress);
        }
        let Painter { gpu, renderer } = painter;
        let (film, sky) = (self.film(), !self.transparent);
        let picture = match self.blur(job.scene, job.fps)? {
            Some(blur) => film.expose(gpu, renderer, job.scene, blur, sky, progress)?,
            None => film.take(gpu, renderer, &job.frame, sky, progress)?,
        };
        Ok(Drawn { picture, estimate: None, stopped: false })
    }

    /// Writes a drawn picture, whole or not at all.
    ///
    /// # Errors
    /// Where the device or the file are not good.
    pub fn write(&self, painter: &mut Painter, job: &Job<'_>, drawn: &Drawn) -> Result<()> {
        let picture = &drawn.picture;
        match (Format::of(job.output)?, &drawn.estimate) {
            (Format::Exr, Some(estimate)) => {
                export::write_estimate_noted(job.output, picture, estimate, job.scene, &self.noted(job))
            }
            (Format::Exr, None) => export::write_beauty_noted(job.output, picture, &self.noted(job)),
            (Format::Png, _) => {
                let bytes = self.finished(painter, picture, job)?;
                let size = [self.width, self.height];
                export::write_png_noted(job.output, size, &bytes, self.transparent, &job.notes)
            }
        }
    }

    /// The picture of a job as screens show it, RGBA of 8 bits.
    ///
    /// # Errors
    /// Where the device fails.
    pub(super) fn finished(
        &self,
        painter: &mut Painter,
        picture: &Picture,
        job: &Job<'_>,
    ) -> Result<Vec<u8>> {
        let tone = self.tone.tone(job.scene, job.metered);
        picture.finished(&painter.gpu, &mut painter.renderer, tone)
    }

    /// Auto exposure of a frame of `scene` in stops, where it has one. The picture finds its light made.
    ///
    /// # Errors
    /// Where the device fails.
    pub(super) fn meter(&self, painter: &mut Painter, scene: &Scene, frame: &Frame) -> Result<Option<f64>> {
        if self.traces_paths() {
            return self.meter_beside(painter, scene, frame);
        }
        let Painter { gpu, renderer } = painter;
        self.tone.is_metered(scene).then(|| renderer.meter(gpu, frame)).transpose()
    }

    /// The same where no picture follows that has use for the light: in preview quality at most.
    ///
    /// # Errors
    /// Where the device fails.
    pub(super) fn meter_beside(
        &self,
        painter: &mut Painter,
        scene: &Scene,
        frame: &Frame,
    ) -> Result<Option<f64>> {
        let own = painter.renderer.settings.quality;
        let coarser = if own.light_cells > Quality::PREVIEW.light_cells { Quality::PREVIEW } else { own };
        let Painter { gpu, renderer } = painter;
        renderer.settings.quality = coarser;
        let metered = self.tone.is_metered(scene).then(|| renderer.meter(gpu, frame)).transpose();
        renderer.settings.quality = own;
        metered
    }

    /// Puts in what was left out, so that the same picture is asked for by the same words.
    pub(super) fn fill_in(&mut self) {
        if !self.traces_paths() {
            (self.quality, self.supersample) = (Some(self.quality()), Some(self.film().rays()));
        }
    }

    fn quality(&self) -> QualityName {
        self.quality.unwrap_or(QualityName::Final)
    }

    /// With the rays that were asked for; by default those of the quality.
    fn film(&self) -> Film {
        let size = [self.width, self.height];
        match self.supersample {
            _ if self.traces_paths() => Film::new(size, 1),
            Some(rays) => Film::new(size, rays),
            None => Film::of_quality(size, &self.quality().quality()),
        }
    }

    pub(super) fn traces_paths(&self) -> bool {
        self.transport.0.is_none()
    }
}

/// What there is of a picture that was stopped, and how to go on.
fn kept(output: &Path, estimate: &Estimate) -> String {
    let so_far = format!("`{}` is whole, with {} samples a pixel", output.display(), estimate.samples);
    match Format::of(output) {
        Ok(Format::Exr) => so_far + "; the same command with --resume goes on",
        _ => so_far,
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::scene::Preset;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        picture: PictureOptions,
    }

    #[test]
    fn a_device_that_is_lost_ends_in_a_sentence_and_leaves_the_file_alone() {
        let words = ["", "--width", "16", "--height", "9", "--quality", "draft"];
        let options = Line::try_parse_from(words).unwrap().picture;
        let mut painter = options.painter().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("frame.0001.png");
        let scene = Preset::Sphere.scene(1);
        let frame = options.frame(&scene).unwrap();
        let notes = Notes::default();
        let job = Job {
            scene: &scene,
            frame,
            fps: 24.0,
            next: None,
            metered: None,
            output: &output,
            resume: false,
            keep: false,
            notes,
        };
        options.draw_to_file(&mut painter, &job, &mut |_| {}).unwrap();
        let whole = std::fs::read(&output).unwrap();
        painter.gpu.device.destroy();
        let error = options.draw_to_file(&mut painter, &job, &mut |_| {}).unwrap_err();
        assert!(matches!(error, Error::Gpu { .. }), "{error}");
        assert_eq!(std::fs::read(&output).unwrap(), whole);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
