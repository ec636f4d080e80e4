//! What moving, turning and scaling does to ellipsoids. No mouse, no window.

use glam::{DMat3, DQuat, DVec3};

use crate::scene::Ellipsoid;

/// Least and greatest radius, m: what scenes allow.
const RADII: [f64; 2] = [0.01, 1e5];

/// A change of one or several ellipsoids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// By a way, m.
    Move(DVec3),
    /// About the pivot.
    Turn {
        /// Unit vector.
        axis: DVec3,
        /// Right-handed, rad.
        angle: f64,
    },
    /// Away from the pivot by a factor along each axis of `frame`.
    Scale {
        /// Factors; negative ones mirror.
        factors: DVec3,
        /// From the axes to the world.
        frame: DQuat,
    },
}

impl Change {
    /// The ellipsoid after the change about `pivot`.
    ///
    /// Scaling is exact: an ellipsoid that is stretched along any axes, its own or not, is an
    /// ellipsoid again. Along its own axes only its radii change; along others it also turns.
    pub fn apply(&self, pivot: DVec3, ellipsoid: &Ellipsoid) -> Ellipsoid {
        match *self {
            Self::Move(by) => Ellipsoid { center: ellipsoid.center + by, ..ellipsoid.clone() },
            Self::Turn { axis, angle } => {
                let turn = DQuat::from_axis_angle(axis, angle);
                Ellipsoid {
                    center: pivot + turn * (ellipsoid.center - pivot),
                    orientation: (turn * ellipsoid.orientation).normalize(),
                    ..ellipsoid.clone()
                }
            }
            Self::Scale { factors, frame } => {
                let stretch = stretch(factors, frame);
                let (radii, orientation) = stretched(ellipsoid, factors, frame);
                Ellipsoid {
                    center: pivot + stretch * (ellipsoid.center - pivot),
                    radii: radii.clamp(DVec3::splat(RADII[0]), DVec3::splat(RADII[1])),
                    orientation,
                    ..ellipsoid.clone()
                }
            }
        }
    }
}

fn stretch(factors: DVec3, frame: DQuat) -> DMat3 {
    let frame = DMat3::from_quat(frame);
    frame * DMat3::from_diagonal(factors) * frame.transpose()
}

/// Radii and orientation after the stretch L: where the unit sphere became the ellipsoid by
/// M = R diag(r), it now does by L M, and L M (L M)^T = U diag(s^2) U^T has the new radii s
/// along the new axes U.
fn stretched(ellipsoid: &Ellipsoid, factors: DVec3, frame: DQuat) -> (DVec3, DQuat) {
    if let Some(radii) = along_own_axes(ellipsoid, factors, frame) {
        return (radii, ellipsoid.orientation);
    }
    let turn = DMat3::from_quat(ellipsoid.orientation);
    let image = stretch(factors, frame) * turn * DMat3::from_diagonal(ellipsoid.radii);
    let (squares, axes) = eigen(image * image.transpose());
    let (order, signs) = nearest_axes(&axes, &turn);
    let axes = DMat3::from_cols(
        signs[0] * axes.col(order[0]),
        signs[1] * axes.col(order[1]),
        signs[2] * axes.col(order[2]),
    );
    let radii = DVec3::from_array(order.map(|i| squares[i].max(0.0).sqrt()));
    (radii, DQuat::from_mat3(&axes).normalize())
}

/// The new radii where each axis of the stretch is an axis of the ellipsoid, or all factors
/// are one.
fn along_own_axes(ellipsoid: &Ellipsoid, factors: DVec3, frame: DQuat) -> Option<DVec3> {
    let size = factors.abs();
    if size.max_element() - size.min_element() <= 1e-12 * size.max_element() {
        return Some(size.x * ellipsoid.radii);
    }
    let between = DMat3::from_quat(frame.inverse() * ellipsoid.orientation);
    let mut radii = ellipsoid.radii;
    for own in 0..3 {
        let axis = between.col(own).abs();
        let along = (0..3).max_by(|&a, &b| axis[a].total_cmp(&axis[b]))?;
        if axis[along] < 1.0 - 1e-12 {
            return None;
        }
        radii[own] *= size[along];
    }
    Some(radii)
}

/// Which column of `axes` stands for which of `before`, and with which sign, so that the
/// axes turn as little as can be and stay right-handed.
fn nearest_axes(axes: &DMat3, before: &DMat3) -> ([usize; 3], [f64; 3]) {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let cosine = |order: &[usize; 3], i: usize| axes.col(order[i]).dot(before.col(i));
    let closeness = |order: &[usize; 3]| (0..3).map(|i| cosine(order, i).abs()).sum::<f64>();
    let order = ORDERS.into_iter().max_by(|a, b| closeness(a).total_cmp(&closeness(b))).unwrap_or(ORDERS[0]);
    let mut signs = [0, 1, 2].map(|i| if cosine(&order, i) < 0.0 { -1.0 } else { 1.0 });
    let columns = [0, 1, 2].map(|i| signs[i] * axes.col(order[i]));
    if columns[0].cross(columns[1]).dot(columns[2]) < 0.0 {
        // The axis that is least sure of its sign gives way.
        let least = (0..3).min_by(|&a, &b| cosine(&order, a).abs().total_cmp(&cosine(&order, b).abs()));
        signs[least.unwrap_or(2)] *= -1.0;
    }
    (order, signs)
}

/// Eigenvalues and unit eigenvectors (columns) of a symmetric matrix, by Jacobi's rotations.
fn eigen(mut m: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = m.col(q)[p];
            if off.abs() <= 1e-15 * (m.col(p)[p].abs() + m.col(q)[q].abs()) {
                continue;
            }
            let theta = (m.col(q)[q] - m.col(p)[p]) / (2.0 * off);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let (cos, sin) = (1.0 / t.hypot(1.0), t / t.hypot(1.0));
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = cos;
            turn.col_mut(q)[q] = cos;
            turn.col_mut(q)[p] = sin;
            turn.col_mut(p)[q] = -sin;
            m = turn.transpose() * m * turn;
            vectors *= turn;
        }
    }
    (DVec3::new(m.col(0).x, m.col(1).y, m.col(2).z), vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned() -> Ellipsoid {
        let orientation = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
        Ellipsoid {
            orientation,
            ..Ellipsoid::new(DVec3::new(40.0, 900.0, -7.0), DVec3::new(90.0, 30.0, 50.0))
        }
    }

    /// How far points of the old surface, moved by `map`, are from the new one.
    fn misfit(before: &Ellipsoid, after: &Ellipsoid, map: impl Fn(DVec3) -> DVec3) -> f64 {
        let mut worst = 0.0f64;
        for i in 0..500 {
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 500.0;
            let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
            let unit = DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
            let moved = map(before.center + before.orientation * (before.radii * unit));
            let back = after.orientation.inverse() * (moved - after.center) / after.radii;
            worst = worst.max((back.length() - 1.0).abs());
        }
        worst
    }

    #[test]
    fn turning_keeps_radii_and_turns_the_surface() {
        let (pivot, axis, angle) = (DVec3::new(100.0, 800.0, 30.0), DVec3::new(0.0, 0.6, 0.8), 1.1);
        let before = turned();
        let after = Change::Turn { axis, angle }.apply(pivot, &before);
        assert_eq!(after.radii, before.radii);
        let turn = DQuat::from_axis_angle(axis, angle);
        assert!(misfit(&before, &after, |p| pivot + turn * (p - pivot)) < 1e-12);
    }

    #[test]
    fn scaling_along_its_own_axes_changes_only_radii() {
        let before = turned();
        let change = Change::Scale { factors: DVec3::new(2.0, 1.0, 0.5), frame: before.orientation };
        let after = change.apply(before.center, &before);
        assert_eq!((after.center, after.orientation), (before.center, before.orientation));
        assert!(after.radii.distance(DVec3::new(180.0, 30.0, 25.0)) < 1e-9);
        // The same axes under other names: a quarter turn about z.
        let frame = before.orientation * DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let after = Change::Scale { factors: DVec3::new(3.0, 1.0, 1.0), frame }.apply(before.center, &before);
        assert!(after.radii.distance(DVec3::new(90.0, 90.0, 50.0)) < 1e-9);
        assert_eq!(after.orientation, before.orientation);
    }

    #[test]
    fn scaling_a_turned_ellipsoid_along_the_worlds_axes_is_exact() {
        let before = turned();
        for factors in [DVec3::new(3.0, 1.0, 1.0), DVec3::new(0.2, 1.0, 2.0), DVec3::new(-1.5, 1.0, 1.0)] {
            let pivot = DVec3::new(10.0, 700.0, 0.0);
            let after = Change::Scale { factors, frame: DQuat::IDENTITY }.apply(pivot, &before);
            // Jacobi in f64, and radii that are square roots.
            assert!(misfit(&before, &after, |p| pivot + factors * (p - pivot)) < 1e-9);
            assert!((after.orientation.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_little_stretch_turns_the_axes_a_little() {
        let before = turned();
        let factors = DVec3::new(1.0 + 1e-4, 1.0, 1.0);
        let after = Change::Scale { factors, frame: DQuat::IDENTITY }.apply(before.center, &before);
        assert!(after.orientation.angle_between(before.orientation) < 1e-3);
        assert!(after.radii.distance(before.radii) < 0.02);
    }

    #[test]
    fn uniform_scaling_keeps_the_orientation_and_radii_stay_in_their_range() {
        let before = turned();
        let change = |factor| Change::Scale { factors: DVec3::splat(factor), frame: DQuat::IDENTITY };
        let after = change(2.0).apply(DVec3::ZERO, &before);
        assert_eq!((after.center, after.radii), (2.0 * before.center, 2.0 * before.radii));
        assert_eq!(after.orientation, before.orientation);
        assert_eq!(change(0.0).apply(DVec3::ZERO, &before).radii, DVec3::splat(0.01));
        assert_eq!(change(1e9).apply(DVec3::ZERO, &before).radii, DVec3::splat(1e5));
    }
}
