//! Every preset, under suns from the zenith to below the horizon and from cameras around,
//! below and inside: finite, never negative, and where it should be.
#![cfg(feature = "export")]

use crate::common;

use common::picture::{draw, in_coarse_light, renderer};
use glam::DVec3;
use nephos::{
    render::{Quality, Transport},
    scene::{Camera, Preset, Scene, SunPosition},
};

const SIZE: [u32; 2] = [48, 27];

fn suns() -> [SunPosition; 3] {
    [(200.0, 90.0), (10.0, 1.0), (90.0, -3.0)]
        .map(|(azimuth_deg, elevation_deg)| SunPosition::Angles { azimuth_deg, elevation_deg })
}

/// The preset's own camera, one below looking up (of layers, above looking down), one inside.
fn cameras(scene: &Scene) -> Vec<Camera> {
    let look = |position: DVec3, target: DVec3| Camera { position, target, ..scene.camera() };
    if let Some(layer) = scene.layers().next() {
        let inside = DVec3::Y * (layer.base + 0.4 * layer.thickness);
        let above = DVec3::Y * (layer.base + 2.0 * layer.thickness + 500.0);
        let ahead = DVec3::new(100.0, 20.0, -50.0);
        return vec![
            scene.camera(),
            look(above, above + ahead - DVec3::Y * 60.0),
            look(inside, inside + ahead),
        ];
    }
    let (min, max) = scene.bounds().unwrap();
    let middle = 0.5 * (min + max);
    let inside = scene.clouds[0].ellipsoids[0].center;
    vec![
        scene.camera(),
        look(middle.with_y(min.y - 300.0), middle),
        look(inside, inside + DVec3::new(100.0, 20.0, -50.0)),
    ]
}

#[test]
fn light_is_finite_and_never_negative() {
    let quality = Quality { light_resolution: 16, light_cells: 8, shadow_texels: 32, ..Quality::DRAFT };
    let mut renderer = renderer(quality, Transport::default());
    // The clouds of a field are of kinds that are here by themselves; all of them take minutes.
    let presets = Preset::ALL.into_iter().filter(|preset| *preset != Preset::Field);
    // Each under one sun in turn: light stays when only the camera moves.
    for (preset, sun) in presets.zip(suns().into_iter().cycle()) {
        let mut scene = preset.scene(3);
        let cameras = cameras(&scene);
        scene.sun.position = sun;
        for camera in cameras {
            scene.camera = Some(camera);
            let picture = draw(&mut renderer, &scene, SIZE, true);
            for pixel in &picture.pixels {
                let good = pixel.iter().all(|c| c.is_finite() && *c >= 0.0) && pixel[3] <= 1.0;
                assert!(good, "{preset} under {:?} from {:?}: {pixel:?}", scene.sun, scene.camera);
            }
        }
    }
}

#[test]
fn presets_are_in_their_picture() {
    // What is covered has nothing to do with light.
    let mut renderer = renderer(Quality::DRAFT, Transport::EMITTER);
    for preset in Preset::ALL {
        let scene = preset.scene(1);
        let picture = draw(&mut renderer, &scene, SIZE, false);
        let cover = picture.pixels.iter().map(|pixel| pixel[3]).sum::<f32>() / picture.pixels.len() as f32;
        let wide = preset == Preset::Glory || scene.layers().next().is_some();
        let expected = if wide { 0.1..=1.0 } else { 0.02..=0.75 };
        assert!(expected.contains(&cover), "{preset} covers {cover}");
    }
}

#[test]
fn every_preset_is_lit_from_where_the_sun_is() {
    // The sun in the east lights the eastern (right) half of what a camera in the south sees.
    let mut renderer = renderer(in_coarse_light(Quality::DRAFT), Transport::default());
    for preset in [Preset::Kol, Preset::Sphere, Preset::Mediocris] {
        let mut scene = preset.scene(1);
        let mut sides = |azimuth_deg: f64| {
            scene.sun.position = SunPosition::Angles { azimuth_deg, elevation_deg: 20.0 };
            let picture = draw(&mut renderer, &scene, SIZE, false);
            let side = |right: bool| -> f32 {
                let half = |i: &usize| (i % picture.width >= picture.width / 2) == right;
                let (light, alpha) = (0..picture.pixels.len())
                    .filter(half)
                    .fold((0.0, 0.0), |(l, a), i| (l + picture.pixels[i][1], a + picture.pixels[i][3]));
                light / alpha
            };
            side(true) / side(false)
        };
        let (east, west) = (sides(90.0), sides(270.0));
        assert!(east > 1.1 * west, "{preset}: {east} {west}");
    }
}
