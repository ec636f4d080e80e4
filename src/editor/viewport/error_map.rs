//! How far the preview is from the truth: one number for all pixels, one colour for each.

use crate::{export::Picture, reference::Estimate, srgb};

/// The relative difference that gets the strongest colour.
pub const RANGE: f32 = 0.5;
/// Where a cloud hides less than this there is no cloud.
const LEAST_OPACITY: f32 = 0.01;
/// Share of the pixels that only count for the bias.
const NOISIEST: f64 = 0.01;
/// Share of the mean light that is added before a division, so that dark pixels do not shout.
const FLOOR: f32 = 0.02;

/// How far two pictures are from each other, over all pixels with cloud.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Numbers {
    /// Root of the mean squared difference of luminance, over the mean luminance, without
    /// the hundredth of the pixels that are noisiest in the truth: few paths that met the sun
    /// head on would drown all else.
    pub relative_rmse: f64,
    /// Mean difference over the mean luminance, of all pixels: positive where the preview is
    /// too bright.
    pub bias: f64,
    /// The part of the RMSE that is the truth's own noise: its standard error likewise.
    pub noise: f64,
    /// Pixels with cloud.
    pub pixels: usize,
}

impl Numbers {
    /// Of `preview` against `truth`, both over the same sky, where `estimate` is the truth
    /// without it.
    pub fn new(preview: &Picture, truth: &Picture, estimate: &Estimate) -> Self {
        // Luminance of both, and the variance of the truth's.
        let pixel = |(i, mean): (usize, &[f32; 4])| {
            let variance = (0..3).map(|c| f64::from(WEIGHTS[c] * estimate.error[i][c]).powi(2)).sum::<f64>();
            let luminances = [&preview.pixels[i], &truth.pixels[i]].map(|p| f64::from(luminance(p)));
            (mean[3] >= LEAST_OPACITY).then_some((luminances, variance))
        };
        let mut pixels: Vec<_> = estimate.mean.iter().enumerate().filter_map(pixel).collect();
        let mean_of = |value: fn(&([f64; 2], f64)) -> f64, of: &[([f64; 2], f64)]| {
            of.iter().map(value).sum::<f64>() / of.len().max(1) as f64
        };
        let light = mean_of(|([_, t], _)| *t, &pixels).max(1e-12);
        let bias = mean_of(|([p, t], _)| p - t, &pixels) / light;
        pixels.sort_by(|a, b| a.1.total_cmp(&b.1));
        let calm = &pixels[..pixels.len() - (NOISIEST * pixels.len() as f64) as usize];
        Self {
            relative_rmse: mean_of(|([p, t], _)| (p - t).powi(2), calm).sqrt() / light,
            bias,
            noise: mean_of(|(_, variance)| *variance, calm).sqrt() / light,
            pixels: pixels.len(),
        }
    }

    /// The relative RMSE that is left without the truth's noise.
    pub fn without_noise(&self) -> f64 {
        (self.relative_rmse.powi(2) - self.noise.powi(2)).max(0.0).sqrt()
    }
}

/// Relative difference of each pixel's luminance, positive where the preview is too bright.
pub fn differences(preview: &Picture, truth: &Picture) -> Vec<f32> {
    let mean = truth.pixels.iter().map(luminance).sum::<f32>() / truth.pixels.len().max(1) as f32;
    let difference = |(p, t): (&[f32; 4], &[f32; 4])| {
        let (p, t) = (luminance(p), luminance(t));
        (p - t) / (t + FLOOR * mean).max(1e-9)
    };
    preview.pixels.iter().zip(&truth.pixels).map(difference).collect()
}

/// Of Rec. 709.
const WEIGHTS: [f32; 3] = [0.2126, 0.7152, 0.0722];

fn luminance(pixel: &[f32; 4]) -> f32 {
    (0..3).map(|c| WEIGHTS[c] * pixel[c]).sum()
}

/// The colour of a place on the scale from -1 to 1, as the screen shows it: dark where both
/// agree, blue where the preview is too dark, orange where it is too bright. Lightness grows
/// evenly to both sides, in OKLab (Ottosson 2020), so that equal differences look equal.
pub fn color(x: f32) -> [f32; 3] {
    let x = x.clamp(-1.0, 1.0);
    let strength = x.abs();
    let hue: f32 = if x < 0.0 { 4.36 } else { 1.05 };
    let (lightness, chroma) = (0.16 + 0.68 * strength, 0.15 * strength.sqrt());
    from_oklab([lightness, chroma * hue.cos(), chroma * hue.sin()])
}

fn from_oklab([l, a, b]: [f32; 3]) -> [f32; 3] {
    let cones = [
        l + 0.396_337_78 * a + 0.215_803_76 * b,
        l - 0.105_561_346 * a - 0.063_854_17 * b,
        l - 0.089_484_18 * a - 1.291_485_5 * b,
    ]
    .map(|c| c * c * c);
    let [l, m, s] = cones;
    let linear = [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_93 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ];
    linear.map(|c: f32| srgb::encoded(f64::from(c.clamp(0.0, 1.0))) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(values: &[f32], alpha: f32) -> Picture {
        let pixels = values.iter().map(|v| [*v, *v, *v, alpha]).collect();
        Picture { width: values.len(), height: 1, pixels }
    }

    fn estimate(truth: &Picture, error: f32) -> Estimate {
        Estimate { mean: truth.pixels.clone(), error: vec![[error; 3]; truth.pixels.len()], samples: 3 }
    }

    #[test]
    fn numbers_of_a_picture_that_is_a_tenth_too_bright() {
        let truth = flat(&[1.0, 1.0, 1.0, 1.0], 1.0);
        let preview = flat(&[1.1; 4], 1.0);
        let numbers = Numbers::new(&preview, &truth, &estimate(&truth, 0.0));
        // f32 luminance.
        assert!((numbers.relative_rmse - 0.1).abs() < 1e-6 && (numbers.bias - 0.1).abs() < 1e-6);
        assert_eq!((numbers.noise, numbers.pixels), (0.0, 4));
        assert!(differences(&preview, &truth).iter().all(|d| (d - 0.1 / 1.02).abs() < 1e-6));
    }

    #[test]
    fn noise_is_told_and_taken_out() {
        // Three independent errors of 0.1: luminance has 0.1 sqrt(sum of squared weights).
        let truth = flat(&[1.0, 1.0], 1.0);
        let wrong = flat(&[1.2, 0.8], 1.0);
        let numbers = Numbers::new(&wrong, &truth, &estimate(&truth, 0.1));
        let expected = 0.1 * (0.2126f64.powi(2) + 0.7152f64.powi(2) + 0.0722f64.powi(2)).sqrt();
        assert!((numbers.noise - expected).abs() < 1e-6, "{}", numbers.noise);
        assert!((numbers.without_noise().powi(2) - (0.04 - expected.powi(2))).abs() < 1e-6);
        assert!(numbers.bias.abs() < 1e-6);
    }

    #[test]
    fn one_path_that_met_the_sun_does_not_drown_the_rest() {
        let truth = flat(&[1.0; 200], 1.0);
        let mut estimate = estimate(&truth, 0.1);
        estimate.error[17] = [1e4; 3];
        let mut preview = truth.clone();
        preview.pixels[17] = [-99.0; 4];
        let numbers = Numbers::new(&preview, &truth, &estimate);
        assert!(numbers.noise < 0.1 && numbers.relative_rmse < 1e-6);
        assert!((numbers.bias + 0.5).abs() < 1e-6);
    }

    #[test]
    fn sky_does_not_count() {
        let mut truth = flat(&[1.0, 1.0], 1.0);
        truth.pixels[1][3] = 0.0;
        let preview = flat(&[1.0, 9.0], 1.0);
        let numbers = Numbers::new(&preview, &truth, &estimate(&truth, 0.0));
        assert_eq!((numbers.relative_rmse, numbers.pixels), (0.0, 1));
    }

    #[test]
    fn equal_differences_of_both_signs_look_equally_strong() {
        let light = |x: f32| color(x).iter().zip(WEIGHTS).map(|(c, w)| c * w).sum::<f32>();
        for x in [0.25f32, 0.5, 0.75, 1.0] {
            assert!(light(x) > light(x - 0.25) && light(-x) > light(0.25 - x));
            // Gamma-encoded luma, of two hues, some of it cut at the edge of sRGB.
            assert!((light(x) - light(-x)).abs() < 0.1, "{x}: {} {}", light(x), light(-x));
        }
        assert!(color(-1.0)[2] > color(-1.0)[0] && color(1.0)[0] > color(1.0)[2]);
    }
}
