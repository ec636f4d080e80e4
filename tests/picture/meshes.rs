//! Meshes that are boundaries, drawn: against ellipsoids of the same shape, and against truth.
#![cfg(feature = "export")]

use std::{f64::consts::TAU, sync::Arc};

use crate::common;

use common::{
    gpu,
    picture::{draw, in_coarse_light, renderer, scene},
    truth::{Measured, assert_agree, mean, trace},
};
use glam::{DQuat, DVec3};
use nephos::{
    export::Picture,
    render::{Frame, Quality, Transport, VoxelGrid, Voxels},
    scene::{Cloud, Ellipsoid, Mesh, Scene, Surface},
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

/// Root of the mean square of the difference, over the mean.
fn difference(a: &Picture, b: &Picture, channels: std::ops::Range<usize>) -> f64 {
    let values = |picture: &Picture| -> Vec<f64> {
        picture.pixels.iter().flat_map(|pixel| pixel[channels.clone()].to_vec()).map(f64::from).collect()
    };
    let (a, b) = (values(a), values(b));
    let squares: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt() / (a.iter().sum::<f64>() / a.len() as f64)
}

#[test]
fn the_mesh_of_a_ball_looks_like_the_ball() {
    let ball = ball();
    for edge in [r#"{"boundary": 4, "wispiness": 0}"#, r#"{"boundary": 40, "wispiness": 0.3}"#] {
        let [exact, baked] = [with_ball(evening(edge)), with_mesh(evening(edge), &ball, 100.0)];
        for transport in [Transport::SINGLE, Transport::MOMENTS] {
            let mut renderer = renderer(in_coarse_light(STILL), transport);
            let [exact, baked] = [&exact, &baked].map(|scene| draw(&mut renderer, scene, SIZE, false));
            let [light, opacity] = [0..3, 3..4].map(|channels| difference(&exact, &baked, channels));
            eprintln!("{edge} {transport}: light {light:.4}, opacity {opacity:.4}");
            // A pixel is 12 m wide; the boxes of both's light differ, and with them where its texels are.
            assert!(light < 0.05 && opacity < 0.02, "{edge} {transport}: {light} {opacity}");
        }
    }
}

#[test]
fn truth_of_a_mesh_is_that_of_the_ball_alone_and_among_others() {
    let ball = ball();
    let edge = r#"{"boundary": 40, "wispiness": 0.3}"#;
    let mut far = Cloud { ellipsoids: vec![Ellipsoid::default()], ..Cloud::default() };
    far.ellipsoids[0].center = DVec3::new(60e3, 1000.0, 60e3);
    let among = |mut scene: Scene| {
        scene.clouds.push(far.clone());
        scene
    };
    let wanted = with_ball(evening(edge));
    let alone = with_mesh(evening(edge), &ball, 100.0);
    let found = [("alone", alone.clone()), ("among others", among(alone))];
    let exact = trace(&wanted, [16, 9], 768);
    let results =
        found.map(|(name, scene)| (name.to_owned(), mean(&trace(&scene, [16, 9], 768), 1), mean(&exact, 1)));
    // The mesh's sides are flat: it has 0.1 % less of the ball's area.
    let results = results.map(|(name, found, wanted)| {
        let wanted = Measured { error: wanted.error.hypot(2e-3 * wanted.value), ..wanted };
        (name, found, wanted)
    });
    assert_agree(&results);
}

#[test]
fn the_hole_of_a_ring_is_clear_and_preview_has_the_opacity_of_truth() {
    let mut ring = with_mesh(evening(r#"{"boundary": 20, "wispiness": 0.2}"#), &ring(), 80.0);
    // It stands, and turns a little to the side.
    let mesh = ring.clouds[0].mesh.as_mut().unwrap();
    mesh.orientation = DQuat::from_rotation_x(1.3) * DQuat::from_rotation_z(0.2);
    ring.clouds[0].droplets.concentration_per_cm3 = 30.0;
    let seen = draw(&mut renderer(STILL, Transport::EMITTER), &ring, [32, 18], false);
    let truth = trace(&ring, [32, 18], 192);
    let middle = 9 * 32 + 16;
    assert_eq!((seen.pixels[middle][3], truth.mean[middle][3]), (0.0, 0.0));
    let apart: f64 = seen.pixels.iter().zip(&truth.mean).map(|(a, b)| f64::from(a[3] - b[3])).sum();
    let all: f64 = seen.pixels.iter().map(|pixel| f64::from(pixel[3])).sum();
    // 192 samples of a hundred pixels that are partly covered.
    assert!(all > 60.0 && (apart / all).abs() < 0.01, "{apart} of {all}");
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
