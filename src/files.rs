//! Files that are whole or not there.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    process,
    sync::atomic::{AtomicU32, Ordering},
};

use crate::{Error, Result};

/// Has `write` fill a new file beside `path`, then gives it that name: a failure leaves
/// what was there before.
///
/// # Errors
/// [`Error::File`] with the path that was asked for.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    // The file behind a link is replaced, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if fs::metadata(&target).is_ok_and(|found| !found.is_file()) {
        // A device or a pipe takes what it is given; a folder says that it is one.
        return write_through(&target, write).map_err(failed(path));
    }
    let beside = name_beside(&target);
    let written = write_new(&beside, write).and_then(|()| fs::rename(&beside, &target));
    written.map_err(|source| {
        // The first error is the one to tell; a leftover is no more than untidy.
        let _ = fs::remove_file(&beside);
        failed(path)(source)
    })
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> Error {
    |source| match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.exists() => Error::Argument(format!(
            "cannot write `{}`: there is no folder `{}`; make it first",
            path.display(),
            folder.display()
        )),
        _ => Error::File { action: "write", path: path.to_owned(), source },
    }
}

fn write_through(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::new(File::options().write(true).open(path)?);
    write(&mut file)?;
    file.flush()
}

fn write_new(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::new(File::create_new(path)?);
    write(&mut file)?;
    file.flush()?;
    file.get_ref().sync_all()
}

/// A hidden name in the folder of `target` that no other writer uses.
pub fn name_beside(target: &Path) -> PathBuf {
    static WRITES: AtomicU32 = AtomicU32::new(0);
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let write = WRITES.fetch_add(1, Ordering::Relaxed);
    target.with_file_name(format!(".{name}.{}-{write}.tmp", process::id()))
}
