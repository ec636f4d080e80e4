//! Layers: what they cover, where they end, and their light against truth.
#![cfg(feature = "export")]

use crate::common;

use common::truth::trace;
use common::{
    gpu,
    picture::{draw, renderer, scene},
};
use nephos::{
    export::Picture,
    reference::Estimate,
    render::{Film, Quality, Transport},
    scene::Scene,
};

const SIZE: [u32; 2] = [48, 27];
/// Rays across a pixel: truth sees all of it.
const RAYS: u32 = 4;

/// A deck without air between it and the camera.
fn deck(layer: &str, cloud: &str, camera: &str, sun: &str) -> Scene {
    scene(&format!(
        r#"{{"clouds": [{{"layer": {{{layer}}}, {cloud}}}], "camera": {{{camera}}},
            "sky": {{"uniform": {{"radiance": [0.05, 0.06, 0.08]}}}},
            "sun": {{"irradiance": [1, 1, 1], "position": {{"angles": {{{sun}}}}}}}}}"#
    ))
}

const HEAPS: &str = r#""base": 1000, "thickness": 300, "scale": 700, "coverage": 0.7"#;
const WATER: &str = r#""droplets": {"concentration_per_cm3": 80, "effective_radius_um": 9},
    "edge": {"boundary": 60, "wispiness": 0.2}"#;
const HIGH: &str = r#""azimuth_deg": 120, "elevation_deg": 50"#;
const LOW: &str = r#""azimuth_deg": 120, "elevation_deg": 12"#;

fn looking(position: [f64; 3], target: [f64; 3], fov: f64) -> String {
    format!(
        r#""position": {position:?}, "target": {target:?}, "projection": {{"perspective": {{"vertical_fov_deg": {fov}}}}}"#
    )
}

fn from_below() -> String {
    looking([300.0, 2.0, 500.0], [300.0, 700.0, -500.0], 60.0)
}

fn from_above() -> String {
    looking([300.0, 2600.0, 500.0], [300.0, 1700.0, -700.0], 60.0)
}

/// Relative RMSE of all light, the noise of the truth taken off, and the bias.
fn errors(drawn: &Picture, truth: &Estimate) -> (f64, f64) {
    let (mut square, mut noise, mut light, mut sums) = (0.0, 0.0, 0.0, [0.0; 2]);
    for ((pixel, mean), error) in drawn.pixels.iter().zip(&truth.mean).zip(&truth.error) {
        for c in 0..3 {
            let (found, wanted) = (f64::from(pixel[c]), f64::from(mean[c]));
            square += (found - wanted).powi(2);
            noise += f64::from(error[c]).powi(2);
            light += wanted * wanted;
            sums[0] += found;
            sums[1] += wanted;
        }
    }
    (((square - noise).max(0.0) / light).sqrt(), sums[0] / sums[1] - 1.0)
}

fn measured(scene: &Scene, samples: u32) -> (f64, f64) {
    let film = Film::new(SIZE, RAYS);
    let frame = film.frame(scene).unwrap();
    let truth = trace(scene, SIZE, samples);
    let mut renderer = renderer(Quality::FINAL, Transport::MOMENTS);
    let drawn = film.take(gpu(), &mut renderer, &frame, false, &mut |_| ()).unwrap();
    errors(&drawn, &truth)
}

#[test]
fn light_of_layers_is_near_the_truth() {
    let sheet = r#""base": 1000, "thickness": 200, "coverage": 1, "heaps": 0, "bulge": 0"#;
    let cases = [
        ("sheet below", sheet, from_below(), HIGH, 0.05),
        ("sheet above", sheet, from_above(), HIGH, 0.05),
        ("sheet low sun", sheet, from_above(), LOW, 0.05),
        ("deck below", HEAPS, from_below(), HIGH, 0.10),
        ("deck above", HEAPS, from_above(), HIGH, 0.10),
        ("deck low sun", HEAPS, from_above(), LOW, 0.10),
        ("deck low sun below", HEAPS, from_below(), LOW, 0.10),
    ];
    let mut wrong = Vec::new();
    for (name, layer, camera, sun, bound) in cases {
        let (error, bias) = measured(&deck(layer, WATER, &camera, sun), 96);
        eprintln!("{name}: {error:.3}, bias {bias:+.3}");
        wrong.extend((error > bound).then(|| format!("{name}: {error:.3}")));
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Share of pixels whose opacity is above a half, by rays straight down from above.
fn covered(layer: &str, period: f64) -> f64 {
    let above = format!(
        r#""position": [0, 9000, 0], "target": [0, 0, -0.0001], "projection": {{"orthographic": {{"height": {period}}}}}"#
    );
    let opaque = r#""droplets": {"concentration_per_cm3": 2000, "effective_radius_um": 9}"#;
    let scene = deck(layer, opaque, &above, HIGH);
    // A texel of the field each, so that nothing is a mean over some.
    let film = Film::new([1024, 1024], 1);
    let frame = film.frame(&scene).unwrap();
    let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
    let picture = film.take(gpu(), &mut renderer, &frame, false, &mut |_| ()).unwrap();
    picture.pixels.iter().filter(|pixel| pixel[3] > 0.5).count() as f64 / picture.pixels.len() as f64
}

#[test]
fn covered_share_of_the_plan_is_the_coverage() {
    for heaps in [0.0, 1.0] {
        for coverage in [0.15, 0.8] {
            let layer = format!(r#""scale": 700, "heaps": {heaps}, "coverage": {coverage}"#);
            let share = covered(&layer, 12.0 * 700.0);
            eprintln!("heaps {heaps}: {share:.4} of {coverage}");
            assert!((share - coverage).abs() < 0.01, "heaps {heaps}: {share} of {coverage}");
        }
    }
}

#[test]
fn a_layer_that_covers_nothing_is_not_there() {
    let scene = deck(r#""coverage": 0"#, WATER, &from_below(), HIGH);
    let mut renderer = renderer(Quality::DRAFT, Transport::MOMENTS);
    renderer.settings.counting = true;
    let picture = draw(&mut renderer, &scene, SIZE, false);
    assert!(picture.pixels.iter().all(|pixel| *pixel == [0.0; 4]));
    assert_eq!(renderer.counts(gpu()).unwrap().rays, 0);
}

/// Elevation, degrees, of the lowest pixel of the middle column that shows a layer with its base at `base` metres.
fn lowest(base: f64, eye: f64) -> f64 {
    let fov = 4.0_f64;
    let camera = looking([0.0, eye, 0.0], [0.0, eye, -1000.0], fov);
    let layer = format!(r#""base": {base}, "coverage": 1, "heaps": 0, "thickness": 500"#);
    let rows = 400;
    let film = Film::new([1, rows], 1);
    let frame = film.frame(&deck(&layer, WATER, &camera, HIGH)).unwrap();
    let mut renderer = renderer(Quality::PREVIEW, Transport::SINGLE);
    let picture = film.take(gpu(), &mut renderer, &frame, false, &mut |_| ()).unwrap();
    let last = picture.pixels.iter().rposition(|pixel| pixel[3] > 0.5).unwrap();
    let half = (0.5 * fov).to_radians().tan();
    (half * (1.0 - 2.0 * (last as f64 + 1.0) / f64::from(rows))).atan().to_degrees()
}

#[test]
fn a_layer_goes_on_to_the_horizon_of_a_round_earth() {
    // The dip of the horizon, arccos(R / (R + h)); a base of 1200 m is met there 124 km away.
    let dip = |height: f64| (6360e3 / (6360e3 + height)).acos().to_degrees();
    for (base, eye) in [(1200.0, 2.0), (8000.0, 2.0), (4000.0, 1000.0)] {
        let (found, expected) = (lowest(base, eye), -dip(eye));
        eprintln!("{base} m from {eye} m: {found:.3}, expected {expected:.3} degrees");
        assert!((found - expected).abs() < 0.02, "{base} m from {eye} m: {found} for {expected} degrees");
    }
    // Seen from above, the top hides what is below: its own horizon is the end.
    let found = lowest_gap(1500.0, 6000.0);
    let expected = -dip_over(1500.0, 6000.0);
    assert!((found - expected).abs() < 0.02, "{found} for {expected}");
}

/// Angle below the level, degrees, at which a line of sight from `eye` touches a sphere `top` above the ground, m.
fn dip_over(top: f64, eye: f64) -> f64 {
    ((6360e3 + top) / (6360e3 + eye)).acos().to_degrees()
}

/// Elevation, degrees, of the highest pixel that shows a layer whose top is at `top`, seen from above.
fn lowest_gap(top: f64, eye: f64) -> f64 {
    let fov = 8.0_f64;
    let camera = looking([0.0, eye, 0.0], [0.0, eye, -1000.0], fov);
    let layer = format!(r#""base": {}, "coverage": 1, "heaps": 0, "thickness": 500"#, top - 500.0);
    let rows = 800;
    let film = Film::new([1, rows], 1);
    let frame =
        film.frame(&deck(&layer, r#""edge": {"boundary": 0, "wispiness": 0}"#, &camera, HIGH)).unwrap();
    let mut renderer = renderer(Quality::PREVIEW, Transport::SINGLE);
    let picture = film.take(gpu(), &mut renderer, &frame, false, &mut |_| ()).unwrap();
    let first = picture.pixels.iter().position(|pixel| pixel[3] > 0.5).unwrap();
    let half = (0.5 * fov).to_radians().tan();
    (half * (1.0 - 2.0 * first as f64 / f64::from(rows))).atan().to_degrees()
}

#[test]
fn light_among_the_heaps_of_a_deck_stays_white_in_a_white_furnace() {
    let layer = r#""base": 1000, "thickness": 300, "scale": 700, "coverage": 0.7"#;
    let mut scene = deck(layer, WATER, &from_below(), HIGH);
    scene.sky = nephos::scene::Sky::Uniform { radiance: [1.0; 3] };
    scene.sun.irradiance = [0.0; 3];
    let picture = draw(&mut renderer(Quality::PREVIEW, Transport::MOMENTS), &scene, SIZE, false);
    let lights = picture.pixels.iter().filter(|pixel| pixel[3] > 0.3).map(|pixel| pixel[1] / pixel[3]);
    let most = lights.map(|light| (light - 1.0).abs()).fold(0.0, f32::max);
    eprintln!("off by {most} at most");
    assert!(most < 0.01, "{most}");
}
