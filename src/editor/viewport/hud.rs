//! Words and buttons over the picture: tools, the compass, what the mouse and the keys do
//! now, how far the picture has come.

use eframe::egui::{
    Align2, Button, Color32, ComboBox, Painter, Pos2, Rect, RichText, Shape, Ui, UiBuilder, Visuals,
    WidgetInfo, WidgetType, pos2, vec2,
};
use egui_phosphor::regular as icon;

use super::{
    Viewport,
    commands::{self, ViewCommand},
    compass,
    hand::Hand,
    ink,
    lens::{Lens, pos},
    mouse::Boxing,
    operation::{Constraint, Kind, Operation},
    overlay,
    settings::{Axes, Layer, Pivot, Tool},
    space::axis_of,
};
use crate::{editor::Document, render::HeatMap};

/// Between the edge of a plate and its widgets, points.
const EDGE: f32 = 3.0;
/// Height of the strip of words at the bottom, points.
const STRIP: f32 = 22.0;
/// From the edge of the viewport, points.
const MARGIN: f32 = 10.0;

/// The line of the axis, the way of the mouse and the numbers of an operation.
pub fn draw_operation(ui: &Ui, painter: &Painter, lens: &Lens, operation: &Operation) {
    let axes: &[usize] = match operation.constraint {
        Constraint::Free => &[],
        Constraint::Axis(0) => &[0],
        Constraint::Axis(1) => &[1],
        Constraint::Axis(_) => &[2],
        Constraint::Plane(0) => &[1, 2],
        Constraint::Plane(1) => &[2, 0],
        Constraint::Plane(_) => &[0, 1],
    };
    for &axis in axes {
        overlay::axis_line(painter, lens, operation.pivot, axis_of(operation.frame(), axis), ink::AXIS[axis]);
    }
    let pointer = ui.input(|i| i.pointer.latest_pos());
    if operation.kind != Kind::Move
        && let (Some(center), Some(at)) = (lens.project(operation.pivot), pointer)
    {
        overlay::tether(painter, pos(center), at);
    }
    let anchor = pointer.unwrap_or(lens.rect.center()) + vec2(18.0, 22.0);
    let text = operation.readout();
    let width = 8.0 * text.chars().count() as f32;
    let x = anchor.x.min(lens.rect.right() - width).max(lens.rect.left() + MARGIN);
    ink::plate(painter, pos2(x, anchor.y.min(lens.rect.bottom() - 70.0)), Align2::LEFT_TOP, 14.0, &text);
}

impl Viewport {
    /// Everything that is not the scene.
    pub(super) fn hud(&mut self, ui: &mut Ui, document: &mut Document) {
        let painter = ui.painter_at(self.rect);
        let (lens, to_sun) = (self.view.lens(self.rect), document.scene().sun.to_sun());
        // Very small windows have room for the picture only.
        if self.rect.width() < 260.0 || self.rect.height() < 160.0 {
            return;
        }
        if self.settings.grid {
            overlay::sun(&painter, &lens, to_sun);
        }
        let corner = self.rect.right_top() + vec2(-56.0, 56.0);
        if let Some(side) = compass::show(ui, &lens, corner, to_sun) {
            self.run(ViewCommand::LookFrom(side), document);
            ui.ctx().request_repaint();
        }
        self.tools(ui, document);
        self.strip(&painter);
        self.state(&painter);
        self.legend(&painter);
        self.tell_truth(&painter);
        self.hints(&painter, document);
    }

    /// Buttons down the left edge, and a bar on top.
    fn tools(&mut self, ui: &mut Ui, document: &mut Document) {
        let mut chosen = None;
        let corner = self.rect.min + vec2(MARGIN, MARGIN);
        let column = over(ui, corner, |ui| {
            ui.vertical(|ui| {
                for (tool, icon) in [
                    (Tool::Select, icon::CURSOR),
                    (Tool::Move, icon::ARROWS_OUT_CARDINAL),
                    (Tool::Rotate, icon::ARROWS_CLOCKWISE),
                    (Tool::Scale, icon::RESIZE),
                ] {
                    let command = ViewCommand::UseTool(tool);
                    if button(ui, icon, self.settings.tool == tool, command) {
                        chosen = Some(command);
                    }
                }
            });
        });
        over(ui, pos2(column.right() + 8.0, corner.y), |ui| {
            ui.horizontal(|ui| chosen = chosen.or(self.bar(ui)));
        });
        if let Some(command) = chosen {
            self.run(command, document);
            ui.ctx().request_repaint();
        }
    }

    fn bar(&mut self, ui: &mut Ui) -> Option<ViewCommand> {
        let (truth, narrow) = (self.truth, self.rect.width() < 560.0);
        let settings = &mut self.settings;
        let mut chosen = None;
        let toggles = [
            (icon::GLOBE, icon::CUBE, settings.axes == Axes::Local, ViewCommand::ToggleLocal),
            (icon::MAGNET_STRAIGHT, icon::MAGNET_STRAIGHT, settings.snap, ViewCommand::ToggleSnap),
            (icon::CIRCLE_DASHED, icon::CIRCLE_DASHED, settings.outlines, ViewCommand::ToggleOutlines),
            (icon::GRID_FOUR, icon::GRID_FOUR, settings.grid, ViewCommand::ToggleGrid),
            (icon::SQUARE_SPLIT_HORIZONTAL, icon::SQUARE_SPLIT_HORIZONTAL, truth, ViewCommand::ToggleTruth),
        ];
        for (off, on, state, command) in toggles {
            if button(ui, if state { on } else { off }, state, command) {
                chosen = Some(command);
            }
        }
        if narrow {
            return chosen;
        }
        let pivot = ComboBox::from_id_salt("nephos pivot").width(64.0).selected_text(settings.pivot.name());
        let response = pivot.show_ui(ui, |ui| {
            for pivot in [Pivot::Middle, Pivot::Active, Pivot::Each] {
                ui.selectable_value(&mut settings.pivot, pivot, pivot.name());
            }
        });
        response.response.on_hover_text("About what several ellipsoids turn and scale.");
        let layer = Layer::ALL.into_iter().find(|(layer, ..)| *layer == settings.layer);
        let name = layer.map_or("", |(_, name, _)| name);
        let layers = ComboBox::from_id_salt("nephos layer").width(118.0).height(300.0).selected_text(name);
        layers.show_ui(ui, |ui| {
            for (layer, name, help) in Layer::ALL {
                ui.selectable_value(&mut settings.layer, layer, name).on_hover_text(help);
            }
        });
        chosen
    }

    /// The dark strip at the bottom that words lie on.
    fn strip(&self, painter: &Painter) {
        let area = Rect::from_min_max(pos2(self.rect.left(), self.rect.bottom() - STRIP), self.rect.max);
        painter.rect_filled(area, 0.0, Color32::from_black_alpha(120));
    }

    /// How far the picture has come, at the bottom right.
    fn state(&self, painter: &Painter) {
        let statistics = &self.easel.seen().statistics;
        let [width, height] = statistics.resolution;
        let rays = if statistics.rays > 1 {
            format!(" ×{}", statistics.rays * statistics.rays)
        } else {
            String::new()
        };
        let text = format!("{width} × {height}{rays}   {}   {}", statistics.quality, duration(statistics.ms));
        let at = self.rect.right_bottom() - vec2(MARGIN, 0.5 * STRIP);
        ink::words(painter, at, Align2::RIGHT_CENTER, 11.0, Color32::from_gray(205), &text);
        if let Some(error) = &self.easel.seen().error {
            let galley = painter.layout(
                error.clone(),
                eframe::egui::FontId::proportional(13.0),
                Color32::from_rgb(255, 190, 180),
                0.7 * self.rect.width(),
            );
            let rect = Rect::from_center_size(self.rect.center(), galley.size() + vec2(28.0, 20.0));
            ink::panel(painter, rect);
            painter.galley(rect.min + vec2(14.0, 10.0), galley, ink::WORDS);
        }
        if !self.easel.at_rest() && self.easel.seen().error.is_none() {
            let (left, bottom) = (self.rect.left(), self.rect.bottom());
            let share = self.easel.seen().statistics.share as f32;
            let bar =
                Rect::from_min_max(pos2(left, bottom - 2.0), pos2(left + share * self.rect.width(), bottom));
            painter.rect_filled(bar, 0.0, ink::HOVER);
        }
    }

    /// The colours of the cost layer.
    fn legend(&self, painter: &Painter) {
        if self.settings.layer == Layer::Cost && !self.truth {
            let at = self.rect.right_bottom() - vec2(MARGIN + 190.0, 66.0);
            let color = |x: f32| HeatMap::color(x);
            let ticks: Vec<_> = [0.0, 10.0, 100.0, 1000.0]
                .map(|steps: f32| (HeatMap::place(steps, super::work::COST_RANGE), format!("{steps:.0}")))
                .into();
            scale(painter, at, "Steps of a ray", color, &ticks);
        }
    }

    /// What the mouse and the keys do now, at the bottom left.
    fn hints(&self, painter: &Painter, document: &Document) {
        if !self.settings.hints || self.rect.width() < 560.0 {
            return;
        }
        let at = self.rect.left_bottom() + vec2(MARGIN, -0.5 * STRIP);
        ink::words(painter, at, Align2::LEFT_CENTER, 11.5, Color32::from_gray(225), self.hint(document));
    }

    fn hint(&self, document: &Document) -> &'static str {
        match (&self.operation, self.hand, self.boxing) {
            (Some(operation), ..) if operation.dragged => {
                "Drag   Ctrl snaps   Shift slower   X Y Z axis   type a number   Esc cancels"
            }
            (Some(_), ..) => {
                "Move the mouse or type a number   X Y Z axis, twice local   Shift+X plane   Ctrl snaps   Click keeps   Esc cancels"
            }
            (_, Hand::Fly, _) => "W A S D fly   Q E down and up   Wheel speed   Shift faster",
            (_, Hand::Orbit { .. }, _) => "Orbit",
            (_, Hand::Pan { .. }, _) => "Pan",
            (_, Hand::Dolly { .. }, _) => "Dolly",
            (_, _, Boxing::Armed | Boxing::From(_)) => "Drag a box over centres   Shift adds   Esc cancels",
            _ if self.hover.handle.is_some() => "Drag the handle   Ctrl snaps   Shift slower",
            _ if document.selection().ellipsoids.is_empty() => {
                "Click selects   Drag boxes   Middle or Alt+drag orbits, with Shift pans   Wheel dollies   Right drag flies"
            }
            _ => {
                "G move   R rotate   S scale   F frame   Shift+click adds   Ctrl+click cloud   Middle or Alt+drag orbits"
            }
        }
    }
}

/// A plate with widgets that look the same in light and dark themes, for they lie on the
/// picture. Tells where it is.
fn over(ui: &mut Ui, corner: Pos2, add: impl FnOnce(&mut Ui)) -> Rect {
    let plate = ui.painter().add(Shape::Noop);
    let inner = corner + vec2(EDGE, EDGE);
    let mut child = ui.new_child(UiBuilder::new().max_rect(Rect::from_min_size(inner, vec2(600.0, 400.0))));
    *child.visuals_mut() = Visuals::dark();
    child.visuals_mut().widgets.inactive.weak_bg_fill = Color32::TRANSPARENT;
    child.visuals_mut().selection.bg_fill = Color32::from_rgb(52, 98, 150);
    child.spacing_mut().item_spacing = vec2(3.0, 3.0);
    child.spacing_mut().button_padding = vec2(4.0, 3.0);
    add(&mut child);
    let rect = child.min_rect().expand(EDGE);
    ui.painter().set(plate, ink::panel_shape(rect));
    rect
}

/// A button with an icon; tells its name, help and keys.
fn button(ui: &mut Ui, icon: &str, on: bool, command: ViewCommand) -> bool {
    let button = Button::selectable(on, RichText::new(icon).size(18.0)).min_size(vec2(28.0, 28.0));
    let response = ui.add(button);
    match commands::find(command) {
        Some(entry) => {
            response.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, on, entry.name));
            let keys = entry.shortcut.map(|keys| ui.ctx().format_shortcut(&keys));
            let keys = keys.map_or(String::new(), |keys| format!("  ({keys})"));
            response.on_hover_text(format!("{}{keys}\n{}", entry.name, entry.help)).clicked()
        }
        None => response.clicked(),
    }
}

/// A bar of colours with numbers below.
pub fn scale(
    painter: &Painter,
    at: Pos2,
    title: &str,
    color: impl Fn(f32) -> [f32; 3],
    ticks: &[(f32, String)],
) {
    const SIZE: [f32; 2] = [170.0, 10.0];
    let plate = Rect::from_min_size(at - vec2(12.0, 22.0), vec2(SIZE[0] + 24.0, SIZE[1] + 44.0));
    ink::panel(painter, plate);
    ink::words(painter, at - vec2(0.0, 3.0), Align2::LEFT_BOTTOM, 11.0, ink::WORDS, title);
    let steps = 85;
    for i in 0..steps {
        let x = i as f32 / steps as f32;
        let [r, g, b] = color((i as f32 + 0.5) / steps as f32).map(|c| (255.0 * c).round() as u8);
        let min = at + vec2(x * SIZE[0], 0.0);
        let piece = Rect::from_min_size(min, vec2(SIZE[0] / steps as f32 + 0.5, SIZE[1]));
        painter.rect_filled(piece, 0.0, Color32::from_rgb(r, g, b));
    }
    for (x, text) in ticks {
        let below = at + vec2(x * SIZE[0], SIZE[1] + 2.0);
        painter.line_segment([below, below - vec2(0.0, 4.0)], (1.0, ink::WORDS));
        ink::words(painter, below, Align2::CENTER_TOP, 10.0, ink::WORDS, text);
    }
}

/// A time in the unit that suits it.
pub fn duration(ms: f64) -> String {
    match ms {
        ms if ms < 10.0 => format!("{ms:.1} ms"),
        ms if ms < 1000.0 => format!("{ms:.0} ms"),
        ms => format!("{:.1} s", 1e-3 * ms),
    }
}
