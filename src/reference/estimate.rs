//! What a path tracer has found: means, their errors, and how two findings become one.

use crate::{Error, Result};

/// Light of the clouds alone: without background, multiplied by opacity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// Mean radiance and opacity of each pixel, rows from the top.
    pub mean: Vec<[f32; 4]>,
    /// Standard error of the mean radiance, by channel.
    pub error: Vec<[f32; 3]>,
    /// Samples of each pixel.
    pub samples: u32,
}

impl Estimate {
    /// Relative noise: the root of the summed variance of all pixels' light over the sum of its
    /// square, all channels together. Pixels without cloud add nothing to either; 0 where there is
    /// no light at all.
    pub fn noise(&self) -> f64 {
        let square = |x: &f32| f64::from(*x).powi(2);
        let variance: f64 = self.error.iter().flatten().map(square).sum();
        let light: f64 = self.mean.iter().flat_map(|pixel| &pixel[..3]).map(square).sum();
        if light > 0.0 { (variance / light).sqrt() } else { 0.0 }
    }

    /// Adds the light of another estimate of the same pixels, which has no sample in common with this one.
    pub(super) fn add_light(&mut self, other: &Self) {
        for (pixel, other) in self.mean.iter_mut().zip(&other.mean) {
            pixel[..3].iter_mut().zip(other).for_each(|(pixel, other)| *pixel += other);
        }
        for (error, other) in self.error.iter_mut().zip(&other.error) {
            error.iter_mut().zip(other).for_each(|(error, other)| *error = error.hypot(*other));
        }
    }

    /// This and `other`, which are of the same frame but have no sample in common, as if all
    /// samples had been taken at once (Chan et al. 1979).
    ///
    /// # Errors
    /// [`Error::Argument`] where the numbers of pixels differ.
    pub fn merged(&self, other: &Self) -> Result<Self> {
        if self.mean.len() != other.mean.len() {
            return Err(Error::Argument(format!(
                "pictures of {} and of {} pixels can't be merged: give two of one frame",
                self.mean.len(),
                other.mean.len()
            )));
        }
        let part = |of: &Self, i: usize| Moments::of(of.mean[i], of.error[i], of.samples);
        let pixel = |i| Moments::sum(&[part(self, i), part(other, i)]).mean_and_error();
        let (mean, error) = (0..self.mean.len()).map(pixel).unzip();
        Ok(Self { mean, error, samples: self.samples + other.samples })
    }
}

/// Number, mean, and sum of squared differences from the mean, of some samples of a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments {
    pub count: f64,
    pub mean: [f64; 4],
    pub squares: [f64; 3],
}

impl Moments {
    fn of(mean: [f32; 4], error: [f32; 3], samples: u32) -> Self {
        let count = f64::from(samples);
        let squares = error.map(|error| f64::from(error).powi(2) * count * (count - 1.0).max(1.0));
        Self { count, mean: mean.map(f64::from), squares }
    }

    /// All `parts` together.
    pub(super) fn sum(parts: &[Self]) -> Self {
        let count: f64 = parts.iter().map(|part| part.count).sum();
        let mean = [0, 1, 2, 3]
            .map(|c| parts.iter().map(|part| part.count * part.mean[c]).sum::<f64>() / count.max(1.0));
        let squares = [0, 1, 2].map(|c| {
            let apart = |part: &Self| part.squares[c] + part.count * (part.mean[c] - mean[c]).powi(2);
            parts.iter().map(apart).sum()
        });
        Self { count, mean, squares }
    }

    /// Mean, and standard error of the colours.
    pub(super) fn mean_and_error(self) -> ([f32; 4], [f32; 3]) {
        let n = self.count.max(1.0);
        let error = self.squares.map(|squares| (squares.max(0.0) / (n * (n - 1.0).max(1.0))).sqrt());
        (self.mean.map(|x| x as f32), error.map(|x| x as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The estimate of one pixel whose samples are known.
    fn pixel(samples: &[f32]) -> Estimate {
        let n = samples.len() as f64;
        let mean = samples.iter().map(|x| f64::from(*x)).sum::<f64>() / n;
        let squares: f64 = samples.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum();
        let error = (squares / (n * (n - 1.0).max(1.0))).sqrt() as f32;
        Estimate { mean: vec![[mean as f32; 4]], error: vec![[error; 3]], samples: samples.len() as u32 }
    }

    #[test]
    fn merging_parts_gives_what_all_samples_at_once_give() {
        let samples = [0.5, 2.0, 0.0, 0.0, 7.5, 1.0, 0.25];
        let whole = pixel(&samples);
        for cut in [1, 3, 6] {
            let merged = pixel(&samples[..cut]).merged(&pixel(&samples[cut..])).unwrap();
            assert_eq!(merged.samples, 7);
            assert!((merged.mean[0][1] - whole.mean[0][1]).abs() < 1e-6);
            assert!((merged.error[0][1] - whole.error[0][1]).abs() < 1e-6, "{merged:?} for {whole:?}");
        }
    }

    #[test]
    fn nothing_adds_nothing_and_other_sizes_are_refused() {
        let one = pixel(&[1.0, 3.0]);
        let nothing = Estimate { samples: 0, mean: vec![[0.0; 4]], error: vec![[0.0; 3]] };
        assert_eq!(one.merged(&nothing).unwrap(), one);
        let refusal = one.merged(&Estimate::default()).unwrap_err().to_string();
        assert!(refusal.contains("of 1 and of 0 pixels"), "{refusal}");
    }

    #[test]
    fn noise_is_the_variance_over_the_light() {
        let estimate = Estimate {
            mean: vec![[3.0, 0.0, 4.0, 1.0], [0.0; 4]],
            error: vec![[0.3, 0.0, 0.4], [0.0; 3]],
            samples: 2,
        };
        assert!((estimate.noise() - 0.1).abs() < 1e-6);
        assert_eq!(Estimate::default().noise(), 0.0);
    }
}
