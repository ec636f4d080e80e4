//! Where air rises in a thunderstorm: one great updraught, shoulders around it, turrets that step down upshear.

use glam::DVec3;

use super::Growth;
use super::pile::mixed;
use super::plumes::{Plume, RISE};
use crate::scene::dice::Dice;

/// Highest point of the turrets, of the storm's height: what is above is left to the dome and the anvil.
const CEILING: f64 = 0.84;

/// Depth of the base against its width.
const DEPTH: f64 = 0.75;

/// Shoulders of the great updraught.
const SHOULDERS: u64 = 7;

/// Turrets in the line of flank clouds.
const STEPS: u64 = 7;

/// Low plumes between all of them.
const LOW: f64 = 22.0;

/// Turrets of a storm, the great one first.
pub(super) fn plan(growth: &Growth) -> Vec<Plume> {
    let key = mixed(u64::from(growth.seed), 1 + growth.kind as u64);
    let dice = &mut Dice::new(key);
    let half = 0.5 * growth.width;
    let tall = growth.height * CEILING * (1.0 - 0.3 * growth.age * growth.age);
    let side = if dice.unit() < 0.5 { -1.0 } else { 1.0 };
    let core = DVec3::new(0.14 * half, 0.0, 0.0) + 0.08 * half * dice.disc();
    let plume = |foot, height, radius, waist, turn| Plume {
        foot,
        height,
        radius,
        rise: RISE,
        waist,
        lean: DVec3::ZERO,
        key: mixed(key, turn),
    };
    let mut plumes = vec![plume(core, tall, half * dice.between(0.5, 0.6), 0.25, 100)];
    for i in 0..SHOULDERS {
        let dice = &mut Dice::new(mixed(key, 300 + i));
        let away = half * DVec3::new(1.0, 0.0, DEPTH) * dice.cap(0.0).with_y(0.0).normalize_or(DVec3::X);
        let far = dice.between(0.3, 0.68);
        // The farther out the lower.
        let height = tall * (0.98 - 0.6 * far) * dice.between(0.55, 1.04);
        let radius = half * dice.between(0.24, 0.37);
        plumes.push(plume(core + far * away, height, radius, 0.3, 400 + i));
    }
    for i in 0..STEPS {
        let dice = &mut Dice::new(mixed(key, 500 + i));
        let step = (i as f64 + dice.between(0.2, 0.9)) / STEPS as f64;
        let way = DVec3::new(-0.4 - 0.85 * step, 0.0, side * 0.24 * step + 0.28 * dice.between(-1.0, 1.0));
        let height = tall * (0.62 - 0.5 * step) * dice.between(0.7, 1.15);
        let radius = half * (0.3 - 0.13 * step) * dice.between(0.85, 1.15);
        plumes.push(plume(core + half * way, height, radius, 0.32, 600 + i));
    }
    for i in 0..(LOW * growth.coverage / 0.7).round() as u64 {
        let dice = &mut Dice::new(mixed(key, 1000 + i));
        let foot = half * DVec3::new(1.0, 0.0, DEPTH) * dice.disc() * 0.9;
        let out = (foot - core).length() / half;
        let height = tall * dice.between(0.08, 0.2) * (1.25 - 0.6 * out).max(0.4);
        let radius = half * dice.between(0.16, 0.3) * (1.0 - 0.3 * out).max(0.5);
        plumes.push(plume(foot, height, radius, 0.2, 2000 + i));
    }
    plumes
}
