//! The directions along which light is solved for.

use glam::Vec4;

use crate::optics::slab::angles::Quadrature;

/// Levels of the quadrature, and directions of each.
const LEVELS: usize = 6;
const PLACES: usize = 8;
/// Directions in all.
pub const DIRECTIONS: usize = LEVELS * PLACES;

/// Levels of height, from the top, with their weights, which add up to 2: Gauss and Legendre's.
pub fn levels() -> Vec<(f64, f64)> {
    let rule = Quadrature::new(LEVELS);
    rule.mu.iter().zip(&rule.weight).map(|(x, weight)| (2.0 * x - 1.0, 2.0 * weight)).collect()
}

/// Azimuth of place `j` of level `k`, rad; levels are turned against each other.
fn azimuth(k: usize, j: f64) -> f64 {
    std::f64::consts::TAU * (j + 0.25 + 0.5 * (k % 2) as f64) / PLACES as f64
}

/// Directions of propagation and their weights, which add up to 4 pi: evenly many places around
/// each level. Exact for products of harmonics to degree 3.
pub fn directions() -> Vec<Vec4> {
    let mut ways = Vec::with_capacity(DIRECTIONS);
    for (k, (height, weight)) in levels().into_iter().enumerate() {
        let around = (1.0 - height * height).sqrt();
        let share = std::f64::consts::TAU * weight / PLACES as f64;
        ways.extend((0..PLACES).map(|j| {
            let angle = azimuth(k, j as f64);
            glam::DVec4::new(around * angle.cos(), height, around * angle.sin(), share).as_vec4()
        }));
    }
    ways
}

/// The part of the sphere that each direction's light comes from: sines of elevation and azimuths,
/// low and high.
pub fn patches() -> Vec<[f32; 4]> {
    let mut patches = Vec::with_capacity(DIRECTIONS);
    let mut top = 1.0;
    for (k, (_, weight)) in levels().into_iter().enumerate() {
        let bottom = top - weight;
        patches.extend((0..PLACES).map(|j| {
            let [start, end] = [-0.5, 0.5].map(|half| azimuth(k, j as f64 + half) + std::f64::consts::PI);
            // Light comes from where it does not go.
            [-top, -bottom, start, end].map(|x| x as f32)
        }));
        top = bottom;
    }
    patches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_integrate_products_of_harmonics_exactly() {
        // Of degree 0 to 3: monomials to degree 6 in each coordinate.
        let ways = directions();
        let integral = |f: &dyn Fn(Vec4) -> f64| ways.iter().map(|d| f64::from(d.w) * f(*d)).sum::<f64>();
        let whole = 4.0 * std::f64::consts::PI;
        for (power, share) in [(0, 1.0), (2, 1.0 / 3.0), (4, 1.0 / 5.0), (6, 1.0 / 7.0), (3, 0.0), (5, 0.0)] {
            for axis in 0..3 {
                let found = integral(&|d| f64::from(d[axis]).powi(power)) / whole;
                assert!((found - share).abs() < 1e-6, "axis {axis}, power {power}: {found}");
            }
        }
    }

    #[test]
    fn patches_tile_the_sphere_and_lie_behind_their_directions() {
        let (ways, patches) = (directions(), patches());
        let area: f32 = patches.iter().map(|[low, high, start, end]| (high - low) * (end - start)).sum();
        assert!((area - 4.0 * std::f32::consts::PI).abs() < 1e-4);
        for (way, [low, high, start, end]) in ways.iter().zip(&patches) {
            let azimuth = 0.5 * (start + end);
            let around = (1.0 - way.y * way.y).sqrt();
            assert!(*low < -way.y && -way.y < *high);
            assert!((around * azimuth.cos() + way.x).abs() < 1e-5);
            assert!((around * azimuth.sin() + way.z).abs() < 1e-5);
            // Its weight is its solid angle.
            assert!(((high - low) * (end - start) - way.w).abs() < 1e-5);
        }
    }
}
