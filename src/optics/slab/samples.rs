//! The light of slabs at the points that the direct table and Bouthors' functions are
//! made from.

use std::f64::consts::PI;

use super::axes::{depth_at, depth_coordinate, point, sun_at, thickness_at};
use super::{Beam, Field, SETS};

/// Optical thicknesses, even in the logarithm.
pub const THICKNESSES: usize = 18;

/// Suns, from 1 degree above the slab to the zenith.
pub const SUNS: usize = 10;

/// Depths from face to face.
pub const DEPTHS: usize = 17;

/// Cosines of the view's direction, from upward to downward.
pub const COSINES: usize = 20;

/// Azimuths, evenly from 0 to pi, in the middles of their steps.
pub const AZIMUTHS: usize = 16;

/// Numbers of a slab.
pub const NUMBERS: usize = SETS * DEPTHS * COSINES * AZIMUTHS;

/// Slabs.
pub const SLABS: usize = THICKNESSES * SUNS;

/// Least light of a column of depths, of its most: under it truncated sums tell nothing.
pub const FLOOR: f64 = 1e-6;

/// A view of a point in a slab: what C of \[K 3.25\] depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Optical thickness of the slab.
    pub thickness: f64,
    /// Optical depth of the point.
    pub depth: f64,
    /// Cosine of the light's direction at the point, to the inward normal: positive downward.
    pub mu: f64,
    /// Azimuth of the same from the sun's, rad: 0 is straight on.
    pub phi: f64,
    /// Cosine of the sunlight's direction to the inward normal; negative where the sun
    /// shines on the far face.
    pub mu0: f64,
}

impl View {
    /// The same with the slab turned over where the sun shines on its far face.
    pub fn sunward(self) -> Self {
        if self.mu0 >= 0.0 {
            return self;
        }
        Self { depth: self.thickness - self.depth, mu: -self.mu, mu0: -self.mu0, ..self }
    }

    /// Cosine of the angle between sunlight and the view's light.
    pub fn cosine(&self) -> f64 {
        let sines = ((1.0 - self.mu * self.mu) * (1.0 - self.mu0 * self.mu0)).max(0.0).sqrt();
        (self.mu * self.mu0 + sines * self.phi.cos()).clamp(-1.0, 1.0)
    }

    /// Sine of half that angle.
    pub fn half_sine(&self) -> f64 {
        (0.5 - 0.5 * self.cosine()).max(0.0).sqrt()
    }

    /// The slab and its sun.
    pub fn beam(&self) -> Beam {
        Beam { thickness: self.thickness, mu0: self.mu0 }
    }
}

/// The slab of samples number `slab`: suns vary fastest.
pub fn beam(slab: usize) -> Beam {
    Beam { thickness: thickness_at(point(slab / SUNS, THICKNESSES)), mu0: sun_at(point(slab % SUNS, SUNS)) }
}

/// Cosine of the view's direction at a coordinate from 0 to 1: dense along the slab.
pub fn view_at(coordinate: f64) -> f64 {
    let from_middle = 2.0 * coordinate - 1.0;
    from_middle * from_middle.abs().sqrt()
}

/// The inverse of [`view_at`].
pub fn view_coordinate(mu: f64) -> f64 {
    0.5 + 0.5 * mu.signum() * mu.abs().min(1.0).cbrt().powi(2)
}

/// Azimuth number `i`, rad.
pub fn azimuth(i: usize) -> f64 {
    PI * (i as f64 + 0.5) / AZIMUTHS as f64
}

/// The view of sample `i` of a slab.
pub fn view(beam: Beam, i: usize) -> View {
    let (depth, mu, phi) = (i / (AZIMUTHS * COSINES) % DEPTHS, i / AZIMUTHS % COSINES, i % AZIMUTHS);
    View {
        thickness: beam.thickness,
        depth: depth_at(point(depth, DEPTHS), beam.thickness),
        mu: view_at(point(mu, COSINES)),
        phi: azimuth(phi),
        mu0: beam.mu0,
    }
}

/// ln(mean source / mu0) of a slab, by set, depth, cosine, azimuth: see [`Field::mean_source`].
pub fn sample(field: &Field) -> Vec<f32> {
    let azimuths: Vec<f64> = (0..AZIMUTHS).map(azimuth).collect();
    let Beam { thickness, mu0 } = field.beam();
    let levels: Vec<f64> = field.depths().iter().map(|depth| depth_coordinate(*depth, thickness)).collect();
    let mut numbers = vec![0.0; NUMBERS];
    for set in 0..SETS {
        for cosine in 0..COSINES {
            let source = field.mean_source(set, view_at(point(cosine, COSINES)), &azimuths);
            for (azimuth, source) in source.iter().enumerate() {
                let floor = FLOOR * source.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
                let logs: Vec<f64> = source.iter().map(|source| (source.max(floor) / mu0).ln()).collect();
                for depth in 0..DEPTHS {
                    let value = between(&levels, &logs, point(depth, DEPTHS));
                    numbers[((set * DEPTHS + depth) * COSINES + cosine) * AZIMUTHS + azimuth] = value as f32;
                }
            }
        }
    }
    numbers
}

/// The cubic through the four neighbours of `x`.
fn between(places: &[f64], values: &[f64], x: f64) -> f64 {
    let above = places.partition_point(|place| *place < x);
    let first = above.saturating_sub(2).min(places.len() - 4);
    let near = first..first + 4;
    near.clone()
        .map(|i| {
            let others = near.clone().filter(|j| *j != i);
            values[i] * others.map(|j| (x - places[j]) / (places[i] - places[j])).product::<f64>()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_of_views_have_their_inverse() {
        for i in 0..=20 {
            let x = point(i, 21);
            assert!((view_coordinate(view_at(x)) - x).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn cubics_are_exact() {
        let places = [0.0, 0.2, 0.3, 0.7, 1.0];
        let cubic = |x: f64| 1.0 - x + 3.0 * x * x * x;
        for x in [0.0, 0.1, 0.5, 0.95, 1.0] {
            assert!((between(&places, &places.map(cubic), x) - cubic(x)).abs() < 1e-12, "{x}");
        }
    }
}
