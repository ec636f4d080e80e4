//! `nephos info`: the adapters of this machine.

use clap::Args;

use super::terminal::{print, print_json};
use crate::{Result, gpu};

/// List the graphics adapters, best first.
#[derive(Debug, Args)]
pub struct Info {
    /// Write JSON.
    #[arg(long)]
    json: bool,
}

impl Info {
    /// Lists them.
    ///
    /// # Errors
    /// Where the standard output can't be written.
    pub fn run(self) -> Result<()> {
        let adapters = pollster::block_on(gpu::adapters());
        if self.json {
            return print_json(&adapters);
        }
        if adapters.is_empty() {
            // Opening one tells what is missing.
            return pollster::block_on(gpu::Gpu::open(None)).map(drop);
        }
        let line =
            |a: &gpu::AdapterSummary| format!("{}  ({}, {}, {})\n", a.name, a.kind, a.backend, a.driver);
        print(&adapters.iter().map(line).collect::<String>())
    }
}
