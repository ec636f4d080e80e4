//! Rain and ice in pictures: bows and halos where their phase functions have them, in truth and in preview.
#![cfg(feature = "export")]

use crate::common;

use common::{
    picture::{draw, in_coarse_light, renderer, scene},
    truth::{Measured, assert_agree, mean, trace},
};
use nephos::{
    optics::phase::Phase,
    render::{Quality, Transport},
    scene::{Droplets, Preset, Scene, Species},
};

/// Optical depth along the middle of the ball.
const DEPTH: f64 = 0.02;

/// A thin homogeneous ball in a lens so narrow that its middle fills the picture, which sees light that was turned by
/// `theta_deg` degrees. The sun has no disc where `disc` is 0.
fn ball(species: Species, theta_deg: f64, disc: f64) -> Scene {
    let droplets =
        Droplets { species, effective_radius_um: species.usual_radius_um(), ..Droplets::default() };
    let mass = 1000.0 * DEPTH / 200.0 * 1e-6 * droplets.effective_radius_um * species.density() / 1.5;
    // The eye looks along -z, which light goes to at 0 degrees from.
    let theta = theta_deg.to_radians();
    let (x, z) = (theta.sin(), -theta.cos());
    let (name, radius_um) = (species.name(), droplets.effective_radius_um);
    scene(&format!(
        r#"{{"clouds": [{{"edge": {{"boundary": 0}},
            "droplets": {{"species": "{name}", "effective_radius_um": {radius_um}, "mass_g_per_m3": {mass}}},
            "ellipsoids": [{{"center": [0, 1000, 0], "radii": [100, 100, 100]}}]}}],
        "sky": "none", "sun": {{"position": {{"direction": [{x}, 0, {z}]}}, "irradiance": [1, 1, 1],
            "angular_diameter_deg": {disc}}},
        "camera": {{"position": [0, 1000, 500], "target": [0, 1000, 0],
            "projection": {{"orthographic": {{"height": 2}}}}}}}}"#
    ))
}

/// Angles where something is: beside halo and bow, on them, far from both.
const ANGLES: [(Species, f64); 8] = [
    (Species::Ice, 19.5),
    (Species::Ice, 22.7),
    (Species::Ice, 100.0),
    (Species::Rain, 60.0),
    (Species::Rain, 133.5),
    (Species::Rain, 138.6),
    (Species::Snow, 40.0),
    (Species::Graupel, 150.0),
];

fn phase(scene: &Scene) -> Phase {
    Phase::of(&scene.clouds[0].droplets).unwrap()
}

#[test]
fn truth_scatters_thin_matter_by_its_phase_function() {
    let results = ANGLES.iter().flat_map(|&(species, theta_deg)| {
        let scene = ball(species, theta_deg, 0.0);
        let found = trace(&scene, [4; 2], 20_000);
        let phase = phase(&scene);
        [0, 2].map(|channel| {
            // Of light that is scattered twice there is as much as another half percent.
            let wanted = phase.value(channel, theta_deg.to_radians()) * DEPTH;
            let wanted = Measured { value: wanted, error: 0.012 * wanted };
            (format!("{species:?} {theta_deg}, channel {channel}"), mean(&found, channel), wanted)
        })
    });
    assert_agree(&results.collect::<Vec<_>>());
}

#[test]
fn previews_scatter_thin_matter_by_its_phase_function_over_the_suns_disc() {
    for (species, theta_deg) in ANGLES {
        let scene = ball(species, theta_deg, 0.53);
        let phase = phase(&scene);
        let quality = in_coarse_light(Quality::PREVIEW);
        let picture = draw(&mut renderer(quality, Transport::MOMENTS), &scene, [4; 2], false);
        for channel in [0, 2] {
            let found = picture.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / 16.0;
            // Evenly over the width of the disc is enough here.
            let disc = |i: u32| {
                let x = (f64::from(i) + 0.5) / 20.0 * 2.0 - 1.0;
                let weight = (1.0 - x * x).sqrt();
                (weight * phase.value(channel, (theta_deg + 0.265 * x).to_radians()), weight)
            };
            let (sum, whole) = (0..20).map(disc).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            let wanted = sum / whole * DEPTH;
            // The table's angles are a third of a degree apart at the most. What is scattered twice, of half the depth
            // and every which way, counts where it is dark.
            let twice = 0.5 * DEPTH * DEPTH / (4.0 * std::f64::consts::PI);
            let error = (found - wanted).abs();
            assert!(
                error < 0.06 * wanted + 0.5 * twice,
                "{species:?} {theta_deg}, {channel}: {found} for {wanted}"
            );
        }
    }
}

#[test]
fn all_models_of_light_draw_ice_and_rain() {
    for species in [Species::Ice, Species::Rain] {
        let mut renderer = renderer(in_coarse_light(Quality::PREVIEW), Transport::SINGLE);
        for transport in Transport::all() {
            renderer.settings.transport = transport;
            let picture = draw(&mut renderer, &ball(species, 22.7, 0.53), [4; 2], false);
            let light = picture.pixels[5];
            assert!(light.iter().all(|value| value.is_finite() && *value > 0.0), "{species:?}, {transport}");
        }
    }
}

#[test]
fn a_shower_has_a_bow_with_red_outside() {
    let mut shower = Preset::Shower.scene(1);
    // The curtain alone, in clear air.
    shower.clouds.retain(|cloud| cloud.name == "rain");
    shower.sky = nephos::scene::Sky::None;
    // A tall strip up the middle of the picture, half a degree a row; the bow's top is 15 degrees high in it.
    let (width, height) = (8, 108);
    let quality = in_coarse_light(Quality::PREVIEW);
    let picture = draw(&mut renderer(quality, Transport::MOMENTS), &shower, [width, height], false);
    let row = |channel: usize| {
        let light = |y: &u32| {
            let at = |x: u32| picture.pixels[(y * width + x) as usize][channel];
            (0..width).map(at).sum::<f32>()
        };
        (50..68).max_by(|a, b| light(a).total_cmp(&light(b))).unwrap()
    };
    let rows = [0, 1, 2].map(row);
    assert!(rows[0] < rows[1] && rows[1] < rows[2] && rows[0] > 50, "{rows:?}");
}
