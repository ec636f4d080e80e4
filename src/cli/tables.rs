//! `nephos tables`: makes the tables that this crate embeds.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::terminal;
use crate::{Result, optics::table::write_mie_table};

/// Make the tables that the program embeds.
#[derive(Debug, Args)]
pub struct Tables {
    /// Which table to make.
    #[command(subcommand)]
    table: Table,
}

#[derive(Debug, Subcommand)]
enum Table {
    /// Scattering by water droplets of effective radius 4 to 20 um (takes some minutes).
    Mie {
        /// File to write.
        #[arg(short, long, default_value = "tables/mie.bin")]
        output: PathBuf,
    },
}

impl Tables {
    /// Makes the table that was asked for.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) where the file cannot be written.
    pub fn run(self) -> Result<()> {
        let Table::Mie { output } = self.table;
        let bar = terminal::progress("Mie table");
        // Threads report out of order; the bar only goes forward.
        write_mie_table(&output, |share| bar.set_position(bar.position().max((1000.0 * share) as u64)))?;
        bar.finish_and_clear();
        Ok(())
    }
}
