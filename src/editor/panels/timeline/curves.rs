//! The curve of one track: keys and handles to be dragged.

use eframe::egui::{
    Align2, Color32, Painter, Pos2, Rangef, Rect, Response, ScrollArea, Sense, Shape, Stroke, TextStyle, Ui,
    UiBuilder, Vec2, pos2, vec2,
};

use super::{NAMES, Picked, drag, free_time, ruler::Scale, titles::title};
use crate::{
    editor::{Document, keying::diamond, labels::name_widget, tracks},
    scene::{
        Scene, Timeline,
        timeline::{Curve, Key},
    },
};

/// Half the width of what can be gripped, points.
const GRIP: f32 = 7.0;
/// Room above and below the curve, points.
const MARGIN: f32 = 16.0;
/// Points between two samples of the line.
const SAMPLE: f32 = 2.0;

/// The curve view.
#[derive(Debug, Default)]
pub struct Curves {
    /// The values that are shown; they stay while something is dragged.
    shown: Option<(f64, f64)>,
}

/// Where values are on the screen.
#[derive(Clone, Copy)]
struct Values {
    y: Rangef,
    low: f64,
    high: f64,
}

impl Values {
    fn y(&self, value: f64) -> f32 {
        self.y.max - self.y.span() * ((value - self.low) / (self.high - self.low)) as f32
    }

    fn value(&self, y: f32) -> f64 {
        self.low + f64::from((self.y.max - y) / self.y.span()) * (self.high - self.low)
    }
}

impl Curves {
    /// Names on the left, the curve of the picked track on the right.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        size: Vec2,
        scale: &Scale,
        document: &mut Document,
        picked: &mut Option<Picked>,
    ) {
        let Some(timeline) = document.scene().timeline.clone() else { return };
        let now = picked.get_or_insert(Picked { track: 0, key: None }).track;
        let (room, _) = ui.allocate_exact_size(size, Sense::hover());
        names(ui, room.with_max_x(room.left() + NAMES), document.scene(), picked);
        let Some(curve) = tracks::curve(&timeline, now) else { return };
        let values = self.values(ui, &curve, Rangef::new(room.top() + MARGIN, room.bottom() - MARGIN));
        line(ui, room, scale, &values, &curve);
        let plot = Plot { scale, values, timeline: &timeline, curve: &curve, track: now };
        for key in 0..timeline.tracks[now].keys.len() {
            plot.key(ui, key, document, picked);
        }
    }

    /// All that the curve reaches; while a hand holds something the plane does not move under it.
    fn values(&mut self, ui: &Ui, curve: &Curve, y: Rangef) -> Values {
        let (low, high) = match self.shown {
            Some(shown) if ui.input(|input| input.pointer.any_down()) => shown,
            _ => {
                let (low, high) = curve.reach();
                let flat = 1e-9 + 1e-6 * low.abs();
                if high - low < flat {
                    (low - 0.5 * low.abs().max(1.0), high + 0.5 * low.abs().max(1.0))
                } else {
                    (low, high)
                }
            }
        };
        self.shown = Some((low, high));
        Values { y: Rangef::new(y.min, y.max.max(y.min + 1.0)), low, high }
    }
}

fn names(ui: &mut Ui, room: Rect, scene: &Scene, picked: &mut Option<Picked>) {
    let mut inside = ui.new_child(UiBuilder::new().max_rect(room.shrink2(vec2(4.0, 0.0))).id_salt("names"));
    ScrollArea::vertical().auto_shrink(false).show(&mut inside, |ui| {
        for (index, track) in scene.timeline.iter().flat_map(|timeline| &timeline.tracks).enumerate() {
            let is_it = picked.is_some_and(|picked| picked.track == index);
            let text = eframe::egui::RichText::new(title(&track.path, scene)).small();
            if ui.selectable_label(is_it, text).on_hover_text(&track.path).clicked() {
                *picked = Some(Picked { track: index, key: None });
            }
        }
    });
}

fn line(ui: &Ui, room: Rect, scale: &Scale, values: &Values, curve: &Curve) {
    let painter = ui.painter_at(room.with_min_x(scale.x.min - GRIP));
    let (weak, font) = (ui.visuals().weak_text_color(), TextStyle::Small.resolve(ui.style()));
    for value in [values.low, values.high] {
        let y = values.y(value);
        painter.hline(scale.x, y, Stroke::new(0.5, weak.gamma_multiply(0.4)));
        let text = format!("{:.3}", value);
        painter.text(pos2(scale.x.max, y - 2.0), Align2::RIGHT_BOTTOM, text, font.clone(), weak);
    }
    let samples = (scale.x.span() / SAMPLE).ceil() as usize;
    let at = |i: usize| {
        let x = (scale.x.min + SAMPLE * i as f32).min(scale.x.max - 0.01);
        pos2(x, values.y(curve.at(scale.time(x))))
    };
    let points: Vec<Pos2> = (0..=samples).map(at).collect();
    painter.add(Shape::line(points, Stroke::new(1.5, ui.visuals().hyperlink_color)));
}

/// One curve where it is.
struct Plot<'a> {
    scale: &'a Scale,
    values: Values,
    timeline: &'a Timeline,
    curve: &'a Curve,
    track: usize,
}

impl Plot<'_> {
    fn place(&self, [time, value]: [f64; 2]) -> Pos2 {
        pos2(self.scale.x(time), self.values.y(value))
    }

    fn key(&self, ui: &Ui, key: usize, document: &mut Document, picked: &mut Option<Picked>) {
        let value = self.timeline.tracks[self.track].keys[key];
        let own = Picked { track: self.track, key: Some(key) };
        if *picked == Some(own) {
            self.handles(ui, key, &value, document);
        }
        let at = self.place([value.time, value.value]);
        let response = grip(ui, at, ("curve key", self.track, key), &format!("Point {}", key + 1));
        if response.clicked() || response.drag_started() {
            *picked = Some(own);
        }
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let time = free_time(self.timeline, (self.track, key), self.scale.time(pointer.x));
            let moved = Key { time, value: self.values.value(pointer.y), ..value };
            drag(document, (self.track, key), moved);
        }
        let lit = *picked == Some(own) || response.hovered();
        let color = if lit { ui.visuals().strong_text_color() } else { ui.visuals().text_color() };
        diamond(ui.painter(), at, 5.0, color, true);
    }

    fn handles(&self, ui: &Ui, key: usize, value: &Key, document: &mut Document) {
        let at = self.place([value.time, value.value]);
        for (side, end) in self.curve.handles(key).into_iter().enumerate() {
            let Some(end) = end else { continue };
            let (tip, name) = (self.place(end), ["Handle before", "Handle after"][side]);
            arm(ui.painter(), at, tip, ui.visuals().weak_text_color());
            let response = grip(ui, tip, (name, self.track, key), name);
            let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) else {
                continue;
            };
            let seconds = self.scale.time(pointer.x) - value.time;
            let seconds = if side == 0 { seconds.min(0.0) } else { seconds.max(0.0) };
            let handle = Some([seconds, self.values.value(pointer.y) - value.value]);
            let bent =
                if side == 0 { Key { before: handle, ..*value } } else { Key { after: handle, ..*value } };
            drag(document, (self.track, key), bent);
        }
    }
}

fn grip(ui: &Ui, at: Pos2, id: (&str, usize, usize), name: &str) -> Response {
    let area = Rect::from_center_size(at, Vec2::splat(2.0 * GRIP));
    let response = ui.interact(area, ui.id().with(id), Sense::click_and_drag());
    name_widget(ui, &response, name);
    response
}

fn arm(painter: &Painter, from: Pos2, to: Pos2, color: Color32) {
    painter.line_segment([from, to], Stroke::new(1.0, color));
    painter.circle_filled(to, 3.0, color);
}
