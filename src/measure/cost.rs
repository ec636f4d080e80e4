//! What a picture costs: time, and exact counts of work.

use std::time::Instant;

use super::Way;
use crate::{
    Result,
    gpu::{Gpu, PassTime, Timing},
    render::{Counts, Film, Renderer, Target},
    scene::{Scene, SunPosition},
};

/// Cost of one way of drawing one picture. Times are medians over repeats with everything
/// compiled and at hand; they include the rays of supersampling, but not their average.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Cost {
    /// Name of the picture.
    pub scene: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Name of the quality.
    pub quality: &'static str,
    /// Wall time of a frame while the camera moves and sun and shape stay, milliseconds.
    pub frame_ms: f64,
    /// What a frame takes more when the sun has moved: the light inside the clouds and the sky
    /// are found anew, milliseconds.
    pub light_ms: f64,
    /// Time of each pass of such a frame by the adapter's clock, empty where it has none.
    pub frame_passes: Vec<PassTime>,
    /// The same when the sun has moved.
    pub light_passes: Vec<PassTime>,
    /// Work of a frame, by pixel of the finished picture.
    pub work: Work,
}

/// Work by pixel of the finished picture.
#[derive(Debug, Clone, Copy, Default, serde::Serialize)]
pub struct Work {
    /// Rays launched.
    pub rays: f64,
    /// Steps along rays.
    pub steps: f64,
    /// Evaluations of the density.
    pub density: f64,
    /// Reads of the noise volume.
    pub noise_reads: f64,
    /// Reads of sun maps, sun volume, sky volume and tables.
    pub map_reads: f64,
}

impl Work {
    /// Counts of a picture over its pixels.
    pub fn new(counts: &Counts, [width, height]: [u32; 2]) -> Self {
        let each = |count: u64| count as f64 / f64::from(width * height);
        Self {
            rays: each(counts.rays),
            steps: each(counts.steps),
            density: each(counts.density_evaluations),
            noise_reads: each(counts.noise_reads),
            map_reads: each(counts.map_reads),
        }
    }

    /// Evaluations of the density and reads of noise and maps: one number for all of it.
    pub fn total(&self) -> f64 {
        self.density + self.noise_reads + self.map_reads
    }
}

/// Times frames of `size` pixels.
pub struct Stopwatch<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Size of the finished pictures, pixels.
    pub size: [u32; 2],
    /// How often the time of a frame is taken at most; that of light, a third as often. Frames that
    /// take long are drawn less often: noise is a smaller share of them.
    pub repeats: u32,
}

/// No more repeats where those so far took this long together, milliseconds.
const ENOUGH: f64 = 3000.0;

impl Stopwatch<'_> {
    /// The cost of drawing `scene`, named `name`, one way.
    ///
    /// # Errors
    /// Where the scene is not valid or the device fails.
    pub fn cost(
        &self,
        renderer: &mut Renderer,
        name: &'static str,
        scene: &Scene,
        way: &Way,
    ) -> Result<Cost> {
        way.set(renderer);
        let film = Film::of_quality(self.size, &way.quality.1);
        renderer.settings.counting = true;
        self.frame(renderer, scene, film)?;
        let work = Work::new(&renderer.counts(self.gpu)?, self.size);
        renderer.settings.counting = false;
        renderer.timing = Some(Timing::new(self.gpu));
        // Compiles what the counting variant did not.
        self.frame(renderer, scene, film)?;
        let (frame_ms, frame_passes) = self.median(renderer, scene, film, camera_moved, self.repeats)?;
        // Slow, and long enough that few repeats tell.
        let seldom = self.repeats.div_ceil(3);
        let (with_light, light_passes) = self.median(renderer, scene, film, sun_moved, seldom)?;
        renderer.timing = None;
        Ok(Cost {
            scene: name,
            model: way.model.0,
            quality: way.quality.0,
            frame_ms,
            light_ms: (with_light - frame_ms).max(0.0),
            frame_passes,
            light_passes,
            work,
        })
    }

    /// Median of the wall time and of each pass's over repeats, each of a changed scene.
    fn median(
        &self,
        renderer: &mut Renderer,
        scene: &Scene,
        film: Film,
        changed: fn(&Scene, f64) -> Scene,
        repeats: u32,
    ) -> Result<(f64, Vec<PassTime>)> {
        let (mut walls, mut passes) = (Vec::new(), Vec::new());
        for repeat in 1..=repeats.max(1) {
            let scene = changed(scene, f64::from(repeat));
            walls.push(self.frame(renderer, &scene, film)?);
            if let Some(timing) = &renderer.timing {
                passes.push(timing.collect(self.gpu)?);
            }
            if walls.iter().sum::<f64>() > ENOUGH {
                break;
            }
        }
        Ok((middle(walls), medians(&passes)))
    }

    /// Draws one frame and waits for it; wall time, milliseconds.
    fn frame(&self, renderer: &mut Renderer, scene: &Scene, film: Film) -> Result<f64> {
        let frame = film.frame(scene)?;
        let texture = renderer.picture("timed", frame.size(), wgpu::TextureFormat::Rgba16Float);
        let view = texture.create_view(&Default::default());
        self.gpu.finish("making room for a picture")?;
        let started = Instant::now();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        renderer.render(&mut encoder, &frame, &Target { color: &view, depth: None, sky: true });
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.finish("drawing a timed frame")?;
        Ok(1e3 * started.elapsed().as_secs_f64())
    }
}

/// A thousandth of the distance to the side at a time.
fn camera_moved(scene: &Scene, times: f64) -> Scene {
    let mut camera = scene.camera();
    let side = camera.world_from_camera() * glam::DVec3::X;
    camera.position += 1e-3 * times * camera.position.distance(camera.target) * side;
    Scene { camera: Some(camera), ..scene.clone() }
}

/// A tenth of a degree or so at a time.
fn sun_moved(scene: &Scene, times: f64) -> Scene {
    let mut scene = scene.clone();
    let moved = scene.sun.to_sun() + 2e-3 * times * glam::DVec3::X;
    scene.sun.position = SunPosition::Direction(moved);
    scene
}

pub(super) fn medians(frames: &[Vec<PassTime>]) -> Vec<PassTime> {
    let Some(first) = frames.first() else { return Vec::new() };
    let of = |pass: &'static str| {
        let times = frames.iter().flatten().filter(|time| time.pass == pass).map(|time| time.ms);
        PassTime { pass, ms: middle(times.collect()) }
    };
    first.iter().map(|time| of(time.pass)).collect()
}

/// The median, the upper one of two; 0 of nothing.
pub(super) fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_of_each_pass() {
        let frame = |a, b| vec![PassTime { pass: "a", ms: a }, PassTime { pass: "b", ms: b }];
        let found = medians(&[frame(3.0, 10.0), frame(1.0, 30.0), frame(2.0, 20.0)]);
        assert_eq!(found, frame(2.0, 20.0));
        assert_eq!((middle(Vec::new()), medians(&[])), (0.0, Vec::new()));
    }
}
