//! A layer: its numbers.

use eframe::egui::Ui;

use super::{apply, hint, object::path};
use crate::{
    editor::{Document, form::Form},
    scene::{Cloud, CoverMap, Evaporation, Layer, timeline::Owner},
};

/// Whether a cloud is a layer, and its numbers.
pub(super) fn layer(ui: &mut Ui, document: &mut Document, index: usize, cloud: &Cloud) {
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    let mut is_layer = cloud.layer.is_some();
    form.check("Cloud.layer", "To the horizon", &mut is_layer, false);
    let mut numbers = cloud.layer.clone().unwrap_or_default();
    if is_layer {
        layer_rows(&mut form, &mut numbers);
        map_rows(&mut form, &mut numbers);
    }
    let change = form.changed();
    let told = match is_layer {
        true => {
            let depth = numbers.thickness * numbers.density * cloud.droplets.extinction();
            format!(
                "Optical thickness where it is thickest: {depth:.1}. It repeats every {:.0} m.{}",
                numbers.period(),
                map_told(&numbers)
            )
        }
        false => "To make it a layer takes its ellipsoids away.".to_owned(),
    };
    hint(ui, &told);
    apply(document, change, |scene| put(&mut scene.clouds[index], is_layer.then_some(numbers)));
}

/// Makes a cloud a layer, or takes that away; a layer has nothing of what other clouds have.
fn put(cloud: &mut Cloud, layer: Option<Layer>) {
    if layer.is_some() {
        cloud.ellipsoids.clear();
        (cloud.growth, cloud.level, cloud.life) = (None, None, None);
        cloud.evaporation = Evaporation::default();
    }
    cloud.layer = layer;
}

/// What the map of a layer is.
fn map_told(layer: &Layer) -> String {
    match layer.map.as_ref().map(|map| (map, map.cover())) {
        None => " Drop a PNG or EXR picture into the window to paint what it covers.".to_owned(),
        Some((map, None)) => format!(" {} was not read: open the scene anew.", map.file),
        Some((map, Some(cover))) => {
            let [width, height] = cover.size();
            let share = 100.0 * cover.mean();
            format!(
                " It is painted by {}, {width} x {height} pixels, {share:.0} % on average. Drop another picture into the window to \
                 take that.",
                map.file
            )
        }
    }
}

/// The map, which a picture that is dropped makes.
fn map_rows(form: &mut Form<'_>, numbers: &mut Layer) {
    let Some(map) = &mut numbers.map else { return };
    let mut is_painted = true;
    form.slider(
        "CoverMap.size",
        "Size of the map",
        &mut map.size,
        CoverMap::default().size,
        1000.0..=100_000.0,
    );
    form.check("Layer.map", "Painted", &mut is_painted, false);
    if !is_painted {
        numbers.map = None;
    }
}

fn layer_rows(form: &mut Form<'_>, numbers: &mut Layer) {
    let usual = Layer::default();
    form.slider("Layer.base", "Base", &mut numbers.base, usual.base, 0.0..=12_000.0);
    form.slider("Layer.thickness", "Thickness", &mut numbers.thickness, usual.thickness, 10.0..=2000.0);
    form.number("Layer.coverage", "Coverage", &mut numbers.coverage, usual.coverage);
    form.slider("Layer.scale", "Scale", &mut numbers.scale, usual.scale, 100.0..=5000.0);
    form.number("Layer.stretch", "Stretch", &mut numbers.stretch, usual.stretch);
    form.slider("Layer.heading_deg", "Heading", &mut numbers.heading_deg, usual.heading_deg, 0.0..=360.0);
    form.number("Layer.heaps", "Heaps", &mut numbers.heaps, usual.heaps);
    form.number("Layer.cells", "Cells", &mut numbers.cells, usual.cells);
    form.number("Layer.bulge", "Bulge", &mut numbers.bulge, usual.bulge);
    form.slider("Layer.density", "Density", &mut numbers.density, usual.density, 0.0..=4.0);
    form.whole("Layer.seed", "Seed", &mut numbers.seed, usual.seed);
}
