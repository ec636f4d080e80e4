//! The anvil of a thunderstorm: an overshooting top, sheets of ice that spread downwind, fibres, mammatus.

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::Growth;
use super::heading::along;
use super::pile::{Brood, Lump, Part, Pile, mixed};
use crate::scene::dice::Dice;

const SHEETS: u64 = 110;
const FIBRES: u64 = 320;
const POUCHES: u64 = 150;

/// Height of the anvil's underside, of the storm's.
const DECK: f64 = 0.84;

/// Grows the anvil on the tower.
pub(super) fn spread(growth: &Growth, pile: &mut Pile) {
    let top = summit(pile);
    let key = mixed(u64::from(growth.seed), 7);
    overshoot(growth, top, key, pile);
    let first = pile.lumps().len();
    sheets(growth, top, key, pile);
    let sheets = first..pile.lumps().len();
    fibres(growth, sheets.clone(), mixed(key, 2), pile);
    pouches(growth, sheets, mixed(key, 3), pile);
}

/// Middle of the highest lump.
fn summit(pile: &Pile) -> DVec3 {
    let tops = pile.lumps().iter().map(|lump| (lump.center.y + lump.radii.y, lump.center));
    tops.fold((0.0, DVec3::ZERO), |best, top| if top.0 > best.0 { top } else { best }).1
}

/// The dome of the strongest updraught, above the anvil.
fn overshoot(growth: &Growth, top: DVec3, key: u64, pile: &mut Pile) {
    let size = 0.13 * growth.width;
    let first = pile.lumps().len();
    for (i, lift) in [(0, -0.9), (1, 0.0), (2, 0.35)] {
        let center = DVec3::new(top.x + 0.2 * lift * size, growth.height - (1.1 - lift) * size, top.z);
        let radii = size * DVec3::new(1.25 - 0.4 * lift, 0.95 - 0.4 * lift.abs(), 1.2 - 0.4 * lift);
        let key = mixed(key, 50 + i);
        pile.put(Lump { center, radii, turn: DQuat::IDENTITY, size, generation: 0, part: Part::Heap, key });
    }
    let least = growth.least(0.0);
    let brood = Brood { tries: 20, ratio: (0.25, 0.45), seat: 0.82, lowest: -0.1, least };
    let parents = first..pile.lumps().len();
    let next = parents.end;
    pile.grow(parents, &brood);
    let parents = next..pile.lumps().len();
    pile.grow(parents, &Brood { tries: 6, ..brood });
}

/// Flat sheets one over the other: a funnel out of the tower, then widening downwind and thinning.
fn sheets(growth: &Growth, top: DVec3, key: u64, pile: &mut Pile) {
    let wide = growth.width;
    for i in 0..SHEETS {
        let dice = &mut Dice::new(mixed(key, 100 + i));
        let along = i as f64 / (SHEETS - 1) as f64;
        let jitter = dice.disc();
        // Near the tower it is thick and reaches farther down: what spreads there has just risen.
        let near = (1.0 - 2.0 * along).max(0.0);
        let center = DVec3::new(
            top.x - 0.45 * wide + 2.2 * wide * along + 0.12 * wide * jitter.x,
            growth.height * (DECK + 0.05 * along) + wide * (0.02 * dice.unit() - 0.05 * near * dice.unit()),
            top.z + wide * (0.3 + 0.3 * along) * jitter.z,
        );
        let thin = 0.008 + 0.06 * (1.0 - along) * (1.0 - along);
        let radii = wide
            * DVec3::new(
                dice.between(0.2, 0.36),
                thin * dice.between(0.6, 1.1),
                dice.between(0.12, 0.24) * (1.0 - 0.3 * along) * (1.0 + 0.6 * near),
            );
        let size = wide * (0.9 - 0.8 * along);
        let turn = out_from(top, wide, center);
        pile.put(Lump {
            center,
            radii,
            turn,
            size,
            generation: 0,
            part: Part::Ice,
            key: mixed(key, 900 + i),
        });
    }
}

/// The turn of what the wind above draws out of the tower: it spreads like a fan.
fn out_from(top: DVec3, wide: f64, center: DVec3) -> DQuat {
    let source = top - DVec3::X * 1.6 * wide;
    along((center - source).with_y(0.0))
}

/// Long thin threads that reach beyond the sheets.
fn fibres(growth: &Growth, sheets: Range<usize>, key: u64, pile: &mut Pile) {
    for i in 0..FIBRES {
        let dice = &mut Dice::new(mixed(key, i));
        // More of them downwind.
        let far = 1.0 - dice.unit() * dice.unit();
        let Some(sheet) = sheet(pile, &sheets, far) else { continue };
        let seat = DVec3::new(dice.between(0.1, 0.95), dice.between(-0.6, 0.7), dice.between(-0.95, 0.95));
        let inside = seat / seat.length().max(1.0);
        let center = sheet.center + sheet.turn * (inside * sheet.radii * 0.95);
        let long = growth.width * dice.between(0.06, 0.26);
        let radii =
            DVec3::new(long, growth.width * dice.between(0.0025, 0.007), long * dice.between(0.03, 0.08));
        let (turn, size, key) = (sheet.turn, 0.35 * sheet.size, mixed(key, i));
        pile.put(Lump { center, radii, turn, size, generation: 1, part: Part::Ice, key });
    }
}

/// Mammatus: pouches that sink out of the sheets, in patches downwind of the tower.
fn pouches(growth: &Growth, sheets: Range<usize>, key: u64, pile: &mut Pile) {
    for i in 0..POUCHES {
        let dice = &mut Dice::new(mixed(key, i));
        let Some(sheet) = sheet(pile, &sheets, dice.between(0.12, 0.6)) else { continue };
        let flat = 0.75 * dice.disc();
        let under = -(1.0 - flat.length_squared()).max(0.0).sqrt();
        let seat = DVec3::new(flat.x, under, flat.z);
        let size = growth.width * dice.between(0.012, 0.024);
        let center = sheet.center + sheet.turn * (seat * sheet.radii) - DVec3::Y * 0.25 * size;
        let radii = size * DVec3::new(1.1, dice.between(0.8, 1.1), 1.1);
        let (turn, key) = (DQuat::IDENTITY, mixed(key, i));
        pile.put(Lump { center, radii, turn, size, generation: 2, part: Part::Pouch, key });
    }
}

/// The sheet that is `far` along from the tower, 0 to 1.
fn sheet(pile: &Pile, sheets: &Range<usize>, far: f64) -> Option<Lump> {
    let index = sheets.start + (far * sheets.len() as f64) as usize;
    pile.lumps()[..sheets.end].get(index).cloned()
}
