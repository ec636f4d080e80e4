//! Turns about the vertical that come out the same on every platform.

use glam::{DQuat, DVec3};

/// The turn from a cloud's own frame, downwind along +x, to the world's: a compass direction, degrees clockwise
/// from north (-z). Exact for east; elsewhere to 1e-9.
pub(super) fn from_downwind(heading_deg: f64) -> DQuat {
    let right_of_east = heading_deg - 90.0;
    if right_of_east == 0.0 {
        return DQuat::IDENTITY;
    }
    // Turning right is turning about -y.
    let half = -0.5 * right_of_east * (std::f64::consts::PI / 180.0);
    let (sin, cos) = sin_cos(half);
    DQuat::from_xyzw(0.0, sin, 0.0, cos).normalize()
}

/// The turn about the vertical that brings +x to the horizontal direction of `v`.
pub(super) fn along(v: DVec3) -> DQuat {
    let length = (v.x * v.x + v.z * v.z).sqrt();
    if length < 1e-9 {
        return DQuat::IDENTITY;
    }
    let cos = v.x / length;
    let half_cos = (0.5 * (1.0 + cos)).max(0.0).sqrt();
    let half_sin = (0.5 * (1.0 - cos)).max(0.0).sqrt();
    // About +y, +x goes to -z.
    DQuat::from_xyzw(0.0, if v.z > 0.0 { -half_sin } else { half_sin }, 0.0, half_cos).normalize()
}

/// Sine and cosine by their series, which no library rounds its own way; |x| up to 4, errors below 1e-9.
fn sin_cos(x: f64) -> (f64, f64) {
    let (mut sin, mut cos, mut term) = (0.0, 0.0, 1.0);
    for n in 0..32 {
        match n % 4 {
            0 => cos += term,
            1 => sin += term,
            2 => cos -= term,
            _ => sin -= term,
        }
        term *= x / f64::from(n + 1);
    }
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_compass_directions() {
        for heading in [-360.0, -75.0, 0.0, 33.0, 90.0, 180.0, 270.0, 360.0f64] {
            let (sin, cos) = heading.to_radians().sin_cos();
            let to = from_downwind(heading) * DVec3::X;
            assert!(to.distance(DVec3::new(sin, 0.0, -cos)) < 1e-9, "{heading}: {to}");
        }
    }

    #[test]
    fn what_lies_along_a_direction_points_there() {
        for v in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::new(0.3, 0.0, -2.0), DVec3::new(-1.0, 0.0, 0.2)] {
            assert!((along(v) * DVec3::X).distance(v.normalize()) < 1e-9, "{v}");
        }
    }
}
