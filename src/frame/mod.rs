//! One moment of a scene as the GPU takes it: what the real-time renderer and the path tracer both
//! stand on, and the only type between the artist's `Scene` and their passes.

mod air;
mod camera;
mod ground;
mod light;
mod matrices;
pub(crate) mod medium;
mod shared;
mod unit;

use glam::{DAffine3, DVec3, Mat4, Vec3};

pub(crate) use air::AERIAL_REACH;
pub use air::{AtmosphereUniform, SkySettings, SkyUniform};
pub use camera::CameraUniform;
pub(crate) use camera::Rays;
#[cfg(test)]
pub(crate) use ground::LARGER;
pub(crate) use ground::{FIELDS, PATTERN_SCALE};
pub use ground::{GroundSettings, GroundShader, GroundUniform};
pub(crate) use light::{FrameLight, LitBy};
pub use medium::{MEDIA, MIXED, NOISE_SIZE, bake_noise};

use crate::{
    Error, Result,
    scene::{self, GroundKind, Scene},
};
use medium::{LayerShape, Medium};
pub(crate) use shared::Shared;

/// A scene at one moment, seen by one camera, for one size of picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    pub(crate) camera: CameraUniform,
    pub(crate) camera_position: DVec3,
    pub(crate) sun: Sun,
    /// What kind of light that is.
    pub(crate) by: LitBy,
    /// Lights beside it.
    lights: Vec<FrameLight>,
    pub(crate) sky: SkySettings,
    /// Altitude of the ground, m.
    pub(crate) ground: f64,
    ground_kind: GroundKind,
    pub(crate) clouds: Vec<CloudFrame>,
    /// What 1 stands for in the lights of sun and sky.
    unit: f32,
}

/// The sun above the atmosphere, or another light as far away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sun {
    pub to_sun: DVec3,
    /// Across the beam.
    pub irradiance: Vec3,
    /// Angular radius of the disc, rad.
    pub radius: f32,
}

/// A cloud in its own frame, whose origin is in the middle of it and whose axes are the
/// world's. What is kept between frames lives here and does not notice the camera.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CloudFrame {
    /// Origin in the world, m.
    pub origin: DVec3,
    /// Half the extent along the world's axes, m.
    pub half: DVec3,
    pub medium: Shared<Medium>,
    /// Which cloud of the moment it is.
    pub number: usize,
}

impl Frame {
    /// `scene` at its own time, for a picture of `size` pixels.
    ///
    /// # Errors
    /// Where a value of the scene is out of its range, a step of a volume can't be read, a mesh or picture was not, or `size` has a zero.
    pub fn new(scene: &Scene, size: [u32; 2]) -> Result<Self> {
        let mut moved = scene.at(scene.time)?;
        let camera = moved.camera();
        for cloud in &mut moved.clouds {
            cloud.ellipsoids = cloud.visible().cloned().collect();
            cloud.layer = cloud.layer.take().filter(|_| !cloud.hidden);
            cloud.mesh = cloud.mesh.take().filter(|_| !cloud.hidden);
            cloud.volume = cloud.volume.take().filter(|_| !cloud.hidden);
        }
        if let Some(picture) = moved.ground.kind.picture().filter(|picture| picture.colors().is_none()) {
            return Err(picture.unread());
        }
        let sun = Sun::new(&moved.sun);
        let frame = Self {
            camera: CameraUniform::new(&camera, moved.ground.altitude, [1; 2]),
            camera_position: camera.position,
            sky: SkySettings::new(&moved, sun.to_sun),
            sun,
            by: LitBy::Sky,
            lights: FrameLight::all(&moved),
            ground: moved.ground.altitude,
            ground_kind: moved.ground.kind.clone(),
            clouds: clouds(&moved)?,
            unit: 1.0,
        };
        frame.in_its_unit().seen_by(&camera, size)
    }

    /// The same moment seen by another camera, for a picture of `size` pixels. What is in the clouds
    /// is shared.
    ///
    /// # Errors
    /// Where `size` has a zero.
    pub fn seen_by(&self, camera: &scene::Camera, size: [u32; 2]) -> Result<Self> {
        check_size(size)?;
        let uniform = CameraUniform::new(camera, self.ground, size);
        let eye = camera.eye(f64::from(size[0]) / f64::from(size[1]));
        Ok(Self { camera: uniform, ..self.clone() }.seen_at(eye))
    }

    /// The same picture in `size` pixels, which are as wide as high only where it has the same shape.
    pub(crate) fn resized(&self, size: [u32; 2]) -> Self {
        Self { camera: self.camera.resized(size), ..self.clone() }
    }

    /// The same moment seen by the camera of a game engine, for a picture of `size` pixels: perspective, with
    /// the middle of the picture where the matrix has it, or orthographic; depth may be finite or not,
    /// reversed or not, which [`SceneDepth`](crate::render::SceneDepth) tells. Behind parallel
    /// lines of sight is the sky of the height of the picture's middle. The camera looks along -Z of
    /// its view, y is up, in metres; y of the clip space is up, as wgpu has it.
    ///
    /// # Errors
    /// Where a matrix is no projection or no place of a camera, or `size` has a zero.
    pub fn seen_through(
        &self,
        clip_from_view: Mat4,
        world_from_view: DAffine3,
        size: [u32; 2],
    ) -> Result<Self> {
        check_size(size)?;
        let (camera, camera_position) = matrices::camera(clip_from_view, world_from_view, self.ground, size)?;
        Ok(Self { camera, ..self.clone() }.seen_at(camera_position))
    }

    /// The same with the camera elsewhere, m: layers, which have no end, have their frames beside it.
    fn seen_at(mut self, eye: DVec3) -> Self {
        self.camera_position = eye;
        for cloud in &mut self.clouds {
            if let Some(layer) = &cloud.medium.layer {
                cloud.origin = layer.origin_near(eye);
            }
        }
        self
    }

    /// The same moment seen from the points of a horizontal square of `extent` metres around `center`
    /// towards the sun: north on top, `size` pixels along an edge.
    ///
    /// # Errors
    /// As [`Frame::new`], and where the sun does not stand above the horizon.
    pub fn towards_sun(scene: &Scene, center: DVec3, extent: f64, size: u32) -> Result<Self> {
        let mut frame = Self::new(scene, [size; 2])?;
        let to_sun = frame.sun.to_sun;
        if to_sun.y <= 1e-3 {
            return Err(Error::Argument(
                "the sun does not stand above the horizon: it casts no shadows on the ground".to_owned(),
            ));
        }
        frame.camera = CameraUniform::from_square(to_sun, extent, center.y - frame.ground, size);
        Ok(frame.seen_at(center))
    }

    /// What the ground looks like from the camera.
    pub(crate) fn ground_settings(&self) -> GroundSettings {
        GroundSettings::new(&self.ground_kind, self.camera_position)
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.camera.size.map(|x| x as u32)
    }

    /// Least and greatest corner of the box around all clouds but layers, which have no end, m; `None`
    /// without such clouds.
    pub(crate) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let ends = self.clouds.iter().filter(|cloud| cloud.medium.layer.is_none());
        let boxes = ends.map(|cloud| (cloud.origin - cloud.half, cloud.origin + cloud.half));
        boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

fn check_size(size: [u32; 2]) -> Result<()> {
    if size.contains(&0) {
        return Err(Error::Argument(format!(
            "a picture of {} by {} pixels has none: both must be at least 1",
            size[0], size[1]
        )));
    }
    Ok(())
}

fn clouds(scene: &Scene) -> Result<Vec<CloudFrame>> {
    let mut frames = Vec::new();
    for (number, cloud) in scene.clouds.iter().enumerate() {
        if let Some(map) = cloud.map().filter(|map| map.cover().is_none()) {
            return Err(map.unread());
        }
        if let Some(shape) = LayerShape::new(cloud, scene.ground.altitude) {
            let (origin, half) = (shape.anchor(), shape.half());
            let medium = Shared::new(Medium::of_layer(cloud, shape, &scene.noise)?);
            frames.push(CloudFrame { origin, half, medium, number });
        }
        if let Some(volume) = &cloud.volume {
            volume.grid()?;
        }
        if let Some(mesh) = &cloud.mesh {
            mesh.read_surface()?;
        }
        let Some((min, max)) = cloud.bounds() else { continue };
        let origin = 0.5 * (min + max);
        let (noise, bounds) = (&scene.noise, (min, max));
        let medium = match (&cloud.mesh, &cloud.volume) {
            // What lets all light through is not there.
            (_, Some(volume)) if volume.extinction <= 0.0 => continue,
            (Some(mesh), _) if mesh.density <= 0.0 => continue,
            (_, Some(volume)) => Medium::of_volume(cloud, volume, noise, bounds, origin)?,
            (Some(mesh), _) => Medium::of_mesh(cloud, mesh, noise, bounds, origin)?,
            (None, None) => Medium::new(cloud, noise, bounds, origin)?,
        };
        let medium = Shared::new(medium);
        frames.push(CloudFrame { origin, half: 0.5 * (max - min), medium, number });
    }
    Ok(frames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;

    #[test]
    fn hidden_ellipsoids_and_clouds_are_left_out_and_the_camera_takes_no_note_of_them() {
        let mut scene = Preset::Kol.scene(1);
        scene.camera = None;
        scene.clouds.push(scene.clouds[0].clone());
        let all = Frame::new(&scene, [16, 9]).unwrap();
        scene.clouds[0].hidden = true;
        scene.clouds[1].ellipsoids[2].hidden = true;
        let some = Frame::new(&scene, [16, 9]).unwrap();
        let counts = |frame: &Frame| frame.clouds.iter().map(|c| c.medium.ellipsoids.len()).collect();
        let (before, after): (Vec<_>, Vec<_>) = (counts(&all), counts(&some));
        assert_eq!((before, after), (vec![8, 8], vec![7]));
        let mut shown = scene.clone();
        shown.clouds.remove(0);
        shown.clouds[0].ellipsoids.remove(2);
        assert_eq!(some.camera_position, Frame::new(&shown, [16, 9]).unwrap().camera_position);
        assert_ne!(some.camera_position, all.camera_position);
        // Where all are hidden the camera stays.
        scene.clouds[1].hidden = true;
        assert_eq!(Frame::new(&scene, [16, 9]).unwrap().camera_position, all.camera_position);
    }
}
