//! Files that are whole or not there.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    process,
    sync::atomic::{AtomicU32, Ordering},
};

use crate::{Error, Result};

/// Links that lead to links, at most, as systems have it.
const MOST_LINKS: usize = 40;

/// A file under way: it lies beside the one that it will be, and is gone when it is dropped before that.
pub struct Beside {
    /// What was asked for, and the file behind it where that is a link.
    asked: PathBuf,
    target: PathBuf,
    path: PathBuf,
}

impl Beside {
    /// Makes an empty file beside `asked`.
    ///
    /// # Errors
    /// [`Error::Argument`] and [`Error::File`] with the path that was asked for: where there is no such folder, or
    /// nothing can be written into it.
    pub fn new(asked: &Path) -> Result<Self> {
        let target = behind_links(asked);
        let new = Self { path: name_beside(&target), asked: asked.to_owned(), target };
        // Systems that have no such long names say so here.
        if let Err(source) = fs::metadata(&new.target)
            && source.kind() != io::ErrorKind::NotFound
        {
            return Err(failed(asked)(source));
        }
        File::create_new(&new.path).map_err(failed(asked))?;
        Ok(new)
    }

    /// Where it is now.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it its name, in place of an old file, whose mode it takes.
    ///
    /// # Errors
    /// [`Error::File`] with the path that was asked for.
    pub fn keep(self) -> Result<()> {
        let finish = || {
            File::options().write(true).open(&self.path)?.sync_all()?;
            if let Ok(old) = fs::metadata(&self.target) {
                fs::set_permissions(&self.path, old.permissions())?;
            }
            fs::rename(&self.path, &self.target)
        };
        finish().map_err(failed(&self.asked))
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // It has its name, or a leftover is no more than untidy.
        let _ = fs::remove_file(&self.path);
    }
}

/// Has `write` fill a new file beside `path`, then gives it that name: a failure leaves
/// what was there before.
///
/// # Errors
/// [`Error::File`] with the path that was asked for.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    if is_no_file(path) {
        // A device or a pipe takes what it is given; a folder says that it is one.
        return write_through(path, write).map_err(failed(path));
    }
    let beside = Beside::new(path)?;
    write_through(beside.path(), write).map_err(failed(path))?;
    beside.keep()
}

/// Whether a file can be written, to be asked before the work for it is done.
///
/// # Errors
/// [`Error::Argument`] and [`Error::File`] as writing it would have.
#[cfg(feature = "cli")]
pub fn check_place(path: &Path) -> Result<()> {
    if path.is_dir() {
        return Err(Error::Argument(format!("`{}` is a folder: name a file in it", path.display())));
    }
    if is_no_file(path) { Ok(()) } else { Beside::new(path).map(drop) }
}

/// Whether something is there that is no file, but takes bytes as it may.
fn is_no_file(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file())
}

/// The file that a link stands for, whether it is there or not: it is replaced, and not the link.
fn behind_links(path: &Path) -> PathBuf {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&target) else { break };
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    target
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

/// A hidden name in the folder of `target` that no other writer uses, and short: that of `target` may be as
/// long as names can be.
fn name_beside(target: &Path) -> PathBuf {
    static WRITES: AtomicU32 = AtomicU32::new(0);
    let write = WRITES.fetch_add(1, Ordering::Relaxed);
    target.with_file_name(format!(".nephos-{}-{write}.tmp", process::id()))
}
