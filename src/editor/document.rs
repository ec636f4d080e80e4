//! The scene that is edited: what is selected, what can be undone.

use std::collections::BTreeSet;

use crate::scene::Scene;

/// One ellipsoid of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EllipsoidId {
    /// Index into the scene's clouds.
    pub cloud: usize,
    /// Index into the cloud's ellipsoids.
    pub ellipsoid: usize,
}

/// What is selected.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Selection {
    /// The ellipsoids, in the order of the scene.
    pub ellipsoids: BTreeSet<EllipsoidId>,
    /// The one that the inspector shows and that local axes come from: the last one clicked.
    pub active: Option<EllipsoidId>,
}

/// A state of the scene that undo goes back to.
#[derive(Debug, Clone)]
struct Step {
    what: &'static str,
    scene: Scene,
    selection: Selection,
}

/// The scene that is edited.
#[derive(Debug, Default)]
pub struct Document {
    scene: Scene,
    selection: Selection,
    undo: Vec<Step>,
    redo: Vec<Step>,
    grouping: bool,
    revision: u64,
}

impl Document {
    /// Begins with `scene`.
    pub fn new(scene: Scene) -> Self {
        Self { scene, ..Self::default() }
    }

    /// The scene as it is now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Grows with every change of the scene, undo and redo too.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// What is selected.
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// Selects; no step of undo.
    pub fn select(&mut self, selection: Selection) {
        self.selection = selection;
    }

    /// Changes the scene: one step of undo, named `what` in the menu; within
    /// [`Document::begin`] and [`Document::end`] part of theirs.
    pub fn edit(&mut self, what: &'static str, change: impl FnOnce(&mut Scene)) {
        if !self.grouping {
            self.keep(what);
        }
        change(&mut self.scene);
        self.revision += 1;
    }

    /// All edits until [`Document::end`] are one step of undo: a drag.
    pub fn begin(&mut self, what: &'static str) {
        if !self.grouping {
            self.keep(what);
            self.grouping = true;
        }
    }

    /// Ends what [`Document::begin`] began.
    pub fn end(&mut self) {
        self.grouping = false;
    }

    fn keep(&mut self, what: &'static str) {
        self.undo.push(Step { what, scene: self.scene.clone(), selection: self.selection.clone() });
        self.redo.clear();
    }
}
