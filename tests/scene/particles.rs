//! What clouds are made of: names, sizes, masses in scene files.

use nephos::{
    optics::phase::Phase,
    scene::{Droplets, Habit, Preset, Scene, Species},
};

fn droplets(json: &str) -> nephos::Result<Droplets> {
    let scene = Scene::from_json(&format!(r#"{{"clouds": [{{"droplets": {json}}}]}}"#))?;
    Ok(scene.clouds[0].droplets.clone())
}

#[test]
fn files_that_name_no_species_are_water_and_are_written_as_before() {
    let water = droplets(r#"{"effective_radius_um": 8}"#).unwrap();
    assert_eq!((water.species, water.mass_g_per_m3), (Species::Water, None));
    let text = Preset::Humilis.scene(1).to_json();
    for word in ["species", "habit", "roughness", "mass"] {
        assert!(!text.contains(word), "{word}");
    }
}

#[test]
fn species_survive_a_round_trip() {
    for (json, species) in [
        (r#"{"species": "rain", "effective_radius_um": 500, "mass_g_per_m3": 0.3}"#, Species::Rain),
        (
            r#"{"species": "ice", "habit": "plates", "roughness": 0.1, "effective_radius_um": 40}"#,
            Species::Ice,
        ),
        (r#"{"species": "snow", "effective_radius_um": 250}"#, Species::Snow),
        (r#"{"species": "graupel", "effective_radius_um": 1000}"#, Species::Graupel),
    ] {
        let read = droplets(json).unwrap();
        assert_eq!(read.species, species);
        let again = droplets(&serde_json::to_string(&read).unwrap()).unwrap();
        assert_eq!(again, read);
    }
    let plates = droplets(r#"{"species": "ice", "habit": "plates", "effective_radius_um": 40}"#).unwrap();
    assert_eq!(plates.habit, Habit::Plates);
}

#[test]
fn extinction_of_a_mass_is_three_halves_of_it_over_density_and_radius() {
    for (species, density) in [
        (Species::Water, 1000.0),
        (Species::Rain, 1000.0),
        (Species::Ice, 917.0),
        (Species::Snow, 100.0),
        (Species::Graupel, 400.0),
    ] {
        let some = Droplets::of_mass(species, 0.5);
        let wanted = 3.0 * 0.5e-3 / (2.0 * density * some.effective_radius_um * 1e-6);
        assert!((some.extinction() / wanted - 1.0).abs() < 1e-12, "{species:?}");
    }
    // An anvil of 0.1 g over 3 km: ice of 40 um has a depth of 12, of 1 mm, as one of the sources has it, 0.5.
    let anvil = Droplets::of_mass(Species::Ice, 0.1).extinction() * 3000.0;
    assert!((12.0..12.5).contains(&anvil), "{anvil}");
}

#[test]
fn sizes_that_a_species_has_not_are_refused_by_name() {
    for (json, problem) in [
        (r#"{"effective_radius_um": 40}"#, "40 is out of range: expected 4 to 20 micrometres"),
        (
            r#"{"species": "rain", "effective_radius_um": 6}"#,
            "6 is out of range for rain: expected 50 to 3000 micrometres, usual are 500",
        ),
        (
            r#"{"species": "ice", "effective_radius_um": 4000}"#,
            "4000 is out of range for ice: expected 10 to 500 micrometres",
        ),
        (r#"{"species": "ice", "effective_radius_um": 40, "roughness": 0.6}"#, "expected 0 to 0.5"),
        (r#"{"mass_g_per_m3": -1}"#, "-1 is out of range: expected 0 to 100 grams per cubic metre"),
        (r#"{"species": "hail"}"#, "hail"),
    ] {
        let error = droplets(json).unwrap_err().to_string();
        assert!(error.contains(problem) && error.contains("clouds[0].droplets"), "{json}: {error}");
    }
}

#[test]
fn every_species_has_a_phase_function_at_its_usual_and_its_outermost_sizes() {
    for species in [Species::Water, Species::Rain, Species::Ice, Species::Snow, Species::Graupel] {
        let [least, most] = species.radii_um();
        for effective_radius_um in [least, species.usual_radius_um(), most] {
            let droplets = Droplets { species, effective_radius_um, ..Droplets::default() };
            let phase = Phase::of(&droplets).unwrap();
            // Of green: 1 over the sphere, by another rule than its own.
            let rings = 40_000;
            let sum: f64 = (0..rings)
                .map(|i| {
                    let x = (f64::from(i) + 0.5) / f64::from(rings);
                    let theta = std::f64::consts::PI * x.powi(3);
                    let wide = 3.0 * std::f64::consts::PI * x * x / f64::from(rings);
                    2.0 * std::f64::consts::PI * theta.sin() * phase.value(1, theta) * wide
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-4, "{species:?}, {effective_radius_um} um: {sum}");
            assert!((0.7..0.92).contains(&phase.asymmetry(1)), "{species:?}: {}", phase.asymmetry(1));
        }
    }
}
