//! The eye of the viewport: a turntable about a pivot. No GPU, no window.

use eframe::egui::Rect;
use glam::{DQuat, DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::lens::Lens;
use crate::scene::{Aperture, Bounds, Camera, Projection};

/// Farthest from level, rad: a hair less than straight, so that left stays left.
const STEEPEST: f64 = std::f64::consts::FRAC_PI_2 - 1e-4;
/// Nearest and farthest that the pivot may be from the eye, m.
const NEAREST: f64 = 0.05;
const FARTHEST: f64 = 1e6;
/// Largest coordinate of the eye, m: within what a scene's camera may have.
const REACH: f64 = 5e6;
/// Room about what is framed.
const MARGIN: f64 = 1.15;
/// Width over height of the pictures that scenes are framed for.
pub const PICTURE_ASPECT: f64 = 16.0 / 9.0;
/// Vertical field of view of a new view, degrees.
const FIELD_OF_VIEW: f64 = 45.0;

/// From where the viewport looks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Navigation {
    /// What the eye turns about and looks at, m.
    pub pivot: DVec3,
    /// From the eye to the pivot, m.
    pub distance: f64,
    /// Compass direction of the line of sight, rad: 0 is north, a quarter turn east.
    pub heading: f64,
    /// Elevation of the line of sight, rad.
    pub pitch: f64,
    /// Turn about the line of sight, rad; 0 but for scenes' cameras that are tilted.
    pub roll: f64,
    /// How directions become places.
    pub projection: Projection,
    /// How far the lens is shifted, shares of the picture's width.
    pub shift: DVec2,
    /// How wide the lens is open: kept for the scene's camera, views are those of pinholes.
    pub aperture: Option<Aperture>,
    /// Whether parallel lines stay parallel; spans what the lens sees at the pivot.
    pub orthographic: bool,
    /// Whether all of the picture that the camera would take fits into the window.
    pub framed: bool,
}

impl Default for Navigation {
    fn default() -> Self {
        Self {
            pivot: DVec3::new(0.0, 500.0, 0.0),
            distance: 3000.0,
            heading: 0.0,
            pitch: 0.0,
            roll: 0.0,
            projection: Projection::Perspective { vertical_fov_deg: FIELD_OF_VIEW },
            shift: DVec2::ZERO,
            aperture: None,
            orthographic: false,
            framed: false,
        }
    }
}

/// One of the six views along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// From the south to the north.
    Front,
    /// From the north to the south.
    Back,
    /// From the east to the west.
    Right,
    /// From the west to the east.
    Left,
    /// From above, north up.
    Top,
    /// From below, north down.
    Bottom,
}

impl Navigation {
    /// Looks through `camera`; turns about a point in its line of sight as far away as
    /// `focus`, m.
    pub fn through(camera: &Camera, focus: DVec3) -> Self {
        let forward = camera.forward();
        let ahead = (focus - camera.position).dot(forward);
        let distance = if ahead > NEAREST { ahead } else { camera.position.distance(camera.target) };
        let distance = distance.clamp(NEAREST, FARTHEST);
        let level = forward.x.hypot(forward.z);
        let projection = match camera.projection {
            Projection::Equirectangular => Projection::Perspective { vertical_fov_deg: 90.0 },
            Projection::Orthographic { height } => Projection::Perspective {
                vertical_fov_deg: (2.0 * (0.5 * height / distance).atan()).to_degrees().clamp(0.1, 170.0),
            },
            other => other,
        };
        Self {
            pivot: camera.position + distance * forward,
            distance,
            heading: if level > 1e-9 { forward.x.atan2(-forward.z) } else { 0.0 },
            pitch: forward.y.atan2(level).clamp(-STEEPEST, STEEPEST),
            roll: camera.roll_deg.to_radians(),
            projection,
            shift: DVec2::new(camera.shift_x, camera.shift_y),
            aperture: camera.aperture,
            orthographic: matches!(camera.projection, Projection::Orthographic { .. }),
            framed: false,
        }
    }

    /// Unit vector of the line of sight.
    pub fn forward(&self) -> DVec3 {
        let (sin, cos) = self.heading.sin_cos();
        let (rise, level) = self.pitch.sin_cos();
        DVec3::new(sin * level, rise, -cos * level)
    }

    /// Where the eye is, m.
    pub fn eye(&self) -> DVec3 {
        self.pivot - self.distance * self.forward()
    }

    /// The view as a scene's camera, for a picture of `aspect` (width over height).
    pub fn camera(&self, aspect: f64) -> Camera {
        let projection = if self.orthographic {
            let half = 0.5 * self.projection.vertical_fov(aspect).unwrap_or(1.0);
            Projection::Orthographic { height: (2.0 * self.distance * half.tan()).clamp(0.01, 1e7) }
        } else {
            self.projection
        };
        let position = self.eye();
        // Far enough that the subtraction keeps the direction.
        let target = position + self.distance.max(100.0) * self.forward();
        let DVec2 { x: shift_x, y: shift_y } = self.shift;
        Camera {
            position,
            target,
            roll_deg: self.roll.to_degrees(),
            projection,
            shift_x,
            shift_y,
            aperture: self.aperture.filter(|_| !self.orthographic),
        }
    }

    /// What the window shows: the camera, or more around its picture where that would not fit
    /// into a window of `aspect`.
    pub fn seen(&self, aspect: f64) -> Camera {
        let mut camera = self.camera(aspect);
        let wider = (PICTURE_ASPECT / aspect).max(1.0);
        let higher = (aspect / PICTURE_ASPECT).max(1.0);
        if self.framed {
            // What is around the picture is part of the width.
            camera.shift_x /= higher;
            camera.shift_y /= higher;
        }
        match &mut camera.projection {
            _ if !self.framed => {}
            Projection::Perspective { vertical_fov_deg } => {
                let half = (0.5 * vertical_fov_deg.to_radians()).tan();
                *vertical_fov_deg = (2.0 * (wider * half).atan()).to_degrees().min(170.0);
            }
            // The width of the sensor fills the width of the picture.
            Projection::Lens { focal_length_mm, .. } => *focal_length_mm /= higher,
            Projection::Orthographic { height } => *height *= wider,
            Projection::Equirectangular => {}
        }
        camera
    }

    /// The lens of this view in `rect`.
    pub fn lens(&self, rect: Rect) -> Lens {
        let aspect = f64::from(rect.width().max(1.0) / rect.height().max(1.0));
        Lens::new(&self.seen(aspect), rect)
    }

    /// Turns about `about` by a drag, rad to the right and up; `about` keeps its place on
    /// the screen.
    pub fn orbit(&mut self, about: DVec3, turn: DVec2) {
        let before = self.turn();
        let eye = self.eye() - about;
        self.look(turn);
        let eye = about + self.turn() * (before.inverse() * eye);
        self.pivot = eye + self.distance * self.forward();
        self.keep_in_reach();
    }

    /// Turns the head: the eye stays.
    pub fn look_around(&mut self, turn: DVec2) {
        let eye = self.eye();
        self.look(turn);
        self.pivot = eye + self.distance * self.forward();
    }

    /// Slides so that what was `depth` metres deep under `from` comes under `to`.
    pub fn pan(&mut self, lens: &Lens, from: DVec2, to: DVec2, depth: f64) {
        self.pivot += lens.at_depth(from, depth) - lens.at_depth(to, depth);
        self.keep_in_reach();
    }

    /// Comes nearer to `anchor` by `factor` of the distance (below 1 nearer); `anchor` keeps
    /// its place on the screen.
    pub fn dolly(&mut self, anchor: DVec3, factor: f64) {
        let distance = (self.distance * factor).clamp(NEAREST, FARTHEST);
        if self.orthographic {
            // Only the span changes what is seen.
            let lens_plane = self.eye();
            let along = (anchor - lens_plane).dot(self.forward());
            let across = anchor - lens_plane - along * self.forward();
            self.pivot += (1.0 - distance / self.distance) * across;
        } else {
            let eye = anchor + factor * (self.eye() - anchor);
            self.pivot = eye + distance * self.forward();
        }
        self.distance = distance;
        self.keep_in_reach();
    }

    /// Flies by metres to the right, up in the world, and ahead.
    pub fn fly(&mut self, by: DVec3) {
        let right = self.turn() * DVec3::X;
        self.pivot += by.x * right + by.y * DVec3::Y + by.z * self.forward();
        self.keep_in_reach();
    }

    /// Comes so near that a box fills the picture of `aspect`.
    pub fn frame(&mut self, (low, high): Bounds, aspect: f64) {
        let radius = (0.5 * high.distance(low)).max(0.01);
        let half = 0.5 * self.projection.vertical_fov(aspect).unwrap_or(1.0);
        let narrow = half.min((half.tan() * aspect).atan());
        self.framed = false;
        self.pivot = 0.5 * (low + high);
        let fit = if self.orthographic { narrow.tan() } else { narrow.sin() };
        self.distance = (MARGIN * radius / fit).clamp(NEAREST, FARTHEST);
        self.keep_in_reach();
    }

    /// Looks at the pivot from a side.
    pub fn look_from(&mut self, side: Side) {
        use std::f64::consts::{FRAC_PI_2, PI};
        (self.heading, self.pitch) = match side {
            Side::Front => (0.0, 0.0),
            Side::Back => (PI, 0.0),
            Side::Right => (-FRAC_PI_2, 0.0),
            Side::Left => (FRAC_PI_2, 0.0),
            Side::Top => (0.0, -STEEPEST),
            Side::Bottom => (0.0, STEEPEST),
        };
        self.roll = 0.0;
        self.framed = false;
    }

    /// Between two views, for a move that the eye can follow; `share` 0 is this one.
    pub fn toward(&self, other: &Self, share: f64) -> Self {
        let turn = (other.heading - self.heading + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Self {
            pivot: self.pivot.lerp(other.pivot, share),
            distance: self.distance * (other.distance / self.distance).powf(share),
            heading: self.heading + share * turn,
            pitch: mix(self.pitch, other.pitch),
            roll: mix(self.roll, other.roll),
            ..other.clone()
        }
    }

    fn look(&mut self, turn: DVec2) {
        self.heading = (self.heading + turn.x).rem_euclid(std::f64::consts::TAU);
        self.pitch = (self.pitch + turn.y).clamp(-STEEPEST, STEEPEST);
    }

    /// From the camera's space to the world.
    fn turn(&self) -> DQuat {
        DQuat::from_rotation_y(-self.heading)
            * DQuat::from_rotation_x(self.pitch)
            * DQuat::from_rotation_z(-self.roll)
    }

    fn keep_in_reach(&mut self) {
        let reach = DVec3::splat(REACH - FARTHEST);
        self.pivot = self.pivot.clamp(-reach, reach);
    }
}

#[cfg(test)]
#[path = "navigation_tests.rs"]
mod tests;
