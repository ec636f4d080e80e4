//! Clouds of ellipsoids, layers and volumes in one scene: path traced together, in each other's shadow, and through one
//! another.
#![cfg(all(feature = "export", feature = "import"))]

use crate::common;

use common::truth::{EXTINCTION_PER_CM3, assert_agree, mean, opacity, trace};
use common::{
    gpu,
    picture::{draw, in_coarse_light, renderer, scene},
};
use nephos::{
    export::Picture,
    reference::{PathOptions, PathTracer},
    render::{Film, Frame, Quality, Renderer, Transport},
    scene::{Scene, Sky},
};

const SIZE: [u32; 2] = [16, 9];

/// Clouds before a uniform sky, seen along parallel lines.
fn seen(clouds: &str, position: [f64; 3], target: [f64; 3], height: f64, elevation: f64) -> Scene {
    scene(&format!(
        r#"{{"clouds": [{clouds}], "sky": {{"uniform": {{"radiance": [0.05, 0.06, 0.08]}}}},
            "camera": {{"position": {position:?}, "target": {target:?}, "projection": {{"orthographic": {{"height": {height}}}}}}},
            "sun": {{"irradiance": [1, 1, 1], "position": {{"angles": {{"azimuth_deg": 120, "elevation_deg": {elevation}}}}}}}}}"#
    ))
}

/// A layer of `thickness` m from `base` on, all covered, whose droplets scatter all ways alike.
fn sheet(base: f64, thickness: f64, per_cm3: f64) -> String {
    format!(
        r#"{{"layer": {{"base": {base}, "thickness": {thickness}, "coverage": 1, "heaps": 0, "bulge": 0}},
            "edge": {{"boundary": 0, "wispiness": 0}},
            "droplets": {{"phase": "isotropic", "concentration_per_cm3": {per_cm3}}}}}"#
    )
}

/// A ball whose droplets scatter all ways alike.
fn ball(center: [f64; 3], radius: f64, per_cm3: f64) -> String {
    format!(
        r#"{{"edge": {{"boundary": 0}}, "droplets": {{"phase": "isotropic", "concentration_per_cm3": {per_cm3}}},
            "ellipsoids": [{{"center": {center:?}, "radii": [{radius}, {radius}, {radius}]}}]}}"#
    )
}

const DECK: &str = r#"{"layer": {"base": 1000, "thickness": 300, "scale": 700, "coverage": 0.7},
    "edge": {"boundary": 60, "wispiness": 0.2}, "droplets": {"phase": "isotropic", "concentration_per_cm3": 20}}"#;

/// A ball far from all that is seen: it changes no picture, but what it is traced with.
fn far() -> String {
    ball([60e3, 1150.0, 60e3], 40.0, 20.0)
}

#[test]
fn a_layer_is_the_same_among_other_clouds() {
    let both: Vec<_> = [DECK.to_owned(), format!("{DECK}, {}", far())]
        .iter()
        .map(|clouds| {
            let scene = seen(clouds, [300.0, 3000.0, 500.0], [300.0, 1000.0, -300.0], 1500.0, 50.0);
            let estimate = trace(&scene, SIZE, 240);
            (mean(&estimate, 1), opacity(&estimate))
        })
        .collect();
    let [(light, covered), (light_among, covered_among)] = [both[0], both[1]];
    assert_agree(&[("light".to_owned(), light, light_among)]);
    assert!((covered - covered_among).abs() < 0.02, "{covered} and {covered_among}");
}

#[test]
fn what_is_behind_several_layers_is_dimmed_by_each() {
    // Level sheets of optical depths 0.4 and 0.9, and an even ball of 2 in the middle, seen straight down.
    let per_cm3 = |depth: f64, length: f64| {
        let cloud = scene(&format!(r#"{{"clouds": [{}]}}"#, ball([0.0; 3], 1.0, 1.0)));
        depth / length / cloud.clouds[0].droplets.extinction()
    };
    let layers = [sheet(1000.0, 100.0, per_cm3(0.4, 100.0)), sheet(3000.0, 200.0, per_cm3(0.9, 200.0))];
    let middle = ball([0.0, 2000.0, 0.0], 300.0, per_cm3(2.0, 600.0));
    let clouds = format!("{}, {}, {middle}", layers[0], layers[1]);
    let above = seen(&clouds, [0.0, 6000.0, 0.0], [0.0, 0.0, 0.1], 10.0, 50.0);
    let found = opacity(&trace(&above, [16, 9], 600));
    let wanted = 1.0 - (-3.3f64).exp();
    assert!((found - wanted).abs() < 0.01, "{found} for {wanted}");
}

/// A renderer of light that is judged: a third of the cells of a preview, which are as near to the truth.
fn solving() -> Renderer {
    renderer(Quality { light_resolution: 40, light_cells: 40, ..Quality::PREVIEW }, Transport::MOMENTS)
}

/// Mean light of green where truth is opaque by at least a half, drawn and true, and the relative RMSE there.
fn against_truth(renderer: &mut Renderer, scene: &Scene, samples: u32) -> (f64, f64, f64) {
    let truth = trace(scene, SIZE, samples);
    let film = Film::new(SIZE, 3);
    let frame = film.frame(scene).unwrap();
    let drawn: Picture = film.take(gpu(), renderer, &frame, false, &mut |_| ()).unwrap();
    let (mut sums, mut square, mut noise, mut light) = ([0.0; 2], 0.0, 0.0, 0.0);
    for ((pixel, mean), error) in drawn.pixels.iter().zip(&truth.mean).zip(&truth.error) {
        if mean[3] < 0.5 {
            continue;
        }
        let (found, wanted) = (f64::from(pixel[1]), f64::from(mean[1]));
        sums = [sums[0] + found, sums[1] + wanted];
        square += (found - wanted).powi(2);
        noise += f64::from(error[1]).powi(2);
        light += wanted * wanted;
    }
    (sums[0] / sums[1], ((square - noise).max(0.0) / light).sqrt(), sums[1])
}

/// The mean over the true one, and the relative RMSE, are within bounds.
fn assert_true(renderer: &mut Renderer, scene: &Scene, [off, most]: [f64; 2]) {
    let (mean, error, _) = against_truth(renderer, scene, 192);
    eprintln!("mean {mean:.3}, rmse {error:.3}");
    assert!((mean - 1.0).abs() < off && error < most, "mean {mean:.3}, rmse {error:.3}: {:?}", scene.clouds);
}

/// So it is for pictures of `clouds` with each of `others`.
fn assert_true_beside(at: impl Fn(&str) -> Scene, clouds: &str, others: &[String], bounds: [f64; 2]) {
    for other in others {
        assert_true(&mut solving(), &at(&format!("{clouds}, {other}")), bounds);
    }
}

#[test]
fn a_cloud_has_the_light_that_layers_scatter_to_it() {
    let cloud = ball([0.0, 1000.0, 0.0], 150.0, 40.0);
    let at = |clouds: &str| seen(clouds, [0.0, 1000.0, 900.0], [0.0, 1000.0, 0.0], 320.0, 50.0);
    // A thin sheet above, one of optical depth 5, a deck with holes, and a sheet below.
    let deck = DECK.replace("1000", "2000");
    let layers = [sheet(3000.0, 200.0, 5.0), sheet(2000.0, 300.0, 74.0), deck, sheet(200.0, 300.0, 74.0)];
    assert_true_beside(at, &cloud, &layers, [0.05, 0.1]);
}

#[test]
fn a_layer_has_the_light_that_one_above_scatters_to_it() {
    let at = |clouds: &str| seen(clouds, [0.0, 2500.0, 0.0], [0.0, 1000.0, -0.1], 500.0, 50.0);
    let below = sheet(1000.0, 300.0, 40.0);
    assert_true_beside(at, &below, &[sheet(3000.0, 200.0, 5.0)], [0.05, 0.05]);
    // What of the light from above is scattered once more is left out.
    assert_true_beside(at, &below, &[sheet(3000.0, 200.0, 50.0)], [0.09, 0.1]);
}

#[test]
fn a_ball_casts_its_shadow_on_the_deck_below() {
    let deck = sheet(1000.0, 300.0, 20.0);
    let cloud = ball([0.0, 1900.0, 0.0], 250.0, 40.0);
    // The shadow lies to the north-west of the ball's foot.
    let shadow = 1900.0 - 1300.0;
    let (x, z) = (-shadow * 120f64.to_radians().sin(), shadow * 120f64.to_radians().cos());
    let position = [x, 1700.0, z + 900.0];
    let at = |clouds: &str| seen(clouds, position, [x, 1300.0, z], 500.0, 45.0);
    let (mut sums, mut renderer) = (Vec::new(), solving());
    for clouds in [deck.clone(), format!("{deck}, {cloud}")] {
        let (mean, error, light) = against_truth(&mut renderer, &at(&clouds), 128);
        eprintln!("mean {mean:.3}, rmse {error:.3}, light {light:.3}");
        assert!((mean - 1.0).abs() < 0.12, "{mean}");
        sums.push(light);
    }
    assert!(sums[1] < 0.92 * sums[0], "{sums:?}");
}

#[test]
fn a_shadow_on_a_deck_is_soft_from_below() {
    let cloud = ball([0.0, 1900.0, 0.0], 250.0, 40.0);
    let (x, z) = (-600.0 * 120f64.to_radians().sin(), 600.0 * 120f64.to_radians().cos());
    let at = |clouds: &str| seen(clouds, [x, 200.0, z], [x, 1000.0, z - 0.1], 900.0, 45.0);
    // Thin and thick: optical depths 1.4 and 5.
    for per_cm3 in [20.0, 74.0] {
        let deck = sheet(1000.0, 300.0, per_cm3);
        assert_true_beside(at, &deck, std::slice::from_ref(&cloud), [0.05, 0.06]);
    }
}

#[test]
fn a_cloud_has_the_light_that_others_scatter_to_it() {
    let cloud = ball([0.0, 1000.0, 0.0], 150.0, 40.0);
    // The sun is behind the camera, to its right: to the left a cloud shines on the shaded side, to the right one takes
    // of the sky; one stands above, and one touches.
    let at = |clouds: &str| seen(clouds, [0.0, 1000.0, 900.0], [0.0, 1000.0, 0.0], 240.0, 20.0);
    let others =
        [[-500.0, 1000.0, -100.0], [500.0, 1000.0, -300.0], [-100.0, 1450.0, 0.0], [-440.0, 1000.0, 0.0]];
    let others = others.map(|center| ball(center, 280.0, 40.0));
    assert_true_beside(at, &cloud, &others, [0.05, 0.1]);
}

/// Mean of green and opacity of a picture of `scene`.
fn drawn(transport: Transport, scene: &Scene) -> [f64; 2] {
    let pixels = draw(&mut renderer(Quality::FINAL, transport), scene, [6, 6], false).pixels;
    [1, 3].map(|i| pixels.iter().map(|pixel| f64::from(pixel[i])).sum::<f64>() / pixels.len() as f64)
}

#[test]
fn clouds_that_pass_through_one_another_hide_each_other_place_by_place() {
    // Glowing balls on a line of sight, of optical depths 1 and 2, half of each in half of the other, the second half as
    // bright.
    let per_cm3 = |depth: f64| depth / 200.0 / EXTINCTION_PER_CM3;
    let one = ball([-50.0, 0.0, 0.0], 100.0, per_cm3(1.0));
    let other =
        ball([50.0, 0.0, 0.0], 100.0, per_cm3(2.0)).replace("isotropic\",", "isotropic\", \"albedo\": 0.5,");
    let at = |clouds: &str| seen(clouds, [-900.0, 0.0, 0.0], [0.0, 0.0, 0.0], 1.0, 50.0);
    let through = |depth: f64| (-depth).exp();
    // What is seen of each: alone, in the other, and behind it.
    let both = through(0.5) * (1.0 - through(1.5)) / 3.0;
    let first = 1.0 - through(0.5) + both;
    let second = 2.0 * both + through(2.0) * (1.0 - through(1.0));
    let [bright, opacity] = drawn(Transport::EMITTER, &at(&one));
    let wanted = bright / opacity * (first + 0.5 * second);
    for clouds in [format!("{one}, {other}"), format!("{other}, {one}")] {
        let [light, opacity] = drawn(Transport::EMITTER, &at(&clouds));
        assert!((light / wanted - 1.0).abs() < 0.01, "{light} for {wanted}");
        assert!((opacity - 1.0 + through(3.0)).abs() < 0.005, "{opacity}");
    }
}

#[test]
fn clouds_that_pass_through_one_another_are_as_in_truth() {
    // Two balls, one far in the other and lit from the side of either; and one through a deck, from above and from below.
    let (one, other) = (ball([-80.0, 0.0, 0.0], 150.0, 60.0), ball([80.0, 30.0, 40.0], 140.0, 60.0));
    let eyes = [[0.0, 100.0, 900.0], [900.0, 100.0, -200.0], [-900.0, 100.0, 200.0]];
    // Light that is the same for all cameras is made once.
    let mut renderer = solving();
    for eye in eyes {
        let scene = seen(&format!("{one}, {other}"), eye, [0.0, 15.0, 0.0], 300.0, 30.0);
        assert_true(&mut renderer, &scene, [0.05, 0.1]);
    }
    let clouds = format!("{}, {}", sheet(1000.0, 200.0, 20.0), ball([0.0, 1150.0, 0.0], 180.0, 40.0));
    let mut renderer = solving();
    for height in [2200.0, 100.0] {
        let scene = seen(&clouds, [0.0, height, 1000.0], [0.0, 1100.0, 0.0], 500.0, 40.0);
        assert_true(&mut renderer, &scene, [0.08, 0.12]);
    }
}

#[test]
fn a_white_furnace_stays_white_where_clouds_pass_through_one_another() {
    // Ragged heaps half in each other, thin and thick, before a sky as bright as the light that falls on them.
    let heap = |x: f64, per_cm3: f64| {
        format!(
            r#"{{"edge": {{"boundary": 60, "wispiness": 0.3}}, "droplets": {{"concentration_per_cm3": {per_cm3}}},
                "ellipsoids": [{{"center": [{x}, 0, 0], "radii": [150, 120, 130]}}, {{"center": [{}, 90, 40], "radii": [80, 70, 80]}}]}}"#,
            x + 40.0
        )
    };
    for per_cm3 in [4.0, 40.0, 400.0] {
        let clouds = format!("{}, {}", heap(-50.0, per_cm3), heap(50.0, 1.5 * per_cm3));
        let mut scene = seen(&clouds, [0.0, 60.0, 900.0], [0.0, 20.0, 0.0], 380.0, 40.0);
        scene.sky = Sky::Uniform { radiance: [1.0; 3] };
        scene.sun.irradiance = [0.0; 3];
        for quality in [Quality::DRAFT, Quality::FINAL] {
            let pixels =
                draw(&mut renderer(in_coarse_light(quality), Transport::MOMENTS), &scene, SIZE, true).pixels;
            let off = |pixel: &[f32; 4]| f64::from(pixel[1]) - 1.0;
            let worst = pixels.iter().map(|pixel| off(pixel).abs()).fold(0.0, f64::max);
            let bias = pixels.iter().map(off).sum::<f64>() / pixels.len() as f64;
            eprintln!("{per_cm3} a cm3: off by {worst:.4} at most, {bias:+.5} in the mean");
            assert!(worst < 0.06 && bias.abs() < 0.003, "{per_cm3}: {worst} {bias}");
        }
    }
}

#[test]
fn layers_of_light_add_up_where_clouds_pass_through_one_another() {
    let clouds =
        format!("{}, {}", ball([-60.0, 0.0, 0.0], 100.0, 20.0), ball([60.0, 20.0, 30.0], 100.0, 20.0));
    let scene = seen(&clouds, [0.0, 30.0, 900.0], [0.0, 0.0, 0.0], 260.0, 40.0);
    let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
    let film = Film::new(SIZE, 1);
    let frame = film.frame(&scene).unwrap();
    let whole = film.take(gpu(), &mut renderer, &frame, false, &mut |_| ()).unwrap();
    let layers = renderer.render_layers(gpu(), &frame, &mut |_| ()).unwrap();
    let parts = [&layers.sun.single, &layers.sun.multiple, &layers.sun.ambient, &layers.sun.air];
    let parts = parts.map(|part| film.read(gpu(), part).unwrap().pixels);
    for (i, pixel) in whole.pixels.iter().enumerate() {
        let sum: f32 = parts.iter().map(|part| part[i][1]).sum::<f32>() * frame.unit();
        assert!((sum - pixel[1]).abs() < 2e-3 * (pixel[1] + 0.01), "{sum} for {}", pixel[1]);
        assert!((parts[0][i][3] - pixel[3]).abs() < 1e-3, "{} for {}", parts[0][i][3], pixel[3]);
    }
}

#[test]
fn more_layers_than_there_is_room_for_are_refused() {
    let layers: Vec<_> = (0..5).map(|i| sheet(1000.0 + 500.0 * f64::from(i), 100.0, 5.0)).collect();
    let scene = seen(&layers.join(", "), [0.0, 9000.0, 0.0], [0.0, 0.0, 0.1], 100.0, 50.0);
    let frame = Frame::new(&scene, [8, 8]).unwrap();
    let refusal = PathTracer::with_options(gpu(), &frame, &PathOptions::default()).err().unwrap().to_string();
    assert!(refusal.contains("at most 4 layers") && refusal.contains('5'), "{refusal}");
}
