//! What is the same all over a cloud, drawn: density that grows with height, a diluted rim, noise of its
//! own, lumps that join.
#![cfg(feature = "export")]

use crate::common;

use common::{
    constants::{constant, constants},
    hull::{optical_depth, smooth_rise},
    picture::{draw, renderer, scene},
    truth::{Measured, assert_agree, opacity, trace},
};
use glam::DVec3;
use nephos::{
    export::Picture,
    render::{Quality, Renderer, Transport},
    scene::{Camera, Cloud, Noise, Projection, Scene},
};

/// A smooth homogeneous ball of radius 100 m, 1000 m up, seen by parallel rays, unlit.
fn ball(body: &str) -> Scene {
    scene(&format!(
        r#"{{"clouds": [{{"edge": {{"boundary": 0}},
            "droplets": {{"phase": "isotropic", "concentration_per_cm3": 30}}, {body}
            "ellipsoids": [{{"center": [0, 1000, 0], "radii": [100, 100, 100]}}]}}],
        "sky": "none", "sun": {{"irradiance": [0, 0, 0]}}}}"#
    ))
}

/// The same seen along `direction` through `place`, so that the picture is as good as one ray.
fn along(scene: &Scene, place: DVec3, direction: DVec3) -> Scene {
    let camera = Camera {
        position: place - 500.0 * direction,
        target: place,
        roll_deg: 0.0,
        projection: Projection::Orthographic { height: 0.01 },
        ..Camera::default()
    };
    Scene { camera: Some(camera), ..scene.clone() }
}

/// Optical depth of the ray in the middle of a picture.
fn depth(renderer: &mut Renderer, scene: &Scene) -> f64 {
    let picture = draw(renderer, scene, [3, 3], false);
    -(1.0 - f64::from(picture.pixels[4][3])).ln()
}

fn still(quality: Quality) -> Quality {
    Quality { jitter: false, opaque: 0.0, ..quality }
}

#[test]
fn extinction_grows_as_the_two_thirds_power_of_height() {
    let up = DVec3::new(0.0, 1000.0, 0.0);
    // A step may be longer than its middle tells, by six tenths of what is as good as even: at worst a step is
    // off by 2/3 of half of that.
    let most_uneven = 0.5 * 0.6 * constant("density", "EVEN") * 2.0 / 3.0;
    for quality in [Quality::FINAL, Quality::PREVIEW, Quality::DRAFT] {
        let mut renderer = renderer(still(quality), Transport::EMITTER);
        for share in [0.0, 0.5, 1.0] {
            let ball = ball(&format!(r#""stratification": {share}, "#));
            let extinction = ball.clouds[0].droplets.extinction();
            let mut check = |place: DVec3, direction: DVec3, exact: f64| {
                let found = depth(&mut renderer, &along(&ball, place, direction));
                // Half floats of opacity are good to 0.0005 of what gets through, which is a fifth at least.
                let uneven = if direction.y == 0.0 { 0.0 } else { share * most_uneven * exact };
                let most = uneven + 0.003;
                eprintln!("{share} {place} {direction}: {:.4}", found / exact - 1.0);
                assert!((found - exact).abs() < most, "{share} {place} {direction}: {found} for {exact}");
            };
            // Level rays: as dense all along.
            for height in [0.1, 0.5, 0.9_f64] {
                let y = 200.0 * (height - 0.5);
                let chord = 2.0 * (1e4 - y * y).sqrt();
                let profile = 1.0 - share + share * height.powf(2.0 / 3.0);
                check(up + y * DVec3::Y, DVec3::X, extinction * profile * chord);
            }
            // Upright, the mean of h^(2/3) is 3/5.
            for direction in [DVec3::Y, DVec3::NEG_Y] {
                check(up, direction, extinction * 200.0 * (1.0 - share + 0.6 * share));
            }
        }
    }
}

#[test]
fn a_baked_ball_is_stratified_alike() {
    // Three in one place are one with a hard edge, and enough for a volume.
    let mut ball = ball(r#""stratification": 1, "#);
    let lump = ball.clouds[0].ellipsoids[0].clone();
    ball.clouds[0].ellipsoids = vec![lump; 3];
    let mut renderer = renderer(still(Quality::FINAL), Transport::EMITTER);
    renderer.settings.bake_from = 1;
    let extinction = ball.clouds[0].droplets.extinction();
    for height in [0.3, 0.5, 0.8_f64] {
        let y = 200.0 * (height - 0.5);
        let place = DVec3::new(0.0, 1000.0 + y, 0.0);
        let exact = extinction * height.powf(2.0 / 3.0) * 2.0 * (1e4 - y * y).sqrt();
        let found = depth(&mut renderer, &along(&ball, place, DVec3::X));
        // A hard edge is spread over a cell of 17 m at either end.
        assert!((found / exact - 1.0).abs() < 0.08, "{height}: {found} for {exact}");
    }
    assert_eq!(renderer.volumes_baked(), 1);
}

#[test]
fn a_diluted_rim_has_lost_its_share_of_droplets_and_the_core_none() {
    // Billows so wide that the noise is the same all over the ball: how far it displaces the edge, the ball
    // with an undiluted rim tells.
    let mut ball = ball("");
    ball.noise.scale = Some(1e5);
    ball.clouds[0].edge.boundary = 15.0;
    ball.clouds[0].edge.wispiness = 0.0;
    let mut renderer = renderer(still(Quality::FINAL), Transport::EMITTER);
    let middle = DVec3::new(0.0, 1000.0, 0.0);
    let whole = depth(&mut renderer, &along(&ball, middle, DVec3::X));
    let extinction = ball.clouds[0].droplets.extinction();
    let rise = 15.0 * f64::from(constants("density", "RISE")[0] as f32);
    // Of two edges, each of which is half of its rise deep.
    let moved = 100.0 - 0.5 * rise - 0.5 * whole / extinction;
    assert!((0.0..15.0 - rise).contains(&moved), "{moved}");
    let noise = 1.0 - 2.0 * moved / (15.0 - rise);
    for dilution in [0.3, 1.0] {
        ball.clouds[0].dilution = dilution;
        let found = depth(&mut renderer, &along(&ball, middle, DVec3::X));
        let (from, to) = (middle - 100.0 * DVec3::X, middle + 100.0 * DVec3::X);
        let exact = optical_depth(&ball.clouds[0], noise, from, to, 4000);
        // The rim of 30 m behind the edge lacks half of the share on the whole.
        assert!((whole - exact) / extinction > 0.4 * dilution * 60.0, "{exact} of {whole}");
        assert!((found / exact - 1.0).abs() < 0.01, "{dilution}: {found} for {exact}");
    }
    // Smooth at both ends.
    assert_eq!((smooth_rise(0.0), smooth_rise(1.0)), (0.0, 1.0));
}

/// Two lumps that join, stratified and with a thin rim, and noise.
fn stratified(per_cm3: f64) -> Scene {
    let mut scene = common::truth::noisy("\"isotropic\"", per_cm3, DVec3::new(0.3, 0.2, 0.9));
    scene.sun.irradiance = [0.0; 3];
    let cloud = &mut scene.clouds[0];
    (cloud.blend, cloud.stratification, cloud.dilution) = (0.8, 0.9, 0.6);
    scene
}

#[test]
fn free_paths_in_a_stratified_cloud_end_where_the_march_has_its_opacity() {
    let scene = stratified(30.0);
    let found = opacity(&trace(&scene, [32, 32], 1200));
    let mut renderer = renderer(still(Quality::FINAL), Transport::EMITTER);
    let picture = draw(&mut renderer, &scene, [192, 192], false);
    let wanted = picture.pixels.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>() / (192.0 * 192.0);
    let error = (wanted * (1.0 - wanted) / (32.0 * 32.0 * 1200.0)).sqrt();
    // Steps of the march of the final quality, and pixels that leave out the finest noise.
    let wanted = Measured { value: wanted, error: 1.5e-3 * wanted };
    assert_agree(&[("opacity".to_owned(), Measured { value: found, error }, wanted)]);
}

/// A cloud of its own noise in a row, 800 m from the next.
fn member(place: f64, noise: Noise, blend: f64, stratification: f64) -> Cloud {
    let mut cloud = stratified(40.0).clouds.remove(0);
    cloud.ellipsoids.iter_mut().for_each(|e| e.center += DVec3::new(place, 0.0, 0.0));
    Cloud { noise: Some(noise), blend, stratification, ..cloud }
}

/// Two clouds that have nothing in common, and are too far apart to light each other; the sun behind the eye.
fn pair() -> Scene {
    let other = Noise { seed: 9, scale: Some(35.0), dimension: 2.7, detail: 1.0, ..Noise::default() };
    let mut scene = stratified(40.0);
    scene.clouds = vec![
        member(-400.0, Noise { seed: 3, ..Noise::default() }, 0.1, 0.0),
        member(400.0, Noise { offset: DVec3::new(7.0, 0.0, 0.0), ..other }, 0.9, 1.0),
    ];
    scene.sun.position = nephos::scene::SunPosition::Direction(DVec3::new(0.0, 0.3, 1.0));
    scene.sun.irradiance = [1.0; 3];
    scene.camera = Some(Camera {
        position: DVec3::new(0.0, 1010.0, 2000.0),
        target: DVec3::new(0.0, 1010.0, 0.0),
        roll_deg: 0.0,
        projection: Projection::Orthographic { height: 220.0 },
        ..Camera::default()
    });
    scene
}

#[test]
fn noise_that_is_renewed_changes_steadily_and_keeps_its_share_of_the_picture() {
    let mut scene = alone(&pair(), 0);
    scene.clouds[0].noise.as_mut().unwrap().rate = 60.0;
    scene.clouds[0].ellipsoids.iter_mut().for_each(|e| e.center.x += 400.0);
    // Steps of 1/16 of a renewal, over ends of both phases and the beginning.
    let mut renderer = renderer(still(Quality::PREVIEW), Transport::EMITTER);
    let mut drawn = |i: u32| draw(&mut renderer, &scene.at(f64::from(i) / 16.0).unwrap(), [60, 40], false);
    let frames: Vec<Picture> = (0..=20).map(&mut drawn).collect();
    let between = |a: &Picture, b: &Picture| {
        let squares = a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from(a[3] - b[3]).powi(2));
        (squares.sum::<f64>() / a.pixels.len() as f64).sqrt()
    };
    let steps: Vec<f64> = frames.windows(2).map(|pair| between(&pair[0], &pair[1])).collect();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    assert!(mean > 1e-3, "it moves: {mean}");
    assert!(steps.iter().all(|step| *step < 1.6 * mean && *step > 0.5 * mean), "{mean}: {steps:?}");
    let cover = |frame: &Picture| frame.pixels.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>();
    let covers: Vec<f64> = frames.iter().map(cover).collect();
    let usual = covers.iter().sum::<f64>() / covers.len() as f64;
    assert!(covers.iter().all(|cover| (cover / usual - 1.0).abs() < 0.1), "{usual}: {covers:?}");
}

#[test]
fn nothing_of_a_cloud_is_below_its_level_and_its_base_is_level() {
    let mut ball = alone(&pair(), 0);
    ball.clouds[0].ellipsoids.truncate(1);
    let e = &mut ball.clouds[0].ellipsoids[0];
    (e.center, e.radii) = (DVec3::new(0.0, 1010.0, 0.0), DVec3::splat(100.0));
    ball.clouds[0].edge = nephos::scene::Edge { boundary: 12.0, wispiness: 0.0 };
    ball.clouds[0].droplets.concentration_per_cm3 = 300.0;
    ball.clouds[0].level = Some(1010.0);
    for from in [1, u32::MAX] {
        let mut renderer = renderer(still(Quality::PREVIEW), Transport::EMITTER);
        renderer.settings.bake_from = from;
        // Pixels are 1.1 m.
        let picture = draw(&mut renderer, &ball, [20, 200], false);
        let alpha = |row: usize| picture.pixels[row * 20 + 10][3];
        assert!((101..200).all(|row| alpha(row) == 0.0), "{from}");
        // Noise moves it by a quarter of what it moves flanks by.
        let thin: Vec<_> = (25..95).map(|row| (row, alpha(row))).filter(|(_, alpha)| *alpha < 0.9).collect();
        assert!(thin.is_empty(), "{from}: {thin:?}");
    }
}

/// The scene with one of its clouds alone.
fn alone(scene: &Scene, number: usize) -> Scene {
    Scene { clouds: vec![scene.clouds[number].clone()], ..scene.clone() }
}

const ROW: [u32; 2] = [100, 20];

#[test]
fn clouds_with_noises_of_their_own_look_in_one_scene_like_each_alone() {
    let pair = pair();
    let mut renderer = renderer(still(Quality::DRAFT), Transport::MOMENTS);
    let mut drawn = |scene: &Scene| draw(&mut renderer, scene, ROW, false);
    let (both, first, second) = (drawn(&pair), drawn(&alone(&pair, 0)), drawn(&alone(&pair, 1)));
    let covered = |picture: &Picture| picture.pixels.iter().filter(|pixel| pixel[3] > 0.1).count();
    assert!(covered(&first) > 60 && covered(&second) > 60);
    for (i, pixel) in both.pixels.iter().enumerate() {
        for c in 0..4 {
            let apart = first.pixels[i][c] + second.pixels[i][c];
            // Half floats; each cloud's light is made as if it were alone.
            assert!((pixel[c] - apart).abs() < 2e-3, "{i}: {pixel:?} for {apart}");
        }
    }
    // Were they read with one another's, it would show.
    let mut swapped = pair.clone();
    let (a, b) = swapped.clouds.split_at_mut(1);
    std::mem::swap(&mut a[0].noise, &mut b[0].noise);
    let swapped = drawn(&swapped);
    let worst = both.pixels.iter().flatten().zip(swapped.pixels.iter().flatten());
    assert!(worst.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) > 0.05);
}

#[test]
fn paths_through_clouds_with_noises_of_their_own_are_those_through_each_alone() {
    let pair = pair();
    let traced = |scene: &Scene| trace(scene, ROW, 300);
    let both = traced(&pair);
    // Half the picture each; sums of opacity and light.
    let of = |estimate: &nephos::reference::Estimate, half: usize, channel: usize| {
        let inside = |i: &usize| (i % 100 >= 50) == (half == 1);
        let pixels: Vec<usize> = (0..estimate.mean.len()).filter(inside).collect();
        let n = pixels.len() as f64;
        let value = pixels.iter().map(|&i| f64::from(estimate.mean[i][channel])).sum::<f64>() / n;
        let variance = |i: usize| match channel {
            3 => value * (1.0 - value) / 300.0,
            _ => f64::from(estimate.error[i][channel]).powi(2),
        };
        let error = pixels.iter().map(|&i| variance(i)).sum::<f64>().sqrt() / n;
        Measured { value, error }
    };
    let mut results = Vec::new();
    for half in [0, 1] {
        let single = traced(&alone(&pair, half));
        for (channel, name) in [(3, "opacity"), (1, "light")] {
            results.push((
                format!("cloud {half}: {name}"),
                of(&both, half, channel),
                of(&single, half, channel),
            ));
        }
    }
    assert_agree(&results);
}

/// A camera that goes with the wind, which has carried the clouds by `drift`, m.
fn carried(camera: &Camera, drift: DVec3) -> Camera {
    Camera { position: camera.position + drift, target: camera.target + drift, ..camera.clone() }
}

#[test]
fn wind_makes_no_light_for_clouds_with_noise_of_their_own() {
    // One lump alone, in the middle of its frame but for rounding, and two that shade what is below.
    let mut windy = pair();
    windy.clouds[0].ellipsoids.truncate(1);
    windy.clouds[1].ellipsoids.iter_mut().for_each(|e| e.center += DVec3::new(-800.0, 200.0, 0.0));
    windy.sun.position = nephos::scene::SunPosition::Direction(DVec3::new(0.1, 0.9, 0.4));
    windy.wind.velocity = DVec3::new(3.7, 0.1, -1.3);
    let middle = DVec3::new(-400.0, 1100.0, 0.0);
    let camera = Camera {
        position: middle + 2000.0 * DVec3::Z,
        target: middle,
        roll_deg: 0.0,
        projection: Projection::Orthographic { height: 450.0 },
        ..Camera::default()
    };
    let mut renderer = renderer(still(Quality::DRAFT), Transport::MOMENTS);
    renderer.settings.bake_from = 2;
    let mut pictures = Vec::new();
    let mut updates = Vec::new();
    for time in [0.0, 1.0 / 24.0, 0.4, 7.7, 1234.567] {
        windy.time = time;
        windy.camera = Some(carried(&camera, windy.drift()));
        pictures.push(draw(&mut renderer, &windy, [32, 32], false));
        updates.push((renderer.light_updates(), renderer.volumes_baked()));
    }
    assert!(updates[0].0 > 0 && updates[0].1 == 1, "{updates:?}");
    assert!(updates.iter().all(|made| *made == updates[0]), "{updates:?}");
    let difference = |a: &Picture, b: &Picture| {
        let pairs = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    for picture in &pictures[1..] {
        // Rays start some mm beside where they did: half floats.
        let found = difference(picture, &pictures[0]);
        assert!(found < 5e-3, "{found}");
    }
    // The scene's noise stands still while the cloud drifts through it.
    windy.clouds.iter_mut().for_each(|cloud| cloud.noise = None);
    let seen = [0.0, 40.0].map(|time| {
        windy.time = time;
        windy.camera = Some(carried(&camera, windy.drift()));
        draw(&mut renderer, &windy, [32, 32], false)
    });
    assert!(difference(&seen[0], &seen[1]) > 0.02);
}

#[test]
fn the_shadow_of_a_stratified_heap_is_that_of_its_density() {
    // A veil far below two lumps that join, with the sun above.
    let veil = r#"{"edge": {"boundary": 0}, "droplets": {"phase": "isotropic", "concentration_per_cm3": 0.5},
        "ellipsoids": [{"center": [0, 1000, 0], "radii": [40, 4, 40]}]}"#;
    let heap = r#", {"edge": {"boundary": 0}, "blend": 0.8, "stratification": 1,
        "droplets": {"phase": "isotropic", "concentration_per_cm3": 25}, "ellipsoids": [
            {"center": [-10, 1500, 0], "radii": [120, 90, 100]},
            {"center": [15, 1570, 0], "radii": [90, 70, 90], "density": 0.4}]}"#;
    let light = |clouds: &str| {
        let scene = scene(&format!(
            r#"{{"sky": "none", "clouds": [{clouds}],
                "sun": {{"position": {{"direction": [0, 1, 0]}}, "angular_diameter_deg": 0}},
                "camera": {{"position": [0, 1000, 200], "target": [0, 1000, 0],
                    "projection": {{"orthographic": {{"height": 1}}}}}}}}"#
        ));
        let mut renderer = renderer(still(Quality::FINAL), Transport::SINGLE);
        (f64::from(draw(&mut renderer, &scene, [3, 3], false).pixels[4][1]), scene)
    };
    let ((bright, _), (dimmed, scene)) = (light(veil), light(&[veil, heap].concat()));
    let ray = [1300.0, 1700.0].map(|y| DVec3::new(0.0, y, 0.0));
    let exact = optical_depth(&scene.clouds[1], 0.0, ray[0], ray[1], 4000);
    let found = -(dimmed / bright).ln();
    // Twelve samples through each lump soften its edges.
    assert!((found / exact - 1.0).abs() < 0.1, "{found} for {exact}");
}
