//! Skies as engines take them: equirectangular, and the six faces of a cube.
//!
//! Faces are in the order of Direct3D, Vulkan and KTX: +X, -X, +Y, -Y, +Z, -Z. That cube is
//! left-handed, and scenes are right-handed: its +Z is the scene's north, -z, so that it is sampled with (x, y, -z) of a
//! direction of the scene. Each face is a picture as seen from inside the cube, not mirrored.

use glam::DVec3;

use super::{Picture, Studio};
use crate::{
    Result,
    render::Frame,
    scene::{Camera, Projection, Scene},
};

/// Faces of the cube: name, direction in the scene, roll that brings its rows into order, degrees.
pub const FACES: [(&str, DVec3, f64); 6] = [
    ("px", DVec3::X, 0.0),
    ("nx", DVec3::NEG_X, 0.0),
    ("py", DVec3::Y, 180.0),
    ("ny", DVec3::NEG_Y, 0.0),
    ("pz", DVec3::NEG_Z, 0.0),
    ("nz", DVec3::Z, 0.0),
];

/// The six faces around the scene's camera, `size` pixels along an edge, in the order of [`FACES`];
/// tells the share done.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn cube_faces(
    studio: &mut Studio,
    scene: &Scene,
    size: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Picture>> {
    let right_angle = Projection::Perspective { vertical_fov_deg: 90.0 };
    let mut faces = Vec::new();
    for (_, direction, roll) in FACES {
        let scene = looking(scene, direction, roll, right_angle);
        faces.push(studio.picture(&scene, [size; 2], true)?);
        progress(faces.len() as f64 / FACES.len() as f64);
    }
    Ok(faces)
}

/// The whole sphere around the scene's camera, twice as wide as `height` pixels: north in the middle,
/// east to the right of it, the zenith on top.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn equirectangular(studio: &mut Studio, scene: &Scene, height: u32) -> Result<Picture> {
    let scene = looking(scene, DVec3::NEG_Z, 0.0, Projection::Equirectangular);
    studio.picture(&scene, [2 * height, height], true)
}

/// Auto exposure of the whole sphere around the scene's camera, in stops: one for all that is made of it.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn meter_around(studio: &mut Studio, scene: &Scene) -> Result<f64> {
    let scene = looking(scene, DVec3::NEG_Z, 0.0, Projection::Equirectangular);
    let gpu = studio.gpu().clone();
    studio.renderer().meter(&gpu, &Frame::new(&scene, [2, 1])?)
}

fn looking(scene: &Scene, direction: DVec3, roll_deg: f64, projection: Projection) -> Scene {
    let position = scene.camera().position;
    let camera =
        Camera { position, target: position + 1000.0 * direction, roll_deg, projection, ..Camera::default() };
    scene.seen_by(camera)
}
