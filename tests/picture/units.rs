//! Light in whatever unit: lux, watts, or a ten-thousandth. Half floats inside must not show.
#![cfg(feature = "export")]

use crate::common;

use common::{
    gpu,
    picture::{draw, renderer},
};
use nephos::{
    export::{
        Picture, Studio, cube_faces, equirectangular, write_beauty, write_hdr, write_ktx2, write_layers,
    },
    reference::PathTracer,
    render::{Film, Quality, Transport},
    scene::{Scene, Sky, SunPosition, Tone, ToneCurve},
};

const UNITS: [f64; 6] = [1e-6, 0.003, 20.0, 1361.0, 120_000.0, 1_000_000.0];

/// A cloud before the sun, which is as bright as `unit`.
fn scene(unit: f64, sky: Sky) -> Scene {
    let mut scene = common::picture::scene(
        r#"{"clouds":[{"edge":{"boundary":30},"ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]}],
            "camera":{"position":[0,880,600],"target":[0,900,0]}}"#,
    );
    scene.sun.irradiance = [unit, 0.8 * unit, 0.5 * unit];
    scene.sky = match sky {
        Sky::Uniform { radiance } => Sky::Uniform { radiance: radiance.map(|light| light * unit) },
        sky => sky,
    };
    scene
}

fn skies() -> [Sky; 2] {
    [Sky::default(), Sky::Uniform { radiance: [0.1, 0.2, 0.3] }]
}

/// Checks that `found` is `expected` in another unit, to the rounding of half floats.
fn same(name: &str, found: &Picture, expected: &Picture, unit: f64) {
    for (i, (a, b)) in found.pixels.iter().zip(&expected.pixels).enumerate() {
        for c in 0..3 {
            let (a, b) = (f64::from(a[c]) / unit, f64::from(b[c]));
            assert!((a - b).abs() < 4e-3 * b.abs() + 1e-5, "{name}, unit {unit}, pixel {i}: {a} {b}");
        }
        assert!((a[3] - b[3]).abs() < 1e-3, "{name}, unit {unit}, pixel {i}");
    }
}

#[test]
fn pictures_are_the_same_in_every_unit() {
    let size = [24, 16];
    let mut renderer = renderer(Quality { jitter: false, ..Quality::DRAFT }, Transport::default());
    for sky in skies() {
        let film = Film::new(size, 1);
        let base = scene(1.0, sky.clone());
        let expected = draw(&mut renderer, &base, size, true);
        let stops = renderer.meter(gpu(), &film.frame(&base).unwrap()).unwrap();
        let shown = |renderer: &mut _, picture: &Picture, stops| {
            picture.finished(gpu(), renderer, Tone { stops, curve: ToneCurve::Natural }).unwrap()
        };
        let bytes = shown(&mut renderer, &expected, stops);
        for unit in UNITS {
            let scene = scene(unit, sky.clone());
            let frame = film.frame(&scene).unwrap();
            let found = draw(&mut renderer, &scene, size, true);
            same("beauty", &found, &expected, unit);
            let layers = renderer.render_layers(gpu(), &frame, &mut |_| ()).unwrap();
            let mut sum = film.read(gpu(), &layers.sun.sky).unwrap();
            let mut clouds = film.read(gpu(), &layers.sun.single).unwrap();
            for layer in [&layers.sun.multiple, &layers.sun.ambient, &layers.sun.air] {
                let light = film.read(gpu(), layer).unwrap();
                for (sum, light) in clouds.pixels.iter_mut().zip(light.pixels) {
                    (0..3).for_each(|c| sum[c] += light[c]);
                }
            }
            clouds.put_over(&sum);
            std::mem::swap(&mut sum, &mut clouds);
            same("layers", &sum.times(layers.unit), &expected, unit);
            let metered = renderer.meter(gpu(), &frame).unwrap();
            assert!((metered + unit.log2() - stops).abs() < 0.01, "{unit}: {metered} {stops}");
            let own = shown(&mut renderer, &found, stops - unit.log2());
            let apart = own.iter().zip(&bytes).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(apart <= 2, "{unit}: {apart}");
        }
    }
}

#[test]
fn truth_is_the_same_in_every_unit() {
    let size = [8, 6];
    let traced = |scene: &Scene| {
        let frame = Film::new(size, 1).frame(scene).unwrap();
        let mut tracer = PathTracer::new(gpu(), &frame, 3).unwrap();
        tracer.trace(24, &mut |_| true).unwrap();
        let estimate = tracer.estimate().unwrap();
        (estimate.noise(), Picture { width: 8, height: 6, pixels: estimate.mean })
    };
    for sky in skies() {
        let (noise, expected) = traced(&scene(1.0, sky.clone()));
        for unit in [1e-6, 120_000.0] {
            let (own, found) = traced(&scene(unit, sky.clone()));
            same("truth", &found, &expected, unit);
            assert!((own / noise - 1.0).abs() < 0.01, "{own} {noise}");
        }
    }
}

/// What the disc brings, by a map of the sphere without clouds, less the same of a point elsewhere.
fn irradiance(map: &Picture) -> [f64; 3] {
    let height = map.height as f64;
    let mut sum = [0.0; 3];
    for (i, pixel) in map.pixels.iter().enumerate() {
        let latitude = std::f64::consts::PI * (0.5 - (i / map.width) as f64 / height - 0.5 / height);
        let solid_angle = (std::f64::consts::PI / height).powi(2) * latitude.cos();
        (0..3).for_each(|c| sum[c] += solid_angle * f64::from(pixel[c]));
    }
    sum
}

#[test]
fn the_suns_disc_keeps_its_light_in_every_unit_and_size() {
    let mut studio = Studio::new(gpu(), 2, true);
    let mut disc = |unit: f64, diameter: f64, height: u32| {
        let mut scene = Scene { sky: Sky::Uniform { radiance: [0.0; 3] }, ..Scene::default() };
        scene.sun.irradiance = [unit; 3];
        scene.sun.angular_diameter_deg = diameter;
        scene.sun.position = SunPosition::Angles { azimuth_deg: 120.0, elevation_deg: 30.0 };
        irradiance(&equirectangular(&mut studio, &scene, height).unwrap()).map(|light| light / unit)
    };
    for unit in [1e-6, 1.0, 120_000.0, 1_000_000.0] {
        for (diameter, height) in [(0.53, 128), (0.0, 128), (0.02, 1024), (5.0, 256)] {
            let found = disc(unit, diameter, height);
            assert!(found.iter().all(|light| (light - 1.0).abs() < 0.06), "{unit} {diameter}: {found:?}");
        }
    }
}

#[test]
fn files_hold_the_light_or_say_that_they_cannot() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let size = [16, 12];
    let mut renderer = renderer(Quality { jitter: false, ..Quality::DRAFT }, Transport::SINGLE);
    for unit in [1e-6, 1.0, 1_000_000.0] {
        let mut scene = scene(unit, Sky::default());
        let picture = draw(&mut renderer, &scene, size, true);
        write_beauty(&path("a.exr"), &picture).unwrap();
        write_hdr(&path("a.hdr"), &picture).unwrap();
        let layers = renderer.render_layers(gpu(), &Film::new(size, 1).frame(&scene).unwrap(), &mut |_| ());
        write_layers(&path("layers.exr"), gpu(), &layers.unwrap(), false, 1).unwrap();
        for (name, near) in [("a.exr", 1e-3), ("a.hdr", 1e-2), ("layers.exr", 5e-3)] {
            let read: Vec<[f32; 3]> = match name {
                "a.hdr" => image::open(path(name)).unwrap().to_rgb32f().pixels().map(|p| p.0).collect(),
                _ => exr_colours(&path(name)),
            };
            for (found, expected) in read.iter().zip(&picture.pixels) {
                let largest = expected[..3].iter().fold(0f32, |most, light| most.max(*light));
                let off = (0..3).map(|c| (found[c] - expected[c]).abs()).fold(0.0, f32::max);
                assert!(off <= near * largest, "{name} {unit}: {found:?} {expected:?}");
            }
        }
        // The sun's own disc: in lux BC6H can't hold it.
        scene.sun.position = SunPosition::Angles { azimuth_deg: 0.0, elevation_deg: 20.0 };
        let mut studio = Studio::new(gpu(), 1, true);
        studio.renderer().settings.quality = Quality::DRAFT;
        let written = write_ktx2(&path("a.ktx2"), &cube_faces(&mut studio, &scene, 16, &mut |_| ()).unwrap());
        match unit {
            1.0 => written.unwrap(),
            _ => {
                let refused = written.unwrap_err().to_string();
                assert!(refused.contains("65504") && refused.contains("irradiance"), "{refused}");
            }
        }
    }
}

fn exr_colours(path: &std::path::Path) -> Vec<[f32; 3]> {
    use exr::prelude::*;
    let image = read_first_flat_layer_from_file(path).unwrap();
    let channel = |name: &str| {
        let list = &image.layer_data.channel_data.list;
        let found = list.iter().find(|channel| channel.name.eq(name)).unwrap();
        found.sample_data.values_as_f32().collect::<Vec<f32>>()
    };
    let [r, g, b] = ["R", "G", "B"].map(channel);
    r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
}
