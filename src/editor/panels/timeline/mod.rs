//! The timeline: playing and scrubbing, and the keys as a dope sheet or as curves.

mod curves;
mod ruler;
mod sheet;
mod titles;

use eframe::egui::{Align, Context, DragValue, Layout, RichText, ScrollArea, Ui, vec2};
use egui_phosphor::regular as icon;

use self::{curves::Curves, ruler::Scale, sheet::Sheet};
use crate::{
    editor::{Document, labels::name_widget},
    scene::{
        Timeline,
        timeline::{Interpolation, Key},
    },
};

/// Width of the names of tracks, points.
const NAMES: f32 = 210.0;

/// The key that commands are about: its track's number and its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Picked {
    track: usize,
    key: Option<usize>,
}

/// What was the window's time, and what the playhead's, when playing began; s.
#[derive(Debug, Clone, Copy)]
struct Playing {
    began: f64,
    from: f64,
}

/// The panel of the timeline.
#[derive(Debug, Default)]
pub struct TimelinePanel {
    playing: Option<Playing>,
    as_curves: bool,
    picked: Option<Picked>,
    curves: Curves,
}

impl TimelinePanel {
    /// Whether it plays.
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }

    /// Plays, or stops.
    pub fn toggle_playing(&mut self, ctx: &Context, document: &Document) {
        self.playing = match (self.playing, &document.scene().timeline) {
            (None, Some(timeline)) => {
                // From the end it goes on at the beginning.
                let now = document.playhead();
                let over = !timeline.looped && now >= last_frame(timeline);
                let from = if over { 0.0 } else { now };
                Some(Playing { began: ctx.input(|input| input.time), from })
            }
            _ => None,
        };
        ctx.request_repaint();
    }

    /// Moves the playhead to where it is by the clock: frames that could not be shown in time are
    /// left out, so that a second takes a second.
    pub fn play_on(&mut self, ctx: &Context, document: &mut Document) {
        let Some(playing) = self.playing else { return };
        let Some(timeline) = &document.scene().timeline else {
            self.playing = None;
            return;
        };
        let elapsed = ctx.input(|input| input.time) - playing.began;
        let mut frame = frame_at(timeline, playing.from + elapsed);
        if !timeline.looped && frame >= i64::from(timeline.frames()) {
            frame = i64::from(timeline.frames()) - 1;
            self.playing = None;
        }
        let (time, fps) = (timeline.time_of(frame), timeline.fps);
        document.set_playhead(time);
        if self.playing.is_some() {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(0.5 / fps));
        }
    }

    /// Shows it.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document) {
        let Some(timeline) = document.scene().timeline.clone() else { return };
        self.keep_to(&timeline);
        ui.horizontal(|ui| self.head(ui, document, &timeline));
        ui.separator();
        let scale = Scale::new(ui, NAMES, &timeline);
        if let Some(frame) = ruler::ui(ui, &scale, &timeline, document.playhead()) {
            self.playing = None;
            document.set_playhead(timeline.time_of(frame));
        }
        // The panel is as high as it was dragged to, whatever is in it.
        let room = vec2(ui.available_width(), ui.available_height());
        if timeline.tracks.is_empty() {
            ui.set_min_height(room.y);
            ui.weak(
                "Nothing changes yet. Click the diamond beside a field, or press I to key what is selected.",
            );
            return;
        }
        match self.as_curves {
            true => self.curves.ui(ui, room, &scale, document, &mut self.picked),
            false => {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    Sheet { scale: &scale, timeline: &timeline }.ui(ui, document, &mut self.picked);
                });
            }
        }
    }

    /// What was picked may be gone.
    fn keep_to(&mut self, timeline: &Timeline) {
        if let Some(picked) = &mut self.picked {
            let keys = timeline.tracks.get(picked.track).map(|track| track.keys.len());
            picked.key = picked.key.filter(|key| keys.is_some_and(|keys| *key < keys));
            if keys.is_none() {
                self.picked = None;
            }
        }
    }

    fn head(&mut self, ui: &mut Ui, document: &mut Document, timeline: &Timeline) {
        if tool(ui, icon::SKIP_BACK, "To the start") {
            document.set_playhead(0.0);
            self.playing = None;
        }
        if tool(ui, icon::CARET_LEFT, "Key before") {
            self.jump(document, timeline, false);
        }
        let (mark, name) = if self.is_playing() { (icon::PAUSE, "Stop") } else { (icon::PLAY, "Play") };
        if tool(ui, mark, name) {
            self.toggle_playing(ui.ctx(), document);
        }
        if tool(ui, icon::CARET_RIGHT, "Key after") {
            self.jump(document, timeline, true);
        }
        let mut frame = frame_at(timeline, document.playhead()) + 1;
        let last = i64::from(timeline.frames());
        ui.label("Frame");
        let response =
            ui.add(DragValue::new(&mut frame).range(1..=last).clamp_existing_to_range(false).speed(0.2));
        name_widget(ui, &response, "Frame");
        if response.changed() {
            self.playing = None;
            document.set_playhead(timeline.time_of(frame - 1));
        }
        ui.weak(format!("of {last} at {:.2} s", document.playhead()));
        ui.separator();
        settings(ui, document, timeline);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let response = ui.selectable_label(self.as_curves, format!("{} Curves", icon::BEZIER_CURVE));
            name_widget(ui, &response, "Curves");
            if response.clicked() {
                self.as_curves ^= true;
            }
            if let Some(Picked { track, key: Some(key) }) = self.picked {
                key_tools(ui, document, timeline, (track, key));
            }
        });
    }

    /// To the next key of any track, or the one before.
    fn jump(&mut self, document: &mut Document, timeline: &Timeline, forward: bool) {
        self.playing = None;
        let now = document.playhead();
        let least = 0.5 / timeline.fps;
        let times = timeline.tracks.iter().flat_map(|track| &track.keys).map(|key| key.time);
        let next = if forward {
            times.filter(|time| *time > now + least).min_by(f64::total_cmp)
        } else {
            times.filter(|time| *time < now - least).max_by(f64::total_cmp)
        };
        if let Some(time) = next {
            document.set_playhead(time);
        }
    }
}

/// Length, frames per second, loop.
fn settings(ui: &mut Ui, document: &mut Document, timeline: &Timeline) {
    let mut new = timeline.clone();
    let length = DragValue::new(&mut new.length).range(0.01..=1e6).suffix(" s").speed(0.05);
    let length = ui.add(length.update_while_editing(false)).on_hover_text("How long it is");
    name_widget(ui, &length, "Length");
    let fps = DragValue::new(&mut new.fps).range(0.1..=1000.0).suffix(" fps").speed(0.1);
    let fps = ui.add(fps.update_while_editing(false)).on_hover_text("Frames per second");
    name_widget(ui, &fps, "Frames per second");
    let looped = ui.toggle_value(&mut new.looped, format!("{} Loop", icon::REPEAT));
    let looped = looped.on_hover_text("The end leads into the beginning.");
    name_widget(ui, &looped, "Loop");
    if new == *timeline {
        return;
    }
    if new.looped {
        // A loop is a whole number of frames long.
        new.length = f64::from(new.frames()) / new.fps;
    }
    let last = new.tracks.iter().flat_map(|track| &track.keys).map(|key| key.time).fold(0.0, f64::max);
    new.length = new.length.max(last);
    let field = length.union(fps).union(looped).id.value();
    document.adjust("Change the timeline", field, |scene| scene.timeline = Some(new));
}

/// What is done with the picked key.
fn key_tools(ui: &mut Ui, document: &mut Document, timeline: &Timeline, (track, key): (usize, usize)) {
    let Some(now) = timeline.tracks.get(track).and_then(|track| track.keys.get(key)).copied() else { return };
    if tool(ui, icon::TRASH, "Delete key") {
        edit(document, "Delete key", |timeline| {
            timeline.tracks[track].keys.remove(key);
            timeline.tracks.retain(|track| !track.keys.is_empty());
        });
        return;
    }
    let ways =
        [(Interpolation::Cubic, "Cubic"), (Interpolation::Linear, "Linear"), (Interpolation::Step, "Step")];
    for (interpolation, name) in ways {
        let response = ui.selectable_label(now.interpolation == interpolation, name);
        name_widget(ui, &response, &format!("{name} key"));
        if response.on_hover_text("How it goes from here to the next key").clicked() {
            set(document, "Change the curve", (track, key), Key { interpolation, ..now });
        }
    }
    if (now.before, now.after) != (None, None) && tool(ui, icon::MAGIC_WAND, "Smooth handles") {
        set(document, "Smooth handles", (track, key), Key { before: None, after: None, ..now });
    }
    ui.weak(RichText::new("Key:"));
}

fn tool(ui: &mut Ui, mark: &str, name: &str) -> bool {
    let response = ui.button(mark).on_hover_text(name);
    name_widget(ui, &response, name);
    response.clicked()
}

fn edit(document: &mut Document, what: &'static str, change: impl FnOnce(&mut Timeline)) {
    document.edit(what, |scene| {
        if let Some(timeline) = &mut scene.timeline {
            change(timeline);
        }
    });
}

fn set(document: &mut Document, what: &'static str, (track, key): (usize, usize), value: Key) {
    edit(document, what, |timeline| timeline.tracks[track].keys[key] = value);
}

/// The same while a hand drags it: one step of undo.
fn drag(document: &mut Document, (track, key): (usize, usize), value: Key) {
    let field = (track as u64) << 32 | key as u64;
    document.adjust("Move key", field, |scene| {
        if let Some(timeline) = &mut scene.timeline {
            timeline.tracks[track].keys[key] = value;
        }
    });
}

/// `time` (s) on a frame and between the neighbours of the key that is dragged there.
fn free_time(timeline: &Timeline, (track, key): (usize, usize), time: f64) -> f64 {
    let keys = &timeline.tracks[track].keys;
    let frame = 1.0 / timeline.fps;
    let low = key.checked_sub(1).map_or(0.0, |before| keys[before].time + frame);
    let high = keys.get(key + 1).map_or(timeline.length, |after| after.time - frame);
    let snapped = ((time * timeline.fps).round() / timeline.fps).max(0.0);
    if low <= high { snapped.clamp(low, high) } else { keys[key].time }
}

/// The number of the frame at `time`, s, from 0 on; a frame is seen until the next begins.
fn frame_at(timeline: &Timeline, time: f64) -> i64 {
    // Times of frames are rounded: a little more than the frame itself.
    (time * timeline.fps + 1e-6).floor() as i64
}

fn last_frame(timeline: &Timeline) -> f64 {
    timeline.time_of(i64::from(timeline.frames()) - 1)
}
