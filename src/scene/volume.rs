//! A volume: numbers on a grid that another program made.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::grid::{Grid, MOST_ALONG};
use super::validate::{At, COORDINATE, Limits};
use super::{Bounds, Droplets, union};
use crate::{Error, Result};

const EXTINCTION: Limits = Limits::new(0.0, 1e6, "per metre");
const SCALE: Limits = Limits::new(1e-6, 1e6, "metres");
const VOXEL: Limits = Limits::new(1e-9, 1e9, "");
/// Voxels of a brick of floats along an axis.
const ALONG: Limits = Limits::new(1.0, MOST_ALONG as f64, "voxels");

/// The shape of a cloud that another program made: density on a grid, in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Volume {
    /// The file: OpenVDB (.vdb), Mitsuba's .vol, output of WRF (NetCDF), or floats that lie as `raw` says; from the
    /// folder of the scene's file on.
    pub file: String,
    /// Name of the grid in the file; left out, the only one, or `density`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<String>,
    /// Extinction coefficient where the grid is 1, per metre, 0 to 1000000: 1 where the grid's values are extinctions, as
    /// in files that nephos wrote.
    #[schemars(range(min = EXTINCTION.min, max = EXTINCTION.max), extend("unit" = EXTINCTION.unit))]
    pub extinction: f64,
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
    /// Which of its times, where the file holds several: 0 is the first.
    #[serde(skip_serializing_if = "is_first")]
    pub step: u32,
    /// How the numbers of a file lie that holds nothing but floats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raw: Option<Brick>,
    /// What was read of the file.
    #[serde(skip)]
    pub opened: Opened,
}

/// Which axis of a file goes up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Up {
    /// Y, as in Houdini and Maya.
    #[default]
    Y,
    /// Z, as in Blender and Unreal: its y goes north.
    Z,
}

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Endian {
    /// The least significant one first, as most machines have it.
    #[default]
    Little,
    /// The most significant one first.
    Big,
}

/// How the numbers of a file lie that holds nothing but floats, x fastest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Brick {
    /// Voxels along x, y and z, 1 to 2048.
    #[schemars(inner(range(min = ALONG.min, max = ALONG.max)))]
    pub size: [u32; 3],
    /// The order of the bytes of a number: "little" or "big".
    #[serde(default)]
    pub endian: Endian,
    /// Edges of a voxel along x, y and z, in the file's unit of length, 0.000000001 to 1000000000; 1 where left out.
    #[serde(default = "unit_voxel")]
    #[schemars(inner(range(min = VOXEL.min, max = VOXEL.max)))]
    pub voxel: [f64; 3],
}

fn is_first(step: &u32) -> bool {
    *step == 0
}

fn unit_voxel() -> [f64; 3] {
    [1.0; 3]
}

/// What was read of a file, and the folder that its path starts from. It is no part of what a scene says.
#[derive(Debug, Clone, Default)]
pub struct Opened {
    grid: Option<Arc<Grid>>,
    folder: PathBuf,
}

impl PartialEq for Opened {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Default for Volume {
    fn default() -> Self {
        Self {
            file: String::new(),
            grid: None,
            extinction: 1.0,
            scale: 1.0,
            up: Up::Y,
            place: DVec3::ZERO,
            orientation: DQuat::IDENTITY,
            step: 0,
            raw: None,
            opened: Opened::default(),
        }
    }
}

impl Volume {
    /// A volume of this grid, which stands in for that of its file.
    #[must_use]
    pub fn with_grid(mut self, grid: Arc<Grid>) -> Self {
        self.opened.grid = Some(grid);
        self
    }

    /// Whether a file has the name of a volume's: .vdb, .vol or .nc.
    pub fn is_named(path: &Path) -> bool {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        ["vdb", "vol", "nc"].iter().any(|known| ending.eq_ignore_ascii_case(known))
    }

    /// Which axis goes up in a file of this name, if nobody says otherwise: z in NetCDF.
    pub fn usual_up(file: &Path) -> Up {
        if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("nc")) { Up::Z } else { Up::Y }
    }

    /// Extinction, per metre, that `grid` has where it is 1, if nobody says otherwise: 1 where its file says that
    /// its values are extinctions, else that of droplets as clouds have them.
    pub fn usual_extinction(grid: &Grid) -> f64 {
        if grid.quantity.contains("extinction") { 1.0 } else { Droplets::default().extinction() }
    }

    /// What was read of its file: [`Scene::load`](super::Scene::load) reads that.
    pub fn read_grid(&self) -> Option<&Arc<Grid>> {
        self.opened.grid.as_ref()
    }

    /// Takes over what another one has read, where that is the same part of the same file.
    pub(crate) fn take_grid_of(&mut self, other: &Self) {
        if (&self.file, &self.grid, self.step, &self.raw)
            == (&other.file, &other.grid, other.step, &other.raw)
        {
            self.opened = other.opened.clone();
        }
    }

    /// Reads its file, whose path starts from `folder`.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Format`] where it can't be read or has no such grid.
    pub fn read(&mut self, folder: &Path) -> Result<()> {
        let grid = self.grid_in(&folder.join(&self.file))?;
        self.opened = Opened { grid: Some(Arc::new(grid)), folder: folder.to_owned() };
        Ok(())
    }

    #[cfg(feature = "import")]
    fn grid_in(&self, path: &Path) -> Result<Grid> {
        let raw = self.raw.as_ref().map(|brick| crate::import::Raw {
            size: brick.size,
            big_endian: brick.endian == Endian::Big,
            voxel: brick.voxel.into(),
        });
        let choice = crate::import::Choice { grid: self.grid.as_deref(), raw, step: self.step };
        crate::import::read_volume(path, &choice)
    }

    #[cfg(not(feature = "import"))]
    fn grid_in(&self, path: &Path) -> Result<Grid> {
        Err(Error::Argument(format!(
            "`{}` is a volume, and this build reads none: build with the feature `import`, or give the volume its grid",
            path.display()
        )))
    }

    /// The same volume in a scene whose file is in `folder`.
    pub(super) fn written_from(&self, folder: &Path) -> Self {
        let mut written = self.clone();
        if self.opened.grid.is_some() && self.opened.folder != folder {
            written.file = Self::path_from(folder, &self.opened.folder.join(&self.file));
        }
        written
    }

    /// The path of a file as a scene in `folder` tells it: from there on where it is in it.
    pub fn path_from(folder: &Path, file: &Path) -> String {
        let whole = |path: &Path| {
            let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
            std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
        };
        let file = whole(file);
        file.strip_prefix(whole(folder)).unwrap_or(&file).to_string_lossy().into_owned()
    }

    /// From numbers of voxels of its grid to the world, m.
    pub fn world_from_voxels(&self, grid: &Grid) -> DAffine3 {
        let turned = match self.up {
            Up::Y => DMat3::IDENTITY,
            Up::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        };
        let turned = DMat3::from_quat(self.orientation) * turned * self.scale;
        DAffine3::from_mat3_translation(turned, self.place) * grid.place
    }

    /// Numbers of voxels between which there may be something: values change from one voxel's middle to the next.
    pub(crate) fn reach(grid: &Grid) -> (IVec3, IVec3) {
        let (first, last) = grid.bounds;
        (first - 1, last + 1)
    }

    /// The box around it in the world, m; `None` before it is read.
    pub fn bounds(&self) -> Option<Bounds> {
        let grid = self.read_grid()?;
        let (first, last) = Self::reach(grid);
        let world = self.world_from_voxels(grid);
        let corner = |i: i32| {
            let pick = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let p = world.transform_point3((first + pick * (last - first)).as_dvec3());
            (p, p)
        };
        (0..8).map(corner).reduce(union)
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        if self.file.is_empty() && self.opened.grid.is_none() {
            return Err(at.field("file").problem("it is empty: name the file that holds the volume"));
        }
        at.field("extinction").number(self.extinction, EXTINCTION)?;
        at.field("scale").number(self.scale, SCALE)?;
        at.field("place").position(self.place)?;
        at.field("orientation").rotation(self.orientation)?;
        if let Some(brick) = &self.raw {
            let raw = at.field("raw");
            raw.field("size").numbers(&brick.size.map(f64::from), ALONG)?;
            raw.field("voxel").numbers(&brick.voxel, VOXEL)?;
        }
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

    /// What is wrong with a volume that is to be drawn and was not read.
    pub(crate) fn unread(&self) -> Error {
        Error::Argument(format!(
            "the volume `{}` was not read: load the scene from its file, or read it by `Scene::read_volumes`",
            self.file
        ))
    }
}
