//! Which clouds may cast a shadow on which: found for all clouds at once by sweeping over them
//! across the light, so that a thousand clouds need no million comparisons.

use glam::DVec3;

use super::moment::Clouds;
use crate::frame::{CloudFrame, Frame};

/// Which clouds stand before each cloud of a frame, as it was last asked for.
#[derive(Default)]
pub(in crate::render) struct Occluders {
    clouds: Clouds,
    to_sun: DVec3,
    lists: Vec<Vec<u32>>,
}

impl Occluders {
    /// Those of `frame` in the light of its sun: found anew where clouds or sun have moved.
    pub fn find(&mut self, frame: &Frame) {
        if self.to_sun != frame.sun.to_sun || !self.clouds.are_of(frame) {
            self.clouds = Clouds::of(frame);
            self.to_sun = frame.sun.to_sun;
            self.lists = occluders(&frame.clouds, -self.to_sun);
        }
    }

    /// Nothing shades anything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Numbers of the clouds that stand before each, in order; no lists where nothing shades anything.
    pub fn lists(&self) -> &[Vec<u32>] {
        &self.lists
    }
}

/// What is added to a cloud's half-extents: its maps are a little wider than it.
const MARGIN: f64 = 1.25;

/// Extents of a cloud's box along an axis: low and high.
fn extent(cloud: &CloudFrame, axis: DVec3) -> [f64; 2] {
    let (middle, half) = (cloud.origin.dot(axis), MARGIN * cloud.half.dot(axis.abs()));
    [middle - half, middle + half]
}

fn overlap(a: [f64; 2], b: [f64; 2]) -> bool {
    a[0] <= b[1] && b[0] <= a[1]
}

/// For each cloud those others, in order, whose boxes may overlap it as seen along the light
/// that goes along `along`, and that do not lie wholly behind it: never one too few. Layers, which have no end, stand
/// before all that is behind them in height; what shades them is in maps
/// ([`crate::render::shadow`]).
fn occluders(clouds: &[CloudFrame], along: DVec3) -> Vec<Vec<u32>> {
    let (across, aside) = along.any_orthonormal_pair();
    let ranges: Vec<_> =
        clouds.iter().map(|cloud| [across, aside, along].map(|axis| extent(cloud, axis))).collect();
    let mut order: Vec<usize> = (0..clouds.len()).collect();
    order.sort_by(|&a, &b| ranges[a][0][0].total_cmp(&ranges[b][0][0]));
    let mut found = vec![Vec::new(); clouds.len()];
    for (place, &a) in order.iter().enumerate() {
        for &b in order[place + 1..].iter().take_while(|&&b| ranges[b][0][0] <= ranges[a][0][1]) {
            let end = [a, b].iter().all(|&i| clouds[i].medium.layer.is_none());
            if end && overlap(ranges[a][1], ranges[b][1]) {
                for (shaded, shading) in [(a, b), (b, a)] {
                    if ranges[shading][2][0] <= ranges[shaded][2][1] {
                        found[shaded].push(shading as u32);
                    }
                }
            }
        }
    }
    for (layer, cloud) in clouds.iter().enumerate().filter(|(_, cloud)| cloud.medium.layer.is_some()) {
        for (shaded, list) in found.iter_mut().enumerate() {
            if clouds[shaded].medium.layer.is_none() && begins_before(cloud, &clouds[shaded], along) {
                list.push(layer as u32);
            }
        }
    }
    for list in &mut found {
        list.sort_unstable();
    }
    found
}

/// Whether some of what has this `cloud`'s heights lies before the end of the `other`, upright.
pub(in crate::render) fn begins_before(cloud: &CloudFrame, other: &CloudFrame, along: DVec3) -> bool {
    let way = along.y.signum();
    let [own, others] = [cloud, other].map(|cloud| way * cloud.origin.y);
    own - cloud.half.y < others + other.half.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{render::Frame, scene::Preset};

    #[test]
    fn every_cloud_that_may_shade_another_is_found_and_few_others() {
        let mut scene = Preset::Sphere.scene(1);
        let first = scene.clouds[0].clone();
        scene.clouds = (0..100u32)
            .map(|i| {
                let (x, z) = (f64::from(i % 10), f64::from(i / 10));
                let mut cloud = first.clone();
                for ellipsoid in &mut cloud.ellipsoids {
                    ellipsoid.center += DVec3::new(700.0 * x, 100.0 * f64::from(i % 7), 700.0 * z);
                }
                cloud
            })
            .collect();
        let frame = Frame::new(&scene, [8, 8]).unwrap();
        for along in [DVec3::NEG_Y, DVec3::new(0.8, -0.6, 0.0), DVec3::new(0.36, -0.48, 0.8)] {
            let found = occluders(&frame.clouds, along);
            let (u, v) = along.any_orthonormal_pair();
            let mut pairs = 0;
            for (i, a) in frame.clouds.iter().enumerate() {
                for (j, b) in frame.clouds.iter().enumerate().filter(|(j, _)| *j != i) {
                    let apart = b.origin - a.origin;
                    let reach = a.half.length() + b.half.length();
                    let listed = found[i].contains(&(j as u32));
                    let meets = [u, v].iter().all(|axis| {
                        let half = a.half + b.half;
                        apart.dot(*axis).abs() < half.dot(axis.abs())
                    }) && apart.dot(along) < (a.half + b.half).dot(along.abs());
                    assert!(listed || !meets, "{j} shades {i}");
                    let far = (apart - apart.dot(along) * along).length() > 3.0 * reach;
                    assert!(!(listed && far), "{j} is nowhere near the beam of {i}");
                    pairs += usize::from(listed);
                }
            }
            assert!(pairs < 100 * 25, "{pairs}");
        }
    }
}
