//! Meshes that are boundaries, drawn: against ellipsoids of the same shape, and against truth.
#![cfg(feature = "export")]

use std::{f64::consts::TAU, sync::Arc};

use crate::common;

use common::{
    gpu,
    picture::{draw, in_coarse_light, renderer, scene},
    truth::{assert_agree, mean, opacity, trace, trace_with},
};
use glam::{DQuat, DVec3};
use nephos::{
    export::Picture,
    reference::PathOptions,
    render::{Frame, Quality, Transport, VoxelGrid, Voxels},
    scene::{Cloud, Ellipsoid, Mesh, Phase, Projection, Scene, Surface},
};

const SIZE: [u32; 2] = [48, 27];
const STILL: Quality = Quality { jitter: false, ..Quality::PREVIEW };
const CENTER: DVec3 = DVec3::new(0.0, 1000.0, 0.0);

/// A ball of radius 1 in rows and columns of quads.
fn ball() -> Arc<Surface> {
    let (rows, columns) = (96u32, 192u32);
    let corner = |n: u32| {
        let [a, b] = [n / columns, n % columns].map(f64::from);
        let (a, b) = (0.5 * TAU * a / f64::from(rows), TAU * b / f64::from(columns));
        DVec3::new(a.sin() * b.sin(), a.cos(), a.sin() * b.cos())
    };
    surface([rows, columns], (0..(rows + 1) * columns).map(corner).collect(), false)
}

/// A ring around Y, of tubes: its radius is 1, that of the tubes 0.4.
fn ring() -> Arc<Surface> {
    let (along, around) = (96u32, 48u32);
    let corner = |n: u32| {
        let [a, b] =
            [(n / around, along), (n % around, around)].map(|(i, n)| TAU * f64::from(i) / f64::from(n));
        let out = 1.0 + 0.4 * b.cos();
        DVec3::new(out * a.cos(), 0.4 * b.sin(), out * a.sin())
    };
    surface([along, around], (0..along * around).map(corner).collect(), true)
}

/// Quads between rows of corners; the last row goes on with the first where it is `closed`.
fn surface([rows, columns]: [u32; 2], positions: Vec<DVec3>, closed: bool) -> Arc<Surface> {
    let count = positions.len() as u32;
    assert!(closed || count == (rows + 1) * columns);
    let at = |row: u32, column: u32| (row * columns + column % columns) % count;
    let quads = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles: Vec<_> = quads
        .flat_map(|(row, column)| {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
            [[a, c, b], [a, d, c]]
        })
        .collect();
    Arc::new(Surface::new(&positions, &triangles).unwrap())
}

/// A cloud in the evening, seen from the south, without a shape.
fn evening(edge: &str) -> Scene {
    scene(&format!(
        r#"{{"sky": "none", "noise": {{"scale": 50}}, "clouds": [{{"edge": {edge},
                "droplets": {{"concentration_per_cm3": 60}}}}],
            "sun": {{"position": {{"angles": {{"azimuth_deg": 250, "elevation_deg": 20}}}}}},
            "camera": {{"position": [0, 1000, 900], "target": [0, 1000, 0],
                "projection": {{"perspective": {{"vertical_fov_deg": 20}}}}}}}}"#
    ))
}

/// Adds a mesh that is `scale` times as large.
fn with_mesh(mut scene: Scene, surface: &Arc<Surface>, scale: f64) -> Scene {
    let mesh = Mesh { scale, place: CENTER, ..Mesh::default() }.with_surface(surface.clone());
    scene.clouds[0].mesh = Some(mesh);
    scene
}

fn with_ball(mut scene: Scene) -> Scene {
    scene.clouds[0].ellipsoids = vec![Ellipsoid::new(CENTER, DVec3::splat(100.0))];
    scene
}

/// Sum of a channel.
fn total(picture: &Picture, channel: usize) -> f64 {
    picture.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum()
}

/// Root of the mean square of the difference of a channel, over the mean.
fn difference(a: &Picture, b: &Picture, channel: usize) -> f64 {
    let pairs = a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from(a[channel] - b[channel]).powi(2));
    let count = a.pixels.len() as f64;
    (pairs.sum::<f64>() / count).sqrt() / (total(a, channel) / count)
}

#[test]
fn the_mesh_of_a_ball_looks_like_the_ball() {
    let ball = ball();
    let [sharp, noisy] = [r#"{"boundary": 4, "wispiness": 0}"#, r#"{"boundary": 40, "wispiness": 0.3}"#];
    let fine = Quality { jitter: false, ..Quality::FINAL };
    let coarse = in_coarse_light(STILL);
    let mut renderer = renderer(fine, Transport::EMITTER);
    // Rays of both have their steps in other places, and so have the texels of light, for the boxes of both are others.
    for (edge, transport, quality, size, bounds) in [
        (sharp, Transport::EMITTER, fine, [64, 36], [0.005, 0.03]),
        (noisy, Transport::EMITTER, fine, [64, 36], [0.005, 0.05]),
        (noisy, Transport::MOMENTS, coarse, SIZE, [0.03, 0.2]),
    ] {
        (renderer.settings.transport, renderer.settings.quality) = (transport, quality);
        let mut scene = evening(edge);
        if edge == noisy {
            let cloud = &mut scene.clouds[0];
            (cloud.level, cloud.stratification, cloud.dilution) = (Some(960.0), 0.8, 0.5);
        }
        let clouds = [with_ball(scene.clone()), with_mesh(scene, &ball, 100.0)];
        let [exact, baked] = clouds.map(|scene| draw(&mut renderer, &scene, size, false));
        for channel in [1, 3] {
            let apart = total(&baked, channel) / total(&exact, channel) - 1.0;
            let found = difference(&exact, &baked, channel);
            eprintln!("{edge} {transport}: mean {apart:.4}, pixels {found:.4}");
            assert!(apart.abs() < bounds[0] && found < bounds[1], "{edge} {transport}: {apart} {found}");
        }
    }
}

#[test]
fn truth_of_a_mesh_is_that_of_the_ball_alone_and_among_others() {
    let ball = ball();
    // Thin, and lit from where it is seen: light that is scattered once or twice.
    let thin = |edge: &str| {
        let mut scene = evening(edge);
        let droplets = &mut scene.clouds[0].droplets;
        (droplets.concentration_per_cm3, droplets.phase) = (30.0, Phase::Isotropic);
        let camera = scene.camera.as_mut().unwrap();
        camera.projection = Projection::Orthographic { height: 200.0 };
        scene
    };
    let edge = r#"{"boundary": 40, "wispiness": 0.3}"#;
    let alone = with_mesh(thin(edge), &ball, 100.0);
    let mut among = alone.clone();
    let far = Ellipsoid::new(DVec3::new(60e3, 1000.0, 60e3), DVec3::splat(40.0));
    among.clouds.push(Cloud { ellipsoids: vec![far], ..Cloud::default() });
    let traced = |scene: &Scene, seed: u32| {
        let options = PathOptions { seed, ..PathOptions::default() };
        trace_with(scene, [16, 9], 384, &options)
    };
    let exact = traced(&with_ball(thin(edge)), 1);
    let found = [("alone", &alone, 2), ("among others", &among, 3)].map(|(name, scene, seed)| {
        let estimate = traced(scene, seed);
        let opaque = opacity(&estimate) / opacity(&exact) - 1.0;
        eprintln!("{name}: opacity {opaque:.4}");
        // 384 samples of 70 pixels, half of which are half covered: 0.6 % each way.
        assert!(opaque.abs() < 0.025, "{name}: {opaque}");
        (name.to_owned(), mean(&estimate, 1), mean(&exact, 1))
    });
    assert_agree(&found);
}

#[test]
fn the_hole_of_a_ring_is_clear_and_preview_has_the_opacity_of_truth() {
    let mut ring = with_mesh(evening(r#"{"boundary": 20, "wispiness": 0.2}"#), &ring(), 80.0);
    // It stands, and turns a little to the side.
    let mesh = ring.clouds[0].mesh.as_mut().unwrap();
    mesh.orientation = DQuat::from_rotation_x(1.3) * DQuat::from_rotation_z(0.2);
    ring.clouds[0].droplets.concentration_per_cm3 = 30.0;
    let mut renderer = renderer(STILL, Transport::EMITTER);
    let truth = opacity(&trace(&ring, [32, 18], 96));
    let size = 4;
    let seen = draw(&mut renderer, &ring, [32 * size, 18 * size], false);
    let found = total(&seen, 3) / seen.pixels.len() as f64;
    // 96 samples of a hundred pixels that are partly covered.
    assert!(truth > 0.02 && (found / truth - 1.0).abs() < 0.01, "{found} for {truth}");
}

#[test]
fn voxels_of_a_mesh_hold_what_is_in_it_beside_another_cloud() {
    let mut ring = with_mesh(evening(r#"{"boundary": 0}"#), &ring(), 80.0);
    let mass = |scene: &Scene| {
        let frame = Frame::new(scene, [1, 1]).unwrap();
        let voxels = Voxels::sample(gpu(), &frame, VoxelGrid::new(4.0), &mut |_| ()).unwrap();
        64.0 * voxels.filled().map(|(_, extinction)| f64::from(extinction)).sum::<f64>()
    };
    let extinction = ring.clouds[0].droplets.extinction();
    // 2 pi^2 R r^2, of 96 corners by 48: sin(x)/x of both angles.
    let flat = |corners: f64| (TAU / corners).sin() / (TAU / corners);
    let exact = extinction * 0.5 * TAU * TAU * 80.0 * 32.0 * 32.0 * flat(96.0) * flat(48.0);
    let alone = mass(&ring);
    assert!((alone / exact - 1.0).abs() < 0.01, "{alone} for {exact}");
    let ball = Ellipsoid::new(CENTER + DVec3::Y * 300.0, DVec3::splat(50.0));
    let own = Cloud { ellipsoids: vec![ball], ..ring.clouds[0].clone() };
    ring.clouds.push(Cloud { mesh: None, ..own });
    let both = mass(&ring);
    let ball = extinction * 2.0 / 3.0 * TAU * 50f64.powi(3);
    assert!((both / (exact + ball) - 1.0).abs() < 0.01, "{both} for {exact} and {ball}");
}

#[test]
fn a_mesh_is_baked_once_and_not_again_for_what_shows_it() {
    let mut scene = with_mesh(evening(r#"{"boundary": 20, "wispiness": 0.2}"#), &ring(), 80.0);
    let mut renderer = renderer(in_coarse_light(STILL), Transport::EMITTER);
    let mut baked = |scene: &Scene| {
        draw(&mut renderer, scene, SIZE, false);
        renderer.volumes_baked()
    };
    assert_eq!(baked(&scene), 1);
    scene.clouds[0].mesh.as_mut().unwrap().place.x += 0.5;
    scene.camera.as_mut().unwrap().position.x += 30.0;
    scene.noise.offset.x += 30.0;
    scene.clouds[0].droplets.concentration_per_cm3 *= 0.5;
    assert_eq!(baked(&scene), 1, "place, camera, noise and droplets bake nothing");
    scene.clouds[0].edge.boundary = 30.0;
    assert_eq!(baked(&scene), 2, "another edge");
}
