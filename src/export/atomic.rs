//! Files that are whole or not there.

use std::{
    ffi::OsString,
    fs, io,
    path::{Path, PathBuf},
};

use crate::{Error, Result};

/// Has `write` make a file beside `path`, then puts it in its place in one step: a
/// failure leaves what was there before.
///
/// # Errors
/// [`Error::File`] with the path that was asked for.
pub fn write_atomically(path: &Path, write: impl FnOnce(&Path) -> io::Result<()>) -> Result<()> {
    let temporary = beside(path);
    let result = write(&temporary).and_then(|()| fs::rename(&temporary, path));
    result.map_err(|source| {
        // Already failing: a left-over that can't be removed either changes nothing.
        let _ = fs::remove_file(&temporary);
        Error::File { action: "write", path: path.to_owned(), source }
    })
}

fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}
