//! `nephos bench march`: error of the march apart from that of the model.

use clap::Args;
use indicatif::ProgressBar;

use super::{super::open, chosen, named};
use crate::{
    Result,
    cli::terminal,
    gpu::Gpu,
    measure::{self, CORPUS, MARCH_PICTURES, MarchPoint},
    render::Transport,
};

/// Measure what the length of the steps costs and what error it makes, the model being the same.
#[derive(Debug, Args)]
pub struct BenchMarch {
    /// Part of the names of the pictures; humilis-front and congestus-back where left out.
    #[arg(long, value_name = "NAME")]
    filter: Option<String>,
    /// Models, with commas between; single and the default where left out.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    models: Vec<String>,
    /// Write what is found as JSON.
    #[arg(long)]
    json: bool,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// A cloud with soft edges, and one with many hard ones that the sun shines through.
const SCENES: [&str; 2] = ["humilis-front", "congestus-back"];

impl BenchMarch {
    /// Measures.
    ///
    /// # Errors
    /// Where the arguments or the adapter are not good.
    pub fn run(self) -> Result<()> {
        let entries = match &self.filter {
            Some(part) => chosen(Some(part))?,
            None => CORPUS.into_iter().filter(|entry| SCENES.contains(&entry.name)).collect(),
        };
        let models = if self.models.is_empty() {
            usual_models()
        } else {
            named(&Transport::entries(), &self.models, "--models")?
        };
        let gpu = open(self.adapter.as_deref())?;
        let bar = terminal::progress("marching");
        let points = curves(&gpu, &entries, &models, &bar)?;
        bar.finish_and_clear();
        if self.json { terminal::print_json(&points) } else { terminal::print(&measure::march_text(&points)) }
    }
}

/// The march of the pictures that are measured when none is named.
pub(super) fn usual_curves(gpu: &Gpu, bar: &ProgressBar) -> Result<Vec<MarchPoint>> {
    let entries: Vec<_> = CORPUS.into_iter().filter(|entry| SCENES.contains(&entry.name)).collect();
    curves(gpu, &entries, &usual_models(), bar)
}

fn usual_models() -> Vec<(&'static str, Transport)> {
    let wanted = [Transport::SINGLE, Transport::default()];
    Transport::entries().into_iter().filter(|(_, model)| wanted.contains(model)).collect()
}

fn curves(
    gpu: &Gpu,
    entries: &[measure::Entry],
    models: &[(&'static str, Transport)],
    bar: &ProgressBar,
) -> Result<Vec<MarchPoint>> {
    bar.set_length((entries.len() * models.len() * MARCH_PICTURES) as u64);
    bar.set_position(0);
    let mut renderer = measure::draw::renderer(gpu);
    let mut points = Vec::new();
    for entry in entries {
        let scene = entry.scene();
        for &model in models {
            let found = measure::curve(gpu, &mut renderer, (entry.name, &scene), model, &mut || bar.inc(1))?;
            points.extend(found);
        }
    }
    Ok(points)
}
