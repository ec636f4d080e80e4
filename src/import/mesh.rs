//! Triangles of OBJ and glTF files.

use std::path::Path;

use glam::DVec3;

use super::{gltf, obj};
use crate::{Error, Result};

/// Triangles in metres, Y up.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Corners, m.
    pub positions: Vec<DVec3>,
    /// Numbers of each triangle's corners, against the clock as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Reads all triangles of an .obj, .gltf or .glb file.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where the file can't be read or has none.
pub fn read_mesh(path: &Path) -> Result<Mesh> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    let mesh = match ending.as_str() {
        "obj" => obj::read_mesh(path)?,
        "gltf" | "glb" => gltf::read_mesh(path)?,
        _ => {
            return Err(Error::Argument(format!(
                "`{}` ends in neither .obj, .gltf nor .glb: export the mesh as one of these",
                path.display()
            )));
        }
    };
    let problem = if mesh.triangles.is_empty() {
        "has no triangles: export a mesh with faces"
    } else if mesh.corners().flatten().any(|p| !p.is_finite()) {
        "has corners that are no numbers: export it anew"
    } else {
        return Ok(mesh);
    };
    Err(Error::Format { path: path.to_owned(), problem: problem.to_owned() })
}

impl Mesh {
    /// Least and greatest corner of its triangles, m.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let corners = self.corners().flatten();
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
    }

    /// Corners of each triangle.
    pub fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|i| self.positions[i as usize]))
    }
}
