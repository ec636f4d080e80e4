//! Jobs one after another.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

use eframe::egui::Context;

use super::process::{Outcome, Process};
use crate::{Result, scene::Scene};

/// How often the end of a program is looked for.
const LOOK: Duration = Duration::from_millis(100);

/// What is to be done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    /// What kind of job it is.
    pub title: &'static str,
    /// The program and all words behind it.
    pub words: Vec<String>,
    /// The file that it writes.
    pub output: PathBuf,
    /// The scene as it was when it was asked for.
    pub scene: PathBuf,
}

/// How far a job is.
pub(super) enum State {
    Waiting,
    Working(Process),
    Paused(Process),
    Done(String),
    Failed(String),
    Cancelled,
}

/// A job in the queue.
pub(super) struct Job {
    pub order: Order,
    pub state: State,
    /// Whether it was asked to stop.
    pub stopping: bool,
}

/// What ended since it was asked last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ended {
    /// A file was written.
    Well(String),
    /// A job failed: a sentence.
    Badly(String),
}

/// The queue, first job first; one works at a time.
#[derive(Default)]
pub struct Jobs {
    pub(super) jobs: Vec<Job>,
    /// Whether its window is open.
    pub is_open: bool,
    count: u64,
}

impl Jobs {
    /// Keeps `scene` as it is in a file of `folder` of its own, for a job whose program reads it later.
    ///
    /// # Errors
    /// [`crate::Error::File`] where it can't be written.
    pub fn keep(&mut self, folder: &Path, name: &str, scene: &Scene) -> Result<PathBuf> {
        fs::create_dir_all(folder).map_err(|source| crate::Error::File {
            action: "create",
            path: folder.to_owned(),
            source,
        })?;
        self.count += 1;
        let file = folder.join(format!("{name}-{}-{}.json", std::process::id(), self.count));
        scene.save(&file)?;
        Ok(file)
    }

    /// Puts a job behind the others.
    pub fn add(&mut self, order: Order) {
        self.jobs.push(Job { order, state: State::Waiting, stopping: false });
        self.is_open = true;
    }

    /// Whether any job is not at its end.
    pub fn are_busy(&self) -> bool {
        self.jobs.iter().any(Job::is_under_way)
    }

    /// Jobs that are not at their end, and the share of the one at work that is done.
    pub fn under_way(&self) -> Option<(usize, f32)> {
        let count = self.jobs.iter().filter(|job| job.is_under_way()).count();
        let share = self.jobs.iter().find_map(Job::share).unwrap_or(0.0);
        (count > 0).then_some((count, share))
    }

    /// Has all jobs end where their files are whole.
    pub fn stop_all(&mut self) {
        self.jobs.iter_mut().for_each(Job::cancel);
    }

    /// Hears the programs and begins the next job; what ended meanwhile.
    pub fn go_on(&mut self, window: &Context) -> Vec<Ended> {
        let ended = self.jobs.iter_mut().filter_map(Job::look).collect();
        let at_work = |job: &Job| matches!(job.state, State::Working(_) | State::Paused(_));
        if !self.jobs.iter().any(at_work)
            && let Some(next) = self.jobs.iter_mut().find(|job| matches!(job.state, State::Waiting))
        {
            next.begin(window);
        }
        if self.jobs.iter().any(at_work) {
            window.request_repaint_after(LOOK);
        }
        ended
    }

    /// Takes a job away that is at its end, and the scene that was kept for it.
    pub(super) fn remove(&mut self, index: usize) {
        if self.jobs.get(index).is_some_and(|job| !job.is_under_way()) {
            let job = self.jobs.remove(index);
            let _ = fs::remove_file(job.order.scene);
        }
    }
}

impl Drop for Jobs {
    fn drop(&mut self) {
        for job in self.jobs.drain(..) {
            drop(job.state);
            let _ = fs::remove_file(job.order.scene);
        }
    }
}

impl Job {
    pub fn is_under_way(&self) -> bool {
        matches!(self.state, State::Waiting | State::Working(_) | State::Paused(_))
    }

    /// Share that is done, where it is at work.
    pub fn share(&self) -> Option<f32> {
        match &self.state {
            State::Working(process) | State::Paused(process) => Some(process.share()),
            _ => None,
        }
    }

    fn begin(&mut self, window: &Context) {
        self.state = match Process::begin(&self.order.words, window) {
            Ok(process) => State::Working(process),
            Err(error) => {
                let program = self.order.words.first().map_or("", String::as_str);
                State::Failed(format!("cannot start `{program}`: {error}"))
            }
        };
    }

    pub fn pause(&mut self) {
        self.state = match std::mem::replace(&mut self.state, State::Cancelled) {
            State::Working(mut process) => {
                process.pause();
                State::Paused(process)
            }
            other => other,
        };
    }

    pub fn resume(&mut self) {
        self.state = match std::mem::replace(&mut self.state, State::Cancelled) {
            State::Paused(mut process) => {
                process.go_on();
                State::Working(process)
            }
            other => other,
        };
    }

    pub fn cancel(&mut self) {
        match &mut self.state {
            State::Waiting => self.state = State::Cancelled,
            State::Working(process) | State::Paused(process) => {
                process.stop();
                self.stopping = true;
            }
            _ => {}
        }
    }

    fn look(&mut self) -> Option<Ended> {
        let (State::Working(process) | State::Paused(process)) = &mut self.state else { return None };
        let outcome = process.look()?;
        let (title, file) = (self.order.title, self.order.output.display());
        let (state, ended) = match outcome {
            // What was stopped in time says what is kept.
            Outcome::Failed(_) if self.stopping => {
                (State::Cancelled, Ended::Well(format!("{title}: `{file}` was cancelled.")))
            }
            Outcome::Done(told) => (State::Done(told), Ended::Well(format!("{title}: {file} is written."))),
            Outcome::Failed(why) => {
                (State::Failed(why.clone()), Ended::Badly(format!("{title} of `{file}` failed: {why}")))
            }
        };
        self.state = state;
        Some(ended)
    }
}
