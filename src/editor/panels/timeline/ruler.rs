//! Time from left to right: the scale that everything in the panel shares, and the ruler on top.

use eframe::egui::{Align2, Painter, Rangef, Rect, Sense, Stroke, TextStyle, Ui, pos2, vec2};

use super::frame_at;
use crate::{editor::labels::name_widget, scene::Timeline};

const HEIGHT: f32 = 20.0;
/// Least distance of two ticks with numbers, points.
const TICKS: f32 = 56.0;
/// Room at both ends, so that keys there can be gripped, points.
const MARGIN: f32 = 12.0;

/// Where times are on the screen.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// From 0 to the end.
    pub x: Rangef,
    length: f64,
}

impl Scale {
    /// The whole timeline beside names that are `names` points wide.
    pub fn new(ui: &Ui, names: f32, timeline: &Timeline) -> Self {
        let room = ui.available_rect_before_wrap();
        let left = room.left() + names + MARGIN;
        Self { x: Rangef::new(left, (room.right() - MARGIN).max(left + 1.0)), length: timeline.length }
    }

    /// Where `time` (s) is.
    pub fn x(&self, time: f64) -> f32 {
        self.x.min + self.x.span() * (time / self.length) as f32
    }

    /// What time (s) is there, also beyond the ends.
    pub fn time(&self, x: f32) -> f64 {
        f64::from((x - self.x.min) / self.x.span()) * self.length
    }
}

/// Shows the ruler and the playhead; the frame that a person scrubbed to.
pub fn ui(ui: &mut Ui, scale: &Scale, timeline: &Timeline, playhead: f64) -> Option<i64> {
    let (room, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let area = Rect::from_x_y_ranges(scale.x.expand(MARGIN), room.y_range());
    let response = ui.interact(area, ui.id().with("ruler"), Sense::click_and_drag());
    name_widget(ui, &response, "Ruler");
    ticks(ui, scale, timeline, area);
    let below = Rangef::new(room.top(), ui.max_rect().bottom());
    head(ui.painter(), scale.x(playhead), below, ui.visuals().hyperlink_color);
    let at = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked())?;
    let last = i64::from(timeline.frames()) - 1;
    // The nearest frame, not the one that is seen then: half a frame more.
    Some(frame_at(timeline, scale.time(at.x) + 0.5 / timeline.fps).clamp(0, last))
}

fn ticks(ui: &Ui, scale: &Scale, timeline: &Timeline, area: Rect) {
    let most = f64::from(scale.x.span() / TICKS).max(1.0);
    let step = nice(f64::from(timeline.frames()) / most);
    let (color, font) = (ui.visuals().weak_text_color(), TextStyle::Small.resolve(ui.style()));
    let mut frame = 0.0;
    while frame < f64::from(timeline.frames()) {
        let x = scale.x(frame / timeline.fps);
        ui.painter().vline(x, Rangef::new(area.bottom() - 4.0, area.bottom()), Stroke::new(1.0, color));
        let text = (frame as i64 + 1).to_string();
        ui.painter().text(pos2(x, area.top() + 7.0), Align2::CENTER_CENTER, text, font.clone(), color);
        frame += step;
    }
}

/// The next of 1, 2, 5, 10, 20 and so on.
fn nice(least: f64) -> f64 {
    let power = 10f64.powf(least.max(1.0).log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|n| n * power).into_iter().find(|step| *step >= least).unwrap_or(10.0 * power)
}

fn head(painter: &Painter, x: f32, y: Rangef, color: eframe::egui::Color32) {
    painter.vline(x, y, Stroke::new(1.0, color));
    painter.circle_filled(pos2(x, y.min + 3.0), 3.5, color);
}

#[cfg(test)]
mod tests {
    use super::nice;

    #[test]
    fn ticks_are_round_numbers_apart() {
        let expected =
            [(0.3, 1.0), (1.0, 1.0), (1.2, 2.0), (2.1, 5.0), (7.0, 10.0), (12.0, 20.0), (240.0, 500.0)];
        for (least, step) in expected {
            assert_eq!(nice(least), step, "{least}");
        }
    }
}
