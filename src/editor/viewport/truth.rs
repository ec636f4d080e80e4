//! Truth beside the preview: the path tracer converges over the viewport, a bounded piece
//! of work at a time, and the difference is told in numbers and colours.

use crate::scene::Tone;
use std::time::{Duration, Instant};

use eframe::egui::{Color32, ColorImage, Context, TextureHandle, TextureId, TextureOptions};

use super::{
    canvas::Canvas,
    easel::TruthSeen,
    error_map::{self, Numbers},
    screen::Screen,
    subject::Subject,
};
use crate::{Result, export::Picture, gpu::Gpu, reference::PathTracer};

/// The truth is good enough where its noise is below this share of the light ...
const NOISE: f64 = 0.004;
/// ... or each pixel has this many samples.
const MOST: u32 = 12_000;
/// Time between two pictures of the truth.
const SHOW_EVERY: Duration = Duration::from_millis(400);
/// Most pixels on adapters without a GPU, and with one.
const PIXELS: [u32; 2] = [14_400, 480_000];

/// The truth under way.
#[derive(Default)]
pub struct Truth {
    run: Option<Run>,
    screen: Option<Screen>,
    map: Option<TextureHandle>,
    /// Why there is none.
    error: Option<String>,
}

/// What is known of one subject.
struct Run {
    subject: Subject,
    tone: Tone,
    /// What 1 stands for in what is shown.
    unit: f32,
    tracer: PathTracer,
    preview: Picture,
    sky: Picture,
    samples: u32,
    target: u32,
    shown: Option<Shown>,
    done: bool,
}

struct Shown {
    at: Instant,
    samples: u32,
    linear: wgpu::Texture,
    numbers: Numbers,
}

impl Truth {
    /// Most pixels that the truth may have on this adapter, or as wanted.
    pub fn pixels(gpu: &Gpu, wanted: u32) -> u32 {
        match wanted {
            0 if gpu.adapter.kind == "Cpu" => PIXELS[0],
            0 => PIXELS[1],
            wanted => wanted,
        }
    }

    /// What there is to see of it.
    pub fn seen(&self) -> TruthSeen {
        TruthSeen {
            image: self.image(),
            map: self.map(),
            numbers: self.numbers(),
            error: self.error.clone(),
            done: self.done(),
        }
    }

    /// The truth's picture, where there is one of what is seen now.
    fn image(&self) -> Option<TextureId> {
        self.run.as_ref()?.shown.as_ref()?;
        self.screen.as_ref().and_then(Screen::id)
    }

    /// The map of differences likewise.
    fn map(&self) -> Option<TextureId> {
        self.run.as_ref()?.shown.as_ref()?;
        self.map.as_ref().map(TextureHandle::id)
    }

    /// Samples of each pixel that the picture has, and how far the preview is from it.
    fn numbers(&self) -> Option<(u32, Numbers)> {
        let shown = self.run.as_ref()?.shown.as_ref()?;
        Some((shown.samples, shown.numbers))
    }

    /// Whether there is no more to do.
    fn done(&self) -> bool {
        self.error.is_some() || self.run.as_ref().is_some_and(|run| run.done)
    }

    /// Forgets everything.
    pub fn stop(&mut self) {
        (self.run, self.map, self.error) = (None, None, None);
    }

    /// Does a piece of work for what `canvas` shows, once that is final. Tells whether there
    /// is more to do.
    pub fn update(&mut self, ctx: &Context, canvas: &mut Canvas, tone: Tone, budget: Duration) -> bool {
        match self.step(ctx, canvas, tone, budget) {
            Ok(more) => more,
            Err(error) => {
                self.error = Some(error.to_string());
                self.run = None;
                false
            }
        }
    }

    fn step(&mut self, ctx: &Context, canvas: &mut Canvas, tone: Tone, budget: Duration) -> Result<bool> {
        let Some(subject) = canvas.subject().cloned() else { return Ok(false) };
        let same = |run: &Run| run.subject.same_scene(&subject) && run.subject.same_view(&subject);
        if !self.run.as_ref().is_some_and(same) {
            self.error = None;
            self.run = begin(canvas, subject, tone)?;
        }
        let Some(run) = &mut self.run else { return Ok(false) };
        let exposed = std::mem::replace(&mut run.tone, tone) != tone;
        if exposed && let Some(shown) = &run.shown {
            canvas.compose_into(&mut self.screen, &shown.linear, tone.in_unit(run.unit))?;
        }
        if run.done {
            return Ok(false);
        }
        run.trace(budget)?;
        if run.due() {
            let map = run.show(canvas.gpu())?;
            if let Some(shown) = &run.shown {
                canvas.compose_into(&mut self.screen, &shown.linear, tone.in_unit(run.unit))?;
            }
            let options = TextureOptions::NEAREST;
            match &mut self.map {
                Some(texture) => texture.set(map, options),
                None => self.map = Some(ctx.load_texture("error map", map, options)),
            }
        }
        Ok(true)
    }
}

/// Begins where the preview is finished.
fn begin(canvas: &mut Canvas, subject: Subject, tone: Tone) -> Result<Option<Run>> {
    let Some(linear) = canvas.picture() else { return Ok(None) };
    let frame = subject.frame([linear.width(), linear.height()])?;
    let unit = frame.unit();
    let preview = Picture::read(canvas.gpu(), linear)?.times(unit);
    let sky = canvas.sky(&frame)?;
    let tracer = PathTracer::new(canvas.gpu(), &frame, 0)?;
    Ok(Some(Run {
        subject,
        tone,
        unit,
        tracer,
        preview,
        sky,
        samples: 0,
        target: 9,
        shown: None,
        done: false,
    }))
}

impl Run {
    /// Traces for about `budget`, or until there is something new to show.
    fn trace(&mut self, budget: Duration) -> Result<()> {
        let started = Instant::now();
        while started.elapsed() < budget {
            if self.samples == self.target {
                // Samples come in threes, one for each channel.
                self.target += (self.samples / 12).clamp(1, 16) * 3;
            }
            if self.tracer.advance(self.target)? >= 1.0 {
                self.samples = self.target;
                if self.due() {
                    break;
                }
            }
        }
        Ok(())
    }

    /// Whether there is a picture to show: each pixel has all its samples, and the last one
    /// is old.
    fn due(&self) -> bool {
        let old = self.shown.as_ref().is_none_or(|shown| shown.at.elapsed() > SHOW_EVERY);
        old && self.samples == self.target
    }

    /// Reads what has been found, compares it, and decides whether that is enough.
    fn show(&mut self, gpu: &Gpu) -> Result<ColorImage> {
        let estimate = self.tracer.estimate()?;
        let Picture { width, height, .. } = self.preview;
        let mut truth = Picture { width, height, pixels: estimate.mean.clone() };
        truth.put_over(&self.sky);
        let numbers = Numbers::new(&self.preview, &truth, &estimate);
        self.done =
            numbers.pixels == 0 || self.samples >= MOST || (self.samples >= 48 && numbers.noise < NOISE);
        let colors = error_map::differences(&self.preview, &truth).into_iter().map(|difference| {
            let [r, g, b] =
                error_map::color(difference / error_map::RANGE).map(|c| (255.0 * c).round() as u8);
            Color32::from_rgb(r, g, b)
        });
        let map = ColorImage::new([width, height], colors.collect());
        let linear = truth.times(self.unit.recip()).upload(gpu);
        self.shown = Some(Shown { at: Instant::now(), samples: self.samples, linear, numbers });
        Ok(map)
    }
}
