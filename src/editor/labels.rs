//! Names of widgets, for those who do not see them.

use eframe::egui::{Response, Ui};

/// Gives a widget a name that screen readers, and tests, know it by.
pub fn name_widget(ui: &Ui, response: &Response, name: &str) {
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
}
