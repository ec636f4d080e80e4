//! `nephos bench`: errors of the renderer against path traced truth, and its cost.

mod march;
mod models;
mod moving;
mod reference;
mod speed;

use clap::{Args, Subcommand};

use crate::{
    Error, Result,
    measure::{CORPUS, Entry},
};

/// Measure every transport model against path traced references, and its cost.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Bench {
    #[command(subcommand)]
    what: Option<What>,
    #[command(flatten)]
    models: models::BenchModels,
}

#[derive(Debug, Subcommand)]
enum What {
    Reference(reference::MakeReferences),
    March(march::BenchMarch),
    Speed(speed::BenchSpeed),
    Moving(moving::BenchMoving),
}

impl Bench {
    /// Measures.
    ///
    /// # Errors
    /// Where the arguments, the adapter or a file are not good.
    pub fn run(self) -> Result<()> {
        match self.what {
            Some(What::Reference(command)) => command.run(),
            Some(What::March(command)) => command.run(),
            Some(What::Speed(command)) => command.run(),
            Some(What::Moving(command)) => command.run(),
            None => self.models.run(),
        }
    }
}

/// On what is measured, and how it is told.
#[derive(Debug, Args)]
struct Told {
    /// Write what is found as JSON to the standard output.
    #[arg(long)]
    json: bool,
    /// The commit that the program was built from; asked of git where left out.
    #[arg(long)]
    commit: Option<String>,
    /// Part of the name of the adapter to use; `nephos info` lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// The pictures of the corpus that have `part` in their names.
fn chosen(part: Option<&str>) -> Result<Vec<Entry>> {
    let part = part.unwrap_or_default();
    let entries: Vec<Entry> = CORPUS.into_iter().filter(|entry| entry.name.contains(part)).collect();
    if entries.is_empty() {
        let names = CORPUS.map(|entry| entry.name).join(", ");
        return Err(Error::Argument(format!("no picture has `{part}` in its name: there are {names}")));
    }
    Ok(entries)
}

/// The values of `all` with the `wanted` names; all of them where none is wanted.
fn named<T: Copy>(
    all: &[(&'static str, T)],
    wanted: &[String],
    option: &str,
) -> Result<Vec<(&'static str, T)>> {
    for name in wanted {
        if !all.iter().any(|(known, _)| known == name) {
            let names = all.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
            return Err(Error::Argument(format!("{option} knows no `{name}`: there are {names}")));
        }
    }
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name);
    Ok(all.iter().filter(|(name, _)| is_wanted(name)).copied().collect())
}
