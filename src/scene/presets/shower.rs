//! Rain under a cloud, and the bow in it.

use glam::DVec3;

use super::{camera, heap::tenths, weather};
use crate::scene::dice::Dice;
use crate::scene::{
    Camera, Cloud, Droplets, Edge, Ellipsoid, Growth, GrowthKind, Noise, Projection, Scene, Species,
    SunPosition,
};

/// Where the cloud's base is, metres.
const BASE: f64 = 1500.0;

/// Middle of the cloud and of the curtain under its near side, which the sun reaches, metres in front of the camera.
const CLOUD: f64 = 8200.0;
const RAIN: f64 = 5600.0;

/// A towering cumulus, and a curtain of rain from its base to the ground.
pub(super) fn clouds(dice: &mut Dice, seed: u32) -> Vec<Cloud> {
    let place = DVec3::new(0.0, BASE, -CLOUD);
    let growth = Growth {
        place,
        width: 9500.0,
        height: 5000.0,
        coverage: 0.9,
        ..Growth::new(GrowthKind::Congestus, seed)
    };
    vec![weather::cloud("shower", growth), rain(dice)]
}

/// Shafts side by side, two deep, of drops of half a millimetre: 0.6 g in each cubic metre, some 12 mm an hour.
fn rain(dice: &mut Dice) -> Cloud {
    const ACROSS: i32 = 11;
    let shaft = |i: i32| {
        let across = f64::from(i % ACROSS - ACROSS / 2) * 800.0 + dice.between(-200.0, 200.0);
        let back = f64::from(i / ACROSS) * 1300.0 + dice.between(-250.0, 250.0);
        let wide = dice.between(750.0, 1050.0);
        // Tall enough for the walls to be upright between the ground and the base.
        let center = DVec3::new(across, 0.5 * BASE, -back - RAIN);
        Ellipsoid::new(tenths(center), tenths(DVec3::new(wide, BASE, 0.9 * wide)))
    };
    let noise = Noise { scale: Some(900.0), ..Noise::default() };
    Cloud {
        name: "rain".to_owned(),
        ellipsoids: (0..2 * ACROSS).map(shaft).collect(),
        droplets: Droplets::of_mass(Species::Rain, 0.6),
        edge: Edge { boundary: 400.0, wispiness: 1.0 },
        blend: 1.0,
        noise: Some(noise),
        ..Cloud::default()
    }
}

/// From the ground, the sun 27 degrees high behind: the top of the bow is 15 degrees high, under the base.
pub(super) fn look_at_the_bow(scene: &mut Scene) {
    scene.sun.position = SunPosition::Angles { azimuth_deg: 180.0, elevation_deg: 27.0 };
    let eye = DVec3::new(0.0, scene.ground.altitude + 1.7, 0.0);
    scene.camera = Some(Camera {
        projection: Projection::Perspective { vertical_fov_deg: 52.0 },
        ..camera(eye, eye + DVec3::new(0.0, 310.0, -1000.0))
    });
}
