//! The dope sheet: a row a track, a diamond a key.

use eframe::egui::{Align2, Rect, Sense, Stroke, TextStyle, Ui, pos2, vec2};

use super::{NAMES, Picked, drag, free_time, ruler::Scale, titles::title};
use crate::{
    editor::{Document, keying::diamond, labels::name_widget},
    scene::{Timeline, timeline::Key},
};

const ROW: f32 = 20.0;
/// Half the width of what can be gripped of a key, points.
const GRIP: f32 = 7.0;

/// The rows of all tracks.
pub struct Sheet<'a> {
    /// Where times are.
    pub scale: &'a Scale,
    /// The tracks.
    pub timeline: &'a Timeline,
}

impl Sheet<'_> {
    /// Shows the rows; keys are picked by a click and moved by a drag.
    pub fn ui(&self, ui: &mut Ui, document: &mut Document, picked: &mut Option<Picked>) {
        for (index, track) in self.timeline.tracks.iter().enumerate() {
            let (room, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
            self.name(ui, room, index, (&track.path, &title(&track.path, document.scene())), picked);
            let line = ui.visuals().widgets.noninteractive.bg_stroke;
            ui.painter().hline(self.scale.x, room.center().y, Stroke::new(1.0, line.color));
            for (key, value) in track.keys.iter().enumerate() {
                self.key(ui, room.center().y, (index, key), value, (document, picked));
            }
        }
    }

    fn name(
        &self,
        ui: &Ui,
        room: Rect,
        index: usize,
        (path, title): (&str, &str),
        picked: &mut Option<Picked>,
    ) {
        let area = room.with_max_x(room.left() + NAMES);
        let response = ui.interact(area, ui.id().with(("track", index)), Sense::click());
        name_widget(ui, &response, path);
        let is_picked = picked.is_some_and(|picked| picked.track == index);
        let color = if is_picked { ui.visuals().strong_text_color() } else { ui.visuals().text_color() };
        let font = TextStyle::Small.resolve(ui.style());
        let painter = ui.painter_at(area);
        // The end of a title tells more than its beginning.
        let galley = painter.layout_no_wrap(title.to_owned(), font, color);
        let left = area.left().min(area.right() - 6.0 - galley.size().x);
        let at = Align2::LEFT_CENTER.anchor_size(pos2(left, area.center().y), galley.size());
        painter.galley(at.min, galley, color);
        if response.on_hover_text(path).clicked() {
            *picked = Some(Picked { track: index, key: None });
        }
    }

    fn key(
        &self,
        ui: &Ui,
        y: f32,
        (track, key): (usize, usize),
        value: &Key,
        (document, picked): (&mut Document, &mut Option<Picked>),
    ) {
        let at = pos2(self.scale.x(value.time), y);
        let area = Rect::from_center_size(at, vec2(2.0 * GRIP, ROW));
        let response = ui.interact(area, ui.id().with(("key", track, key)), Sense::click_and_drag());
        let path = &self.timeline.tracks[track].path;
        name_widget(ui, &response, &format!("Key {} of {path}", key + 1));
        let own = Picked { track, key: Some(key) };
        if response.clicked() || response.drag_started() {
            *picked = Some(own);
        }
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let time = free_time(self.timeline, (track, key), self.scale.time(pointer.x));
            drag(document, (track, key), Key { time, ..*value });
        }
        let lit = *picked == Some(own) || response.hovered();
        let color = if lit { ui.visuals().hyperlink_color } else { ui.visuals().text_color() };
        diamond(ui.painter(), at, 5.0, color, true);
        response.on_hover_text(format!("{} at {:.3} s", value.value, value.time));
    }
}
