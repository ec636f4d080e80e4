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

/// Light of the sun, by quadrature: int k e^{-k s_view} `source`(k s_sun) ds, where the source is per unit of irradiance.
fn lit(source: fn(f64) -> f64, extinction: f64, to_sun: DVec3, (x, y, half): (f64, f64, f64)) -> f64 {
    let n = 400;
    let h = 2.0 * half / f64::from(n);
    let at = |j: i32| {
        let s = (f64::from(j) + 0.5) * h;
        let p = DVec3::new(x, y, half - s);
        let along = p.dot(to_sun);
        let sun = (along * along - p.length_squared() + RADIUS * RADIUS).max(0.0).sqrt() - along;
        extinction * (-extinction * s).exp() * source(extinction * sun) * h
    };
    (0..n).map(at).sum()
}

/// Relative RMSE of the sun's light on a sphere against the integral of `source`.
fn error(transport: Transport, per_cm3: f64, source: fn(f64) -> f64) -> f64 {
    let scene = sphere(per_cm3, r#""isotropic""#, 1.0, r#""none""#);
    let extinction = scene.clouds[0].droplets.extinction();
    let quality = Quality { light_resolution: 64, ..Quality::FINAL };
    let picture = draw(&mut renderer(quality, transport), &scene, SIZE, false);
    let mut squares = (0.0, 0.0);
    for (pixel, ray) in picture.pixels.iter().zip(rays()) {
        let exact = lit(source, extinction, scene.sun.to_sun(), ray);
        squares.0 += (f64::from(pixel[0]) - exact).powi(2);
        squares.1 += exact * exact;
    }
    (squares.0 / squares.1).sqrt()
}

#[test]
fn octaves_of_a_sphere_are_their_integrals() {
    for (per_cm3, bound) in [(1.0, 0.01), (60.0, 0.02)] {
        // The sum of b^i P e^{-a^i t}.
        let error = error(Transport::OCTAVES, per_cm3, |t| {
            [1.0, 0.5, 0.25].map(|octave: f64| octave * (-octave * t).exp()).iter().sum::<f64>() / (4.0 * PI)
        });
        // As for single scattering: the optical depth to the sun comes from voxels.
        assert!(error < bound, "relative RMSE {error} at {per_cm3} droplets per cm3");
    }
}

#[test]
fn powder_of_a_sphere_is_its_integral() {
    // Rays through much thinner ones are lit at once, from one end without light to the other; in much thicker
    // ones the light rises and falls within a few voxels of the sun's volume: 0.09 at 400, half with twice the voxels.
    let error = error(Transport::POWDER, 60.0, |t| {
        // A lobe of g = 0.2, across the sun: (1 - g^2) / (1 + g^2)^1.5.
        let phase = 0.96 / (4.0 * PI * 1.04f64.powf(1.5));
        phase * (-t).exp() * (1.0 - (-2.0 * t).exp()) * 2.0
    });
    // Measured: 0.010.
    assert!(error < 0.02, "relative RMSE {error}");
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
