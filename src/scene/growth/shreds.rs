//! Fractus: shreds that the wind tears, each drawn out along it.

use glam::{DQuat, DVec3};

use super::Growth;
use super::pile::{Lump, Part, Pile, mixed};
use crate::scene::dice::Dice;

/// Patches where all of the width is covered.
const PATCHES: f64 = 11.0;

/// Grows patches of shreds.
pub(super) fn tear(growth: &Growth, pile: &mut Pile) {
    let key = mixed(u64::from(growth.seed), 11);
    let patches = (PATCHES * growth.coverage).round().max(1.0) as u64;
    for i in 0..patches {
        patch(growth, mixed(key, i), i == 0, pile);
    }
}

/// A heap of shreds, thick in the middle, with threads that the shear draws out of it.
fn patch(growth: &Growth, key: u64, first: bool, pile: &mut Pile) {
    let dice = &mut Dice::new(key);
    let half = 0.5 * growth.width;
    let mut middle = dice.disc() * DVec3::new(0.85 * half, 0.0, 0.5 * half);
    let large = if first { 0.3 * half } else { half * dice.between(0.1, 0.24) };
    middle.y = growth.height * dice.between(0.25, 0.5);
    let tall = (0.5 * growth.height).min(0.6 * large);
    let shreds = (10.0 + 34.0 * growth.detail * large / (0.3 * half)) as u64;
    let mut last = (middle, 0.5 * large);
    for i in 0..shreds {
        let dice = &mut Dice::new(mixed(key, i));
        let size = large * dice.between(0.16, 0.42) * if i < 6 { 1.3 } else { 1.0 };
        // Each hangs on the one before, drawn to the middle where it went far.
        let back = (middle - last.0) * if i % 5 == 4 { 0.8 } else { 0.12 };
        let way = dice.sphere() * DVec3::new(1.0, 0.55, 0.8);
        let mut at = last.0 + 0.8 * last.1.min(size) * way + back.clamp_length_max(last.1);
        at.y = at.y.clamp(middle.y - tall, middle.y + tall).max(0.3 * size);
        // What is higher is farther downwind.
        at.x += growth.lean * 0.5 * (at.y - last.0.y);
        let drawn = dice.between(1.0, 1.7);
        let radii = size * DVec3::new(drawn, dice.between(0.5, 0.85), dice.between(0.7, 1.0));
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
    let pitch = 0.25 * lean.clamp(-1.0, 1.0) * dice.between(-0.2, 1.0);
    let slew = 0.3 * dice.between(-1.0, 1.0);
    DQuat::from_xyzw(0.0, slew, 0.0, 1.0).normalize() * DQuat::from_xyzw(0.0, 0.0, pitch, 1.0).normalize()
}
