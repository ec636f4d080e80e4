//! What actions do, whether they can be done now, and their keys.

use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers};
use glam::DVec3;

use super::selection::Selection;
use super::{
    actions::{Action, entries},
    app::{Editor, Tab},
    asking::{Dialog, Then},
    choosing::Purpose,
    dialogs::Shortcuts,
    palette::Palette,
    viewport::{self, ViewCommand},
};
use crate::scene::{Preset, Timeline};

/// Where the first ellipsoid goes: as high as fair-weather cumulus, metres.
const FIRST: DVec3 = DVec3::new(0.0, 1000.0, 0.0);

impl Editor {
    /// Does what a menu, a key or the palette asked for.
    pub fn perform(&mut self, ctx: &Context, action: Action) {
        if !self.can(action) {
            return;
        }
        match action {
            Action::New => self.ask(ctx, Then::New),
            Action::NewFrom(preset) => self.ask(ctx, Then::NewFrom(preset)),
            Action::Open => self.ask(ctx, Then::ChooseFile),
            Action::Save => self.save(ctx, None),
            Action::SaveAs => self.choose(ctx, Purpose::Save, None),
            Action::Revert => self.revert(),
            Action::Job(kind) => self.ask_for_job(kind),
            Action::ToggleJobs => self.jobs.is_open ^= true,
            Action::Quit => self.ask(ctx, Then::Close),
            Action::Undo => self.document.undo(),
            Action::Redo => self.document.redo(),
            Action::CameraFromView => {
                let camera = self.viewport.camera();
                self.document.edit("Set the camera", |scene| scene.camera = Some(camera));
            }
            Action::ToggleTimeline => self.toggle_timeline(),
            Action::Play => self.timeline.toggle_playing(ctx, &self.document),
            Action::RemoveTimeline => {
                self.document.edit("Remove the timeline", |scene| scene.timeline = None);
            }
            Action::ToggleOutliner => self.settings.toggle("outliner"),
            Action::ToggleInspector => self.settings.toggle("inspector"),
            Action::ObjectPanel => self.inspect(Tab::Object),
            Action::WorldPanel => self.inspect(Tab::World),
            Action::ViewPanel => self.inspect(Tab::View),
            Action::Look(look) => {
                self.settings.look = look;
                self.apply_settings(ctx);
            }
            Action::Larger => self.zoom(ctx, |zoom| zoom + 0.1),
            Action::Smaller => self.zoom(ctx, |zoom| zoom - 0.1),
            Action::ActualSize => self.zoom(ctx, |_| 1.0),
            Action::Palette => self.dialog = Some(Dialog::Palette(Palette::default())),
            Action::Shortcuts => self.dialog = Some(Dialog::Shortcuts(Shortcuts::default())),
            Action::About => self.dialog = Some(Dialog::About),
            Action::View(command) => self.viewport.run(command, &mut self.document),
            _ => self.perform_edit(action),
        }
    }

    fn perform_edit(&mut self, action: Action) {
        let document = &mut self.document;
        match action {
            Action::Duplicate => {
                document.duplicate(DVec3::ZERO);
                self.viewport.run(ViewCommand::Move, &mut self.document);
            }
            Action::Delete => document.delete(),
            Action::Rename => self.outliner.rename_active(document),
            Action::KeySelected => document.key_selected(),
            Action::Group => document.group(),
            Action::Join => {
                if let Some(to) = document.selection().active.map(|id| id.cloud) {
                    document.move_to_cloud(to);
                }
            }
            Action::Grow => {
                document.grow(&self.object.heaps);
                self.object.heaps.seed = self.object.heaps.seed.wrapping_add(1);
            }
            Action::Hide => document.hide(),
            Action::ShowAll => document.show_all(),
            Action::Lock => document.lock(),
            Action::SelectAll => document.select(Selection::all(document.scene())),
            Action::SelectNone => document.select(Selection::default()),
            Action::SelectOthers => {
                let selected = document.selection().ellipsoids.clone();
                let all = Selection::all(document.scene()).ellipsoids;
                document.select(Selection::of(all.difference(&selected).copied()));
            }
            Action::AddEllipsoid => self.add_ellipsoid(),
            Action::AddCloud => document.add_cloud(),
            Action::AddPreset(preset) => self.add_preset(preset),
            _ => {}
        }
    }

    /// Whether `action` can be done now.
    pub(super) fn can(&self, action: Action) -> bool {
        let document = &self.document;
        let selection = document.selection();
        match action {
            Action::Undo => document.undo_name().is_some(),
            Action::Redo => document.redo_name().is_some(),
            Action::Job(_) => self.program.is_some(),
            Action::Revert => self.session.path().is_some() && document.is_dirty(),
            Action::Delete | Action::Duplicate | Action::Hide | Action::Lock => !selection.is_empty(),
            Action::Play | Action::RemoveTimeline => document.scene().timeline.is_some(),
            Action::KeySelected => document.scene().timeline.is_some() && !selection.ellipsoids.is_empty(),
            Action::Rename => selection.active.is_some() || selection.cloud.is_some(),
            Action::Group | Action::Grow => !selection.ellipsoids.is_empty(),
            Action::Join => {
                selection.active.is_some_and(|to| selection.ellipsoids.iter().any(|id| id.cloud != to.cloud))
            }
            Action::ShowAll => {
                let clouds = &document.scene().clouds;
                clouds.iter().any(|cloud| cloud.hidden || cloud.ellipsoids.iter().any(|e| e.hidden))
            }
            _ => true,
        }
    }

    fn add_ellipsoid(&mut self) {
        let scene = self.document.scene();
        let was_empty = scene.bounds().is_none();
        let active = self.document.selection().active.and_then(|id| self.document.ellipsoid(id));
        let center = match (active, scene.bounds()) {
            // Half inside its neighbour, on the right as one looks.
            (Some(active), _) => {
                let right = self.viewport.camera().world_from_camera() * DVec3::X;
                active.center
                    + (right.with_y(0.0).normalize_or(DVec3::X) * active.radii.max_element()).round()
            }
            (None, Some((low, high))) => (0.5 * (low + high)).round(),
            (None, None) => FIRST + DVec3::Y * scene.ground.altitude,
        };
        self.document.add_ellipsoid(center);
        self.tab = Tab::Object;
        self.frame_first(was_empty);
    }

    /// Adds another cloud of its kind each time, east of those that are there.
    fn add_preset(&mut self, preset: Preset) {
        let seed = self.next_seed();
        let there = self.document.scene().bounds();
        let offset = match (there, preset.scene(seed).bounds()) {
            (Some((_, east)), Some((low, high))) => (east.x - low.x + 0.1 * (high.x - low.x)).round(),
            _ => 0.0,
        };
        self.document.add_preset(preset, seed, DVec3::X * offset);
        self.frame_first(there.is_none());
    }

    /// Another seed each time, 1 at first.
    pub(super) fn next_seed(&mut self) -> u64 {
        self.seed += 1;
        self.seed
    }

    /// Shows the timeline or closes it; begins one where there is none.
    fn toggle_timeline(&mut self) {
        if self.document.scene().timeline.is_none() {
            self.document.edit("Add a timeline", |scene| scene.timeline = Some(Timeline::default()));
            if self.settings.shows("timeline") {
                return;
            }
        }
        self.settings.toggle("timeline");
    }

    /// Shows one panel of the inspector.
    fn inspect(&mut self, tab: Tab) {
        self.tab = tab;
        if !self.settings.shows("inspector") {
            self.settings.toggle("inspector");
        }
    }

    fn zoom(&mut self, ctx: &Context, change: impl FnOnce(f32) -> f32) {
        let zoom = change(self.settings.zoom.unwrap_or(1.0)).clamp(0.5, 3.0);
        self.settings.zoom = Some((zoom * 10.0).round() / 10.0);
        self.apply_settings(ctx);
    }

    /// Does what the keys ask for that nobody took before.
    pub(super) fn shortcuts(&mut self, ctx: &Context) {
        let covered = match &self.dialog {
            Some(Dialog::Choosing(choosing, _)) => !choosing.is_systems(),
            Some(_) => true,
            None => false,
        };
        if covered {
            return;
        }
        let typing = ctx.text_edit_focused();
        let pressed = |modifiers: Modifiers, key: Key| {
            ctx.input_mut(|input| viewport::take(input, &KeyboardShortcut::new(modifiers, key)))
        };
        let own = entries().iter().filter(|entry| !matches!(entry.action, Action::View(_)));
        let mut asked = None;
        for entry in own {
            // In a text field, letters are text, and it has an undo of its own.
            let free = |modifiers: Modifiers, key: Key| {
                let function = key.name().len() > 1 && key.name().starts_with('F');
                let texts = [Key::A, Key::C, Key::V, Key::X, Key::Y, Key::Z].contains(&key);
                !typing || function || (modifiers.command && !texts)
            };
            let keys = entry.shortcuts.iter().map(|keys| (keys.modifiers, keys.logical_key));
            if keys.into_iter().any(|(modifiers, key)| free(modifiers, key) && pressed(modifiers, key)) {
                asked = Some(entry.action);
                break;
            }
        }
        if let Some(action) = asked {
            self.perform(ctx, action);
            ctx.request_repaint();
        }
    }
}
