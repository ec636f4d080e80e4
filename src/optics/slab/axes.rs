//! The axes of the tables of slabs: where their points lie, and where between them a value
//! is. Shaders have the same coordinates in `shaders/lib/slab.wgsl`.

/// Optical thicknesses of the tables, from the first to the last.
pub const THICKNESS: [f64; 2] = [0.05, 400.0];

/// Number of thicknesses.
pub const THICKNESSES: usize = 24;

/// Number of suns.
pub const SUNS: usize = 16;

/// Lowest sun of the tables, as the cosine to the normal: 1 degree above the slab.
pub const LOWEST_SUN: f64 = 0.017_452_406_437_283_51;

/// Number of depths.
pub const DEPTHS: usize = 32;

/// Optical depth from a face over which light changes, about: tables are dense there.
pub const FACE: f64 = 0.25;

/// Optical thickness at a coordinate from 0 to 1: even in the logarithm.
pub fn thickness_at(coordinate: f64) -> f64 {
    THICKNESS[0] * (THICKNESS[1] / THICKNESS[0]).powf(coordinate)
}

/// The inverse of [`thickness_at`], kept from 0 to 1.
pub fn thickness_coordinate(thickness: f64) -> f64 {
    ((thickness / THICKNESS[0]).ln() / (THICKNESS[1] / THICKNESS[0]).ln()).clamp(0.0, 1.0)
}

/// Cosine of the sun's direction to the normal at a coordinate from 0 to 1: dense where
/// the sun is low.
pub fn sun_at(coordinate: f64) -> f64 {
    LOWEST_SUN + (1.0 - LOWEST_SUN) * coordinate * coordinate
}

/// The inverse of [`sun_at`], kept from 0 to 1.
pub fn sun_coordinate(mu0: f64) -> f64 {
    ((mu0 - LOWEST_SUN) / (1.0 - LOWEST_SUN)).clamp(0.0, 1.0).sqrt()
}

/// Coordinate from 0 to 1 of an optical depth in a slab: dense at both faces.
pub fn depth_coordinate(depth: f64, thickness: f64) -> f64 {
    let depth = depth.clamp(0.0, thickness);
    let from_face = |x: f64| (x / FACE).ln_1p();
    0.5 + 0.5 * (from_face(depth) - from_face(thickness - depth)) / from_face(thickness)
}

/// The inverse of [`depth_coordinate`], by bisection.
pub fn depth_at(coordinate: f64, thickness: f64) -> f64 {
    let (mut low, mut high) = (0.0, thickness);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if depth_coordinate(middle, thickness) < coordinate { low = middle } else { high = middle }
    }
    if coordinate <= 0.0 {
        0.0
    } else if coordinate >= 1.0 {
        thickness
    } else {
        0.5 * (low + high)
    }
}

/// Optical depth of paths at the middle of their coordinates.
const MIDDLE_PATH: f64 = 4.0;

/// Optical depth of a path at a coordinate from 0 to 1, where there is no end to it.
pub fn path_at(coordinate: f64) -> f64 {
    MIDDLE_PATH * coordinate / (1.0 - coordinate)
}

/// The inverse of [`path_at`].
pub fn path_coordinate(path: f64) -> f64 {
    path / (path + MIDDLE_PATH)
}

/// Point `i` of `n`, as a coordinate from 0 to 1.
pub fn point(i: usize, n: usize) -> f64 {
    i as f64 / (n - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_have_their_inverses() {
        for i in 0..=20 {
            let x = point(i, 21);
            assert!((thickness_coordinate(thickness_at(x)) - x).abs() < 1e-12);
            assert!((sun_coordinate(sun_at(x)) - x).abs() < 1e-12);
            let inner = 0.99 * x;
            assert!((path_coordinate(path_at(inner)) - inner).abs() < 1e-12);
            for thickness in [0.05, 3.0, 400.0] {
                assert!((depth_coordinate(depth_at(x, thickness), thickness) - x).abs() < 1e-9);
            }
        }
    }
}
