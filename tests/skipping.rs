//! What a scene does not use costs nothing: told by the counts of work and by what is made.
#![cfg(feature = "export")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::{
    gpu,
    picture::{draw, renderer, scene},
};
use nephos::{
    render::{Counts, Quality, Transport},
    scene::Scene,
};

const SIZE: [u32; 2] = [32, 18];

fn one(edge: &str) -> Scene {
    scene(&format!(
        r#"{{"sky": "none", "clouds": [{{"edge": {edge}, "droplets": {{"phase": "isotropic"}}, "ellipsoids": [
            {{"center": [0, 900, 0], "radii": [100, 100, 100]}}]}}]}}"#
    ))
}

fn counted(scene: &Scene, transport: Transport) -> Counts {
    let mut renderer = renderer(Quality::DRAFT, transport);
    renderer.counting = true;
    draw(&mut renderer, scene, SIZE, false);
    renderer.counts(gpu()).unwrap()
}

#[test]
fn homogeneous_clouds_read_no_noise() {
    let smooth = counted(&one(r#"{"boundary": 0}"#), Transport::Single);
    assert_eq!((smooth.density_evaluations, smooth.noise_reads), (0, 0));
    assert!(smooth.rays_hit > 0 && smooth.steps > 0);
    let noisy = counted(&one(r#"{"boundary": 40}"#), Transport::Single);
    assert!(noisy.noise_reads > 0, "else the test would prove nothing");
}

#[test]
fn light_that_is_not_asked_for_is_not_read() {
    let cloud = one(r#"{"boundary": 40}"#);
    let reads = |transport| counted(&cloud, transport).map_reads;
    assert_eq!(reads(Transport::Emitter), 0, "an emitter has no shadows");
    assert!(reads(Transport::Single) < reads(Transport::Moments));
    let mut lit = cloud.clone();
    lit.sky = common::random::white();
    assert!(counted(&lit, Transport::Single).map_reads > reads(Transport::Single), "the sky is read");
}

#[test]
fn pixels_without_clouds_are_not_launched() {
    let empty = scene(r#"{"sky": "none", "clouds": [{}]}"#);
    assert_eq!(counted(&empty, Transport::Single), Counts::default());
    let mut away = one(r#"{"boundary": 40}"#);
    away.camera = Some(away.camera());
    away.clouds[0].ellipsoids[0].center.z += 1e5;
    let counts = counted(&away, Transport::Single);
    assert_eq!(counts, Counts::default(), "behind the camera");
}

#[test]
fn clouds_out_of_the_picture_get_no_light_and_keep_what_they_have() {
    let cloud = one(r#"{"boundary": 40}"#);
    let mut away = cloud.clone();
    let camera = cloud.camera();
    away.camera = Some(nephos::scene::Camera { target: 2.0 * camera.position - camera.target, ..camera });
    let mut renderer = renderer(Quality::DRAFT, Transport::Single);
    let mut made = |scene: &Scene| {
        draw(&mut renderer, scene, SIZE, false);
        (renderer.light_updates(), renderer.light_bytes())
    };
    assert_eq!(made(&away), (0, 0));
    let seen = made(&cloud);
    assert!(seen.0 > 0 && seen.1 > 0);
    assert_eq!(made(&away), seen);
    assert_eq!(made(&cloud), seen, "what was made once is found again");
}

#[test]
fn ellipsoids_that_a_ray_does_not_meet_are_not_asked_at_its_points() {
    // A row of many across the view: each ray meets few of them.
    let mut row = one(r#"{"boundary": 40}"#);
    row.camera = Some(row.camera());
    let first = row.clouds[0].ellipsoids[0].clone();
    let alone = counted(&row, Transport::Single);
    for i in 0..400 {
        let mut next = first.clone();
        next.center.x += 250.0 * f64::from(i + 1);
        row.clouds[0].ellipsoids.push(next);
    }
    let many = counted(&row, Transport::Single);
    let each = |counts: Counts| counts.ellipsoids as f64 / counts.density_evaluations as f64;
    assert!(each(many) < 4.0 * each(alone), "{} for {}", each(many), each(alone));
}
