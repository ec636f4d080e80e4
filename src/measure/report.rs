//! What a benchmark found, for machines and as text.

use std::fmt::Write;

use super::{Cost, MarchPoint, Mean, Score, Set, View};
use crate::gpu::AdapterSummary;

/// A benchmark.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Report {
    /// Version of the program.
    pub version: &'static str,
    /// The commit it was built from, as far as known.
    pub commit: Option<String>,
    /// Date and time, RFC 3339.
    pub date: String,
    /// The graphics adapter.
    pub adapter: AdapterSummary,
    /// Size of the timed pictures, pixels.
    pub timing_size: [u32; 2],
    /// The references that were measured against.
    pub references: Vec<Known>,
    /// Pictures of the corpus that could not be measured, with the reason.
    pub left_out: Vec<String>,
    /// Means over the sets.
    pub means: Vec<Mean>,
    /// Cost of each way of drawing the timed pictures.
    pub costs: Vec<Cost>,
    /// Errors of each picture.
    pub scores: Vec<Score>,
    /// Errors of the march.
    pub march: Vec<MarchPoint>,
    /// Pictures for people.
    #[serde(skip)]
    pub views: Vec<View>,
}

/// What a reference is known by.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Known {
    /// Name of the picture.
    pub scene: &'static str,
    /// Samples of each pixel.
    pub samples: u32,
    /// Relative noise.
    pub noise: f64,
}

/// Mean cost over the timed pictures.
#[derive(Debug, Clone, Copy, Default)]
pub struct MeanCost {
    /// Frame, milliseconds.
    pub frame_ms: f64,
    /// Light, milliseconds.
    pub light_ms: f64,
    /// Evaluations of the density and reads, by pixel.
    pub work: f64,
}

impl Report {
    /// Mean cost of one way of drawing; none where nothing was timed.
    pub fn cost(&self, model: &str, quality: &str) -> Option<MeanCost> {
        let costs: Vec<&Cost> =
            self.costs.iter().filter(|cost| (cost.model, cost.quality) == (model, quality)).collect();
        let mean = |value: fn(&Cost) -> f64| {
            costs.iter().map(|&cost| value(cost)).sum::<f64>() / costs.len().max(1) as f64
        };
        (!costs.is_empty()).then(|| MeanCost {
            frame_ms: mean(|cost| cost.frame_ms),
            light_ms: mean(|cost| cost.light_ms),
            work: mean(|cost| cost.work.total()),
        })
    }

    /// Mean errors of one way of drawing over a set.
    pub fn mean(&self, model: &str, quality: &str, set: Set) -> Option<&Mean> {
        self.means.iter().find(|mean| (mean.model, mean.quality, mean.set) == (model, quality, set))
    }

    /// Models and qualities, in the order in which they were measured.
    pub fn ways(&self) -> Vec<(&'static str, &'static str)> {
        let mut ways = Vec::new();
        for mean in &self.means {
            if !ways.contains(&(mean.model, mean.quality)) {
                ways.push((mean.model, mean.quality));
            }
        }
        ways
    }

    /// A table for terminals.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:<16}{:<9}{:<10}{:>7}{:>8}{:>8}{:>8}{:>8}{:>7}{:>7}{:>6}{:>6}{:>6}{:>10}{:>10}{:>9}\n",
            "model",
            "quality",
            "set",
            "rmse",
            "pooled",
            "mean",
            "p95",
            "bias",
            "psnr",
            "flip",
            "c1.5",
            "c3",
            "c6",
            "frame ms",
            "light ms",
            "work/px"
        );
        for mean in &self.means {
            text += &self.line(mean);
        }
        for reason in &self.left_out {
            text += &format!("left out: {reason}\n");
        }
        text + &self.legend()
    }

    /// What the columns are, and how far the references are to be trusted.
    fn legend(&self) -> String {
        let mut noise: Vec<f64> = self.references.iter().map(|known| known.noise).collect();
        noise.sort_by(f64::total_cmp);
        let (Some(worst), middle) = (noise.last(), noise.len() / 2) else { return String::new() };
        format!(
            "rmse, mean and p95 of |error|, and bias are shares of the clouds' light; pooled is the root of the \
             mean squared rmse.\nc1.5, c3 and c6: relief inside clouds between blurs of so many pixels and twice that, over the reference's.\nThe noise of the {} references, {:.2} in the median picture and {worst:.2} \
             at most, is taken off; psnr and flip keep it.\nwork/px: evaluations of the density and reads of noise, \
             maps and tables. docs/benchmark.md has the definitions.\n",
            noise.len(),
            noise[middle],
        )
    }

    fn line(&self, mean: &Mean) -> String {
        let (e, set) = (&mean.errors, mean.set);
        let mut line = format!(
            "{:<16}{:<9}{set:<10}{:>7.3}{:>8.3}{:>8.3}{:>8.3}{:>+8.3}{:>7.1}{:>7.3}",
            mean.model,
            mean.quality,
            e.rmse,
            mean.pooled_rmse,
            e.mean_relative,
            e.p95_relative,
            e.bias,
            e.psnr,
            e.flip
        );
        // A string takes whatever it is given.
        for ratio in e.contrast {
            let _ = write!(line, "{:>6}", ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.2}")));
        }
        if let Some(cost) = self.cost(mean.model, mean.quality) {
            let _ = write!(line, "{:>10.1}{:>10.1}{:>9.0}", cost.frame_ms, cost.light_ms, cost.work);
        }
        line + "\n"
    }
}

/// A table of errors of the march.
pub fn march_text(points: &[MarchPoint]) -> String {
    let mut text = format!(
        "{:<18}{:<16}{:<12}{:>9}{:>11}{:>13}\n",
        "scene", "model", "steps", "rmse", "steps/px", "density/px"
    );
    for p in points {
        let steps = p.quality.map_or_else(|| format!("x {}", p.scale.unwrap_or(1.0)), str::to_owned);
        text += &format!(
            "{:<18}{:<16}{steps:<12}{:>9.5}{:>11.1}{:>13.1}\n",
            p.scene, p.model, p.rmse, p.work.steps, p.work.density
        );
    }
    text
}
