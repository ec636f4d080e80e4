//! Volumes that other programs made: in closed form, against truth, and our own clouds written and read in again.
#![cfg(all(feature = "export", feature = "import"))]

use crate::common;

use std::sync::Arc;

use common::truth::{trace, traced, tracer};
use common::{
    gpu,
    picture::{draw, renderer, scene},
};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use nephos::{
    export::{Picture, write_vdb, write_vol},
    reference::{PathOptions, PathTracer},
    render::{Film, Frame, Quality, Renderer, Transport, VoxelGrid, Voxels},
    scene::{Camera, Cloud, Droplets, Grid, Phase, Projection, Scene, Up, Volume},
};

use crate::volumes_drawn::CLOUD;

const SIZE: [u32; 2] = [48, 27];

/// A box of voxels of value 1, by their edges.
fn solid(size: [u32; 3], edge: DVec3) -> Arc<Grid> {
    let count = size.iter().product::<u32>() as usize;
    let place = DAffine3::from_mat3(DMat3::from_diagonal(edge));
    Arc::new(Grid::dense("density".to_owned(), place, size, vec![1.0; count].into_iter()).unwrap())
}

/// Only a volume whose droplets scatter all ways alike, seen along parallel lines.
fn alone(volume: Volume, position: DVec3, target: DVec3, height: f64) -> Scene {
    let mut cloud = Cloud::of_volume("volume", volume);
    cloud.droplets = Droplets { phase: Phase::Isotropic, ..Droplets::default() };
    let mut scene = scene(r#"{"sky": "none", "ground": {"albedo": [0, 0, 0], "altitude": -1000}}"#);
    scene.clouds.push(cloud);
    let projection = Projection::Orthographic { height };
    scene.camera = Some(Camera { position, target, roll_deg: 0.0, projection, ..Camera::default() });
    scene
}

fn opacities(renderer: &mut Renderer, scene: &Scene) -> Vec<f64> {
    draw(renderer, scene, [8, 8], false).pixels.iter().map(|pixel| f64::from(pixel[3])).collect()
}

#[test]
fn a_homogeneous_box_lets_through_what_beer_and_lambert_say() {
    // 24 by 16 by 40 voxels of 2, 3 and 5 units of half a metre: 24, 24 and 100 m.
    let grid = solid([24, 16, 40], DVec3::new(2.0, 3.0, 5.0));
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1);
    let middle = 0.5 * DVec3::new(23.0, 15.0, 39.0) * DVec3::new(1.0, 1.5, 2.5);
    let z_up = |v: DVec3| DVec3::new(v.x, v.z, -v.y);
    let mut renderer = renderer(Quality::FINAL, Transport::EMITTER);
    for (name, quality) in Quality::PRESETS {
        renderer.settings.quality = quality;
        for (up, orientation) in [(Up::Y, DQuat::IDENTITY), (Up::Y, turn), (Up::Z, turn)] {
            for (axis, length) in [(DVec3::X, 24.0), (DVec3::Y, 24.0), (DVec3::Z, 100.0)] {
                for depth in [0.05, 0.7, 3.0] {
                    let place = DVec3::new(100.0, 50.0, -30.0);
                    let volume = Volume {
                        extinction: depth / length,
                        scale: 0.5,
                        up,
                        place,
                        orientation,
                        ..Volume::default()
                    };
                    let turned = |v: DVec3| orientation * if up == Up::Z { z_up(v) } else { v };
                    let target = place + turned(middle);
                    // In the middle of the box, where walls are far.
                    // Straight up and down there would be no way up in the picture.
                    let position = target - 200.0 * turned(axis) + 1e-3 * DVec3::Z;
                    let scene = alone(volume.with_grid(grid.clone()), position, target, 8.0);
                    let wanted = 1.0 - (-depth).exp();
                    for found in opacities(&mut renderer, &scene) {
                        let error = (found - wanted).abs();
                        // A step may go over the rim, in which a voxel's value rises: of final quality it is the shortest.
                        let most = if quality == Quality::FINAL { 2e-3 + 1e-3 * depth } else { 8e-3 };
                        assert!(error < most, "{name} {up:?} {axis} {depth}: {found} for {wanted}");
                    }
                }
            }
        }
    }
}

#[test]
fn path_traced_boxes_let_through_the_same() {
    let grid = solid([24, 16, 40], DVec3::new(2.0, 3.0, 5.0));
    let middle = 0.5 * DVec3::new(23.0, 15.0, 39.0) * DVec3::new(2.0, 3.0, 5.0);
    let volume = Volume { extinction: 0.7 / 48.0, ..Volume::default() };
    let scene = alone(volume.with_grid(grid), middle + 500.0 * DVec3::X, middle, 8.0);
    let estimate = trace(&scene, [8, 8], 768);
    let mean = estimate.mean.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>() / 64.0;
    // 49 thousand paths that scatter or do not: four of their standard errors.
    let wanted = 1.0 - (-0.7f64).exp();
    assert!((mean - wanted).abs() < 4.0 * (wanted * (1.0 - wanted) / 49152.0).sqrt(), "{mean} for {wanted}");
}

/// The same scene with its clouds as a volume, by way of a file.
fn read_in(scene: &Scene, grid: VoxelGrid, name: &str) -> Scene {
    let voxels = Voxels::sample(gpu(), &Frame::new(scene, [1, 1]).unwrap(), grid, &mut |_| ()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    if name.ends_with(".vol") { write_vol(&path, &voxels) } else { write_vdb(&path, &voxels) }.unwrap();
    let up = if grid.world_from_volume == DMat3::IDENTITY { Up::Y } else { Up::Z };
    let mut volume = Volume { file: name.to_owned(), up, ..Volume::default() };
    volume.read(folder.path()).unwrap();
    let mut cloud = Cloud::of_volume("read", volume);
    cloud.droplets = scene.clouds[0].droplets.clone();
    Scene { clouds: vec![cloud], ..scene.clone() }
}

fn pictured(scene: &Scene, transport: Transport) -> Picture {
    let film = Film::new(SIZE, 4);
    let frame = film.frame(scene).unwrap();
    let quality = Quality { light_resolution: 64, light_cells: 48, ..Quality::FINAL };
    film.take(gpu(), &mut renderer(quality, transport), &frame, false, &mut |_| ()).unwrap()
}

fn light(pixels: &[[f32; 4]]) -> f64 {
    pixels.iter().map(|pixel| f64::from(pixel[0] + pixel[1] + pixel[2])).sum()
}

fn opacity_rmse(a: &[[f32; 4]], b: &[[f32; 4]]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a[3] - b[3]).powi(2)).sum();
    (squares / a.len() as f64).sqrt()
}

#[test]
fn our_own_clouds_come_back_as_they_were() {
    let original = scene(CLOUD);
    let before = pictured(&original, Transport::MOMENTS);
    let truth = trace(&original, SIZE, 768);
    for (name, grid) in [("cloud.vdb", VoxelGrid::new(3.0)), ("cloud.vol", VoxelGrid::new(3.0).z_up())] {
        let again = read_in(&original, grid, name);
        let after = pictured(&again, Transport::MOMENTS);
        let rmse = opacity_rmse(&before.pixels, &after.pixels);
        let drawn = light(&after.pixels) / light(&before.pixels) - 1.0;
        let [was, is] = [&before, &after].map(|picture| light(&picture.pixels) / light(&truth.mean) - 1.0);
        let found = trace(&again, SIZE, 768);
        let traced = light(&found.mean) / light(&truth.mean) - 1.0;
        eprintln!(
            "{name}: opacity rmse {rmse:.4}, path traced light {traced:+.4}, drawn {drawn:+.4} ({was:+.4}, {is:+.4})"
        );
        assert!(rmse <= 0.013, "{name}: {rmse}");
        // Of which 0.004 is noise.
        assert!(traced.abs() <= 0.01, "{name}: {traced}");
        // Cells that light is solved for in lie elsewhere.
        assert!(drawn.abs() <= 0.01, "{name}: {drawn}");
    }
}

/// Smoke: a plume of swirls, by a formula.
fn smoke() -> Arc<Grid> {
    let size = [48u32, 64, 40];
    let value = |i: u32| {
        let p = DVec3::from([i % size[0], i / size[0] % size[1], i / (size[0] * size[1])].map(f64::from));
        let rise = p.y / 64.0;
        let middle = DVec3::new(24.0 + 6.0 * (4.0 * rise).sin(), p.y, 20.0 + 5.0 * (5.0 * rise).cos());
        let swirl = 2.0 * ((0.9 * p.x).sin() * (0.7 * p.y).cos() * (0.8 * p.z).sin());
        let width = 4.0 + 11.0 * rise + swirl;
        (1.0 - p.distance(middle) / width).max(0.0) as f32 * if rise > 0.97 { 0.0 } else { 1.0 }
    };
    let place = DAffine3::from_scale(DVec3::splat(4.0));
    let values = (0..size.iter().product()).map(value);
    Arc::new(Grid::dense("density".to_owned(), place, size, values).unwrap())
}

fn smoke_scene(extinction: f64) -> Scene {
    let volume = Volume { extinction, place: DVec3::new(0.0, 300.0, 0.0), ..Volume::default() };
    let mut scene = scene(
        r#"{"sky": {"uniform": {"radiance": [0.05, 0.06, 0.08]}}, "ground": {"albedo": [0, 0, 0]},
            "sun": {"irradiance": [1, 1, 1], "position": {"angles": {"azimuth_deg": 120, "elevation_deg": 40}}},
            "camera": {"position": [96, 420, 520], "target": [96, 425, 80], "projection": {"perspective": {"vertical_fov_deg": 36}}}}"#,
    );
    let mut cloud = Cloud::of_volume("smoke", volume.with_grid(smoke()));
    cloud.droplets.phase = Phase::HenyeyGreenstein { g: 0.5 };
    scene.clouds.push(cloud);
    scene
}

#[test]
fn light_of_a_volume_is_near_the_truth() {
    for extinction in [0.01, 0.08] {
        let scene = smoke_scene(extinction);
        let drawn = pictured(&scene, Transport::MOMENTS);
        let truth = trace(&scene, SIZE, 384);
        let bias = light(&drawn.pixels) / light(&truth.mean) - 1.0;
        let (mut square, mut noise, mut whole) = (0.0, 0.0, 0.0);
        for ((pixel, mean), error) in drawn.pixels.iter().zip(&truth.mean).zip(&truth.error) {
            for c in 0..3 {
                square += f64::from(pixel[c] - mean[c]).powi(2);
                noise += f64::from(error[c]).powi(2);
                whole += f64::from(mean[c]).powi(2);
            }
        }
        let rmse = ((square - noise).max(0.0) / whole).sqrt();
        eprintln!("extinction {extinction}: relative rmse {rmse:.3}, bias {bias:+.3}");
        assert!(rmse < 0.06 && bias.abs() < 0.04, "{extinction}: {rmse} {bias}");
    }
}

#[test]
fn opacity_of_a_volume_is_that_of_the_truth() {
    let scene = smoke_scene(0.02);
    let drawn = pictured(&scene, Transport::EMITTER);
    let estimate = traced(&mut tracer(&scene, SIZE, &PathOptions::default()), 384);
    let sum = |pixels: &[[f32; 4]]| pixels.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>();
    let ratio = sum(&drawn.pixels) / sum(&estimate.mean);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn voxels_of_a_volume_hold_its_matter() {
    let scene = smoke_scene(0.05);
    let grid = scene.clouds[0].volume.as_ref().unwrap().read_grid().unwrap().clone();
    let wanted: f64 = grid.filled().map(|(_, value)| f64::from(value) * 64.0 * 0.05).sum();
    let frame = Frame::new(&scene, [1, 1]).unwrap();
    let voxels = Voxels::sample(gpu(), &frame, VoxelGrid::new(5.0), &mut |_| ()).unwrap();
    let found: f64 = voxels.filled().map(|(_, value)| f64::from(value) * 125.0).sum();
    assert!((found / wanted - 1.0).abs() < 2e-3, "{found} for {wanted}");
}

#[test]
fn empty_space_costs_nothing() {
    // Two plates of voxels, 600 apart, in line.
    let size = [600u32, 16, 16];
    let values = (0..size.iter().product()).map(|i: u32| f32::from(u8::from(!(8..592).contains(&(i % 600)))));
    let grid = Grid::dense("density".to_owned(), DAffine3::IDENTITY, size, values).unwrap();
    let volume = Volume { extinction: 0.01, ..Volume::default() }.with_grid(Arc::new(grid));
    let scene = alone(volume, DVec3::new(-900.0, 8.0, 8.0), DVec3::new(0.0, 8.0, 8.0), 8.0);
    let mut renderer = renderer(Quality::FINAL, Transport::EMITTER);
    renderer.settings.counting = true;
    draw(&mut renderer, &scene, [8, 8], false);
    let counts = renderer.counts(gpu()).unwrap();
    let each = counts.density_evaluations as f64 / counts.rays as f64;
    eprintln!("{each:.1} densities a ray");
    // 16 voxels and their rims, some samples each: far fewer than the 600 voxels between.
    assert!(each > 10.0 && each < 120.0, "{each}");
    assert!(renderer.brick_bytes() < 1 << 20, "{}", renderer.brick_bytes());
}

#[test]
fn a_volume_among_other_clouds_is_drawn_and_traced_and_not_written() {
    let mut both = smoke_scene(0.05);
    both.clouds.push(scene(CLOUD).clouds.remove(0));
    let frame = Frame::new(&both, SIZE).unwrap();
    assert!(
        draw(&mut renderer(Quality::DRAFT, Transport::SINGLE), &both, SIZE, true).pixels.len() == 48 * 27
    );
    assert!(PathTracer::new(gpu(), &frame, 0).is_ok());
    let refused = Voxels::sample(gpu(), &frame, VoxelGrid::new(5.0), &mut |_| ()).unwrap_err().to_string();
    assert!(refused.contains("only by itself") && refused.contains("hide"), "{refused}");
}
