//! `nephos bench`: errors and costs of every model in every quality.

use std::{
    io::Write,
    path::PathBuf,
    process::Command,
    time::{SystemTime, UNIX_EPOCH},
};

use clap::{Args, ValueEnum};

use super::{super::open, chosen, march, named};
use crate::{
    Error, Result,
    cli::terminal,
    files::{check_place, write_whole},
    gpu::Gpu,
    measure::{self, Cost, Entry, Known, Reference, Report, Set, Stopwatch, Way},
    render::{Quality, Transport},
};

/// What to measure.
#[derive(Debug, Args)]
pub struct BenchModels {
    /// Part of the names of the pictures; all where left out.
    #[arg(long, value_name = "NAME")]
    filter: Option<String>,
    /// Which pictures: those that models may be fitted to, those held out, or all.
    #[arg(long, value_enum, default_value_t = SetName::All)]
    set: SetName,
    /// Models, with commas between; all where left out.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    models: Vec<String>,
    /// Qualities, with commas between; all where left out.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    qualities: Vec<String>,
    /// Width and height of the pictures that are timed.
    #[arg(long, num_args = 2, value_names = ["WIDTH", "HEIGHT"], default_values_t = [120, 68],
        value_parser = clap::value_parser!(u32).range(1..=4096))]
    timing_size: Vec<u32>,
    /// How often the time of a frame is taken at most; that of light, a third as often. Frames that take
    /// seconds are timed once.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    /// Write what is found as a page, HTML, with the error of the march.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write what is found as JSON.
    #[arg(long)]
    json: bool,
    /// The commit that the program was built from; asked of git where left out.
    #[arg(long)]
    commit: Option<String>,
    /// Where the references are kept.
    #[arg(long, value_name = "FOLDER", default_value = "benches/references")]
    folder: PathBuf,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SetName {
    Fit,
    HeldOut,
    All,
}

/// Pictures that are timed: a small soft cloud and a tall one. Of others only errors are told.
const TIMED: [&str; 2] = ["humilis-front", "congestus-back"];

/// Pictures with their references, and those that lack one, with the reason.
type Measured = (Vec<(Entry, Reference)>, Vec<String>);

impl BenchModels {
    /// Measures.
    ///
    /// # Errors
    /// Where the arguments, the adapter or a file are not good.
    pub fn run(self) -> Result<()> {
        let ways = self.ways()?;
        self.output.iter().try_for_each(|page| check_place(page))?;
        let (measured, left_out) = self.references()?;
        let gpu = open(self.adapter.as_deref())?;
        let mut report = self.report(&gpu, &measured, left_out);
        self.score(&gpu, &measured, &ways, &mut report)?;
        report.costs = self.costs(&gpu, &measured, &ways)?;
        if let Some(path) = &self.output {
            let bar = terminal::progress("marching");
            report.march = march::usual_curves(&gpu, &bar)?;
            bar.finish_and_clear();
            let page = measure::page(&report);
            write_whole(path, |file| file.write_all(page.as_bytes()))?;
        }
        if self.json { terminal::print_json(&report) } else { terminal::print(&report.text()) }
    }

    fn ways(&self) -> Result<Vec<Way>> {
        let models = named(&Transport::entries(), &self.models, "--models")?;
        let qualities = named(&Quality::PRESETS, &self.qualities, "--qualities")?;
        let of = |model| qualities.iter().map(move |&quality| Way { model, quality });
        Ok(models.into_iter().flat_map(of).collect())
    }

    fn references(&self) -> Result<Measured> {
        let (mut measured, mut left_out) = (Vec::new(), Vec::new());
        let wanted = |entry: &Entry| match self.set {
            SetName::Fit => entry.set == Set::Fit,
            SetName::HeldOut => entry.set == Set::HeldOut,
            SetName::All => true,
        };
        for entry in chosen(self.filter.as_deref())?.into_iter().filter(wanted) {
            let path = Reference::path(&self.folder, &entry);
            match Reference::read(&path) {
                Ok(found) if found.scene == entry.scene() => measured.push((entry, found)),
                Ok(_) => left_out.push(format!("{}: its reference is of another scene", entry.name)),
                Err(_) if !path.exists() => left_out.push(format!("{}: it has no reference", entry.name)),
                Err(error) => left_out.push(format!("{}: {error}", entry.name)),
            }
        }
        if measured.is_empty() {
            return Err(Error::Argument(format!(
                "there is nothing to measure against in `{}`: name the project's `benches/references` by \
                --folder, or path trace references by `nephos bench reference`, which takes hours",
                self.folder.display()
            )));
        }
        Ok((measured, left_out))
    }

    fn report(&self, gpu: &Gpu, measured: &[(Entry, Reference)], left_out: Vec<String>) -> Report {
        let known = |(entry, reference): &(Entry, Reference)| Known {
            scene: entry.name,
            samples: reference.samples,
            noise: reference.noise(),
        };
        Report {
            version: env!("CARGO_PKG_VERSION"),
            commit: self.commit.clone().or_else(commit),
            date: now(),
            adapter: gpu.adapter.clone(),
            timing_size: [self.timing_size[0], self.timing_size[1]],
            references: measured.iter().map(known).collect(),
            left_out,
            means: Vec::new(),
            costs: Vec::new(),
            scores: Vec::new(),
            march: Vec::new(),
            views: Vec::new(),
        }
    }

    fn score(
        &self,
        gpu: &Gpu,
        measured: &[(Entry, Reference)],
        ways: &[Way],
        report: &mut Report,
    ) -> Result<()> {
        let bar = terminal::progress("errors");
        bar.set_length((measured.len() * ways.len()) as u64);
        let shown = ways.last().map_or("", |way| way.quality.0);
        let mut renderer = measure::draw::renderer(gpu);
        // What is prepared for a quality serves all models.
        let mut by_quality = ways.to_vec();
        by_quality.sort_by_key(|way| way.quality.0);
        for (entry, reference) in measured {
            bar.set_message(entry.name);
            let (scores, view) =
                measure::score(gpu, &mut renderer, (entry, reference), &by_quality, shown, &mut || {
                    bar.inc(1);
                })?;
            report.scores.extend(scores);
            report.views.push(view);
        }
        bar.finish_and_clear();
        report.means = measure::means(ways, &report.scores);
        Ok(())
    }

    /// Costs of the timed pictures, or where none is wanted, of the first.
    fn costs(&self, gpu: &Gpu, measured: &[(Entry, Reference)], ways: &[Way]) -> Result<Vec<Cost>> {
        let is_timed = |entry: &Entry| TIMED.contains(&entry.name);
        let mut timed: Vec<Entry> = measured.iter().map(|(entry, _)| *entry).filter(is_timed).collect();
        if timed.is_empty() {
            timed.extend(measured.first().map(|(entry, _)| *entry));
        }
        let size = [self.timing_size[0], self.timing_size[1]];
        let watch = Stopwatch { gpu, size, repeats: self.repeats };
        let bar = terminal::progress("times");
        bar.set_length((timed.len() * ways.len()) as u64);
        let mut renderer = measure::draw::renderer(gpu);
        // Games and pictures have air.
        renderer.settings.aerial = true;
        let mut costs = Vec::new();
        for entry in timed {
            bar.set_message(entry.name);
            for way in ways {
                costs.push(watch.cost(&mut renderer, entry.name, &entry.scene(), way)?);
                bar.inc(1);
            }
        }
        bar.finish_and_clear();
        Ok(costs)
    }
}

/// What git says of the folder that this runs in.
pub(super) fn commit() -> Option<String> {
    let output = Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}

pub(super) fn now() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    chrono::DateTime::from_timestamp(seconds as i64, 0).map_or(String::new(), |now| now.to_rfc3339())
}
