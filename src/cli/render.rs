//! `nephos render`: a picture of a scene.

use std::{path::PathBuf, time::Instant};

use clap::Args;
use serde::Serialize;

use super::{
    camera::CameraOption,
    numbers::number,
    picture::{Format, Job, Painter, PictureOptions},
    stopped, terminal,
    tone::told,
};
use crate::{
    Error, Result,
    export::Notes,
    files::check_place,
    gpu::{self, PassTime},
    reference::Estimate,
    render::Counts,
    scene::{Scene, Timeline},
};

/// Render a scene file to a picture.
#[derive(Debug, Args)]
pub struct Render {
    /// Scene file; `-` reads the standard input.
    scene: PathBuf,
    /// Picture to write: .png (tone-mapped, sRGB) or .exr (linear).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    picture: PictureOptions,
    /// The moment to show, seconds since the scene's start; the scene's own `time` where left out.
    #[arg(long, value_name = "S", value_parser = number)]
    time: Option<f64>,
    /// Go on with the EXR picture that the output holds, if there is one, for `--transport path`.
    #[arg(long)]
    resume: bool,
    /// Tell the work and time of each pass; counting makes the picture slower.
    #[arg(long)]
    stats: bool,
    /// Write what is told as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    camera: CameraOption,
}

/// What `--json` tells.
#[derive(Debug, Serialize)]
struct Report {
    output: String,
    width: u32,
    height: u32,
    adapter: gpu::AdapterSummary,
    seconds: f64,
    /// What auto exposure adds to the scene's exposure, in stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    auto_exposure_stops: Option<f64>,
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
        self.picture.check(format)?;
        self.check_resuming(format)?;
        self.check_counting()?;
        check_place(&self.output)?;
        let mut scene = Scene::load(&self.scene).map_err(|error| error.in_file(&self.scene))?;
        scene.time = self.time.unwrap_or(scene.time);
        let fps = scene.timeline.as_ref().map_or(Timeline::default().fps, |timeline| timeline.fps);
        let span = 1.0 / fps;
        let mut later = Scene { time: scene.time + span, ..scene.clone() };
        if self.picture.sees_motion() {
            later = self.camera.see(later)?;
        }
        scene = match self.picture.shutter {
            Some(_) => self.camera.see_over_time(scene, fps)?,
            None => self.camera.see(scene)?,
        };
        self.picture.moments(&scene, fps)?;
        // What is wrong with the scene is told before an adapter is looked for.
        let frame = self.picture.frame(&scene)?;
        let next = self.picture.next(&scene, &frame, &later, span)?;
        let mut painter = self.picture.painter()?;
        painter.count(self.stats);
        let started = Instant::now();
        let bar = terminal::share("rendering");
        let mut progress = |share: f64| bar.set(share);
        let unwritten =
            |error| stopped(error, || format!("nothing was written to `{}`", self.output.display()));
        let metered = match format {
            Format::Exr => None,
            Format::Png => self.picture.meter(&mut painter, &scene, &frame).map_err(unwritten)?,
        };
        let job = Job {
            scene: &scene,
            frame,
            fps,
            next,
            metered,
            output: &self.output,
            resume: self.resume,
            keep: true,
            notes: self.notes(&scene),
        };
        let traced = self.picture.draw_to_file(&mut painter, &job, &mut progress)?;
        bar.finish();
        self.tell(&painter, metered, traced.as_ref(), started.elapsed().as_secs_f64())
    }

    /// What the file says of the frame: its number where the scene has frames and it is one of them.
    fn notes(&self, scene: &Scene) -> Notes {
        let mut notes = self.picture.notes();
        if let Some(timeline) = &scene.timeline {
            let index = (scene.time * timeline.fps).round();
            let is_frame = (index / timeline.fps - scene.time).abs() < 1e-6;
            notes.header.frame = is_frame.then_some(index as i32 + 1);
            notes.header.fps = Some(timeline.fps);
        }
        notes
    }

    /// Only EXR files hold what path tracing found so far.
    fn check_resuming(&self, format: Format) -> Result<()> {
        let problem = match (self.resume, self.picture.traces_paths(), format) {
            (true, false, _) => "--resume is for --transport path: add that or leave it out".to_owned(),
            (true, true, Format::Png) => format!(
                "--resume goes on with a picture that ends in .exr, and `{}` does not: only EXR files hold \
                 what was found so far",
                self.output.display()
            ),
            _ => return Ok(()),
        };
        Err(Error::Argument(problem))
    }

    /// What is counted and timed are the passes of the renderer.
    fn check_counting(&self) -> Result<()> {
        if self.stats && self.picture.traces_paths() {
            return Err(Error::Argument(
                "--stats tells the work of the renderer, and --transport path does without it: leave one out"
                    .to_owned(),
            ));
        }
        Ok(())
    }

    fn tell(
        &self,
        painter: &Painter,
        metered: Option<f64>,
        traced: Option<&Estimate>,
        seconds: f64,
    ) -> Result<()> {
        let Painter { gpu, renderer } = painter;
        let counts = if self.stats { Some(renderer.counts(gpu)?) } else { None };
        let passes = renderer.timing.as_ref().map_or(Ok(Vec::new()), |timing| timing.collect(gpu))?;
        let report = Report {
            // JSON has no other names.
            output: self.output.display().to_string(),
            width: self.picture.width,
            height: self.picture.height,
            adapter: gpu.adapter.clone(),
            seconds,
            auto_exposure_stops: metered,
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
            self.output, self.width, self.height, self.seconds, self.adapter.name
        );
        if let Some(metered) = self.auto_exposure_stops {
            text += &format!("  {}\n", told(metered));
        }
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
