//! `nephos tables`: makes the tables that this crate embeds.

use std::path::PathBuf;

use crate::Result;
use crate::optics::table::write_mie_table;
use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

/// Steps of the progress bar.
const STEPS: u64 = 1000;

/// Make the tables that the program embeds
#[derive(Debug, Args)]
pub struct TablesArgs {
    /// Which table to make
    #[command(subcommand)]
    table: Table,
}

#[derive(Debug, Subcommand)]
enum Table {
    /// Scattering by water droplets of effective radius 4 to 20 um (takes some minutes)
    Mie {
        /// File to write
        #[arg(short, long, default_value = "tables/mie.bin")]
        output: PathBuf,
    },
}

/// Makes the table that was asked for.
pub fn run(args: &TablesArgs) -> Result<()> {
    match &args.table {
        Table::Mie { output } => {
            let bar = ProgressBar::new(STEPS)
                .with_style(style())
                .with_message("Mie table");
            // Threads report out of order; the bar only goes forward.
            write_mie_table(output, |share| {
                bar.set_position(bar.position().max((share * STEPS as f64) as u64));
            })?;
            bar.finish_and_clear();
        }
    }
    Ok(())
}

/// What the bar looks like.
fn style() -> ProgressStyle {
    ProgressStyle::with_template("{msg} {wide_bar} {percent} % {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}
