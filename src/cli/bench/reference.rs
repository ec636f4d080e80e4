//! `nephos bench reference`: path traces what the models are measured against.

use std::{fs, path::PathBuf, time::Duration};

use clap::Args;

use super::{super::open, chosen};
use crate::{
    Error, Result,
    cli::{
        numbers::{above_zero, share},
        terminal,
    },
    gpu::Gpu,
    measure::{Entry, Limits, Reference, SEED},
};

/// Path trace the references: those that are missing, of another scene, or too noisy, which are
/// gone on with.
#[derive(Debug, Args)]
pub struct MakeReferences {
    /// Part of the names of the pictures; all where left out.
    #[arg(long, value_name = "NAME")]
    filter: Option<String>,
    /// Relative noise at which a picture is done.
    #[arg(long, default_value_t = 0.05, value_parser = share)]
    noise: f64,
    /// Most samples of each pixel.
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(3..=10_000_000))]
    samples: u32,
    /// Most seconds for each picture.
    #[arg(long, default_value_t = 3600.0, value_parser = above_zero)]
    seconds: f64,
    /// Make those again from the beginning that are there.
    #[arg(long)]
    force: bool,
    /// Where the references are kept.
    #[arg(long, value_name = "FOLDER", default_value = "benches/references")]
    folder: PathBuf,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

impl MakeReferences {
    /// Makes them.
    ///
    /// # Errors
    /// Where the arguments, the adapter or a file are not good.
    pub fn run(self) -> Result<()> {
        let entries = chosen(self.filter.as_deref())?;
        let time = Duration::from_secs_f64(self.seconds);
        let limits = Limits { noise: self.noise, samples: self.samples, time };
        fs::create_dir_all(&self.folder).map_err(|source| Error::File {
            action: "create",
            path: self.folder.clone(),
            source,
        })?;
        let gpu = open(self.adapter.as_deref())?;
        for entry in &entries {
            self.make(&gpu, entry, &limits)?;
        }
        Ok(())
    }

    fn make(&self, gpu: &Gpu, entry: &Entry, limits: &Limits) -> Result<()> {
        let (path, scene) = (Reference::path(&self.folder, entry), entry.scene());
        let found = Reference::read(&path).ok().filter(|found| !self.force && found.scene == scene);
        let is_done = |found: &Reference| found.samples >= limits.samples || found.noise() <= limits.noise;
        if found.as_ref().is_some_and(is_done) {
            return terminal::print(&format!("{}: there already\n", entry.name));
        }
        let bar = terminal::progress(entry.name);
        let reference = Reference::trace(gpu, &scene, SEED, limits, found, &mut |progress| {
            bar.set_position((1000.0 * progress.share) as u64);
            bar.set_message(format!(
                "{} {} samples, noise {:.3}",
                entry.name, progress.samples, progress.noise
            ));
        })?;
        bar.finish_and_clear();
        reference.write(&path)?;
        terminal::print(&format!(
            "{}: {} samples, noise {:.3}, {:.0} s\n",
            entry.name,
            reference.samples,
            reference.noise(),
            bar.elapsed().as_secs_f64()
        ))
    }
}
