//! `nephos export volume`: the density in voxels.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::DVec3;

use super::{
    super::{
        numbers::above_zero,
        sequence::frames::{self, Frames, rate},
        terminal,
    },
    Source, ending, shares,
};
use crate::{
    Error, Result,
    export::{VdbOptions, write_vdb_with, write_vol},
    files::check_place,
    numbered::Pattern,
    render::{Frame, VoxelGrid, Voxels},
    scene::{Movement, Scene, Species},
};

/// Write the density as OpenVDB (.vdb) or as a grid volume of Mitsuba (.vol).
///
/// Voxels hold the mean extinction coefficient in 1/m, with all the noise of the pictures; what is
/// drawn as a medium of density 1 and this extinction is the same cloud. Coordinates are those
/// of the scene, in metres: clouds are where they are in pictures. Where clouds overlap the
/// densest counts.
#[derive(Debug, Args)]
pub struct Volume {
    #[command(flatten)]
    source: Source,
    /// Volume to write: .vdb (OpenVDB) or .vol (Mitsuba). Of a sequence the frame's number stands for the
    /// hashes of "cloud.####.vdb", for `%04d` or for `$F4`.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Frames of a sequence, such as 1-240, 1-240:2 or -10-240, frame 1 being at 0 seconds; all of the timeline
    /// where left out.
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true, conflicts_with = "time")]
    frames: Option<Frames>,
    /// Frames per second of a sequence, such as 24 or 24000/1001; the timeline's where left out, or else 24.
    #[arg(long, value_name = "N", value_parser = rate, conflicts_with = "time")]
    fps: Option<f64>,
    /// Edge of a voxel, metres.
    #[arg(long, value_name = "METRES", value_parser = above_zero, conflicts_with = "resolution")]
    voxel: Option<f64>,
    /// Voxels along the longest edge of the box around all clouds.
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(8..=16384))]
    resolution: u32,
    /// Samples of the density along each edge of a voxel, which then holds their mean.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=16))]
    samples: u32,
    /// Keep numbers as half floats, good to 1 in 2000, in half the bytes (.vdb).
    #[arg(long)]
    half: bool,
    /// Write how fast clouds go, too, by wind and curves: the grid `vel`, metres per second (.vdb).
    #[arg(long)]
    velocity: bool,
    /// Which axis points up. Y is that of scenes, Houdini, Mitsuba and glTF; Z that of Blender and Unreal.
    #[arg(long, value_enum, default_value_t = Up::Y)]
    up: Up,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Up {
    /// x east, y up, z south.
    Y,
    /// x east, y north, z up.
    Z,
}

impl Volume {
    pub(super) fn run(self) -> Result<()> {
        self.check_ending(ending(&self.output, &["vdb", "vol"])?)?;
        match frames::pattern(&self.output) {
            Ok(_) if self.source.time.is_some() => Err(Error::Argument(format!(
                "--time is one moment, and `{}` names a file for each frame: leave one of them out, or give --frames",
                self.output.display()
            ))),
            Ok(pattern) => self.sequence(&pattern),
            Err(problem) if self.frames.is_some() || self.fps.is_some() => Err(problem),
            Err(_) => self.moment(),
        }
    }

    /// What only one kind of file has is not asked of the other.
    fn check_ending(&self, ending: &str) -> Result<()> {
        let given = [(self.half, "--half"), (self.velocity, "--velocity")];
        match given.into_iter().find(|(given, _)| *given && ending != "vdb") {
            Some((_, word)) => {
                Err(Error::Argument(format!("{word} is for .vdb files, and .{ending} has none of it")))
            }
            None => Ok(()),
        }
    }

    fn moment(&self) -> Result<()> {
        check_place(&self.output)?;
        let scene = self.source.scene()?;
        let movement = self.velocity.then(|| self.source.movement()).transpose()?;
        let frame = Frame::new(&scene, [1, 1])?;
        let voxel = self.voxel.map_or_else(|| VoxelGrid::voxel_of(&frame, self.resolution), Ok)?;
        let gpu = self.source.gpu()?;
        let grid = self.grid(voxel);
        let volume = shares("sampling the density", |progress| Voxels::sample(&gpu, &frame, grid, progress))?;
        self.write(&self.output, &volume, movement.as_ref())?;
        let (first, last) = volume.bounds().unwrap_or_default();
        let size = last - first + 1;
        terminal::print(&format!(
            "{}: {}x{}x{} voxels of {} m, {} of them filled\n",
            self.output.display(),
            size.x,
            size.y,
            size.z,
            short(voxel),
            volume.filled().count()
        ))?;
        terminal::print(&untold(&scene))
    }

    /// A file a frame, with voxels of one size: that of the frame which needs the largest.
    fn sequence(&self, pattern: &Pattern) -> Result<()> {
        let moments = self.source.moments(self.frames.as_ref(), self.fps)?;
        let movements = match self.velocity {
            true => self.source.movements(self.frames.as_ref(), self.fps)?.into_iter().map(Some).collect(),
            false => vec![None; moments.len()],
        };
        moments.iter().try_for_each(|(number, _)| check_place(&pattern.file(*number)))?;
        // Frames are made when they are written: steps of volumes would not fit into memory together.
        let voxel = match self.voxel {
            Some(voxel) => voxel,
            None => moments
                .iter()
                .map(|(_, scene)| VoxelGrid::voxel_of(&Frame::new(scene, [1, 1])?, self.resolution))
                .try_fold(0.0, |most: f64, voxel| Ok::<_, Error>(most.max(voxel?)))?,
        };
        let (gpu, count) = (self.source.gpu()?, moments.len() as f64);
        shares("sampling the density", |progress| {
            for (i, ((number, scene), movement)) in moments.iter().zip(&movements).enumerate() {
                let mut own = |share: f64| progress((i as f64 + share) / count);
                let frame = Frame::new(scene, [1, 1])?;
                let volume = Voxels::sample(&gpu, &frame, self.grid(voxel), &mut own)?;
                self.write(&pattern.file(*number), &volume, movement.as_ref())?;
            }
            Ok(())
        })?;
        let (name, voxel) = (self.output.display(), short(voxel));
        terminal::print(&format!("{name}: {count} frames with voxels of {voxel} m\n"))
    }

    /// Writes a volume; `movement` is what matter does in a frame, with the frames of a second.
    fn write(&self, path: &Path, volume: &Voxels, movement: Option<&(Movement, f64)>) -> Result<()> {
        if !self.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("vdb")) {
            return write_vol(path, volume);
        }
        let velocity = movement.map(|(movement, fps)| move |p: DVec3| *fps * movement.nearest(p));
        let velocity = velocity.as_ref().map(|velocity| velocity as &(dyn Fn(DVec3) -> DVec3 + Sync));
        write_vdb_with(path, volume, VdbOptions { half: self.half, velocity })
    }

    fn grid(&self, voxel: f64) -> VoxelGrid {
        let grid = VoxelGrid { samples: self.samples, ..VoxelGrid::new(voxel) };
        if self.up == Up::Z { grid.z_up() } else { grid }
    }
}

fn short(voxel: f64) -> f64 {
    (1e4 * voxel).round() / 1e4
}

/// What a volume can't say of a scene's particles: a line, or nothing where there is nothing but water.
fn untold(scene: &Scene) -> String {
    let seen = scene.clouds.iter().filter(|cloud| !cloud.hidden).map(|cloud| cloud.droplets.species);
    let mut names: Vec<&str> = seen.filter(|species| *species != Species::Water).map(Species::name).collect();
    names.sort_unstable();
    names.dedup();
    if names.is_empty() {
        return String::new();
    }
    format!(
        "How {} scatters light is not in the file, which holds extinction alone: give the other program its asymmetry \
         (docs/particles.md).\n",
        names.join(" and ")
    )
}
