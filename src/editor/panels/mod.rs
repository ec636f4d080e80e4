//! The panels: one struct, one file each.

mod droplets;
mod growth;
mod layer;
mod lights;
mod mesh;
mod object;
mod outliner;
mod outliner_row;
mod sun;
mod sun_dial;
pub(super) mod timeline;
mod view;
mod volume;
mod world;

use eframe::egui::{self, RichText, Ui};

pub use lights::LightsPanel;
pub use object::ObjectPanel;
pub use outliner::Outliner;
pub use sun::SunPanel;
pub use timeline::TimelinePanel;
pub use view::ViewPanel;
pub use world::{Wish, WorldPanel};

use super::{Document, form::Change};
use crate::scene::Scene;

/// A part of a panel that can be folded.
fn section(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui)) {
    let color = ui.visuals().strong_text_color();
    egui::CollapsingHeader::new(RichText::new(title).color(color).strong())
        .id_salt(title)
        .default_open(open)
        .show_unindented(ui, |ui| {
            ui.add_space(2.0);
            add(ui);
            ui.add_space(4.0);
        });
    ui.separator();
}

/// A sentence for who looks for something here.
fn hint(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(RichText::new(text).color(ui.visuals().weak_text_color())).wrap());
}

/// Puts a changed field into the document, or the keys of one.
fn apply(document: &mut Document, change: Option<Change>, set: impl FnOnce(&mut Scene)) {
    match change {
        Some(Change { keys: Some(paths), .. }) => document.toggle_keys(&paths),
        Some(change) => document.adjust(change.name, change.field, set),
        None => {}
    }
}
