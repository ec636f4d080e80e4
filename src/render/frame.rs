//! One moment of a scene as the GPU takes it: the only type between the artist's
//! `Scene` and the passes.

use std::sync::Arc;

use glam::DVec3;

use super::{camera::CameraUniform, ellipsoids::EllipsoidUniform, noise::NoiseFrame, optics::CloudOptics};
use crate::{Error, Result, scene::Scene};

/// A scene at one moment, seen by one camera, for one size of picture.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The moment of the scene that it was made from.
    pub(crate) scene: Scene,
    pub(crate) camera: CameraUniform,
    pub(crate) camera_position: DVec3,
    pub(crate) to_sun: DVec3,
    pub(crate) clouds: Vec<CloudFrame>,
}

/// A cloud in its own frame, whose origin is in the middle of it and whose axes are the
/// world's. What is kept between frames lives here and does not notice the camera.
#[derive(Debug, Clone)]
pub struct CloudFrame {
    /// Origin in the world, m.
    pub(crate) origin: DVec3,
    /// Half the extent along the world's axes, m.
    pub(crate) half: DVec3,
    pub(crate) ellipsoids: Vec<EllipsoidUniform>,
    /// Ellipsoids of other clouds, in this cloud's frame.
    pub(crate) others: Vec<EllipsoidUniform>,
    pub(crate) optics: Arc<CloudOptics>,
    pub(crate) noise: NoiseFrame,
}

impl Frame {
    /// `scene` at its own time, for a picture of `size` pixels.
    ///
    /// # Errors
    /// Where a value of the scene is out of its range, or `size` has a zero.
    pub fn new(scene: &Scene, size: [u32; 2]) -> Result<Self> {
        let mut moved = scene.at(scene.time)?;
        if size.contains(&0) {
            return Err(Error::Argument(format!(
                "a picture of {} by {} pixels has none: both must be at least 1",
                size[0], size[1]
            )));
        }
        let camera = moved.camera();
        for cloud in &mut moved.clouds {
            cloud.ellipsoids = cloud.visible().cloned().collect();
        }
        Ok(Self {
            camera: CameraUniform::new(&camera, moved.ground.altitude, size),
            camera_position: camera.position,
            to_sun: moved.sun.to_sun(),
            clouds: clouds(&moved)?,
            scene: moved,
        })
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.camera.size.map(|x| x as u32)
    }
}

fn clouds(scene: &Scene) -> Result<Vec<CloudFrame>> {
    let mut frames = Vec::new();
    for (index, cloud) in scene.clouds.iter().enumerate() {
        let Some((min, max)) = cloud.bounds() else { continue };
        let origin = 0.5 * (min + max);
        let others = scene.clouds.iter().enumerate().filter(|(other, _)| *other != index);
        let in_frame = |cloud| move |e| EllipsoidUniform::new(cloud, e, origin);
        frames.push(CloudFrame {
            origin,
            half: 0.5 * (max - min),
            ellipsoids: cloud.ellipsoids.iter().map(in_frame(cloud)).collect(),
            others: others.flat_map(|(_, other)| other.ellipsoids.iter().map(in_frame(other))).collect(),
            optics: CloudOptics::of(&cloud.droplets)?,
            noise: NoiseFrame::new(&scene.noise, origin),
        });
    }
    Ok(frames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;

    #[test]
    fn hidden_ellipsoids_and_clouds_are_left_out_but_the_camera_stays() {
        let mut scene = Preset::Kol.scene(1);
        scene.camera = None;
        scene.clouds.push(scene.clouds[0].clone());
        let all = Frame::new(&scene, [16, 9]).unwrap();
        scene.clouds[0].hidden = true;
        scene.clouds[1].ellipsoids[2].hidden = true;
        let some = Frame::new(&scene, [16, 9]).unwrap();
        let counts =
            |frame: &Frame| frame.clouds.iter().map(|c| (c.ellipsoids.len(), c.others.len())).collect();
        let (before, after): (Vec<_>, Vec<_>) = (counts(&all), counts(&some));
        assert_eq!((before, after), (vec![(8, 8), (8, 8)], vec![(7, 0)]));
        // What the path tracer takes.
        assert_eq!(some.scene.clouds.iter().map(|c| c.ellipsoids.len()).sum::<usize>(), 7);
        assert_eq!(some.camera_position, all.camera_position);
    }
}
