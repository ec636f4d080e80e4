//! Cameras of glTF files, as 3-D programs export them.

use std::path::Path;

use glam::{DMat4, DVec3};
use gltf::camera::Projection as Found;

use super::gltf_file::{open, visit_nodes};
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
    let file = open(path)?;
    let mut cameras = Vec::new();
    visit_nodes(&file, &mut |node, world_from_node| {
        if let Some(camera) = node.camera() {
            let names = [node.name(), camera.name()].map(|name| name.unwrap_or_default().to_owned());
            cameras.push((names, placed(world_from_node, &camera.projection())));
        }
    });
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
fn placed(world_from_node: DMat4, projection: &Found<'_>) -> Camera {
    let position = world_from_node.w_axis.truncate();
    let forward = -world_from_node.z_axis.truncate().normalize_or(DVec3::Z);
    let up = world_from_node.y_axis.truncate();
    let projection = match projection {
        Found::Perspective(lens) => {
            Projection::Perspective { vertical_fov_deg: f64::from(lens.yfov()).to_degrees() }
        }
        Found::Orthographic(parallel) => {
            Projection::Orthographic { height: 2.0 * f64::from(parallel.ymag()).abs() }
        }
    };
    let mut camera = Camera { position, target: position + 1000.0 * forward, roll_deg: 0.0, projection };
    let level = camera.world_from_camera();
    camera.roll_deg = up.dot(level * DVec3::X).atan2(up.dot(level * DVec3::Y)).to_degrees();
    camera
}
