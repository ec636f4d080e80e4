//! A sky in motion: fair-weather cumuli that form, drift and dissolve, ten seconds that never end.

use glam::DVec3;

use super::{Scene, camera, weather};
use crate::scene::dice::Dice;
use crate::scene::timeline::{Key, Timeline, Track};
use crate::scene::{Cloud, Growth, GrowthKind, Life};

/// Length of the loop, s.
const ROUND: f64 = 10.0;
/// How long a cloud is seen, s.
const SPAN: f64 = 8.0;
/// Where the clouds are half way through their lives, m: no two that are young at a time are neighbours.
const PLACES: [(f64, f64); 5] =
    [(-520.0, 60.0), (210.0, -260.0), (-150.0, -700.0), (560.0, 140.0), (-60.0, 330.0)];

/// Five clouds, each of them two seconds younger than the one before.
pub(super) fn clouds(dice: &mut Dice) -> Vec<Cloud> {
    let cloud = |(i, (x, z)): (usize, (f64, f64))| {
        let growth = Growth {
            place: DVec3::new(x, 1000.0, z),
            width: dice.between(380.0, 520.0).round(),
            detail: 0.5,
            ..Growth::new(GrowthKind::Humilis, (dice.unit() * 1e9) as u32)
        };
        let mut cloud = weather::cloud(&format!("cumulus {}", i + 1), growth);
        // It drifts through the noise of the scene, so that its billows change.
        cloud.noise = None;
        let birth = ROUND * i as f64 / PLACES.len() as f64;
        let death = (birth + SPAN) % ROUND;
        cloud.life = Some(Life { birth, death, forming: 3.0, dissolving: 3.5 });
        cloud
    };
    PLACES.into_iter().enumerate().map(cloud).collect()
}

/// Wind as in time-lapse, and billows that boil on a closed way: two curves, a quarter of the round
/// apart, so that they never stand still together.
pub(super) fn set_in_motion(scene: &mut Scene) {
    scene.wind.velocity = DVec3::new(22.0, 0.0, 4.0);
    scene.camera = Some(camera(DVec3::new(0.0, 640.0, 1650.0), DVec3::new(0.0, 1030.0, 0.0)));
    let swing = |path: &str, start: f64, far: f64| Track {
        path: path.to_owned(),
        keys: vec![Key::new(start, far), Key::new(start + 0.5 * ROUND, -far)],
    };
    scene.timeline = Some(Timeline {
        length: ROUND,
        looped: true,
        tracks: vec![swing("noise.offset[1]", 0.0, 6.0), swing("noise.evolution", 0.25 * ROUND, 5.0)],
        ..Timeline::default()
    });
}
