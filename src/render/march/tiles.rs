//! Which parts of the picture a cloud can touch, and which ellipsoids each part can
//! see: quarters of the picture are split until they are small, and dropped as soon as
//! no ellipsoid reaches into them. No pixel outside the tiles is launched.

use glam::{UVec2, Vec2, Vec3, Vec3A};

use crate::frame::{
    CameraUniform,
    medium::{EllipsoidUniform, LayerShape},
};

const TILE: u32 = 16;
/// Quarters of a tile are tiles of their own where one of them is empty, and quarters of those.
const SMALL: u32 = TILE / 2;
/// Where a tile sees more ellipsoids than these, which its rays ask, it is cut down to [`SMALLEST`].
pub(in crate::render) const MANY: usize = 64;
const SMALLEST: u32 = 4;

/// `Tile` of `shaders/march.wgsl`.
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
    /// Covers the picture of `camera`, which is at `eye` in the cloud's frame. Tiles that see more than
    /// `many` ellipsoids are the smallest.
    pub fn new(camera: &CameraUniform, eye: Vec3, ellipsoids: &[EllipsoidUniform], many: usize) -> Self {
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
                    &View { camera, eye, ellipsoids, many },
                    corner,
                    (corner + start).min(size),
                    &all,
                );
            }
        }
        cover
    }

    /// Covers the picture where rays from `eye`, in the layer's frame, may meet a layer before the ground, over an
    /// earth of half the curvature `bend`, 1/m.
    pub(crate) fn of_layer(camera: &CameraUniform, eye: Vec3, layer: &LayerShape, bend: f32) -> Self {
        let mut cover = Self::default();
        let size = UVec2::new(camera.size[0] as u32, camera.size[1] as u32);
        for y in (0..size.y).step_by(TILE as usize) {
            for x in (0..size.x).step_by(TILE as usize) {
                let min = UVec2::new(x, y);
                let max = (min + TILE).min(size);
                if may_meet(camera, eye, layer, bend, min, max) {
                    cover.push(min, max, Vec::new());
                }
            }
        }
        cover
    }

    fn split(&mut self, view: &View<'_>, min: UVec2, max: UVec2, parents: &[u32]) {
        if min.cmpge(max).any() {
            return;
        }
        let near = view.seen(min, max, parents);
        if near.is_empty() {
            return;
        }
        let size = max - min;
        let widest = size.max_element();
        if widest > TILE || (widest > SMALLEST && near.len() > view.many) {
            for (a, b) in quarters(min, max, if widest > TILE { TILE } else { SMALLEST }) {
                self.split(view, a, b, &near);
            }
            return;
        }
        self.trim(view, min, max, near, SMALL);
    }

    /// Adds a tile, or its quarters where one of them is empty.
    fn trim(&mut self, view: &View<'_>, min: UVec2, max: UVec2, near: Vec<u32>, step: u32) {
        if near.is_empty() {
            return;
        }
        if step < SMALLEST {
            return self.push(min, max, near);
        }
        let smaller = quarters(min, max, step).map(|(a, b)| (a, b, view.seen(a, b, &near)));
        if smaller.iter().all(|(_, _, seen)| !seen.is_empty()) {
            self.push(min, max, near);
        } else {
            smaller.into_iter().for_each(|(a, b, seen)| self.trim(view, a, b, seen, step / 2));
        }
    }

    fn push(&mut self, min: UVec2, max: UVec2, near: Vec<u32>) {
        self.tiles.push(Tile {
            area: [min.x, min.y, max.x, max.y],
            first: self.candidates.len() as u32,
            count: near.len() as u32,
            padding: [0; 2],
        });
        self.candidates.extend(near);
    }
}

struct View<'a> {
    camera: &'a CameraUniform,
    eye: Vec3,
    ellipsoids: &'a [EllipsoidUniform],
    many: usize,
}

/// Whether a rectangle of the picture may see a layer. What it sees is bounded by horizons: of slopes, all above one
/// or all below it meet the layer, so that the steepest two of the rectangle tell.
fn may_meet(
    camera: &CameraUniform,
    eye: Vec3,
    layer: &LayerShape,
    bend: f32,
    min: UVec2,
    max: UVec2,
) -> bool {
    if camera.projection == CameraUniform::ORTHOGRAPHIC {
        return true;
    }
    let corners = [min, UVec2::new(max.x, min.y), max, UVec2::new(min.x, max.y)];
    let slopes = corners.map(|corner| camera.ray(corner.as_vec2() / Vec2::from(camera.size)).1.y);
    let wide = (max - min).max_element() as f32 * camera.pixel;
    let [low, high] =
        [slopes.into_iter().fold(1.0, f32::min) - wide, slopes.into_iter().fold(-1.0, f32::max) + wide];
    [low, high].into_iter().any(|slope| layer.is_met(eye.y, slope.clamp(-1.0, 1.0), bend))
}

/// Everything that a rectangle of the picture can see: inside four planes and in front.
struct Wedge {
    /// Inward normals with a point of each plane.
    planes: [(Vec3A, Vec3A); 4],
    front: Option<(Vec3A, Vec3A)>,
    everything: bool,
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

impl View<'_> {
    /// Those of `parents` that a rectangle of the picture may see; none where it is empty.
    fn seen(&self, min: UVec2, max: UVec2, parents: &[u32]) -> Vec<u32> {
        if min.cmpge(max).any() {
            return Vec::new();
        }
        let wedge = self.wedge(min, max);
        parents.iter().copied().filter(|&i| wedge.reaches(&self.ellipsoids[i as usize])).collect()
    }

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
        // Of lines of sight that begin on a plane they don't cross at right angles, the hindmost.
        let front = middle.try_normalize().map(|axis| {
            let start = corners
                .map(|(start, _)| start)
                .into_iter()
                .min_by(|a, b| a.dot(axis).total_cmp(&b.dot(axis)));
            (axis, eye + start.unwrap_or_default())
        });
        Wedge { planes, front: front.filter(|_| !curved), everything }
    }
}

/// Tilts planes outwards by the angle that the tile spans: more than it can bulge.
fn widen(planes: [(Vec3A, Vec3A); 4], axis: Vec3A, size: UVec2, picture: [f32; 2]) -> [(Vec3A, Vec3A); 4] {
    let angle = std::f32::consts::PI * (size.x as f32 / picture[0] + size.y as f32 / picture[1]);
    planes.map(|(normal, point)| ((normal + 0.5 * angle * axis).normalize_or_zero(), point))
}

impl Wedge {
    fn reaches(&self, e: &EllipsoidUniform) -> bool {
        let beyond = |&(normal, point): &(Vec3A, Vec3A)| {
            (Vec3A::from(e.center) - point).dot(normal) + e.support(normal.into()) < 0.0
        };
        self.everything || !(self.planes.iter().any(beyond) || self.front.iter().any(beyond))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Cloud, Ellipsoid, Projection};
    use glam::{DQuat, DVec3};

    fn ellipsoids() -> Vec<EllipsoidUniform> {
        let places = [[0.0, 0.0, 0.0], [150.0, 30.0, -40.0], [-220.0, -60.0, 90.0]];
        let cloud = Cloud::default();
        let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
        places
            .map(|center| {
                let mut e = Ellipsoid::new(center.into(), DVec3::new(90.0, 12.0, 40.0));
                e.orientation = turned;
                EllipsoidUniform::new(&cloud, &e, DVec3::ZERO, 10.0)
            })
            .to_vec()
    }

    fn hit(e: &EllipsoidUniform, (origin, direction): (Vec3A, Vec3A), eye: Vec3) -> bool {
        let to_unit = |v: Vec3| {
            Vec3::new(e.row_x.truncate().dot(v), e.row_y.truncate().dot(v), e.row_z.truncate().dot(v))
        };
        let (o, d) = (to_unit(eye + Vec3::from(origin) - e.center), to_unit(direction.into()));
        let t = -o.dot(d) / d.length_squared();
        let enters = (o + t * d).length() < 1.0;
        enters && (t > 0.0 || o.length() < 1.0)
    }

    #[test]
    fn every_ray_that_meets_an_ellipsoid_is_in_a_tile_that_lists_it() {
        let ellipsoids = ellipsoids();
        let projections = [
            Projection::Perspective { vertical_fov_deg: 40.0 },
            Projection::Perspective { vertical_fov_deg: 150.0 },
            Projection::Orthographic { height: 500.0 },
            Projection::Equirectangular,
        ];
        let eyes = [[0.0, 0.0, 600.0], [30.0, 5.0, 10.0], [-400.0, 300.0, -200.0], [0.0, 900.0, 0.1]];
        let size = [120u32, 68];
        for projection in projections {
            for eye in eyes.map(DVec3::from) {
                let camera = Camera { position: eye, target: DVec3::ZERO, roll_deg: 20.0, projection };
                let camera = CameraUniform::new(&camera, 0.0, size);
                assert_covered(&camera, eye.as_vec3(), &ellipsoids, &format!("{projection:?} from {eye}"));
            }
        }
    }

    #[test]
    fn rays_of_a_shifted_lens_are_in_tiles_too() {
        for eye in [[0.0, 0.0, 600.0], [30.0, 5.0, 10.0], [-400.0, 300.0, -200.0]].map(DVec3::from) {
            let camera = Camera {
                position: eye,
                target: DVec3::ZERO,
                roll_deg: 20.0,
                projection: Projection::default(),
            };
            for projection in [CameraUniform::PERSPECTIVE, CameraUniform::ORTHOGRAPHIC] {
                for shift in [Vec2::new(-1.0, 1.0), Vec2::new(3.0, 0.4), Vec2::new(0.0, -6.0)] {
                    let mut camera = CameraUniform::new(&camera, 0.0, [120, 68]);
                    camera.forward += shift.x * camera.right + shift.y * camera.up;
                    camera.projection = projection;
                    if projection == CameraUniform::ORTHOGRAPHIC {
                        camera.forward = camera.forward.normalize();
                        (camera.right, camera.up) = (400.0 * camera.right, 400.0 * camera.up);
                    }
                    let said = format!("{projection} shifted by {shift} from {eye}");
                    assert_covered(&camera, eye.as_vec3(), &ellipsoids(), &said);
                }
            }
        }
    }

    /// Each pixel is in one tile at most, which lists what its ray meets.
    fn assert_covered(camera: &CameraUniform, eye: Vec3, ellipsoids: &[EllipsoidUniform], said: &str) {
        let size = camera.size.map(|n| n as u32);
        let cover = Cover::new(camera, eye, ellipsoids, MANY);
        for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
            let uv = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::from(camera.size);
            let ray = camera.ray(uv);
            let owners: Vec<_> = cover.tiles.iter().filter(|tile| contains(tile, x, y)).collect();
            assert!(owners.len() <= 1, "pixel {x} {y} is launched twice");
            for (i, e) in ellipsoids.iter().enumerate() {
                let listed = owners.iter().any(|tile| list(&cover, tile).contains(&(i as u32)));
                assert!(listed || !hit(e, ray, eye), "{said}: {x} {y} misses {i}");
            }
        }
    }

    #[test]
    fn tiles_are_few_where_the_cloud_is_small() {
        let eye = DVec3::new(0.0, 0.0, 20_000.0);
        let camera =
            Camera { position: eye, target: DVec3::ZERO, roll_deg: 0.0, projection: Projection::default() };
        let camera = CameraUniform::new(&camera, 0.0, [1920, 1080]);
        let cover = Cover::new(&camera, eye.as_vec3(), &ellipsoids(), MANY);
        let pixels: u32 = cover.tiles.iter().map(|t| (t.area[2] - t.area[0]) * (t.area[3] - t.area[1])).sum();
        assert!((100..8000).contains(&pixels), "{pixels} of two million");
    }

    fn contains(tile: &Tile, x: u32, y: u32) -> bool {
        (tile.area[0]..tile.area[2]).contains(&x) && (tile.area[1]..tile.area[3]).contains(&y)
    }

    fn list<'a>(cover: &'a Cover, tile: &Tile) -> &'a [u32] {
        &cover.candidates[tile.first as usize..][..tile.count as usize]
    }
}
