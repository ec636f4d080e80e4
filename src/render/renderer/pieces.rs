//! Pictures that are drawn over several of the caller's frames: an editor whose window
//! must stay alive asks for a few tiles at a time.

use wgpu::TextureView;

use super::{Draw, HDR, Layers, Renderer, Target, clear, view};
use crate::render::Frame;

/// A picture under way: what [`Renderer::draw_pieces`] has yet to draw. It stays good until
/// another frame is begun on its renderer.
pub struct Pieces {
    stages: Vec<Stage>,
    stage: usize,
    tile: u32,
    done: u32,
    total: u32,
}

/// One cloud into its targets.
struct Stage {
    draw: Draw,
    targets: Vec<TextureView>,
    format: wgpu::TextureFormat,
}

impl Pieces {
    fn new(stages: Vec<Stage>) -> Self {
        let total = stages.iter().map(|stage| stage.draw.tiles).sum();
        Self { stages, stage: 0, tile: 0, done: 0, total }
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
        let draws = self.begin(encoder, frame, target);
        Pieces::new(stages(draws, &[target.color], self.format))
    }

    /// Begins the light of `frame` apart: [`Renderer::render_layers`] in pieces.
    pub fn begin_layers(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame) -> (Layers, Pieces) {
        self.prepare(encoder, frame);
        let [sky, single, multiple, air, distance, normal] =
            ["sky", "single", "multiple", "air", "distance", "normal"]
                .map(|label| self.picture(label, frame.size(), HDR));
        self.sky.draw(&self.device, encoder, &view(&sky), HDR, self.timing.as_ref());
        let targets = [&single, &multiple, &air, &distance, &normal].map(view);
        targets.iter().for_each(|target| clear(encoder, target));
        let [single_to, multiple_to, air_to, distance_to, normal_to] = &targets;
        let mut work = stages(self.draws(frame, None, "normals", HDR), &[normal_to], HDR);
        let lit = [single_to, multiple_to, air_to, distance_to];
        work.extend(stages(self.draws(frame, None, "layers", HDR), &lit, HDR));
        (Layers { sky, single, multiple, air, distance, normal }, Pieces::new(work))
    }

    /// Begins the work of each pixel of `frame`: steps, evaluations of the density and reads
    /// of maps, all clouds added up, in the first three channels of the texture.
    pub fn begin_cost(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
    ) -> (wgpu::Texture, Pieces) {
        self.prepare(encoder, frame);
        let cost = self.picture("cost", frame.size(), HDR);
        clear(encoder, &view(&cost));
        let draws = self.draws(frame, None, "cost", HDR);
        let work = stages(draws, &[&view(&cost)], HDR);
        (cost, Pieces::new(work))
    }

    /// Records the next `tiles` tiles; submit the encoder before the next call.
    pub fn draw_pieces(&self, encoder: &mut wgpu::CommandEncoder, pieces: &mut Pieces, tiles: u32) {
        let mut left = tiles;
        while left > 0
            && let Some(stage) = pieces.stages.get(pieces.stage)
        {
            let last = (pieces.tile + left).min(stage.draw.tiles);
            let targets: Vec<_> = stage.targets.iter().collect();
            self.draw_clouds(encoder, &stage.draw, pieces.tile..last, &targets, stage.format);
            left -= last - pieces.tile;
            pieces.done += last - pieces.tile;
            pieces.tile = last;
            if last == stage.draw.tiles {
                pieces.stage += 1;
                pieces.tile = 0;
            }
        }
        if pieces.finished() {
            self.end(encoder);
        }
    }
}

fn stages(draws: Vec<Draw>, targets: &[&TextureView], format: wgpu::TextureFormat) -> Vec<Stage> {
    let stage = |draw| Stage { draw, targets: targets.iter().map(|&view| view.clone()).collect(), format };
    draws.into_iter().map(stage).collect()
}
