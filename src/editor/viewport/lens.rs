//! From the world to the viewport and back, in f64.

use eframe::egui::{Pos2, Rect};
use glam::{DVec2, DVec3};

use crate::scene::{Camera, Projection};

/// A line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins, m.
    pub origin: DVec3,
    /// Where it goes, unit length.
    pub direction: DVec3,
}

impl Ray {
    /// The point at `distance` metres.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + distance * self.direction
    }
}

/// A camera in a rectangle of the screen: its places are egui's points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Where the camera is, m.
    pub eye: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to the top of the picture.
    pub up: DVec3,
    /// Unit vector of the line of sight.
    pub forward: DVec3,
    /// Half the picture's width and height: tangents, or metres where orthographic.
    pub half: DVec2,
    /// How far a lens without parallel lines of sight is shifted, halves of the picture's width and height.
    pub shift: DVec2,
    /// Whether lines of sight are parallel.
    pub orthographic: bool,
    /// The picture on the screen.
    pub rect: Rect,
}

impl Lens {
    /// The lens of `camera` for a picture in `rect`. A camera that sees all around is taken
    /// for a pinhole of 90 degrees.
    pub fn new(camera: &Camera, rect: Rect) -> Self {
        let aspect = f64::from(rect.width().max(1.0) / rect.height().max(1.0));
        let turn = camera.world_from_camera();
        let (half_height, orthographic) = match camera.projection {
            Projection::Orthographic { height } => (0.5 * height, true),
            other => (other.vertical_fov(aspect).map_or(1.0, |fov| (0.5 * fov).tan()), false),
        };
        Self {
            eye: camera.eye(aspect),
            right: turn * DVec3::X,
            up: turn * DVec3::Y,
            forward: turn * DVec3::NEG_Z,
            half: DVec2::new(half_height * aspect, half_height),
            shift: if orthographic { DVec2::ZERO } else { DVec2::from(camera.shift(aspect)) },
            orthographic,
            rect,
        }
    }

    /// The same in a world that is moved by `offset`: for what the wind has carried.
    pub fn seen_from(mut self, offset: DVec3) -> Self {
        self.eye -= offset;
        self
    }

    /// Distance along the line of sight, m.
    pub fn depth(&self, point: DVec3) -> f64 {
        (point - self.eye).dot(self.forward)
    }

    /// Where `point` is on the screen; nothing where it is behind the camera.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let p = point - self.eye;
        let depth = p.dot(self.forward);
        if !self.orthographic && depth <= 0.0 {
            return None;
        }
        let scale = if self.orthographic { 1.0 } else { depth };
        let ndc = DVec2::new(p.dot(self.right), p.dot(self.up)) / (self.half * scale) - self.shift;
        Some(self.place_of(ndc)).filter(|place| place.is_finite())
    }

    /// The same for egui, which works in f32; nothing where it is so far out that f32 and
    /// the tessellator suffer.
    pub fn place(&self, point: DVec3) -> Option<Pos2> {
        self.project(point).filter(|at| at.abs().max_element() < 1e6).map(pos)
    }

    /// The line of sight through a place on the screen.
    pub fn ray(&self, at: DVec2) -> Ray {
        let across = self.across(at);
        if self.orthographic {
            Ray { origin: self.eye + across, direction: self.forward }
        } else {
            Ray { origin: self.eye, direction: (self.forward + across).normalize() }
        }
    }

    /// The point under a place on the screen, `depth` metres along the line of sight.
    pub fn at_depth(&self, at: DVec2, depth: f64) -> DVec3 {
        let across = self.across(at) * if self.orthographic { 1.0 } else { depth };
        self.eye + depth * self.forward + across
    }

    /// Metres that one point of the screen spans at `point`.
    pub fn metres_per_point(&self, point: DVec3) -> f64 {
        let depth = if self.orthographic { 1.0 } else { self.depth(point).max(1e-6) };
        2.0 * self.half.y * depth / f64::from(self.rect.height().max(1.0))
    }

    /// Unit vector from a point to the eye.
    pub fn to_eye(&self, point: DVec3) -> DVec3 {
        if self.orthographic { -self.forward } else { (self.eye - point).normalize_or(-self.forward) }
    }

    /// The piece of a line that is before the camera, for drawing.
    pub fn clip(&self, a: DVec3, b: DVec3) -> Option<[DVec3; 2]> {
        if self.orthographic {
            return Some([a, b]);
        }
        let near = 1e-3 * (self.depth(a).abs() + self.depth(b).abs()).max(1e-6);
        let (da, db) = (self.depth(a) - near, self.depth(b) - near);
        match (da > 0.0, db > 0.0) {
            (true, true) => Some([a, b]),
            (false, false) => None,
            (true, false) => Some([a, a.lerp(b, da / (da - db))]),
            (false, true) => Some([a.lerp(b, da / (da - db)), b]),
        }
    }

    fn place_of(&self, ndc: DVec2) -> DVec2 {
        let (center, size) = (self.rect.center(), self.rect.size());
        DVec2::new(
            f64::from(center.x) + 0.5 * f64::from(size.x) * ndc.x,
            f64::from(center.y) - 0.5 * f64::from(size.y) * ndc.y,
        )
    }

    fn across(&self, at: DVec2) -> DVec3 {
        let (center, size) = (self.rect.center(), self.rect.size());
        let x = 2.0 * (at.x - f64::from(center.x)) / f64::from(size.x.max(1.0));
        let y = 2.0 * (f64::from(center.y) - at.y) / f64::from(size.y.max(1.0));
        (x + self.shift.x) * self.half.x * self.right + (y + self.shift.y) * self.half.y * self.up
    }
}

/// egui's place as f64.
pub fn dvec(at: Pos2) -> DVec2 {
    DVec2::new(f64::from(at.x), f64::from(at.y))
}

/// A place for egui.
pub fn pos(at: DVec2) -> Pos2 {
    Pos2::new(at.x as f32, at.y as f32)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use eframe::egui::{pos2, vec2};

    pub fn lens(camera: &Camera) -> Lens {
        Lens::new(camera, Rect::from_min_size(pos2(40.0, 30.0), vec2(640.0, 360.0)))
    }

    pub fn cameras() -> Vec<Camera> {
        let projections = [
            Projection::Perspective { vertical_fov_deg: 40.0 },
            Projection::Lens { focal_length_mm: 24.0, sensor_width_mm: 36.0 },
            Projection::Orthographic { height: 3000.0 },
        ];
        let camera = |projection| Camera {
            position: DVec3::new(3000.0, 800.0, -40.0),
            target: DVec3::new(-200.0, 900.0, 600.0),
            roll_deg: 20.0,
            projection,
            ..Camera::default()
        };
        let shifted = |camera: Camera| Camera { shift_x: 0.2, shift_y: -0.4, ..camera };
        projections.map(camera).into_iter().flat_map(|camera| [camera.clone(), shifted(camera)]).collect()
    }

    #[test]
    fn places_and_rays_are_inverse() {
        for camera in cameras() {
            let lens = lens(&camera);
            for (x, y) in [(41.0, 31.0), (200.0, 333.0), (360.0, 210.0), (679.0, 100.0)] {
                let at = DVec2::new(x, y);
                for distance in [1.0, 1e3, 1e5] {
                    let back = lens.project(lens.ray(at).at(distance)).unwrap();
                    // f64 at 1e5 m: 1e-11 m of 1e5 m, over 300 points.
                    assert!(back.distance(at) < 1e-7, "{at} {back}");
                    let back = lens.project(lens.at_depth(at, distance)).unwrap();
                    assert!(back.distance(at) < 1e-7, "{at} {back}");
                }
            }
        }
    }

    #[test]
    fn the_lens_agrees_with_the_renderers_camera() {
        for camera in cameras() {
            let lens = lens(&camera);
            let uniform = crate::frame::CameraUniform::new(&camera, 0.0, [1280, 720]);
            for (u, v) in [(0.1f32, 0.2f32), (0.5, 0.5), (0.9, 0.7)] {
                let (origin, direction) = uniform.ray(glam::Vec2::new(u, v));
                let at = DVec2::new(40.0 + 640.0 * f64::from(u), 30.0 + 360.0 * f64::from(v));
                let ray = lens.ray(at);
                // f32 of the renderer.
                assert!(glam::Vec3::from(direction).as_dvec3().distance(ray.direction) < 1e-6);
                assert!(
                    (glam::Vec3::from(origin).as_dvec3() + camera.eye(16.0 / 9.0)).distance(ray.origin)
                        < 1e-3
                );
            }
        }
    }

    #[test]
    fn what_is_behind_has_no_place_and_lines_end_at_the_eye() {
        let lens = lens(&cameras()[0]);
        let behind = lens.eye - 10.0 * lens.forward;
        assert_eq!(lens.project(behind), None);
        let [a, b] = lens.clip(behind, lens.eye + 100.0 * lens.forward + 5.0 * lens.right).unwrap();
        assert!(lens.depth(a) > 0.0 && lens.depth(b) > 99.0);
        assert_eq!(lens.clip(behind, behind + lens.right), None);
    }
}
