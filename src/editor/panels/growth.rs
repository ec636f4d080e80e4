//! How a cloud grows: its numbers, and anew with each.

use eframe::egui::Ui;

use super::{apply, hint, object::path};
use crate::{
    editor::{Document, form::Form, words::choice},
    scene::{Cloud, Growth, GrowthKind, timeline::Owner},
};

/// The kinds that grow, as the panel calls them.
const KINDS: [(&str, &str, GrowthKind); 7] = [
    ("Humilis", "GrowthKind.humilis", GrowthKind::Humilis),
    ("Mediocris", "GrowthKind.mediocris", GrowthKind::Mediocris),
    ("Congestus", "GrowthKind.congestus", GrowthKind::Congestus),
    ("Cumulonimbus", "GrowthKind.cumulonimbus", GrowthKind::Cumulonimbus),
    ("Fractus", "GrowthKind.fractus", GrowthKind::Fractus),
    ("Closed cells", "GrowthKind.closed_cells", GrowthKind::ClosedCells),
    ("Open cells", "GrowthKind.open_cells", GrowthKind::OpenCells),
];

/// Whether a cloud grows, and its numbers.
pub(super) fn growth(ui: &mut Ui, document: &mut Document, index: usize, cloud: &Cloud) {
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    let mut grows = cloud.growth.is_some();
    form.check("Cloud.growth", "Grows", &mut grows, false);
    let mut numbers = cloud.growth.clone().unwrap_or_else(|| in_place_of(cloud));
    if grows {
        growth_rows(&mut form, &mut numbers);
    }
    let change = form.changed();
    let told = match grows {
        true => format!("{} ellipsoids. A change of one by hand ends the growth.", cloud.ellipsoids.len()),
        false => "Ellipsoids made by hand. To let it grow takes their place.".to_owned(),
    };
    hint(ui, &told);
    apply(document, change, |scene| scene.clouds[index].growth = grows.then_some(numbers));
}

fn growth_rows(form: &mut Form<'_>, numbers: &mut Growth) {
    let kind = numbers.kind;
    form.choice(
        "Growth.kind",
        "Kind",
        &mut numbers.kind,
        &KINDS.map(|(name, path, kind)| (name, choice(path), kind)),
    );
    let usual = Growth::new(numbers.kind, numbers.seed);
    if numbers.kind != kind {
        // Of another kind, as it is usual, where it was.
        *numbers = Growth { place: numbers.place, heading_deg: numbers.heading_deg, ..usual.clone() };
    }
    form.whole("Growth.seed", "Seed", &mut numbers.seed, 1);
    form.slider(
        "Growth.width",
        "Width",
        &mut numbers.width,
        usual.width,
        0.2 * usual.width..=3.0 * usual.width,
    );
    form.slider(
        "Growth.height",
        "Height",
        &mut numbers.height,
        usual.height,
        0.2 * usual.height..=3.0 * usual.height,
    );
    form.slider("Growth.lean", "Lean", &mut numbers.lean, usual.lean, 0.0..=1.0);
    form.slider("Growth.heading_deg", "Heading", &mut numbers.heading_deg, usual.heading_deg, 0.0..=360.0);
    form.number("Growth.coverage", "Coverage", &mut numbers.coverage, usual.coverage);
    form.number("Growth.age", "Age", &mut numbers.age, usual.age);
    form.number("Growth.detail", "Detail", &mut numbers.detail, usual.detail);
    form.vector("Growth.place", "Place", &mut numbers.place, usual.place);
}

/// A growth as large as the ellipsoids of `cloud` are together, where they are.
fn in_place_of(cloud: &Cloud) -> Growth {
    let usual = Growth::new(GrowthKind::default(), 1);
    let Some((low, high)) = cloud.bounds() else { return usual };
    let (size, middle) = (high - low, 0.5 * (low + high));
    let kind = match size.y / size.x.max(1.0) {
        flat if flat < 0.5 => GrowthKind::Humilis,
        even if even < 0.9 => GrowthKind::Mediocris,
        _ => GrowthKind::Congestus,
    };
    let place = middle.with_y(low.y).round();
    Growth { place, width: size.x.round().max(1.0), height: size.y.round().max(1.0), ..Growth::new(kind, 1) }
}
