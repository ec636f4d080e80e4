//! Shadows of clouds on the ground and in the air: against pictures taken from the sun, and against the atmosphere
//! in f64 with a beam cut out of it.
#![cfg(feature = "export")]

use crate::common;

use common::{
    atmosphere::{Air, GROUND, Ray, Rgb, haze_phase, rayleigh_phase},
    gpu,
    picture::{draw, renderer, scene},
};
use glam::DVec3;
use nephos::{
    export::{Picture, Studio},
    render::{Quality, Renderer, Transport},
    scene::{Camera, Preset, Projection, Scene, Sky, SunPosition},
};

const SIZE: [u32; 2] = [64, 36];

/// The sun's light at points below a scene's clouds, by the map that the last picture left.
fn light_at(renderer: &Renderer, camera: DVec3, points: &[DVec3], soft: bool) -> Vec<f32> {
    let light = if soft {
        "vec4f(sun_map_ground(map, lit, linear, x[0].xyz), 0.0)"
    } else {
        "vec4f(sun_map_light(map, lit, linear, x[0].xyz))"
    };
    read_at(renderer, camera, points, light).into_iter().map(|value| value[0]).collect()
}

/// What this expression over `map`, `lit`, `linear` and x[0] has at points.
fn read_at(renderer: &Renderer, camera: DVec3, points: &[DVec3], expression: &str) -> Vec<[f32; 4]> {
    let map = renderer.sun_map().expect("clouds cast shadows");
    let inputs: Vec<_> = points.iter().map(|p| [(*p - camera).as_vec3().extend(0.0).to_array()]).collect();
    let linear = nephos::gpu::linear_clamp(&gpu().device);
    let resources = [
        map.uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(map.lit),
        wgpu::BindingResource::Sampler(&linear),
    ];
    let declarations = "
        @group(0) @binding(2) var<storage, read> map: SunMap;
        @group(0) @binding(3) var lit: texture_2d_array<f32>;
        @group(0) @binding(4) var linear: sampler;";
    common::evaluate_bound("sun_map", declarations, &format!("return {expression};"), &inputs, &resources)
}

/// Middles of the pixels of `Studio::sunlight_on`.
fn ground(center: DVec3, extent: f64, size: u32) -> Vec<DVec3> {
    let at = |i: u32| extent * ((f64::from(i) + 0.5) / f64::from(size) - 0.5);
    (0..size * size).map(|i| center + DVec3::new(at(i % size), 0.0, at(i / size))).collect()
}

/// Means over squares of `edge` values, of which there are `width` in a row.
fn means(values: &[f32], width: u32, edge: u32) -> Vec<f32> {
    let (width, edge) = (width as usize, edge as usize);
    let across = width / edge;
    let mut sums = vec![0.0; across * across];
    for (i, value) in values.iter().enumerate() {
        sums[i / width / edge * across + i % width / edge] += value / (edge * edge) as f32;
    }
    sums
}

fn sunlit(mut scene: Scene, elevation_deg: f64) -> Scene {
    scene.sun.position = SunPosition::Angles { azimuth_deg: 120.0, elevation_deg };
    scene.sun.angular_diameter_deg = 0.0;
    scene
}

#[test]
fn light_on_the_ground_is_that_of_pictures_from_the_sun() {
    const POINTS: u32 = 48;
    for (preset, elevation) in [(Preset::Kol, 60.0), (Preset::Kol, 20.0), (Preset::Sphere, 35.0)] {
        let scene = sunlit(preset.scene(2), elevation);
        let mut studio = Studio::new(gpu(), 4, false);
        let (center, extent) = studio.shadows_of(&scene, scene.ground.altitude).unwrap();
        let wanted = studio.sunlight_on(&scene, center, extent, POINTS).unwrap();
        let mut renderer = renderer(Quality::FINAL, Transport::SINGLE);
        draw(&mut renderer, &scene, SIZE, true);
        let camera = scene.camera().position;
        for soft in [false, true] {
            let finer = light_at(&renderer, camera, &ground(center, extent, 4 * POINTS), soft);
            let got = means(&finer, 4 * POINTS, 4);
            let n = f64::from(POINTS * POINTS);
            let mean = |values: &[f32]| values.iter().copied().map(f64::from).sum::<f64>() / n;
            let squares = got.iter().zip(&wanted).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
            let (rms, off) = ((squares / n).sqrt(), mean(&got) - mean(&wanted));
            println!("{preset:?} {elevation} {soft}: rms {rms:.4}, mean {:.4} off {off:.4}", mean(&wanted));
            assert!(rms <= 0.02, "{preset:?} at {elevation} degrees: rms {rms}");
            assert!(off.abs() <= 0.004, "{preset:?} at {elevation} degrees: mean off by {off}");
        }
    }
}

/// A layer under a sun 40 degrees high, and what of its light reaches the ground in a square of 6 km: straight, and
/// scattered down.
fn below_layer(layer: &str) -> (Scene, DVec3, Vec<[f32; 4]>) {
    let scene = sunlit(
        scene(&format!(
            r#"{{"clouds": [{{"layer": {layer}, "edge": {{"boundary": 0}},
                "droplets": {{"concentration_per_cm3": 20, "effective_radius_um": 8}}}}]}}"#
        )),
        40.0,
    );
    let mut renderer = renderer(Quality::PREVIEW, Transport::SINGLE);
    draw(&mut renderer, &scene, SIZE, true);
    let center = DVec3::new(500.0, 0.0, -300.0);
    let points = ground(center, 6e3, 4 * POINTS_BELOW);
    let light = "vec4f(sun_map_ground(map, lit, linear, x[0].xyz), 0.0)";
    let light = read_at(&renderer, scene.camera().position, &points, light);
    (scene, center, light)
}

const POINTS_BELOW: u32 = 24;

#[test]
fn a_deck_lets_through_to_the_ground_what_its_opacity_leaves() {
    let (scene, center, light) =
        below_layer(r#"{"base": 800, "thickness": 200, "coverage": 0.5, "scale": 700, "heaps": 1}"#);
    let wanted = Studio::new(gpu(), 2, false).sunlight_on(&scene, center, 6e3, 2 * POINTS_BELOW).unwrap();
    let mean = |values: &mut dyn Iterator<Item = f32>| {
        let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + f64::from(value), count + 1));
        sum / f64::from(count)
    };
    let (got, wanted) = (mean(&mut light.iter().map(|v| v[0])), mean(&mut wanted.iter().copied()));
    println!("{got:.4} for {wanted:.4}");
    assert!((0.3..0.9).contains(&wanted), "{wanted}");
    assert!((got - wanted).abs() < 0.02, "{got} for {wanted}");
}

#[test]
fn below_an_even_sheet_the_ground_has_the_light_of_two_streams() {
    let (scene, _, light) =
        below_layer(r#"{"base": 800, "thickness": 100, "coverage": 1, "heaps": 0, "bulge": 0}"#);
    let mu = scene.sun.to_sun().y;
    for value in &light {
        let [straight, scattered, ..] = value.map(f64::from);
        // Optical depth along the beam, and the share that turns: droplets of 8 um without the peak.
        let (depth, turning) = (-straight.ln(), 1.0 - 0.74);
        let whole = (2.0 / 3.0 + mu + (2.0 / 3.0 - mu) * straight) / (4.0 / 3.0 + turning * mu * depth);
        assert!((0.02..0.9).contains(&straight), "{straight}");
        assert!((straight + scattered - whole).abs() < 0.03, "{straight} and {scattered} for {whole}");
    }
}

/// An opaque ball of radius 300 m, 1500 m up and 2 km to the north, under a hazy sky and a sun in the west.
fn ball() -> Scene {
    let mut scene = scene(
        r#"{"sky": {"atmosphere": {"haze": 5.0}}, "ground": {"albedo": [0.3, 0.3, 0.3]}, "clouds": [{"edge": {"boundary": 0},
            "droplets": {"concentration_per_cm3": 1000, "phase": "isotropic"},
            "ellipsoids": [{"center": [0, 1500, -2000], "radii": [300, 300, 300]}]}]}"#,
    );
    scene.sun.position = SunPosition::Angles { azimuth_deg: 270.0, elevation_deg: 40.0 };
    scene.sun.angular_diameter_deg = 0.0;
    scene
}

fn seen_from(scene: &mut Scene, position: DVec3, target: DVec3) {
    let projection = Projection::Perspective { vertical_fov_deg: 40.0 };
    scene.camera = Some(Camera { position, target, roll_deg: 0.0, projection, ..Camera::default() });
}

/// What shadows take from each pixel.
fn taken(scene: &Scene) -> Picture {
    let mut renderer = renderer(Quality::FINAL, Transport::SINGLE);
    let with = draw(&mut renderer, scene, SIZE, true);
    renderer.settings.shadows = false;
    let mut without = draw(&mut renderer, scene, SIZE, true);
    for (a, b) in without.pixels.iter_mut().zip(&with.pixels) {
        (0..3).for_each(|c| a[c] -= b[c]);
    }
    without
}

fn direction(frame_size: [u32; 2], scene: &Scene, i: usize) -> DVec3 {
    let camera = scene.camera();
    let frame = camera.world_from_camera();
    let half = 20f64.to_radians().tan();
    let [w, h] = frame_size.map(f64::from);
    let (x, y) = ((i as u32 % frame_size[0]) as f64 + 0.5, (i as u32 / frame_size[0]) as f64 + 0.5);
    (frame * DVec3::new((2.0 * x / w - 1.0) * half * w / h, (1.0 - 2.0 * y / h) * half, -1.0)).normalize()
}

/// Whether the ball stands between the sun and a point.
fn is_shaded(scene: &Scene, p: DVec3) -> bool {
    let to_sun = scene.sun.to_sun();
    let to_ball = DVec3::new(0.0, 1500.0, -2000.0) - p;
    let along = to_ball.dot(to_sun);
    along > 0.0 && (to_ball - along * to_sun).length() < 300.0
}

/// What the shadow takes of a ray, from the definition.
fn reference(scene: &Scene, direction: DVec3) -> Rgb {
    let air = Air { haze: 5.0, albedo: [0.3; 3], sun_radius: 1e-6, ..Air::EARTH };
    let (camera, to_sun) = (scene.camera().position, scene.sun.to_sun());
    let ray = Ray { r: GROUND + camera.y, mu: direction.y, mu_sun: to_sun.y, nu: direction.dot(to_sun) };
    let (length, ends) = ray.length();
    let (single, haze) = (rayleigh_phase(ray.nu), haze_phase(0.7, ray.nu));
    let steps = 4000;
    let near = length.min(12e3);
    let step = near / f64::from(steps);
    let mut sum = [0.0; 3];
    let mut depth = [0.0; 3];
    for i in 0..steps {
        let t = step * (f64::from(i) + 0.5);
        let here = ray.at(t);
        let (rayleigh, mie, extinction) = air.medium(here.r - GROUND);
        if is_shaded(scene, camera + t * direction) {
            let sun = air.sun(here.r, here.mu_sun);
            for c in 0..3 {
                sum[c] += step * sun[c] * (rayleigh[c] * single + mie * haze) * f64::exp(-depth[c]);
            }
        }
        (0..3).for_each(|c| depth[c] += step * extinction[c]);
    }
    if ends && is_shaded(scene, camera + length * direction) {
        let foot = ray.at(length);
        let sun = air.sun(GROUND + 1e-3, foot.mu_sun);
        (0..3)
            .for_each(|c| sum[c] += 0.3 / std::f64::consts::PI * foot.mu_sun * sun[c] * f64::exp(-depth[c]));
    }
    sum
}

/// Pixels that a ray to the ball's rim does not come near.
fn is_clear_of_the_ball(scene: &Scene, direction: DVec3) -> bool {
    let to_ball = DVec3::new(0.0, 1500.0, -2000.0) - scene.camera().position;
    let along = to_ball.dot(direction);
    along < 0.0 || (to_ball - along * direction).length() > 360.0
}

#[test]
fn the_air_lacks_the_light_of_a_beam_and_the_ground_that_of_a_shadow() {
    let views = [
        // From the ground, through the beam in the air.
        (DVec3::new(0.0, 2.0, 0.0), DVec3::new(900.0, 700.0, -2000.0)),
        // From above, at the shadow on the ground.
        (DVec3::new(1800.0, 2500.0, 500.0), DVec3::new(1790.0, 0.0, -2000.0)),
    ];
    for (position, target) in views {
        let mut scene = ball();
        seen_from(&mut scene, position, target);
        let got = taken(&scene);
        let (mut sum, mut wanted_sum, mut errors, mut shaded) = (0.0, 0.0, 0.0, 0);
        for (i, pixel) in got.pixels.iter().enumerate() {
            let direction = direction(SIZE, &scene, i);
            if !is_clear_of_the_ball(&scene, direction) {
                continue;
            }
            let wanted = reference(&scene, direction)[1];
            (sum, wanted_sum) = (sum + f64::from(pixel[1]), wanted_sum + wanted);
            errors += (f64::from(pixel[1]) - wanted).powi(2);
            shaded += usize::from(wanted > 0.0);
        }
        let rms = (errors / shaded as f64).sqrt() * shaded as f64 / wanted_sum;
        println!("{shaded} pixels: {sum:.4e} for {wanted_sum:.4e}, rms {rms:.3}");
        assert!(shaded > 100, "{shaded}");
        assert!((sum / wanted_sum - 1.0).abs() < 0.03, "{sum} for {wanted_sum}");
        assert!(rms < 0.25, "{rms}");
    }
}

#[test]
fn clouds_behind_the_camera_cast_their_shadow_into_the_picture() {
    let mut scene = ball();
    // The ball's shadow falls 1.8 km to the east of it; the camera looks down at that, and not at the ball.
    seen_from(&mut scene, DVec3::new(1000.0, 600.0, -2000.0), DVec3::new(1788.0, 0.0, -2000.0));
    let got = taken(&scene);
    let most = got.pixels.iter().map(|pixel| pixel[1]).fold(0.0, f32::max);
    assert!(most > 0.02, "{most}");
}

#[test]
fn shadows_cost_nothing_where_nothing_is_shaded() {
    let mut night = ball();
    night.sun.position = SunPosition::Angles { azimuth_deg: 0.0, elevation_deg: -1.0 };
    let mut bare = ball();
    bare.sky = Sky::None;
    let mut empty = ball();
    empty.clouds.clear();
    for scene in [night, bare, empty] {
        let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
        draw(&mut renderer, &scene, SIZE, true);
        assert!(renderer.sun_map().is_none());
    }
}

#[test]
fn the_map_outlives_a_turn_of_the_camera_and_changes_with_the_sun() {
    let mut scene = ball();
    seen_from(&mut scene, DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, 900.0, -2000.0));
    let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
    let mut made = |scene: &Scene| {
        let before = renderer.light_updates();
        draw(&mut renderer, scene, SIZE, true);
        renderer.light_updates() - before
    };
    made(&scene);
    assert_eq!(made(&scene), 0, "nothing changed");
    seen_from(&mut scene, DVec3::new(0.0, 2.0, 0.0), DVec3::new(300.0, 900.0, -2000.0));
    assert_eq!(made(&scene), 2, "the air before the camera and its shadow");
    scene.sun.position = SunPosition::Angles { azimuth_deg: 250.0, elevation_deg: 40.0 };
    assert!(made(&scene) > 2, "sun volume, map, air");
}

#[test]
fn a_cloud_that_leaves_the_picture_keeps_its_light_for_its_shadow_and_for_later() {
    let mut scene = ball();
    let position = DVec3::new(0.0, 2.0, 0.0);
    let mut renderer = renderer(Quality::DRAFT, Transport::MOMENTS);
    let mut made = |scene: &Scene| {
        let before = renderer.light_updates();
        draw(&mut renderer, scene, SIZE, true);
        renderer.light_updates() - before
    };
    let (ball, beside) = (DVec3::new(0.0, 1500.0, -2000.0), DVec3::new(1788.0, 300.0, -2000.0));
    seen_from(&mut scene, position, ball);
    assert!(made(&scene) > 5);
    for target in [beside, ball] {
        seen_from(&mut scene, position, target);
        assert_eq!(made(&scene), 2, "the air before the camera and its shadow");
    }
}

#[test]
fn a_game_reads_the_shadows_that_are_drawn() {
    let mut scene = ball();
    seen_from(&mut scene, DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, 900.0, -2000.0));
    let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
    draw(&mut renderer, &scene, SIZE, true);
    let camera = scene.camera().position;
    let to_sun = scene.sun.to_sun();
    let ball = DVec3::new(0.0, 1500.0, -2000.0);
    let points = [ball - 800.0 * to_sun, ball + 800.0 * to_sun, ball - 800.0 * to_sun + 500.0 * DVec3::Z];
    let light = light_at(&renderer, camera, &points, false);
    assert!(light[0] < 0.01 && light[1] > 0.99 && light[2] > 0.99, "behind, before, beside: {light:?}");
}
