//! Pictures that are drawn over several of the caller's frames: an editor whose window
//! must stay alive asks for a few tiles at a time.

use std::sync::Arc;

use wgpu::TextureView;

use super::{
    Draw, Drawn, Flush, HDR, Layers, LightLayers, Matte, Renderer, Target, Way, clear, draws::in_order,
    matte::MatteTarget, view,
};
use crate::{
    Result,
    frame::{Frame, LitBy},
    gpu::Gpu,
    render::march::{EVERYTHING, PLACES, VISIBILITY},
};

/// Tiles of one submission, of at most 256 pixels each: a second or two in final quality on two
/// CPU cores.
const PIECE: u32 = 256;

/// Bytes of a pixel of all that one march can tell: six pictures of half floats, and a matte.
const BYTES_OF_EVERYTHING: u32 = 6 * 8 + 4;

/// What is drawn apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Apart {
    /// Light.
    Light,
    /// Each cloud, too.
    Clouds,
}

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
    /// Where the one cloud of it goes by itself, beside these.
    matte: Option<MatteTarget>,
}

impl Stage {
    fn new(draws: Arc<[Draw]>, targets: &[&TextureView]) -> Self {
        Self { draws, targets: targets.iter().map(|&view| view.clone()).collect(), matte: None }
    }
}

/// What is told of a picture's places.
struct Places {
    distance: wgpu::Texture,
    normal: wgpu::Texture,
    mattes: Vec<Matte>,
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
        let way = Way { depth: target.depth.as_ref(), ..Way::over("beauty", self.format) };
        self.begin_drawn(encoder, frame, way, target.color)
    }

    /// Begins the clouds into one target.
    fn begin_drawn(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        way: Way<'_>,
        target: &TextureView,
    ) -> Pieces {
        let Drawn { crossing, draws, .. } = self.draws(frame, way);
        let stages = self.begin_crossings(encoder, crossing, target).into_iter();
        Pieces::new(stages.chain([Stage::new(draws, &[target])]).collect())
    }

    /// Begins the visibilities of clouds that cross others, in the pixels of `target`, which stays as it is; nothing where
    /// none do.
    fn begin_crossings(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        crossing: Arc<[Draw]>,
        target: &TextureView,
    ) -> Option<Stage> {
        (!crossing.is_empty()).then(|| {
            self.march.clear_visibilities(encoder, &self.crossings);
            Stage::new(crossing, &[target])
        })
    }

    /// Begins the light of `frame` apart: [`Renderer::render_layers`] in pieces.
    pub fn begin_layers(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame) -> (Layers, Pieces) {
        self.begin_apart(encoder, frame, Apart::Light, &mut |_| true)
    }

    /// The same; `flush` may submit the light of the clouds one by one.
    pub(super) fn begin_apart(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        apart: Apart,
        flush: Flush<'_>,
    ) -> (Layers, Pieces) {
        self.prepare(encoder, frame, flush);
        let crossing = self.crossing_draws(frame, Way::over(VISIBILITY, HDR));
        let [distance, normal] = ["distance", "normal"].map(|label| self.cleared(encoder, label, frame));
        let mut work: Vec<_> =
            self.begin_crossings(encoder, crossing, &view(&distance)).into_iter().collect();
        let mut places = Places { distance, normal, mattes: Vec::new() };
        let sun = self.begin_sun(encoder, frame, apart, &mut places, &mut work);
        let further = frame.lights().iter().map(|light| {
            let lit = frame.lit_by(light);
            let layers = self.light_layers(encoder, &lit, Some(light.number));
            let draws = self.light_draws(&lit, Some(light.number));
            work.push(Stage::new(draws, &layers.of_clouds().each_ref()));
            (light.name.clone(), layers)
        });
        let lights = further.collect();
        let Places { distance, normal, mattes } = places;
        (Layers { sun, lights, distance, normal, mattes, unit: frame.unit() }, Pieces::new(work))
    }

    /// What [`Renderer::begin_apart`] draws in the light of the sun, and what is where: in one march where all of that
    /// goes into the targets of a pass.
    fn begin_sun(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        apart: Apart,
        places: &mut Places,
        work: &mut Vec<Stage>,
    ) -> LightLayers {
        let sun = self.light_layers(encoder, frame, None);
        let light = sun.of_clouds();
        let where_it_is = [&places.normal, &places.distance].map(view);
        let targets = if self.has_room_for_everything() {
            light.iter().chain(&where_it_is).collect()
        } else {
            work.push(Stage::new(self.light_draws(frame, None), &light.each_ref()));
            where_it_is.iter().collect::<Vec<_>>()
        };
        let entry = if targets.len() > where_it_is.len() { EVERYTHING } else { PLACES };
        let mattes = apart == Apart::Clouds;
        let draws = self.draws_of(frame, None, Way { mattes, ..Way::over(entry, HDR) });
        if mattes {
            let texture = self.matte_texture(frame.size());
            for (cloud, draw) in draws {
                let matte = Matte::new(&self.device, frame.clouds[cloud].number, &self.covers.all()[cloud]);
                let own = MatteTarget::new(&texture, &matte);
                work.push(Stage { matte: Some(own), ..Stage::new([draw].into(), &targets) });
                places.mattes.push(matte);
            }
        } else {
            work.push(Stage::new(in_order(draws), &targets));
        }
        sun
    }

    /// Whether light apart and what is where go into the targets of one pass.
    fn has_room_for_everything(&self) -> bool {
        self.device.limits().max_color_attachment_bytes_per_sample >= BYTES_OF_EVERYTHING
    }

    /// Pictures for the light of the sun or of another, by its number; the sky is drawn at once.
    fn light_layers(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        number: Option<usize>,
    ) -> LightLayers {
        let sky = self.cleared(encoder, "sky", frame);
        let lamp = number.map_or(Some(&mut self.sun), |number| self.further[number].as_mut());
        if let Some(lamp) = lamp.filter(|_| frame.by == LitBy::Sky) {
            lamp.draw_sky(&self.device, encoder, (&view(&sky), HDR), false, self.timing.as_ref());
        }
        let [single, multiple, ambient, air] =
            ["single", "multiple", "ambient", "air"].map(|label| self.cleared(encoder, label, frame));
        LightLayers { sky, single, multiple, ambient, air }
    }

    /// The clouds into those, in that light.
    fn light_draws(&mut self, frame: &Frame, number: Option<usize>) -> Arc<[Draw]> {
        let way = Way::over("layers", HDR);
        let mut draws = self.draws_of(frame, number, way);
        if matches!(frame.by, LitBy::Flash(..)) {
            draws = self.among_dark(frame, draws, way);
        }
        in_order(draws)
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
        let pieces = self.begin_drawn(encoder, frame, Way::over("cost", HDR), &view(&cost));
        (cost, pieces)
    }

    /// Records the next `tiles` tiles; submit the encoder before the next call.
    pub fn draw_pieces(&self, encoder: &mut wgpu::CommandEncoder, pieces: &mut Pieces, tiles: u32) {
        let mut left = tiles;
        while left > 0
            && let Some(stage) = pieces.stages.get(pieces.stage)
        {
            let begins = (pieces.draw, pieces.tile) == (0, 0);
            let matte = stage.matte.as_ref().map(|matte| (matte.view(), begins));
            let mut pass = self.clouds_pass(encoder, &stage.targets, matte);
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
            drop(pass);
            if pieces.draw == stage.draws.len() {
                stage.matte.iter().for_each(|matte| matte.keep(encoder));
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
