//! A mesh that is a cloud's boundary: its numbers.

use eframe::egui::Ui;

use super::{apply, hint, object::path};
use crate::{
    editor::{Document, form::Form, words::choice},
    scene::{Cloud, Mesh, Up, timeline::Owner},
};

/// The numbers of a mesh that is the boundary of a cloud.
pub(super) fn mesh(ui: &mut Ui, document: &mut Document, index: usize, cloud: &Cloud) {
    let Some(mut mesh) = cloud.mesh.clone() else { return };
    hint(ui, &told(&mesh));
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    let usual = Mesh::default();
    form.slider("Mesh.density", "Density", &mut mesh.density, usual.density, 0.0..=2.0);
    form.number("Mesh.scale", "Metres per unit", &mut mesh.scale, usual.scale);
    let ups = [("Y", choice("Up.y"), Up::Y), ("Z", choice("Up.z"), Up::Z)];
    form.choice("Mesh.up", "Axis that goes up", &mut mesh.up, &ups);
    form.vector("Mesh.place", "Place", &mut mesh.place, usual.place);
    form.rotation("Mesh.orientation", "Rotation", &mut mesh.orientation);
    let change = form.changed();
    apply(document, change, |scene| scene.clouds[index].mesh = Some(mesh));
}

/// What the file holds.
fn told(mesh: &Mesh) -> String {
    match mesh.surface() {
        Some(surface) => format!("{}: {} triangles.", mesh.file, surface.count()),
        None => format!("{} was not read: open the scene anew.", mesh.file),
    }
}
