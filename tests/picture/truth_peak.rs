//! The path tracer's way to the sun through the forward peak of phase functions: the same light as without,
//! region by region, and closed forms.
#![cfg(feature = "export")]

use crate::common;

use common::{
    picture::{draw, renderer, scene},
    truth::{
        DISC, EXTINCTION_PER_CM3, Measured, assert_agree, by_batches, mean, noisy, opacity, sphere, trace,
        trace_with, traced, tracer,
    },
};
use glam::DVec3;
use nephos::{
    optics::phase::Phase,
    reference::{Estimate, PathOptions},
    render::{Quality, Transport},
    scene::{Scene, SunPosition},
};

fn seed(seed: u32) -> PathOptions {
    PathOptions { seed, ..PathOptions::default() }
}

/// Aimed at the sun by the whole phase function at every collision, as it stands in the textbook.
fn plain(seed: u32) -> PathOptions {
    PathOptions { seed, through_peak: false, ..PathOptions::default() }
}

/// Mean of one channel over each quarter of a square picture.
fn quarters(estimate: &Estimate, side: usize, channel: usize) -> [Measured; 4] {
    [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[right, low]| {
        let inside =
            |i: &usize| (i % side >= side / 2) == (right == 1) && (i / side >= side / 2) == (low == 1);
        let pixels: Vec<usize> = (0..side * side).filter(inside).collect();
        let part = |values: Vec<[f32; 3]>| Estimate {
            mean: pixels.iter().map(|&i| estimate.mean[i]).collect(),
            error: values,
            samples: estimate.samples,
        };
        mean(&part(pixels.iter().map(|&i| estimate.error[i]).collect()), channel)
    })
}

/// All quarters and channels of `scene` by both ways.
fn assert_same_light(name: &str, scene: &Scene, samples: [u32; 2]) {
    const SIDE: u32 = 12;
    let through = trace_with(scene, [SIDE; 2], samples[0], &seed(1));
    let whole = trace_with(scene, [SIDE; 2], samples[1], &plain(2));
    let results = (0..3).flat_map(|channel| {
        let [a, b] = [&through, &whole].map(|estimate| quarters(estimate, SIDE as usize, channel));
        (0..4).map(move |i| (format!("{name}, channel {channel}, quarter {i}"), a[i], b[i]))
    });
    assert_agree(&results.collect::<Vec<_>>());
}

/// A noisy cloud of Mie droplets with the sun in a direction, seen from the front.
fn lit(to_sun: DVec3, per_cm3: f64) -> Scene {
    let mut scene = noisy("\"mie\"", per_cm3, DVec3::new(0.3, 0.2, 0.9));
    scene.sun.position = SunPosition::Direction(to_sun);
    scene
}

#[test]
fn light_through_the_peak_is_that_of_the_whole_phase_function() {
    assert_same_light("side", &lit(DVec3::new(0.7, 0.5, 0.3), 40.0), [960, 1920]);
    assert_same_light("front", &lit(DVec3::new(0.3, 0.5, 0.8), 150.0), [960, 1920]);
    let mut absorbing = lit(DVec3::new(0.7, 0.5, -0.6), 80.0);
    absorbing.clouds[0].droplets.albedo = 0.9;
    absorbing.clouds[0].stratification = 0.8;
    assert_same_light("back, absorbing", &absorbing, [960, 1920]);
}

#[test]
fn light_around_the_sun_is_that_of_the_whole_phase_function() {
    // The sun's disc 6 degrees off the line of sight, behind a thin cloud.
    let mut aureole = lit(DVec3::new(-0.22, -0.15, -0.9), 15.0);
    assert_same_light("aureole", &aureole, [1920, 1920]);
    aureole.clouds[0].droplets.albedo = 0.5;
    assert_same_light("aureole, absorbing", &aureole, [1920, 1920]);
}

#[test]
fn light_through_clouds_of_two_kinds_is_that_of_the_whole_phase_function() {
    let droplets = r#""droplets": {"phase": "mie", "concentration_per_cm3": 40"#;
    let scene = |second: &str| {
        scene(&format!(
            r#"{{"clouds": [
                {{"edge": {{"boundary": 20}}, {droplets}, "effective_radius_um": 12}},
                    "ellipsoids": [{{"center": [-40, 1000, 0], "radii": [60, 60, 60]}}]}},
                {{"edge": {{"boundary": 20}}, {second}}},
                    "ellipsoids": [{{"center": [50, 1020, 0], "radii": [60, 60, 60]}}]}}],
            "sky": "none", "sun": {{"position": {{"direction": [0.8, 0.2, 0.1]}}}},
            "camera": {{"position": [0, 1000, 500], "target": [5, 1010, 0],
                "projection": {{"orthographic": {{"height": 240}}}}}}}}"#
        ))
    };
    let small = format!("{droplets}, \"effective_radius_um\": 5");
    assert_same_light("two sizes", &scene(&small), [960, 1920]);
    let isotropic = small.replace("\"mie\"", "\"isotropic\"");
    assert_same_light("one without a peak", &scene(&isotropic), [960, 1920]);
}

#[test]
fn a_furnace_of_droplets_with_a_peak_keeps_its_light() {
    let furnace = r#"{"uniform": {"radiance": [1, 1, 1]}}"#;
    for through_peak in [false, true] {
        let options = PathOptions { seed: 1, guided: false, through_peak, ..PathOptions::default() };
        let mut tracer = tracer(&sphere(8.0, "\"mie\"", furnace, [0.0, 1.0, 0.0], 0.0), [12, 12], &options);
        let estimate = traced(&mut tracer, 192);
        // Channels share a path: what one of them lacks, another one has.
        let light = [0, 1, 2].map(|channel| mean(&estimate, channel).value).iter().sum::<f64>() / 3.0;
        assert!((opacity(&estimate) - light).abs() < 1e-4, "{light} for {}", opacity(&estimate));
    }
}

#[test]
fn thin_spheres_scatter_once() {
    // Of what collides once, P of the scattering angle is seen. Twice scattered light and what is lost on the
    // way are of the first order in the thickness t beside that: two thicknesses take them out.
    let phase = Phase::mie(6.0).unwrap();
    let mut number = 0;
    let mut beyond = |scattering_deg: f64, wanted: f64, t: f64| {
        number += 1;
        let (sine, cosine) = scattering_deg.to_radians().sin_cos();
        // Light goes from the sun to the eye, which is at +z: straight on where the sun is at -z.
        let scene = sphere(t, "\"mie\"", "\"none\"", [sine, 0.0, -cosine], 1.0);
        let more = |estimate: &Estimate| mean(estimate, 1).value - wanted * opacity(estimate);
        by_batches(&mut tracer(&scene, [16, 16], &seed(number)), 12, 480, more).times(1.0 / (DISC * t))
    };
    let results = [170.0_f64, 90.0, 30.0, 12.0].map(|scattering_deg| {
        let wanted = phase.value(1, scattering_deg.to_radians());
        let (thin, thick) = (beyond(scattering_deg, wanted, 0.02), beyond(scattering_deg, wanted, 0.04));
        let value = 2.0 * thin.value - thick.value + 4.0 / 3.0 * wanted;
        let found = Measured { value, error: (2.0 * thin.error).hypot(thick.error) };
        // What is left is of the second order.
        let wanted = Measured { value: 4.0 / 3.0 * wanted, error: 2e-3 * wanted };
        (format!("{scattering_deg} degrees"), found, wanted)
    });
    assert_agree(&results);
}

#[test]
fn light_around_the_sun_is_as_wide_as_in_truth_behind_a_thick_veil() {
    // Of optical depth 3: light that came through its peak alone was scattered twice in it on the mean.
    let veil = |from_sun_deg: f64| {
        let (sine, cosine) = from_sun_deg.to_radians().sin_cos();
        scene(&format!(
            r#"{{"sky": "none", "clouds": [{{"edge": {{"boundary": 0}},
                "droplets": {{"concentration_per_cm3": {}}},
                "ellipsoids": [{{"center": [0, 0, 0], "radii": [900, 900, 60]}}]}}],
            "camera": {{"position": [0, 0, 2000], "target": [0, 0, 0], "projection": {{"orthographic": {{"height": 20}}}}}},
            "sun": {{"irradiance": [1, 1, 1], "position": {{"direction": [{sine}, 0, {}]}}}}}}"#,
            3.0 / 120.0 / EXTINCTION_PER_CM3,
            -cosine
        ))
    };
    let mut renderer = renderer(Quality::PREVIEW, Transport::MOMENTS);
    // With one scattering in the peak the first was 1.5 of truth, the second 0.64.
    for from_sun_deg in [0.6, 3.5] {
        let scene = veil(from_sun_deg);
        let truth = mean(&trace(&scene, [16, 16], 1200), 1);
        let pixels = draw(&mut renderer, &scene, [16, 16], false).pixels;
        let drawn = pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / pixels.len() as f64;
        eprintln!("{from_sun_deg} degrees: {drawn:.4} for {:.4} +- {:.4}", truth.value, truth.error);
        assert!(
            (drawn - truth.value).abs() < 0.05 * truth.value + 3.0 * truth.error,
            "{from_sun_deg}: {drawn} for {truth:?}"
        );
    }
}
