//! Work that survives a crash: a copy beside a lock that only a living editor holds.

use std::{
    fs::{self, File},
    io::Write,
    path::{Path, PathBuf},
    process,
    time::{SystemTime, UNIX_EPOCH},
};

use serde::{Deserialize, Serialize};

use crate::{Error, Result, files::write_whole, scene::Scene};

/// Unsaved work of an editor that ended without a word.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// The file that was edited, where there was one.
    pub file: Option<PathBuf>,
    /// The scene as it was.
    pub scene: Scene,
    /// When it was kept.
    pub at: SystemTime,
    copy: PathBuf,
}

/// What the copy holds.
#[derive(Serialize, Deserialize)]
struct Copy {
    file: Option<PathBuf>,
    scene: Scene,
}

/// The place where one editor keeps its unsaved work.
#[derive(Debug)]
pub struct Recovery {
    folder: PathBuf,
    copy: PathBuf,
    lock: PathBuf,
    /// The system unlocks it when this process ends, in whatever way.
    _held: File,
}

impl Recovery {
    /// Takes a place in `folder`, which is made where it is missing.
    ///
    /// # Errors
    /// [`Error::File`] where that is not possible.
    pub fn begin(folder: &Path) -> Result<Self> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| Error::File { action: "create", path, source }
        };
        fs::create_dir_all(folder).map_err(failed(folder))?;
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        let name = format!("{}-{now}", process::id());
        let lock = folder.join(format!("{name}.lock"));
        let held = File::create_new(&lock).map_err(failed(&lock))?;
        held.lock().map_err(failed(&lock))?;
        let copy = folder.join(format!("{name}.json"));
        Ok(Self { folder: folder.to_owned(), copy, lock, _held: held })
    }

    /// Keeps `scene`, which belongs into `file`.
    ///
    /// # Errors
    /// [`Error::File`] where it can't be written.
    pub fn keep(&self, file: Option<&Path>, scene: &Scene) -> Result<()> {
        // Its volumes are found from there, wherever its own file is.
        let copy = Copy { file: file.map(Path::to_owned), scene: scene.written_from(&self.folder) };
        let text = serde_json::to_string(&copy)
            .map_err(|error| Error::Argument(format!("the scene could not be kept: {error}")))?;
        write_whole(&self.copy, |file| file.write_all(text.as_bytes()))
    }

    /// There is nothing to keep any more.
    pub fn forget(&self) {
        // What can't be removed now is offered once more than needed.
        let _ = fs::remove_file(&self.copy);
    }

    /// What others left behind, the latest first.
    pub fn left_behind(&self) -> Vec<Kept> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let copies = entries.map(|entry| entry.path()).filter(|path| {
            *path != self.copy && path.extension().is_some_and(|extension| extension == "json")
        });
        let mut found: Vec<_> = copies.filter(|copy| !is_held(copy)).filter_map(|copy| read(&copy)).collect();
        found.sort_by_key(|kept| std::cmp::Reverse(kept.at));
        found
    }
}

impl Drop for Recovery {
    fn drop(&mut self) {
        self.forget();
        // A lock that nobody holds harms nobody.
        let _ = fs::remove_file(&self.lock);
    }
}

impl Kept {
    /// Throws the copy away.
    pub fn discard(&self) {
        let _ = fs::remove_file(&self.copy);
        let _ = fs::remove_file(self.copy.with_extension("lock"));
    }
}

/// Whether the editor that wrote `copy` is still there.
fn is_held(copy: &Path) -> bool {
    File::open(copy.with_extension("lock")).is_ok_and(|lock| lock.try_lock().is_err())
}

fn read(copy: &Path) -> Option<Kept> {
    let at = fs::metadata(copy).and_then(|found| found.modified()).unwrap_or(UNIX_EPOCH);
    let Copy { file, mut scene } = serde_json::from_str(&fs::read_to_string(copy).ok()?).ok()?;
    scene.validate().ok()?;
    if let Err(problem) = scene.read_volumes(copy.parent().unwrap_or(Path::new(""))) {
        tracing::warn!(%problem, "a volume of what was left behind could not be read");
    }
    Some(Kept { file, scene, at, copy: copy.to_owned() })
}

#[cfg(all(test, feature = "import"))]
mod tests {
    use super::*;

    #[test]
    fn volumes_are_found_again_wherever_the_scene_was_to_be_saved() {
        let folder = tempfile::tempdir().unwrap();
        let [made, kept] = ["made", "kept"].map(|name| folder.path().join(name));
        fs::create_dir_all(&made).unwrap();
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/half.vdb");
        fs::copy(data, made.join("smoke.vdb")).unwrap();
        let text = r#"{"clouds":[{"volume":{"file":"smoke.vdb"}}]}"#;
        let mut scene = Scene::from_json(text).unwrap();
        scene.read_volumes(&made).unwrap();
        let recovery = Recovery::begin(&kept).unwrap();
        // It was saved elsewhere since it was opened.
        recovery.keep(Some(&folder.path().join("other/scene.json")), &scene).unwrap();
        let found = read(&recovery.copy).unwrap();
        assert!(found.scene.clouds[0].volume.as_ref().unwrap().read_grid().is_some());
        found.scene.save(made.join("scene.json")).unwrap();
        let saved = Scene::load(made.join("scene.json")).unwrap();
        assert_eq!(saved.clouds[0].volume.as_ref().unwrap().file, "smoke.vdb");
    }
}
