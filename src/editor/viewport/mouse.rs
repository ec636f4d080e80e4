//! What the mouse and the keys do to the document: clicks and boxes select, handles and
//! G, R, S change what is selected.

use eframe::egui::{CursorIcon, Event, Key, PointerButton, Pos2, Rect, Response, Ui};
use glam::DVec2;

use super::{
    Viewport,
    gizmo::Gizmo,
    hand::{self, Hand, Hold},
    lens::{Lens, dvec},
    operation::{Constraint, Grip, Kind, Operation},
    pick,
    settings::Axes,
    space::{frame_of, pivot_of},
};
use crate::editor::{Document, EllipsoidId, Selection};

/// How near two clicks must be to mean the same place, points.
const SAME_PLACE: f32 = 4.0;

/// What the cursor is over.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hover {
    /// The handle.
    pub handle: Option<Constraint>,
    /// The ellipsoid, where there is no handle.
    pub ellipsoid: Option<EllipsoidId>,
}

/// A box that is being drawn, or is to be.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Boxing {
    /// None.
    #[default]
    Off,
    /// The next drag draws one, wherever it begins.
    Armed,
    /// One is being drawn from here.
    From(Pos2),
}

/// How an operation goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    GoOn,
    Keep,
    Cancel,
}

impl Viewport {
    /// Everything that the mouse does, in order of who has it.
    pub(super) fn mouse(&mut self, ui: &Ui, response: &Response, document: &mut Document) {
        let lens = self.scene_lens(document);
        if let Some(kind) = self.wish.take() {
            let at = ui.input(|i| i.pointer.latest_pos()).unwrap_or_else(|| self.rect.center());
            self.begin(kind, document, dvec(at));
        }
        self.hover = Hover::default();
        if self.operation.is_some() {
            self.operate(ui, &lens, document);
            return;
        }
        self.navigate(ui, response, document);
        if self.hand != Hand::Free {
            ui.ctx().set_cursor_icon(self.hand.cursor());
            return;
        }
        if let Some(at) = response.hover_pos() {
            self.point_at(ui, &lens, document, dvec(at));
        }
        self.select_by_box(ui, response, document);
        if response.drag_started_by(PointerButton::Primary) && self.boxing == Boxing::Off {
            self.take_hold(ui, &lens, document);
        }
        if response.clicked_by(PointerButton::Primary) && self.hover.handle.is_none() {
            self.select_by_click(ui, &lens, document);
        }
    }

    /// The gizmo at what is selected.
    pub(super) fn gizmo(&self, document: &Document) -> Option<Gizmo> {
        if let Some(operation) = &self.operation {
            let pivot = pivot_of(document, self.settings.pivot)?;
            return Gizmo::new(self.settings.tool, pivot, operation.frame())
                .filter(|gizmo| operation.dragged && gizmo.kind == operation.kind);
        }
        if self.truth || matches!(self.boxing, Boxing::From(_)) {
            return None;
        }
        let pivot = pivot_of(document, self.settings.pivot)?;
        Gizmo::new(self.settings.tool, pivot, self.axes(document))
    }

    fn axes(&self, document: &Document) -> glam::DQuat {
        match self.settings.axes {
            Axes::World => glam::DQuat::IDENTITY,
            Axes::Local => frame_of(document),
        }
    }

    /// Begins an operation by its key: it goes on until a click.
    fn begin(&mut self, kind: Kind, document: &mut Document, at: DVec2) {
        if let Some(running) = self.operation.take() {
            document.cancel();
            drop(running);
        }
        self.operation = Operation::begin(kind, document, self.settings.pivot, self.is_local(), at);
    }

    fn is_local(&self) -> bool {
        self.settings.axes == Axes::Local
    }

    /// A drag begins: on a handle an operation, elsewhere a box.
    fn take_hold(&mut self, ui: &Ui, lens: &Lens, document: &mut Document) {
        let (origin, now) = ui.input(|i| (i.pointer.press_origin(), i.pointer.latest_pos()));
        let Some(origin) = origin else { return };
        let gizmo = self.gizmo(document);
        let handle = gizmo.and_then(|gizmo| gizmo.handle_at(lens, dvec(origin)));
        let (Some(gizmo), Some(handle)) = (gizmo, handle) else {
            self.boxing = Boxing::From(origin);
            return;
        };
        let begun =
            Operation::begin(gizmo.kind, document, self.settings.pivot, self.is_local(), dvec(origin));
        self.operation = begun.map(|operation| operation.dragged_by(handle));
        let grip = self.grip_of(ui);
        if let (Some(operation), Some(now)) = (&mut self.operation, now) {
            operation.point(lens, dvec(now), grip);
            operation.update(lens, document, grip);
        }
    }

    fn grip_of(&self, ui: &Ui) -> Grip {
        let modifiers = ui.input(|i| i.modifiers);
        Grip { snap: modifiers.command != self.settings.snap, precise: modifiers.shift }
    }

    fn operate(&mut self, ui: &Ui, lens: &Lens, document: &mut Document) {
        let grip = self.grip_of(ui);
        let local_first = self.is_local();
        let Some(mut operation) = self.operation.take() else { return };
        let at = ui.input(|i| i.pointer.latest_pos()).map(dvec);
        if let Some(at) = at {
            operation.point(lens, at, grip);
        }
        let (verdict, other) = keys(ui, &mut operation, local_first);
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
        match verdict {
            Verdict::Cancel => document.cancel(),
            Verdict::Keep => {
                operation.update(lens, document, grip);
                document.end();
            }
            Verdict::GoOn => {
                operation.update(lens, document, grip);
                self.operation = Some(operation);
                if let Some(kind) = other {
                    self.begin(kind, document, at.unwrap_or_default());
                }
            }
        }
    }

    fn point_at(&mut self, ui: &Ui, lens: &Lens, document: &Document, at: DVec2) {
        if self.boxing != Boxing::Off {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
            return;
        }
        self.hover.handle = self.gizmo(document).and_then(|gizmo| gizmo.handle_at(lens, at));
        if self.hover.handle.is_some() {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
        } else {
            self.hover.ellipsoid = pick::hits(document.scene(), &lens.ray(at)).first().map(|hit| hit.id);
        }
    }

    /// A click selects what is nearest under it; another one at the same place what is
    /// behind. Shift adds and takes out, Ctrl takes the whole cloud.
    fn select_by_click(&mut self, ui: &Ui, lens: &Lens, document: &mut Document) {
        let (at, modifiers) = ui.input(|i| (i.pointer.interact_pos(), i.modifiers));
        let Some(at) = at else { return };
        let hits: Vec<_> =
            pick::hits(document.scene(), &lens.ray(dvec(at))).into_iter().map(|hit| hit.id).collect();
        let again = self.clicked.is_some_and(|before| before.distance(at) < SAME_PLACE);
        self.clicked = Some(at);
        let mut selection = document.selection().clone();
        let Some(&first) = hits.first() else {
            if !modifiers.shift {
                document.select(Selection::default());
            }
            return;
        };
        if modifiers.command {
            selection = Selection::cloud(document.scene(), first.cloud);
        } else if modifiers.shift {
            selection.toggle(first);
        } else {
            let alone = selection.active.filter(|_| selection.ellipsoids.len() == 1);
            let place = alone.and_then(|id| hits.iter().position(|hit| *hit == id));
            let next = place.filter(|_| again).map_or(0, |place| (place + 1) % hits.len());
            selection = Selection::one(hits[next]);
        }
        document.select(selection);
    }

    fn select_by_box(&mut self, ui: &Ui, response: &Response, document: &mut Document) {
        if self.boxing == Boxing::Armed {
            if response.drag_started_by(PointerButton::Primary)
                && let Some(origin) = ui.input(|i| i.pointer.press_origin())
            {
                self.boxing = Boxing::From(origin);
            }
            if ui.input(|i| i.key_pressed(Key::Escape)) || response.clicked() {
                self.boxing = Boxing::Off;
            }
        }
        let Some(area) = self.box_area(ui) else { return };
        if ui.input(|i| i.key_pressed(Key::Escape)) {
            self.boxing = Boxing::Off;
        } else if !ui.input(|i| i.pointer.primary_down()) {
            self.boxing = Boxing::Off;
            let add = ui.input(|i| i.modifiers.shift);
            let found = pick::in_box(document.scene(), &self.scene_lens(document), area);
            let before = document.selection().ellipsoids.iter().copied().filter(|_| add);
            document.select(Selection::of(before.chain(found)));
        }
    }

    /// The box that is being drawn.
    pub(super) fn box_area(&self, ui: &Ui) -> Option<Rect> {
        let Boxing::From(from) = self.boxing else { return None };
        Some(Rect::from_two_pos(from, ui.input(|i| i.pointer.latest_pos())?))
    }

    fn navigate(&mut self, ui: &Ui, response: &Response, document: &Document) {
        let lens = self.view.lens(self.rect);
        let blown = blown(document);
        let scene_lens = lens.seen_from(blown);
        let (pivot, depth) = (self.view.pivot, self.view.distance);
        let selected = pivot_of(document, self.settings.pivot).filter(|_| self.settings.orbit_selected);
        let about = selected.map(|at| at + blown).filter(|at| lens.depth(*at) > 0.0).unwrap_or(pivot);
        let hold = |at: DVec2| {
            let hit = pick::hits(document.scene(), &scene_lens.ray(at)).into_iter().find(|hit| !hit.inside);
            let under = hit.map_or_else(|| lens.at_depth(at, depth), |hit| lens.ray(at).at(hit.distance));
            Hold { under, about }
        };
        let moved = self.hand.update(ui, response, &mut self.view, &mut self.speed, hold)
            | hand::wheel(ui, response, &self.hand, &mut self.view, &mut self.speed, hold);
        if moved {
            self.glide = None;
        }
    }

    /// The lens in the space of the scene's ellipsoids, before the wind moved them.
    pub(super) fn scene_lens(&self, document: &Document) -> Lens {
        self.view.lens(self.rect).seen_from(blown(document))
    }
}

/// How far the wind has carried the clouds, m.
pub(super) fn blown(document: &Document) -> glam::DVec3 {
    document.scene().drift()
}

/// Takes all keys for an operation: axes, numbers, the end.
fn keys(ui: &Ui, operation: &mut Operation, local_first: bool) -> (Verdict, Option<Kind>) {
    let (mut verdict, mut other) = (Verdict::GoOn, None);
    ui.input_mut(|i| {
        let typed = i.events.iter().any(|event| matches!(event, Event::Text(_)));
        for event in &i.events {
            match event {
                Event::Text(text) => text.chars().for_each(|c| {
                    operation.type_character(c);
                }),
                Event::Key { key, pressed: true, modifiers, .. } => match key {
                    Key::Escape => verdict = Verdict::Cancel,
                    Key::Enter | Key::Space => verdict = Verdict::Keep,
                    Key::Backspace => drop(operation.typed.pop()),
                    Key::X => operation.press_axis(0, modifiers.shift, local_first),
                    Key::Y => operation.press_axis(1, modifiers.shift, local_first),
                    Key::Z => operation.press_axis(2, modifiers.shift, local_first),
                    Key::G if !operation.dragged => other = Some(Kind::Move),
                    Key::R if !operation.dragged => other = Some(Kind::Rotate),
                    Key::S if !operation.dragged => other = Some(Kind::Scale),
                    key if !typed => {
                        if let Some(character) = character_of(*key) {
                            operation.type_character(character);
                        }
                    }
                    _ => {}
                },
                _ => {}
            }
        }
        i.events.retain(|event| !matches!(event, Event::Key { .. } | Event::Text(_)));
        if i.pointer.secondary_pressed() {
            verdict = Verdict::Cancel;
        }
        // Drags end where the button is let go; else a click ends it.
        if verdict == Verdict::GoOn
            && (i.pointer.primary_released() || (operation.dragged && !i.pointer.primary_down()))
        {
            verdict = Verdict::Keep;
        }
    });
    (verdict, other.filter(|kind| *kind != operation.kind))
}

/// The character of a key that comes without text.
fn character_of(key: Key) -> Option<char> {
    match key {
        Key::Minus => Some('-'),
        Key::Period | Key::Comma => Some('.'),
        key => key.name().chars().next().filter(|c| c.is_ascii_digit() && key.name().len() == 1),
    }
}
