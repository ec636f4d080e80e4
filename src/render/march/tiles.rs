//! Which parts of the picture a cloud can touch, and which ellipsoids each part can
//! see: quarters of the picture are split until they are small, and dropped as soon as
//! no ellipsoid reaches into them. No pixel outside the tiles is launched.

use std::ops::Range;

use glam::{UVec2, Vec2, Vec3, Vec3A};

use super::parts::{Part, Parts, SMALL, SMALLEST, TILE};
use crate::frame::{
    CameraUniform,
    medium::{EllipsoidUniform, LayerShape},
};

/// Where a tile sees more ellipsoids than these, which its rays ask, it is cut down to [`SMALLEST`].
pub(in crate::render) const MANY: usize = 64;

/// Any distance, m.
const ANY: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

/// `Tile` of `shaders/march.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Tile {
    pub(crate) area: [u32; 4],
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) block: u32,
    pub(crate) others: u32,
}

/// The tiles of one cloud and their lists of ellipsoids.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cover {
    pub(crate) tiles: Vec<Tile>,
    pub(crate) candidates: Vec<u32>,
    /// Nearest and farthest distance of what each tile may meet, m, where the cloud may cross others.
    pub(in crate::render) depths: Vec<[f32; 2]>,
}

/// What a picture is covered with: a cloud whose frame has the eye at `eye`.
pub(in crate::render) struct Seen<'a> {
    pub eye: Vec3,
    pub ellipsoids: &'a [EllipsoidUniform],
    /// Half the extent of a box around its frame's origin that holds them all, m, where one is known.
    pub half: Option<Vec3>,
    /// Tiles that see more ellipsoids than these are the smallest.
    pub many: usize,
}

impl Cover {
    /// Covers the picture that has these `parts`.
    pub fn new(parts: &Parts, seen: &Seen<'_>) -> Self {
        let mut cover = Self::default();
        let mut near: Vec<u32> = (0..seen.ellipsoids.len() as u32).collect();
        let all = 0..near.len();
        let half = seen.half.map(|half| widened(half, seen.eye));
        let most = seen.ellipsoids.iter().map(|e| 1.001 * e.largest_radius()).collect();
        let view = View { camera: &parts.camera, seen, half, most };
        for root in &parts.roots {
            cover.split(&view, root, &mut near, all.clone());
        }
        cover
    }

    /// Covers the picture where rays from `eye`, in the layer's frame, may meet a layer before the ground, over an
    /// earth of half the curvature `bend`, 1/m.
    pub(crate) fn of_layer(camera: &CameraUniform, eye: Vec3, layer: &LayerShape, bend: f32) -> Self {
        let view = LayerView { camera, eye, layer, bend };
        let mut cover = Self::default();
        let size = UVec2::new(camera.size[0] as u32, camera.size[1] as u32);
        for y in (0..size.y).step_by(TILE as usize) {
            for x in (0..size.x).step_by(TILE as usize) {
                let min = UVec2::new(x, y);
                let max = (min + TILE).min(size);
                if view.may_meet(min, max) {
                    cover.push(min, max, &[]);
                }
            }
        }
        cover
    }

    /// Adds what of `part` sees any of the `parents`, a range of the lists in `near`.
    fn split(&mut self, view: &View<'_>, part: &Part, near: &mut Vec<u32>, parents: Range<usize>) {
        let seen = view.seen(part, near, parents);
        if !seen.is_empty() {
            let widest = part.widest();
            if widest > TILE || (widest > SMALLEST && seen.len() > view.seen.many) {
                let step = if widest > TILE { TILE } else { SMALLEST };
                part.with_quarters(view.camera, step, |quarters| {
                    for quarter in quarters {
                        self.split(view, quarter, near, seen.clone());
                    }
                });
            } else {
                self.trim(view, part, near, seen.clone(), SMALL);
            }
        }
        near.truncate(seen.start);
    }

    /// Adds a tile that sees `seen`, or its quarters where one of them is empty.
    fn trim(&mut self, view: &View<'_>, part: &Part, near: &mut Vec<u32>, seen: Range<usize>, step: u32) {
        if seen.is_empty() {
            return;
        }
        if step < SMALLEST {
            return self.push(part.min, part.max, &near[seen]);
        }
        let length = near.len();
        part.with_quarters(view.camera, step, |quarters| {
            let lists = quarters.each_ref().map(|quarter| view.seen(quarter, near, seen.clone()));
            if lists.iter().all(|list| !list.is_empty()) {
                self.push(part.min, part.max, &near[seen.clone()]);
            } else {
                for (quarter, list) in quarters.iter().zip(lists) {
                    self.trim(view, quarter, near, list, step / 2);
                }
            }
        });
        near.truncate(length);
    }

    /// Finds the distances of what its tiles list, in the picture of `camera`.
    pub fn measure(&mut self, camera: &CameraUniform, seen: &Seen<'_>) {
        let distance = |e: &EllipsoidUniform| match camera.projection {
            CameraUniform::ORTHOGRAPHIC => (e.center - seen.eye).dot(camera.forward),
            _ => e.center.distance(seen.eye),
        };
        // Lines of sight that begin on a plane that they don't cross at right angles begin at many distances.
        let skewed =
            camera.projection == CameraUniform::ORTHOGRAPHIC && camera.forward.dot(camera.axis) < 0.9999;
        let span = |tile: &Tile| {
            let listed = &self.candidates[tile.first as usize..][..tile.count as usize];
            let ends = listed.iter().map(|&index| {
                let e = &seen.ellipsoids[index as usize];
                let (middle, radius) = (distance(e), 1.001 * e.largest_radius());
                [middle - radius, middle + radius]
            });
            let all = ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
            all.filter(|_| !skewed).unwrap_or(ANY)
        };
        self.depths = self.tiles.iter().map(span).collect();
    }

    /// Finds the distances of what its tiles see of a layer, as [`Cover::of_layer`] has it.
    pub fn measure_layer(&mut self, camera: &CameraUniform, eye: Vec3, layer: &LayerShape, bend: f32) {
        let view = LayerView { camera, eye, layer, bend };
        let span = |tile: &Tile| {
            let [left, top, right, bottom] = tile.area;
            view.depths(UVec2::new(left, top), UVec2::new(right, bottom))
        };
        self.depths = self.tiles.iter().map(span).collect();
    }

    fn push(&mut self, min: UVec2, max: UVec2, near: &[u32]) {
        self.tiles.push(Tile {
            area: [min.x, min.y, max.x, max.y],
            first: self.candidates.len() as u32,
            count: near.len() as u32,
            block: 0,
            others: 0,
        });
        self.candidates.extend_from_slice(near);
    }
}

struct View<'a> {
    camera: &'a CameraUniform,
    seen: &'a Seen<'a>,
    half: Option<Vec3A>,
    /// No ellipsoid reaches farther from its middle, m.
    most: Vec<f32>,
}

/// A box so much larger that no rounding of places as far from the eye puts an ellipsoid of it outside.
fn widened(half: Vec3, eye: Vec3) -> Vec3A {
    Vec3A::from(1.0001 * half) + 1e-3 + 4e-6 * eye.length()
}

impl View<'_> {
    /// Those of `parents` that a part of the picture may see, at the end of `near`; none where it is empty.
    fn seen(&self, part: &Part, near: &mut Vec<u32>, parents: Range<usize>) -> Range<usize> {
        let first = near.len();
        let eye = Vec3A::from(self.seen.eye);
        let in_box = |half: Vec3A| {
            part.reaches(eye, Vec3A::ZERO, 1.001 * half.length(), |normal| half.dot(normal.abs()))
        };
        if !part.is_empty() && self.half.is_none_or(in_box) {
            for place in parents {
                let index = near[place];
                let e = &self.seen.ellipsoids[index as usize];
                let most = self.most[index as usize];
                if part.reaches(eye, e.center.into(), most, |normal| e.support(normal.into())) {
                    near.push(index);
                }
            }
        }
        first..near.len()
    }
}

/// A layer as a picture sees it, over an earth of half the curvature `bend`, 1/m.
struct LayerView<'a> {
    camera: &'a CameraUniform,
    eye: Vec3,
    layer: &'a LayerShape,
    bend: f32,
}

impl LayerView<'_> {
    /// Where the steepest lines of sight of a rectangle of the picture meet the layer, m. What a rectangle sees is bounded by
    /// horizons: of slopes, all above one or all below it meet the layer, so that the steepest two tell. None for parallel
    /// lines of sight.
    fn met(&self, min: UVec2, max: UVec2) -> Option<[Option<[f32; 2]>; 2]> {
        let Self { camera, eye, layer, bend } = self;
        let parallel = camera.projection == CameraUniform::ORTHOGRAPHIC;
        (!parallel).then(|| slopes(camera, min, max).map(|slope| layer.met(eye.y, slope, *bend)))
    }

    /// Whether a rectangle may see the layer.
    fn may_meet(&self, min: UVec2, max: UVec2) -> bool {
        self.met(min, max).is_none_or(|met| met.iter().any(Option::is_some))
    }

    /// Nearest and farthest distance at which a rectangle may see it, m: any, where not all of it does.
    fn depths(&self, min: UVec2, max: UVec2) -> [f32; 2] {
        match self.met(min, max) {
            Some([Some([a, b]), Some([c, d])]) => [a.min(c), b.max(d)],
            _ => ANY,
        }
    }
}

/// Least and largest slope of what a rectangle of the picture sees, m of height each m of the way.
fn slopes(camera: &CameraUniform, min: UVec2, max: UVec2) -> [f32; 2] {
    let corners = [min, UVec2::new(max.x, min.y), max, UVec2::new(min.x, max.y)];
    let slopes = corners.map(|corner| camera.ray(corner.as_vec2() / Vec2::from(camera.size)).1.y);
    let wide = (max - min).max_element() as f32 * camera.pixel;
    let ends =
        [slopes.into_iter().fold(1.0, f32::min) - wide, slopes.into_iter().fold(-1.0, f32::max) + wide];
    ends.map(|slope| slope.clamp(-1.0, 1.0))
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

    fn covered(camera: &CameraUniform, eye: Vec3, ellipsoids: &[EllipsoidUniform]) -> Cover {
        let (low, high) = EllipsoidUniform::bounds(ellipsoids);
        let parts = Parts::new(camera);
        let cover = |half| Cover::new(&parts, &Seen { eye, ellipsoids, half, many: MANY });
        let known = cover(Some(low.abs().max(high)));
        assert_eq!(known, cover(None), "a box that holds all takes nothing away");
        known
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
                let camera = Camera {
                    position: eye,
                    target: DVec3::ZERO,
                    roll_deg: 20.0,
                    projection,
                    ..Camera::default()
                };
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
                ..Camera::default()
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
        let cover = covered(camera, eye, ellipsoids);
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
        let camera = Camera {
            position: eye,
            target: DVec3::ZERO,
            roll_deg: 0.0,
            projection: Projection::default(),
            ..Camera::default()
        };
        let camera = CameraUniform::new(&camera, 0.0, [1920, 1080]);
        let cover = covered(&camera, eye.as_vec3(), &ellipsoids());
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
