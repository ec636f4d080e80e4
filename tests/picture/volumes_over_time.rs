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
    export::{Picture, VdbOptions, write_vdb, write_vdb_with},
    render::{Film, Frame, Quality, Renderer, Transport, VoxelGrid, Voxels},
    scene::{Between, Cloud, Scene, Sequence, Volume},
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
    read_as(scene, folder, Sequence { fps: Some(FPS), ..Sequence::default() })
}

fn read_as(scene: &Scene, folder: &Path, sequence: Sequence) -> Scene {
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
    write_steps(&original, 3, folder.path());
    let sequence = read_in(&original, folder.path());
    let mut renderer = renderer(Quality::PREVIEW, Transport::SINGLE);
    let mut first = Vec::new();
    for step in 0..3 {
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
    let truth = trace(&at(&sequence, 1.0), SIZE, 12);
    let [(x, y, _), (drawn_x, drawn_y, _)] = [&truth.mean, &first[2].pixels].map(|pixels| seen(pixels));
    assert!((x - drawn_x).hypot(y - drawn_y) < 0.3, "{x} {y}, drawn at {drawn_x} {drawn_y}");
    // Same time, same picture, in whatever order.
    for step in [2, 0] {
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

/// Steps 1 and 2 of a ball that goes farther between them than it is wide, with its velocities where it is.
fn write_far_steps(scene: &Scene, seconds: f64, folder: &Path) {
    for step in 0..2 {
        let time = f64::from(step) * seconds;
        let frame = Frame::new(&at(scene, time), [1, 1]).unwrap();
        let voxels = Voxels::sample(gpu(), &frame, VoxelGrid::new(3.0), &mut |_| ()).unwrap();
        let movement = scene.movement(time, 0.1).unwrap();
        let velocity = |p: DVec3| movement.nearest(p) / 0.1;
        let options = VdbOptions { velocity: Some(&velocity), ..VdbOptions::default() };
        write_vdb_with(&folder.join(format!("blob.{:04}.vdb", step + 1)), &voxels, options).unwrap();
    }
}

#[test]
fn half_way_between_steps_a_ball_with_velocities_is_one_ball() {
    let (original, folder, seconds) = (blob(), tempfile::tempdir().unwrap(), 1.5);
    write_far_steps(&original, seconds, folder.path());
    let read = |sequence: Sequence| {
        read_as(&original, folder.path(), Sequence { fps: Some(1.0 / seconds), ..sequence })
    };
    let half = 0.5 * seconds;
    let grid = |scene: &Scene, time: f64| {
        let moment = scene.at(time).unwrap();
        moment.clouds[0].volume.as_ref().unwrap().read_grid().unwrap().clone()
    };
    let middle = |grid: &nephos::scene::Grid| {
        let sum: DVec3 = grid
            .filled()
            .map(|(at, value)| f64::from(value) * grid.place.transform_point3(at.as_dvec3()))
            .sum();
        sum / grid.total
    };
    // As the file says by itself, and by a velocity that is told.
    let told = Sequence { velocity: Some(original.wind.velocity), ..Sequence::default() };
    for sequence in [Sequence::default(), told] {
        let scene = read(sequence);
        let [first, between, last] = [0.0, half, seconds].map(|time| grid(&scene, time));
        // The cloud goes through its noise: steps differ by that.
        let mass = 0.5 * (first.total + last.total);
        assert!((between.total / mass - 1.0).abs() < 0.01, "{} of {mass}", between.total);
        let expected = 0.5 * (middle(&first) + middle(&last));
        assert!(middle(&between).distance(expected) < 0.3, "{}", middle(&between));
        let size = between.size() - first.size().max(last.size());
        assert!(size.max_element() <= 2, "{} wider than its steps", size);
        let mut renderer = renderer(Quality::PREVIEW, Transport::SINGLE);
        let [was, is] =
            [&original, &scene].map(|scene| seen(&pictured(&mut renderer, &at(scene, half)).pixels));
        eprintln!(
            "half way: at {:.2} {:.2}, {:.2} {:.2} there; {:.4} as much",
            was.0,
            was.1,
            is.0,
            is.1,
            is.2 / was.2
        );
        assert!(
            (was.0 - is.0).hypot(was.1 - is.1) < 0.3 && (is.2 / was.2 - 1.0).abs() < 0.04,
            "{was:?} {is:?}"
        );
    }
    // Where both are shown, both are seen.
    let both = grid(&read(Sequence { between: Between::Blend, ..Sequence::default() }), half);
    assert!(both.size().x > 3 * grid(&read(Sequence::default()), half).size().x / 2);
    let nearest = read(Sequence { between: Between::Nearest, ..Sequence::default() });
    assert_eq!(grid(&nearest, 0.4 * seconds), grid(&nearest, 0.0));
}
