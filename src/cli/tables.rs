//! `nephos tables`: makes the tables that this crate embeds, and checks them.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{numbers::seed, terminal};
use crate::files::check_place;
use crate::optics::ice;
use crate::optics::slab::{check, study};
use crate::optics::table::write_mie_table;
use crate::{Error, Result};

/// Make the tables that the program embeds, or check them.
#[derive(Debug, Args)]
pub struct Tables {
    /// What to do.
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Make the table of scattering by water droplets of effective radius 4 to 20 um (takes
    /// some minutes).
    Mie {
        /// File to write.
        #[arg(short, long, default_value = "tables/mie.bin")]
        output: PathBuf,
    },
    /// Make the tables of scattering by ice, snow and graupel (takes some minutes).
    Ice {
        /// File to write.
        #[arg(short, long, default_value = "tables/ice.bin")]
        output: PathBuf,
    },
    /// Make the tables of light in slabs (takes some minutes; a run that was interrupted goes on).
    Slab {
        /// Folder to write to.
        #[arg(short, long, default_value = "tables")]
        output: PathBuf,
        /// Number of the random walks that tell where light enters.
        #[arg(long, default_value_t = study::SEED, value_parser = seed)]
        seed: u64,
    },
    /// Make random parts of the tables of slabs anew and compare.
    Check {
        /// Number of slabs for each table.
        #[arg(long, default_value_t = 4)]
        samples: usize,
        /// Which slabs: another number, other slabs.
        #[arg(long, default_value_t = 0, value_parser = seed)]
        seed: u64,
    },
}

impl Tables {
    /// Does what was asked for.
    ///
    /// # Errors
    /// [`Error::File`] where a file cannot be written, [`Error::Table`] where a table is wrong.
    pub fn run(self) -> Result<()> {
        match self.task {
            Task::Mie { output } => {
                check_place(&output)?;
                with_bar("Mie table", |progress| write_mie_table(&output, progress))
            }
            Task::Ice { output } => {
                check_place(&output)?;
                with_bar("Ice", |progress| ice::write_table(&output, progress))
            }
            Task::Slab { output, seed } => {
                with_bar("Slabs", |progress| study::write_tables(&output, seed, progress))
            }
            Task::Check { samples: 0, .. } => {
                Err(Error::Argument("--samples 0 compares nothing: give 1 or more".to_owned()))
            }
            Task::Check { samples, seed } => {
                let lines = check::run(check::Tables::embedded()?, samples, seed)?;
                terminal::print(&(lines.join("\n") + "\n"))
            }
        }
    }
}

/// Runs work that tells its progress, 0 to 1, under a bar.
fn with_bar(message: &'static str, work: impl FnOnce(&(dyn Fn(f64) + Sync)) -> Result<()>) -> Result<()> {
    let bar = terminal::progress(message);
    // Threads report out of order; the bar only goes forward.
    work(&|share| bar.set_position(bar.position().max((1000.0 * share) as u64)))?;
    bar.finish_and_clear();
    Ok(())
}
