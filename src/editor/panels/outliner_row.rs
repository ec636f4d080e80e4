//! One line of the outliner: how it looks, and what is done to it with the mouse.

use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, Id, Key, Rect, Response, Sense, Stroke, TextEdit, Ui,
    WidgetInfo, WidgetType, pos2, vec2,
};
use egui_phosphor::regular as icon;

use crate::{
    editor::{Document, EllipsoidId, Selection, labels::name_widget},
    scene::Scene,
};

/// Height of a row, points.
pub(super) const ROW: f32 = 22.0;
/// Width of an icon that can be clicked, points.
pub(super) const ICON: f32 = 20.0;

/// One line of the list, and what is dragged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Row {
    Cloud(usize),
    Ellipsoid(EllipsoidId),
}

/// What a row's icons and keys ask for.
pub(super) enum Deed {
    Click(Row),
    Rename(Row),
    Named(Row, String),
    Hide(Row),
    Lock(Row),
    Fold(usize),
    /// Puts the first before the second; at the end of its list where `bool` says "after".
    Drop(Row, Row, bool),
}

/// What a row is called: its name, or its number.
pub(super) fn name(scene: &Scene, row: Row) -> String {
    match row {
        Row::Cloud(index) => scene.clouds.get(index).map(|cloud| cloud.label(index)).unwrap_or_default(),
        Row::Ellipsoid(id) => {
            let found = scene.clouds.get(id.cloud).and_then(|cloud| cloud.ellipsoids.get(id.ellipsoid));
            found.and_then(|e| e.name.clone()).unwrap_or_else(|| format!("ellipsoid {}", id.ellipsoid + 1))
        }
    }
}

pub(super) fn flags(scene: &Scene, row: Row) -> (bool, bool) {
    match row {
        Row::Cloud(index) => scene.clouds.get(index).map(|cloud| (cloud.hidden, cloud.locked)),
        Row::Ellipsoid(id) => {
            let cloud = scene.clouds.get(id.cloud);
            cloud.and_then(|cloud| cloud.ellipsoids.get(id.ellipsoid)).map(|e| (e.hidden, e.locked))
        }
    }
    .unwrap_or_default()
}

pub(super) fn is_selected(selection: &Selection, row: Row) -> bool {
    match row {
        Row::Cloud(index) => selection.cloud == Some(index),
        Row::Ellipsoid(id) => selection.contains(id),
    }
}

pub(super) fn describe(response: &Response, title: &str, chosen: bool) {
    response.widget_info(|| WidgetInfo::selected(WidgetType::SelectableLabel, true, chosen, title));
}

pub(super) fn paint_row(
    ui: &Ui,
    rect: Rect,
    response: &Response,
    document: &Document,
    row: Row,
    title: &str,
) {
    let visuals = ui.visuals();
    let selection = document.selection();
    let active = match row {
        Row::Ellipsoid(id) => selection.active == Some(id),
        Row::Cloud(index) => selection.cloud == Some(index),
    };
    let chosen = is_selected(selection, row);
    let fill = match (chosen, active, response.hovered()) {
        (true, true, _) => visuals.selection.bg_fill,
        (true, false, _) => visuals.selection.bg_fill.gamma_multiply(0.6),
        (false, _, true) => visuals.widgets.inactive.weak_bg_fill.gamma_multiply(0.6),
        _ => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, 4.0, fill);
    let hidden = flags(document.scene(), row).0
        || matches!(row, Row::Ellipsoid(id) if flags(document.scene(), Row::Cloud(id.cloud)).0);
    let color = match (hidden, chosen) {
        (true, _) => visuals.weak_text_color().gamma_multiply(0.7),
        (false, true) => visuals.strong_text_color(),
        (false, false) => visuals.text_color(),
    };
    let (indent, mark) = match row {
        Row::Cloud(_) => (ICON, icon::CLOUD),
        Row::Ellipsoid(_) => (ICON + 16.0, icon::CIRCLE),
    };
    let font = FontId::proportional(13.0);
    let at = pos2(rect.left() + indent, rect.center().y);
    ui.painter().text(at, Align2::LEFT_CENTER, mark, FontId::proportional(14.0), color.gamma_multiply(0.8));
    let room =
        Rect::from_min_max(at + vec2(20.0, -ROW), pos2(rect.right() - 2.0 * ICON - 6.0, rect.bottom()));
    let painter = ui.painter().with_clip_rect(room.intersect(ui.clip_rect()));
    painter.text(at + vec2(20.0, 0.0), Align2::LEFT_CENTER, title, font, color);
}

/// An icon that can be clicked; nothing is seen of it where it is not `shown`.
pub(super) fn icon_button(
    ui: &mut Ui,
    rect: Rect,
    row: Row,
    text: &str,
    help: &str,
    shown: bool,
    strong: bool,
) -> bool {
    let id = ui.id().with(("icon", format!("{row:?}"), rect.left() as i32));
    let response = ui.interact(rect, id, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, help));
    if shown {
        let color = match (response.hovered(), strong) {
            (true, _) => ui.visuals().strong_text_color(),
            (false, true) => ui.visuals().text_color(),
            (false, false) => ui.visuals().weak_text_color(),
        };
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, FontId::proportional(13.0), color);
    }
    response.on_hover_text(help).clicked()
}

/// Takes a row along, and drops it between others.
pub(super) fn dragged(ui: &Ui, rect: Rect, response: &Response, row: Row) -> Option<Deed> {
    response.dnd_set_drag_payload(row);
    let hovering = response.dnd_hover_payload::<Row>()?;
    if *hovering == row {
        return None;
    }
    ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    let after = ui.input(|input| input.pointer.latest_pos()).is_some_and(|at| at.y > rect.center().y);
    let y = if after { rect.bottom() } else { rect.top() };
    let line = Stroke::new(2.0, ui.visuals().hyperlink_color);
    ui.painter().hline(rect.x_range(), y, line);
    let dropped = response.dnd_release_payload::<Row>()?;
    Some(Deed::Drop(*dropped, row, after))
}

/// The field in which a row is renamed; the name once it is entered.
pub(super) fn rename_field(ui: &mut Ui, rect: Rect, row: Row, text: &mut String) -> Option<Deed> {
    let id = Id::new("rename");
    let response = ui.put(rect.shrink2(vec2(4.0, 1.0)), TextEdit::singleline(text).id(id));
    name_widget(ui, &response, "New name");
    let escaped = ui.input(|input| input.key_pressed(Key::Escape));
    if response.lost_focus() {
        let title = if escaped { None } else { Some(text.trim().to_owned()) };
        return Some(title.map_or(Deed::Click(row), |title| Deed::Named(row, title)));
    }
    if !response.has_focus() {
        response.request_focus();
        select_all(ui.ctx(), id, text);
    }
    None
}

/// Marks all of a text field, so that typing replaces it.
fn select_all(ctx: &egui::Context, id: Id, text: &str) {
    let mut state = TextEdit::load_state(ctx, id).unwrap_or_default();
    let range = egui::text::CCursorRange::two(
        egui::text::CCursor::new(0),
        egui::text::CCursor::new(text.chars().count()),
    );
    state.cursor.set_char_range(Some(range));
    state.store(ctx, id);
}
