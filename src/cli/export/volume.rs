//! `nephos export volume`: the density in voxels.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    super::{numbers::above_zero, terminal},
    Source, ending, shares,
};
use crate::{
    Result,
    export::{write_vdb, write_vol},
    files::check_place,
    render::{Frame, VoxelGrid, Voxels},
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
    /// Volume to write: .vdb (OpenVDB) or .vol (Mitsuba).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
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
        let write = match ending(&self.output, &["vdb", "vol"])? {
            "vdb" => write_vdb,
            _ => write_vol,
        };
        check_place(&self.output)?;
        let frame = Frame::new(&self.source.scene()?, [1, 1])?;
        let voxel = self.voxel.map_or_else(|| VoxelGrid::voxel_of(&frame, self.resolution), Ok)?;
        let grid = VoxelGrid { samples: self.samples, ..VoxelGrid::new(voxel) };
        let grid = if self.up == Up::Z { grid.z_up() } else { grid };
        let gpu = self.source.gpu()?;
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
            (1e4 * voxel).round() / 1e4,
            volume.filled().count()
        ))
    }
}
