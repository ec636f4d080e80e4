//! `nephos bench speed`: how fast frames are that follow one another.

use std::{io::Write, path::PathBuf, str::FromStr};

use clap::Args;

use super::{super::open, Told, models::commit, models::now, named};
use crate::{
    Error, Result,
    cli::{numbers::above_zero, terminal},
    files::{check_place, write_whole},
    measure::{self, MOST_CLOUDS, Motion, SpeedReport, Track},
    render::Quality,
    scene::{Preset, Scene},
};

/// Measure frames as games draw them, one after another: time of the CPU and of the GPU, work, and memory.
#[derive(Debug, Args)]
pub struct BenchSpeed {
    /// Scenes, with commas between: names of presets, and clouds-N for N cumuli of 16 ellipsoids (1 to 4096).
    #[arg(long, value_delimiter = ',', value_name = "NAMES",
        default_values_t = ["humilis", "congestus", "field", "clouds-100"].map(str::to_owned))]
    scenes: Vec<String>,
    /// Qualities, with commas between.
    #[arg(long, value_delimiter = ',', value_name = "NAMES", default_values_t = ["draft".to_owned()])]
    qualities: Vec<String>,
    /// Sizes of the pictures, with commas between: 720p, 1080p, 4k or WIDTHxHEIGHT.
    #[arg(long, value_delimiter = ',', value_name = "SIZES", default_values_t = ["160x90".to_owned()])]
    sizes: Vec<String>,
    /// How many frames each median is of.
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// What the adapter can do, billions of operations on numbers of 32 bits a second: to tell pixels a second for each.
    #[arg(long, value_name = "N", value_parser = above_zero)]
    gflops: Option<f64>,
    /// Write what is found as JSON (.json) or as a page (.html).
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    told: Told,
}

impl BenchSpeed {
    /// Measures.
    ///
    /// # Errors
    /// Where the arguments, the adapter or a file are not good.
    pub fn run(self) -> Result<()> {
        let qualities = named(&Quality::PRESETS, &self.qualities, "--qualities")?;
        let sizes = self.sizes.iter().map(|size| size_of(size, "--sizes")).collect::<Result<Vec<_>>>()?;
        let scenes = self.scenes.iter().map(|name| scene_of(name)).collect::<Result<Vec<_>>>()?;
        let kind = self.output.as_deref().map(Kind::of).transpose()?;
        self.output.iter().try_for_each(|file| check_place(file))?;
        let gpu = open(self.told.adapter.as_deref())?;
        let mut report = SpeedReport {
            version: env!("CARGO_PKG_VERSION"),
            commit: self.told.commit.clone().or_else(commit),
            date: now(),
            adapter: gpu.adapter.clone(),
            gflops: self.gflops,
            frames: self.frames,
            speeds: Vec::new(),
        };
        let bar = terminal::progress("frames");
        bar.set_length((scenes.len() * sizes.len() * qualities.len() * Motion::ALL.len()) as u64);
        for (name, scene) in self.scenes.iter().zip(&scenes) {
            for &size in &sizes {
                let track = Track { gpu: &gpu, size, frames: self.frames };
                for &quality in &qualities {
                    report.speeds.extend(track.speeds((name, scene), quality, &mut || bar.inc(1))?);
                }
            }
        }
        bar.finish_and_clear();
        if let (Some(path), Some(kind)) = (&self.output, kind) {
            let text = kind.text(&report)?;
            write_whole(path, |file| file.write_all(text.as_bytes()))?;
        }
        if self.told.json { terminal::print_json(&report) } else { terminal::print(&report.text()) }
    }
}

/// What a file is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Json,
    Page,
}

impl Kind {
    fn of(path: &std::path::Path) -> Result<Self> {
        match path.extension().and_then(|end| end.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("json") => Ok(Self::Json),
            Some("html" | "htm") => Ok(Self::Page),
            _ => Err(Error::Argument(format!(
                "`{}` is neither JSON nor a page: name a file that ends in .json or .html",
                path.display()
            ))),
        }
    }

    fn text(self, report: &SpeedReport) -> Result<String> {
        match self {
            Self::Json => terminal::json(report),
            Self::Page => Ok(measure::speed_page(report)),
        }
    }
}

/// Widest and highest picture, pixels: what every device can draw into.
const MOST: u32 = 8192;

pub(super) fn size_of(text: &str, option: &str) -> Result<[u32; 2]> {
    let known = [("720p", [1280, 720]), ("1080p", [1920, 1080]), ("4k", [3840, 2160])];
    if let Some((_, size)) = known.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)) {
        return Ok(*size);
    }
    let number = |text: &str| u32::from_str(text).ok().filter(|n| (1..=MOST).contains(n));
    let size = text.split_once(['x', 'X']).and_then(|(w, h)| Some([number(w)?, number(h)?]));
    size.ok_or_else(|| {
        Error::Argument(format!(
            "{option} knows no `{text}`: there are 720p, 1080p, 4k, and WIDTHxHEIGHT with numbers from 1 to {MOST}"
        ))
    })
}

pub(super) fn scene_of(name: &str) -> Result<Scene> {
    if let Some(preset) = Preset::ALL.into_iter().find(|preset| preset.name() == name) {
        return Ok(preset.scene(1));
    }
    let count = name.strip_prefix("clouds-").and_then(|count| count.parse().ok());
    count.filter(|count| (1..=MOST_CLOUDS).contains(count)).map(measure::crowd).ok_or_else(|| {
        let names = Preset::ALL.map(Preset::name).join(", ");
        Error::Argument(format!(
            "--scenes knows no `{name}`: there are clouds-1 to clouds-{MOST_CLOUDS}, and {names}"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_scenes_are_read_or_told() {
        assert_eq!(size_of("1080p", "--sizes").unwrap(), [1920, 1080]);
        assert_eq!(size_of("32x18", "--sizes").unwrap(), [32, 18]);
        assert_eq!(scene_of("clouds-7").unwrap().clouds.len(), 7);
        assert!(!scene_of("field").unwrap().clouds.is_empty());
        for wrong in ["32", "0x9", "9000x9", "axb"] {
            assert!(size_of(wrong, "--sizes").unwrap_err().to_string().contains(&format!("`{wrong}`")));
        }
        for wrong in ["clouds-0", "clouds-4097", "clouds-", "nothing"] {
            assert!(scene_of(wrong).unwrap_err().to_string().contains(&format!("`{wrong}`")));
        }
    }
}
