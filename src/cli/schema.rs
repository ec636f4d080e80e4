//! `nephos schema`: the JSON Schema of scene files.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::terminal::print;
use crate::Result;
use crate::{files::write_whole, scene::schema};

/// Write the JSON Schema of scene files, for editors and other programs.
#[derive(Debug, Args)]
pub struct Schema {
    /// File to write, replacing it; the standard output where left out or `-`.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Schema {
    /// Writes the schema.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) where the file cannot be written.
    pub fn run(self) -> Result<()> {
        let text = format!("{:#}\n", schema());
        match self.output.as_deref().filter(|path| *path != Path::new("-")) {
            None => print(&text),
            Some(path) => write_whole(path, |file| file.write_all(text.as_bytes())),
        }
    }
}
