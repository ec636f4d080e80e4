//! Light of many clouds, made for some of them at a time while things move.
#![cfg(feature = "export")]

use crate::common;

use common::picture::{draw, in_coarse_light, renderer, scene};
use glam::DVec3;
use nephos::{
    export::Picture,
    render::{Quality, Renderer, Transport},
    scene::{Scene, SunPosition},
};

const SIZE: [u32; 2] = [48, 27];

fn three_clouds() -> Scene {
    scene(
        r#"{"clouds": [
            {"ellipsoids": [{"center": [-550, 900, 0], "radii": [100, 70, 100]}]},
            {"ellipsoids": [{"center": [0, 950, 0], "radii": [90, 80, 100]}]},
            {"ellipsoids": [{"center": [550, 900, 0], "radii": [100, 70, 100]}]}],
        "camera": {"position": [0, 900, 1200], "target": [0, 900, 0]}}"#,
    )
}

fn drawn(renderer: &mut Renderer, scene: &Scene) -> Picture {
    draw(renderer, scene, SIZE, false)
}

fn at_once(lights_at_once: u32) -> Renderer {
    let mut renderer = renderer(in_coarse_light(Quality::DRAFT), Transport::MOMENTS);
    renderer.settings.lights_at_once = lights_at_once;
    // What is made for shadows would be counted as well: tests/picture/shadows.rs has theirs.
    renderer.settings.shadows = false;
    renderer
}

fn with_sun(azimuth_deg: f64) -> Scene {
    let mut scene = three_clouds();
    scene.sun.position = SunPosition::Angles { azimuth_deg, elevation_deg: 30.0 };
    scene
}

/// Pixels of the left, middle or right third of a picture.
fn third(picture: &Picture, part: usize) -> impl Iterator<Item = &[f32; 4]> {
    let columns = part * picture.width / 3..(part + 1) * picture.width / 3;
    picture.pixels.chunks(picture.width).flat_map(move |row| &row[columns.clone()])
}

/// Mean opacity of the three thirds.
fn opacities(picture: &Picture) -> [f32; 3] {
    let share = 3.0 / (picture.width * picture.height) as f32;
    [0, 1, 2].map(|part| share * third(picture, part).map(|pixel| pixel[3]).sum::<f32>())
}

#[test]
fn clouds_without_light_wait_for_their_turn_and_then_all_is_as_ever() {
    let mut some = at_once(1);
    let shown = [0, 1, 2].map(|_| {
        let picture = drawn(&mut some, &three_clouds());
        (opacities(&picture).iter().filter(|opacity| **opacity > 0.01).count(), some.lights_waiting())
    });
    assert_eq!(shown, [(1, 2), (2, 1), (3, 0)]);
    let all = drawn(&mut at_once(u32::MAX), &three_clouds());
    assert_eq!(drawn(&mut some, &three_clouds()).pixels, all.pixels);
}

#[test]
fn while_the_sun_moves_every_cloud_has_its_turn() {
    let (mut some, mut all) = (at_once(u32::MAX), at_once(u32::MAX));
    drawn(&mut some, &with_sun(100.0));
    some.settings.lights_at_once = 1;
    let mut turns = [0; 3];
    for azimuth in [120.0, 140.0, 160.0] {
        let picture = drawn(&mut some, &with_sun(azimuth));
        assert_eq!(some.lights_waiting(), 2);
        assert!(opacities(&picture).iter().all(|opacity| *opacity > 0.02));
        let current = drawn(&mut all, &with_sun(azimuth));
        for (part, turn) in turns.iter_mut().enumerate() {
            *turn += i32::from(third(&picture, part).eq(third(&current, part)));
        }
    }
    assert_eq!(turns, [1, 1, 1]);
}

#[test]
fn a_cloud_that_moves_keeps_its_light_until_its_turn() {
    let mut some = at_once(u32::MAX);
    drawn(&mut some, &three_clouds());
    let made = some.light_updates();
    some.settings.lights_at_once = 0;
    let mut moved = three_clouds();
    moved.clouds[1].ellipsoids[0].center.x += 20.0;
    let picture = drawn(&mut some, &moved);
    // It waits, and so do those that it stands beside.
    assert_eq!((some.light_updates(), some.lights_waiting()), (made, 3));
    assert!(opacities(&picture).iter().all(|opacity| *opacity > 0.02));
}

#[test]
fn a_cloud_whose_last_shadow_goes_is_lit_as_if_there_had_been_none() {
    let clouds = |high: f64| {
        let mut scene = three_clouds();
        scene.clouds.truncate(2);
        scene.clouds[0].ellipsoids[0].center = DVec3::new(0.0, high, 0.0);
        scene.sun.position = SunPosition::Direction(DVec3::Y);
        scene
    };
    let (mut some, mut fresh) = (at_once(u32::MAX), at_once(u32::MAX));
    let shaded = drawn(&mut some, &clouds(1600.0));
    let lit = drawn(&mut some, &clouds(100.0));
    assert_eq!(lit.pixels, drawn(&mut fresh, &clouds(100.0)).pixels);
    let light = |picture: &Picture| picture.pixels.iter().map(|pixel| pixel[1]).sum::<f32>();
    assert!(light(&shaded) < 0.8 * light(&lit), "{} {}", light(&shaded), light(&lit));
}

#[test]
fn light_of_another_model_does_not_stand_in() {
    let mut some = at_once(u32::MAX);
    some.settings.transport = Transport::SINGLE;
    drawn(&mut some, &three_clouds());
    (some.settings.transport, some.settings.lights_at_once) = (Transport::MOMENTS, 0);
    let picture = drawn(&mut some, &three_clouds());
    assert_eq!(some.lights_waiting(), 3);
    assert!(picture.pixels.iter().all(|pixel| pixel[3] == 0.0));
}

/// A small cloud in the middle of a wide thin one, seen from `east` metres beside them.
fn concentric(east: f64) -> Scene {
    let mut scene = scene(
        r#"{"clouds": [
            {"ellipsoids": [{"center": [0, 900, 0], "radii": [60, 60, 60]}]},
            {"ellipsoids": [{"center": [0, 900, 0], "radii": [300, 80, 300], "density": 0.02}]}],
        "camera": {"position": [0, 900, 1200], "target": [0, 900, 0]}}"#,
    );
    let camera = scene.camera.as_mut().unwrap();
    camera.position.x += east;
    camera.target.x += east;
    scene
}

#[test]
fn clouds_with_one_middle_keep_their_light_while_the_camera_moves() {
    let mut some = at_once(u32::MAX);
    drawn(&mut some, &concentric(0.0));
    let made = some.light_updates();
    for east in [1.0, 2.0, 3.0] {
        drawn(&mut some, &concentric(east));
        assert_eq!(some.light_updates(), made, "{east} m to the east");
    }
}

#[test]
fn clouds_with_one_middle_wait_for_no_turn_and_are_lit_by_their_own_light() {
    let mut some = at_once(u32::MAX);
    drawn(&mut some, &concentric(0.0));
    some.settings.lights_at_once = 0;
    let picture = drawn(&mut some, &concentric(0.0));
    assert_eq!(some.lights_waiting(), 0);
    assert_eq!(picture.pixels, drawn(&mut at_once(u32::MAX), &concentric(0.0)).pixels);
}

#[test]
fn of_clouds_with_one_middle_one_may_be_out_of_view() {
    // The small one leaves the picture by its edge; the wide one reaches into it.
    let beside = 850.0;
    let mut some = at_once(u32::MAX);
    drawn(&mut some, &concentric(0.0));
    let made = some.light_updates();
    for east in [beside, beside + 1.0, beside + 2.0, 0.0] {
        drawn(&mut some, &concentric(east));
        assert_eq!(some.light_updates(), made, "{east} m to the east");
    }
}

/// A heap in the light of the sun at this azimuth, which its own noise or that of the scene makes ragged.
fn heap(azimuth_deg: f64, east: f64) -> Scene {
    let mut scene = scene(
        r#"{"clouds": [{"edge": {"boundary": 40}, "droplets": {"concentration_per_cm3": 150}, "ellipsoids": [
            {"center": [0, 950, 0], "radii": [160, 120, 150]}, {"center": [120, 900, 40], "radii": [110, 80, 110]}]}],
        "noise": {"scale": 90}, "sky": {"uniform": {"radiance": [0.05, 0.07, 0.1]}},
        "camera": {"position": [0, 900, 900], "target": [0, 930, 0]}}"#,
    );
    scene.sun.position = SunPosition::Angles { azimuth_deg, elevation_deg: 30.0 };
    scene.clouds[0].ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.center.x += east);
    scene
}

#[test]
fn light_is_kept_while_little_moves_where_that_is_asked_for() {
    let updates = |slack_deg: f64, scenes: &[Scene]| {
        let mut some = at_once(u32::MAX);
        some.settings.light_slack_deg = slack_deg;
        let mut made = Vec::new();
        for scene in scenes {
            let before = some.light_updates();
            drawn(&mut some, scene);
            assert_eq!(some.lights_waiting(), 0);
            made.push(some.light_updates() > before);
        }
        made
    };
    let turning = [0.0, 0.3, 0.5, 0.7, 0.9].map(|turned| heap(120.0 + turned, 0.0));
    assert_eq!(updates(0.0, &turning), [true; 5]);
    // Steps of azimuth are shorter at a height of 30 degrees, by its cosine.
    assert_eq!(updates(0.5, &turning), [true, false, false, true, false]);
    // It drifts through the scene's noise: 0.5 degrees are 2 m at its far side, and half of it counts.
    let drifting = [0.0, 0.5, 0.9, 1.3, 2.0].map(|east| heap(120.0, east));
    assert_eq!(updates(0.0, &drifting), [true; 5]);
    assert_eq!(updates(0.5, &drifting), [true, false, false, true, false]);
    // Where it is to be exact again it is, though nothing moves any more.
    let mut some = at_once(u32::MAX);
    some.settings.light_slack_deg = 0.5;
    drawn(&mut some, &turning[0]);
    drawn(&mut some, &turning[1]);
    some.settings.light_slack_deg = 0.0;
    let exact = drawn(&mut at_once(u32::MAX), &turning[1]);
    assert_eq!(drawn(&mut some, &turning[1]).pixels, exact.pixels);
    // What is another cloud is another cloud.
    let mut thinner = heap(120.0, 0.0);
    thinner.clouds[0].droplets.concentration_per_cm3 = 149.0;
    assert_eq!(updates(0.5, &[heap(120.0, 0.0), thinner]), [true, true]);
}

#[test]
fn what_light_is_kept_for_is_not_seen() {
    let (mut some, mut exact) = (at_once(u32::MAX), at_once(u32::MAX));
    some.settings.light_slack_deg = 0.5;
    let mut worst = [0.0f64; 2];
    let mut last: Option<Vec<f64>> = None;
    for step in 0..16 {
        let scene = heap(120.0 + 0.15 * f64::from(step), 0.0);
        let [kept, made] = [&mut some, &mut exact].map(|renderer| drawn(renderer, &scene));
        let bright = made.pixels.iter().map(|pixel| pixel[1]).fold(0.0, f32::max);
        let off: Vec<_> =
            kept.pixels.iter().zip(&made.pixels).map(|(a, b)| f64::from((a[1] - b[1]) / bright)).collect();
        worst[0] = off.iter().fold(worst[0], |most, off| most.max(off.abs()));
        if let Some(last) = &last {
            // What changes at once beside what the turn of the sun changes.
            let jump = off.iter().zip(last).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            worst[1] = worst[1].max(jump);
        }
        last = Some(off);
    }
    eprintln!("off by {:.4} of the brightest, in one step {:.4}", worst[0], worst[1]);
    assert!(worst.iter().all(|off| *off < 1.0 / 255.0), "{worst:?}");
}
