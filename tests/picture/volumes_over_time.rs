//! Volumes over time: our own clouds, written step by step, are where they were when they are read again.
#![cfg(all(feature = "export", feature = "import"))]

use crate::common;

use std::{fs, path::Path};

use common::{
    gpu,
    picture::{draw, renderer, scene},
    truth::trace,
};
use glam::DVec3;
use nephos::{
    export::{Picture, write_vdb},
    render::{Film, Frame, Quality, Renderer, Transport, VoxelGrid, Voxels},
    scene::{Cloud, Scene, Sequence, Volume},
};

const SIZE: [u32; 2] = [48, 27];
/// How far it moves from one step to the next, m, and steps a second.
const WAY: DVec3 = DVec3::new(30.0, 10.0, 0.0);
const FPS: f64 = 2.0;

/// A ball that the wind carries.
fn blob() -> Scene {
    let mut blob = scene(
        r#"{"clouds": [{"name": "blob", "edge": {"boundary": 6}, "droplets": {"concentration_per_cm3": 100}, "ellipsoids": [
            {"center": [0, 500, 0], "radii": [40, 30, 35]}]}], "noise": {"scale": 25}, "sky": "none", "ground": {"albedo": [0, 0, 0]},
            "sun": {"position": {"angles": {"azimuth_deg": 120, "elevation_deg": 35}}},
            "camera": {"position": [45, 500, 500], "target": [45, 515, 0], "projection": {"perspective": {"vertical_fov_deg": 24}}}}"#,
    );
    blob.wind.velocity = FPS * WAY;
    blob
}

/// Writes steps 1 to `count` of `scene` as `blob.####.vdb`.
fn write_steps(scene: &Scene, count: i32, folder: &Path) {
    for step in 0..count {
        let moment = Scene { time: f64::from(step) / FPS, ..scene.clone() };
        let frame = Frame::new(&moment, [1, 1]).unwrap();
        let voxels = Voxels::sample(gpu(), &frame, VoxelGrid::new(3.0), &mut |_| ()).unwrap();
        write_vdb(&folder.join(format!("blob.{:04}.vdb", step + 1)), &voxels).unwrap();
    }
}

/// The same scene with those steps in place of its cloud, in still air.
fn read_in(scene: &Scene, folder: &Path) -> Scene {
    let sequence = Sequence { fps: Some(FPS), ..Sequence::default() };
    let file = "blob.####.vdb".to_owned();
    let mut volume = Volume { file, sequence: Some(sequence), ..Volume::default() };
    volume.read(folder).unwrap();
    let mut cloud = Cloud::of_volume("blob", volume);
    cloud.droplets = scene.clouds[0].droplets.clone();
    Scene { clouds: vec![cloud], wind: Default::default(), ..scene.clone() }
}

fn at(scene: &Scene, time: f64) -> Scene {
    Scene { time, ..scene.clone() }
}

fn pictured(renderer: &mut Renderer, scene: &Scene) -> Picture {
    let film = Film::new(SIZE, 2);
    film.take(gpu(), renderer, &film.frame(scene).unwrap(), false, &mut |_| ()).unwrap()
}

/// Mean place of what is seen, pixels, and how much there is of it.
fn seen(pixels: &[[f32; 4]]) -> (f64, f64, f64) {
    let mut sum = (0.0, 0.0, 0.0);
    for (i, pixel) in pixels.iter().enumerate() {
        let (x, y) = (i % SIZE[0] as usize, i / SIZE[0] as usize);
        let opacity = f64::from(pixel[3]);
        sum = (sum.0 + opacity * x as f64, sum.1 + opacity * y as f64, sum.2 + opacity);
    }
    (sum.0 / sum.2, sum.1 / sum.2, sum.2)
}

#[test]
fn steps_are_where_the_cloud_was_in_pictures_and_in_truth() {
    let (original, folder) = (blob(), tempfile::tempdir().unwrap());
    write_steps(&original, 4, folder.path());
    let sequence = read_in(&original, folder.path());
    let mut renderer = renderer(Quality::FINAL, Transport::MOMENTS);
    let mut first = Vec::new();
    for step in 0..4 {
        let time = f64::from(step) / FPS;
        let [was, is] = [&original, &sequence].map(|scene| pictured(&mut renderer, &at(scene, time)));
        let rmse =
            was.pixels.iter().zip(&is.pixels).map(|(a, b)| f64::from(a[3] - b[3]).powi(2)).sum::<f64>();
        let rmse = (rmse / was.pixels.len() as f64).sqrt();
        let [(x, y, sum), (other_x, other_y, other_sum)] = [&was, &is].map(|picture| seen(&picture.pixels));
        eprintln!(
            "step {step}: opacity rmse {rmse:.4}, at {x:.2} {y:.2}, off by {:.3} {:.3}",
            other_x - x,
            other_y - y
        );
        // Voxels of 3 m, a pixel being 8 m wide; a step further is 4 pixels.
        assert!(rmse < 0.013 && (other_x - x).hypot(other_y - y) < 0.1, "{step}: {rmse}");
        assert!((other_sum / sum - 1.0).abs() < 0.01, "{step}: {other_sum} for {sum}");
        first.push(is);
    }
    // The path tracer sees the same step.
    let truth = trace(&at(&sequence, 1.0), SIZE, 96);
    let [(x, y, _), (drawn_x, drawn_y, _)] = [&truth.mean, &first[2].pixels].map(|pixels| seen(pixels));
    assert!((x - drawn_x).hypot(y - drawn_y) < 0.3, "{x} {y}, drawn at {drawn_x} {drawn_y}");
    // Same time, same picture, in whatever order.
    for step in [3, 0, 2, 1] {
        let again = pictured(&mut renderer, &at(&sequence, f64::from(step) / FPS));
        assert!(again.pixels == first[step as usize].pixels, "{step}");
    }
}

#[test]
fn a_step_that_stays_is_neither_read_nor_lit_anew() {
    let (original, folder) = (blob(), tempfile::tempdir().unwrap());
    write_steps(&original, 3, folder.path());
    let sequence = read_in(&original, folder.path());
    let mut renderer = renderer(Quality::DRAFT, Transport::MOMENTS);
    draw(&mut renderer, &at(&sequence, 0.5), SIZE, false);
    let (lit, bytes) = (renderer.light_updates(), renderer.brick_bytes());
    fs::remove_file(folder.path().join("blob.0002.vdb")).unwrap();
    for time in [0.5, 0.3, 0.6, 0.7] {
        draw(&mut renderer, &at(&sequence, time), SIZE, false);
    }
    assert_eq!((renderer.light_updates(), renderer.brick_bytes()), (lit, bytes));
    draw(&mut renderer, &at(&sequence, 1.0), SIZE, false);
    assert!(renderer.light_updates() > lit);
}
