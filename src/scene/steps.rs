//! The steps of a volume, streamed: those that were asked for last are kept, and while it plays the next one is read on
//! a thread of its own.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError},
    thread,
    time::UNIX_EPOCH,
};

use super::flow::{self, End, Motion, Velocity};
use super::grid::fingerprint;
use super::sequence::{Between, Mix, Shown, Way};
use super::{Grid, Opened, Volume};
#[cfg(feature = "import")]
use crate::import::{times_in, velocity_in};
use crate::{
    Error, Result,
    numbered::{Pattern, Unfit},
};

/// Most steps in memory: one that is seen or two that are blended, and the next one or that before, which motion blur
/// goes back to.
const MOST: usize = 3;
/// Most blends of steps in memory.
const MOST_MIXED: usize = 2;
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
    /// Whether velocities are wanted of files that have them, and whether the first one has.
    wants_velocities: bool,
    velocities: OnceLock<bool>,
    shelf: Mutex<Shelf>,
    news: Condvar,
}

/// A step that was read.
#[derive(Debug, Clone)]
struct Step {
    grid: Arc<Grid>,
    velocity: Option<Arc<Velocity>>,
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
    /// Blends of two steps, the latest in front.
    mixed: Vec<(Shown, Arc<Grid>)>,
    /// The step that was asked for last.
    last: Option<i32>,
}

#[derive(Debug)]
struct Kept {
    number: i32,
    /// Whether anybody asked for it.
    asked: bool,
    /// None while it is read.
    step: Option<Step>,
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
        let sequence = volume.sequence.clone().unwrap_or_default();
        let wants_velocities =
            matches!(sequence.between, Between::Auto | Between::Flow) && sequence.velocity.is_none();
        let volume = Volume { sequence: None, opened: Opened::default(), ..volume.clone() };
        let (velocities, shelf, news) = (OnceLock::new(), Mutex::default(), Condvar::new());
        Ok(Some(Self {
            volume,
            folder: folder.to_owned(),
            source,
            numbers,
            wants_velocities,
            velocities,
            shelf,
            news,
        }))
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

    /// Whether its files tell how fast matter goes, as far as the first one says.
    pub fn has_velocities(&self) -> bool {
        let first = || {
            self.still(self.ends()[0])
                .is_ok_and(|still| self.velocity_of(&still).is_ok_and(|found| found.is_some()))
        };
        *self.velocities.get_or_init(first)
    }

    /// What is there of it: at once where its steps were asked for lately, or read ahead.
    ///
    /// # Errors
    /// Where a file can't be read or has no such grid.
    pub fn show(self: &Arc<Self>, shown: &Shown) -> Result<Arc<Grid>> {
        match &shown.mix {
            None => Ok(self.one(shown.number)?.grid),
            Some(mix) => self.mixed(shown, mix),
        }
    }

    fn one(self: &Arc<Self>, number: i32) -> Result<Step> {
        let (step, before) = self.get(number)?;
        self.read_ahead(before.and_then(|before| number.checked_add(number.checked_sub(before)?)));
        Ok(step)
    }

    /// What is between two steps, of which the one that is new tells where to read ahead.
    fn mixed(self: &Arc<Self>, shown: &Shown, mix: &Mix) -> Result<Arc<Grid>> {
        if let Some((_, grid)) = self.shelf().mixed.iter().find(|(known, _)| known == shown) {
            return Ok(grid.clone());
        }
        let ((from, before_from), (to, before_to)) = (self.get(shown.number)?, self.get(mix.next)?);
        let apart = mix.next.checked_sub(shown.number);
        self.read_ahead(match (before_from, before_to) {
            (None, Some(_)) => apart.and_then(|apart| mix.next.checked_add(apart)),
            (Some(_), None) => apart.and_then(|apart| shown.number.checked_sub(apart)),
            _ => None,
        });
        let motions = [self.motion(shown.number, &from, mix)?, self.motion(mix.next, &to, mix)?];
        let [from, to] =
            [(&from, &motions[0]), (&to, &motions[1])].map(|(step, motion)| End { grid: &step.grid, motion });
        let grid = flow::between(&from, &to, mix.share).map(Arc::new).map_err(|problem| Error::Format {
            path: self.folder.join(&self.volume.file),
            problem: format!("{problem} (between the steps {} and {})", shown.number, mix.next),
        })?;
        let mut shelf = self.shelf();
        shelf.mixed.insert(0, (*shown, grid.clone()));
        shelf.mixed.truncate(MOST_MIXED);
        Ok(grid)
    }

    /// How the matter of a step goes.
    fn motion(&self, number: i32, step: &Step, mix: &Mix) -> Result<Motion> {
        let seconds = match mix.way {
            Way::Even(way) => return Ok(Motion::Even(way)),
            Way::Told(seconds) => seconds,
        };
        let still = self.still(number).map_err(Error::Argument)?;
        let read = || self.velocity_of(&still).map(|found| found.map(Arc::new));
        let found = step.velocity.clone().map_or_else(read, |velocity| Ok(Some(velocity)))?;
        let velocity = found.ok_or_else(|| Error::Format {
            path: self.folder.join(&still.file),
            problem: "has no grid of velocities, and the first step has one: export it with that, or choose `between`".to_owned(),
        })?;
        Ok(Motion::of(&velocity, &step.grid, seconds))
    }

    /// Step `number`, and the one that was asked for before, where this one was not asked for lately.
    fn get(&self, number: i32) -> Result<(Step, Option<i32>)> {
        let mut shelf = self.shelf();
        while let Some(place) = shelf.place(number) {
            if let Some(found) = shelf.ask(place) {
                return Ok(found);
            }
            shelf = self.news.wait(shelf).unwrap_or_else(PoisonError::into_inner);
        }
        shelf.keep(Kept { number, asked: true, step: None }, 0);
        let before = shelf.last.replace(number);
        drop(shelf);
        Ok((self.fill(number)?, before))
    }

    /// Reads a step that is soon asked for, where there is one of that number, on a thread of its own.
    fn read_ahead(self: &Arc<Self>, number: Option<i32>) {
        let Some(number) = number.filter(|number| self.numbers.binary_search(number).is_ok()) else { return };
        let mut shelf = self.shelf();
        if shelf.place(number).is_some() {
            return;
        }
        shelf.keep(Kept { number, asked: false, step: None }, 1);
        drop(shelf);
        let steps = self.clone();
        // What goes wrong is told when it is asked for.
        let begun = thread::Builder::new().spawn(move || drop(steps.fill(number)));
        if begun.is_err() {
            self.shelf().forget_unread(number);
        }
    }

    /// Reads a step into its place, or gives that up.
    fn fill(&self, number: i32) -> Result<Step> {
        let _given_up = GivenUp(self, number);
        let still = self.still(number).map_err(Error::Argument)?;
        let grid = Arc::new(still.grid_in(&self.folder.join(&still.file))?);
        let velocity = match self.wants_velocities && self.has_velocities() {
            true => self.velocity_of(&still)?.map(Arc::new),
            false => None,
        };
        let step = Step { grid, velocity };
        let mut shelf = self.shelf();
        if let Some(place) = shelf.place(number) {
            shelf.kept[place].step = Some(step.clone());
        }
        Ok(step)
    }

    /// Velocities in the file of a step.
    fn velocity_of(&self, still: &Volume) -> Result<Option<Velocity>> {
        match &self.source {
            Source::Files(_) if still.raw.is_none() => velocity_in(&self.folder.join(&still.file)),
            _ => Ok(None),
        }
    }

    /// Differs where what there is differs: of the size of files and of when they were written, so that nobody need read them.
    pub fn fingerprint(&self, shown: &Shown) -> u64 {
        let about = |number: i32| {
            let path = self.still(number).map(|still| self.folder.join(still.file));
            let about = path.ok().and_then(|path| fs::metadata(path).ok());
            let written =
                about.as_ref().and_then(|about| about.modified().ok()?.duration_since(UNIX_EPOCH).ok());
            [about.map_or(0, |about| about.len()), written.map_or(0, |written| written.as_nanos() as u64)]
        };
        let mut words = about(shown.number).to_vec();
        if let Some(Mix { next, share, way }) = &shown.mix {
            words.extend(about(*next));
            words.push(share.to_bits());
            words.extend(match way {
                Way::Even(way) => way.to_array().map(f64::to_bits).to_vec(),
                Way::Told(seconds) => vec![seconds.to_bits()],
            });
        }
        fingerprint(words)
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
    fn ask(&mut self, place: usize) -> Option<(Step, Option<i32>)> {
        let step = self.kept[place].step.clone()?;
        let mut kept = self.kept.remove(place);
        let is_new = !std::mem::replace(&mut kept.asked, true);
        let before = self.last.replace(kept.number).filter(|_| is_new);
        self.kept.insert(0, kept);
        Some((step, before))
    }

    fn keep(&mut self, kept: Kept, place: usize) {
        self.kept.insert(place.min(self.kept.len()), kept);
        self.kept.truncate(MOST);
    }

    fn forget_unread(&mut self, number: i32) {
        self.kept.retain(|kept| kept.number != number || kept.step.is_some());
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

#[cfg(not(feature = "import"))]
fn times_in(path: &Path) -> Result<i32> {
    Err(Error::Argument(format!(
        "`{}` is a volume, and this build reads none: build with the feature `import`",
        path.display()
    )))
}

#[cfg(not(feature = "import"))]
fn velocity_in(_: &Path) -> Result<Option<Velocity>> {
    Ok(None)
}

#[cfg(test)]
#[cfg(feature = "import")]
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

    fn one(steps: &Arc<Steps>, number: i32) -> Result<Arc<Grid>> {
        steps.show(&Shown { number, mix: None })
    }

    /// What is in memory, once nothing is read any more.
    fn kept(steps: &Steps) -> Vec<i32> {
        let is_reading = |shelf: &mut Shelf| shelf.kept.iter().any(|kept| kept.step.is_none());
        let shelf = steps.news.wait_while(steps.shelf(), is_reading).unwrap();
        shelf.kept.iter().map(|kept| kept.number).collect()
    }

    #[test]
    fn few_steps_are_in_memory_and_the_next_one_is_read_ahead() {
        let (_folder, steps) = steps();
        let ask = |number: i32| {
            assert_eq!(one(&steps, number).unwrap().most, 1.0 + number as f32);
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
        (0..2).for_each(|number| drop(one(&steps, number).unwrap()));
        kept(&steps);
        fs::remove_file(folder.path().join("a2.raw")).unwrap();
        assert_eq!(one(&steps, 2).unwrap().most, 3.0);
        kept(&steps);
        fs::write(folder.path().join("a5.raw"), "no float").unwrap();
        assert!(one(&steps, 5).unwrap_err().to_string().contains("a5.raw"));
        fs::write(folder.path().join("a5.raw"), 7f32.to_le_bytes()).unwrap();
        assert_eq!(one(&steps, 5).unwrap().most, 7.0);
    }
}
