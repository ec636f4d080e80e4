//! The list of clouds and their ellipsoids: select, name, hide, lock, reorder, search.

use std::collections::BTreeSet;

use eframe::egui::{Event, Modifiers, Rect, Response, ScrollArea, Sense, TextEdit, Ui, pos2, vec2};
use egui_phosphor::regular as icon;

use super::{
    hint,
    outliner_row::{
        Deed, ICON, ROW, Row, describe, dragged, flags, icon_button, is_selected, name, paint_row,
        rename_field,
    },
};
use crate::{
    editor::{Document, EllipsoidId, Selection, labels::name_widget},
    scene::Scene,
};

/// The list of what a scene holds.
#[derive(Debug, Default)]
pub struct Outliner {
    search: String,
    folded: BTreeSet<usize>,
    renamed: Option<(Row, String)>,
    /// Where a range begins that Shift ends.
    anchor: Option<Row>,
    /// What was active in the last frame, to scroll to it when it changes.
    shown: Option<EllipsoidId>,
}

impl Outliner {
    /// Shows the list.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document) {
        self.search_field(ui);
        let rows = self.rows(document.scene());
        if rows.is_empty() {
            let text = match self.search.is_empty() {
                true => "The sky is empty. Add an ellipsoid, or a preset, from the Add menu.",
                false => "No name contains this.",
            };
            hint(ui, text);
            return;
        }
        let mut deed = None;
        let mut area = ScrollArea::vertical().auto_shrink(false).id_salt("rows");
        if let Some(offset) = self.scroll_to(ui, document, &rows) {
            area = area.vertical_scroll_offset(offset);
        }
        ui.spacing_mut().item_spacing.y = 0.0;
        area.show_rows(ui, ROW, rows.len(), |ui, range| {
            for row in &rows[range] {
                if let Some(done) = self.row(ui, document, *row) {
                    deed = Some(done);
                }
            }
        });
        if let Some(deed) = deed {
            self.carry_out(ui, document, &rows, deed);
        }
    }

    /// Begins to rename what is active.
    pub fn rename_active(&mut self, document: &Document) {
        let selection = document.selection();
        let row = selection.active.map(Row::Ellipsoid).or(selection.cloud.map(Row::Cloud));
        self.renamed = row.map(|row| (row, name(document.scene(), row)));
    }

    fn search_field(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let field = TextEdit::singleline(&mut self.search)
                .hint_text(format!("{} Search", icon::MAGNIFYING_GLASS))
                .desired_width(ui.available_width());
            let response = ui.add(field);
            name_widget(ui, &response, "Search the outliner");
        });
        ui.add_space(2.0);
    }

    /// The rows that the search and the folds leave.
    fn rows(&self, scene: &Scene) -> Vec<Row> {
        let wanted = self.search.to_lowercase();
        let fits = |row| name(scene, row).to_lowercase().contains(&wanted);
        let mut rows = Vec::new();
        for (index, cloud) in scene.clouds.iter().enumerate() {
            let whole = fits(Row::Cloud(index));
            let list = (0..cloud.ellipsoids.len())
                .map(|e| Row::Ellipsoid(EllipsoidId { cloud: index, ellipsoid: e }));
            let list: Vec<_> = list.filter(|row| whole || fits(*row)).collect();
            if whole || !list.is_empty() {
                rows.push(Row::Cloud(index));
                let open = !self.folded.contains(&index) || !wanted.is_empty();
                rows.extend(list.into_iter().filter(|_| open));
            }
        }
        rows
    }

    /// Where to scroll so that a newly active ellipsoid is seen.
    fn scroll_to(&mut self, ui: &Ui, document: &Document, rows: &[Row]) -> Option<f32> {
        let active = document.selection().active;
        if std::mem::replace(&mut self.shown, active) == active {
            return None;
        }
        let at = rows.iter().position(|row| Some(*row) == active.map(Row::Ellipsoid))? as f32 * ROW;
        // Rows that are few enough to be seen anyway stay where they are.
        let room = ui.available_height();
        (rows.len() as f32 * ROW > room).then_some((at - 0.5 * room).max(0.0))
    }

    fn row(&mut self, ui: &mut Ui, document: &Document, row: Row) -> Option<Deed> {
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click_and_drag());
        if let Some((renamed, text)) = &mut self.renamed
            && *renamed == row
        {
            let deed = rename_field(ui, rect, row, text)?;
            self.renamed = None;
            return Some(deed);
        }
        let scene = document.scene();
        let title = name(scene, row);
        let chosen = is_selected(document.selection(), row);
        describe(&response, &title, chosen);
        paint_row(ui, rect, &response, document, row, &title);
        if let Some(deed) = self.icons(ui, rect, &response, scene, row, &title) {
            return Some(deed);
        }
        if let Some(deed) = dragged(ui, rect, &response, row) {
            return Some(deed);
        }
        if response.double_clicked() {
            return Some(Deed::Rename(row));
        }
        response.clicked().then_some(Deed::Click(row))
    }

    /// Fold, hide and lock.
    fn icons(
        &self,
        ui: &mut Ui,
        rect: Rect,
        response: &Response,
        scene: &Scene,
        row: Row,
        title: &str,
    ) -> Option<Deed> {
        let near = response.hovered() || ui.rect_contains_pointer(rect);
        let (hidden, locked) = flags(scene, row);
        let mut deed = None;
        if let Row::Cloud(index) = row {
            let caret = if self.folded.contains(&index) { icon::CARET_RIGHT } else { icon::CARET_DOWN };
            let place = Rect::from_min_size(rect.min, vec2(ICON, ROW));
            if icon_button(ui, place, row, caret, &format!("Fold {title}"), true, true) {
                deed = Some(Deed::Fold(index));
            }
        }
        let place =
            |n: f32| Rect::from_min_size(pos2(rect.right() - n * ICON - 2.0, rect.top()), vec2(ICON, ROW));
        let eye = if hidden { icon::EYE_SLASH } else { icon::EYE };
        let verb = if hidden { "Show" } else { "Hide" };
        if icon_button(ui, place(1.0), row, eye, &format!("{verb} {title}"), hidden || near, !hidden) {
            deed = Some(Deed::Hide(row));
        }
        let lock = if locked { icon::LOCK } else { icon::LOCK_OPEN };
        let verb = if locked { "Unlock" } else { "Lock" };
        if icon_button(ui, place(2.0), row, lock, &format!("{verb} {title}"), locked || near, locked) {
            deed = Some(Deed::Lock(row));
        }
        deed
    }

    fn carry_out(&mut self, ui: &Ui, document: &mut Document, rows: &[Row], deed: Deed) {
        match deed {
            Deed::Click(row) => self.click(ui, document, rows, row),
            Deed::Rename(row) => self.renamed = Some((row, name(document.scene(), row))),
            Deed::Named(row, title) => rename(document, row, title),
            Deed::Hide(row) => document.edit("Hide or show", |scene| {
                let (hidden, _) = flags_mut(scene, row);
                *hidden = !*hidden;
            }),
            Deed::Lock(row) => document.edit("Lock or unlock", |scene| {
                let (_, locked) = flags_mut(scene, row);
                *locked = !*locked;
            }),
            Deed::Fold(index) => {
                if !self.folded.remove(&index) {
                    self.folded.insert(index);
                }
            }
            Deed::Drop(what, at, after) => drop_at(document, what, at, after),
        }
    }

    fn click(&mut self, ui: &Ui, document: &mut Document, rows: &[Row], row: Row) {
        let keys = keys_at_click(ui);
        let place = |row: Row| rows.iter().position(|other| *other == row);
        match (row, self.anchor.and_then(place), place(row)) {
            (_, Some(from), Some(to)) if keys.shift => {
                let range = &rows[from.min(to)..=from.max(to)];
                let ids = range.iter().filter_map(|row| match row {
                    Row::Ellipsoid(id) => Some(*id),
                    Row::Cloud(_) => None,
                });
                document.select(Selection::of(ids));
            }
            (Row::Ellipsoid(id), ..) if keys.command => {
                let mut selection = document.selection().clone();
                selection.toggle(id);
                document.select(selection);
                self.anchor = Some(row);
            }
            (Row::Ellipsoid(id), ..) => {
                document.select(Selection::one(id));
                self.anchor = Some(row);
            }
            (Row::Cloud(index), ..) => {
                document.select(Selection::cloud(document.scene(), index));
                self.anchor = Some(row);
            }
        }
        // The one that was clicked is in sight already.
        self.shown = document.selection().active;
    }
}

/// The modifiers of the moment of the click: a slow frame may end without them.
fn keys_at_click(ui: &Ui) -> Modifiers {
    ui.input(|input| {
        let let_go = input.events.iter().rev().find_map(|event| match event {
            Event::PointerButton { pressed: false, modifiers, .. } => Some(*modifiers),
            _ => None,
        });
        let_go.unwrap_or(input.modifiers)
    })
}

fn flags_mut(scene: &mut Scene, row: Row) -> (&mut bool, &mut bool) {
    match row {
        Row::Cloud(index) => {
            let cloud = &mut scene.clouds[index];
            (&mut cloud.hidden, &mut cloud.locked)
        }
        Row::Ellipsoid(id) => {
            let ellipsoid = &mut scene.clouds[id.cloud].ellipsoids[id.ellipsoid];
            (&mut ellipsoid.hidden, &mut ellipsoid.locked)
        }
    }
}

fn rename(document: &mut Document, row: Row, title: String) {
    // A number that stands for no name is none.
    if title == name(document.scene(), row) {
        return;
    }
    document.edit("Rename", |scene| match row {
        Row::Cloud(index) => scene.clouds[index].name = title,
        Row::Ellipsoid(id) => {
            let ellipsoid = &mut scene.clouds[id.cloud].ellipsoids[id.ellipsoid];
            ellipsoid.name = Some(title).filter(|title| !title.is_empty());
        }
    });
}

fn drop_at(document: &mut Document, what: Row, at: Row, after: bool) {
    let step = usize::from(after);
    match (what, at) {
        (Row::Cloud(from), Row::Cloud(to)) => document.move_cloud(from, to + step),
        (Row::Cloud(from), Row::Ellipsoid(id)) => document.move_cloud(from, id.cloud + 1),
        (Row::Ellipsoid(from), Row::Ellipsoid(to)) => {
            document.move_ellipsoid(from, EllipsoidId { ellipsoid: to.ellipsoid + step, ..to });
        }
        (Row::Ellipsoid(from), Row::Cloud(cloud)) => {
            document.move_ellipsoid(from, EllipsoidId { cloud, ellipsoid: 0 });
        }
    }
}
