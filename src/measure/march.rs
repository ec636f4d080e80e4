//! Error of the march apart from that of the model: the same model with ever shorter steps,
//! against a march so fine that it has converged. Rays are thin: steps are as short as the
//! quality says, as they are where a cloud is near.

use super::{Reference, SIZE, Truth, Work, draw};
use crate::{
    Result,
    export::Picture,
    gpu::Gpu,
    render::{Quality, Renderer, Transport},
    scene::Scene,
};

/// Steps of the final quality over those of a point of the curve.
const SCALES: [f32; 7] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// The same for the converged march.
const CONVERGED: f32 = 0.2;

/// A march of some length of steps.
#[derive(Debug, Clone, serde::Serialize)]
pub struct MarchPoint {
    /// Name of the scene.
    pub scene: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Name of the quality that it is the march of; none for a point of the curve.
    pub quality: Option<&'static str>,
    /// Length of the steps over that of the final quality; none for a quality.
    pub scale: Option<f32>,
    /// Relative RMSE against the converged march.
    pub rmse: f64,
    /// Work of the picture.
    pub work: Work,
}

/// Final quality with steps `scale` times as long, opacity and light as they are.
fn stepped(scale: f32) -> Quality {
    let fine = Quality::FINAL;
    Quality {
        first_step: fine.first_step * scale,
        growth: fine.growth.powf(scale),
        longest_step: fine.longest_step * scale,
        max_steps: 16_384,
        ..fine
    }
}

/// The march of `quality`, light found as in final quality.
fn march_of(quality: &Quality) -> Quality {
    let Quality { first_step, growth, longest_step, opaque, max_steps, jitter, .. } = *quality;
    Quality { first_step, growth, longest_step, opaque, max_steps, jitter, ..Quality::FINAL }
}

/// The curve of `model` on `scene` and the marches of the named qualities, one ray a pixel.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn curve(
    gpu: &Gpu,
    renderer: &mut Renderer,
    (name, scene): (&'static str, &Scene),
    model: (&'static str, Transport),
    progress: &mut dyn FnMut(),
) -> Result<Vec<MarchPoint>> {
    renderer.settings.transport = model.1;
    let (picture, _) = drawn(gpu, renderer, scene, stepped(CONVERGED))?;
    progress();
    let error = vec![[0.0; 3]; picture.pixels.len()];
    let reference = Reference { picture, error, samples: 0, scene: scene.clone() };
    let black = Picture { pixels: vec![[0.0; 4]; reference.picture.pixels.len()], ..reference.picture };
    let truth = Truth { reference: &reference, sky: &black };
    let curve = SCALES.map(|scale| (None, Some(scale), stepped(scale)));
    let qualities = Quality::PRESETS.map(|(name, quality)| (Some(name), None, march_of(&quality)));
    let mut points = Vec::new();
    for (quality, scale, steps) in curve.into_iter().chain(qualities) {
        let (picture, work) = drawn(gpu, renderer, scene, steps)?;
        let rmse = truth.rmse(&picture);
        points.push(MarchPoint { scene: name, model: model.0, quality, scale, rmse, work });
        progress();
    }
    Ok(points)
}

/// Pictures that one curve takes.
pub const PICTURES: usize = 1 + SCALES.len() + Quality::PRESETS.len();

fn drawn(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, quality: Quality) -> Result<(Picture, Work)> {
    renderer.settings.quality = quality;
    renderer.settings.counting = true;
    let picture = draw::thin_rays(gpu, renderer, scene, SIZE);
    renderer.settings.counting = false;
    Ok((picture?, Work::new(&renderer.counts(gpu)?, SIZE)))
}
