//! The steps of a volume, streamed: those that were asked for last are kept, and while it plays the next one is read on
//! a thread of its own.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::UNIX_EPOCH,
};

use super::{Grid, Opened, Volume};
use crate::{
    Error, Result,
    numbered::{Pattern, Unfit},
};

/// Most steps in memory: one that is seen, the next one, and the one before, which motion blur goes back to.
const MOST: usize = 3;
/// Most numbers of steps that a sentence tells.
const TOLD: usize = 6;

/// The steps of a volume, of which a few are in memory.
#[derive(Debug)]
pub(super) struct Steps {
    /// What all of them have in common.
    volume: Volume,
    folder: PathBuf,
    source: Source,
    /// Of those that there are, least first.
    numbers: Vec<i32>,
    shelf: Mutex<Shelf>,
    news: Condvar,
}

/// Where steps are.
#[derive(Debug)]
enum Source {
    Files(Pattern),
    /// Times of one file.
    Times,
}

/// What is in memory, the step that was asked for last in front.
#[derive(Debug, Default)]
struct Shelf {
    kept: Vec<Kept>,
    /// The step that was asked for last.
    last: Option<i32>,
}

#[derive(Debug)]
struct Kept {
    number: i32,
    /// Whether anybody asked for it.
    asked: bool,
    /// None while it is read.
    grid: Option<Arc<Grid>>,
}

impl Steps {
    /// Those of `volume`, whose file is in `folder`; `None` where it has but one.
    ///
    /// # Errors
    /// Where there are none.
    pub fn of(volume: &Volume, folder: &Path) -> Result<Option<Self>> {
        let path = folder.join(&volume.file);
        let refused = |problem: String| Error::Format { path: path.clone(), problem };
        let (source, numbers) = match Pattern::of(&path) {
            // What is called so is what is meant.
            _ if path.is_file() && volume.sequence.is_none() => return Ok(None),
            Ok(pattern) if !path.is_file() => {
                let folder = || path.parent().unwrap_or(Path::new("")).to_owned();
                let numbers = pattern.numbers();
                let numbers =
                    numbers.map_err(|source| Error::File { action: "read", path: folder(), source })?;
                (Source::Files(pattern), numbers)
            }
            Err(Unfit::TwoPlaces) if !path.is_file() => {
                return Err(refused("has two places for the step's number: leave one".to_owned()));
            }
            _ if volume.sequence.is_none() => return Ok(None),
            _ if volume.step > 0 => {
                return Err(refused(
                    "has both `step`, one of its times, and `sequence`, all of them: leave out one"
                        .to_owned(),
                ));
            }
            _ => (Source::Times, (0..times_in(&path)?).collect()),
        };
        if numbers.is_empty() {
            return Err(refused("names a sequence, and there is no file of it: check its folder, and how many digits its numbers \
                                have".to_owned()));
        }
        let volume = Volume { sequence: None, opened: Opened::default(), ..volume.clone() };
        let (shelf, news) = (Mutex::default(), Condvar::new());
        Ok(Some(Self { volume, folder: folder.to_owned(), source, numbers, shelf, news }))
    }

    /// The least and the greatest number.
    pub fn ends(&self) -> [i32; 2] {
        [self.numbers.first(), self.numbers.last()].map(|number| number.copied().unwrap_or_default())
    }

    /// The volume that is step `number`, as one that has no others.
    ///
    /// # Errors
    /// Where there is no such step, as a sentence.
    pub fn still(&self, number: i32) -> std::result::Result<Volume, String> {
        if self.numbers.binary_search(&number).is_err() {
            return Err(self.missing(number));
        }
        Ok(match &self.source {
            Source::Files(pattern) => {
                let name = pattern.file(number);
                let name =
                    name.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
                let file = Path::new(&self.volume.file).with_file_name(name).to_string_lossy().into_owned();
                Volume { file, ..self.volume.clone() }
            }
            Source::Times => Volume { step: number.unsigned_abs(), ..self.volume.clone() },
        })
    }

    fn missing(&self, number: i32) -> String {
        let [least, greatest] = self.ends();
        match &self.source {
            Source::Times => {
                format!("step {number} is missing: `{}` has the times 0 to {greatest}", self.volume.file)
            }
            Source::Files(pattern) => {
                let there: Vec<String> = self.numbers.iter().take(TOLD).map(i32::to_string).collect();
                let more = if self.numbers.len() > TOLD { format!(" ... {greatest}") } else { String::new() };
                format!(
                    "step {number} is missing: there is no `{}`. Write it, or tell `first`, `last` or `increment`: from {least} \
                     on there are {}{more}",
                    pattern.file(number).display(),
                    there.join(", ")
                )
            }
        }
    }

    /// Its step `number`: at once where it was asked for lately, or read ahead.
    ///
    /// # Errors
    /// Where its file can't be read or has no such grid.
    pub fn read(self: &Arc<Self>, number: i32) -> Result<Arc<Grid>> {
        let (grid, before) = self.get(number)?;
        let ahead = before.and_then(|before| number.checked_add(number.checked_sub(before)?));
        if let Some(ahead) =
            ahead.filter(|ahead| *ahead != number && self.numbers.binary_search(ahead).is_ok())
        {
            self.read_ahead(ahead);
        }
        Ok(grid)
    }

    /// Step `number`, and the one that was asked for before, where this one was not asked for lately.
    fn get(&self, number: i32) -> Result<(Arc<Grid>, Option<i32>)> {
        let mut shelf = self.shelf();
        while let Some(place) = shelf.place(number) {
            if let Some(found) = shelf.ask(place) {
                return Ok(found);
            }
            shelf = self.news.wait(shelf).unwrap_or_else(PoisonError::into_inner);
        }
        shelf.keep(Kept { number, asked: true, grid: None }, 0);
        let before = shelf.last.replace(number);
        drop(shelf);
        Ok((self.fill(number)?, before))
    }

    /// Reads a step that is soon asked for, on a thread of its own.
    fn read_ahead(self: &Arc<Self>, number: i32) {
        let mut shelf = self.shelf();
        if shelf.place(number).is_some() {
            return;
        }
        shelf.keep(Kept { number, asked: false, grid: None }, 1);
        drop(shelf);
        let steps = self.clone();
        // What goes wrong is told when it is asked for.
        let begun = thread::Builder::new().spawn(move || drop(steps.fill(number)));
        if begun.is_err() {
            self.shelf().forget_unread(number);
        }
    }

    /// Reads a step into its place, or gives that up.
    fn fill(&self, number: i32) -> Result<Arc<Grid>> {
        let _given_up = GivenUp(self, number);
        let still = self.still(number).map_err(Error::Argument)?;
        let grid = Arc::new(still.grid_in(&self.folder.join(&still.file))?);
        let mut shelf = self.shelf();
        if let Some(place) = shelf.place(number) {
            shelf.kept[place].grid = Some(grid.clone());
        }
        Ok(grid)
    }

    /// Differs where what is in the file of a step does: of its size and of when it was written, so that nobody need
    /// read it.
    pub fn fingerprint(&self, number: i32) -> u64 {
        let path = self.still(number).map(|still| self.folder.join(still.file));
        let about = path.ok().and_then(|path| fs::metadata(path).ok());
        let written = about.as_ref().and_then(|about| about.modified().ok()?.duration_since(UNIX_EPOCH).ok());
        let size = about.map_or(0, |about| about.len());
        written.map_or(0, |written| written.as_nanos() as u64).rotate_left(32) ^ size
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shelf {
    fn place(&self, number: i32) -> Option<usize> {
        self.kept.iter().position(|kept| kept.number == number)
    }

    /// What is in a place, and the step that was asked for before if this one never was; `None` while it is read.
    fn ask(&mut self, place: usize) -> Option<(Arc<Grid>, Option<i32>)> {
        let grid = self.kept[place].grid.clone()?;
        let mut kept = self.kept.remove(place);
        let is_new = !std::mem::replace(&mut kept.asked, true);
        let before = self.last.replace(kept.number).filter(|_| is_new);
        self.kept.insert(0, kept);
        Some((grid, before))
    }

    fn keep(&mut self, kept: Kept, place: usize) {
        self.kept.insert(place.min(self.kept.len()), kept);
        self.kept.truncate(MOST);
    }

    fn forget_unread(&mut self, number: i32) {
        self.kept.retain(|kept| kept.number != number || kept.grid.is_some());
    }
}

/// Takes a step's place away that was not filled, and wakes who waits for it.
struct GivenUp<'a>(&'a Steps, i32);

impl Drop for GivenUp<'_> {
    fn drop(&mut self) {
        let Self(steps, number) = self;
        steps.shelf().forget_unread(*number);
        steps.news.notify_all();
    }
}

#[cfg(feature = "import")]
fn times_in(path: &Path) -> Result<i32> {
    crate::import::times_in(path)
}

#[cfg(not(feature = "import"))]
fn times_in(path: &Path) -> Result<i32> {
    Err(Error::Argument(format!(
        "`{}` is a volume, and this build reads none: build with the feature `import`",
        path.display()
    )))
}

#[cfg(all(test, feature = "import"))]
mod tests {
    use super::*;
    use crate::scene::Brick;

    /// Steps 0 to 9 of one voxel each, in a folder of their own.
    fn steps() -> (tempfile::TempDir, Arc<Steps>) {
        let folder = tempfile::tempdir().unwrap();
        for number in 0..10 {
            fs::write(folder.path().join(format!("a{number}.raw")), (1.0 + number as f32).to_le_bytes())
                .unwrap();
        }
        let raw = Some(Brick { size: [1; 3], endian: Default::default(), voxel: [1.0; 3] });
        let volume = Volume { file: "a#.raw".to_owned(), raw, ..Volume::default() };
        let steps = Steps::of(&volume, folder.path()).unwrap().unwrap();
        (folder, Arc::new(steps))
    }

    /// What is in memory, once nothing is read any more.
    fn kept(steps: &Steps) -> Vec<i32> {
        let is_reading = |shelf: &mut Shelf| shelf.kept.iter().any(|kept| kept.grid.is_none());
        let shelf = steps.news.wait_while(steps.shelf(), is_reading).unwrap();
        shelf.kept.iter().map(|kept| kept.number).collect()
    }

    #[test]
    fn few_steps_are_in_memory_and_the_next_one_is_read_ahead() {
        let (_folder, steps) = steps();
        let mut ask = |number: i32| {
            assert_eq!(steps.read(number).unwrap().most, 1.0 + number as f32);
            kept(&steps)
        };
        // Who sees one step may see no other.
        assert_eq!(ask(4), [4]);
        assert_eq!(ask(5), [5, 6, 4]);
        assert_eq!(ask(6), [6, 7, 5]);
        // Motion blur goes back and forth between two, which says nothing of the next one.
        assert_eq!(ask(5), [5, 6, 7]);
        assert_eq!(ask(6), [6, 5, 7]);
        assert_eq!(ask(7), [7, 8, 6]);
        // A player that leaves out frames, one that goes back, and the end.
        assert_eq!(ask(9), [9, 7, 8]);
        assert_eq!(ask(8), [8, 9, 7]);
        assert_eq!(ask(3), [3, 8, 9]);
        assert_eq!(ask(2), [2, 1, 3]);
        assert_eq!(ask(1), [1, 0, 2]);
    }

    #[test]
    fn a_step_that_was_read_ahead_is_read_once_and_one_that_failed_again() {
        let (folder, steps) = steps();
        (0..2).for_each(|number| drop(steps.read(number).unwrap()));
        kept(&steps);
        fs::remove_file(folder.path().join("a2.raw")).unwrap();
        assert_eq!(steps.read(2).unwrap().most, 3.0);
        kept(&steps);
        fs::write(folder.path().join("a5.raw"), "no float").unwrap();
        assert!(steps.read(5).unwrap_err().to_string().contains("a5.raw"));
        fs::write(folder.path().join("a5.raw"), 7f32.to_le_bytes()).unwrap();
        assert_eq!(steps.read(5).unwrap().most, 7.0);
    }
}
