//! How pictures are drawn and written: what `nephos render` and `nephos sequence` share.

use std::{path::Path, sync::LazyLock};

use clap::{Args, ValueEnum, builder::PossibleValue};

use super::{
    color::ColorOptions,
    numbers::{above_zero, share},
    open, stopped,
    tone::ToneOptions,
};
use crate::{
    Error, Result,
    export::{self, Header, LayerKind, Layered, Notes, Picture, Shutter},
    gpu::{Gpu, Timing},
    reference::Estimate,
    render::{Blur, Film, Frame, Quality, Renderer, Transport},
    scene::{Movement, Scene},
};

/// Pictures that a blurred one is the mean of, where nobody says how many.
const SAMPLES: u32 = 16;

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
    pub(super) layers: Option<Vec<LayerName>>,
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

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum QualityName {
    Draft,
    Preview,
    Final,
}

impl QualityName {
    pub(super) fn quality(self) -> Quality {
        match self {
            Self::Draft => Quality::DRAFT,
            Self::Preview => Quality::PREVIEW,
            Self::Final => Quality::FINAL,
        }
    }
}

/// A kind of layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum LayerName {
    /// What the beauty is the sum of, and the light of clouds by what it comes from
    Light,
    /// depth.Z: distance from the eye, metres
    Distance,
    /// Which way the cloud faces
    Normal,
    /// planar.Z: distance along the camera's axis, metres
    Depth,
    /// Where in the world what is seen is, metres
    Position,
    /// How far it goes until the next frame, pixels right and up
    Motion,
    /// Cryptomatte: which clouds there are, and how much each one hides
    Clouds,
}

impl LayerName {
    fn kind(self) -> LayerKind {
        match self {
            Self::Light => LayerKind::Light,
            Self::Distance => LayerKind::Distance,
            Self::Normal => LayerKind::Normal,
            Self::Depth => LayerKind::Depth,
            Self::Position => LayerKind::Position,
            Self::Motion => LayerKind::Motion,
            Self::Clouds => LayerKind::Clouds,
        }
    }
}

/// A model of light, or none for the path tracer.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TransportName(Option<Transport>);

impl ValueEnum for TransportName {
    fn value_variants<'a>() -> &'a [Self] {
        static ALL: LazyLock<Vec<TransportName>> =
            LazyLock::new(|| Transport::all().map(Some).chain([None]).map(TransportName).collect());
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self.0 {
            Some(transport) => PossibleValue::new(transport.name()).help(transport.about()),
            None => PossibleValue::new("path")
                .help("Truth by Monte Carlo: slow, without bias, with noise that --spp lowers"),
        })
    }
}

/// A value as the command line writes it.
pub(super) fn word(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
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
    /// Whether such a picture can be drawn into a file of this format.
    ///
    /// # Errors
    /// Where words do not go together.
    pub fn check(&self, format: Format) -> Result<()> {
        if self.layers.is_some() && format != Format::Exr {
            return Err(Error::Argument("--layers needs an output that ends in .exr".to_owned()));
        }
        match format {
            Format::Exr => self.tone.refuse_for("EXR")?,
            Format::Png => self.color.refuse_for("PNG")?,
        }
        self.check_transport()?;
        self.check_blur()?;
        self.check_rays()
    }

    /// No word may be without effect where light is found in this way.
    fn check_transport(&self) -> Result<()> {
        let refuse = |problem: String| Err(Error::Argument(problem));
        let of_paths = [
            self.spp.map(|spp| format!("--spp {spp}")),
            self.noise.map(|noise| format!("--noise {noise}")),
            self.seconds.map(|seconds| format!("--seconds {seconds}")),
        ];
        let of_others = [
            self.layers.is_some().then(|| "--layers".to_owned()),
            self.quality.map(|quality| format!("--quality {}", word(quality))),
            self.supersample.map(|rays| format!("--supersample {rays}")),
            self.exact.then(|| "--exact".to_owned()),
            self.shutter.map(|share| format!("--shutter {share}")),
            self.samples.map(|samples| format!("--samples {samples}")),
        ];
        let first = |words: &[Option<String>]| words.iter().flatten().next().cloned();
        match (first(&of_paths), first(&of_others)) {
            (Some(given), _) if !self.traces_paths() => {
                refuse(format!("{given} is for --transport path: add that or leave it out"))
            }
            (_, Some(given)) if self.traces_paths() => refuse(format!(
                "{given} and --transport path don't go together: leave one out; how well paths are traced is \
                 told by --spp, --noise or --seconds"
            )),
            _ => Ok(()),
        }
    }

    /// Layers are of one moment.
    fn check_blur(&self) -> Result<()> {
        let given = [
            self.shutter.map(|share| format!("--shutter {share}")),
            self.samples.map(|samples| format!("--samples {samples}")),
        ];
        match given.into_iter().flatten().next() {
            Some(word) if self.layers.is_some() => Err(Error::Argument(format!(
                "{word} and --layers don't go together, for depths and names have no mean: leave one out; with \
                 --layers=light,motion a compositor blurs"
            ))),
            _ => Ok(()),
        }
    }

    /// How a picture of `scene`, at `fps` frames a second, is blurred; not at all where it is of a pinhole and a moment.
    ///
    /// # Errors
    /// Where samples are asked for and there is nothing to blur.
    fn blur(&self, scene: &Scene, fps: f64) -> Result<Option<Blur>> {
        let has_aperture = scene.camera.as_ref().is_some_and(|camera| camera.aperture.is_some());
        let samples = self.samples.unwrap_or(SAMPLES);
        match (self.shutter, has_aperture && !self.traces_paths() && self.layers.is_none()) {
            (None, false) if self.samples.is_some_and(|samples| samples > 1) => {
                Err(Error::Argument(format!(
                    "--samples {samples} average nothing: add --shutter 0.5 for motion blur, or give the camera an `aperture`"
                )))
            }
            (None, false) => Ok(None),
            _ if samples == 1 => Ok(None),
            (share, _) => Ok(Some(Blur { samples, open: share.unwrap_or(0.0) / fps })),
        }
    }

    /// The moments that a picture of `scene` shows beside its own, s.
    ///
    /// # Errors
    /// As [`PictureOptions::blur`].
    pub fn moments(&self, scene: &Scene, fps: f64) -> Result<Vec<f64>> {
        let blur = self.blur(scene, fps)?.filter(|blur| blur.open > 0.0);
        Ok(blur.map(|blur| blur.moments(scene).collect()).unwrap_or_default())
    }

    /// As many rays as were asked for must go into one texture.
    fn check_rays(&self) -> Result<()> {
        let size = [self.width, self.height];
        match self.supersample {
            Some(rays) if rays > Film::most_rays(size) => Err(Error::Argument(format!(
                "--supersample {rays} of {}x{} pixels makes {} rays across, and {} is the most: give \
                 --supersample {}, or a picture of at most {} pixels across",
                self.width,
                self.height,
                rays * self.width.max(self.height),
                Film::WIDEST,
                Film::most_rays(size),
                Film::WIDEST / rays
            ))),
            _ => Ok(()),
        }
    }

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
        if let Some(kinds) = self.layer_kinds() {
            return self.draw_layers(painter, job, &kinds, progress).map_err(unwritten).map(|()| None);
        }
        let drawn = self.draw(painter, job, progress).map_err(unwritten)?;
        self.write(painter, job, &drawn).map_err(unwritten)?;
        match drawn.estimate {
            Some(estimate) if drawn.stopped => Err(Error::Stopped { kept: kept(job.output, &estimate) }),
            estimate => Ok(estimate),
        }
    }

    /// The kinds of layers that are wanted.
    fn layer_kinds(&self) -> Option<Vec<LayerKind>> {
        self.layers.as_ref().map(|names| names.iter().map(|name| name.kind()).collect())
    }

    /// Whether what is drawn of a moment depends on what comes after it.
    pub fn sees_motion(&self) -> bool {
        self.layer_kinds().is_some_and(|kinds| kinds.contains(&LayerKind::Motion))
    }

    fn draw_layers(
        &self,
        painter: &mut Painter,
        job: &Job<'_>,
        kinds: &[LayerKind],
        progress: &mut dyn FnMut(f64),
    ) -> Result<()> {
        let Painter { gpu, renderer } = painter;
        let next = job.next.as_ref().filter(|_| kinds.contains(&LayerKind::Motion));
        let go_apart = next.is_some_and(|(_, movement)| movement.of_all().is_none());
        let layers = if go_apart || kinds.contains(&LayerKind::Clouds) {
            renderer.render_layers_and_mattes(gpu, &job.frame, progress)?
        } else {
            renderer.render_layers(gpu, &job.frame, progress)?
        };
        let moment = job.scene.at(job.scene.time)?;
        let names: Vec<_> = moment.clouds.iter().enumerate().map(|(i, cloud)| cloud.label(i)).collect();
        let of = Layered {
            layers: &layers,
            frame: &job.frame,
            next: next.map(|(frame, movement)| (frame, movement)),
            names: &names,
            reduce: self.film().rays() as usize,
        };
        export::write_layers_of(job.output, gpu, of, kinds, self.transparent, &self.noted(job))
    }

    /// What is seen `span` seconds after the scene's own time, through the camera of `later`, and how far clouds go until
    /// then; where that is asked for.
    ///
    /// # Errors
    /// Where the scene is not good then.
    pub fn next(
        &self,
        scene: &Scene,
        frame: &Frame,
        later: &Scene,
        span: f64,
    ) -> Result<Option<(Frame, Movement)>> {
        if !self.sees_motion() {
            return Ok(None);
        }
        let camera = later.at(later.time)?.camera();
        Ok(Some((frame.seen_by(&camera, frame.size())?, scene.movement(scene.time, span)?)))
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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Exr,
}

impl Format {
    pub(super) fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match extension.as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(Error::Argument(format!(
                "`{}` ends in neither .png nor .exr: name one of these, the ending says what is written",
                path.display()
            ))),
        }
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
