//! Levels of a slab, dense at both faces, and how light changes from one to the next.

/// Step at the faces of a slab, optical depth: a sun 1 degree high is gone after 0.017.
const FIRST_STEP: f64 = 0.004;

/// Growth of the step with the distance from the nearer face.
const GROWTH: f64 = 0.12;

/// Least number of steps through a slab.
const LEAST_STEPS: f64 = 16.0;

/// Optical depths from 0 to `thickness`, the same from both faces.
pub fn levels(thickness: f64) -> Vec<f64> {
    let first = FIRST_STEP.min(thickness / LEAST_STEPS);
    let mut half = vec![0.0];
    let mut depth = 0.0;
    while depth < 0.5 * thickness {
        depth += first + GROWTH * depth;
        half.push(depth);
    }
    // The last level is the middle of the slab.
    let stretch = 0.5 * thickness / depth;
    half.iter_mut().for_each(|depth| *depth *= stretch);
    let below: Vec<f64> = half.iter().rev().skip(1).map(|depth| thickness - depth).collect();
    half.extend(below);
    half
}

/// What a layer does to light along a direction, where the source function is a parabola in
/// depth: radiance behind it = through * before + near * source before + far * source behind
/// + bend * second derivative of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Transmittance.
    pub through: f64,
    /// Weight of the source where light enters.
    pub near: f64,
    /// Weight of the source where it leaves.
    pub far: f64,
    /// Weight of the source's second derivative by depth; not above 0.
    pub bend: f64,
}

impl Layer {
    /// A layer of optical thickness `thickness` along the normal, crossed at cosine `mu` > 0.
    pub fn new(thickness: f64, mu: f64) -> Self {
        let x = thickness / mu;
        let through = (-x).exp();
        // mean = int e^-xv dv and lobe = x int v (1 - v) e^-xv dv over v from 0 to 1, by
        // their series where the closed forms lose digits.
        let (mean, far, lobe) = if x < 1e-2 {
            let far = x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0)));
            let lobe = x * (1.0 / 6.0 - x * (1.0 / 12.0 - x * (1.0 / 40.0 - x / 180.0)));
            (1.0 - far, far, lobe)
        } else {
            let mean = -(-x).exp_m1() / x;
            let first = (mean - through) / x;
            (mean, 1.0 - mean, x * (first - (2.0 * first - through) / x))
        };
        Self { through, near: mean - through, far, bend: -0.5 * thickness * thickness * lobe }
    }
}

/// The second derivative by depth of a function known at `depths`, in the middle of each
/// layer: weights of the function at the up to four levels around it, from the first given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// The first of four levels.
    pub first: usize,
    /// Weights of the function at these.
    pub weights: [f64; 4],
}

impl Curvature {
    /// Of the layer between levels `k` and `k` + 1; there must be four levels or more.
    pub fn new(depths: &[f64], k: usize) -> Self {
        let first = k.saturating_sub(1).min(depths.len() - 4);
        let mut weights = [0.0; 4];
        // Mean of the parabolas through three neighbours that contain the layer.
        let parabolas: Vec<usize> = (first..first + 2).filter(|start| *start <= k && k < start + 2).collect();
        for start in &parabolas {
            let [a, b, c] = [depths[*start], depths[start + 1], depths[start + 2]];
            let share = 2.0 / parabolas.len() as f64;
            weights[start - first] += share / ((a - b) * (a - c));
            weights[start - first + 1] += share / ((b - a) * (b - c));
            weights[start - first + 2] += share / ((c - a) * (c - b));
        }
        Self { first, weights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_rise_from_face_to_face() {
        for thickness in [0.05, 1.0, 400.0] {
            let levels = levels(thickness);
            assert!(levels.windows(2).all(|pair| pair[1] > pair[0]), "{thickness}");
            assert!((levels[levels.len() - 1] - thickness).abs() < 1e-9 * thickness, "{thickness}");
            assert_eq!(levels[0], 0.0);
        }
    }

    #[test]
    fn a_layer_keeps_what_is_even() {
        for x in [0.0, 1e-9, 9.99e-3, 1.001e-2, 0.3, 50.0] {
            let layer = Layer::new(x, 1.0);
            assert!((layer.through + layer.near + layer.far - 1.0).abs() < 1e-11, "{x}");
            assert!(layer.near >= -1e-12 && layer.far >= 0.0 && layer.bend <= 0.0, "{x}");
        }
    }

    #[test]
    fn a_layer_integrates_a_parabola() {
        // int_0^h s^2 e^{-(h - s) / mu} ds / mu in closed form.
        for (h, mu) in [(0.003_f64, 0.5_f64), (0.2, 0.1), (2.0, 0.9), (9.0, 0.3)] {
            let layer = Layer::new(h, mu);
            let exact = h * h - 2.0 * mu * h + 2.0 * mu * mu * (1.0 - (-h / mu).exp());
            let found = layer.far * h * h + layer.bend * 2.0;
            assert!((found - exact).abs() < 1e-9 * h * h, "{h} {mu}: {found} for {exact}");
        }
    }

    #[test]
    fn curvature_of_a_parabola_is_exact() {
        let depths = levels(3.0);
        let parabola: Vec<f64> = depths.iter().map(|x| 2.0 - x + 0.7 * x * x).collect();
        for k in 0..depths.len() - 1 {
            let Curvature { first, weights } = Curvature::new(&depths, k);
            let found: f64 = (0..4).map(|i| weights[i] * parabola[first + i]).sum();
            assert!((found - 1.4).abs() < 1e-7, "{k}: {found}");
        }
    }
}
