//! Simple models of transport against closed forms, and what work they leave out.
#![cfg(feature = "export")]

use crate::common;

use std::f64::consts::PI;

use common::{
    gpu,
    picture::{draw, in_coarse_light, renderer, scene},
};
use glam::DVec3;
use nephos::{
    render::{Counts, Quality, Transport},
    scene::{Preset, Scene},
};

const SIZE: [u32; 2] = [64, 36];
/// Height of the picture and radius of the sphere in it, m.
const HEIGHT: f64 = 220.0;
const RADIUS: f64 = 100.0;

/// A homogeneous sphere seen by an orthographic camera.
fn sphere(per_cm3: f64, phase: &str, albedo: f64, sky: &str) -> Scene {
    scene(&format!(
        r#"{{"clouds": [{{"edge": {{"boundary": 0}},
            "droplets": {{"phase": {phase}, "concentration_per_cm3": {per_cm3}, "albedo": {albedo}}},
            "ellipsoids": [{{"center": [0, 1000, 0], "radii": [{RADIUS}, {RADIUS}, {RADIUS}]}}]}}],
        "sky": {sky}, "sun": {{"position": {{"direction": [0.6, 0.8, 0]}}, "irradiance": [1, 2, 4]}},
        "camera": {{"position": [0, 1000, 500], "target": [0, 1000, 0],
            "projection": {{"orthographic": {{"height": {HEIGHT}}}}}}}}}"#
    ))
}

/// Where each pixel looks: x and y from the middle of the sphere, and half of the chord there, m.
fn rays() -> Vec<(f64, f64, f64)> {
    let metres = HEIGHT / f64::from(SIZE[1]);
    (0..SIZE[0] * SIZE[1])
        .map(|i| {
            let x = metres * (f64::from(i % SIZE[0]) + 0.5 - 0.5 * f64::from(SIZE[0]));
            let y = metres * (0.5 * f64::from(SIZE[1]) - f64::from(i / SIZE[0]) - 0.5);
            (x, y, (RADIUS * RADIUS - x * x - y * y).max(0.0).sqrt())
        })
        .collect()
}

#[test]
fn an_emitter_shows_its_emission_times_its_opacity() {
    let sky = r#"{"uniform": {"radiance": [0.1, 0.3, 0.2]}}"#;
    // Droplets' peak is not left out: nothing is scattered.
    for (phase, albedo) in [(r#""isotropic""#, 1.0), (r#""mie""#, 1.0), (r#""mie""#, 0.8)] {
        let scene = sphere(120.0, phase, albedo, sky);
        let extinction = scene.clouds[0].droplets.extinction();
        let picture = draw(&mut renderer(Quality::FINAL, Transport::EMITTER), &scene, SIZE, false);
        for (pixel, (x, y, half)) in picture.pixels.iter().zip(rays()) {
            let opacity = 1.0 - (-2.0 * extinction * half).exp();
            let radiance = [1.0, 2.0, 4.0].map(|sun| sun / (4.0 * PI));
            for (channel, sky) in [0.1, 0.3, 0.2].into_iter().enumerate() {
                let exact = albedo * opacity * (radiance[channel] + sky);
                // Half floats have 11 bits; a ray ends where less than 0.003 gets through.
                let error = (f64::from(pixel[channel]) - exact).abs();
                assert!(error < 4e-3, "{pixel:?} for {exact} at {x} {y} of {phase}");
            }
        }
    }
}

/// The octaves' light of the sun, by quadrature: the sum of b^i P E int k e^{-k (s_view + a^i s_sun)} ds.
fn octaves(extinction: f64, to_sun: DVec3, (x, y, half): (f64, f64, f64)) -> f64 {
    let n = 400;
    let h = 2.0 * half / f64::from(n);
    let at = |j: i32| {
        let s = (f64::from(j) + 0.5) * h;
        let p = DVec3::new(x, y, half - s);
        let along = p.dot(to_sun);
        let sun = (along * along - p.length_squared() + RADIUS * RADIUS).max(0.0).sqrt() - along;
        let light = [1.0, 0.5, 0.25].map(|octave: f64| octave * (-octave * extinction * sun).exp());
        extinction * (-extinction * s).exp() * light.iter().sum::<f64>() * h / (4.0 * PI)
    };
    (0..n).map(at).sum()
}

#[test]
fn octaves_of_a_sphere_are_their_integrals() {
    for (per_cm3, bound) in [(1.0, 0.01), (60.0, 0.02)] {
        let scene = sphere(per_cm3, r#""isotropic""#, 1.0, r#""none""#);
        let extinction = scene.clouds[0].droplets.extinction();
        let quality = Quality { light_resolution: 64, ..Quality::FINAL };
        let picture = draw(&mut renderer(quality, Transport::OCTAVES), &scene, SIZE, false);
        let mut squares = (0.0, 0.0);
        for (pixel, ray) in picture.pixels.iter().zip(rays()) {
            let exact = octaves(extinction, scene.sun.to_sun(), ray);
            squares.0 += (f64::from(pixel[0]) - exact).powi(2);
            squares.1 += exact * exact;
        }
        let error = (squares.0 / squares.1).sqrt();
        // As for single scattering: the optical depth to the sun comes from voxels.
        assert!(error < bound, "relative RMSE {error} at {per_cm3} droplets per cm3");
    }
}

#[test]
fn octaves_of_a_thin_cloud_are_seven_quarters_of_single_scattering() {
    let scene = sphere(0.2, r#""isotropic""#, 1.0, r#""none""#);
    let [single, octaves] = [Transport::SINGLE, Transport::OCTAVES].map(|transport| {
        let picture = draw(&mut renderer(in_coarse_light(Quality::FINAL), transport), &scene, SIZE, false);
        picture.pixels.iter().map(|pixel| f64::from(pixel[2])).sum::<f64>()
    });
    // The optical diameter is 0.009: shadows take less than that.
    assert!((octaves / single - 1.75).abs() < 0.01, "{octaves} {single}");
}

#[test]
fn models_leave_out_the_work_that_they_do_not_need() {
    let scene = Preset::Mediocris.scene(1);
    let work = |transport| -> Counts {
        let mut renderer = renderer(in_coarse_light(Quality::PREVIEW), transport);
        renderer.settings.counting = true;
        draw(&mut renderer, &scene, SIZE, true);
        renderer.counts(gpu()).unwrap()
    };
    let (emitter, single, octaves) =
        (work(Transport::EMITTER), work(Transport::SINGLE), work(Transport::OCTAVES));
    assert_eq!(octaves, single, "octaves are exponentials only");
    assert_eq!(emitter.map_reads, 0, "an emitter knows no shadow");
    assert!(emitter.density_evaluations <= emitter.steps, "{emitter:?}");
    assert!(single.density_evaluations <= single.steps, "none towards the sun: {single:?}");
}
