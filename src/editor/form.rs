//! Rows of fields: label, value, reset. Names are given here; help, range and unit come from
//! the scene's schema.

use std::ops::RangeInclusive;

use eframe::egui::{
    self, Align, Align2, DragValue, Layout, Rect, Response, RichText, Slider, Ui, UiBuilder, emath::Numeric,
    vec2,
};
use egui_phosphor::regular as icon;
use glam::{DQuat, DVec3, EulerRot};

use super::{
    Document,
    keying::{Keying, key_button},
    labels::name_widget,
    theme::LABEL_WIDTH,
    words::{Word, word},
};

/// Width of the number beside a slider, points.
const VALUE_WIDTH: f32 = 74.0;

/// Width kept for the button that resets a field, points, and for the one that keys it.
const RESET_WIDTH: f32 = 22.0;
const KEY_WIDTH: f32 = 18.0;

/// Ranges as wide as this, or wider, are dragged rather than slid.
const SLIDER_SPAN: f64 = 20.0;

/// What the numbers of a field are called behind its path.
const NUMBER: [&str; 1] = [""];
const VECTOR: [&str; 3] = ["[0]", "[1]", "[2]"];
const ROTATION: [&str; 4] = ["[0]", "[1]", "[2]", "[3]"];

/// The rows of one part of the scene. It edits a copy; the caller puts the copy into the
/// document where [`Form::changed`] says so.
pub struct Form<'a> {
    ui: &'a mut Ui,
    /// Where fields can be keyed.
    keying: Option<Keying>,
    /// Why the next rows do nothing, where that is so.
    off: Option<&'static str>,
    changed: Option<Change>,
}

/// The field that was changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// Name of the field, for the menu's "Undo ...".
    pub name: &'static str,
    /// Path of the field in the schema.
    pub path: &'static str,
    /// Tells this field from all others on the screen.
    pub field: u64,
    /// The numbers whose keys shall be set or taken away, where that was asked for instead.
    pub keys: Option<Vec<String>>,
}

impl<'a> Form<'a> {
    /// Rows at the end of `ui`.
    pub fn new(ui: &'a mut Ui) -> Self {
        Self { ui, keying: None, off: None, changed: None }
    }

    /// Lets fields be keyed where the document has a timeline; `object` is the path of the cloud or the
    /// ellipsoid that the rows are about, empty for the world.
    pub fn keyed(mut self, document: &Document, object: &str) -> Self {
        self.keying = Keying::of(document, object);
        self
    }

    /// Whether the next rows change anything: where they do not they are off, and `why`, a sentence, is their help.
    pub fn works(&mut self, works: bool, why: &'static str) {
        self.off = (!works).then_some(why);
    }

    /// The field that was changed in this frame.
    pub fn changed(self) -> Option<Change> {
        self.changed
    }

    /// Where the rows are.
    pub fn ui(&mut self) -> &mut Ui {
        self.ui
    }

    /// A number: a slider where the whole range is of use, else to be dragged.
    pub fn number(&mut self, path: &'static str, name: &'static str, value: &mut f64, default: f64) {
        let about = word(path);
        if about.max - about.min <= SLIDER_SPAN {
            return self.slider(path, name, value, default, about.min..=about.max);
        }
        let help = explained(about, &told(default, about.unit));
        self.row(path, name, &help, value, default, &NUMBER, |ui, value| {
            let speed = speed_at(*value, about);
            named(ui, name, |ui| sized(ui, |ui| ui.add(number(value, about).speed(speed))))
        });
    }

    /// A number of which only part of the range is of use every day: a slider over `usual`;
    /// any other value of the range can be typed.
    pub fn slider(
        &mut self,
        path: &'static str,
        name: &'static str,
        value: &mut f64,
        default: f64,
        usual: RangeInclusive<f64>,
    ) {
        let about = word(path);
        let help = explained(about, &told(default, about.unit));
        self.row(path, name, &help, value, default, &NUMBER, |ui, value| {
            slide(ui, name, about, value, usual)
        });
    }

    /// A whole number.
    pub fn whole(&mut self, path: &'static str, name: &'static str, value: &mut u32, default: u32) {
        let help = explained(word(path), &default.to_string());
        self.row(path, name, &help, value, default, &NUMBER, |ui, value| {
            named(ui, name, |ui| sized(ui, |ui| ui.add(DragValue::new(value).update_while_editing(false))))
        });
    }

    /// A vector: three numbers under one another's names.
    pub fn vector(&mut self, path: &'static str, name: &'static str, value: &mut DVec3, default: DVec3) {
        let about = word(path);
        let help = explained(about, &format!("{}, {}, {}{}", default.x, default.y, default.z, about.unit));
        self.row(path, name, &help, value, default, &VECTOR, |ui, value| {
            three(ui, name, ["X", "Y", "Z"], value.as_mut(), |ui, value| {
                let speed = speed_at(*value, about);
                ui.add(compact(value, about.unit).range(about.min..=about.max).speed(speed))
            })
        });
    }

    /// A rotation, as turns about three axes in degrees: about y first, then x, then z.
    pub fn rotation(&mut self, path: &'static str, name: &'static str, value: &mut DQuat) {
        let help = explained(word(path), "no rotation");
        self.row(path, name, &help, value, DQuat::IDENTITY, &ROTATION, |ui, value| {
            let (yaw, pitch, roll) = value.to_euler(EulerRot::YXZ);
            // Adding zero makes -0 a 0.
            let mut turns = [pitch, yaw, roll].map(|turn| (turn.to_degrees() * 1e6).round() / 1e6 + 0.0);
            let response = three(ui, name, ["X", "Y", "Z"], &mut turns, |ui, turn| {
                ui.add(compact(turn, "°").speed(0.5))
            });
            if response.changed() {
                let [pitch, yaw, roll] = turns.map(f64::to_radians);
                *value = DQuat::from_euler(EulerRot::YXZ, yaw, pitch, roll).normalize();
            }
            response
        });
    }

    /// A colour as linear light: a swatch where it is no brighter than white, and its numbers.
    pub fn color(&mut self, path: &'static str, name: &'static str, value: &mut [f64; 3], default: [f64; 3]) {
        let about = word(path);
        let help = explained(about, &format!("{}, {}, {}", default[0], default[1], default[2]));
        self.row(path, name, &help, value, default, &VECTOR, |ui, value| {
            let mut swatch = None;
            if about.max <= 1.0 {
                let mut color = value.map(|c| c as f32);
                let response = egui::color_picker::color_edit_button_rgb(ui, &mut color);
                if response.changed() {
                    *value = color.map(|c| (f64::from(c) * 1e4).round() / 1e4);
                }
                swatch = Some(response);
            }
            let numbers = three(ui, name, ["R", "G", "B"], value, |ui, value| {
                ui.add(compact(value, about.unit).range(about.min..=about.max).speed(0.005))
            });
            swatch.map_or(numbers.clone(), |swatch| swatch.union(numbers))
        });
    }

    /// A line of text.
    pub fn text(&mut self, path: &'static str, name: &'static str, value: &mut String, hint: &'static str) {
        let help = explained(word(path), "");
        self.row(path, name, &help, value, String::new(), &[], |ui, value| {
            let field = egui::TextEdit::singleline(value).hint_text(hint).desired_width(ui.available_width());
            named(ui, name, |ui| ui.add(field))
        });
    }

    /// Yes or no.
    pub fn check(&mut self, path: &'static str, name: &'static str, value: &mut bool, default: bool) {
        let help = explained(word(path), if default { "yes" } else { "no" });
        self.row(path, name, &help, value, default, &[], |ui, value| {
            named(ui, name, |ui| ui.checkbox(value, ""))
        });
    }

    /// One of several choices; each is a name, what it is, and the value that it begins with.
    pub fn choice<T: Clone + PartialEq>(
        &mut self,
        path: &'static str,
        name: &'static str,
        value: &mut T,
        choices: &[(&str, &str, T)],
    ) {
        let kind = |value: &T| std::mem::discriminant(value);
        let chosen = choices.iter().find(|(_, _, v)| kind(v) == kind(value)).map_or("", |(name, ..)| *name);
        let help = explained(word(path), choices.first().map_or("", |(name, ..)| *name));
        let default = choices.first().map_or_else(|| value.clone(), |(_, _, value)| value.clone());
        self.row(path, name, &help, value, default, &[], |ui, value| {
            let mut picked = false;
            let box_id = ui.id().with(path);
            let mut response = egui::ComboBox::from_id_salt(box_id)
                .width(ui.available_width())
                .selected_text(chosen)
                .show_ui(ui, |ui| {
                    for (name, help, begins) in choices {
                        let is_it = kind(begins) == kind(value);
                        if ui.selectable_label(is_it, *name).on_hover_text(*help).clicked() && !is_it {
                            *value = begins.clone();
                            picked = true;
                        }
                    }
                })
                .response;
            name_widget(ui, &response, name);
            if picked {
                response.mark_changed();
            }
            response
        });
    }

    /// Label, widget, reset, key; notes what changed. `numbers` is what those that can be keyed are
    /// called behind the path.
    #[allow(clippy::too_many_arguments, reason = "what a row is made of")]
    fn row<T: Clone + PartialEq>(
        &mut self,
        path: &'static str,
        name: &'static str,
        help: &str,
        value: &mut T,
        default: T,
        numbers: &[&str],
        widget: impl FnOnce(&mut Ui, &mut T) -> Response,
    ) {
        let before = value.clone();
        let differs = *value != default;
        let off = self.off;
        let told = off.map(|why| format!("Does nothing now. {why}\n\n{help}"));
        let help = told.as_deref().unwrap_or(help);
        let keys = self.keying.as_ref().and_then(|keying| keying.keys(path, numbers));
        let key_room = if self.keying.is_some() { KEY_WIDTH } else { 0.0 };
        let (id, reset, key) = self
            .ui
            .push_id((path, name), |ui| {
                // Rooms of a given size: no row can make the panel wider.
                let (row, _) = ui.allocate_exact_size(
                    vec2(ui.available_width(), ui.spacing().interact_size.y),
                    egui::Sense::hover(),
                );
                let (row, beside) = row.split_left_right_at_x(row.right() - key_room);
                let [name_room, room, reset_room] = rooms(row);
                label(&mut room_in(ui, name_room), name).on_hover_text(help);
                let mut inside = room_in(ui, room);
                if off.is_some() {
                    inside.disable();
                }
                let response = widget(&mut inside, value).on_hover_text(help).on_disabled_hover_text(help);
                let reset = differs && reset_button(&mut room_in(ui, reset_room), name);
                let key = keys.as_ref().is_some_and(|(_, keyed)| key_button(ui, beside, name, *keyed));
                (response.id, reset, key)
            })
            .inner;
        if reset {
            *value = default;
        }
        let keys = keys.filter(|_| key).map(|(paths, _)| paths);
        if *value != before || keys.is_some() {
            self.changed = Some(Change { name, path, field: id.value(), keys });
        }
    }
}

/// The rooms of a row: label, widget, reset.
fn rooms(row: Rect) -> [Rect; 3] {
    let (name, rest) = row.split_left_right_at_x(row.left() + LABEL_WIDTH);
    let (widget, reset) = rest.split_left_right_at_x(row.right() - RESET_WIDTH);
    [name, widget, reset.with_min_x(reset.left() + 6.0)]
}

fn room_in(ui: &mut Ui, room: Rect) -> Ui {
    let layout = Layout::left_to_right(Align::Center);
    let mut inside = ui.new_child(UiBuilder::new().max_rect(room).layout(layout).id_salt(room.left() as i32));
    inside.shrink_clip_rect(room.expand(2.0));
    inside
}

/// The label of a row, cut where it is too long. It is painted only: the widget beside it
/// says the same name to who can't see it.
fn label(ui: &mut Ui, name: &str) -> Response {
    let room = ui.max_rect();
    let (font, color) = (egui::TextStyle::Body.resolve(ui.style()), ui.visuals().weak_text_color());
    ui.painter().text(room.left_center(), Align2::LEFT_CENTER, name, font, color);
    ui.interact(room, ui.id().with("label"), egui::Sense::hover())
}

fn reset_button(ui: &mut Ui, name: &str) -> bool {
    let text = RichText::new(icon::ARROW_COUNTER_CLOCKWISE).size(12.0);
    let button = egui::Button::new(text).frame(false);
    let response = ui.add(button).on_hover_text("Back to the default");
    name_widget(ui, &response, &format!("Reset {name}"));
    response.clicked()
}

fn number<'a>(value: &'a mut f64, about: &Word) -> DragValue<'a> {
    DragValue::new(value)
        .range(about.min..=about.max)
        .suffix(about.unit)
        .custom_parser(|text| read_number(text, about.unit))
        .max_decimals(3)
        .update_while_editing(false)
}

/// Letters that one of three numbers beside each other has room for.
const ROOM: usize = 7;

/// A number that has little room: without its unit, and with as many digits as there is room for. Where
/// nobody changes its text, it stays as exact as it was.
fn compact<'a>(value: &'a mut f64, unit: &str) -> DragValue<'a> {
    let (exact, shown, unit) = (*value, short(*value), unit.to_owned());
    DragValue::new(value)
        .custom_formatter(|value, _| short(value))
        .custom_parser(move |text| if text == shown { Some(exact) } else { read_number(text, &unit) })
        .update_while_editing(false)
}

/// `value` in [`ROOM`] letters, where that is possible, and with three decimals at most.
fn short(value: f64) -> String {
    let told = |decimals: usize| format!("{value:.decimals$}");
    let text = (1..=3).rev().map(told).find(|text| text.len() <= ROOM).unwrap_or_else(|| told(0));
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A number as people type it: with its unit or without, with a comma for the point.
fn read_number(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let bare = text.strip_suffix(unit.trim()).unwrap_or(text).trim().replace('\u{2212}', "-");
    bare.parse().ok().or_else(|| bare.replacen(',', ".", 1).parse().ok()).filter(|x: &f64| x.is_finite())
}

/// A slider over what is usual, and the number beside it.
fn slide(ui: &mut Ui, name: &str, about: &Word, value: &mut f64, usual: RangeInclusive<f64>) -> Response {
    let gap = ui.spacing().item_spacing.x;
    ui.spacing_mut().slider_width = (ui.available_width() - VALUE_WIDTH - gap).max(40.0);
    let span = usual.end() - usual.start();
    let slider = Slider::new(value, usual).show_value(false).clamping(egui::SliderClamping::Never);
    let slid = named(ui, &format!("{name} slider"), |ui| ui.add(slider));
    if slid.changed() {
        *value = rounded(*value, span).clamp(about.min, about.max);
    }
    let typed = named(ui, name, |ui| sized(ui, |ui| ui.add(number(value, about).speed(span * 2e-3))));
    typed.union(slid)
}

/// `value` to a thousandth of `span`: nobody means more digits by a slider.
fn rounded(value: f64, span: f64) -> f64 {
    let digits = -(span * 1e-3).log10().floor();
    let scale = 10f64.powf(digits);
    (value * scale).round() / scale
}

/// A widget with a name that is not on it.
fn named(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    let response = add(ui);
    name_widget(ui, &response, name);
    response
}

/// A number as wide as there is room.
fn sized(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    ui.spacing_mut().interact_size.x = ui.available_width();
    add(ui)
}

/// What a point of dragging changes: a hundredth of what there is, or a thousandth of a small range.
fn speed_at(value: f64, about: &Word) -> f64 {
    let span = about.max - about.min;
    if span <= 1e3 { (span * 2e-3).max(1e-4) } else { (value.abs() * 5e-3).max(0.1) }
}

/// Three numbers side by side, named for the one who can't see the letters.
fn three(
    ui: &mut Ui,
    name: &str,
    axes: [&str; 3],
    values: &mut [f64; 3],
    mut add: impl FnMut(&mut Ui, &mut f64) -> Response,
) -> Response {
    let gap = 3.0;
    ui.spacing_mut().item_spacing.x = gap;
    ui.spacing_mut().button_padding.x = 3.0;
    ui.spacing_mut().interact_size.x = (ui.available_width() - 2.0 * gap) / 3.0;
    if values.iter().any(|value| short(*value).len() >= ROOM) {
        ui.style_mut().drag_value_text_style = egui::TextStyle::Small;
    }
    let mut all: Option<Response> = None;
    for (axis, value) in axes.iter().zip(values) {
        let response = add(ui, value);
        name_widget(ui, &response, &format!("{name} {axis}"));
        all = Some(all.map_or(response.clone(), |all| all.union(response)));
    }
    all.unwrap_or_else(|| ui.label(""))
}

/// Help, range and default of a field.
fn explained(about: &Word, default: &str) -> String {
    match default {
        "" => about.help.clone(),
        default => format!("{}\n\nDefault: {default}", about.help),
    }
}

fn told(value: impl Numeric + std::fmt::Display, unit: &str) -> String {
    format!("{value}{unit}")
}

#[cfg(test)]
mod tests {
    use super::{read_number, short};

    #[test]
    fn numbers_beside_each_other_have_as_many_digits_as_there_is_room_for() {
        let shown = [
            (0.0, "0"),
            (100.0, "100"),
            (-0.1254, "-0.125"),
            (2196.34, "2196.34"),
            (-12345.678, "-12346"),
            (100234.56, "100235"),
            (-9_999_999.0, "-9999999"),
            (106.26, "106.26"),
            (-106.264, "-106.26"),
        ];
        shown.iter().for_each(|(value, text)| assert_eq!(short(*value), *text));
    }

    #[test]
    fn numbers_are_read_as_people_type_them() {
        for text in ["1150", " 1150 m", "1150m", "1.15e3", "1150,0", "1150.0 m "] {
            assert_eq!(read_number(text, " m"), Some(1150.0), "{text}");
        }
        assert_eq!(read_number("\u{2212}2", ""), Some(-2.0));
        for text in ["", "m", "1,150,0", "fifty", "inf"] {
            assert_eq!(read_number(text, " m"), None, "{text}");
        }
    }
}
