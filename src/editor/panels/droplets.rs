//! The rows of what a cloud is made of.

use eframe::egui::Ui;

use super::{apply, hint, object::path};
use crate::{
    editor::{Document, form::Form, words::choice},
    scene::{Cloud, Droplets, Habit, Phase, Species, timeline::Owner},
};

/// The species, and what is usual of it: grams per cubic metre of air, and the most that its slider has.
const SPECIES: [(Species, f64, f64); 5] = [
    (Species::Water, 0.3, 2.0),
    (Species::Rain, 1.0, 5.0),
    (Species::Ice, 0.02, 0.5),
    (Species::Snow, 0.2, 2.0),
    (Species::Graupel, 1.0, 5.0),
];

/// Shows what the droplets of a cloud are.
pub(super) fn droplets(ui: &mut Ui, document: &mut Document, index: usize, cloud: &Cloud) {
    let (mut water, default) = (cloud.droplets.clone(), Droplets::default());
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    species(&mut form, &mut water);
    // A volume tells by itself how dense it is.
    let is_counted = cloud.volume.is_none();
    if is_counted {
        how_many(&mut form, &mut water);
    }
    let [least, most] = water.species.radii_um();
    form.slider(
        "Droplets.effective_radius_um",
        "Effective radius",
        &mut water.effective_radius_um,
        water.species.usual_radius_um(),
        least..=most,
    );
    water.effective_radius_um = water.effective_radius_um.clamp(least, most);
    let phases = [
        ("As it is", choice("Phase.mie"), Phase::Mie),
        ("Henyey-Greenstein", choice("Phase.henyey_greenstein"), Phase::HenyeyGreenstein { g: 0.85 }),
        ("Isotropic", choice("Phase.isotropic"), Phase::Isotropic),
    ];
    form.choice("Droplets.phase", "Phase function", &mut water.phase, &phases);
    if let Phase::HenyeyGreenstein { g } = &mut water.phase {
        form.number("Phase.henyey_greenstein.g", "Asymmetry", g, 0.85);
    }
    form.number("Droplets.albedo", "Albedo", &mut water.albedo, default.albedo);
    let change = form.changed();
    let free = 1.0 / water.extinction();
    if is_counted && free.is_finite() {
        hint(ui, &format!("Mean free path of light: {free:.1} m"));
    }
    apply(document, change, |scene| scene.clouds[index].droplets = water);
}

/// The species, and of ice its crystals. A new one begins with what is usual of it.
fn species(form: &mut Form<'_>, water: &mut Droplets) {
    let before = water.species;
    let choices = [
        ("Water", choice("Species.water"), Species::Water),
        ("Rain", choice("Species.rain"), Species::Rain),
        ("Ice", choice("Species.ice"), Species::Ice),
        ("Snow", choice("Species.snow"), Species::Snow),
        ("Graupel", choice("Species.graupel"), Species::Graupel),
    ];
    form.choice("Droplets.species", "Particles", &mut water.species, &choices);
    if water.species != before {
        water.effective_radius_um = water.species.usual_radius_um();
        water.mass_g_per_m3 = (water.species != Species::Water).then_some(usual(water.species).0);
    }
    if water.species == Species::Ice {
        let habits = [
            ("Columns", choice("Habit.columns"), Habit::Columns),
            ("Plates", choice("Habit.plates"), Habit::Plates),
        ];
        form.choice("Droplets.habit", "Crystals", &mut water.habit, &habits);
        form.number("Droplets.roughness", "Roughness", &mut water.roughness, Droplets::default().roughness);
    }
}

/// How dense it is, by its mass or by a count.
fn how_many(form: &mut Form<'_>, water: &mut Droplets) {
    let (mass, most) = usual(water.species);
    let mut by_mass = water.mass_g_per_m3.is_some();
    form.check("Droplets.mass_g_per_m3", "By mass", &mut by_mass, false);
    water.mass_g_per_m3 = by_mass.then(|| water.mass_g_per_m3.unwrap_or(mass));
    match &mut water.mass_g_per_m3 {
        Some(grams) => form.slider("Droplets.mass_g_per_m3", "Mass", grams, mass, 0.0..=most),
        None => form.slider(
            "Droplets.concentration_per_cm3",
            "Concentration",
            &mut water.concentration_per_cm3,
            Droplets::default().concentration_per_cm3,
            0.0..=1000.0,
        ),
    }
}

fn usual(species: Species) -> (f64, f64) {
    SPECIES.iter().find(|(known, ..)| *known == species).map_or((0.3, 2.0), |(_, mass, most)| (*mass, *most))
}
