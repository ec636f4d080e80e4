//! The parts of a picture, in quarters of quarters, with what each can see of the world: the same for all clouds,
//! and for all pictures of a camera that moves without turning.

use std::sync::OnceLock;

use glam::{UVec2, Vec2, Vec3A};

use crate::frame::CameraUniform;

pub(super) const TILE: u32 = 16;
/// Quarters of a tile are tiles of their own where one of them is empty, and quarters of those.
pub(super) const SMALL: u32 = TILE / 2;
pub(super) const SMALLEST: u32 = 4;

/// All parts of a picture, found when first asked for.
pub(in crate::render) struct Parts {
    pub(super) camera: CameraUniform,
    pub(super) roots: Vec<Part>,
}

/// A rectangle of the picture, pixels, and what it can see.
pub(super) struct Part {
    pub min: UVec2,
    pub max: UVec2,
    /// What it is cut into, by steps of so many pixels.
    step: u32,
    quarters: OnceLock<Box<[Part; 4]>>,
    wedge: Wedge,
}

/// Everything that a rectangle of the picture can see: inside four planes and in front.
struct Wedge {
    /// Inward normals.
    planes: [Vec3A; 4],
    front: Option<Vec3A>,
    everything: bool,
    /// A point of each plane and of the front from the eye, m, where lines of sight do not begin there.
    points: Option<Box<[Vec3A; 5]>>,
}

impl Parts {
    /// Those of the picture of `camera`.
    pub fn new(camera: &CameraUniform) -> Self {
        let size = UVec2::new(camera.size[0] as u32, camera.size[1] as u32);
        // A wedge between four planes bounds a part of an equirectangular picture only
        // where it is much narrower than a half-turn.
        let start = if camera.projection == CameraUniform::EQUIRECTANGULAR { size / 16 + 1 } else { size };
        let mut roots = Vec::new();
        for y in (0..size.y).step_by(start.y as usize) {
            for x in (0..size.x).step_by(start.x as usize) {
                let corner = UVec2::new(x, y);
                roots.push(Part::new(camera, corner, (corner + start).min(size), TILE));
            }
        }
        Self { camera: *camera, roots }
    }

    /// Whether the picture of `camera` has the same, wherever it is.
    pub fn are_of(&self, camera: &CameraUniform) -> bool {
        let mut level = *camera;
        level.altitude = self.camera.altitude;
        self.camera == level
    }
}

impl Part {
    /// A part of one that was cut in steps of `step` pixels.
    fn new(camera: &CameraUniform, min: UVec2, max: UVec2, step: u32) -> Self {
        let widest = max.saturating_sub(min).max_element();
        let step = match step {
            TILE if widest > TILE => TILE,
            step => step / 2,
        };
        Self { min, max, step, quarters: OnceLock::new(), wedge: Wedge::new(camera, min, max) }
    }

    pub fn is_empty(&self) -> bool {
        self.min.cmpge(self.max).any()
    }

    /// Its longer edge, pixels.
    pub fn widest(&self) -> u32 {
        (self.max - self.min).max_element()
    }

    /// Its quarters, cut at multiples of `step` from its corner; some may be empty. Those of the usual step are kept.
    pub fn with_quarters(&self, camera: &CameraUniform, step: u32, mut then: impl FnMut(&[Self; 4])) {
        let cut = || Box::new(quarters(self.min, self.max, step).map(|(a, b)| Self::new(camera, a, b, step)));
        if step == self.step { then(self.quarters.get_or_init(cut)) } else { then(&cut()) }
    }

    /// Whether it may see anything around `center`, seen from `eye`, whose extent along a normal `support` tells, which
    /// is nowhere above `most`: asked only where that does not tell already.
    pub fn reaches(&self, eye: Vec3A, center: Vec3A, most: f32, support: impl Fn(Vec3A) -> f32) -> bool {
        let point = |i: usize| self.wedge.points.as_ref().map_or(eye, |points| eye + points[i]);
        let beyond = |(i, normal): (usize, &Vec3A)| {
            let inside = (center - point(i)).dot(*normal);
            inside < -most || (inside < 0.0 && inside + support(*normal) < 0.0)
        };
        let front = self.wedge.front.iter().map(|axis| (4, axis));
        self.wedge.everything || !self.wedge.planes.iter().enumerate().chain(front).any(beyond)
    }
}

/// A rectangle in four, at multiples of `step` from its corner; some may be empty.
fn quarters(min: UVec2, max: UVec2, step: u32) -> [(UVec2, UVec2); 4] {
    let size = max - min;
    let half = UVec2::new((size.x / 2).next_multiple_of(step), (size.y / 2).next_multiple_of(step));
    let middle = min + half.min(size);
    [
        (min, middle),
        (UVec2::new(middle.x, min.y), UVec2::new(max.x, middle.y)),
        (UVec2::new(min.x, middle.y), UVec2::new(middle.x, max.y)),
        (middle, max),
    ]
}

impl Wedge {
    fn new(camera: &CameraUniform, min: UVec2, max: UVec2) -> Self {
        let corners = [min, UVec2::new(max.x, min.y), max, UVec2::new(min.x, max.y)]
            .map(|corner| camera.ray(corner.as_vec2() / Vec2::from(camera.size)));
        let middle: Vec3A = corners.iter().map(|(_, direction)| *direction).sum();
        let parallel = camera.projection == CameraUniform::ORTHOGRAPHIC;
        let mut everything = false;
        let planes = std::array::from_fn(|i| {
            let (a, along) = corners[i];
            let (b, next) = corners[(i + 1) % 4];
            let normal = along.cross(if parallel { b - a } else { next });
            everything |= normal.length_squared() < 1e-14;
            let inward = normal * normal.dot(middle + (corners[(i + 2) % 4].0 - a)).signum();
            inward.normalize_or_zero()
        });
        // Equirectangular wedges bulge beyond their corner planes towards the poles.
        let curved = camera.projection == CameraUniform::EQUIRECTANGULAR;
        let planes = if curved {
            widen(planes, middle.normalize_or_zero(), max.saturating_sub(min), camera.size)
        } else {
            planes
        };
        let front = middle.try_normalize().filter(|_| !curved);
        // Of lines of sight that begin on a plane they don't cross at right angles, the hindmost.
        let starts = corners.map(|(start, _)| start);
        let axis = middle.normalize_or_zero();
        let hindmost = starts.into_iter().min_by(|a, b| a.dot(axis).total_cmp(&b.dot(axis)));
        let [a, b, c, d] = starts;
        let points = parallel.then(|| Box::new([a, b, c, d, hindmost.unwrap_or_default()]));
        Self { planes, front, everything, points }
    }
}

/// Tilts planes outwards by the angle that the tile spans: more than it can bulge.
fn widen(planes: [Vec3A; 4], axis: Vec3A, size: UVec2, picture: [f32; 2]) -> [Vec3A; 4] {
    let angle = std::f32::consts::PI * (size.x as f32 / picture[0] + size.y as f32 / picture[1]);
    planes.map(|normal| (normal + 0.5 * angle * axis).normalize_or_zero())
}
