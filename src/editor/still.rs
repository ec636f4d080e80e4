//! A final picture, drawn on a thread of its own on the window's device, in pieces so short
//! that the window stays alive.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use eframe::egui::Context;

use crate::{
    Error, Result, export,
    gpu::Gpu,
    render::{Film, Pieces, Quality, Renderer},
    scene::{Scene, Tone},
};

/// GPU time that a piece should take.
const PIECE: Duration = Duration::from_millis(40);
/// How often the window shows the share that is done.
const REPAINT: Duration = Duration::from_millis(100);
const LINEAR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What picture is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Still {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// How much work it gets.
    pub quality: Quality,
    /// Whether the sky is left out.
    pub transparent: bool,
    /// Whether an EXR file gets the layers of the light, too.
    pub layers: bool,
    /// File to write: .png or .exr.
    pub path: PathBuf,
}

impl Still {
    /// Whether it can be drawn: the sentence says what to change.
    ///
    /// # Errors
    /// [`Error::Argument`] where the name of the file or the size is no good.
    pub fn check(&self) -> Result<()> {
        let ending = ending(&self.path);
        if ending != "png" && ending != "exr" {
            return Err(Error::Argument(format!(
                "`{}` ends in neither .png nor .exr: name one of these, the ending says what is written",
                self.path.display()
            )));
        }
        if self.size.iter().any(|n| !(1..=Film::WIDEST).contains(n)) {
            let [width, height] = self.size;
            return Err(Error::Argument(format!(
                "a picture of {width} by {height} pixels can't be drawn: both must be 1 to {}",
                Film::WIDEST
            )));
        }
        Ok(())
    }
}

/// What thread and window tell one another.
#[derive(Debug, Default)]
struct Control {
    /// Thousandths that are done.
    done: AtomicU32,
    cancelled: AtomicBool,
}

/// A picture under way.
#[derive(Debug)]
pub struct StillJob {
    /// The file that it goes to.
    pub path: PathBuf,
    started: Instant,
    control: Arc<Control>,
    thread: JoinHandle<Result<bool>>,
}

/// How a picture came out.
#[derive(Debug)]
pub enum Outcome {
    /// It is in the file, after so much time.
    Written(PathBuf, Duration),
    /// It was not wanted any more.
    Cancelled,
    /// It could not be drawn or written.
    Failed(Error),
}

impl StillJob {
    /// Begins to draw `scene`; `window` is woken when there is something to see.
    pub fn begin(gpu: Gpu, scene: Arc<Scene>, still: Still, window: Context) -> Self {
        let control = Arc::<Control>::default();
        let (told, path) = (control.clone(), still.path.clone());
        let thread = thread::spawn(move || {
            let result = draw(&gpu, &scene, &still, &told, &window);
            window.request_repaint();
            result
        });
        Self { path, started: Instant::now(), control, thread }
    }

    /// Share that is done, 0 to 1.
    pub fn share(&self) -> f32 {
        self.control.done.load(Ordering::Relaxed) as f32 / 1000.0
    }

    /// Asks it to stop; nothing is written then.
    pub fn cancel(&self) {
        self.control.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether [`StillJob::finish`] has no need to wait.
    pub fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// How it came out, once it has.
    pub fn finish(self) -> Outcome {
        match self.thread.join() {
            Ok(Ok(false)) => Outcome::Cancelled,
            Ok(Ok(true)) => Outcome::Written(self.path, self.started.elapsed()),
            Ok(Err(error)) => Outcome::Failed(error),
            Err(_) => Outcome::Failed(Error::Gpu {
                doing: "drawing the picture".to_owned(),
                reason: "it ended in a panic; the log tells more".to_owned(),
            }),
        }
    }
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase()
}

/// Draws and writes the picture; false where it was cancelled before it was written.
fn draw(gpu: &Gpu, scene: &Scene, still: &Still, control: &Control, window: &Context) -> Result<bool> {
    let film = Film::of_quality(still.size, &still.quality);
    let frame = film.frame(scene)?;
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, LINEAR);
    renderer.settings.quality = still.quality;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let is_exr = ending(&still.path) == "exr";
    if is_exr && still.layers {
        let (layers, pieces) = renderer.begin_layers(&mut encoder, &frame);
        gpu.queue.submit([encoder.finish()]);
        let whole = draw_pieces(gpu, &renderer, pieces, control, window)?;
        if whole {
            export::write_layers(&still.path, gpu, &layers, still.transparent, film.rays() as usize)?;
        }
        return Ok(whole);
    }
    let metered = if !is_exr && scene.is_metered() { renderer.meter(gpu, &frame)? } else { 0.0 };
    let (linear, pieces) = renderer.begin_picture(&mut encoder, &frame, !still.transparent);
    gpu.queue.submit([encoder.finish()]);
    if !draw_pieces(gpu, &renderer, pieces, control, window)? {
        return Ok(false);
    }
    let picture = film.read(gpu, &linear)?.times(frame.unit());
    if is_exr {
        export::write_beauty(&still.path, &picture)?;
    } else {
        let own = scene.tone();
        let tone = Tone { stops: own.stops + metered, ..own };
        let bytes = picture.finished(gpu, &mut renderer, tone)?;
        export::write_png(&still.path, still.size, &bytes, still.transparent)?;
    }
    Ok(true)
}

/// Draws the pieces, as many at a time as fit into [`PIECE`]; false where it was cancelled.
fn draw_pieces(
    gpu: &Gpu,
    renderer: &Renderer,
    mut pieces: Pieces,
    control: &Control,
    window: &Context,
) -> Result<bool> {
    let mut tiles = 8;
    loop {
        if control.cancelled.load(Ordering::Relaxed) {
            return Ok(false);
        }
        if pieces.finished() {
            return Ok(true);
        }
        let began = Instant::now();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.draw_pieces(&mut encoder, &mut pieces, tiles);
        gpu.queue.submit([encoder.finish()]);
        gpu.finish("drawing the picture")?;
        let ratio = PIECE.as_secs_f64() / began.elapsed().as_secs_f64().max(1e-6);
        tiles = (f64::from(tiles) * ratio.clamp(0.5, 2.0)).clamp(1.0, 4096.0) as u32;
        control.done.store((1000.0 * pieces.share()) as u32, Ordering::Relaxed);
        window.request_repaint_after(REPAINT);
    }
}
