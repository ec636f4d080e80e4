//! Cameras of glTF files, as 3-D programs export them.

use std::path::Path;

use glam::{DMat4, DVec3};

use super::gltf::{Gltf, Lens, Motion};
use crate::{
    Error, Result,
    scene::{Camera, Projection},
};

/// The camera of a file, which may move.
pub struct MovingCamera {
    file: Gltf,
    motion: Motion,
    node: usize,
    lens: Seen,
}

/// How directions become places: the projection, and how far the lens is shifted.
type Seen = (Projection, [f64; 2]);

/// The camera of a .gltf or .glb file called `name` (that of the camera or of its node), or the first, as it is
/// at the beginning. The picture's own aspect counts, not that of the file.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where the file can't be read or has no such camera.
pub fn read_camera(path: &Path, name: Option<&str>) -> Result<Camera> {
    MovingCamera::read(path, name).map(|camera| camera.at(0.0))
}

impl MovingCamera {
    /// The same with all its ways: those of the nodes that it hangs on, too.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Format`] where the file can't be read or has no such camera.
    pub fn read(path: &Path, name: Option<&str>) -> Result<Self> {
        let file = Gltf::open(path)?;
        let mut cameras = Vec::new();
        for (index, node, lens) in file.with_cameras() {
            if let Some(projection) = projection(lens).map(|projection| (projection, shift(lens))) {
                let names = [&node.name, &lens.name].map(|name| name.clone().unwrap_or_default());
                cameras.push((index, projection, names));
            }
        }
        let wanted = |names: &[String; 2]| name.is_none_or(|name| names.iter().any(|own| own == name));
        if let Some(&(node, lens, _)) = cameras.iter().find(|(.., names)| wanted(names)) {
            let motion = file.motion(node)?;
            return Ok(Self { file, motion, node, lens });
        }
        let list: Vec<_> = cameras.iter().map(|(.., [node, _])| format!("`{node}`")).collect();
        let problem = match name {
            Some(name) if !list.is_empty() => format!("has no camera `{name}`, but {}", list.join(", ")),
            _ => "has no camera: add one before the export".to_owned(),
        };
        Err(Error::Format { path: path.to_owned(), problem })
    }

    /// When its last key is, s; 0 where it stands still.
    pub fn length(&self) -> f64 {
        self.motion.length()
    }

    /// The camera at `time`, s.
    pub fn at(&self, time: f64) -> Camera {
        let world = self.file.world_at(self.node, &self.motion, time).unwrap_or_default();
        placed(world, self.lens)
    }
}

fn projection(lens: &Lens) -> Option<Projection> {
    match (&lens.perspective, &lens.orthographic) {
        (Some(lens), _) => Some(Projection::Perspective { vertical_fov_deg: lens.yfov.to_degrees() }),
        (None, Some(parallel)) => Some(Projection::Orthographic { height: 2.0 * parallel.ymag.abs() }),
        (None, None) => None,
    }
}

/// How far the lens is shifted, shares of the picture's width: no part of glTF, but nephos writes it beside.
fn shift(lens: &Lens) -> [f64; 2] {
    ["shift_x", "shift_y"]
        .map(|name| lens.extras.get(name).and_then(serde_json::Value::as_f64).unwrap_or(0.0))
}

/// A camera looks along -z of its node, and y is up in the picture.
fn placed(world_from_node: DMat4, (projection, [shift_x, shift_y]): Seen) -> Camera {
    let position = world_from_node.w_axis.truncate();
    let forward = -world_from_node.z_axis.truncate().normalize_or(DVec3::Z);
    let up = world_from_node.y_axis.truncate();
    let mut camera = Camera {
        position,
        target: position + 1000.0 * forward,
        roll_deg: 0.0,
        projection,
        shift_x,
        shift_y,
        aperture: None,
    };
    let level = camera.world_from_camera();
    camera.roll_deg = up.dot(level * DVec3::X).atan2(up.dot(level * DVec3::Y)).to_degrees();
    camera
}
