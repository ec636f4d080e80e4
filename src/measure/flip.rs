//! FLIP: the difference that a person sees when two pictures alternate (Andersson et al. 2020,
//! "FLIP: A Difference Evaluator for Alternating Images"), for pictures of 8 bits a channel.
//!
//! Written from the paper, since the only crates wrap a C++ library. Equation and section
//! numbers are the paper's; constants are its published ones.

use std::f64::consts::PI;

use crate::srgb;

/// Pixels per degree of the viewer's eye: a 4K screen, 0.7 m wide, from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;

/// Gaussians (weight, width) that make up the contrast sensitivity of the achromatic, the red-
/// green and the blue-yellow channel (table 1).
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// Width of the lines and points that are looked for, degrees (section 4.2.1).
const FEATURE_WIDTH: f64 = 0.082;

/// Linear sRGB to CIE XYZ, D65.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_386_563_252_992, 0.357_591_490_920_625, 0.180_450_491_203_564],
    [0.212_636_821_677_324, 0.715_182_981_841_251, 0.072_180_196_481_425_6],
    [0.019_330_620_152_484_0, 0.119_197_163_640_208, 0.950_372_587_005_435],
];
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_232_976_36, -1.537_398_969_488_786, -0.498_615_881_996_364],
    [-0.969_224_252_202_516, 1.875_929_983_695_18, 0.041_554_226_340_084_7],
    [0.055_639_419_851_975_5, -0.204_011_206_123_91, 1.057_148_977_187_53],
];

/// A row of pixels of one channel, with the picture's width.
#[derive(Clone)]
struct Plane {
    width: usize,
    values: Vec<f64>,
}

/// Mean FLIP of two pictures of `width` pixels a row, RGBA of 8 bits in sRGB: 0 where they look
/// the same, 1 at most.
pub fn flip(reference: &[u8], test: &[u8], width: usize) -> f64 {
    let [a, b] = [reference, test].map(|picture| Seen::new(picture, width));
    let errors = a.colours.iter().zip(&b.colours).enumerate().map(|(i, (x, y))| {
        let colour = redistributed(hyab(*x, *y).powf(0.7));
        let edges = (a.edges[i] - b.edges[i]).abs();
        let points = (a.points[i] - b.points[i]).abs();
        let feature = (edges.max(points) / 2f64.sqrt()).powf(0.5);
        colour.powf(1.0 - feature)
    });
    errors.sum::<f64>() / a.colours.len().max(1) as f64
}

/// What an eye makes of a picture.
struct Seen {
    /// Hunt-adjusted L*a*b* after the eye's blur.
    colours: Vec<[f64; 3]>,
    /// Strength of edges and points, 0 to 1.
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Seen {
    fn new(rgba: &[u8], width: usize) -> Self {
        let linear = rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]].map(linear));
        let opponent: Vec<[f64; 3]> = linear.map(|rgb| opponent(times(&XYZ_FROM_RGB, rgb))).collect();
        let plane = |c: usize| Plane { width, values: opponent.iter().map(|pixel| pixel[c]).collect() };
        let blurred = [0, 1, 2].map(|c| plane(c).blurred(SENSITIVITY[c]));
        let colours = (0..opponent.len()).map(|i| perceived([0, 1, 2].map(|c| blurred[c].values[i])));
        let grey = Plane { width, values: opponent.iter().map(|p| (p[0] + 16.0) / 116.0).collect() };
        let (edge, point, smooth) = feature_kernels();
        Self {
            colours: colours.collect(),
            edges: grey.gradient(&edge, &smooth),
            points: grey.gradient(&point, &smooth),
        }
    }
}

impl Plane {
    /// Convolved with one kernel along rows and another along columns; the border goes on.
    fn convolved(&self, along_x: &[f64], along_y: &[f64]) -> Self {
        let height = self.values.len() / self.width;
        self.along(1, self.width, along_x).along(self.width, height, along_y)
    }

    /// Convolved along lines of `length` pixels that are `stride` places apart.
    fn along(&self, stride: usize, length: usize, kernel: &[f64]) -> Self {
        let radius = kernel.len() / 2;
        let value = |place: usize| {
            let here = place / stride % length;
            let first = place - here * stride;
            let weigh = |(k, weight): (usize, &f64)| {
                let there = (here + k).saturating_sub(radius).min(length - 1);
                weight * self.values[first + there * stride]
            };
            kernel.iter().enumerate().map(weigh).sum()
        };
        Self { width: self.width, values: (0..self.values.len()).map(value).collect() }
    }

    /// Blurred as the eye does (equation 4).
    fn blurred(&self, gaussians: &[(f64, f64)]) -> Self {
        let widest = SENSITIVITY.iter().copied().flatten().fold(0.0f64, |most, (_, b)| most.max(*b));
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
        let mut sum = Self { width: self.width, values: vec![0.0; self.values.len()] };
        let mut total = 0.0;
        for (weight, b) in gaussians {
            let kernel = kernel(radius, |x| (-(PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp());
            let mass = kernel.iter().sum::<f64>();
            let scale = weight * (PI / b).sqrt();
            total += scale * mass * mass;
            let part = self.convolved(&kernel, &kernel);
            sum.values.iter_mut().zip(part.values).for_each(|(sum, part)| *sum += scale * part);
        }
        sum.values.iter_mut().for_each(|value| *value /= total);
        sum
    }

    /// Length of the vector of `kernel`'s answers along x and y.
    fn gradient(&self, kernel: &[f64], smooth: &[f64]) -> Vec<f64> {
        let (x, y) = (self.convolved(kernel, smooth), self.convolved(smooth, kernel));
        x.values.iter().zip(&y.values).map(|(x, y)| x.hypot(*y)).collect()
    }
}

fn kernel(radius: i32, value: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| value(f64::from(x))).collect()
}

/// Kernels of edges and of points, and the Gaussian across them (section 4.2.1).
fn feature_kernels() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let gauss = move |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
    let edge = balanced(kernel(radius, |x| -x * gauss(x)));
    let point = balanced(kernel(radius, |x| ((x / deviation).powi(2) - 1.0) * gauss(x)));
    let smooth = kernel(radius, gauss);
    let mass: f64 = smooth.iter().sum();
    (edge, point, smooth.into_iter().map(|weight| weight / mass).collect())
}

/// Positive weights scaled to add up to 1, negative ones to -1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    kernel.into_iter().map(|weight| weight / if weight > 0.0 { positive } else { negative }).collect()
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| matrix[i][0] * v[0] + matrix[i][1] * v[1] + matrix[i][2] * v[2])
}

fn linear(byte: u8) -> f64 {
    srgb::decoded(f64::from(byte) / 255.0)
}

fn white() -> [f64; 3] {
    times(&XYZ_FROM_RGB, [1.0; 3])
}

/// YCxCz of XYZ: linear, with luminance and two opponent colours.
fn opponent(xyz: [f64; 3]) -> [f64; 3] {
    let white = white();
    let [x, y, z] = [0, 1, 2].map(|c| xyz[c] / white[c]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Hunt-adjusted L*a*b* of YCxCz, what no screen shows cut off.
fn perceived([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let white = white();
    let y = (y + 16.0) / 116.0;
    let relative = [cx / 500.0 + y, y, y - cz / 200.0];
    let xyz = [0, 1, 2].map(|c| relative[c] * white[c]);
    hunt(times(&RGB_FROM_XYZ, xyz).map(|c| c.clamp(0.0, 1.0)))
}

/// L*a*b* of linear sRGB; colours count for less in the dark (section 4.1).
fn hunt(rgb: [f64; 3]) -> [f64; 3] {
    let (xyz, white) = (times(&XYZ_FROM_RGB, rgb), white());
    const DELTA: f64 = 6.0 / 29.0;
    let f = |t: f64| {
        if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|c| f(xyz[c] / white[c]));
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// Distance of two colours: city block in lightness, Euclidean in chroma (equation 9).
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Small differences spread over most of the range from 0 to 1 (equation 11).
fn redistributed(difference: f64) -> f64 {
    const PART: f64 = 0.4;
    const SHARE: f64 = 0.95;
    let most = hyab(hunt([0.0, 1.0, 0.0]), hunt([0.0, 0.0, 1.0])).powf(0.7);
    let knee = PART * most;
    if difference < knee {
        SHARE / knee * difference
    } else {
        SHARE + (difference - knee) / (most - knee) * (1.0 - SHARE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 24 by 16 pixels without any randomness.
    fn picture(value: impl Fn(usize, usize) -> [usize; 3]) -> Vec<u8> {
        let pixel = |i: usize| {
            let [r, g, b] = value(i % 24, i / 24).map(|c| (c % 256) as u8);
            [r, g, b, 255]
        };
        (0..24 * 16).flat_map(pixel).collect()
    }

    #[test]
    fn no_difference_is_none_and_black_on_white_is_nearly_all() {
        let (black, white) = (picture(|_, _| [0; 3]), picture(|_, _| [255; 3]));
        assert_eq!(flip(&white, &white, 24), 0.0);
        assert!((flip(&black, &white, 24) - BLACK_ON_WHITE).abs() < 1e-4, "{}", flip(&black, &white, 24));
    }

    #[test]
    fn pictures_differ_as_the_authors_program_says() {
        let a = picture(|x, y| [10 * x, 15 * y, 5 * (x + y)]);
        let b = picture(|x, y| [9 * x + 7 * (x % 5), 14 * y, 6 * (x + y) + 20 * (y / 8)]);
        // In single precision, hence the tolerance.
        assert!((flip(&a, &b, 24) - GRADIENTS).abs() < 1e-4, "{}", flip(&a, &b, 24));
    }

    /// By flip-evaluator 1.7, the authors' own program, on the same bytes.
    const BLACK_ON_WHITE: f64 = 0.967_387;
    const GRADIENTS: f64 = 0.403_279;
}
