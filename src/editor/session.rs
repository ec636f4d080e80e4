//! The file that is edited, and the copy that survives a crash.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

use super::{
    Document,
    recovery::{Kept, Recovery},
    settings::Places,
};
use crate::{Error, Result, scene::Scene};

/// How a file looked when it was last read or written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stamp {
    modified: Option<SystemTime>,
    bytes: u64,
}

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        let found = fs::metadata(path).ok()?;
        Some(Self { modified: found.modified().ok(), bytes: found.len() })
    }
}

/// The file that is edited.
#[derive(Debug)]
pub struct Session {
    path: Option<PathBuf>,
    stamp: Option<Stamp>,
    /// Nothing where this system gives no place to keep work in.
    recovery: Option<Recovery>,
    /// Revision of the document that the recovery file holds.
    kept: Option<u64>,
    dirty_since: Option<Instant>,
}

impl Session {
    /// A session without a file; and why unsaved work can't be kept, where it can't.
    pub fn begin(places: &Places) -> (Self, Option<Error>) {
        let (recovery, problem) = match Recovery::begin(&places.recovery) {
            Ok(recovery) => (Some(recovery), None),
            Err(error) => (None, Some(error)),
        };
        (Self { path: None, stamp: None, recovery, kept: None, dirty_since: None }, problem)
    }

    /// The file, once there is one.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Name of the file, for the title of the window.
    pub fn name(&self) -> String {
        let name = self.path.as_deref().and_then(Path::file_name);
        name.map_or_else(|| "Untitled".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Work that an earlier session left behind when it ended without a word.
    pub fn left_behind(&self) -> Vec<Kept> {
        self.recovery.as_ref().map(Recovery::left_behind).unwrap_or_default()
    }

    /// Goes on with no file.
    pub fn start_new(&mut self) {
        (self.path, self.stamp) = (None, None);
        self.forget();
    }

    /// Reads `path` and goes on with it.
    ///
    /// # Errors
    /// Where the file can't be read or is no good scene; the session is then as before.
    pub fn open(&mut self, path: &Path) -> Result<Scene> {
        let stamp = Stamp::of(path);
        let scene = Scene::load(path).map_err(|error| error.in_file(path))?;
        (self.path, self.stamp) = (Some(path.to_owned()), stamp);
        self.forget();
        Ok(scene)
    }

    /// Goes on with what was recovered, which is not in its file yet. Returns the scene as its
    /// file has it.
    pub fn resume(&mut self, kept: &Kept) -> Scene {
        self.path = kept.file.clone();
        self.stamp = self.path.as_deref().and_then(Stamp::of);
        self.path.as_deref().and_then(|path| Scene::load(path).ok()).unwrap_or_default()
    }

    /// Writes the document to `path`, the file from now on.
    ///
    /// # Errors
    /// Where the file is read-only or can't be written; file and session are then as before.
    pub fn save(&mut self, document: &mut Document, path: &Path) -> Result<()> {
        refuse_read_only(path)?;
        let scene = document.file_scene();
        scene.save(path)?;
        document.mark_saved(scene);
        (self.path, self.stamp) = (Some(path.to_owned()), Stamp::of(path));
        self.forget();
        Ok(())
    }

    /// Whether the file may not be written.
    pub fn is_read_only(&self) -> bool {
        self.path.as_deref().is_some_and(|path| refuse_read_only(path).is_err())
    }

    /// Whether another program changed the file, or took it away, since it was last read or written.
    pub fn changed_by_others(&self) -> bool {
        match &self.path {
            Some(path) => Stamp::of(path) != self.stamp,
            None => false,
        }
    }

    /// Takes note of the file as it is now, so that this change is not told again.
    pub fn accept_change(&mut self) {
        self.stamp = self.path.as_deref().and_then(Stamp::of);
    }

    /// Keeps unsaved work safe from a crash, once it is `after` old. Returns how long to wait
    /// until it should be called again; nothing where there is nothing to keep.
    ///
    /// # Errors
    /// [`Error::File`] where the work could not be kept.
    pub fn keep(&mut self, document: &Document, after: Duration) -> Result<Option<Duration>> {
        if !document.is_dirty() {
            self.forget();
            return Ok(None);
        }
        if self.kept == Some(document.revision()) {
            return Ok(None);
        }
        let waited = self.dirty_since.get_or_insert_with(Instant::now).elapsed();
        if waited < after {
            return Ok(Some(after - waited));
        }
        // After a failure it waits as long again: one message at a time.
        self.dirty_since = None;
        self.kept = Some(document.revision());
        let keep = |recovery: &Recovery| recovery.keep(self.path.as_deref(), &document.file_scene());
        self.recovery.as_ref().map_or(Ok(()), keep)?;
        Ok(None)
    }

    /// There is nothing unsaved any more.
    fn forget(&mut self) {
        if self.kept.take().is_some() {
            self.recovery.iter().for_each(Recovery::forget);
        }
        self.dirty_since = None;
    }
}

/// A file that is replaced as a whole can be replaced even when it is read-only: who made it
/// so did not mean that.
fn refuse_read_only(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(found) if found.permissions().readonly() => Err(Error::Argument(format!(
            "cannot write `{}`: it is read-only; save under another name, or make it writable",
            path.display()
        ))),
        _ => Ok(()),
    }
}
