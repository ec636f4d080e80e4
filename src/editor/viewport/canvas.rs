//! The picture in the viewport: coarse while something moves, then finer in helpings that
//! leave the window alive, then nothing until something changes.

use crate::scene::Tone;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use eframe::egui::{Context, TextureId};
use wgpu::{TextureFormat, TextureView};

use super::{
    pace::{Helping, Pace},
    screen::{Screen, Shelf},
    settings::Layer,
    stage::Stage,
    statistics::Statistics,
    subject::Subject,
    work::{Source, Work},
};
use crate::{
    Error, Result,
    export::Picture,
    gpu::{Gpu, Timing},
    render::{Frame, Quality, Renderer, Resolve, Shown},
    scene::Scene,
};

const LINEAR: TextureFormat = TextureFormat::Rgba16Float;
pub(super) const SCREEN: TextureFormat = TextureFormat::Rgba8Unorm;
/// How long the hand rests before the picture is refined.
const REST: Duration = Duration::from_millis(160);
/// Where light takes long, as on adapters that are no GPU, the final picture's light waits
/// for some times as long as the preview's took: it would stop a hand that goes on.
const PATIENCE: u32 = 6;
const LONGEST_PATIENCE: Duration = Duration::from_secs(2);

/// Share of the time of a picture, while something moves, that may go into light.
const LIGHT_SHARE: f64 = 0.5;

/// Keeps what is shown and draws it anew as needed.
pub struct Canvas {
    pub(super) gpu: Gpu,
    pub(super) renderer: Renderer,
    resolve: Resolve,
    pub(super) shelf: Shelf,
    /// The window; nothing before the first picture.
    pub(super) window: Context,
    subject: Option<Subject>,
    /// The moment of a scene that was seen last: a camera that moves makes none of its clouds anew.
    moment: Option<(Arc<Scene>, Frame)>,
    tone: Tone,
    /// What auto exposure adds, stops, where the scene has one: found anew when the hand rests.
    metered: Option<f64>,
    stage: Stage,
    rest_at: Instant,
    moving: Pace,
    editing: Pace,
    /// Tiles drawn, and clouds lit, between two frames of the window.
    helping: Helping,
    lighting: Helping,
    lighting_spent: Duration,
    /// The quality whose light there is. It goes on being used while only the view moves.
    light: Quality,
    work: Option<Work>,
    /// What 1 stands for in `linear`.
    pub(super) unit: f32,
    pub(super) linear: Option<wgpu::Texture>,
    pub(super) screen: Option<Screen>,
    /// Why there is no new picture.
    pub error: Option<String>,
    /// What was drawn and how long it took.
    pub statistics: Statistics,
}

/// While something moves, light that is good to this angle of the sun is kept.
const SLACK_DEG: f64 = 0.5;

impl Canvas {
    /// Draws with `gpu` what `shelf` hands to egui.
    pub fn new(gpu: Gpu, shelf: Shelf) -> Self {
        let renderer = Renderer::new(&gpu.device, &gpu.queue, LINEAR);
        let pace = if gpu.adapter.kind == "Cpu" { Pace::SLOW } else { Pace::default() };
        Self {
            renderer,
            resolve: Resolve::default(),
            shelf,
            window: Context::default(),
            subject: None,
            moment: None,
            tone: Tone::default(),
            metered: None,
            stage: Stage::Moving,
            rest_at: Instant::now(),
            moving: pace,
            editing: pace,
            helping: Helping::of(8),
            lighting: Helping::of(2),
            lighting_spent: Duration::ZERO,
            light: Quality::DRAFT,
            work: None,
            linear: None,
            unit: 1.0,
            screen: None,
            error: None,
            statistics: Statistics::default(),
            gpu,
        }
    }

    /// The picture for egui.
    pub fn image(&self) -> Option<TextureId> {
        self.screen.as_ref().and_then(Screen::id)
    }

    /// The linear picture that is shown, once it is finished.
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        self.linear.as_ref().filter(|_| self.at_rest())
    }

    /// What auto exposure adds to the scene's exposure, stops.
    pub fn metered(&self) -> Option<f64> {
        self.metered
    }

    /// How light becomes the picture, with auto exposure.
    pub fn tone(&self) -> Tone {
        Tone { stops: self.tone.stops + self.metered.unwrap_or(0.0), ..self.tone }
    }

    /// What is seen.
    pub fn subject(&self) -> Option<&Subject> {
        self.subject.as_ref()
    }

    /// The device that it draws with.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Whether there is nothing left to draw.
    pub fn at_rest(&self) -> bool {
        self.subject.as_ref().is_some_and(|subject| self.stage >= subject.finest)
    }

    /// Whether passes are timed and work is counted; makes pictures a little slower.
    pub fn measure(&mut self, on: bool) {
        if self.renderer.settings.counting != on {
            self.renderer.settings.counting = on;
            self.renderer.timing = on.then(|| Timing::new(&self.gpu));
            self.statistics.counts = None;
            self.statistics.passes.clear();
            self.again();
        }
    }

    /// Draws again from preview on.
    pub fn again(&mut self) {
        self.stage = Stage::Moving;
        self.work = None;
    }

    /// Does a share of work for `subject` within `budget`; tells when to come again.
    pub fn update(
        &mut self,
        subject: Subject,
        tone: Tone,
        budget: Duration,
        window: &Context,
    ) -> Option<Duration> {
        self.window = window.clone();
        let step = self.step(subject, tone, budget);
        step.unwrap_or_else(|error| {
            self.error = Some(error.to_string());
            self.work = None;
            self.stage = Stage::Final;
            None
        })
    }

    fn step(&mut self, subject: Subject, tone: Tone, budget: Duration) -> Result<Option<Duration>> {
        let exposed = std::mem::replace(&mut self.tone, tone) != tone;
        let switched = self.switch(&subject);
        let before = self.subject.as_ref();
        let edited = before.is_none_or(|before| !before.same_scene(&subject));
        if edited || before.is_none_or(|before| !before.same_view(&subject)) {
            self.move_to(subject, edited, budget)?;
            return Ok(Some(REST));
        }
        self.subject = Some(subject);
        if exposed || switched {
            self.compose_again()?;
        }
        if self.at_rest() {
            return Ok(None);
        }
        let now = Instant::now();
        if now < self.rest_at {
            return Ok(Some(self.rest_at - now));
        }
        self.refine(budget)?;
        Ok(Some(Duration::ZERO))
    }

    /// Follows the scene's switch of auto exposure; tells whether it was turned.
    fn switch(&mut self, subject: &Subject) -> bool {
        let on = subject.scene.is_metered();
        if self.subject.as_ref().is_none_or(|before| before.scene.is_metered() == on) {
            return false;
        }
        if on {
            self.again();
        }
        self.metered = None;
        true
    }

    /// Meters what is seen, with the light that there is; a picture under way would be lost.
    fn meter(&mut self, frame: &Frame) -> Result<()> {
        if self.subject.as_ref().is_none_or(|subject| !subject.scene.is_metered()) {
            return Ok(());
        }
        let metered = Some(self.renderer.meter(&self.gpu, frame)?);
        if std::mem::replace(&mut self.metered, metered) != metered {
            self.compose_again()?;
        }
        Ok(())
    }

    /// Something moved: a whole picture at once, as fine as there is time for.
    fn move_to(&mut self, subject: Subject, edited: bool, budget: Duration) -> Result<()> {
        if edited {
            self.light = Quality::DRAFT;
        }
        self.abandon();
        let pace = if edited { self.editing } else { self.moving };
        let size = pace.size(subject.size);
        self.subject = Some(subject);
        self.stage = Stage::Moving;
        self.error = None;
        let started = Instant::now();
        let frame = self.frame(Stage::Moving, size)?;
        if self.metered.is_none() {
            self.meter(&frame)?;
        }
        let mut work = self.begin(&frame, Stage::Moving, 1)?;
        self.lit(work.began, budget.mul_f64(LIGHT_SHARE));
        self.draw(&mut work, u32::MAX)?;
        let spent = started.elapsed();
        let pace = if edited { &mut self.editing } else { &mut self.moving };
        pace.measured(1e3 * spent.as_secs_f64(), 1e3 * budget.as_secs_f64());
        work.spent = spent;
        self.show(&work)?;
        self.rest_at = Instant::now() + REST;
        Ok(())
    }

    /// At rest: a helping of the next finer picture.
    fn refine(&mut self, budget: Duration) -> Result<()> {
        let started = Instant::now();
        let mut work = match self.work.take() {
            Some(work) => work,
            None => match self.next(budget)? {
                Some(work) => work,
                None => return Ok(()),
            },
        };
        let tiles = self.helping.count();
        let drawing = Instant::now();
        self.draw(&mut work, tiles)?;
        let ms = 1e3 * drawing.elapsed().as_secs_f64();
        self.helping.measured(tiles, ms, 1e3 * budget.as_secs_f64());
        work.spent += started.elapsed();
        self.statistics.share = work.pieces.share();
        if work.pieces.finished() {
            self.stage = work.stage;
            self.show(&work)?;
            self.rest_at = Instant::now() + (PATIENCE * work.began).min(LONGEST_PATIENCE);
            self.read_statistics()?;
        } else {
            self.work = Some(work);
        }
        Ok(())
    }

    /// The next finer picture; none as long as there is light to make for it, a helping of which is
    /// made.
    fn next(&mut self, budget: Duration) -> Result<Option<Work>> {
        let Some(Subject { size, rays, .. }) = self.subject else { unreachable!("refines what was drawn") };
        let (stage, size, rays) = if self.stage < Stage::Preview {
            if self.light == Quality::DRAFT {
                self.light = Quality::PREVIEW;
            }
            (Stage::Preview, size, 1)
        } else {
            self.light = Quality::FINAL;
            (Stage::Final, size.map(|n| rays * n), rays)
        };
        let started = Instant::now();
        let frame = self.frame(stage, size)?;
        let mut encoder = self.encoder();
        self.renderer.prepare_light(&mut encoder, &frame);
        self.submit(encoder)?;
        let spent = started.elapsed();
        self.lit(spent, budget);
        if self.renderer.lights_waiting() > 0 {
            self.lighting_spent += spent;
            return Ok(None);
        }
        self.meter(&frame)?;
        let before = std::mem::take(&mut self.lighting_spent);
        let mut work = self.begin(&frame, stage, rays)?;
        work.began += before + spent;
        work.spent = before;
        Ok(Some(work))
    }

    /// Learns how long a full helping of light took.
    fn lit(&mut self, spent: Duration, budget: Duration) {
        if self.renderer.lights_waiting() > 0 {
            let [spent, budget] = [spent, budget].map(|time| 1e3 * time.as_secs_f64());
            self.lighting.measured(self.lighting.count(), spent, budget);
        }
    }

    /// Sets the renderer for a stage; what it is to draw.
    fn frame(&mut self, stage: Stage, size: [u32; 2]) -> Result<Frame> {
        let Some(subject) = &self.subject else { unreachable!("there is a subject to draw") };
        let Quality { light_resolution, light_cells, shadow_texels, .. } = self.light;
        self.renderer.settings.quality =
            Quality { light_resolution, light_cells, shadow_texels, ..stage.quality() };
        self.renderer.settings.lights_at_once = self.lighting.count();
        self.renderer.settings.light_slack_deg = if stage == Stage::Moving { SLACK_DEG } else { 0.0 };
        let known = self.moment.take().filter(|(scene, _)| Arc::ptr_eq(scene, &subject.scene));
        let made = || Ok::<_, Error>((subject.scene.clone(), subject.frame(size)?));
        let (_, moment) = &*self.moment.insert(known.map_or_else(made, Ok)?);
        moment.seen_by(&subject.camera, size)
    }

    /// Begins a picture of `frame`, for which the renderer is set.
    fn begin(&mut self, frame: &Frame, stage: Stage, rays: u32) -> Result<Work> {
        let size = frame.size();
        let Some(subject) = &self.subject else { unreachable!("there is a subject to draw") };
        let started = Instant::now();
        let mut encoder = self.encoder();
        let (source, pieces) = match subject.layer {
            Layer::Beauty => {
                let (texture, pieces) = self.renderer.begin_picture(&mut encoder, frame, true);
                (Source::Beauty(texture), pieces)
            }
            Layer::Cost => {
                let (texture, pieces) = self.renderer.begin_cost(&mut encoder, frame);
                (Source::Cost(texture), pieces)
            }
            _ => {
                let (layers, pieces) = self.renderer.begin_layers(&mut encoder, frame);
                (Source::Layers(Box::new(layers)), pieces)
            }
        };
        self.submit(encoder)?;
        let unit = frame.unit();
        Ok(Work { pieces, source, stage, rays, unit, size, began: started.elapsed(), spent: Duration::ZERO })
    }

    fn draw(&mut self, work: &mut Work, tiles: u32) -> Result<()> {
        let mut encoder = self.encoder();
        self.renderer.draw_pieces(&mut encoder, &mut work.pieces, tiles);
        self.submit(encoder)
    }

    fn show(&mut self, work: &Work) -> Result<()> {
        let size = work.size.map(|n| n / work.rays);
        let Some(subject) = &self.subject else { return Ok(()) };
        let (source, shown) = work.source.shown(subject.layer);
        let source = (&view(source), work.rays, shown);
        let mut slot = self.screen.take();
        let screen = self.fit(&mut slot, size);
        let mut encoder = self.encoder();
        if matches!(shown, Shown::Beauty | Shown::Light) {
            let linear = self.renderer.picture("viewport", size, LINEAR);
            self.resolve.draw(&self.gpu.device, &mut encoder, source, &view(&linear), LINEAR);
            self.unit = work.unit;
            let tone = self.tone().in_unit(self.unit);
            self.renderer.compose(&mut encoder, &view(&linear), &screen, SCREEN, tone);
            self.linear = Some(linear);
        } else {
            self.resolve.draw(&self.gpu.device, &mut encoder, source, &screen, SCREEN);
            self.linear = None;
        }
        self.submit(encoder)?;
        self.hang(&mut slot)?;
        self.screen = slot;
        self.statistics.drawn(work.stage, size, work.rays, work.spent);
        self.statistics.light_updates = self.renderer.light_updates();
        Ok(())
    }

    /// What is behind the clouds of `frame`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn sky(&mut self, frame: &Frame) -> Result<Picture> {
        self.renderer.sky_picture(&self.gpu, frame)
    }

    fn abandon(&mut self) {
        self.lighting_spent = Duration::ZERO;
        if self.work.take().is_some() && self.renderer.timing.is_some() {
            // Its time stamps would be read as the next picture's.
            self.renderer.timing = Some(Timing::new(&self.gpu));
        }
    }

    fn read_statistics(&mut self) -> Result<()> {
        if self.renderer.settings.counting {
            self.statistics.counts = Some(self.renderer.counts(&self.gpu)?);
        }
        if let Some(timing) = &self.renderer.timing {
            self.statistics.passes = timing.collect(&self.gpu)?;
        }
        Ok(())
    }

    pub(super) fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu.device.create_command_encoder(&Default::default())
    }

    pub(super) fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.finish("drawing the viewport")
    }
}

pub(super) fn view(texture: &wgpu::Texture) -> TextureView {
    texture.create_view(&Default::default())
}
