//! What casts shadows: clouds whose shadow may be seen.

use glam::{DVec3, Vec3};
use wgpu::TextureView;

use super::super::light::LightBox;
use crate::frame::{AERIAL_REACH, CameraUniform, CloudFrame, Frame};

/// A cloud's sunlight: the volume of its optical depth, in a box along the beam.
#[derive(Clone, PartialEq)]
pub(in crate::render) struct Caster {
    /// Its number among the clouds of the frame.
    pub number: usize,
    /// Origin of the cloud's frame in the world, m.
    pub origin: DVec3,
    pub light_box: LightBox,
    pub volume: TextureView,
    /// 1 less the asymmetry of what scatters without the peak.
    pub turning: f32,
}

impl Caster {
    /// Whether it is a period of something that has no end.
    pub(super) fn is_endless(&self) -> bool {
        self.light_box.repeat > 0.0
    }

    /// The corners of its box on the side of the light, in the world.
    pub(super) fn entries(&self) -> [DVec3; 4] {
        let LightBox { corner, edge_u, edge_v, .. } = self.light_box;
        [Vec3::ZERO, edge_u, edge_v, edge_u + edge_v].map(|edge| self.origin + (corner + edge).as_dvec3())
    }
}

/// How far from the camera the air is shaded, m, in steps; no farther than the air itself shows.
pub(super) fn reach(frame: &Frame, casters: &[Caster]) -> f64 {
    if casters.iter().any(Caster::is_endless) {
        return f64::from(AERIAL_REACH);
    }
    let to_sun = frame.sun.to_sun;
    let end = |entry: DVec3, length: f32| {
        let down = ((entry.y - frame.ground) / to_sun.y).clamp(f64::from(length), LONGEST);
        (entry - frame.camera_position).length().max((entry - down * to_sun - frame.camera_position).length())
    };
    let ends =
        casters.iter().flat_map(|caster| caster.entries().map(|entry| end(entry, caster.light_box.length)));
    let farthest = ends.fold(1.0, f64::max);
    (0.25 * (4.0 * farthest.log2()).ceil()).exp2().min(f64::from(AERIAL_REACH))
}

/// A shadow is followed no farther than this, m: the air's shadow ends at about that distance.
const LONGEST: f64 = 80e3;

/// Whether the cloud or the beam of its shadow, down to the ground, may be in the picture: never false where it is.
pub(in crate::render) fn may_shade(frame: &Frame, cloud: &CloudFrame) -> bool {
    let camera = &frame.camera;
    if cloud.medium.layer.is_some() {
        return true;
    }
    if camera.projection != CameraUniform::PERSPECTIVE {
        return true;
    }
    let radius = cloud.half.length();
    let down = ((cloud.origin.y + cloud.half.y - frame.ground) / frame.sun.to_sun.y).clamp(0.0, LONGEST);
    let near = cloud.origin - frame.camera_position;
    let ends = [near, near - down * frame.sun.to_sun];
    let sides = [
        (camera.up, camera.forward + camera.right),
        (camera.up, camera.forward - camera.right),
        (camera.right, camera.forward + camera.up),
        (camera.right, camera.forward - camera.up),
    ];
    let inward = |(edge, side): (Vec3, Vec3)| {
        let normal = edge.cross(side).as_dvec3().normalize_or_zero();
        if normal.dot(camera.forward.as_dvec3()) < 0.0 { -normal } else { normal }
    };
    let planes = sides.map(inward).into_iter().chain([camera.axis.as_dvec3()]);
    planes.into_iter().all(|normal| ends.iter().any(|end| end.dot(normal) > -radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;

    #[test]
    fn shadows_that_fall_into_the_picture_are_told_from_those_that_do_not() {
        let mut scene = Preset::Sphere.scene(1);
        scene.sun.position = crate::scene::SunPosition::Angles { azimuth_deg: 90.0, elevation_deg: 45.0 };
        let ahead = DVec3::NEG_Z;
        let position = DVec3::new(0.0, 2.0, 0.0);
        scene.camera =
            Some(crate::scene::Camera { position, target: position + 1e3 * ahead, ..scene.camera() });
        let seen = |offset: DVec3| {
            let mut scene = scene.clone();
            for ellipsoid in &mut scene.clouds[0].ellipsoids {
                ellipsoid.center = DVec3::new(0.0, 2000.0, 0.0) + offset;
            }
            let frame = Frame::new(&scene, [32, 18]).unwrap();
            may_shade(&frame, &frame.clouds[0])
        };
        assert!(seen(8e3 * ahead), "before the camera");
        assert!(!seen(-8e3 * ahead), "behind it");
        // From the east its shadow falls 2 km to the west of it.
        let to_sun = DVec3::X;
        assert!(seen(3e3 * ahead + 2e3 * to_sun), "beside it, with its shadow before it");
        assert!(!seen(3e3 * ahead - 12e3 * to_sun), "far on the other side");
    }
}
