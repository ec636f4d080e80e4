//! Fractus: shreds that the wind tears, each drawn out along it.

use glam::{DQuat, DVec3};

use super::pile::{Lump, Part, Pile, mixed};
use super::Growth;
use crate::scene::dice::Dice;

/// Patches where all of the width is covered.
const PATCHES: f64 = 14.0;

/// Grows patches of shreds.
pub(super) fn tear(growth: &Growth, pile: &mut Pile) {
    let key = mixed(u64::from(growth.seed), 11);
    let patches = (PATCHES * growth.coverage).round().max(1.0) as u64;
    for i in 0..patches {
        patch(growth, mixed(key, i), pile);
    }
}

/// A walk downwind and upwards; each step a shred that hangs together with the one before.
fn patch(growth: &Growth, key: u64, pile: &mut Pile) {
    let dice = &mut Dice::new(key);
    let half = 0.5 * growth.width;
    let mut at = dice.disc() * DVec3::new(half, 0.0, 0.6 * half);
    at.y = growth.height * dice.between(0.2, 0.55);
    let large = half * dice.between(0.1, 0.24);
    let steps = dice.count(14, 34) as u64;
    for step in 0..steps {
        let along = step as f64 / steps as f64;
        let size = large * (1.0 - 0.6 * along) * dice.between(0.45, 1.0);
        let radii = size * DVec3::new(dice.between(1.1, 2.0), dice.between(0.35, 0.6), dice.between(0.6, 1.0));
        at.y = at.y.max(radii.y);
        let turn = tilted(dice, growth.lean);
        let key = mixed(key, step);
        pile.put(Lump { center: at, radii, turn, size, generation: 0, part: Part::Shred, key });
        let way = DVec3::new(dice.between(-0.6, 1.0), dice.between(-0.25, 0.4), dice.between(-0.6, 0.6));
        at += 0.75 * size * way;
        at.x += 0.4 * growth.lean * size * dice.unit();
        at.y = at.y.min(growth.height - 0.5 * size);
    }
}

/// A turn about the vertical by chance, and down the wind by the shear.
fn tilted(dice: &mut Dice, lean: f64) -> DQuat {
    let tilt = 0.5 * lean.clamp(-1.0, 1.0) * dice.between(0.2, 0.9);
    // Half the angle whose tangent is about twice `tilt`, about z.
    let pitch = DQuat::from_xyzw(0.0, 0.0, 0.5 * tilt, 1.0).normalize();
    let slew = DQuat::from_xyzw(0.0, 0.3 * dice.between(-1.0, 1.0), 0.0, 1.0).normalize();
    slew * pitch
}
