//! Cameras of glTF files, as 3-D programs export them.

use std::path::Path;

use glam::{DMat4, DVec3};

use super::gltf::{Gltf, Lens};
use crate::{
    Error, Result,
    scene::{Camera, Projection},
};

/// The camera of a .gltf or .glb file called `name` (that of the camera or of its node), or the first.
/// The picture's own aspect counts, not that of the file.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where the file can't be read or has no such camera.
pub fn read_camera(path: &Path, name: Option<&str>) -> Result<Camera> {
    let file = Gltf::open(path)?;
    let mut cameras = Vec::new();
    for (node, world_from_node) in file.nodes() {
        if let Some(lens) = file.camera(node) {
            let names = [&node.name, &lens.name].map(|name| name.clone().unwrap_or_default());
            cameras.extend(placed(world_from_node, lens).map(|camera| (names, camera)));
        }
    }
    let wanted = |names: &[String; 2]| name.is_none_or(|name| names.iter().any(|own| own == name));
    if let Some((_, camera)) = cameras.iter().find(|(names, _)| wanted(names)) {
        return Ok(camera.clone());
    }
    let list: Vec<_> = cameras.iter().map(|([node, _], _)| format!("`{node}`")).collect();
    let problem = match name {
        Some(name) if !list.is_empty() => format!("has no camera `{name}`, but {}", list.join(", ")),
        _ => "has no camera: add one before the export".to_owned(),
    };
    Err(Error::Format { path: path.to_owned(), problem })
}

/// A camera looks along -z of its node, and y is up in the picture.
fn placed(world_from_node: DMat4, lens: &Lens) -> Option<Camera> {
    let position = world_from_node.w_axis.truncate();
    let forward = -world_from_node.z_axis.truncate().normalize_or(DVec3::Z);
    let up = world_from_node.y_axis.truncate();
    let projection = match (&lens.perspective, &lens.orthographic) {
        (Some(lens), _) => Projection::Perspective { vertical_fov_deg: lens.yfov.to_degrees() },
        (None, Some(parallel)) => Projection::Orthographic { height: 2.0 * parallel.ymag.abs() },
        (None, None) => return None,
    };
    let mut camera = Camera { position, target: position + 1000.0 * forward, roll_deg: 0.0, projection };
    let level = camera.world_from_camera();
    camera.roll_deg = up.dot(level * DVec3::X).atan2(up.dot(level * DVec3::Y)).to_degrees();
    Some(camera)
}
