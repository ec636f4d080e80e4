//! The outlines of ellipsoids: exactly what a ray at the edge of each one touches.

use std::f64::consts::TAU;

use eframe::egui::Pos2;
use glam::DVec3;

use super::lens::{Lens, pos};
use crate::scene::Ellipsoid;

/// Most and fewest corners of an outline, and the points of the screen between two of them.
const CORNERS: [usize; 2] = [12, 96];
const BETWEEN: f64 = 6.0;

/// The points of an ellipsoid's surface that lines of sight touch, m; nothing from inside.
///
/// In the space where the ellipsoid is the unit sphere and the eye is at `w`, a line of
/// sight touches the sphere at `u` where `u . (w - u) = 0`, so `u . w = 1`: a circle about
/// `w / |w|^2` of radius `sqrt(1 - 1 / |w|^2)`. Maps between the spaces keep tangency, so its
/// image is the outline: an ellipse in space, a conic on the screen. Without perspective
/// the eye is infinitely far: the great circle across the line of sight.
pub fn silhouette(ellipsoid: &Ellipsoid, lens: &Lens, corners: usize) -> Option<Vec<DVec3>> {
    let into = ellipsoid.orientation.inverse();
    let (axis, height) = if lens.orthographic {
        ((into * -lens.forward / ellipsoid.radii).normalize(), 0.0)
    } else {
        let eye = into * (lens.eye - ellipsoid.center) / ellipsoid.radii;
        let distance = eye.length();
        if distance <= 1.0 {
            return None;
        }
        (eye / distance, 1.0 / distance)
    };
    let radius = (1.0 - height * height).sqrt();
    let (a, b) = axis.any_orthonormal_pair();
    let corner = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / corners as f64).sin_cos();
        let unit = height * axis + radius * (cos * a + sin * b);
        ellipsoid.center + ellipsoid.orientation * (ellipsoid.radii * unit)
    };
    Some((0..corners).map(corner).collect())
}

/// The outline on the screen: lines before the camera, one closed line where all of it is.
pub fn lines(ellipsoid: &Ellipsoid, lens: &Lens) -> Vec<Vec<Pos2>> {
    let Some(count) = corners(ellipsoid, lens) else { return Vec::new() };
    let Some(corners) = silhouette(ellipsoid, lens, count) else { return Vec::new() };
    let mut lines: Vec<Vec<Pos2>> = Vec::new();
    let mut open = false;
    for i in 0..count {
        let piece = lens.clip(corners[i], corners[(i + 1) % count]);
        let ends = piece.and_then(|[a, b]| Some([lens.place(a)?, lens.place(b)?]));
        match (ends, lines.last_mut()) {
            (Some([_, b]), Some(line)) if open => line.push(b),
            (Some([a, b]), _) => lines.push(vec![a, b]),
            _ => {}
        }
        open = ends.is_some();
    }
    lines
}

/// How many corners make an outline look round: as many as its size on the screen asks for,
/// nothing where it is beside the screen. Scenes may have thousands.
fn corners(ellipsoid: &Ellipsoid, lens: &Lens) -> Option<usize> {
    let [fewest, most] = CORNERS;
    let reach = ellipsoid.radii.max_element();
    if !lens.orthographic && lens.depth(ellipsoid.center) < 2.0 * reach {
        // Partly behind the eye, perhaps.
        return (lens.depth(ellipsoid.center) > -reach).then_some(most);
    }
    let at = lens.project(ellipsoid.center)?;
    // Perspective draws spheres out, by no more than this from so far away.
    let radius = 2.0 * reach / lens.metres_per_point(ellipsoid.center);
    let near = lens.rect.expand(radius as f32).contains(pos(at));
    near.then_some(((TAU * radius / BETWEEN) as usize).clamp(fewest, most))
}

/// Whether the centre can be drawn, and where.
pub fn center(ellipsoid: &Ellipsoid, lens: &Lens) -> Option<Pos2> {
    lens.project(ellipsoid.center).map(pos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::viewport::{
        lens::tests::{cameras, lens},
        pick::chord,
    };
    use glam::{DMat3, DQuat};

    fn lumps() -> [Ellipsoid; 3] {
        let orientation = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
        [
            Ellipsoid {
                orientation,
                ..Ellipsoid::new(DVec3::new(-200.0, 900.0, 600.0), DVec3::new(300.0, 90.0, 150.0))
            },
            // The eye is near its surface: the outline is far from an ellipse about the centre.
            Ellipsoid {
                orientation,
                ..Ellipsoid::new(DVec3::new(2700.0, 830.0, 30.0), DVec3::new(150.0, 90.0, 250.0))
            },
            Ellipsoid::new(DVec3::new(1000.0, 500.0, 0.0), DVec3::new(20.0, 700.0, 20.0)),
        ]
    }

    #[test]
    fn rays_within_the_outline_meet_the_ellipsoid_and_rays_beyond_miss_it() {
        for camera in cameras() {
            let lens = lens(&camera);
            for ellipsoid in &lumps() {
                let corners = silhouette(ellipsoid, &lens, 96).unwrap();
                let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
                for corner in corners.iter().filter(|&&corner| lens.orthographic || lens.depth(corner) > 1.0)
                {
                    for (share, meets) in [(1.0 - 1e-6, true), (1.0 + 1e-6, false)] {
                        let at = lens.project(middle + share * (*corner - middle)).unwrap();
                        assert_eq!(chord(ellipsoid, &lens.ray(at)).is_some(), meets);
                    }
                }
            }
        }
    }

    #[test]
    fn the_outline_is_the_conic_of_tangent_directions() {
        // d.A.d (q.A.q - 1) = (d.A.q)^2 for a direction d that touches x.A.x = 1 from q.
        let lens = lens(&cameras()[0]);
        for ellipsoid in &lumps() {
            let turn = DMat3::from_quat(ellipsoid.orientation);
            let a = turn * DMat3::from_diagonal(1.0 / (ellipsoid.radii * ellipsoid.radii)) * turn.transpose();
            let q = lens.eye - ellipsoid.center;
            for corner in silhouette(ellipsoid, &lens, 96).unwrap() {
                let d = (corner - lens.eye).normalize();
                let (left, right) = (d.dot(a * d) * (q.dot(a * q) - 1.0), d.dot(a * q).powi(2));
                assert!((left - right).abs() < 1e-9 * right.max(left), "{left} {right}");
            }
        }
    }

    #[test]
    fn from_inside_there_is_no_outline_and_lines_behind_the_camera_are_cut() {
        let lens = lens(&cameras()[0]);
        let around = Ellipsoid::new(lens.eye, DVec3::splat(10.0));
        assert_eq!(silhouette(&around, &lens, 96), None);
        // A wall beside the camera, half of it behind.
        let wall = Ellipsoid::new(lens.eye + 300.0 * lens.right, DVec3::new(900.0, 900.0, 250.0));
        let wall = Ellipsoid { orientation: DQuat::from_rotation_arc(DVec3::Z, lens.right), ..wall };
        let lines = lines(&wall, &lens);
        assert!(!lines.is_empty() && lines.iter().map(Vec::len).sum::<usize>() < 96);
        assert!(lines.iter().flatten().all(|p| p.is_finite()));
    }

    #[test]
    fn small_ones_have_few_corners_and_those_beside_the_screen_none() {
        let lens = lens(&cameras()[0]);
        let far = |right: f64, radius: f64| {
            let center = lens.eye + 2000.0 * lens.forward + right * lens.right;
            corners(&Ellipsoid::new(center, DVec3::splat(radius)), &lens)
        };
        assert_eq!((far(0.0, 5.0), far(0.0, 500.0)), (Some(12), Some(96)));
        // Half the picture is 1294 m wide there.
        assert_eq!(far(1500.0, 50.0), None);
        assert!(far(1330.0, 50.0).is_some());
    }
}
