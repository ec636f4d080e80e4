//! The scene that is edited: what is selected, what can be undone, whether it is saved.

use std::{collections::VecDeque, sync::Arc};

use super::{
    growing,
    selection::{EllipsoidId, Selection},
    tracks,
};
use crate::scene::{Cloud, Ellipsoid, Scene};

/// Steps that undo can go back. Steps share what they have in common only as whole scenes:
/// 200 of the largest scene are some 200 MB.
const MOST_STEPS: usize = 200;

/// A state of the scene that undo or redo goes to.
#[derive(Debug, Clone)]
struct Step {
    what: &'static str,
    scene: Arc<Scene>,
    selection: Selection,
}

/// Edits under way that will be one step of undo.
#[derive(Debug, Clone)]
struct Group {
    /// The field that is being adjusted; none for a drag between `begin` and `end`.
    field: Option<u64>,
    /// Whether the step was kept already: an empty group leaves none.
    kept: bool,
}

/// The scene that is edited. It is valid at all times: an edit that would break it is
/// refused, and [`Document::take_refusal`] says why.
///
/// Where it has a timeline, it is seen and edited as it is at the playhead, and what is changed
/// of a number that has a track becomes a key there.
#[derive(Debug, Default)]
pub struct Document {
    /// As the file has it.
    stored: Arc<Scene>,
    /// As it is at the playhead.
    posed: Arc<Scene>,
    playhead: f64,
    selection: Selection,
    undo: VecDeque<Step>,
    redo: Vec<Step>,
    group: Option<Group>,
    revision: u64,
    saved: Arc<Scene>,
    dirty: bool,
    /// Whether what was saved is in no file any more.
    lost: bool,
    refusal: Option<String>,
    news: Option<String>,
}

impl Document {
    /// Begins with `scene`, as it is in its file.
    pub fn new(scene: Scene) -> Self {
        let playhead = scene.time;
        let scene = Arc::new(scene);
        let mut document = Self { saved: scene.clone(), stored: scene, playhead, ..Self::default() };
        document.pose();
        document
    }

    /// Begins with `scene`, which differs from what its file holds: recovered work.
    pub fn unsaved(scene: Scene, saved: Scene) -> Self {
        let mut document = Self::new(saved);
        document.replace(Arc::new(scene));
        document
    }

    /// The scene as it is now, at the playhead.
    pub fn scene(&self) -> &Scene {
        &self.posed
    }

    /// The scene as it is now, at the playhead, to be kept or sent to another thread.
    pub fn shared_scene(&self) -> Arc<Scene> {
        self.posed.clone()
    }

    /// The scene as its file has it, wherever the playhead is.
    pub fn file_scene(&self) -> Arc<Scene> {
        self.stored.clone()
    }

    /// The moment that is seen, s; the scene's own time where it has no timeline.
    pub fn playhead(&self) -> f64 {
        self.posed.time
    }

    /// Shows another moment, s. It is no step of undo, and nothing without a timeline.
    pub fn set_playhead(&mut self, time: f64) {
        if self.stored.timeline.is_some() && time != self.playhead {
            self.playhead = time;
            self.pose();
        }
    }

    fn pose(&mut self) {
        self.posed = match self.stored.timeline {
            Some(_) => Arc::new(self.stored.posed(self.playhead)),
            None => self.stored.clone(),
        };
    }

    /// Grows with every change of the scene, undo and redo too.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether the scene differs from what was last saved or loaded.
    pub fn is_dirty(&self) -> bool {
        self.dirty
    }

    /// Tells that `scene`, which may be older than the present one, is now in the file.
    pub fn mark_saved(&mut self, scene: Arc<Scene>) {
        (self.saved, self.lost) = (scene, false);
        self.dirty = self.stored != self.saved;
    }

    /// Tells that the file does not hold what was saved any more: another program changed it.
    pub fn mark_unsaved(&mut self) {
        (self.dirty, self.lost) = (true, true);
    }

    /// What is selected.
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// Selects what there is of `selection`; no step of undo.
    pub fn select(&mut self, selection: Selection) {
        self.selection = selection.within(&self.stored);
    }

    /// The ellipsoid `id`, where there is one.
    pub fn ellipsoid(&self, id: EllipsoidId) -> Option<&Ellipsoid> {
        self.posed.clouds.get(id.cloud)?.ellipsoids.get(id.ellipsoid)
    }

    /// The cloud that is selected, or that the active ellipsoid belongs to.
    pub fn active_cloud(&self) -> Option<(usize, &Cloud)> {
        let index = self.selection.active_cloud()?;
        Some((index, self.posed.clouds.get(index)?))
    }

    /// Whether `id` or its cloud is locked.
    pub fn is_locked(&self, id: EllipsoidId) -> bool {
        let cloud = self.stored.clouds.get(id.cloud);
        cloud.is_some_and(|cloud| cloud.locked) || self.ellipsoid(id).is_some_and(|e| e.locked)
    }

    /// Why the last edit was refused, once.
    pub fn take_refusal(&mut self) -> Option<String> {
        self.refusal.take()
    }

    /// What the last edit did beside what it was asked for, once.
    pub fn take_news(&mut self) -> Option<String> {
        self.news.take()
    }

    /// Changes the scene: one step of undo, named `what` in the menu; within
    /// [`Document::begin`] and [`Document::end`] part of theirs. What changes nothing is no
    /// step; what breaks the scene is refused.
    pub fn edit(&mut self, what: &'static str, change: impl FnOnce(&mut Scene)) {
        self.edit_and_select(what, |scene, _| change(scene));
    }

    /// The same, for edits that move what is selected: `change` says where it went.
    pub fn edit_and_select(&mut self, what: &'static str, change: impl FnOnce(&mut Scene, &mut Selection)) {
        let (mut scene, mut selection) = (Scene::clone(&self.posed), self.selection.clone());
        change(&mut scene, &mut selection);
        if scene != *self.posed {
            let news = growing::follow(&self.posed, &mut scene);
            let time = scene.time;
            if self.posed.timeline.is_some() {
                tracks::unpose(&self.stored, &self.posed, &mut scene);
            }
            if let Err(error) = scene.validate() {
                self.refusal = Some(error.to_string());
                return;
            }
            if scene != *self.stored {
                self.keep(what);
            }
            self.news = news.or(self.news.take());
            self.playhead = time;
            self.replace(Arc::new(scene));
        }
        self.select(selection);
    }

    /// Changes one field: edits of the same `field` are one step until [`Document::settle`].
    pub fn adjust(&mut self, what: &'static str, field: u64, change: impl FnOnce(&mut Scene)) {
        let goes_on = self.group.as_ref().is_some_and(|group| group.field.is_none_or(|f| f == field));
        if !goes_on {
            self.group = Some(Group { field: Some(field), kept: false });
        }
        self.edit(what, change);
    }

    /// The hand rests: the next [`Document::adjust`] is a new step.
    pub fn settle(&mut self) {
        if self.group.as_ref().is_some_and(|group| group.field.is_some()) {
            self.end();
        }
    }

    /// All edits until [`Document::end`] are one step of undo: a drag.
    pub fn begin(&mut self, what: &'static str) {
        self.settle();
        if self.group.is_none() {
            tracing::trace!(what, "a group of edits begins");
            self.group = Some(Group { field: None, kept: false });
        }
    }

    /// Ends what [`Document::begin`] began. A drag back to where it began is no step.
    pub fn end(&mut self) {
        let kept = self.group.take().is_some_and(|group| group.kept);
        if kept && self.undo.back().is_some_and(|step| step.scene == self.stored) {
            self.undo.pop_back();
        }
    }

    /// Ends what [`Document::begin`] began and puts everything back as it was then.
    pub fn cancel(&mut self) {
        let kept = self.group.take().is_some_and(|group| group.kept);
        if kept && let Some(step) = self.undo.pop_back() {
            self.go_to(step);
        }
    }

    /// Whether a drag is under way.
    pub fn is_grouping(&self) -> bool {
        self.group.as_ref().is_some_and(|group| group.field.is_none())
    }

    /// Name of the step that [`Document::undo`] takes back.
    pub fn undo_name(&self) -> Option<&'static str> {
        self.undo.back().map(|step| step.what)
    }

    /// Name of the step that [`Document::redo`] does again.
    pub fn redo_name(&self) -> Option<&'static str> {
        self.redo.last().map(|step| step.what)
    }

    /// Takes the last step back; nothing where there is none.
    pub fn undo(&mut self) {
        self.end();
        if let Some(step) = self.undo.pop_back() {
            self.redo.push(self.step(step.what));
            self.go_to(step);
        }
    }

    /// Does again what was taken back; nothing where there is none.
    pub fn redo(&mut self) {
        self.end();
        if let Some(step) = self.redo.pop() {
            self.undo.push_back(self.step(step.what));
            self.go_to(step);
        }
    }

    fn step(&self, what: &'static str) -> Step {
        Step { what, scene: self.stored.clone(), selection: self.selection.clone() }
    }

    fn keep(&mut self, what: &'static str) {
        self.redo.clear();
        let kept = self.group.as_mut().is_some_and(|group| std::mem::replace(&mut group.kept, true));
        if kept {
            return;
        }
        if self.undo.len() == MOST_STEPS {
            self.undo.pop_front();
        }
        self.undo.push_back(self.step(what));
    }

    fn go_to(&mut self, step: Step) {
        self.replace(step.scene);
        self.select(step.selection);
    }

    fn replace(&mut self, scene: Arc<Scene>) {
        self.stored = scene;
        self.pose();
        self.revision += 1;
        self.dirty = self.lost || self.stored != self.saved;
        self.selection = std::mem::take(&mut self.selection).within(&self.stored);
    }
}
