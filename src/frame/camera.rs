//! The camera as the shaders see it.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3, Vec2, Vec3, Vec3A};

use crate::scene::{Camera, Projection};

/// `Camera` of `shaders/lib/camera.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CameraUniform {
    pub(crate) right: Vec3,
    pub(crate) projection: u32,
    pub(crate) up: Vec3,
    pub(crate) altitude: f32,
    pub(crate) forward: Vec3,
    pub(crate) pixel: f32,
    pub(crate) axis: Vec3,
    pub(crate) jitter: f32,
    pub(crate) size: [f32; 2],
    pub(super) padding: [f32; 2],
}

/// Projection, and the axes of the picture.
pub(crate) type Rays = (u32, [Vec3; 3]);

impl CameraUniform {
    pub(crate) const PERSPECTIVE: u32 = 0;
    pub(crate) const ORTHOGRAPHIC: u32 = 1;
    pub(crate) const EQUIRECTANGULAR: u32 = 2;

    /// The camera for a picture of `width` by `height` pixels, over ground at
    /// `ground` metres.
    pub fn new(camera: &Camera, ground: f64, [width, height]: [u32; 2]) -> Self {
        let aspect = f64::from(width) / f64::from(height);
        let world_from_camera = camera.world_from_camera();
        let [right, up, forward] = [DVec3::X, DVec3::Y, DVec3::NEG_Z].map(|axis| world_from_camera * axis);
        let (half, projection, pixel) = match camera.projection {
            Projection::Perspective { vertical_fov_deg } => {
                let y = (0.5 * vertical_fov_deg.to_radians()).tan();
                ([y * aspect, y], Self::PERSPECTIVE, 2.0 * y / f64::from(height))
            }
            Projection::Lens { focal_length_mm, sensor_width_mm } => {
                let x = 0.5 * sensor_width_mm / focal_length_mm;
                ([x, x / aspect], Self::PERSPECTIVE, 2.0 * x / f64::from(width))
            }
            Projection::Orthographic { height: metres } => {
                ([0.5 * metres * aspect, 0.5 * metres], Self::ORTHOGRAPHIC, metres / f64::from(height))
            }
            Projection::Equirectangular => {
                ([1.0, 1.0], Self::EQUIRECTANGULAR, std::f64::consts::PI / f64::from(height))
            }
        };
        let [x, y] = camera.shift(aspect);
        // Parallel lines of sight begin elsewhere, others are turned.
        let shift = if projection == Self::PERSPECTIVE {
            x * half[0] * right + y * half[1] * up
        } else {
            DVec3::ZERO
        };
        Self {
            right: (right * half[0]).as_vec3(),
            projection,
            up: (up * half[1]).as_vec3(),
            altitude: (camera.eye(aspect).y - ground) as f32,
            forward: (forward + shift).as_vec3(),
            pixel: pixel as f32,
            axis: forward.as_vec3(),
            jitter: 0.0,
            size: [width as f32, height as f32],
            padding: [0.0; 2],
        }
    }

    /// Parallel lines of sight along `forward` from the points of a horizontal square of `extent` metres,
    /// north on top; `altitude` is that of its middle above the ground, m. They need not leave
    /// the square at right angles.
    pub(crate) fn from_square(forward: DVec3, extent: f64, altitude: f64, size: u32) -> Self {
        let half = 0.5 * extent;
        Self {
            right: (half * DVec3::X).as_vec3(),
            projection: Self::ORTHOGRAPHIC,
            up: (half * DVec3::NEG_Z).as_vec3(),
            altitude: altitude as f32,
            forward: forward.as_vec3(),
            pixel: (extent / f64::from(size)) as f32,
            axis: DVec3::Y.as_vec3(),
            jitter: 0.0,
            size: [size as f32; 2],
            padding: [0.0; 2],
        }
    }

    /// The same view in pixels of another number.
    pub(crate) fn resized(self, [width, height]: [u32; 2]) -> Self {
        let size = [width as f32, height as f32];
        Self { pixel: self.pixel * self.size[1] / size[1], size, ..self }
    }

    /// What the rays of a picture are, whatever its size.
    pub(crate) fn rays(&self) -> Rays {
        (self.projection, [self.right, self.up, self.forward])
    }

    pub(crate) fn jittered(mut self, on: bool) -> Self {
        self.jitter = f32::from(u8::from(on));
        self
    }

    /// Origin, relative to the camera's position, and direction of the ray through a
    /// place on the picture, (0, 0) at the top left and (1, 1) at the bottom right:
    /// `camera_ray` of the shader.
    pub(crate) fn ray(&self, uv: Vec2) -> (Vec3A, Vec3A) {
        let ndc = Vec2::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
        let across = ndc.x * self.right + ndc.y * self.up;
        let (origin, direction) = match self.projection {
            Self::ORTHOGRAPHIC => (across, self.forward),
            Self::EQUIRECTANGULAR => {
                let (azimuth, elevation) = (ndc.x * PI, ndc.y * FRAC_PI_2);
                let level = azimuth.sin() * self.right + azimuth.cos() * self.forward;
                (Vec3::ZERO, elevation.cos() * level + elevation.sin() * self.up)
            }
            _ => (Vec3::ZERO, (self.forward + across).normalize()),
        };
        (origin.into(), direction.into())
    }

    /// Where a point is seen that is at `p` from the camera, m: x to the right and y up, both from -1 to 1 in the picture.
    /// None of what is behind a perspective camera. The inverse of the ray through a pixel.
    pub fn place_of(&self, p: DVec3) -> Option<DVec2> {
        let [right, up, forward, axis] = [self.right, self.up, self.forward, self.axis].map(Vec3::as_dvec3);
        let along =
            |v: DVec3| DVec2::new(v.dot(right) / right.length_squared(), v.dot(up) / up.length_squared());
        match self.projection {
            Self::ORTHOGRAPHIC => Some(along(p - p.dot(axis) / forward.dot(axis) * forward)),
            Self::EQUIRECTANGULAR => {
                let azimuth = p.dot(right).atan2(p.dot(forward));
                let elevation = p.normalize_or_zero().dot(up).clamp(-1.0, 1.0).asin();
                Some(DVec2::new(azimuth / std::f64::consts::PI, elevation / std::f64::consts::FRAC_PI_2))
            }
            _ => {
                let depth = p.dot(axis) / forward.dot(axis);
                (depth > 0.0).then(|| along(p / depth - forward))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Aperture;

    const SIZE: [u32; 2] = [1600, 900];

    fn lens() -> Camera {
        let aperture = Some(Aperture { radius: Some(3.0), f_stop: None, focus: 500.0 });
        let position = DVec3::new(30.0, 800.0, -200.0);
        let target = position + DVec3::new(300.0, 120.0, -700.0);
        Camera { position, target, roll_deg: 20.0, shift_x: 0.1, aperture, ..Camera::default() }
    }

    #[test]
    fn places_and_rays_are_inverse() {
        let projections = [
            Projection::default(),
            Projection::Lens { focal_length_mm: 24.0, sensor_width_mm: 36.0 },
            Projection::Orthographic { height: 400.0 },
            Projection::Equirectangular,
        ];
        for projection in projections {
            let uniform = CameraUniform::new(&Camera { projection, ..lens() }, 0.0, SIZE);
            for (u, v) in [(0.1, 0.2), (0.5, 0.5), (0.93, 0.7)] {
                let (origin, direction) = uniform.ray(Vec2::new(u, v));
                let p = Vec3::from(origin + 3000.0 * direction).as_dvec3();
                let found = uniform.place_of(p).unwrap();
                let expected = DVec2::new(2.0 * f64::from(u) - 1.0, 1.0 - 2.0 * f64::from(v));
                // Floats of 3 km.
                assert!(found.distance(expected) < 3e-6, "{projection:?}: {found} {expected}");
            }
        }
        let ahead = CameraUniform::new(&lens(), 0.0, SIZE);
        assert_eq!(ahead.place_of(-lens().forward()), None);
    }

    #[test]
    fn a_lens_shift_is_that_of_the_whole_picture() {
        let still = CameraUniform::new(&Camera { shift_x: 0.0, ..lens() }, 0.0, SIZE);
        let shifted = CameraUniform::new(&lens(), 0.0, SIZE);
        for p in [lens().forward(), 900.0 * lens().forward() + DVec3::new(40.0, 100.0, 3.0)] {
            // A tenth of the width, which is 2, to the left.
            let moved = shifted.place_of(p).unwrap() - still.place_of(p).unwrap();
            assert!(moved.distance(DVec2::new(-0.2, 0.0)) < 1e-6, "{moved}");
        }
    }

    /// The circle of confusion of a thin lens: a point at depth z is seen R (1/z - 1/focus) off, in tangents.
    #[test]
    fn what_is_at_the_focus_stays_and_other_things_go_by_a_thin_lens() {
        let (camera, aspect) = (lens(), 16.0 / 9.0);
        let half = aspect * (20f64).to_radians().tan();
        let turn = camera.world_from_camera();
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [-0.3, 0.8]] {
            let through = camera.through([x, y], aspect);
            let [middle, edge] = [&camera, &through].map(|camera| CameraUniform::new(camera, 0.0, SIZE));
            for depth in [100.0, 500.0, 4000.0] {
                let p = camera.position + turn * DVec3::new(0.1 * depth, -0.05 * depth, -depth);
                let before = middle.place_of(p - camera.position).unwrap();
                let moved = edge.place_of(p - through.position).unwrap() - before;
                let off = -3.0 * (1.0 / depth - 1.0 / 500.0);
                let expected = DVec2::new(x * off / half, y * off * aspect / half);
                assert!(moved.distance(expected) < 1e-6, "{depth}: {moved} {expected}");
            }
        }
    }
}
