//! Triangles of OBJ and glTF files.

use std::{fs::File, io::BufReader, path::Path};

use glam::DVec3;
use gltf::{
    Accessor, Primitive, Semantic,
    accessor::{DataType, Dimensions},
    mesh::Mode,
};

use super::gltf_file::{foreign, is_whole, open, visit_nodes};
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
        "obj" => read_obj(path)?,
        "gltf" | "glb" => read_gltf(path)?,
        _ => {
            return Err(Error::Argument(format!(
                "`{}` ends in neither .obj, .gltf nor .glb: export the mesh as one of these",
                path.display()
            )));
        }
    };
    let problem = if mesh.triangles.is_empty() {
        "has no triangles: export a mesh with faces"
    } else if mesh.positions.iter().any(|p| !p.is_finite()) {
        "has corners that are no numbers: export it anew"
    } else {
        return Ok(mesh);
    };
    Err(Error::Format { path: path.to_owned(), problem: problem.to_owned() })
}

impl Mesh {
    /// Least and greatest corner, m.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let corners = self.positions.iter();
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
    }

    /// Corners of each triangle.
    pub fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|i| self.positions[i as usize]))
    }

    /// Adds triangles whose numbers are those of `positions`; those of corners that do not exist are left out.
    fn add(&mut self, positions: &[DVec3], indices: &[u32]) {
        let first = self.positions.len() as u32;
        self.positions.extend(positions);
        let triangles =
            indices.as_chunks::<3>().0.iter().filter(|t| t.iter().all(|&i| (i as usize) < positions.len()));
        self.triangles.extend(triangles.map(|triangle| triangle.map(|i| first + i)));
    }
}

fn read_obj(path: &Path) -> Result<Mesh> {
    let file =
        File::open(path).map_err(|source| Error::File { action: "read", path: path.to_owned(), source })?;
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    // Materials change nothing here, and need not be there.
    let read = tobj::load_obj_buf(&mut BufReader::new(file), &options, |_| Ok(Default::default()));
    let (models, _) = read.map_err(|error| Error::Format {
        path: path.to_owned(),
        problem: format!("is no OBJ file that can be read ({error}): export it anew"),
    })?;
    let mut mesh = Mesh::default();
    for model in models {
        let positions: Vec<_> =
            model.mesh.positions.as_chunks::<3>().0.iter().map(|&p| DVec3::from(p.map(f64::from))).collect();
        mesh.add(&positions, &model.mesh.indices);
    }
    Ok(mesh)
}

/// Number of an accessor of corners, or of the corners' numbers, that is not as the standard has them.
fn damaged(primitive: &Primitive<'_>) -> Option<usize> {
    let corner = |accessor: &Accessor<'_>| {
        (accessor.data_type(), accessor.dimensions()) == (DataType::F32, Dimensions::Vec3)
    };
    let number = |accessor: &Accessor<'_>| {
        matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32)
            && accessor.dimensions() == Dimensions::Scalar
    };
    let corners =
        primitive.get(&Semantic::Positions).filter(|accessor| !(corner(accessor) && is_whole(accessor)));
    let numbers = primitive.indices().filter(|accessor| !(number(accessor) && is_whole(accessor)));
    corners.or(numbers).map(|accessor| accessor.index())
}

fn read_gltf(path: &Path) -> Result<Mesh> {
    let mut file = open(path)?;
    let mut primitives = file.meshes().flat_map(|mesh| mesh.primitives());
    if let Some(damaged) = primitives.find_map(|primitive| damaged(&primitive)) {
        return Err(foreign(path, &format!("accessor {damaged} does not hold what a mesh takes from it")));
    }
    let blob = file.blob.take();
    let buffers =
        gltf::import_buffers(&file.document, path.parent(), blob).map_err(|error| foreign(path, &error))?;
    let mut mesh = Mesh::default();
    visit_nodes(&file, &mut |node, world_from_node| {
        let primitives = node.mesh().into_iter().flat_map(|mesh| mesh.primitives());
        for primitive in primitives.filter(|primitive| primitive.mode() == Mode::Triangles) {
            let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(|data| &data.0[..]));
            let Some(positions) = reader.read_positions() else { continue };
            let positions: Vec<_> =
                positions.map(|p| world_from_node.transform_point3(DVec3::from(p.map(f64::from)))).collect();
            let indices: Vec<u32> = match reader.read_indices() {
                Some(indices) => indices.into_u32().collect(),
                None => (0..positions.len() as u32).collect(),
            };
            mesh.add(&positions, &indices);
        }
    });
    Ok(mesh)
}
