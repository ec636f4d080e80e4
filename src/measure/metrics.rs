//! How far a picture is from its reference.
//!
//! Light is the mean of the three channels. A cloud that is drawn and one that is path traced
//! share the light of the sky differently: what a droplet scatters by a hair counts as cloud in
//! one and as background in the other. Both pictures are therefore put over the same sky before
//! they are subtracted, and the difference is told as a share of the reference's cloud light.

use glam::DVec3;

use super::{Reference, Relief, light};
use crate::{
    export::Picture,
    scene::{Camera, Scene},
};

/// Limits of the bands of scattering angles, degrees.
pub const BANDS: [f64; 5] = [0.0, 30.0, 60.0, 120.0, 180.0];

/// Pixels that a band needs, so that it tells more than noise.
const LEAST_PIXELS: usize = 20;

/// Errors of one picture. All but the last two are of linear light over the cloud's pixels.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Errors {
    /// Root of the mean squared error over the root of the mean squared light, the variance of
    /// the reference taken from both; 0 where noise explains more than all of it.
    pub rmse: f64,
    /// The square of `rmse`, and below 0 where noise explains more than all: over many pictures such
    /// squares average to the truth, where roots cut off at 0 do not.
    pub relative_square: f64,
    /// Mean over the pixels of |error| / light, corrected for noise by the factor by which the
    /// root of the mean square of the same ratio falls when the variance is taken off.
    pub mean_relative: f64,
    /// 95th percentile of |error| / light, corrected by the same factor.
    pub p95_relative: f64,
    /// Ratio of the sums of light, less 1: above 0 the picture is too bright.
    pub bias: f64,
    /// Standard error of `bias`.
    pub bias_error: f64,
    /// `rmse` in the bands of the angle between sunlight and the way to the eye; none where a
    /// band has few pixels.
    pub bands: [Option<f64>; 4],
    /// Relief inside the clouds over the reference's, at each of [`SCALES`](super::SCALES): below 1 the picture is too flat; none where
    /// the reference is too noisy to tell.
    pub contrast: [Option<f64>; 3],
    /// Peak signal to noise ratio of the finished picture, decibels.
    pub psnr: f64,
    /// FLIP of the finished picture, 0 to 1.
    pub flip: f64,
}

/// One pixel of the cloud: drawn and true light, and the variance of the latter.
#[derive(Debug, Clone, Copy)]
struct Pixel {
    drawn: f64,
    truth: f64,
    variance: f64,
    /// Cosine of the scattering angle.
    cosine: f64,
}

/// A reference with the sky behind it.
pub struct Truth<'a> {
    /// The reference.
    pub reference: &'a Reference,
    /// The sky without clouds, of the same size.
    pub sky: &'a Picture,
}

impl Truth<'_> {
    /// Drawn light of every pixel, with the background that the reference lets through, and its
    /// difference from the reference; none where there is no cloud.
    pub fn differences(&self, drawn: &Picture) -> Vec<Option<(f64, f64)>> {
        let mut all = vec![None; drawn.pixels.len()];
        for i in self.reference.cloud() {
            let (a, b) = (&drawn.pixels[i], &self.reference.picture.pixels[i]);
            let background = f64::from(b[3] - a[3]) * light(&self.sky.pixels[i]);
            all[i] = Some((light(b), light(a) + background - light(b)));
        }
        all
    }

    /// Relative RMSE of `drawn` alone.
    pub fn rmse(&self, drawn: &Picture) -> f64 {
        rmse(&self.pixels(drawn))
    }

    /// Drawn light of every pixel; none where there is no cloud.
    fn light(&self, drawn: &Picture) -> Vec<f64> {
        let light = |found: Option<(f64, f64)>| found.map_or(0.0, |(truth, difference)| truth + difference);
        self.differences(drawn).into_iter().map(light).collect()
    }

    fn pixels(&self, drawn: &Picture) -> Vec<Pixel> {
        let cosines = cosines(&self.reference.scene, [drawn.width, drawn.height]);
        let differences = self.differences(drawn).into_iter().enumerate();
        let pixel = |(i, found): (usize, Option<(f64, f64)>)| {
            let (truth, difference) = found?;
            let variance = self.reference.variance(i);
            Some(Pixel { drawn: truth + difference, truth, variance, cosine: cosines[i] })
        };
        differences.filter_map(pixel).collect()
    }

    /// The errors of `drawn`; `finished` are reference and drawing as screens show them, RGBA
    /// of 8 bits, and `relief` is the reference's.
    pub fn errors(&self, drawn: &Picture, finished: [&[u8]; 2], relief: &Relief) -> Errors {
        let pixels = self.pixels(drawn);
        let (mean_relative, p95_relative) = relative(&pixels);
        let (bias, bias_error) = bias(&pixels);
        let relative_square = relative_square(&pixels);
        Errors {
            rmse: root(relative_square),
            relative_square,
            mean_relative,
            p95_relative,
            bias,
            bias_error,
            bands: bands(&pixels),
            contrast: relief.ratios(&self.light(drawn)),
            psnr: psnr(finished),
            flip: super::flip(finished[0], finished[1], drawn.width),
        }
    }
}

fn rmse(pixels: &[Pixel]) -> f64 {
    root(relative_square(pixels))
}

fn relative_square(pixels: &[Pixel]) -> f64 {
    let noise: f64 = pixels.iter().map(|p| p.variance).sum();
    let squares: f64 = pixels.iter().map(|p| (p.drawn - p.truth).powi(2)).sum();
    let whole: f64 = pixels.iter().map(|p| p.truth * p.truth).sum();
    (squares - noise) / (whole - noise)
}

/// The root of what is above 0, and 0 of what is not or is no number.
fn root(x: f64) -> f64 {
    x.max(0.0).sqrt()
}

/// Mean and 95th percentile of |error| / light.
fn relative(pixels: &[Pixel]) -> (f64, f64) {
    let lit = || pixels.iter().filter(|p| p.truth > 0.0);
    let mut ratios: Vec<f64> = lit().map(|p| ((p.drawn - p.truth) / p.truth).abs()).collect();
    if ratios.is_empty() {
        return (0.0, 0.0);
    }
    let squares: f64 = ratios.iter().map(|ratio| ratio * ratio).sum();
    let noise: f64 = lit().map(|p| p.variance / (p.truth * p.truth)).sum();
    let factor = if squares > 0.0 { root(1.0 - noise / squares) } else { 0.0 };
    ratios.sort_by(f64::total_cmp);
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    (factor * mean, factor * ratios[(0.95 * (ratios.len() - 1) as f64).round() as usize])
}

/// Ratio of the sums less 1, and its standard error, which is the reference's.
fn bias(pixels: &[Pixel]) -> (f64, f64) {
    let [drawn, truth, variance]: [f64; 3] =
        [|p: &Pixel| p.drawn, |p: &Pixel| p.truth, |p: &Pixel| p.variance]
            .map(|value| pixels.iter().map(value).sum());
    if truth > 0.0 { (drawn / truth - 1.0, drawn * variance.sqrt() / (truth * truth)) } else { (0.0, 0.0) }
}

fn bands(pixels: &[Pixel]) -> [Option<f64>; 4] {
    [0, 1, 2, 3].map(|band| {
        let angles = BANDS[band]..BANDS[band + 1];
        let inside = |p: &&Pixel| angles.contains(&p.cosine.clamp(-1.0, 1.0).acos().to_degrees());
        let inside: Vec<Pixel> = pixels.iter().filter(inside).copied().collect();
        (inside.len() >= LEAST_PIXELS).then(|| rmse(&inside))
    })
}

/// Of the bytes of the colours; 99 at most, where nothing differs.
fn psnr([a, b]: [&[u8]; 2]) -> f64 {
    let colours = |bytes: &[u8]| -> Vec<f64> {
        bytes.chunks_exact(4).flat_map(|p| &p[..3]).map(|&c| f64::from(c) / 255.0).collect()
    };
    let (a, b) = (colours(a), colours(b));
    let squares: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
    (-10.0 * (squares / a.len().max(1) as f64).log10()).min(99.0)
}

/// Cosine of the scattering angle of every pixel: 1 where the camera looks at the sun.
fn cosines(scene: &Scene, [width, height]: [usize; 2]) -> Vec<f64> {
    let (camera, to_sun) = (scene.camera(), scene.sun.to_sun());
    let place = |i: usize| {
        let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        [2.0 * x / width as f64 - 1.0, 1.0 - 2.0 * y / height as f64]
    };
    let aspect = width as f64 / height as f64;
    (0..width * height).map(|i| direction(&camera, place(i), aspect).dot(to_sun)).collect()
}

/// Direction of a place in the picture, -1 to 1 from left to right and from bottom to top. One
/// for all where the projection is no pinhole.
fn direction(camera: &Camera, [x, y]: [f64; 2], aspect: f64) -> DVec3 {
    let half_height = camera.projection.vertical_fov(aspect).map_or(0.0, |angle| (0.5 * angle).tan());
    let seen = DVec3::new(x * aspect * half_height, y * half_height, -1.0);
    camera.world_from_camera() * seen.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{
        ChaCha8Rng,
        rand_core::{RngCore, SeedableRng},
    };

    fn pixel(drawn: f64, truth: f64, variance: f64) -> Pixel {
        Pixel { drawn, truth, variance, cosine: 0.0 }
    }

    /// Standard normal numbers by Box and Muller.
    fn normals(count: usize) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut unit = || (f64::from(rng.next_u32()) + 0.5) / 4_294_967_296.0;
        (0..count)
            .map(|_| (-2.0 * unit().ln()).sqrt() * (2.0 * std::f64::consts::PI * unit()).cos())
            .collect()
    }

    #[test]
    fn errors_without_noise_are_their_definitions() {
        let pixels = [pixel(1.0, 2.0, 0.0), pixel(4.0, 4.0, 0.0), pixel(2.0, 1.0, 0.0)];
        assert!((rmse(&pixels) - (2.0f64 / 21.0).sqrt()).abs() < 1e-12);
        let (mean, most) = relative(&pixels);
        assert!((mean - 0.5).abs() < 1e-12 && (most - 1.0).abs() < 1e-12);
        assert_eq!(bias(&pixels), (0.0, 0.0));
        assert!((bias(&[pixel(3.0, 2.0, 0.04)]).0 - 0.5).abs() < 1e-12);
        assert!((bias(&[pixel(3.0, 2.0, 0.04)]).1 - 0.15).abs() < 1e-12);
        assert!(rmse(&[]) == 0.0 && relative(&[]) == (0.0, 0.0) && bands(&[]) == [None; 4]);
    }

    #[test]
    fn a_noisy_reference_gives_the_error_that_a_clean_one_gives() {
        // Light 1 to 2, an error of a fifth up or down, noise as large as the error.
        let noise = normals(20_000);
        let pixels: Vec<Pixel> = noise
            .iter()
            .enumerate()
            .map(|(i, z)| {
                let truth = 1.0 + (i % 100) as f64 / 100.0;
                let drawn = truth * if i % 3 == 0 { 1.2 } else { 0.8 };
                pixel(drawn, truth + 0.2 * truth * z, (0.2 * truth).powi(2))
            })
            .collect();
        // Standard error of the mean of z^2 over 20000 pixels is 1 %, that of its root half.
        assert!((rmse(&pixels) - 0.2).abs() < 0.006, "{}", rmse(&pixels));
        let (found, error) = bias(&pixels);
        assert!((found - (0.2 - 0.4) / 3.0).abs() < 4.0 * error, "{found} {error}");
        // Noise alone is no error.
        let noise: Vec<Pixel> = noise.iter().map(|z| pixel(1.0, 1.0 + 0.1 * z, 0.01)).collect();
        assert!(rmse(&noise) < 0.02, "{}", rmse(&noise));
        assert!(relative(&noise).0 < 0.03, "{:?}", relative(&noise));
    }

    #[test]
    fn bands_part_the_pixels_by_their_angle() {
        let at = |angle: f64, error: f64| Pixel {
            cosine: angle.to_radians().cos(),
            ..pixel(1.0 + error, 1.0, 0.0)
        };
        let mut pixels = vec![at(10.0, 0.1); 30];
        pixels.extend(vec![at(90.0, 0.3); 30]);
        pixels.extend(vec![at(150.0, 0.9); 3]);
        let found = bands(&pixels);
        assert!((found[0].unwrap() - 0.1).abs() < 1e-12 && (found[2].unwrap() - 0.3).abs() < 1e-12);
        assert_eq!([found[1], found[3]], [None, None]);
    }

    #[test]
    fn psnr_is_ten_times_the_logarithm() {
        let (a, b) = ([0u8, 0, 0, 255], [51u8, 51, 51, 0]);
        assert!((psnr([&a, &b]) - 20.0 * 5f64.log10()).abs() < 1e-9);
        assert_eq!(psnr([&a, &a]), 99.0);
    }

    #[test]
    fn the_scattering_angle_is_nought_towards_the_sun() {
        let mut scene = Scene { camera: Some(Camera::default()), ..Scene::default() };
        if let Some(camera) = &mut scene.camera {
            camera.target = camera.position + 100.0 * scene.sun.to_sun();
        }
        let found = cosines(&scene, [9, 5]);
        assert!((found[2 * 9 + 4] - 1.0).abs() < 1e-12);
        assert!(found.iter().all(|c| *c > 0.5));
    }
}
