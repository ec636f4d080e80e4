//! Auto exposure: what it depends on and what not, and where it puts the light of clouds.
#![cfg(feature = "export")]

use crate::common;

use common::{
    gpu,
    picture::{draw, in_coarse_light, renderer, scene},
};
use nephos::{
    render::{Frame, Quality, Renderer, Transport},
    scene::{Preset, Scene, SunPosition, Tone, ToneCurve},
};

const SIZE: [u32; 2] = [96, 54];

/// A small cumulus in sun from the side, under a sky.
fn cumulus() -> Scene {
    let mut scene = Preset::Humilis.scene(1);
    scene.sun.position = SunPosition::Angles { azimuth_deg: 270.0, elevation_deg: 30.0 };
    scene
}

fn meter(renderer: &mut Renderer, scene: &Scene, size: [u32; 2]) -> f64 {
    renderer.meter(gpu(), &Frame::new(scene, size).unwrap()).unwrap()
}

fn draft() -> Renderer {
    renderer(Quality::DRAFT, Transport::default())
}

/// As a screen shows it, exposed by what is metered: RGBA of 8 bits.
fn shown(renderer: &mut Renderer, scene: &Scene) -> Vec<u8> {
    let own = scene.tone();
    let tone = Tone { stops: own.stops + meter(renderer, scene, SIZE), ..own };
    draw(renderer, scene, SIZE, true).finished(gpu(), renderer, tone).unwrap()
}

#[test]
fn the_same_moment_is_exposed_the_same_whatever_was_drawn_before_and_in_all_sizes() {
    let scene = cumulus();
    let first = meter(&mut draft(), &scene, SIZE);
    let mut used = draft();
    draw(&mut used, &Preset::Congestus.scene(3), SIZE, true);
    assert_eq!(meter(&mut used, &scene, SIZE), first);
    assert_eq!(meter(&mut used, &scene, SIZE), first, "a second time");
    // One shape has one draft, but for the rounding of a pixel's width.
    assert!((meter(&mut used, &scene, [1920, 1080]) - first).abs() < 1e-5);
    // Another shape shows more of the sky.
    let square = meter(&mut used, &scene, [200, 200]);
    assert!((square - first).abs() < 0.3, "{square} {first}");
}

#[test]
fn finer_light_is_exposed_about_the_same() {
    let scene = cumulus();
    let [draft, preview, last] = [Quality::DRAFT, Quality::PREVIEW, Quality::FINAL]
        .map(|quality| meter(&mut renderer(quality, Transport::default()), &scene, SIZE));
    // Light of a draft is up to a fifth darker: a quarter of a stop.
    assert!((draft - last).abs() < 0.35 && (preview - last).abs() < 0.15, "{draft} {preview} {last}");
}

#[test]
fn ten_times_the_sun_makes_the_same_picture() {
    let scene = cumulus();
    let mut bright = scene.clone();
    bright.sun.irradiance = scene.sun.irradiance.map(|x| 10.0 * x);
    let mut renderer = draft();
    let stops = [&scene, &bright].map(|scene| meter(&mut renderer, scene, SIZE));
    // Half floats have 11 bits.
    assert!((stops[0] - stops[1] - 10f64.log2()).abs() < 2e-3, "{stops:?}");
    let [dim, bright] = [&scene, &bright].map(|scene| shown(&mut renderer, scene));
    let worst = dim.iter().zip(&bright).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst <= Some(2), "{worst:?} of 255");
    assert!(dim.iter().max() > Some(&200), "there is something to be seen");
}

#[test]
fn lit_faces_use_the_upper_part_of_the_display_with_the_sun_at_the_side_low_and_behind() {
    for (azimuth_deg, elevation_deg) in
        [(270.0, 30.0), (100.0, 30.0), (270.0, 2.0), (0.0, 20.0), (180.0, 75.0)]
    {
        let mut scene = Preset::Congestus.scene(1);
        scene.sun.position = SunPosition::Angles { azimuth_deg, elevation_deg };
        let mut renderer = renderer(in_coarse_light(Quality::DRAFT), Transport::default());
        let alpha: Vec<f32> =
            draw(&mut renderer, &scene, SIZE, false).pixels.iter().map(|pixel| pixel[3]).collect();
        let bytes = shown(&mut renderer, &scene);
        // The brightest channel of pixels that are cloud alone.
        let cloud = bytes.chunks(4).zip(&alpha).filter(|(_, alpha)| **alpha > 0.95);
        let mut faces: Vec<u8> = cloud.map(|(pixel, _)| pixel[..3].iter().copied().max().unwrap()).collect();
        faces.sort_unstable();
        let at = |share: f64| f64::from(faces[(share * faces.len() as f64) as usize]) / 255.0;
        let (middle, bright) = (at(0.5), at(0.9));
        eprintln!("{azimuth_deg} {elevation_deg}: {middle:.3} {bright:.3}");
        assert!(middle > 0.5 && middle < 0.93, "{azimuth_deg} {elevation_deg}: {middle}");
        // The red of a low sun's clouds comes close to all that a display has.
        assert!(bright > 0.75 && bright < 0.999, "{azimuth_deg} {elevation_deg}: {bright}");
    }
}

#[test]
fn a_low_sun_stays_red_by_the_curve_that_scenes_have_and_turns_yellow_by_film() {
    // Light of a cloud 2 degrees below the sun, measured, from dim to overexposed.
    let hue = |curve| {
        let light = [0.25f32, 0.12, 0.06].map(|x| 0.5 * x);
        // Many pixels: bytes are dithered.
        let picture = nephos::render::Picture {
            width: 16,
            height: 16,
            pixels: vec![[light[0], light[1], light[2], 1.0]; 256],
        };
        let bytes = picture.finished(gpu(), &mut draft(), Tone { stops: 1.0, curve }).unwrap();
        let linear = |byte: u8| ((f64::from(byte) / 255.0 + 0.055) / 1.055).powf(2.4);
        let [r, g, b] =
            [0, 1, 2].map(|c| bytes.iter().skip(c).step_by(4).map(|&byte| linear(byte)).sum::<f64>());
        (g - b) / (r - b)
    };
    let (scene, natural, filmic) =
        ((0.12 - 0.06) / (0.25 - 0.06), hue(ToneCurve::default()), hue(ToneCurve::Filmic));
    assert!((natural - scene).abs() < 0.02, "{natural} {scene}");
    assert!(filmic > scene + 0.1, "{filmic} {scene}");
}

#[test]
fn an_empty_sky_is_exposed_and_nothing_at_all_is_left_alone() {
    let mut renderer = draft();
    let empty = meter(&mut renderer, &scene("{}"), SIZE);
    assert!((-1.0..3.0).contains(&empty), "{empty}");
    assert_eq!(meter(&mut renderer, &scene(r#"{"sky": "none"}"#), SIZE), 0.0);
    // Night is no day.
    let mut night = scene("{}");
    night.sun.position = SunPosition::Angles { azimuth_deg: 0.0, elevation_deg: -12.0 };
    let night = meter(&mut renderer, &night, SIZE);
    assert!(night < 6.5 && night > empty, "{night}");
}

#[test]
fn metering_makes_the_light_that_the_picture_needs_and_no_other() {
    let scene = cumulus();
    let mut metered = draft();
    meter(&mut metered, &scene, SIZE);
    draw(&mut metered, &scene, SIZE, true);
    let mut plain = draft();
    draw(&mut plain, &scene, SIZE, true);
    // The air in front of the camera is made for each size.
    let (with, without) = (metered.light_updates(), plain.light_updates());
    assert!(with <= without + 2, "{with} {without}");
    assert_eq!(metered.settings, plain.settings);
}
