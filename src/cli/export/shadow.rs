//! `nephos export shadow`: the shadows of clouds on the ground.

use std::path::PathBuf;

use clap::Args;
use glam::DVec3;

use super::{
    super::{
        numbers::{above_zero, number, numbers},
        terminal,
    },
    Source, ending,
};
use crate::{
    Result,
    export::{Studio, write_grey, write_named},
    files::check_place,
};

/// Write how much sunlight the clouds let through to a horizontal square, from 0 to 1.
///
/// North (-z) is on top and east (+x) to the right; pixel (i, j) of N has the middle x = X + EXTENT ((i + 0.5) / N - 0.5),
/// z = Z + EXTENT ((j + 0.5) / N - 0.5). It is what the
/// opacity of pictures leaves: light that droplets turn by less than 8 degrees counts as let through. The air's own
/// haze is left out, and the sun is a point.
#[derive(Debug, Args)]
pub struct Shadow {
    #[command(flatten)]
    source: Source,
    /// Map to write: .exr (channel Y) or .png (16 bits of grey, linear).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Pixels along an edge.
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=4096))]
    size: u32,
    /// Edge of the square; left out, it holds the shadows of all clouds.
    #[arg(long, value_name = "METRES", value_parser = above_zero)]
    extent: Option<f64>,
    /// Middle of the square; left out, it is in the middle of the shadows.
    #[arg(long, value_name = "X,Z", value_parser = numbers::<2>, allow_hyphen_values = true)]
    center: Option<[f64; 2]>,
    /// Height of the square; left out, that of the ground.
    #[arg(long, value_name = "METRES", value_parser = number)]
    altitude: Option<f64>,
}

impl Shadow {
    pub(super) fn run(self) -> Result<()> {
        let kind = ending(&self.output, &["exr", "png"])?;
        check_place(&self.output)?;
        let scene = self.source.scene()?;
        let altitude = self.altitude.unwrap_or(scene.ground.altitude);
        let mut studio = Studio::new(&self.source.gpu()?, 2, false);
        let told = self.center.map(|[x, z]| DVec3::new(x, altitude, z));
        let (center, extent) = match (told, self.extent) {
            (Some(center), Some(extent)) => (center, extent),
            (center, extent) => {
                let (middle, across) = studio.shadows_of(&scene, altitude)?;
                (center.unwrap_or(middle), extent.unwrap_or(across))
            }
        };
        let shares = studio.sunlight_on(&scene, center, extent, self.size)?;
        match kind {
            "exr" => {
                let size = [self.size as usize; 2];
                write_named(&self.output, size, &[("Y".to_owned(), shares)])?;
            }
            _ => write_grey(&self.output, [self.size; 2], &shares)?,
        }
        terminal::print(&format!(
            "{}: {extent:.1} m around x {:.1} z {:.1} at y {altitude:.1}\n",
            self.output.display(),
            center.x,
            center.z
        ))
    }
}
