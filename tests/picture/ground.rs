//! The ground before clouds, as a sky with an atmosphere has it.
#![cfg(feature = "export")]

use crate::common;

use common::{
    gpu,
    picture::{draw, renderer},
};
use glam::DVec3;
use nephos::{
    export::Picture,
    reference::PathTracer,
    render::{Film, Frame, Quality, Transport},
    scene::{Camera, Cloud, Ellipsoid, Projection, Scene, Sky},
};

/// Clouds below the ground and behind it, by eyes at several heights, with parallel lines of sight too. The
/// truth, all layers and the picture agree on what is hidden; what lies above is as it was.
#[test]
fn the_ground_hides_what_is_below_and_behind_it() {
    let ball = |center: [f64; 3], radius: f64| Cloud {
        ellipsoids: vec![Ellipsoid::new(center.into(), DVec3::splat(radius))],
        ..Cloud::default()
    };
    let view = |position: [f64; 3], target: [f64; 3], projection: Projection| Camera {
        position: position.into(),
        target: target.into(),
        roll_deg: 0.0,
        projection,
        ..Camera::default()
    };
    let parallel = Projection::Orthographic { height: 1000.0 };
    let lens = Projection::default();
    let narrow = Projection::Perspective { vertical_fov_deg: 0.25 };
    let size = [24, 24];
    // What is hidden has nothing to do with light.
    let mut renderer = renderer(Quality { jitter: false, ..Quality::DRAFT }, Transport::EMITTER);
    for (name, center, radius, camera, seen) in [
        ("below", [0.0, 500.0, 0.0], 200.0, view([0.0, 1500.0, 900.0], [0.0, 500.0, 0.0], lens), 0.0),
        ("from above", [0.0, 600.0, 0.0], 200.0, view([0.0, 2500.0, 0.1], [0.0, 600.0, 0.0], parallel), 0.0),
        ("half", [0.0, 1000.0, 0.0], 300.0, view([0.0, 1100.0, 2000.0], [0.0, 1000.0, 0.0], lens), 0.5),
        // 100 km away the ground has sunk by 786 m below the level that it has under the eye, 150 km away by 1769 m,
        // where the horizon hides another 107 m.
        ("far", [0.0, 600.0, -1e5], 200.0, view([0.0, 2000.0, 0.0], [0.0, 600.0, -1e5], narrow), 1.0),
        (
            "behind",
            [0.0, -900.0, -1.5e5],
            200.0,
            view([0.0, 2000.0, 0.0], [0.0, -900.0, -1.5e5], narrow),
            0.0,
        ),
        ("above", [0.0, 1500.0, 0.0], 200.0, view([0.0, 1400.0, 900.0], [0.0, 1500.0, 0.0], lens), 1.0),
    ] {
        let mut scene =
            Scene { clouds: vec![ball(center, radius)], camera: Some(camera), ..Scene::default() };
        scene.ground.altitude = 1000.0;
        let frame = Frame::new(&scene, size).unwrap();
        let alphas = |picture: &Picture| picture.pixels.iter().map(|p| f64::from(p[3])).collect::<Vec<_>>();
        let drawn = alphas(&draw(&mut renderer, &scene, size, false));
        let layers = renderer.render_layers(gpu(), &frame, &mut |_| ()).unwrap();
        for layer in [&layers.sun.single, &layers.distance, &layers.normal] {
            let own = alphas(&Film::new(size, 1).read(gpu(), layer).unwrap());
            let off = own.iter().zip(&drawn).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 2e-3, "{name}: {off}");
        }
        // Paths end where they meet the cloud.
        scene.clouds[0].droplets.albedo = 0.0;
        let black = Frame::new(&scene, size).unwrap();
        let mut tracer = PathTracer::new(gpu(), &black, 1).unwrap();
        tracer.trace(48, &mut |_| true).unwrap();
        let traced: Vec<f64> =
            tracer.estimate().unwrap().mean.iter().map(|pixel| f64::from(pixel[3])).collect();
        let sum = |alphas: &[f64]| alphas.iter().sum::<f64>();
        // Without a sky that has a ground, all of it is seen.
        scene.sky = Sky::None;
        let all = alphas(&draw(&mut renderer, &scene, size, false));
        assert!(sum(&all) > 20.0, "{name} is in the picture: {}", sum(&all));
        for (how, found) in [("drawn", &drawn), ("traced", &traced)] {
            let share = sum(found) / sum(&all);
            let allowed = if seen == 0.0 { 0.0 } else { 0.1 };
            assert!((share - seen).abs() <= allowed, "{name}, {how}: {share}");
        }
    }
}
