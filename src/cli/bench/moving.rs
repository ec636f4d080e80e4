//! `nephos bench moving`: light that is kept while things move.

use clap::Args;

use super::{
    super::open,
    Told,
    models::commit,
    models::now,
    named,
    speed::{scene_of, size_of},
};
use crate::{
    Result,
    cli::terminal,
    measure::{Change, MovingReport, Shift},
    render::Quality,
};

/// Measure what light that is kept while the sun turns or noise wanders is off by, and what it saves.
#[derive(Debug, Args)]
pub struct BenchMoving {
    /// Scenes, with commas between: names of presets, and clouds-N for N cumuli of 16 ellipsoids (1 to 4096).
    #[arg(long, value_delimiter = ',', value_name = "NAMES",
        default_values_t = ["humilis", "congestus"].map(str::to_owned))]
    scenes: Vec<String>,
    /// Qualities, with commas between.
    #[arg(long, value_delimiter = ',', value_name = "NAMES", default_values_t = ["draft".to_owned()])]
    qualities: Vec<String>,
    /// By how many degrees the sun may turn before light is made anew, with commas between, 0 (exact) to 90.
    #[arg(long, value_delimiter = ',', value_name = "DEGREES", value_parser = slack,
        default_values_t = [0.0, 0.5, 1.0, 2.0, 4.0])]
    slack: Vec<f64>,
    /// Width and height of the pictures: 720p, 1080p, 4k or WIDTHxHEIGHT.
    #[arg(long, value_name = "SIZE", default_value = "160x90")]
    size: String,
    /// Frames of each row.
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    #[command(flatten)]
    told: Told,
}

impl BenchMoving {
    /// Measures.
    ///
    /// # Errors
    /// Where the arguments or the adapter are not good.
    pub fn run(self) -> Result<()> {
        let qualities = named(&Quality::PRESETS, &self.qualities, "--qualities")?;
        let scenes = self.scenes.iter().map(|name| scene_of(name)).collect::<Result<Vec<_>>>()?;
        let size = size_of(&self.size, "--size")?;
        let gpu = open(self.told.adapter.as_deref())?;
        let bar = terminal::progress("rows");
        bar.set_length((scenes.len() * qualities.len() * Change::ALL.len() * self.slack.len()) as u64);
        let shift = Shift { gpu: &gpu, size, frames: self.frames };
        let mut rows = Vec::new();
        for (name, scene) in self.scenes.iter().zip(&scenes) {
            for &quality in &qualities {
                for change in Change::ALL {
                    rows.extend(shift.rows((name, scene), quality, change, &self.slack, &mut || bar.inc(1))?);
                }
            }
        }
        bar.finish_and_clear();
        let report = MovingReport {
            version: env!("CARGO_PKG_VERSION"),
            commit: self.told.commit.clone().or_else(commit),
            date: now(),
            adapter: gpu.adapter.clone(),
            frames: self.frames,
            size,
            rows,
        };
        if self.told.json { terminal::print_json(&report) } else { terminal::print(&report.text()) }
    }
}

fn slack(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|degrees| (0.0..=90.0).contains(degrees));
    number.ok_or_else(|| format!("`{text}` is no number from 0 to 90"))
}
