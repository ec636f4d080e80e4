//! A volume: numbers on a grid that another program made.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::grid::{Grid, MOST_ALONG};
use super::sequence::{Sequence, Shown};
use super::steps::Steps;
use super::validate::{At, COORDINATE, Limits};
use super::{Bounds, Droplets, Species, union};
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
    /// folder of the scene's file on. Files of a sequence have #### where their number is, or %04d or $F4:
    /// `storm.####.vdb`.
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
    /// How it goes through the steps of a sequence of files, or through all times of a file that holds several. Left out,
    /// a sequence of files begins at 0 seconds and has a step a frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sequence: Option<Sequence>,
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

impl Up {
    /// From the file's axes to those of the scene.
    pub(super) fn rotation(self) -> DMat3 {
        match self {
            Self::Y => DMat3::IDENTITY,
            Self::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        }
    }
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
    /// Of a sequence that of its first step, without values; of one of its steps its own, read when it is asked for.
    grid: OnceLock<std::result::Result<Arc<Grid>, String>>,
    folder: PathBuf,
    steps: Option<Arc<Steps>>,
    /// What of them it is.
    shown: Option<Shown>,
}

/// Whether the same of a sequence is there: the rest follows from what scenes say.
impl PartialEq for Opened {
    fn eq(&self, other: &Self) -> bool {
        self.shown == other.shown
    }
}

/// Numbers of the first and the last step of a sequence, and how many there are.
pub type StepRange = (i32, i32, u32);

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
            sequence: None,
            raw: None,
            opened: Opened::default(),
        }
    }
}

impl Volume {
    /// A volume of this grid, which stands in for that of its file.
    #[must_use]
    pub fn with_grid(mut self, grid: Arc<Grid>) -> Self {
        self.opened.grid = OnceLock::from(Ok(grid));
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
    /// its values are extinctions, that of so much water in kg/m^3, else that of droplets as clouds have them.
    pub fn usual_extinction(grid: &Grid) -> f64 {
        match &grid.quantity {
            told if told.contains("extinction") => 1.0,
            told if told.contains("mass of water") => Self::extinction_of_mass(Species::Water),
            _ => Droplets::default().extinction(),
        }
    }

    /// Extinction, per metre, of 1 kg/m^3 of particles of their usual size.
    pub fn extinction_of_mass(species: Species) -> f64 {
        species.extinction_of_mass(1.0, 1e-6 * species.usual_radius_um())
    }

    /// What was read of its file: [`Scene::load`](super::Scene::load) reads that. Of a sequence it is the first step without
    /// its values; [`Scene::at`](super::Scene::at) has a step of it, whose file is read when it is asked for here.
    pub fn read_grid(&self) -> Option<&Arc<Grid>> {
        self.grid().ok()
    }

    /// The same, or what is wrong with a volume that is to be drawn.
    ///
    /// # Errors
    /// Where it was not read, or its step can't be.
    pub(crate) fn grid(&self) -> Result<&Arc<Grid>> {
        let read = match (&self.opened.steps, &self.opened.shown) {
            (Some(steps), Some(shown)) => {
                let read = || steps.show(shown).map_err(|error| error.to_string());
                Some(self.opened.grid.get_or_init(read))
            }
            _ => self.opened.grid.get(),
        };
        match read {
            Some(Ok(grid)) => Ok(grid),
            Some(Err(problem)) => Err(Error::Argument(problem.clone())),
            None => Err(self.unread()),
        }
    }

    /// A number that differs where what its files hold does, for who keeps what was made of them; `None` where they were
    /// not read.
    pub fn fingerprint(&self) -> Option<u64> {
        match (&self.opened.steps, &self.opened.shown) {
            (Some(steps), Some(shown)) => Some(steps.fingerprint(shown)),
            _ => Some(self.read_grid()?.fingerprint),
        }
    }

    /// Numbers of the first and the last step of its sequence, and how many there are; `None` of a volume without one.
    pub fn steps(&self) -> Option<StepRange> {
        let [least, greatest] = self.opened.steps.as_ref()?.ends();
        let sequence = self.sequence.clone().unwrap_or_default();
        let (first, count) = sequence.range(least, greatest);
        Some((first, first.saturating_add_unsigned((count - 1).saturating_mul(sequence.increment)), count))
    }

    /// How long its sequence is, s, with as many steps a second as it tells, or as a timeline has where that is left out.
    #[cfg(feature = "cli")]
    pub(crate) fn length(&self) -> Option<f64> {
        let (_, _, count) = self.steps()?;
        let fps = self.sequence.as_ref().and_then(|sequence| sequence.fps);
        Some(f64::from(count) / fps.unwrap_or(super::Timeline::default().fps))
    }

    /// The file of its first step, and what [`Volume::steps`] would tell; its paths start from `folder`. Nothing is read.
    ///
    /// # Errors
    /// Where there is no such step.
    #[cfg(feature = "cli")]
    pub(crate) fn first_file(&self, folder: &Path) -> Result<(PathBuf, Option<StepRange>)> {
        let Some(steps) = Steps::of(self, folder)?.map(Arc::new) else {
            return Ok((folder.join(&self.file), None));
        };
        let opened = Opened { steps: Some(steps.clone()), ..Opened::default() };
        let told = Self { opened, ..self.clone() }.steps();
        let first = steps.still(told.map_or(0, |(first, ..)| first)).map_err(Error::Argument)?;
        Ok((folder.join(first.file), told))
    }

    /// What there is of it at `time`, s, with `fps` steps a second unless it tells a rate: a step of its sequence or what is
    /// between two, or all of it where it has none.
    ///
    /// # Errors
    /// Where a step is missing, or motion that is wanted, as a sentence.
    pub(super) fn at(self, time: f64, fps: f64) -> std::result::Result<Option<Self>, String> {
        let Some(steps) = self.opened.steps.clone().filter(|_| self.opened.shown.is_none()) else {
            return Ok(Some(self));
        };
        let sequence = self.sequence.clone().unwrap_or_default();
        let way = sequence.way(fps, self.scene_from_file().inverse(), || steps.has_velocities());
        let way = way.map_err(|problem| format!("`{}` {problem}", self.file))?;
        let Some(shown) = sequence.shown(time, fps, steps.ends(), way) else { return Ok(None) };
        let Self { file, step, .. } = steps.still(shown.number)?;
        if let Some(mix) = &shown.mix {
            steps.still(mix.next)?;
        }
        let (grid, folder) = (OnceLock::new(), self.opened.folder.clone());
        let opened = Opened { grid, folder, steps: Some(steps), shown: Some(shown) };
        Ok(Some(Self { file, step, sequence: None, opened, ..self }))
    }

    /// Takes over what another one has read, where that is the same part of the same file.
    pub(crate) fn take_grid_of(&mut self, other: &Self) {
        let named = |volume: &Self| {
            (
                volume.file.clone(),
                volume.grid.clone(),
                volume.step,
                volume.raw.clone(),
                volume.sequence.is_some(),
            )
        };
        if named(self) == named(other) {
            self.opened = other.opened.clone();
        }
    }

    /// Reads its file, whose path starts from `folder`; of a sequence the first step.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Format`] where it can't be read or has no such grid.
    pub fn read(&mut self, folder: &Path) -> Result<()> {
        let steps = Steps::of(self, folder)?.map(Arc::new);
        let grid = match &steps {
            Some(steps) => {
                let (first, _) =
                    self.sequence.clone().unwrap_or_default().range(steps.ends()[0], steps.ends()[1]);
                Arc::new(steps.show(&Shown { number: first, mix: None })?.outline())
            }
            None => Arc::new(self.grid_in(&folder.join(&self.file))?),
        };
        self.opened =
            Opened { grid: OnceLock::from(Ok(grid)), folder: folder.to_owned(), steps, shown: None };
        Ok(())
    }

    /// Reads the grid in a file of its own.
    #[cfg(feature = "import")]
    pub(super) fn grid_in(&self, path: &Path) -> Result<Grid> {
        let raw = self.raw.as_ref().map(|brick| crate::import::Raw {
            size: brick.size,
            big_endian: brick.endian == Endian::Big,
            voxel: brick.voxel.into(),
        });
        let choice = crate::import::Choice { grid: self.grid.as_deref(), raw, step: self.step };
        crate::import::read_volume(path, &choice)
    }

    #[cfg(not(feature = "import"))]
    pub(super) fn grid_in(&self, path: &Path) -> Result<Grid> {
        Err(Error::Argument(format!(
            "`{}` is a volume, and this build reads none: build with the feature `import`, or give the volume its grid",
            path.display()
        )))
    }

    /// The same volume in a scene whose file is in `folder`.
    pub(super) fn written_from(&self, folder: &Path) -> Self {
        let mut written = self.clone();
        if (self.opened.grid.get().is_some() || self.opened.steps.is_some()) && self.opened.folder != folder {
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
        DAffine3::from_mat3_translation(self.scene_from_file(), self.place) * grid.place
    }

    /// From vectors in its file's lengths to those of the scene, m.
    fn scene_from_file(&self) -> DMat3 {
        DMat3::from_quat(self.orientation) * self.up.rotation() * self.scale
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
        if self.file.is_empty() && self.opened.grid.get().is_none() {
            return Err(at.field("file").problem("it is empty: name the file that holds the volume"));
        }
        at.field("extinction").number(self.extinction, EXTINCTION)?;
        at.field("scale").number(self.scale, SCALE)?;
        at.field("place").position(self.place)?;
        at.field("orientation").rotation(self.orientation)?;
        if let Some(sequence) = &self.sequence {
            sequence.check(at.field("sequence"))?;
        }
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
    fn unread(&self) -> Error {
        Error::Argument(format!(
            "the volume `{}` was not read: load the scene from its file, or read it by `Scene::read_volumes`",
            self.file
        ))
    }
}
