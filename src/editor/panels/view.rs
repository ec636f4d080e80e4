//! What the view shows and how: layers, overlays, pace; and what it cost.

use eframe::egui::{Grid, Slider, Ui};

use super::{hint, section};
use crate::editor::viewport::{Axes, Layer, Pivot, Statistics, ViewCommand, Viewport, find};

/// Controls of the viewport.
#[derive(Debug, Default)]
pub struct ViewPanel;

impl ViewPanel {
    /// Shows them; the command to run where a button was clicked.
    pub fn ui(&mut self, ui: &mut Ui, viewport: &mut Viewport) -> Option<ViewCommand> {
        let mut command = None;
        section(ui, "Layer", true, |ui| command = layers(ui, viewport));
        section(ui, "Truth", true, |ui| command = command.or(truth(ui)));
        section(ui, "Show", true, |ui| show(ui, viewport));
        section(ui, "Gizmo", true, |ui| gizmo(ui, viewport));
        section(ui, "Pace", false, |ui| pace(ui, viewport));
        section(ui, "Statistics", true, |ui| statistics(ui, viewport));
        command
    }
}

fn layers(ui: &mut Ui, viewport: &Viewport) -> Option<ViewCommand> {
    let mut command = None;
    for (layer, name, help) in Layer::ALL {
        let shown = viewport.settings.layer == layer;
        if ui.radio(shown, name).on_hover_text(help).clicked() {
            command = Some(ViewCommand::Show(layer));
        }
    }
    command
}

fn truth(ui: &mut Ui) -> Option<ViewCommand> {
    let mut command = None;
    ui.horizontal(|ui| {
        for (name, wish) in
            [("Truth beside preview", ViewCommand::ToggleTruth), ("Error map", ViewCommand::ToggleErrorMap)]
        {
            let help = find(wish).map_or("", |entry| entry.help);
            if ui.button(name).on_hover_text(help).clicked() {
                command = Some(wish);
            }
        }
    });
    command
}

fn show(ui: &mut Ui, viewport: &mut Viewport) {
    let settings = &mut viewport.settings;
    ui.checkbox(&mut settings.outlines, "Outlines near the mouse");
    ui.checkbox(&mut settings.grid, "Grid and horizon");
    ui.checkbox(&mut settings.hints, "Hints at the bottom");
}

fn gizmo(ui: &mut Ui, viewport: &mut Viewport) {
    let settings = &mut viewport.settings;
    ui.horizontal(|ui| {
        ui.weak("Axes");
        ui.selectable_value(&mut settings.axes, Axes::World, "World");
        ui.selectable_value(&mut settings.axes, Axes::Local, "Local");
    });
    ui.horizontal(|ui| {
        ui.weak("About");
        ui.selectable_value(&mut settings.pivot, Pivot::Middle, "Middle");
        ui.selectable_value(&mut settings.pivot, Pivot::Active, "Active");
        ui.selectable_value(&mut settings.pivot, Pivot::Each, "Each its own");
    });
    ui.checkbox(&mut settings.snap, "Snap to round numbers")
        .on_hover_text("Ctrl during a drag does the opposite.");
    ui.checkbox(&mut settings.orbit_selected, "Orbit about what is selected");
}

fn pace(ui: &mut Ui, viewport: &mut Viewport) {
    hint(ui, "While something moves, the picture is as fine as this pace allows; at rest it becomes final.");
    let frames = &mut viewport.settings.frames_per_second;
    ui.horizontal(|ui| {
        let label = ui.weak("Frames a second");
        ui.add(Slider::new(frames, 5.0..=120.0).fixed_decimals(0)).labelled_by(label.id);
    });
}

fn statistics(ui: &mut Ui, viewport: &mut Viewport) {
    ui.checkbox(&mut viewport.settings.measure, "Count and time")
        .on_hover_text("Counts the work of final pictures and times their passes; makes them slower.");
    let statistics = viewport.statistics();
    Grid::new("statistics").num_columns(2).striped(true).min_col_width(130.0).show(ui, |ui| {
        for (name, value) in rows(statistics) {
            ui.weak(name);
            ui.label(value);
            ui.end_row();
        }
    });
}

fn rows(statistics: &Statistics) -> Vec<(String, String)> {
    let [width, height] = statistics.resolution;
    let mut rows = vec![
        ("Picture".to_owned(), format!("{width} x {height}, {}", statistics.quality)),
        ("Time".to_owned(), format!("{:.1} ms", statistics.ms)),
        ("Drawn".to_owned(), format!("{:.0} %", 100.0 * statistics.share)),
        ("Light updates".to_owned(), statistics.light_updates.to_string()),
    ];
    rows.extend(statistics.passes.iter().map(|pass| (pass.pass.to_owned(), format!("{:.2} ms", pass.ms))));
    if let Some(counts) = statistics.counts {
        let per_ray = |n: u64| n as f64 / counts.rays.max(1) as f64;
        let count = |(name, n): (&str, u64)| (name.to_owned(), format!("{n} ({:.2} per ray)", per_ray(n)));
        rows.extend(counts.named().map(count));
    }
    rows
}
