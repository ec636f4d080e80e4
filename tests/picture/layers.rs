//! Layers: what they cover, where they end, and their light against truth.
#![cfg(feature = "export")]

use crate::common;

use common::truth::trace;
use common::{
    gpu,
    picture::{draw, renderer, scene},
};
use glam::DVec3;
use nephos::{
    export::Picture,
    reference::{Estimate, PathOptions, PathTracer},
    render::{Film, Frame, Quality, Renderer, Transport},
    scene::{Camera, Preset, Projection, Scene},
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

fn measured(renderer: &mut Renderer, scene: &Scene, samples: u32) -> (f64, f64) {
    let film = Film::new(SIZE, RAYS);
    let frame = film.frame(scene).unwrap();
    let truth = trace(scene, SIZE, samples);
    let drawn = film.take(gpu(), renderer, &frame, false, &mut |_| ()).unwrap();
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
    // Light that is the same for two cameras is made once.
    let mut renderer = renderer(Quality::FINAL, Transport::MOMENTS);
    let mut wrong = Vec::new();
    for (name, layer, camera, sun, bound) in cases {
        // Paths through sheets are short.
        let samples = if layer == sheet { 96 } else { 48 };
        let (error, bias) = measured(&mut renderer, &deck(layer, WATER, &camera, sun), samples);
        eprintln!("{name}: {error:.3}, bias {bias:+.3}");
        wrong.extend((error > bound).then(|| format!("{name}: {error:.3}")));
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Share of a square `edge` metres wide whose opacity is above a half, by rays straight down from above: a texel of
/// the field each, so that nothing is a mean over some, in rows less than half of a heap apart.
fn covered(scene: &Scene, edge: f64) -> f64 {
    const ROW: u32 = 1024;
    const ROWS: u32 = 64;
    let mut renderer = renderer(Quality::DRAFT, Transport::EMITTER);
    let mut row = |i: u32| {
        let mut scene = scene.clone();
        let camera = scene.camera.as_mut().unwrap();
        let south = edge * ((f64::from(i) + 0.5) / f64::from(ROWS) - 0.5);
        (camera.position.z, camera.target.z) = (south, south - 1e-4);
        camera.projection = Projection::Orthographic { height: edge / f64::from(ROW) };
        opaque(&draw(&mut renderer, &scene, [ROW, 1], false))
    };
    (0..ROWS).map(&mut row).sum::<f64>() / f64::from(ROWS)
}

/// Share of pixels whose opacity is above a half.
fn opaque(picture: &Picture) -> f64 {
    picture.pixels.iter().filter(|pixel| pixel[3] > 0.5).count() as f64 / picture.pixels.len() as f64
}

/// An opaque layer from straight above, a period of it.
fn scene_above(layer: &str, period: f64) -> Scene {
    let above = format!(
        r#""position": [0, 9000, 0], "target": [0, 0, -0.0001], "projection": {{"orthographic": {{"height": {period}}}}}"#
    );
    let opaque = r#""droplets": {"concentration_per_cm3": 2000, "effective_radius_um": 9}"#;
    deck(layer, opaque, &above, HIGH)
}

/// A layer as a picture in a file paints it: white in the north-west, black in the south-east, a ramp between.
fn painted(folder: &std::path::Path, ending: &str) -> (Scene, f64) {
    const EDGE: u32 = 64;
    let value = |x: u32, y: u32| (2.0 - f64::from(x + y) / f64::from(EDGE)).clamp(0.2, 1.0) - 0.2;
    let file = folder.join(format!("cover.{ending}"));
    let pixel = |x: u32, y: u32| value(x, y) as f32;
    if ending == "png" {
        image::GrayImage::from_fn(EDGE, EDGE, |x, y| image::Luma([(255.0 * pixel(x, y)).round() as u8]))
            .save(&file)
            .unwrap();
    } else {
        exr::prelude::write_rgb_file(&file, EDGE as usize, EDGE as usize, |x, y| {
            let grey = pixel(x as u32, y as u32);
            (grey, grey, grey)
        })
        .unwrap();
    }
    let mean = (0..EDGE * EDGE).map(|i| value(i % EDGE, i / EDGE)).sum::<f64>() / f64::from(EDGE * EDGE);
    let layer = format!(
        r#""scale": 700, "coverage": 1, "offset": [300, -200], "map": {{"file": "cover.{ending}", "size": 20000}}"#
    );
    let path = folder.join("scene.json");
    std::fs::write(&path, scene_above(&layer, 20000.0).to_json()).unwrap();
    (Scene::load(&path).unwrap(), mean)
}

#[test]
fn a_painted_layer_covers_the_mean_of_its_map_where_it_is_painted() {
    let folder = tempfile::tempdir().unwrap();
    for ending in ["png", "exr"] {
        let (mut scene, mean) = painted(folder.path(), ending);
        if ending == "png" {
            let share = covered(&scene, 20000.0);
            eprintln!("{share:.4} of {mean:.4}");
            assert!((share - mean).abs() < 0.01, "{share} of {mean}");
        }
        // An eighth of it each: all covered in the north-west, clear in the south-east, and so for the path tracer.
        for (corner, wanted) in [([-8500.0, -8500.0], 0.8), ([8500.0, 8500.0], 0.0)] {
            let [x, z] = [corner[0] + 300.0, corner[1] - 200.0];
            let camera = scene.camera.as_mut().unwrap();
            (camera.position, camera.target) = ([x, 9000.0, z].into(), [x, 0.0, z - 1e-4].into());
            camera.projection = Projection::Orthographic { height: 2500.0 };
            let mut renderer = renderer(Quality::DRAFT, Transport::EMITTER);
            let drawn = opaque(&draw(&mut renderer, &scene, [128; 2], false));
            if ending != "png" {
                // The path tracer reads the same map.
                assert!((drawn - wanted).abs() < 0.15, "{corner:?}: {drawn}");
                continue;
            }
            // Paths end where they meet it.
            scene.clouds[0].droplets.albedo = 0.0;
            let frame = Frame::new(&scene, [48, 48]).unwrap();
            let mut tracer = PathTracer::with_options(gpu(), &frame, &PathOptions::default()).unwrap();
            tracer.trace(24, &mut |_| true).unwrap();
            let truth = tracer.estimate().unwrap();
            let traced =
                truth.mean.iter().filter(|pixel| pixel[3] > 0.5).count() as f64 / truth.mean.len() as f64;
            eprintln!("{corner:?}: {drawn:.3}, traced {traced:.3}");
            assert!(
                (drawn - wanted).abs() < 0.15 && (traced - drawn).abs() < 0.03,
                "{corner:?}: {drawn}, {traced}"
            );
        }
    }
}

#[test]
fn a_map_that_cannot_be_used_is_refused_by_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("words.png"), "not a picture").unwrap();
    std::fs::write(folder.path().join("words.exr"), "not a picture").unwrap();
    let problem = |map: &str| {
        let path = folder.path().join("scene.json");
        std::fs::write(&path, format!(r#"{{"clouds": [{{"layer": {{"scale": 700, "map": {{{map}}}}}}}]}}"#))
            .unwrap();
        Scene::load(&path).unwrap_err().to_string()
    };
    for (map, words) in [
        (r#""file": "none.png", "size": 20000"#, "none.png"),
        (r#""file": "words.png", "size": 20000"#, "no PNG picture"),
        (r#""file": "words.exr", "size": 20000"#, "no EXR picture"),
        (r#""file": "", "size": 20000"#, "name the picture"),
        (r#""file": "none.png", "size": 200000"#, "67200"),
        (r#""file": "none.png", "size": 10"#, "100 to 1000000"),
    ] {
        let told = problem(map);
        assert!(told.contains(words) && told.contains("map"), "{told}");
    }
    let unread =
        Scene::from_json(r#"{"clouds": [{"layer": {"map": {"file": "none.png", "size": 9000}}}]}"#).unwrap();
    let told = Frame::new(&unread, [8, 8]).err().unwrap().to_string();
    assert!(told.contains("none.png") && told.contains("was not read"), "{told}");
}

#[test]
fn covered_share_of_the_plan_is_the_coverage() {
    for (heaps, coverage) in [(0.0, 0.8), (1.0, 0.15)] {
        let layer = format!(r#""scale": 700, "heaps": {heaps}, "coverage": {coverage}"#);
        let period = 12.0 * 700.0;
        let share = covered(&scene_above(&layer, period), period);
        eprintln!("heaps {heaps}: {share:.4} of {coverage}");
        assert!((share - coverage).abs() < 0.01, "heaps {heaps}: {share} of {coverage}");
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
    let mut renderer = renderer(Quality::PREVIEW, Transport::EMITTER);
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
    let mut renderer = renderer(Quality::PREVIEW, Transport::EMITTER);
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

#[test]
fn no_bright_line_parts_a_closed_deck_from_the_ground() {
    let mut scene = Preset::Stratus.scene(1);
    let eye = DVec3::new(0.0, scene.ground.altitude + 2.0, 0.0);
    scene.camera = Some(Camera {
        position: eye,
        target: eye - 1000.0 * DVec3::Z,
        projection: Projection::Perspective { vertical_fov_deg: 5.0 },
        ..Camera::default()
    });
    // Rows of a twentieth of a degree, the horizon between the middle ones.
    let picture = draw(&mut renderer(Quality::DRAFT, Transport::MOMENTS), &scene, [8, 100], true);
    let rows: Vec<f32> =
        picture.pixels.chunks(8).map(|row| row.iter().map(|p| p[1]).sum::<f32>() / 8.0).collect();
    let brightest = |rows: &[f32]| rows.iter().copied().fold(0.0, f32::max);
    let (line, sky) = (brightest(&rows[42..58]), brightest(&rows[10..35]));
    eprintln!("at the horizon {line:.4}, above it {sky:.4}");
    assert!(line < 1.1 * sky, "{rows:?}");
}
