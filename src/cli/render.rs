//! `nephos render`: a picture of a scene.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::terminal;
use crate::{
    Error, Result,
    export::{self, Picture},
    gpu::{self, Gpu, PassTime, Timing},
    import::read_camera,
    reference::Estimate,
    render::{Counts, Frame, Quality, Renderer, SlabTable, Target, Transport},
    scene::{Camera, Scene},
    tables,
};

/// Render a scene file to a picture.
#[derive(Debug, Args)]
pub struct Render {
    /// Scene file; `-` reads the standard input.
    scene: PathBuf,
    /// Picture to write: .png (tone-mapped, sRGB) or .exr (linear).
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
    /// Width, pixels.
    #[arg(long, default_value_t = 960, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub(super) width: u32,
    /// Height, pixels.
    #[arg(long, default_value_t = 540, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub(super) height: u32,
    /// How much work to put in.
    #[arg(long, value_enum, default_value_t = QualityName::Final)]
    quality: QualityName,
    /// How light inside clouds is found.
    #[arg(long, value_enum, default_value_t = TransportName::Moments)]
    transport: TransportName,
    /// Where slab-kol and slab-bouthors take their light from; the others do not ask.
    #[arg(long, value_enum, default_value_t = SlabTableName::Functions)]
    slab_table: SlabTableName,
    /// Samples of each pixel, for `--transport path`: 96 where nothing else ends the picture.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..=1_000_000))]
    pub(super) spp: Option<u32>,
    /// Relative noise that is low enough, for `--transport path`: 0.02 is 2 %.
    #[arg(long, value_name = "SHARE", value_parser = above_zero)]
    pub(super) noise: Option<f64>,
    /// Time after which the picture is written as it is, for `--transport path`.
    #[arg(long, value_name = "S", value_parser = above_zero)]
    pub(super) seconds: Option<f64>,
    /// Go on with the EXR picture that the output holds, if there is one, for `--transport path`.
    #[arg(long)]
    pub(super) resume: bool,
    /// Rays across each pixel, for smooth edges: 2 in final quality, else 1.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    supersample: Option<u32>,
    /// Write the layers that the beauty is made of beside it (EXR only).
    #[arg(long)]
    layers: bool,
    /// Leave the sky out: clouds on a transparent ground.
    #[arg(long)]
    pub(super) transparent: bool,
    /// Tell the work and time of each pass; counting makes the picture slower.
    #[arg(long)]
    stats: bool,
    /// Write what is told as JSON.
    #[arg(long)]
    json: bool,
    /// Take the camera of a glTF file instead of the scene's: FILE or, of several, FILE#NAME.
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum QualityName {
    Draft,
    Preview,
    Final,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum TransportName {
    /// A cloud that glows evenly and dims what is behind, as Max (1994): no shadows.
    Emitter,
    /// Single scattering only, and the light of the sky.
    Single,
    /// Also two octaves of it, as games and films do (Wrenninge 2013, Hillaire 2016).
    Octaves,
    /// Also multiple scattering, in closed form.
    DeltaEddington,
    /// Multiple scattering from tables of slabs, set of orders by set.
    Slab,
    /// One slab for all orders, at one level of the sun maps, as Kol (2013).
    SlabKol,
    /// A slab for each set, found by iteration, as Bouthors (2008): slow.
    SlabBouthors,
    /// Moments of the light in the cloud, solved for on a grid.
    Moments,
    /// Truth by Monte Carlo: slow, without bias, with noise that --spp lowers.
    Path,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SlabTableName {
    /// Bouthors' functions, fitted.
    Functions,
    /// A table of their light itself.
    Direct,
}

/// A number above zero.
pub(super) fn above_zero(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 && value < f64::INFINITY => Ok(value),
        _ => Err("give a number above 0".to_owned()),
    }
}

/// The camera of `FILE` or `FILE#NAME`.
fn camera_of(named: &Path) -> Result<Camera> {
    let text = named.to_string_lossy();
    match text.rsplit_once('#') {
        Some((file, name)) if !named.exists() => read_camera(Path::new(file), Some(name)),
        _ => read_camera(named, None),
    }
}

/// What `--json` tells.
#[derive(Debug, Serialize)]
struct Report {
    output: PathBuf,
    width: u32,
    height: u32,
    adapter: gpu::AdapterSummary,
    seconds: f64,
    /// Samples of each pixel and relative noise, of path traced pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    noise: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    counts: Option<Counts>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    passes: Vec<PassTime>,
}

impl Render {
    /// Renders.
    ///
    /// # Errors
    /// Where the scene, the arguments, the adapter or the file are not good.
    pub fn run(self) -> Result<()> {
        let format = Format::of(&self.output)?;
        if self.layers && self.traces_paths() {
            return Err(Error::Argument(
                "--layers and --transport path don't go together: leave one out".to_owned(),
            ));
        }
        if self.layers && format != Format::Exr {
            return Err(Error::Argument("--layers needs an output that ends in .exr".to_owned()));
        }
        self.check_tracing(format)?;
        // A damaged table is told before anything is drawn.
        tables::slab_moments()?;
        let mut scene = Scene::load(&self.scene).map_err(|error| error.in_file(&self.scene))?;
        if let Some(file) = &self.camera {
            scene.camera = Some(camera_of(file)?);
        }
        let n = self.rays_across();
        let frame = Frame::new(&scene, [n * self.width, n * self.height])?;
        let gpu = pollster::block_on(Gpu::open(self.adapter.as_deref()))?;
        let started = Instant::now();
        let mut renderer = self.renderer(&gpu);
        let bar = terminal::progress("rendering");
        let mut progress = |share: f64| bar.set_position((1000.0 * share) as u64);
        let traced = match format {
            _ if self.traces_paths() => {
                Some(self.trace(&gpu, &mut renderer, &frame, &scene, &mut progress)?)
            }
            Format::Png => self.png(&gpu, &mut renderer, &frame, &scene, &mut progress).map(|()| None)?,
            Format::Exr => self.exr(&gpu, &mut renderer, &frame, &mut progress).map(|()| None)?,
        };
        bar.finish_and_clear();
        self.tell(&gpu, &renderer, traced.as_ref(), started.elapsed().as_secs_f64())
    }

    fn renderer(&self, gpu: &Gpu) -> Renderer {
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
        renderer.quality = match self.quality {
            QualityName::Draft => Quality::DRAFT,
            QualityName::Preview => Quality::PREVIEW,
            QualityName::Final => Quality::FINAL,
        };
        renderer.transport = match self.transport {
            TransportName::Emitter => Transport::Emitter,
            TransportName::Single => Transport::Single,
            TransportName::Octaves => Transport::Octaves,
            TransportName::SlabKol => Transport::SlabKol,
            TransportName::SlabBouthors => Transport::SlabBouthors,
            TransportName::DeltaEddington => Transport::DeltaEddington,
            TransportName::Slab => Transport::Slab,
            // What is drawn beside a path traced picture has no clouds.
            TransportName::Moments | TransportName::Path => Transport::Moments,
        };
        renderer.slab_table = match self.slab_table {
            SlabTableName::Functions => SlabTable::Functions,
            SlabTableName::Direct => SlabTable::Direct,
        };
        renderer.counting = self.stats;
        renderer.timing = self.stats.then(|| Timing::new(gpu));
        renderer
    }

    fn png(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        frame: &Frame,
        scene: &Scene,
        progress: &mut dyn FnMut(f64),
    ) -> Result<()> {
        let linear = self.beauty(gpu, renderer, frame, progress)?;
        let bytes = linear.finished(gpu, renderer, scene.tone())?;
        export::write_png(&self.output, [self.width, self.height], &bytes, self.transparent)
    }

    fn exr(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        frame: &Frame,
        progress: &mut dyn FnMut(f64),
    ) -> Result<()> {
        if self.layers {
            let layers = renderer.render_layers(gpu, frame, progress)?;
            return export::write_layers(
                &self.output,
                gpu,
                &layers,
                self.transparent,
                self.rays_across() as usize,
            );
        }
        export::write_beauty(&self.output, &self.beauty(gpu, renderer, frame, progress)?)
    }

    /// As asked for; by default what the quality wants and 8192 pixels allow.
    fn rays_across(&self) -> u32 {
        let most = (8192 / self.width.max(self.height)).max(1);
        match (self.supersample, self.quality) {
            _ if self.traces_paths() => 1,
            (Some(n), _) => n.min(most),
            (None, QualityName::Final) => most.min(2),
            (None, _) => 1,
        }
    }

    pub(super) fn traces_paths(&self) -> bool {
        matches!(self.transport, TransportName::Path)
    }

    fn beauty(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        frame: &Frame,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Picture> {
        let linear = renderer.picture("linear", frame.size(), wgpu::TextureFormat::Rgba16Float);
        let view = linear.create_view(&Default::default());
        let target = Target { color: &view, depth: None, sky: !self.transparent };
        renderer.render_in_pieces(gpu, frame, &target, progress)?;
        Ok(Picture::read(gpu, &linear)?.reduced(self.rays_across() as usize))
    }

    fn tell(&self, gpu: &Gpu, renderer: &Renderer, traced: Option<&Estimate>, seconds: f64) -> Result<()> {
        let counts = if self.stats { Some(renderer.counts(gpu)?) } else { None };
        let passes = renderer.timing.as_ref().map_or(Ok(Vec::new()), |timing| timing.collect(gpu))?;
        let report = Report {
            output: self.output.clone(),
            width: self.width,
            height: self.height,
            adapter: gpu.adapter.clone(),
            seconds,
            samples: traced.map(|estimate| estimate.samples),
            noise: traced.map(Estimate::noise),
            counts,
            passes,
        };
        if self.json { terminal::print_json(&report) } else { terminal::print(&report.text()) }
    }
}

impl Report {
    fn text(&self) -> String {
        let mut text = format!(
            "{}: {}x{} in {:.2} s on {}\n",
            self.output.display(),
            self.width,
            self.height,
            self.seconds,
            self.adapter.name
        );
        if let (Some(samples), Some(noise)) = (self.samples, self.noise) {
            text += &format!("  {samples} samples a pixel, relative noise {:.2} %\n", 100.0 * noise);
        }
        for time in &self.passes {
            text += &format!("  {:<14} {:>10.2} ms\n", time.pass, time.ms);
        }
        if let Some(counts) = self.counts {
            let per_ray = |n: u64| n as f64 / counts.rays.max(1) as f64;
            for (name, n) in counts.named() {
                text += &format!("  {name:<20} {n:>14}  {:>8.2} per ray\n", per_ray(n));
            }
        }
        text
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
