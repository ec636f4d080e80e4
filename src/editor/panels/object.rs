//! The inspector of what is selected: ellipsoid, cloud, and heaps to grow.

use eframe::egui::{DragValue, Ui};
use egui_phosphor::regular as icon;
use glam::DVec3;

use super::{
    apply,
    droplets::droplets,
    growth::growth,
    hint,
    layer::layer,
    mesh::mesh,
    section,
    volume::{sequence, volume},
};
use crate::{
    editor::{
        Document, EllipsoidId,
        form::{Change, Form},
        labels::name_widget,
    },
    scene::{
        Cloud, Edge, Ellipsoid, Heaps, Life, Noise,
        timeline::{Owner, owner_path},
    },
};

/// Inspector of the active ellipsoid and its cloud.
#[derive(Debug, Default)]
pub struct ObjectPanel {
    /// How heaps will grow.
    pub heaps: Heaps,
}

impl ObjectPanel {
    /// Shows what is selected.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document) {
        let Some((index, cloud)) = document.active_cloud() else {
            hint(ui, "Nothing is selected. Click an ellipsoid in the view or in the outliner, or add one.");
            return;
        };
        let cloud = cloud.clone();
        if let Some(id) = document.selection().active {
            section(ui, "Ellipsoid", true, |ui| ellipsoid(ui, document, id, &cloud));
            section(ui, "Edge", true, |ui| own_edge(ui, document, id, &cloud));
        }
        if !document.selection().ellipsoids.is_empty() {
            section(ui, "Grow heaps", false, |ui| self.grow(ui, document));
        }
        section(ui, "Cloud", true, |ui| cloud_fields(ui, document, index, cloud.clone()));
        if cloud.volume.is_some() {
            section(ui, "Volume", true, |ui| volume(ui, document, index, &cloud));
        }
        if cloud.volume.as_ref().is_some_and(|volume| volume.steps().is_some()) {
            section(ui, "Sequence", true, |ui| sequence(ui, document, index, &cloud));
            section(ui, "Droplets", true, |ui| droplets(ui, document, index, &cloud));
            return;
        }
        let is_mesh = cloud.mesh.is_some();
        if is_mesh {
            section(ui, "Mesh", true, |ui| mesh(ui, document, index, &cloud));
        }
        let is_layer = cloud.layer.is_some();
        if !is_mesh {
            section(ui, "Layer", is_layer, |ui| layer(ui, document, index, &cloud));
        }
        if !is_layer && !is_mesh {
            section(ui, "Growth", cloud.growth.is_some(), |ui| growth(ui, document, index, &cloud));
        }
        section(ui, "Noise", false, |ui| own_noise(ui, document, index, cloud.clone()));
        if !is_layer && !is_mesh {
            section(ui, "Life", false, |ui| life(ui, document, index, cloud.life.clone()));
        }
        section(ui, "Droplets", true, |ui| droplets(ui, document, index, &cloud));
    }

    fn grow(&mut self, ui: &mut Ui, document: &mut Document) {
        hint(ui, "Heaps smaller ellipsoids on the upper side of each selected one.");
        let heaps = &mut self.heaps;
        ui.horizontal(|ui| {
            let number = |ui: &mut Ui, name: &str, add: DragValue<'_>| {
                ui.label(name);
                let response = ui.add(add.speed(0.05));
                name_widget(ui, &response, name);
            };
            number(ui, "Children", DragValue::new(&mut heaps.children.0).range(0..=12));
            number(ui, "to", DragValue::new(&mut heaps.children.1).range(0..=12));
            number(ui, "Generations", DragValue::new(&mut heaps.generations).range(1..=4));
        });
        heaps.children.1 = heaps.children.1.max(heaps.children.0);
        ui.horizontal(|ui| {
            ui.label("Seed");
            let response = ui.add(DragValue::new(&mut heaps.seed).speed(0.1));
            name_widget(ui, &response, "Seed of the heaps");
            let grow = ui.button(format!("{} Grow", icon::TREE));
            name_widget(ui, &grow, "Grow");
            if grow.clicked() {
                document.grow(heaps);
                heaps.seed = heaps.seed.wrapping_add(1);
            }
        });
    }
}

/// The path of what rows are about.
pub(super) fn path(document: &Document, owner: Owner) -> String {
    owner_path(owner, document.scene())
}

fn ellipsoid(ui: &mut Ui, document: &mut Document, id: EllipsoidId, cloud: &Cloud) {
    let Some(mut ellipsoid) = document.ellipsoid(id).cloned() else { return };
    let others = document.selection().ellipsoids.len() - 1;
    if others > 0 {
        let what = if others == 1 { "the other one, too" } else { "all of them" };
        hint(ui, &format!("{} are selected: density and edge change {what}.", others + 1));
    }
    let mut name = ellipsoid.name.clone().unwrap_or_default();
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Ellipsoid(id.cloud, id.ellipsoid)));
    let default = Ellipsoid::default();
    form.text("Ellipsoid.name", "Name", &mut name, "ellipsoid");
    form.vector("Ellipsoid.center", "Centre", &mut ellipsoid.center, default.center);
    form.vector("Ellipsoid.radii", "Radii", &mut ellipsoid.radii, default.radii);
    form.rotation("Ellipsoid.orientation", "Rotation", &mut ellipsoid.orientation);
    form.slider("Ellipsoid.density", "Density", &mut ellipsoid.density, default.density, 0.0..=2.0);
    form.check("Ellipsoid.hidden", "Hidden", &mut ellipsoid.hidden, false);
    form.check("Ellipsoid.locked", "Locked", &mut ellipsoid.locked, false);
    let change = form.changed();
    ellipsoid.name = Some(name).filter(|name| !name.is_empty());
    hint(ui, &thickness(cloud, &ellipsoid));
    let all = change.as_ref().is_some_and(|change| change.path == "Ellipsoid.density");
    put(document, change, id, ellipsoid, |to, from| to.density = from.density, all);
}

/// What the numbers mean for light: the optical thickness of the middle.
fn thickness(cloud: &Cloud, ellipsoid: &Ellipsoid) -> String {
    let extinction = cloud.droplets.extinction() * ellipsoid.density;
    let thickness = 2.0 * ellipsoid.radii.min_element() * extinction;
    format!("Optical thickness across the middle: {thickness:.1}")
}

fn own_edge(ui: &mut Ui, document: &mut Document, id: EllipsoidId, cloud: &Cloud) {
    let Some(mut ellipsoid) = document.ellipsoid(id).cloned() else { return };
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Ellipsoid(id.cloud, id.ellipsoid)));
    let mut own = ellipsoid.edge.is_some();
    form.check("Ellipsoid.edge", "Its own edge", &mut own, false);
    let mut edge = ellipsoid.edge.clone().unwrap_or_else(|| cloud.edge.clone());
    if own {
        edge_rows(&mut form, &mut edge, &cloud.edge, 2.0 * ellipsoid.radii.max_element(), true);
    }
    let change = form.changed();
    if !own {
        hint(ui, "It has the edge of its cloud, below.");
    }
    ellipsoid.edge = own.then_some(edge);
    put(document, change, id, ellipsoid, |to, from| to.edge.clone_from(&from.edge), true);
}

/// Boundary and wispiness; the slider of the boundary ends at `widest` metres. They are off where no
/// ellipsoid has this edge.
fn edge_rows(form: &mut Form<'_>, edge: &mut Edge, default: &Edge, widest: f64, works: bool) {
    form.works(works, "All ellipsoids of this cloud have edges of their own.");
    let widest = 0.0..=widest.clamp(10.0, 1e4);
    form.slider("Edge.boundary", "Boundary", &mut edge.boundary, default.boundary, widest);
    if works && edge.boundary <= 0.0 {
        form.works(false, "The boundary has no thickness: raise it first.");
    }
    form.number("Edge.wispiness", "Wispiness", &mut edge.wispiness, default.wispiness);
    form.works(true, "");
}

/// Puts `ellipsoid` into the document, and what `share` copies into the other selected ones.
fn put(
    document: &mut Document,
    change: Option<Change>,
    id: EllipsoidId,
    ellipsoid: Ellipsoid,
    share: fn(&mut Ellipsoid, &Ellipsoid),
    all: bool,
) {
    let others = if all { document.free_selection() } else { Default::default() };
    apply(document, change, |scene| {
        for other in others {
            share(&mut scene.clouds[other.cloud].ellipsoids[other.ellipsoid], &ellipsoid);
        }
        scene.clouds[id.cloud].ellipsoids[id.ellipsoid] = ellipsoid;
    });
}

fn cloud_fields(ui: &mut Ui, document: &mut Document, index: usize, mut cloud: Cloud) {
    let widest = cloud.ellipsoids.iter().map(|e| 2.0 * e.radii.max_element()).fold(200.0, f64::max);
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    form.text("Cloud.name", "Name", &mut cloud.name, "cloud");
    let own = cloud.ellipsoids.iter().filter(|ellipsoid| ellipsoid.edge.is_some()).count();
    let is_used = cloud.ellipsoids.is_empty() || own < cloud.ellipsoids.len();
    if cloud.volume.is_none() {
        edge_rows(&mut form, &mut cloud.edge, &Edge::default(), widest, is_used);
        let default = Cloud::default();
        if cloud.layer.is_none() {
            shape_rows(&mut form, &mut cloud, document.scene().wind.velocity);
        }
        form.number(
            "Cloud.stratification",
            "Stratification",
            &mut cloud.stratification,
            default.stratification,
        );
        form.number("Cloud.dilution", "Dilution", &mut cloud.dilution, default.dilution);
    }
    form.check("Cloud.hidden", "Hidden", &mut cloud.hidden, false);
    form.check("Cloud.locked", "Locked", &mut cloud.locked, false);
    let change = form.changed();
    if own > 0 {
        hint(ui, &format!("{own} of {} ellipsoids have edges of their own.", cloud.ellipsoids.len()));
    }
    apply(document, change, |scene| scene.clouds[index] = cloud);
}

/// What layers do not have.
fn shape_rows(form: &mut Form<'_>, cloud: &mut Cloud, wind: DVec3) {
    let is_mesh = cloud.mesh.is_some();
    if !is_mesh {
        form.works(cloud.ellipsoids.len() > 1, "One ellipsoid alone has none to join: add another.");
        form.number("Cloud.blend", "Blend", &mut cloud.blend, Cloud::default().blend);
        form.works(true, "");
    }
    let mut flat = cloud.level.is_some();
    form.check("Cloud.level", "Flat base", &mut flat, false);
    let lowest = cloud.bounds().map_or(0.0, |(low, _)| low.y);
    cloud.level = flat.then(|| cloud.level.unwrap_or(lowest));
    if let Some(level) = &mut cloud.level {
        form.slider("Cloud.level", "Base altitude", level, lowest, lowest - 500.0..=lowest + 500.0);
    }
    if is_mesh {
        return;
    }
    let has_lee = wind.with_y(0.0) != DVec3::ZERO;
    form.works(has_lee, "Without wind there is no lee: give it a velocity in the World panel.");
    form.number("Evaporation.lee", "Veil in the lee", &mut cloud.evaporation.lee, 0.0);
    form.works(true, "");
    form.number("Evaporation.base", "Veil at the base", &mut cloud.evaporation.base, 0.0);
}

fn own_noise(ui: &mut Ui, document: &mut Document, index: usize, mut cloud: Cloud) {
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    let mut own = cloud.noise.is_some();
    form.check("Cloud.noise", "Its own noise", &mut own, false);
    let mut noise = cloud.noise.take().unwrap_or_else(|| document.scene().noise.clone());
    if own {
        noise_rows(&mut form, &mut noise);
    }
    let change = form.changed();
    if !own {
        hint(ui, "It has the noise of the scene, in which it drifts.");
    }
    cloud.noise = own.then_some(noise);
    apply(document, change, |scene| scene.clouds[index] = cloud);
}

/// What there is of noise, but for where it is.
pub(super) fn noise_rows(form: &mut Form<'_>, noise: &mut Noise) {
    let default = Noise::default();
    form.whole("Noise.seed", "Seed", &mut noise.seed, default.seed);
    let mut scaled = noise.scale.is_some();
    form.check("Noise.scale", "Size in metres", &mut scaled, false);
    noise.scale = scaled.then(|| noise.scale.unwrap_or(BILLOWS));
    if let Some(scale) = &mut noise.scale {
        form.slider("Noise.scale", "Billow size", scale, BILLOWS, 1.0..=1000.0);
    }
    form.number("Noise.dimension", "Dimension", &mut noise.dimension, default.dimension);
    form.number("Noise.detail", "Detail", &mut noise.detail, default.detail);
    form.number("Noise.evolution", "Evolution", &mut noise.evolution, default.evolution);
    form.slider("Noise.rate", "Renewals a minute", &mut noise.rate, default.rate, 0.0..=30.0);
}

/// Size of the largest billows that is offered where none was told, m.
const BILLOWS: f64 = 120.0;

fn life(ui: &mut Ui, document: &mut Document, index: usize, mut life: Option<Life>) {
    let length = document.scene().timeline.as_ref().map_or(60.0, |timeline| timeline.length);
    let begins = Life { birth: 0.0, death: length, forming: 0.25 * length, dissolving: 0.25 * length };
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    let mut own = life.is_some();
    form.check("Cloud.life", "Forms and dissolves", &mut own, false);
    let mut rows = life.take().unwrap_or_else(|| begins.clone());
    if own {
        form.slider("Life.birth", "Birth", &mut rows.birth, begins.birth, 0.0..=length);
        form.slider("Life.death", "Death", &mut rows.death, begins.death, 0.0..=length);
        form.slider("Life.forming", "Forming", &mut rows.forming, begins.forming, 0.0..=length);
        form.slider("Life.dissolving", "Dissolving", &mut rows.dissolving, begins.dissolving, 0.0..=length);
    }
    let change = form.changed();
    apply(document, change, |scene| scene.clouds[index].life = own.then_some(rows));
}
