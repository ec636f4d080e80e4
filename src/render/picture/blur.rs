//! Motion blur and depth of field: the mean of pictures at moments while the shutter is open, through points of the
//! lens.

use super::{Film, Picture, Renderer};
use crate::{Result, frame::Frame, gpu::Gpu, scene::Scene};

/// The golden angle, rad: points that turn by it from one to the next fill a disc evenly (Vogel 1979).
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// What steps by it, modulo 1, is even at every count: the inverse of the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// How long a picture is exposed, and how many pictures it is the mean of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blur {
    /// Pictures, at least 1.
    pub samples: u32,
    /// How long the shutter is open, s; the scene's own time is in the middle.
    pub open: f64,
}

impl Blur {
    /// The moment of sample `i`, s from the middle.
    fn moment(&self, i: u32) -> f64 {
        let share = (0.5 / f64::from(self.samples) + GOLDEN * f64::from(i)).fract();
        self.open * (share - 0.5)
    }

    /// The point of the lens of sample `i`, in a disc of radius 1.
    fn point(&self, i: u32) -> [f64; 2] {
        let radius = ((f64::from(i) + 0.5) / f64::from(self.samples)).sqrt();
        let (sin, cos) = (GOLDEN_ANGLE * f64::from(i)).sin_cos();
        [radius * cos, radius * sin]
    }

    /// The moments that it needs of `scene`, s.
    pub fn moments(&self, scene: &Scene) -> impl Iterator<Item = f64> {
        let (blur, time) = (*self, scene.time);
        (0..self.samples).map(move |i| time + blur.moment(i))
    }
}

impl Film {
    /// Takes a picture that is the mean of several: light itself, before tone curves. Tells the share done.
    ///
    /// # Errors
    /// Where the scene is not valid at a moment, and as [`Film::take`].
    pub fn expose(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        scene: &Scene,
        blur: Blur,
        sky: bool,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Picture> {
        let samples = blur.samples.max(1);
        let mut sum: Option<Picture> = None;
        for i in 0..samples {
            let frame = self.sample(scene, blur, i)?;
            let mut own = |share: f64| progress((f64::from(i) + share) / f64::from(samples));
            let picture = self.take(gpu, renderer, &frame, sky, &mut own)?;
            match &mut sum {
                Some(sum) => add(sum, &picture),
                none => *none = Some(picture),
            }
        }
        let mut mean = sum.expect("there is at least one sample");
        mean.pixels.iter_mut().flatten().for_each(|c| *c /= samples as f32);
        Ok(mean)
    }

    /// What one sample is of.
    fn sample(&self, scene: &Scene, blur: Blur, i: u32) -> Result<Frame> {
        let scene = Scene { time: scene.time + blur.moment(i), ..scene.clone() };
        let frame = self.frame(&scene)?;
        let camera = scene.at(scene.time)?.camera();
        if camera.aperture.is_none() {
            return Ok(frame);
        }
        let [width, height] = frame.size();
        let aspect = f64::from(width) / f64::from(height);
        Ok(frame.seen_by(&camera.through(blur.point(i), aspect), [width, height])?.holding_the_disc())
    }
}

fn add(sum: &mut Picture, other: &Picture) {
    for (sum, own) in sum.pixels.iter_mut().flatten().zip(other.pixels.iter().flatten()) {
        *sum += own;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_fill_the_time_and_the_lens_evenly() {
        for samples in [1, 2, 7, 16, 64] {
            let blur = Blur { samples, open: 0.5 };
            let n = f64::from(samples);
            let times: Vec<_> = (0..samples).map(|i| blur.moment(i)).collect();
            assert!(times.iter().all(|time| time.abs() <= 0.25));
            assert!((times.iter().sum::<f64>() / n).abs() < 0.25 / n.max(2.0), "{samples}");
            let points: Vec<_> = (0..samples).map(|i| blur.point(i)).collect();
            // The mean square of the radius of a disc is a half.
            let square = points.iter().map(|[x, y]| x * x + y * y).sum::<f64>() / n;
            assert!((square - 0.5).abs() < 1e-9, "{samples}: {square}");
            if samples >= 16 {
                let middle = [0, 1].map(|c| points.iter().map(|point| point[c]).sum::<f64>() / n);
                assert!(middle.iter().all(|c| c.abs() < 0.06), "{middle:?}");
            }
        }
    }
}
