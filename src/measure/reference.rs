//! References: path traced pictures of the corpus, kept as OpenEXR files.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use super::{Entry, SIZE};
use crate::{
    Error, Result,
    export::{self, Picture},
    gpu::Gpu,
    reference::{Estimate, PathTracer},
    render::Frame,
    scene::Scene,
};

/// A pixel belongs to the cloud where the reference is more opaque than this.
pub const OPAQUE: f32 = 0.3;

/// A path traced picture with what it was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Mean radiance and opacity, colours multiplied by opacity, without background.
    pub picture: Picture,
    /// Standard error of the mean radiance, by channel.
    pub error: Vec<[f32; 3]>,
    /// Samples of each pixel.
    pub samples: u32,
    /// The scene.
    pub scene: Scene,
}

/// When a reference is good enough; the first limit that is met ends it.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Relative noise, no unit: see [`Reference::noise`].
    pub noise: f64,
    /// Samples of each pixel.
    pub samples: u32,
    /// Time, which a last round of samples may exceed by an eighth.
    pub time: Duration,
}

/// How far a reference has come.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Samples of each pixel so far.
    pub samples: u32,
    /// Relative noise so far.
    pub noise: f64,
    /// Share of the way to the nearest limit, 0 to 1.
    pub share: f64,
}

/// Samples of the least round: fewer say little about the noise, and each thread and channel has
/// as many.
const ROUND: u32 = 24;
/// The only seed: other pictures of the same scene need no other.
pub const SEED: u32 = 1;

impl Reference {
    /// Path traces `scene` in rounds, each an eighth of what there is, until a limit is met. Goes on
    /// from an `earlier` reference of the same scene and seed.
    ///
    /// # Errors
    /// Where a cloud's droplets have no phase function, or the device fails.
    pub fn trace(
        gpu: &Gpu,
        scene: &Scene,
        seed: u32,
        limits: &Limits,
        earlier: Option<Self>,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Self> {
        let started = Instant::now();
        let mut tracer = PathTracer::new(gpu, &Frame::new(scene, SIZE)?, seed)?;
        let mut samples = ROUND.min(limits.samples);
        if let Some(earlier) = earlier {
            samples = next_round(earlier.samples, limits);
            tracer = tracer.after(earlier.estimate())?;
        }
        loop {
            tracer.trace(samples, &mut |_| true)?;
            let found = Self::new(tracer.estimate()?, scene);
            let noise = found.noise();
            let time = started.elapsed().as_secs_f64() / limits.time.as_secs_f64().max(1e-3);
            // Noise falls with the root of the samples.
            let share = f64::from(samples) / f64::from(limits.samples);
            let share = share.max(time).max((limits.noise / noise).powi(2)).min(1.0);
            progress(Progress { samples, noise, share });
            if share >= 1.0 {
                return Ok(found);
            }
            samples = next_round(samples, limits);
        }
    }

    fn new(estimate: Estimate, scene: &Scene) -> Self {
        let [width, height] = SIZE.map(|n| n as usize);
        let picture = Picture { width, height, pixels: estimate.mean };
        Self { picture, error: estimate.error, samples: estimate.samples, scene: scene.clone() }
    }

    fn estimate(self) -> Estimate {
        Estimate { mean: self.picture.pixels, error: self.error, samples: self.samples }
    }

    /// Relative standard error of the light: the root of the sum of its variances over the sum
    /// of its squares, over the cloud's pixels.
    pub fn noise(&self) -> f64 {
        let (mut variance, mut squares) = (0.0, 0.0);
        for i in self.cloud() {
            variance += self.variance(i);
            squares += light(&self.picture.pixels[i]).powi(2);
        }
        if variance > 0.0 { (variance / squares).sqrt() } else { 0.0 }
    }

    /// The pixels that show cloud.
    pub fn cloud(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.picture.pixels.len()).filter(|&i| self.picture.pixels[i][3] > OPAQUE)
    }

    /// Variance of the light of pixel `i`. One path carries all three channels, and clouds are
    /// nearly grey: their errors are alike, not independent, and add up as they are.
    pub fn variance(&self, i: usize) -> f64 {
        light(&self.error[i]).powi(2)
    }

    /// Where the reference of `entry` lies in `folder`.
    pub fn path(folder: &Path, entry: &Entry) -> PathBuf {
        folder.join(format!("{}.exr", entry.name))
    }

    /// Writes it as [`export::write_estimate`] does.
    ///
    /// # Errors
    /// [`Error::File`] when the file can't be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        export::write_estimate(path, &self.picture, &self.clone().estimate(), &self.scene)
    }

    /// Reads what [`Reference::write`] wrote.
    ///
    /// # Errors
    /// [`Error::File`] where it can't be read, [`Error::Format`] where it is no reference.
    pub fn read(path: &Path) -> Result<Self> {
        let stored = export::read_estimate(path)?;
        if stored.size != SIZE {
            let [width, height] = stored.size;
            return Err(Error::Format {
                path: path.to_owned(),
                problem: format!(
                    "is no reference: it has {width}x{height} pixels, not {}x{}; make it anew with \
                     `nephos bench reference --force`",
                    SIZE[0], SIZE[1]
                ),
            });
        }
        Ok(Self::new(stored.estimate, &stored.scene))
    }
}

fn next_round(samples: u32, limits: &Limits) -> u32 {
    let more = (samples / 8).next_multiple_of(ROUND).max(ROUND);
    samples.saturating_add(more).min(limits.samples.max(samples))
}

/// Mean of the three channels.
pub fn light(pixel: &[f32]) -> f64 {
    pixel[..3].iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::CORPUS;

    fn reference() -> Reference {
        let pixels = vec![[0.5, 0.25, 0.75, 1.0], [0.125, 0.125, 0.125, 0.5], [9.0, 9.0, 9.0, 0.25]];
        let picture = Picture { width: 3, height: 1, pixels };
        let error = vec![[0.25, 0.25, 0.25], [0.125, 0.25, 0.5], [1.0, 1.0, 1.0]];
        Reference { picture, error, samples: 96, scene: CORPUS[0].scene() }
    }

    #[test]
    fn noise_is_over_the_clouds_pixels() {
        // Light 0.5 and 0.125, standard errors 0.25 and 0.875 / 3; the third pixel is sky.
        let (variance, squares) = (0.0625 + (0.875f64 / 3.0).powi(2), 0.25 + 0.015_625);
        assert!((reference().noise() - (variance / squares).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn files_give_back_what_was_written_and_others_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let count = (SIZE[0] * SIZE[1]) as usize;
        let estimate =
            Estimate { mean: vec![[0.5, 0.25, 0.75, 1.0]; count], error: vec![[0.1; 3]; count], samples: 96 };
        let written = Reference::new(estimate, &CORPUS[0].scene());
        written.write(&path).unwrap();
        assert_eq!(Reference::read(&path).unwrap(), written);
        let small = reference();
        export::write_estimate(&path, &small.picture, &small.clone().estimate(), &small.scene).unwrap();
        assert!(Reference::read(&path).unwrap_err().to_string().contains("3x1 pixels"));
        let missing = Reference::read(&folder.path().join("b.exr")).unwrap_err().to_string();
        assert!(missing.starts_with("cannot read"), "{missing}");
    }
}
