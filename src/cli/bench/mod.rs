//! `nephos bench`: errors of the renderer against path traced truth, and its cost.

mod reference;

use clap::{Args, Subcommand};

use crate::{
    Error, Result,
    measure::{CORPUS, Entry},
};

/// Measure the renderer against path traced references.
#[derive(Debug, Args)]
pub struct Bench {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Reference(reference::MakeReferences),
}

impl Bench {
    /// Measures.
    ///
    /// # Errors
    /// Where the arguments, the adapter or a file are not good.
    pub fn run(self) -> Result<()> {
        match self.what {
            What::Reference(command) => command.run(),
        }
    }
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
