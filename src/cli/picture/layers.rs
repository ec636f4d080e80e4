//! Layers of pictures: what is drawn for them.

use super::{Job, Painter, PictureOptions};
use crate::{
    Result,
    export::{self, LayerKind, Layered},
    render::Frame,
    scene::{Movement, Scene},
};

impl PictureOptions {
    /// Whether what is drawn of a moment depends on what comes after it.
    pub fn sees_motion(&self) -> bool {
        self.layers.as_ref().is_some_and(|kinds| kinds.contains(&LayerKind::Motion))
    }

    /// Draws a picture with these layers and writes it, whole or not at all.
    pub(super) fn draw_layers(
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
}
