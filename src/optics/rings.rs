//! Light sorted by scattering angle into rings about the direction it came from.

use std::f64::consts::PI;

use super::phase::Tabulated;
use crate::Result;

/// Rings of scattering angles: they cover the sphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Rings {
    /// Their edges, rad, from 0 to pi: one more than rings.
    pub edges: Vec<f64>,
}

impl Rings {
    /// Rings whose widths are a share of their angle, but for at least `least` and at most what `most` tells, degrees.
    pub fn new(least: f64, most: impl Fn(f64) -> f64) -> Self {
        let mut edges = vec![0.0];
        let mut at: f64 = 0.0;
        while at < 180.0 {
            at += (0.08 * at).clamp(least, most(at));
            edges.push(at.min(180.0).to_radians());
        }
        let last = edges.len() - 1;
        edges[last] = PI;
        // The last ring is no sliver.
        if edges[last] - edges[last - 1] < 0.5 * (edges[last - 1] - edges[last - 2]) {
            edges.remove(last - 1);
        }
        Self { edges }
    }

    /// Number of rings.
    pub fn count(&self) -> usize {
        self.edges.len() - 1
    }

    /// The ring of an angle, rad.
    pub fn ring(&self, theta: f64) -> usize {
        self.edges.partition_point(|edge| *edge <= theta).clamp(1, self.count()) - 1
    }

    /// Their middles, rad.
    pub fn middles(&self) -> Vec<f64> {
        self.edges.windows(2).map(|edge| 0.5 * (edge[0] + edge[1])).collect()
    }

    /// Their solid angles, sr.
    pub fn solid_angles(&self) -> Vec<f64> {
        // As a product: the difference of cosines loses its digits near 0.
        let solid =
            |edge: &[f64]| 4.0 * PI * (0.5 * (edge[0] + edge[1])).sin() * (0.5 * (edge[1] - edge[0])).sin();
        self.edges.windows(2).map(solid).collect()
    }

    /// Spreads `light` evenly over the angles from `from` to `to`, rad, among the sums of the rings.
    pub fn spread(&self, sums: &mut [f64], from: f64, to: f64, light: f64) {
        let (low, high) = (from.min(to), from.max(to));
        let (first, last) = (self.ring(low), self.ring(high));
        if first == last {
            sums[first] += light;
            return;
        }
        for (sum, edge) in sums.iter_mut().zip(self.edges.windows(2)).take(last + 1).skip(first) {
            let (start, end) = (edge[0].max(low), edge[1].min(high));
            *sum += light * (end - start).max(0.0) / (high - low);
        }
    }

    /// Light of rings blurred by Gauss's curve of deviation `deviation`, rad, along the angle; none is lost.
    pub fn blurred(&self, light: &[f64], deviation: f64) -> Vec<f64> {
        let (middles, widths) = (self.middles(), self.edges.windows(2).map(|edge| edge[1] - edge[0]));
        let widths: Vec<f64> = widths.collect();
        let mut sums = vec![0.0; light.len()];
        for (i, light) in light.iter().enumerate() {
            let first = middles.partition_point(|theta| *theta < middles[i] - 4.0 * deviation);
            let end = middles.partition_point(|theta| *theta <= middles[i] + 4.0 * deviation);
            let weight =
                |j: usize| widths[j] * (-0.5 * ((middles[j] - middles[i]) / deviation).powi(2)).exp();
            let whole: f64 = (first..end).map(weight).sum();
            for (j, sum) in sums.iter_mut().enumerate().take(end).skip(first) {
                *sum += light * weight(j) / whole;
            }
        }
        sums
    }

    /// The phase function of values, 1/sr, in the middles of the rings.
    ///
    /// # Errors
    /// Where values are none.
    pub fn phase(&self, values: &[f64]) -> Result<Tabulated> {
        let (first, last) = (values[0], values[values.len() - 1]);
        let ends = |first: f64, middle: &[f64], last: f64| [&[first], middle, &[last]].concat();
        Tabulated::new(ends(0.0, &self.middles(), PI), ends(first, values, last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rings() -> Rings {
        Rings::new(0.01, |theta| if theta < 60.0 { 0.1 } else { 0.5 })
    }

    #[test]
    fn rings_cover_the_sphere() {
        let rings = rings();
        let whole: f64 = rings.solid_angles().iter().sum();
        assert!((whole / (4.0 * PI) - 1.0).abs() < 1e-12, "{whole}");
        assert!(rings.edges.windows(2).all(|edge| edge[0] < edge[1]));
        for (i, theta) in rings.middles().iter().enumerate() {
            assert_eq!(rings.ring(*theta), i);
        }
        assert_eq!(rings.ring(PI), rings.count() - 1);
    }

    #[test]
    fn light_that_is_spread_or_blurred_stays_the_same_in_sum() {
        let rings = rings();
        let mut sums = vec![0.0; rings.count()];
        rings.spread(&mut sums, 0.3, 0.9, 2.0);
        rings.spread(&mut sums, 0.9, 0.9, 1.0);
        rings.spread(&mut sums, PI, 2.0, 1.0);
        assert!((sums.iter().sum::<f64>() - 4.0).abs() < 1e-9);
        let within: f64 = sums[..rings.ring(0.6)].iter().sum();
        assert!((within - 1.0).abs() < 0.01, "{within}");
        let blurred = rings.blurred(&sums, 0.01);
        assert!((blurred.iter().sum::<f64>() - 4.0).abs() < 1e-9);
        assert!(blurred[rings.ring(0.29)] > 0.0);
    }
}
