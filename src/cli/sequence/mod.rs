//! `nephos sequence`: the pictures of a scene over time, as files or as a movie.
//!
//! A frame's file says what it shows: a fingerprint of the moment and of how it was drawn. A
//! frame that is there, whole and of the same fingerprint is not drawn again, whoever drew it:
//! that is how a sequence goes on after a crash and how several machines share one.

mod exposure;
pub(super) mod frames;
mod movie;
mod stamp;

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
    time::Instant,
};

use clap::Args;
use serde::Serialize;

use self::{
    frames::{Frames, Shard, numbered, pattern, set_fps},
    movie::{Container, Movie},
    stamp::{Stamp, identity},
};
use super::{
    camera::CameraOption,
    picture::{Format, Job, Painter, PictureOptions},
    stopped, terminal,
    tone::told,
};
use crate::{
    Error, Result,
    export::{self, Header, Notes},
    files::{check_place, write_whole},
    gpu,
    numbered::Pattern,
    render::Frame,
    scene::{Movement, Scene},
};

/// Render a scene over time: numbered pictures, or a movie.
///
/// Frame 1 is at 0 seconds. Frames that are there already, whole and of the same scene and options,
/// are left alone: after a crash the same command goes on where it ended.
#[derive(Debug, Args)]
pub struct Sequence {
    /// Scene file; `-` reads the standard input.
    scene: PathBuf,
    /// Pictures to write, such as "out/frame.####.exr" or .png: the frame's number stands for the
    /// hashes, for `%04d` or for `$F4`. Or one movie, .mp4 or .webm, through ffmpeg.
    #[arg(short, long, value_name = "FILES")]
    output: PathBuf,
    /// Frames, such as 1-240, 1-240:2, 7,12-20 or -10-240; all of the timeline where left out.
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    frames: Option<Frames>,
    /// Frames per second, such as 24 or 24000/1001; the timeline's where left out, or else 24.
    #[arg(long, value_name = "N", value_parser = frames::rate)]
    fps: Option<f64>,
    /// Takes the frames of a movie from these PNG files, such as "out/frame.####.png", where they are whole
    /// and of the same scene and options; the others are drawn.
    #[arg(long, value_name = "FILES")]
    from: Option<PathBuf>,
    /// Draws only every n-th frame, from the i-th on: machine i of n.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    camera: CameraOption,
    /// Write what is told as JSON.
    #[arg(long)]
    json: bool,
}

/// What `--json` tells.
#[derive(Debug, Default, Serialize)]
struct Report {
    frames: usize,
    /// Frames that were drawn, those that were there already, and those that look as the one before.
    drawn: usize,
    found: usize,
    repeated: usize,
    seconds: f64,
    /// What auto exposure adds to the scene's exposure in all frames, in stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    auto_exposure_stops: Option<f64>,
    /// Volumes and tables of light that were made for all frames together.
    light_updates: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<gpu::AdapterSummary>,
}

/// What draws, and how all frames are exposed.
struct Brush {
    painter: Painter,
    metered: Option<f64>,
}

/// A frame to be drawn.
#[derive(Debug, Clone)]
struct Still {
    number: i32,
    fps: f64,
    time: f64,
    stamp: Stamp,
}

impl Sequence {
    /// Renders.
    ///
    /// # Errors
    /// Where the scene, the arguments, the adapter or a file are not good. Frames that were written
    /// before are whole.
    pub fn run(self) -> Result<()> {
        let mut scene = Scene::load(&self.scene).map_err(|error| error.in_file(&self.scene))?;
        let fps = set_fps(&mut scene, self.fps).map_err(|error| error.in_file(&self.scene))?;
        let scene = self.camera.see_over_time(scene, fps)?;
        let stills = self.stills(&scene, fps)?;
        let started = Instant::now();
        let mut report = match Container::of(&self.output) {
            Some(container) => self.movie(&scene, &stills, fps, container)?,
            None => self.pictures(&scene, &stills)?,
        };
        report.frames = stills.len();
        report.seconds = started.elapsed().as_secs_f64();
        if self.json { terminal::print_json(&report) } else { terminal::print(&self.told(&report)) }
    }

    /// The frames of this machine. Every moment is looked at before the first is drawn: what is
    /// wrong at the end is told at the beginning.
    fn stills(&self, scene: &Scene, fps: f64) -> Result<Vec<Still>> {
        let all = numbered(scene, self.frames.as_ref(), fps, &self.scene)?;
        let exposed_by = self.exposed_by(scene).map_err(|error| error.in_file(&self.scene))?;
        let own = all.into_iter().enumerate().filter(|(i, _)| self.shard.is_none_or(|shard| shard.has(*i)));
        own.map(|(_, (number, time))| {
            let at = |time: f64| scene.at(time).map_err(|error| error.in_file(&self.scene));
            let moment = at(time)?;
            let mut beside = exposed_by.clone();
            if self.picture.sees_motion() {
                beside += &identity(&at(time + 1.0 / fps)?);
            }
            for moment in self.picture.moments(&Scene { time, ..scene.clone() }, fps)? {
                beside += &identity(&at(moment)?);
            }
            Ok(Still { number, fps, time, stamp: Stamp::new(&moment, &self.picture, &beside) })
        })
        .collect()
    }

    /// What the exposure of all frames follows from: nothing where it is given, or has no meaning.
    fn exposed_by(&self, scene: &Scene) -> Result<String> {
        let is_metered = self.for_screens() && self.picture.tone.is_metered(scene);
        if is_metered { exposure::basis(scene) } else { Ok(String::new()) }
    }

    fn for_screens(&self) -> bool {
        Container::of(&self.output).is_some() || matches!(Format::of(&self.output), Ok(Format::Png))
    }

    fn brush(&self, scene: &Scene) -> Result<Brush> {
        let mut painter = self.picture.painter()?;
        let metered = match self.for_screens() {
            true => exposure::meter(&self.picture, &mut painter, scene)?,
            false => None,
        };
        Ok(Brush { painter, metered })
    }

    fn pictures(&self, scene: &Scene, stills: &[Still]) -> Result<Report> {
        if self.from.is_some() {
            return Err(Error::Argument("--from is for movies: name one, .mp4 or .webm".to_owned()));
        }
        let pattern = pattern(&self.output)?;
        let format = Format::of(&self.output)?;
        // EXR files tell their frame's number and time.
        let has_no_header = matches!(format, Format::Png);
        self.picture.check(format)?;
        make_folder(&self.output)?;
        stills.iter().take(1).try_for_each(|still| check_place(&pattern.file(still.number)))?;
        let missing: Vec<&Still> =
            stills.iter().filter(|still| !still.stamp.is_on(&pattern.file(still.number))).collect();
        let mut report = Report { found: stills.len() - missing.len(), ..Report::default() };
        if missing.is_empty() {
            return Ok(report);
        }
        let mut brush =
            self.brush(scene).map_err(|error| stopped(error, || kept(report.found, stills.len())))?;
        let mut last: Option<(&Stamp, PathBuf)> = None;
        let bar = terminal::share("frames");
        for (i, still) in missing.iter().enumerate() {
            let mut progress = |share: f64| {
                bar.set((i as f64 + share) / missing.len() as f64);
            };
            let file = pattern.file(still.number);
            match &last {
                // Another machine may have been here since.
                _ if still.stamp.is_on(&file) => report.found += 1,
                Some((stamp, same)) if has_no_header && **stamp == still.stamp => {
                    copy(same, &file)?;
                    report.repeated += 1;
                }
                _ => {
                    let whole = stills.len() - missing.len() + i;
                    self.draw_to(&mut brush, scene, still, &file, &mut progress)
                        .map_err(|error| stopped(error, || kept(whole, stills.len())))?;
                    report.drawn += 1;
                }
            }
            last = Some((&still.stamp, file));
        }
        bar.finish();
        report.tell_of(&brush);
        Ok(report)
    }

    fn draw_to(
        &self,
        Brush { painter, metered }: &mut Brush,
        scene: &Scene,
        still: &Still,
        file: &Path,
        progress: &mut dyn FnMut(f64),
    ) -> Result<()> {
        let scene = Scene { time: still.time, ..scene.clone() };
        // What a path traced frame is on the way is no frame: it would pass for one.
        let header =
            Header { frame: Some(still.number), fps: Some(still.fps), ..self.picture.notes().header };
        let (frame, notes) = (self.picture.frame(&scene)?, still.stamp.notes(header));
        let (metered, output, next) = (*metered, file, self.next(&scene, &frame, still)?);
        let job = Job {
            scene: &scene,
            frame,
            fps: still.fps,
            next,
            metered,
            output,
            resume: false,
            keep: false,
            notes,
        };
        self.picture.draw_to_file(painter, &job, progress).map(drop)
    }

    /// What comes after a frame, where its layers tell.
    fn next(&self, scene: &Scene, frame: &Frame, still: &Still) -> Result<Option<(Frame, Movement)>> {
        let later = Scene { time: still.time + 1.0 / still.fps, ..scene.clone() };
        self.picture.next(scene, frame, &later, 1.0 / still.fps)
    }

    fn movie(&self, scene: &Scene, stills: &[Still], fps: f64, container: Container) -> Result<Report> {
        for (word, given) in [
            ("--layers", self.picture.layers.is_some()),
            ("--transparent", self.picture.transparent),
            ("--shard", self.shard.is_some()),
        ] {
            if given {
                return Err(Error::Argument(format!(
                    "{word} is not for movies: write pictures, such as frame.####.exr"
                )));
            }
        }
        self.picture.check(Format::Png)?;
        let from = self.from.as_deref().map(drawn_before).transpose()?;
        make_folder(&self.output)?;
        let size = [self.picture.width, self.picture.height];
        let mut movie = Movie::begin(&self.output, container, size, fps)?;
        let (mut report, mut last) = (Report::default(), None::<(Stamp, Vec<u8>)>);
        let unfinished =
            |error| stopped(error, || format!("there is no movie `{}` yet", self.output.display()));
        // Who finds all frames needs no adapter.
        let mut brush = None;
        let bar = terminal::share("frames");
        for (i, still) in stills.iter().enumerate() {
            let mut progress = |share: f64| {
                bar.set((i as f64 + share) / stills.len() as f64);
            };
            let file = from.as_ref().map(|pattern| pattern.file(still.number));
            let bytes = match last.take().filter(|(stamp, _)| *stamp == still.stamp) {
                Some((_, bytes)) => {
                    report.repeated += 1;
                    bytes
                }
                None => match file.filter(|file| still.stamp.is_on(file)) {
                    Some(file) => {
                        report.found += 1;
                        export::read_rgb(&file)?
                    }
                    None => {
                        report.drawn += 1;
                        let brush = match &mut brush {
                            Some(brush) => brush,
                            none => none.insert(self.brush(scene).map_err(unfinished)?),
                        };
                        self.bytes(brush, scene, still, &mut progress).map_err(unfinished)?
                    }
                },
            };
            movie.add(&bytes).map_err(unfinished)?;
            progress(1.0);
            last = Some((still.stamp.clone(), bytes));
        }
        movie.finish().map_err(unfinished)?;
        bar.finish();
        brush.iter().for_each(|brush| report.tell_of(brush));
        Ok(report)
    }

    /// A frame as screens show it, RGB of 8 bits.
    fn bytes(
        &self,
        Brush { painter, metered }: &mut Brush,
        scene: &Scene,
        still: &Still,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Vec<u8>> {
        let scene = Scene { time: still.time, ..scene.clone() };
        let (frame, notes) = (self.picture.frame(&scene)?, Notes::default());
        let (metered, output) = (*metered, &*self.output);
        let job = Job {
            scene: &scene,
            frame,
            fps: still.fps,
            next: None,
            metered,
            output,
            resume: false,
            keep: false,
            notes,
        };
        let drawn = self.picture.draw(painter, &job, progress)?;
        Ok(export::opaque_of(&self.picture.finished(painter, &drawn.picture, &job)?))
    }

    fn told(&self, report: &Report) -> String {
        let mut text = format!(
            "{}: {} frames in {:.1} s: {} drawn",
            self.output.display(),
            report.frames,
            report.seconds,
            report.drawn
        );
        for (count, what) in [(report.found, "there already"), (report.repeated, "as the one before")] {
            if count > 0 {
                text += &format!(", {count} {what}");
            }
        }
        if let Some(adapter) = &report.adapter {
            text += &format!(" on {}", adapter.name);
        }
        if let Some(metered) = report.auto_exposure_stops {
            text += &format!(", {}", told(metered));
        }
        text + "\n"
    }
}

impl Report {
    fn tell_of(&mut self, Brush { painter, metered }: &Brush) {
        self.auto_exposure_stops = *metered;
        self.light_updates = painter.renderer.light_updates();
        self.adapter = Some(painter.gpu.adapter.clone());
    }
}

/// What there is of a sequence that was stopped, and how to go on.
fn kept(whole: usize, of: usize) -> String {
    format!("{whole} of {of} frames are there and whole; the same command goes on with the others")
}

/// The pictures that a movie is made of.
fn drawn_before(files: &Path) -> Result<Pattern> {
    match Format::of(files)? {
        Format::Png => pattern(files),
        Format::Exr => Err(Error::Argument(format!(
            "--from `{}`: movies are made of .png files, which are toned as the movie is",
            files.display()
        ))),
    }
}

fn make_folder(output: &Path) -> Result<()> {
    let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) else { return Ok(()) };
    fs::create_dir_all(folder).map_err(|source| Error::File {
        action: "create",
        path: folder.to_owned(),
        source,
    })
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let bytes =
        fs::read(from).map_err(|source| Error::File { action: "read", path: from.to_owned(), source })?;
    write_whole(to, |file| file.write_all(&bytes))
}
