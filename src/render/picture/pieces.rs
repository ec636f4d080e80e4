//! Pictures that are drawn over several of the caller's frames: an editor whose window
//! must stay alive asks for a few tiles at a time.

use std::sync::Arc;

use wgpu::TextureView;

use super::{Draw, Flush, HDR, Layers, LightLayers, Renderer, Target, Way, clear, view};
use crate::{
    Result,
    frame::{Frame, LitBy},
    gpu::Gpu,
};

/// Tiles of one submission, of at most 256 pixels each: a second or two in final quality on two
/// CPU cores.
const PIECE: u32 = 256;

/// A picture under way: what [`Renderer::draw_pieces`] has yet to draw. It stays good until
/// another frame is begun on its renderer.
pub struct Pieces {
    stages: Vec<Stage>,
    stage: usize,
    draw: usize,
    tile: u32,
    done: u32,
    total: u32,
}

/// Clouds into their targets.
struct Stage {
    draws: Arc<[Draw]>,
    targets: Vec<TextureView>,
}

impl Stage {
    fn new(draws: Arc<[Draw]>, targets: &[&TextureView]) -> Self {
        Self { draws, targets: targets.iter().map(|&view| view.clone()).collect() }
    }
}

/// Without the numbers of the clouds.
pub(super) fn in_order(draws: Vec<(usize, Draw)>) -> Arc<[Draw]> {
    draws.into_iter().map(|(_, draw)| draw).collect()
}

impl Pieces {
    fn new(stages: Vec<Stage>) -> Self {
        let total = stages.iter().flat_map(|stage| stage.draws.iter()).map(|draw| draw.tiles).sum();
        Self { stages, stage: 0, draw: 0, tile: 0, done: 0, total }
    }

    /// Whether nothing is left to draw.
    pub fn finished(&self) -> bool {
        self.done == self.total
    }

    /// Share that is drawn, 0 to 1.
    pub fn share(&self) -> f64 {
        if self.total == 0 { 1.0 } else { f64::from(self.done) / f64::from(self.total) }
    }

    /// Tiles in all: at most 256 pixels each.
    pub fn tiles(&self) -> u32 {
        self.total
    }
}

impl Renderer {
    /// Records what comes before the clouds of `frame`, the sky where wanted; the clouds are
    /// left to [`Renderer::draw_pieces`]. Submit the encoder before the first piece.
    pub fn begin_pieces(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        target: &Target<'_>,
    ) -> Pieces {
        self.begin(encoder, frame, target, &mut |_| true)
    }

    /// The same; `flush` may submit the light of the clouds one by one.
    pub(super) fn begin(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        target: &Target<'_>,
        flush: Flush<'_>,
    ) -> Pieces {
        self.prepare(encoder, frame, flush);
        if target.sky {
            self.draw_sky(encoder, frame, target.color, self.format);
        }
        let way = Way { depth: target.depth.as_ref(), entry: "beauty", format: self.format, adds: false };
        let draws = self.draws(frame, way);
        Pieces::new(vec![Stage::new(draws, &[target.color])])
    }

    /// Begins the light of `frame` apart: [`Renderer::render_layers`] in pieces.
    pub fn begin_layers(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame) -> (Layers, Pieces) {
        self.begin_apart(encoder, frame, &mut |_| true)
    }

    /// The same; `flush` may submit the light of the clouds one by one.
    pub(super) fn begin_apart(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        flush: Flush<'_>,
    ) -> (Layers, Pieces) {
        self.prepare(encoder, frame, flush);
        let [distance, normal] = ["distance", "normal"].map(|label| self.cleared(encoder, label, frame));
        let normals =
            self.draws_of(frame, None, Way { depth: None, entry: "normals", format: HDR, adds: false });
        let mut work = vec![Stage::new(in_order(normals), &[&view(&normal)])];
        let (sun, stage) = self.begin_light(encoder, frame, None, &view(&distance));
        work.push(stage);
        // How far clouds are is the same in all lights.
        let same = view(&self.picture("the same distance", frame.size(), HDR));
        let further = frame.lights().iter().map(|light| {
            let (layers, stage) = self.begin_light(encoder, &frame.lit_by(light), Some(light.number), &same);
            work.push(stage);
            (light.name.clone(), layers)
        });
        let lights = further.collect();
        (Layers { sun, lights, distance, normal, unit: frame.unit() }, Pieces::new(work))
    }

    /// What [`Renderer::begin_apart`] draws in the light of the sun or of another, by its number; the sky at once.
    fn begin_light(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        number: Option<usize>,
        distance: &TextureView,
    ) -> (LightLayers, Stage) {
        let sky = self.cleared(encoder, "sky", frame);
        let lamp = number.map_or(Some(&mut self.sun), |number| self.further[number].as_mut());
        if let Some(lamp) = lamp.filter(|_| frame.by == LitBy::Sky) {
            lamp.draw_sky(&self.device, encoder, (&view(&sky), HDR), false, self.timing.as_ref());
        }
        let [single, multiple, air] =
            ["single", "multiple", "air"].map(|label| self.cleared(encoder, label, frame));
        let way = Way { depth: None, entry: "layers", format: HDR, adds: false };
        let mut draws = self.draws_of(frame, number, way);
        if matches!(frame.by, LitBy::Flash(..)) {
            draws = self.among_dark(frame, draws, way);
        }
        let draws = in_order(draws);
        let [to_single, to_multiple, to_air] = [&single, &multiple, &air].map(view);
        let stage = Stage::new(draws, &[&to_single, &to_multiple, &to_air, distance]);
        (LightLayers { sky, single, multiple, air }, stage)
    }

    /// A picture with nothing in it yet.
    fn cleared(&self, encoder: &mut wgpu::CommandEncoder, label: &str, frame: &Frame) -> wgpu::Texture {
        let picture = self.picture(label, frame.size(), HDR);
        clear(encoder, &view(&picture));
        picture
    }

    /// Begins the work of each pixel of `frame`: steps, evaluations of the density and reads
    /// of maps, all clouds added up, in the first three channels of the texture.
    pub fn begin_cost(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
    ) -> (wgpu::Texture, Pieces) {
        self.prepare(encoder, frame, &mut |_| true);
        let cost = self.picture("cost", frame.size(), HDR);
        clear(encoder, &view(&cost));
        let draws = self.draws(frame, Way { depth: None, entry: "cost", format: HDR, adds: false });
        let work = Stage::new(draws, &[&view(&cost)]);
        (cost, Pieces::new(vec![work]))
    }

    /// Records the next `tiles` tiles; submit the encoder before the next call.
    pub fn draw_pieces(&self, encoder: &mut wgpu::CommandEncoder, pieces: &mut Pieces, tiles: u32) {
        let mut left = tiles;
        while left > 0
            && let Some(stage) = pieces.stages.get(pieces.stage)
        {
            let mut pass = self.clouds_pass(encoder, &stage.targets);
            let mut before = None;
            while left > 0
                && let Some(draw) = stage.draws.get(pieces.draw)
            {
                let drawn = left.min(draw.tiles - pieces.tile);
                draw.record(&mut pass, pieces.tile..pieces.tile + drawn, before.replace(draw));
                left -= drawn;
                pieces.done += drawn;
                pieces.tile += drawn;
                if pieces.tile == draw.tiles {
                    (pieces.draw, pieces.tile) = (pieces.draw + 1, 0);
                }
            }
            if pieces.draw == stage.draws.len() {
                (pieces.stage, pieces.draw) = (pieces.stage + 1, 0);
            }
        }
        if pieces.finished() {
            self.end(encoder);
        }
    }

    /// Draws what is left, [`PIECE`] tiles a submission.
    pub(super) fn draw_all(
        &self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
        mut pieces: Pieces,
        progress: &mut dyn FnMut(f64),
    ) -> Result<()> {
        loop {
            self.draw_pieces(&mut encoder, &mut pieces, PIECE);
            let full = std::mem::replace(&mut encoder, self.encoder());
            self.queue.submit([full.finish()]);
            gpu.finish("drawing clouds")?;
            progress(pieces.share());
            if pieces.finished() {
                return Ok(());
            }
        }
    }
}
