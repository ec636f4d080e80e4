//! How much relief a picture has inside clouds beside its reference, by scale.
//!
//! Light is blurred by a Gaussian and by one of twice its width, of what lies in the cloud alone. The difference over the wider
//! blur is the relief of about that size, as a share of the light there. Noise of the reference has relief, too, which is known
//! from its variance and taken off.

use super::Reference;

/// Standard deviations of the narrower Gaussian, pixels.
pub const SCALES: [f64; 3] = [1.5, 3.0, 6.0];

/// A pixel lies inside the cloud where the reference is more opaque than this.
const INSIDE: f32 = 0.95;
/// Pixels that a picture needs inside of clouds, so that it tells more than noise.
const LEAST_PIXELS: usize = 200;
/// The largest share of a reference's relief that may be noise.
const MOST_NOISE: f64 = 0.5;

/// What is inside of the clouds of a reference, and its relief.
pub struct Relief {
    inside: Vec<f64>,
    width: usize,
    /// Mean square of the reference's relief by scale, without noise; none where it is mostly that.
    squares: [Option<f64>; 3],
}

impl Relief {
    /// That of a reference.
    pub fn new(reference: &Reference) -> Self {
        let pixels = &reference.picture.pixels;
        let inside = |p: &[f32; 4]| f64::from(u8::from(p[3] > INSIDE));
        let light: Vec<f64> = pixels.iter().map(|p| super::light(p)).collect();
        let variance: Vec<f64> = (0..pixels.len()).map(|i| reference.variance(i)).collect();
        let inside: Vec<f64> = pixels.iter().map(inside).collect();
        let mut relief = Self { inside, width: reference.picture.width, squares: [None; 3] };
        if relief.inside.iter().sum::<f64>() >= LEAST_PIXELS as f64 {
            relief.squares = SCALES.map(|scale| {
                let whole = relief.mean_square(&light, scale);
                let noise = relief.noise(&light, &variance, scale);
                (noise < MOST_NOISE * whole).then_some(whole - noise)
            });
        }
        relief
    }

    /// The relief of `drawn` light, pixel by pixel, over the reference's, by scale: roots of mean squares. None where the
    /// reference does not tell it.
    pub fn ratios(&self, drawn: &[f64]) -> [Option<f64>; 3] {
        let of = |scale: usize| Some((self.mean_square(drawn, SCALES[scale]) / self.squares[scale]?).sqrt());
        [0, 1, 2].map(of)
    }

    fn mean_square(&self, light: &[f64], scale: f64) -> f64 {
        let [narrow, wide] = [scale, 2.0 * scale].map(|width| self.blurred(light, width));
        self.mean(narrow.iter().zip(&wide).map(|(a, b)| (a / b - 1.0).powi(2)))
    }

    /// Mean square of what noise of a `variance` by pixel has: the squares of the weights that each pixel has in the relief, times
    /// its variance. A product of two Gaussians is one, whose square of the width is half the harmonic mean of theirs.
    fn noise(&self, light: &[f64], variance: &[f64], scale: f64) -> f64 {
        let widths = [scale, 2.0 * scale];
        let weights = widths.map(|width| self.summed(&self.inside, width));
        let of = |a: usize, b: usize| {
            let width = (widths[a].powi(-2) + widths[b].powi(-2)).powf(-0.5);
            let sum = self.summed(variance, width);
            let share = |i: usize| sum[i] / (weights[a][i] * weights[b][i]);
            (0..sum.len()).map(share).collect::<Vec<_>>()
        };
        let (narrow, both, wide) = (of(0, 0), of(0, 1), of(1, 1));
        let mean = self.blurred(light, widths[1]);
        self.mean((0..mean.len()).map(|i| (narrow[i] - 2.0 * both[i] + wide[i]) / mean[i].powi(2)))
    }

    /// Mean of what is inside.
    fn mean(&self, values: impl Iterator<Item = f64>) -> f64 {
        let sum: f64 = values.zip(&self.inside).filter(|(_, inside)| **inside > 0.0).map(|(x, _)| x).sum();
        sum / self.inside.iter().sum::<f64>()
    }

    /// Blurred by a Gaussian of what is inside.
    fn blurred(&self, values: &[f64], width: f64) -> Vec<f64> {
        let (sum, weight) = (self.summed(values, width), self.summed(&self.inside, width));
        sum.iter().zip(weight).map(|(sum, weight)| sum / weight).collect()
    }

    /// Sums of what is inside, each with the weight exp(-d^2 / 2 w^2) of its distance d.
    fn summed(&self, values: &[f64], width: f64) -> Vec<f64> {
        let inside: Vec<f64> =
            values.iter().zip(&self.inside).map(|(value, inside)| value * inside).collect();
        let (columns, rows) = (self.width, values.len() / self.width);
        let reach = (4.0 * width).ceil() as isize;
        let weights: Vec<f64> = (-reach..=reach).map(|d| (-0.5 * (d as f64 / width).powi(2)).exp()).collect();
        let along = |from: &[f64], step: usize, count: usize| -> Vec<f64> {
            let at = |i: usize| {
                let place = (i / step % count) as isize;
                let near = weights.iter().enumerate().map(|(k, weight)| (k as isize - reach, weight));
                let near = near.filter(|(d, _)| (0..count as isize).contains(&(place + d)));
                near.map(|(d, weight)| weight * from[(i as isize + d * step as isize) as usize]).sum()
            };
            (0..from.len()).map(at).collect()
        };
        along(&along(&inside, 1, columns), columns, rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{export::Picture, scene::Scene};

    const SIZE: [usize; 2] = [96, 54];

    fn place(i: usize) -> [f64; 2] {
        [(i % SIZE[0]) as f64, (i / SIZE[0]) as f64]
    }

    /// A picture that is cloud but for a border, with noise of a deviation.
    fn reference(light: impl Fn(usize) -> f64, deviation: f32) -> Reference {
        let [width, height] = SIZE;
        let pixel = |i: usize| {
            let [x, y] = place(i);
            let inside = (10.0..86.0).contains(&x) && (8.0..46.0).contains(&y);
            let l = light(i) as f32;
            [l, l, l, if inside { 1.0 } else { 0.2 }]
        };
        let pixels: Vec<_> = (0..width * height).map(pixel).collect();
        let error = vec![[deviation; 3]; pixels.len()];
        Reference { picture: Picture { width, height, pixels }, error, samples: 1, scene: Scene::default() }
    }

    fn drawn(light: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..SIZE[0] * SIZE[1]).map(light).collect()
    }

    /// Relief of waves as long as a scale sees best.
    fn waves(i: usize) -> f64 {
        let [x, y] = place(i);
        (x / 2.0).sin() + (x / 5.0 + y / 4.0).sin() + (x / 9.0 - y / 11.0).cos()
    }

    #[test]
    fn half_the_relief_is_half_at_every_scale_however_bright() {
        let relief = Relief::new(&reference(|i| 2.0 + 0.1 * waves(i), 0.0));
        for ratio in relief.ratios(&drawn(|i| 2.0 + 0.1 * waves(i))) {
            assert!((ratio.unwrap() - 1.0).abs() < 1e-6);
        }
        for ratio in relief.ratios(&drawn(|i| 6.0 + 0.15 * waves(i))) {
            assert!((ratio.unwrap() - 0.5).abs() < 0.01, "{ratio:?}");
        }
    }

    #[test]
    fn relief_that_is_noise_is_taken_off() {
        let mut state = 1u32;
        let mut unit = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        // Even over a width of 1: a variance of 1/12.
        let noise: Vec<f64> = (0..SIZE[0] * SIZE[1]).map(|_| 0.5 * (unit() - 0.5)).collect();
        let light = |i: usize| 2.0 + 0.15 * waves(i);
        let relief = Relief::new(&reference(|i| light(i) + noise[i], 0.5 / 12f32.sqrt()));
        for ratio in relief.ratios(&drawn(light)) {
            assert!((ratio.unwrap() - 1.0).abs() < 0.06, "{ratio:?}");
        }
        let noisy = Relief::new(&reference(|i| 2.0 + noise[i], 0.5 / 12f32.sqrt()));
        assert_eq!(noisy.ratios(&drawn(|_| 2.0))[0], None);
    }

    #[test]
    fn small_clouds_tell_nothing() {
        let mut small = reference(waves, 0.0);
        small.picture.pixels.iter_mut().skip(1000).for_each(|p| p[3] = 0.0);
        assert_eq!(Relief::new(&small).ratios(&drawn(waves)), [None; 3]);
    }
}
