//! `nephos export volume`: the density in voxels.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{
    super::{
        numbers::above_zero,
        sequence::frames::{Frames, Pattern, rate},
        terminal,
    },
    Source, ending, shares,
};
use crate::{
    Error, Result,
    export::{write_vdb, write_vol},
    files::check_place,
    render::{Frame, VoxelGrid, Voxels},
    scene::{Scene, Species},
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
        let write: Write = match ending(&self.output, &["vdb", "vol"])? {
            "vdb" => write_vdb,
            _ => write_vol,
        };
        match Pattern::of(&self.output) {
            Ok(_) if self.source.time.is_some() => Err(Error::Argument(format!(
                "--time is one moment, and `{}` names a file for each frame: leave one of them out, or give --frames",
                self.output.display()
            ))),
            Ok(pattern) => self.sequence(&pattern, write),
            Err(problem) if self.frames.is_some() || self.fps.is_some() => Err(problem),
            Err(_) => self.moment(write),
        }
    }

    fn moment(&self, write: Write) -> Result<()> {
        check_place(&self.output)?;
        let scene = self.source.scene()?;
        let frame = Frame::new(&scene, [1, 1])?;
        let voxel = self.voxel.map_or_else(|| VoxelGrid::voxel_of(&frame, self.resolution), Ok)?;
        let gpu = self.source.gpu()?;
        let grid = self.grid(voxel);
        let volume = shares("sampling the density", |progress| Voxels::sample(&gpu, &frame, grid, progress))?;
        write(&self.output, &volume)?;
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
    fn sequence(&self, pattern: &Pattern, write: Write) -> Result<()> {
        let moments = self.source.moments(self.frames.as_ref(), self.fps)?;
        moments.iter().try_for_each(|(number, _)| check_place(&pattern.file(*number)))?;
        let frames: Vec<(i32, Frame)> = moments
            .iter()
            .map(|(number, scene)| Ok((*number, Frame::new(scene, [1, 1])?)))
            .collect::<Result<_>>()?;
        let voxel = match self.voxel {
            Some(voxel) => voxel,
            None => frames
                .iter()
                .map(|(_, frame)| VoxelGrid::voxel_of(frame, self.resolution))
                .try_fold(0.0, |most: f64, voxel| Ok::<_, Error>(most.max(voxel?)))?,
        };
        let (gpu, count) = (self.source.gpu()?, frames.len() as f64);
        shares("sampling the density", |progress| {
            for (i, (number, frame)) in frames.iter().enumerate() {
                let mut own = |share: f64| progress((i as f64 + share) / count);
                let volume = Voxels::sample(&gpu, frame, self.grid(voxel), &mut own)?;
                write(&pattern.file(*number), &volume)?;
            }
            Ok(())
        })?;
        let (name, voxel) = (self.output.display(), short(voxel));
        terminal::print(&format!("{name}: {count} frames with voxels of {voxel} m\n"))
    }

    fn grid(&self, voxel: f64) -> VoxelGrid {
        let grid = VoxelGrid { samples: self.samples, ..VoxelGrid::new(voxel) };
        if self.up == Up::Z { grid.z_up() } else { grid }
    }
}

/// Writes a volume into a file.
type Write = fn(&Path, &Voxels) -> Result<()>;

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
