//! Lists of the ellipsoids that reach into each brick of a light box, so that a sample asks only
//! those at hand however many a cloud has.

use glam::{UVec3, Vec3};

use super::boxes::LightBox;
use crate::frame::medium::{EllipsoidUniform, Medium};

/// Edge of a brick, voxels: that of `shaders/lib/light_box.wgsl`.
pub(crate) const BRICK: u32 = 8;
/// Rounding of coordinates, voxels.
const SLACK: f32 = 0.02;

/// Lists, each a place in `candidates` and a length.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Bricks {
    pub lists: Vec<[u32; 2]>,
    pub candidates: Vec<u32>,
}

/// Bricks that an ellipsoid may reach, from the first to before the last.
type Reach = (UVec3, UVec3);

impl Bricks {
    /// Lists of what is of a medium in each brick of a box of `voxels`, x fastest: a layer is everywhere.
    pub fn of(light_box: &LightBox, medium: &Medium, voxels: [u32; 3]) -> Self {
        if medium.layer.is_none() {
            return Self::new(light_box, &medium.ellipsoids, voxels);
        }
        let (_, bricks) = sizes(voxels);
        Self { lists: vec![[0, 1]; bricks.element_product() as usize], candidates: vec![0] }
    }

    /// Lists by brick of a box of `voxels`, x fastest.
    fn new(light_box: &LightBox, ellipsoids: &[EllipsoidUniform], voxels: [u32; 3]) -> Self {
        let (size, bricks) = sizes(voxels);
        let placed = (0..).zip(ellipsoids).flat_map(|(i, e)| {
            places(reach(light_box, e, size, bricks), bricks).map(move |place| (place, i))
        });
        Self::sorted(placed.collect(), bricks.element_product())
    }

    /// Lists in order from pairs of list and entry.
    fn sorted(mut placed: Vec<(u32, u32)>, count: u32) -> Self {
        placed.sort_unstable();
        let mut lists = vec![[0; 2]; count as usize];
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

/// Voxels and bricks along each axis.
fn sizes(voxels: [u32; 3]) -> (UVec3, UVec3) {
    let size = UVec3::from(voxels);
    (size, size.map(|n| n.div_ceil(BRICK)))
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
                EllipsoidUniform::new(&cloud, &e, DVec3::ZERO, 10.0)
            })
            .to_vec();
        let along = Vec3::new(0.48, -0.8, 0.36);
        let light_box = LightBox::new(&ellipsoids[..2], along, 32);
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
