//! Fractus: shreds that the wind tears, each drawn out along it.

use glam::{DQuat, DVec3};

use super::Growth;
use super::pile::{Lump, Part, Pile, mixed};
use crate::scene::dice::Dice;

/// Patches where all of the width is covered.
const PATCHES: f64 = 22.0;

/// Shreds of the first patch; smaller ones have fewer.
const SHREDS: f64 = 64.0;

/// Most shreds of one cloud.
const MOST: u64 = 480;

/// Grows patches of shreds.
pub(super) fn tear(growth: &Growth, pile: &mut Pile) {
    let key = mixed(u64::from(growth.seed), 11);
    let patches = (PATCHES * growth.coverage).round().max(1.0) as u64;
    for i in 0..patches {
        patch(growth, mixed(key, i), i, pile);
    }
}

/// A chain of shreds that the shear draws out: each hangs on the one before.
fn patch(growth: &Growth, key: u64, rank: u64, pile: &mut Pile) {
    let dice = &mut Dice::new(key);
    let half = 0.5 * growth.width;
    let mut middle = dice.disc() * DVec3::new(0.85 * half, 0.0, 0.5 * half);
    // Few are large.
    let share = if rank == 0 { 1.0 } else { 0.25 + 0.6 * dice.unit() * dice.unit() };
    let large = 0.36 * half * share;
    middle.y = growth.height * dice.between(0.15, 0.75);
    let tall = (0.42 * growth.height).min(0.5 * large);
    let shreds = (3.0 + SHREDS * (0.1 + 0.9 * growth.detail) * share) as u64;
    let mut last = (middle, 0.2 * large);
    for i in 0..shreds {
        if pile.lumps().len() as u64 >= MOST {
            return;
        }
        let dice = &mut Dice::new(mixed(key, i));
        let fine = dice.unit();
        let size = 0.3 * half * share.sqrt() * (0.1 + 0.35 * fine * fine);
        let back = (middle - last.0) * if i % 7 == 6 { 0.7 } else { 0.05 };
        let way = dice.sphere() * DVec3::new(1.5, 0.55, 0.9);
        let mut at = last.0 + 0.85 * last.1.min(size) * way + back.clamp_length_max(1.2 * last.1);
        at.y = at.y.clamp(middle.y - tall, middle.y + tall).max(0.3 * size);
        // What is higher is farther downwind.
        at.x += growth.lean * 0.8 * (at.y - last.0.y);
        let radii =
            size * DVec3::new(dice.between(1.1, 2.0), dice.between(0.45, 0.75), dice.between(0.7, 1.1));
        let lump = Lump {
            center: at,
            radii,
            turn: tilted(dice, growth.lean),
            size,
            generation: 0,
            part: Part::Shred,
            key: mixed(key, 1000 + i),
        };
        pile.put(lump);
        last = (at, size);
    }
}

/// A turn about the vertical by chance, and up the wind's shear.
fn tilted(dice: &mut Dice, lean: f64) -> DQuat {
    // Halves of small angles.
    let pitch = 0.4 * lean.clamp(-1.0, 1.0) * dice.between(-0.25, 1.0);
    let slew = 0.3 * dice.between(-1.0, 1.0);
    DQuat::from_xyzw(0.0, slew, 0.0, 1.0).normalize() * DQuat::from_xyzw(0.0, 0.0, pitch, 1.0).normalize()
}
