//! Which parts of the picture a cloud can touch, and which ellipsoids each part can
//! see: quarters of the picture are split until they are small, and dropped as soon as
//! no ellipsoid reaches into them. No pixel outside the tiles is launched.

use glam::{UVec2, Vec2, Vec3, Vec3A};

use super::{camera::CameraUniform, ellipsoids::EllipsoidUniform};

const TILE: u32 = 16;

/// `Tile` of `shaders/clouds.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Tile {
    pub(crate) area: [u32; 4],
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) padding: [u32; 2],
}

/// The tiles of one cloud and their lists of ellipsoids.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Cover {
    pub(crate) tiles: Vec<Tile>,
    pub(crate) candidates: Vec<u32>,
}

impl Cover {
    /// Covers the picture of `camera`, which is at `eye` in the cloud's frame. The lists
    /// also name ellipsoids up to `margin` metres away from a tile's rays, which samples
    /// towards the sun can meet.
    pub fn new(camera: &CameraUniform, eye: Vec3, ellipsoids: &[EllipsoidUniform], margin: f32) -> Self {
        let mut cover = Self::default();
        let size = UVec2::new(camera.size[0] as u32, camera.size[1] as u32);
        // A wedge between four planes bounds a part of an equirectangular picture only
        // where it is much narrower than a half-turn.
        let start = if camera.projection == CameraUniform::EQUIRECTANGULAR { size / 16 + 1 } else { size };
        let all: Vec<u32> = (0..ellipsoids.len() as u32).collect();
        for y in (0..size.y).step_by(start.y as usize) {
            for x in (0..size.x).step_by(start.x as usize) {
                let corner = UVec2::new(x, y);
                cover.split(
                    &View { camera, eye, ellipsoids, margin },
                    corner,
                    (corner + start).min(size),
                    &all,
                );
            }
        }
        cover
    }

    fn split(&mut self, view: &View<'_>, min: UVec2, max: UVec2, parents: &[u32]) {
        if min.cmpge(max).any() {
            return;
        }
        let wedge = view.wedge(min, max);
        let near: Vec<u32> = parents
            .iter()
            .copied()
            .filter(|&i| wedge.reaches(&view.ellipsoids[i as usize], view.margin))
            .collect();
        if !near.iter().any(|&i| wedge.reaches(&view.ellipsoids[i as usize], 0.0)) {
            return;
        }
        let size = max - min;
        if size.max_element() <= TILE {
            self.tiles.push(Tile {
                area: [min.x, min.y, max.x, max.y],
                first: self.candidates.len() as u32,
                count: near.len() as u32,
                padding: [0; 2],
            });
            self.candidates.extend(near);
            return;
        }
        let half = UVec2::new((size.x / 2).next_multiple_of(TILE), (size.y / 2).next_multiple_of(TILE));
        let middle = min + half.min(size);
        for (a, b) in [
            (min, middle),
            (UVec2::new(middle.x, min.y), UVec2::new(max.x, middle.y)),
            (UVec2::new(min.x, middle.y), UVec2::new(middle.x, max.y)),
            (middle, max),
        ] {
            self.split(view, a, b, &near);
        }
    }
}

struct View<'a> {
    camera: &'a CameraUniform,
    eye: Vec3,
    ellipsoids: &'a [EllipsoidUniform],
    margin: f32,
}

/// Everything that a rectangle of the picture can see: inside four planes and in front.
struct Wedge {
    /// Inward normals with a point of each plane.
    planes: [(Vec3A, Vec3A); 4],
    front: Option<(Vec3A, Vec3A)>,
    everything: bool,
}

impl View<'_> {
    fn wedge(&self, min: UVec2, max: UVec2) -> Wedge {
        let corners = [min, UVec2::new(max.x, min.y), max, UVec2::new(min.x, max.y)]
            .map(|corner| self.camera.ray(corner.as_vec2() / Vec2::from(self.camera.size)));
        let eye = Vec3A::from(self.eye);
        let middle: Vec3A = corners.iter().map(|(_, direction)| *direction).sum();
        let mut everything = false;
        let planes = std::array::from_fn(|i| {
            let (a, along) = corners[i];
            let (b, next) = corners[(i + 1) % 4];
            let side = if self.camera.projection == CameraUniform::ORTHOGRAPHIC { b - a } else { next };
            let normal = along.cross(side);
            everything |= normal.length_squared() < 1e-14;
            let inward = normal * normal.dot(middle + (corners[(i + 2) % 4].0 - a)).signum();
            (inward.normalize_or_zero(), eye + a)
        });
        // Equirectangular wedges bulge beyond their corner planes towards the poles.
        let curved = self.camera.projection == CameraUniform::EQUIRECTANGULAR;
        let planes = if curved {
            widen(planes, middle.normalize_or_zero(), max - min, self.camera.size)
        } else {
            planes
        };
        let front = middle.try_normalize().map(|axis| (axis, eye));
        Wedge { planes, front: front.filter(|_| !curved), everything }
    }
}

/// Tilts planes outwards by the angle that the tile spans: more than it can bulge.
fn widen(planes: [(Vec3A, Vec3A); 4], axis: Vec3A, size: UVec2, picture: [f32; 2]) -> [(Vec3A, Vec3A); 4] {
    let angle = std::f32::consts::PI * (size.x as f32 / picture[0] + size.y as f32 / picture[1]);
    planes.map(|(normal, point)| ((normal + 0.5 * angle * axis).normalize_or_zero(), point))
}

impl Wedge {
    fn reaches(&self, e: &EllipsoidUniform, margin: f32) -> bool {
        let beyond = |&(normal, point): &(Vec3A, Vec3A)| {
            (Vec3A::from(e.center) - point).dot(normal) + e.support(normal.into()) + margin < 0.0
        };
        self.everything || !(self.planes.iter().any(beyond) || self.front.iter().any(beyond))
    }
}
