//! What the tests of the path tracer share: scenes, pictures, and statistics of both.

use nephos::{
    reference::{Estimate, PathOptions, PathTracer},
    render::Frame,
    scene::Scene,
};

use super::{gpu, picture::scene};

/// Henyey and Greenstein's phase function, mean cosine 0.85, as scene files have it.
pub const HG: &str = r#"{"henyey_greenstein": {"g": 0.85}}"#;
/// Share of a square that its inscribed disc covers.
pub const DISC: f64 = std::f64::consts::FRAC_PI_4;
/// Extinction of 1 droplet a cm^3 of the default effective radius, 6 um: 2 pi r_e^2 [K 3.3], 1/m.
pub const EXTINCTION_PER_CM3: f64 = 2.261_946_710_584_651e-4;

/// A tracer of `scene` with sun rays that are parallel.
pub fn tracer(scene: &Scene, size: [u32; 2], options: &PathOptions) -> PathTracer {
    let mut scene = scene.clone();
    scene.sun.angular_diameter_deg = 0.0;
    let frame = Frame::new(&scene, size).expect("the scene is valid");
    PathTracer::with_options(gpu(), &frame, options).expect("the droplets are valid")
}

/// Brings a tracer to so many samples.
pub fn traced(tracer: &mut PathTracer, samples: u32) -> Estimate {
    tracer.trace(samples, &mut |_| true).expect("the device works");
    tracer.estimate().expect("the device works")
}

/// What `samples` samples find.
pub fn trace_with(scene: &Scene, size: [u32; 2], samples: u32, options: &PathOptions) -> Estimate {
    traced(&mut tracer(scene, size, options), samples)
}

/// The same with seed 1.
pub fn trace(scene: &Scene, size: [u32; 2], samples: u32) -> Estimate {
    trace_with(scene, size, samples, &PathOptions { seed: 1, ..PathOptions::default() })
}

/// A number and its standard error.
#[derive(Debug, Clone, Copy)]
pub struct Measured {
    pub value: f64,
    pub error: f64,
}

impl Measured {
    /// Nothing is known better.
    pub fn exact(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    /// By repeated measurement.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|x| (x - value).powi(2)).sum::<f64>() / (n * (n - 1.0));
        Self { value, error: variance.sqrt() }
    }

    /// Mean of independent measurements of different things.
    pub fn mean(parts: &[Self]) -> Self {
        let n = parts.len() as f64;
        let variance: f64 = parts.iter().map(|part| part.error.powi(2)).sum();
        Self { value: parts.iter().map(|part| part.value).sum::<f64>() / n, error: variance.sqrt() / n }
    }

    pub fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, error: factor * self.error }
    }

    /// Distance from `other` in standard errors of their difference.
    pub fn z(self, other: Self) -> f64 {
        (self.value - other.value) / self.error.hypot(other.error)
    }
}

/// Mean of one channel over the picture.
pub fn mean(estimate: &Estimate, channel: usize) -> Measured {
    let n = estimate.mean.len() as f64;
    let sum: f64 = estimate.mean.iter().map(|pixel| f64::from(pixel[channel])).sum();
    let variance: f64 = estimate.error.iter().map(|error| f64::from(error[channel]).powi(2)).sum();
    Measured { value: sum / n, error: variance.sqrt() / n }
}

/// Mean opacity over the picture.
pub fn opacity(estimate: &Estimate) -> f64 {
    estimate.mean.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>() / estimate.mean.len() as f64
}

/// A mean over the picture by `count` batches of `samples` each: its error by their spread, for
/// quantities whose error the estimate does not tell.
pub fn by_batches(
    tracer: &mut PathTracer,
    count: u32,
    samples: u32,
    quantity: impl Fn(&Estimate) -> f64,
) -> Measured {
    let sums: Vec<f64> = (1..=count).map(|k| f64::from(k) * quantity(&traced(tracer, k * samples))).collect();
    let batches: Vec<f64> =
        (0..sums.len()).map(|k| sums[k] - if k > 0 { sums[k - 1] } else { 0.0 }).collect();
    Measured::of(&batches)
}

/// All of `results`, named, agree with what they should be: by chance they fail once in 1000 times,
/// however many they are.
pub fn assert_agree(results: &[(String, Measured, Measured)]) {
    let bound = sidak(results.len());
    let told = |(name, found, wanted): &(String, Measured, Measured)| {
        let (z, wide) = (found.z(*wanted), 100.0 * found.error.hypot(wanted.error) / wanted.value.abs());
        format!("{name}: {:.6} for {:.6}, z = {z:.2}, sharp to {wide:.2} %", found.value, wanted.value)
    };
    let lines: Vec<_> = results.iter().map(told).collect();
    eprintln!("{}", lines.join("\n"));
    let wrong = |(_, found, wanted): &&(String, Measured, Measured)| found.z(*wanted).abs().max(0.0) > bound;
    assert!(!results.iter().any(|result| wrong(&result)), "beyond {bound:.2}:\n{}", lines.join("\n"));
}

/// Standard errors that the farthest of so many right results stays within, but for one time in
/// 1000 (Sidak 1967).
pub fn sidak(tests: usize) -> f64 {
    let each = 1.0 - 0.999_f64.powf(1.0 / tests as f64);
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if beyond(middle) > each { low = middle } else { high = middle }
    }
    high
}

/// The chance of a normal variable to be farther from its mean than `z` deviations.
fn beyond(z: f64) -> f64 {
    // The trapezium rule, very good for a smooth integrand that ends flat; half at the start.
    let density = |x: f64| (2.0 / std::f64::consts::PI).sqrt() * (-0.5 * x * x).exp();
    let step = 1e-3;
    let inner: f64 = (1..10_000).map(|i| density(z + step * f64::from(i))).sum();
    step * (0.5 * density(z) + inner)
}

/// The normal deviate as unlikely as this chi-square of so many degrees of freedom: Wilson and
/// Hilferty (1931).
pub fn chi_square_z(chi_square: f64, freedom: usize) -> f64 {
    let spread = 2.0 / (9.0 * freedom as f64);
    ((chi_square / freedom as f64).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// A homogeneous conservative sphere of radius 100 m that just fills a square picture.
pub fn sphere(optical_radius: f64, phase: &str, sky: &str, sun: [f64; 3], irradiance: f64) -> Scene {
    let per_cm3 = optical_radius / 100.0 / EXTINCTION_PER_CM3;
    scene(&format!(
        r#"{{"clouds": [{{"edge": {{"boundary": 0}},
            "droplets": {{"phase": {phase}, "concentration_per_cm3": {per_cm3}}},
            "ellipsoids": [{{"center": [0, 1000, 0], "radii": [100, 100, 100]}}]}}],
        "sky": {sky}, "sun": {{"position": {{"direction": {sun:?}}},
            "irradiance": [{irradiance}, {irradiance}, {irradiance}]}},
        "camera": {{"position": [0, 1000, 500], "target": [0, 1000, 0],
            "projection": {{"orthographic": {{"height": 200}}}}}}}}"#
    ))
}

/// A cloud of two ellipsoids, one sharp and one wispy, that overlap, seen whole from `to_eye` by an
/// orthographic camera.
pub fn noisy(phase: &str, per_cm3: f64, to_eye: glam::DVec3) -> Scene {
    let mut scene = scene(&format!(
        r#"{{"clouds": [{{"edge": {{"boundary": 40, "wispiness": 0.2}},
            "droplets": {{"phase": {phase}, "concentration_per_cm3": {per_cm3}}},
            "ellipsoids": [
                {{"center": [-20, 1000, 0], "radii": [80, 60, 70]}},
                {{"center": [50, 1020, 30], "radii": [60, 50, 60], "edge": {{"boundary": 30, "wispiness": 1}}}}]}}],
        "sky": "none", "camera": {{"position": [0, 1000, 500], "target": [5, 1010, 10],
            "projection": {{"orthographic": {{"height": 260}}}}}}}}"#
    ));
    look_from(&mut scene, to_eye);
    scene
}

/// Puts the camera of a scene 500 m from what it looks at.
pub fn look_from(scene: &mut Scene, to_eye: glam::DVec3) {
    let camera = scene.camera.as_mut().expect("the scene has a camera");
    camera.position = camera.target + 500.0 * to_eye.normalize();
}
