//! A mesh: the boundary of a cloud, as another program made it.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::{DMat3, DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, COORDINATE, Limits};
use super::{Bounds, Surface, Up, Volume};
use crate::{Error, Result};

const SCALE: Limits = Limits::new(1e-6, 1e6, "metres");
const DENSITY: Limits = Limits::new(0.0, 100.0, "");

/// The shape of a cloud as a closed mesh in a file. Its surface is where the cloud ends; edge and noise work on it as on that
/// of ellipsoids, from there inwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Mesh {
    /// The file: .obj, .gltf or .glb; from the folder of the scene's file on. It must be closed, but for holes that are
    /// small beside it; parts may overlap.
    pub file: String,
    /// Extinction over that of the droplets, 0 to 100, no unit.
    #[schemars(range(min = DENSITY.min, max = DENSITY.max))]
    pub density: f64,
    /// Metres of the file's unit of length, 0.000001 to 1000000: 0.01 for centimetres.
    #[schemars(range(min = SCALE.min, max = SCALE.max), extend("unit" = SCALE.unit))]
    pub scale: f64,
    /// Which axis of the file goes up: "y" or "z".
    pub up: Up,
    /// Where the file's origin is in the scene [x, y, z], metres; the wind carries it.
    #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    pub place: DVec3,
    /// Rotation about the file's origin, a quaternion [x, y, z, w] as in glTF; made unit length on loading.
    #[schemars(with = "[f64; 4]")]
    pub orientation: DQuat,
    /// What was read of the file.
    #[serde(skip)]
    pub opened: ReadMesh,
}

/// What was read of a mesh's file, and the folder that its path starts from. It is no part of what a scene says.
#[derive(Debug, Clone, Default)]
pub struct ReadMesh {
    surface: Option<Arc<Surface>>,
    folder: PathBuf,
}

/// All are equal: what differs follows from what scenes say.
impl PartialEq for ReadMesh {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Default for Mesh {
    fn default() -> Self {
        Self {
            file: String::new(),
            density: 1.0,
            scale: 1.0,
            up: Up::Y,
            place: DVec3::ZERO,
            orientation: DQuat::IDENTITY,
            opened: ReadMesh::default(),
        }
    }
}

impl Mesh {
    /// A mesh of this surface, which stands in for that of its file.
    #[must_use]
    pub fn with_surface(mut self, surface: Arc<Surface>) -> Self {
        self.opened.surface = Some(surface);
        self
    }

    /// What was read of its file: [`Scene::load`](super::Scene::load) reads that.
    pub fn surface(&self) -> Option<&Arc<Surface>> {
        self.opened.surface.as_ref()
    }

    /// The same, or what is wrong with a mesh that is to be drawn.
    ///
    /// # Errors
    /// Where it was not read.
    pub(crate) fn read_surface(&self) -> Result<&Arc<Surface>> {
        self.surface().ok_or_else(|| {
            Error::Argument(format!(
                "the mesh `{}` was not read: load the scene from its file, or read it by `Scene::read_volumes`",
                self.file
            ))
        })
    }

    /// Takes over what another one has read, where that is the same file.
    pub(crate) fn take_surface_of(&mut self, other: &Self) {
        if self.file == other.file {
            self.opened = other.opened.clone();
        }
    }

    /// Reads its file, whose path starts from `folder`.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Format`] where it can't be read or encloses nothing.
    #[cfg(feature = "import")]
    pub fn read(&mut self, folder: &Path) -> Result<()> {
        let path = folder.join(&self.file);
        let mesh = crate::import::read_mesh(&path)?;
        let surface = Surface::new(&mesh.positions, &mesh.triangles)
            .map_err(|problem| Error::Format { path, problem })?;
        self.opened = ReadMesh { surface: Some(Arc::new(surface)), folder: folder.to_owned() };
        Ok(())
    }

    /// Refuses to read: this build has no readers.
    ///
    /// # Errors
    /// Always.
    #[cfg(not(feature = "import"))]
    pub fn read(&mut self, folder: &Path) -> Result<()> {
        Err(Error::Argument(format!(
            "`{}` is a mesh, and this build reads none: build with the feature `import`, or give the mesh its surface",
            folder.join(&self.file).display()
        )))
    }

    /// The same mesh in a scene whose file is in `folder`.
    pub(super) fn written_from(&self, folder: &Path) -> Self {
        let mut written = self.clone();
        if self.opened.surface.is_some() && !self.file.is_empty() && self.opened.folder != folder {
            written.file = Volume::path_from(folder, &self.opened.folder.join(&self.file));
        }
        written
    }

    /// From vectors in its file's lengths to those of the scene, m.
    pub(crate) fn scene_from_file(&self) -> DMat3 {
        DMat3::from_quat(self.orientation) * self.up.rotation() * self.scale
    }

    /// The box around it in the world, m; `None` before it is read.
    pub fn bounds(&self) -> Option<Bounds> {
        let (low, high) = self.surface()?.bounds_turned(&self.scene_from_file());
        Some((low + self.place, high + self.place))
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        if self.file.is_empty() && self.surface().is_none() {
            return Err(at.field("file").problem("it is empty: name the file that holds the mesh"));
        }
        at.field("density").number(self.density, DENSITY)?;
        at.field("scale").number(self.scale, SCALE)?;
        at.field("place").position(self.place)?;
        at.field("orientation").rotation(self.orientation)?;
        match self.bounds() {
            Some((low, high)) => [low, high].into_iter().try_for_each(|corner| {
                at.position(corner).map_err(|_| {
                    at.problem(format!(
                        "it reaches to {corner:.0} metres, too far: change `scale` or `place`, by which it lies from {low:.0} to \
                         {high:.0}"
                    ))
                })
            }),
            None => Ok(()),
        }
    }
}
