//! How fine the light of each cloud is. Clouds of a scene have voxels of about one size; where
//! that would take more memory than [`FULL_CLOUDS`] of the largest do, clouds that are small in
//! the picture get coarser light, and clouds outside of it none.

use crate::{
    frame::{CameraUniform, CloudFrame},
    render::Quality,
};
use glam::DVec3;

/// All light together takes no more memory than that of so many clouds of the largest kind, on
/// top of the coarsest light of each cloud in the picture.
const FULL_CLOUDS: u64 = 36;
/// Coarsest light.
const LEAST_RESOLUTION: u32 = 16;
const LEAST_CELLS: u32 = 8;
/// Finest: radiance by direction takes 48 MiB on it.
const MOST_CELLS: u32 = 64;
/// From one allowance of voxels a pixel to the next smaller one that is tried.
const FINER: f64 = 0.8;
/// Bytes of a texel.
const TEXEL: u64 = 8;

/// Texels across a cloud's sun maps and volume, and cells along the longest axis of the grid that
/// light is solved for on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) struct Detail {
    pub resolution: u32,
    pub cells: u32,
}

impl Detail {
    /// Of a cloud out of view whose shadow may be in it.
    pub const SHADOW: Self = Self { resolution: 32, cells: 0 };

    /// What the light of a cube takes, bytes; that of any other cloud at most twice that.
    pub fn bytes(self) -> u64 {
        let [resolution, cells] = [self.resolution, self.cells].map(u64::from);
        let maps = 2 * resolution * resolution * 4 / 3;
        // Moments as half floats, and what goes to the eye; three colours of the sky on half the cells.
        let solved = cells.pow(3) * (4 * 11 + 9) / 8;
        TEXEL * (resolution.pow(3) + maps + solved)
    }

    /// The finest light of `quality` for a cloud as large as this share of the largest.
    fn full(quality: &Quality, share: f64) -> Self {
        let most = quality.light_resolution.max(LEAST_RESOLUTION);
        let wanted = (share * f64::from(quality.light_resolution)) as u32;
        let most_cells = quality.light_cells.clamp(LEAST_CELLS, MOST_CELLS);
        Self {
            resolution: wanted.next_power_of_two().clamp(LEAST_RESOLUTION, most),
            cells: ((share * f64::from(most_cells)).ceil() as u32).clamp(LEAST_CELLS, most_cells),
        }
    }

    /// The same, but no finer than `texels` across the cloud.
    fn at_most(self, texels: f64) -> Self {
        let mut detail = self;
        while detail.resolution > LEAST_RESOLUTION && f64::from(detail.resolution) > texels {
            detail.resolution /= 2;
        }
        let share = f64::from(detail.resolution) / f64::from(self.resolution);
        detail.cells = ((share * f64::from(self.cells)).ceil() as u32).max(LEAST_CELLS);
        detail
    }
}

/// Bytes that the light of a scene with so many clouds in the picture may take in `quality`.
pub(super) fn allowance(quality: &Quality, seen: usize) -> u64 {
    let full = Detail::full(quality, 1.0);
    FULL_CLOUDS * full.bytes() + seen as u64 * full.at_most(0.0).bytes()
}

/// How fine the light of each cloud is that is `in_view`.
pub(super) fn plan(
    quality: &Quality,
    clouds: &[CloudFrame],
    in_view: &[bool],
    camera: &CameraUniform,
    eye: DVec3,
) -> Vec<Option<Detail>> {
    let size = |cloud: &CloudFrame| match cloud.medium.layer {
        Some(_) => f64::INFINITY,
        None => cloud.half.length(),
    };
    let largest = clouds.iter().map(size).filter(|size| size.is_finite()).fold(1e-6, f64::max);
    let seen: Vec<_> = clouds
        .iter()
        .zip(in_view)
        .map(|(cloud, &seen)| {
            let detail = Detail::full(quality, (size(cloud) / largest).min(1.0));
            seen.then(|| (detail, pixels(cloud, camera, eye)))
        })
        .collect();
    let most = allowance(quality, seen.iter().flatten().count());
    let details = |finest: f64| {
        seen.iter().map(move |cloud| cloud.map(|(detail, pixels)| detail.at_most(finest * pixels)))
    };
    let fits = |finest: f64| details(finest).flatten().map(Detail::bytes).sum::<u64>() <= most;
    // Coarser light takes no more, so that the finest that fits is found by halving.
    let tried = tried();
    let place = tried.partition_point(|&finest| finest >= 1e-6 && !fits(finest));
    details(tried[place.min(tried.len() - 1)]).collect()
}

/// Texels a pixel that are tried, finest first: all that clouds want, then ever fewer.
fn tried() -> Vec<f64> {
    let fewer = std::iter::successors(Some(4.0), |finest| Some(FINER * finest));
    let last = fewer.clone().position(|finest| finest < 1e-6).unwrap_or(0);
    [f64::INFINITY].into_iter().chain(fewer.take(last + 1)).collect()
}

/// How wide a cloud is in the picture, pixels; as good as infinite from within.
fn pixels(cloud: &CloudFrame, camera: &CameraUniform, eye: DVec3) -> f64 {
    let radius = cloud.half.length();
    let nearest = ((cloud.origin - eye).length() - radius).max(1e-9);
    let distance = if camera.projection == CameraUniform::ORTHOGRAPHIC { 1.0 } else { nearest };
    2.0 * radius / (f64::from(camera.pixel) * distance).max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{render::Frame, scene::Preset};

    fn frame(clouds: u32) -> Frame {
        let mut scene = Preset::Sphere.scene(1);
        let first = scene.clouds[0].clone();
        scene.clouds = (0..clouds)
            .map(|i| {
                let mut cloud = first.clone();
                cloud.ellipsoids[0].center.z -= 300.0 * f64::from(i);
                cloud
            })
            .collect();
        Frame::new(&scene, [320, 180]).unwrap()
    }

    fn planned(quality: &Quality, frame: &Frame) -> Vec<Option<Detail>> {
        let in_view = vec![true; frame.clouds.len()];
        plan(quality, &frame.clouds, &in_view, &frame.camera, frame.camera_position)
    }

    #[test]
    fn few_clouds_have_all_the_light_they_want() {
        let frame = frame(36);
        for (_, quality) in Quality::PRESETS {
            let full = Detail { resolution: quality.light_resolution, cells: quality.light_cells };
            assert!(planned(&quality, &frame).iter().all(|detail| *detail == Some(full)));
        }
    }

    #[test]
    fn light_of_many_clouds_fits_and_near_ones_have_most_of_it() {
        let frame = frame(3000);
        for (_, quality) in Quality::PRESETS {
            let details: Vec<_> = planned(&quality, &frame).into_iter().flatten().collect();
            let total: u64 = details.iter().map(|detail| detail.bytes()).sum();
            assert!(total <= allowance(&quality, 3000), "{total}");
            assert!(details.is_sorted_by(|near, far| near.resolution >= far.resolution));
            assert_eq!(details[0].resolution, quality.light_resolution);
        }
    }

    #[test]
    fn clouds_out_of_view_have_none() {
        let frame = frame(3);
        let in_view = [false, true, false];
        let details = plan(&Quality::DRAFT, &frame.clouds, &in_view, &frame.camera, frame.camera_position);
        assert_eq!(details.iter().map(Option::is_some).collect::<Vec<_>>(), in_view);
    }
}
