//! A sky in motion: fair-weather cumuli that form, drift and dissolve, ten seconds that never end.

use glam::DVec3;

use super::{Scene, camera, weather};
use crate::scene::dice::Dice;
use crate::scene::{Cloud, Growth, GrowthKind, Life, Timeline};

/// Length of the loop, s.
const ROUND: f64 = 10.0;
/// How long a cloud is seen, s.
const SPAN: f64 = 8.0;
/// How often a minute their billows make way for others, as in time-lapse.
const RATE: f64 = 24.0;
/// Where the clouds are half way through their lives, m: no two that are young at a time are neighbours.
const PLACES: [(f64, f64); 5] =
    [(-520.0, 60.0), (210.0, -260.0), (-150.0, -700.0), (560.0, 140.0), (-60.0, 330.0)];

/// Five clouds, each of them two seconds younger than the one before.
pub(super) fn clouds(dice: &mut Dice) -> Vec<Cloud> {
    let cloud = |(i, (x, z)): (usize, (f64, f64))| {
        let growth = Growth {
            place: DVec3::new(x, 1000.0, z),
            width: dice.between(480.0, 680.0).round(),
            detail: 0.8,
            ..Growth::new(GrowthKind::Humilis, (dice.unit() * 1e9) as u32)
        };
        let mut cloud = weather::cloud(&format!("cumulus {}", i + 1), growth);
        if let Some(noise) = &mut cloud.noise {
            noise.rate = RATE;
        }
        let birth = ROUND * i as f64 / PLACES.len() as f64;
        let death = (birth + SPAN) % ROUND;
        cloud.life = Some(Life { birth, death, forming: 3.0, dissolving: 3.5 });
        cloud
    };
    PLACES.into_iter().enumerate().map(cloud).collect()
}

/// Wind as in time-lapse.
pub(super) fn set_in_motion(scene: &mut Scene) {
    scene.wind.velocity = DVec3::new(22.0, 0.0, 4.0);
    scene.camera = Some(camera(DVec3::new(0.0, 640.0, 1650.0), DVec3::new(0.0, 1030.0, 0.0)));
    scene.timeline = Some(Timeline { length: ROUND, looped: true, ..Timeline::default() });
}
