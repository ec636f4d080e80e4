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
    /// Which of the scene's clouds it is.
    pub(crate) source: usize,
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

    /// The ellipsoids of cloud `index` as they are in the frame whose origin is at `origin`.
    pub(crate) fn ellipsoids_of(
        &self,
        index: usize,
        origin: DVec3,
    ) -> impl Iterator<Item = EllipsoidUniform> {
        EllipsoidUniform::of_cloud(&self.scene.clouds[self.clouds[index].source], origin)
    }

    /// The same moment seen from the points of a horizontal square of `extent` metres around `center`
    /// towards the sun: north on top, `size` pixels along an edge.
    ///
    /// # Errors
    /// As [`Frame::new`], and where the sun does not stand above the horizon.
    pub fn towards_sun(scene: &Scene, center: DVec3, extent: f64, size: u32) -> Result<Self> {
        let mut frame = Self::new(scene, [size; 2])?;
        if frame.to_sun.y <= 1e-3 {
            return Err(Error::Argument(
                "the sun does not stand above the horizon: it casts no shadows on the ground".to_owned(),
            ));
        }
        frame.camera =
            CameraUniform::from_square(frame.to_sun, extent, center.y - scene.ground.altitude, size);
        frame.camera_position = center;
        Ok(frame)
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
        frames.push(CloudFrame {
            origin,
            half: 0.5 * (max - min),
            ellipsoids: EllipsoidUniform::of_cloud(cloud, origin).collect(),
            source: index,
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
        let counts = |frame: &Frame| frame.clouds.iter().map(|c| (c.source, c.ellipsoids.len())).collect();
        let (before, after): (Vec<_>, Vec<_>) = (counts(&all), counts(&some));
        assert_eq!((before, after), (vec![(0, 8), (1, 8)], vec![(1, 7)]));
        // What the path tracer takes.
        assert_eq!(some.scene.clouds.iter().map(|c| c.ellipsoids.len()).sum::<usize>(), 7);
        assert_eq!(some.camera_position, all.camera_position);
    }
}
