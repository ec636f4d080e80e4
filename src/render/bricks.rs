//! Lists of the ellipsoids that reach into each brick of a light box, so that a sample asks only
//! those at hand however many a cloud has; and of those of other clouds that may stand between
//! the sun and each tile of its top.

use glam::{UVec3, Vec3};

use super::{ellipsoids::EllipsoidUniform, light_box::LightBox};

/// Edge of a brick, voxels: that of `shaders/lib/light_box.wgsl`.
pub(super) const BRICK: u32 = 8;
/// Rounding of coordinates, voxels.
const SLACK: f32 = 0.02;

/// Lists by brick, x fastest, and by tile after them: where each begins in `candidates`, and its length.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Bricks {
    pub lists: Vec<[u32; 2]>,
    pub candidates: Vec<u32>,
}

/// Bricks that an ellipsoid may reach, from the first to before the last.
type Reach = (UVec3, UVec3);

impl Bricks {
    /// Lists for a box of `voxels`; the first `light_box.own` of the ellipsoids are the cloud's own.
    pub fn new(light_box: &LightBox, ellipsoids: &[EllipsoidUniform], voxels: [u32; 3]) -> Self {
        let size = UVec3::from(voxels);
        let bricks = size.map(|n| n.div_ceil(BRICK));
        let tiles = bricks.with_z(1);
        let reaches: Vec<_> = ellipsoids.iter().map(|e| reach(light_box, e, size, bricks)).collect();
        let others = (0..ellipsoids.len()).skip(light_box.own as usize);
        let before = others.filter(|&i| starts_before(light_box, &ellipsoids[i]));
        let mut placed: Vec<(u32, u32)> = Vec::new();
        for (i, &reach) in reaches.iter().enumerate() {
            placed.extend(places(reach, bricks).map(|place| (place, i as u32)));
        }
        let first_tile = bricks.element_product();
        for i in before {
            let (low, high) = reaches[i];
            let reach = (low.with_z(0), high.with_z(1));
            placed.extend(places(reach, tiles).map(|place| (first_tile + place, i as u32)));
        }
        Self::sorted(placed, (first_tile + tiles.element_product()) as usize)
    }

    /// Lists in order from pairs of list and entry.
    fn sorted(mut placed: Vec<(u32, u32)>, count: usize) -> Self {
        placed.sort_unstable();
        let mut lists = vec![[0; 2]; count];
        for (at, &(place, _)) in placed.iter().enumerate() {
            let list = &mut lists[place as usize];
            if list[1] == 0 {
                list[0] = at as u32;
            }
            list[1] += 1;
        }
        Self { lists, candidates: placed.into_iter().map(|(_, ellipsoid)| ellipsoid).collect() }
    }
}

fn places((low, high): Reach, size: UVec3) -> impl Iterator<Item = u32> {
    (low.z..high.z).flat_map(move |z| {
        (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| (z * size.y + y) * size.x + x))
    })
}

fn reach(light_box: &LightBox, e: &EllipsoidUniform, size: UVec3, bricks: UVec3) -> Reach {
    let rows = [light_box.row_u, light_box.row_v, light_box.row_w];
    let middle = Vec3::from(rows.map(|row| row.dot(e.center - light_box.corner))) * size.as_vec3();
    let half = Vec3::from(rows.map(|row| e.support(row))) * size.as_vec3() + SLACK;
    let brick = |voxel: Vec3| (voxel / BRICK as f32).floor();
    let low = brick(middle - half).max(Vec3::ZERO).as_uvec3();
    let high = (brick(middle + half) + 1.0).max(Vec3::ZERO).as_uvec3();
    (low.min(bricks), high.min(bricks))
}

fn starts_before(light_box: &LightBox, e: &EllipsoidUniform) -> bool {
    light_box.row_w.dot(e.center - light_box.corner) - e.support(light_box.row_w) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cloud, Ellipsoid};
    use glam::{DQuat, DVec3};

    #[test]
    fn every_point_of_an_ellipsoid_is_in_a_brick_that_lists_it() {
        let cloud = Cloud::default();
        let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
        let radii = DVec3::new(90.0, 8.0, 40.0);
        let ellipsoids: Vec<_> = [[0.0, 0.0, 0.0], [150.0, 30.0, -40.0], [40.0, 400.0, 0.0]]
            .map(|center| {
                let e = Ellipsoid { orientation: turned, ..Ellipsoid::new(center.into(), radii) };
                EllipsoidUniform::new(&cloud, &e, DVec3::ZERO)
            })
            .to_vec();
        let along = Vec3::new(0.48, -0.8, 0.36);
        let (light_box, ellipsoids) = LightBox::new(&ellipsoids[..2], &ellipsoids[2..], along, 32);
        let voxels = light_box.voxels(32);
        let bricks = Bricks::new(&light_box, &ellipsoids, voxels);
        let size = UVec3::from(voxels);
        let across = size.map(|n| n.div_ceil(BRICK));
        let mut listed_somewhere = 0;
        for i in 0..2000u32 {
            // A spiral through each ellipsoid's inside.
            let t = (f64::from(i) + 0.5) / 2000.0;
            let (z, a) = (1.0 - 2.0 * t, 2.399963 * f64::from(i));
            let u = 0.999 * DVec3::new((1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z);
            for (which, e) in ellipsoids.iter().enumerate() {
                let p = e.center + (turned * (u * radii)).as_vec3() - light_box.corner;
                let uvw = Vec3::new(light_box.row_u.dot(p), light_box.row_v.dot(p), light_box.row_w.dot(p));
                if uvw.cmplt(Vec3::ZERO).any() || uvw.cmpge(Vec3::ONE).any() {
                    assert!(which >= 2, "the box holds its own cloud");
                    continue;
                }
                let brick = (uvw * size.as_vec3()).as_uvec3() / BRICK;
                let [first, count] =
                    bricks.lists[((brick.z * across.y + brick.y) * across.x + brick.x) as usize];
                let list = &bricks.candidates[first as usize..][..count as usize];
                assert!(list.contains(&(which as u32)), "{p} of {which}");
                listed_somewhere += 1;
            }
        }
        assert!(listed_somewhere >= 4000);
    }
}
