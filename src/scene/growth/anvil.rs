//! The anvil of a thunderstorm: an overshooting top, sheets of ice that spread downwind, fibres, mammatus.

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::Growth;
use super::heading::along;
use super::pile::{Brood, Lump, Part, Pile, mixed};
use crate::scene::dice::Dice;

const SHEETS: u64 = 150;
const FIBRES: u64 = 320;
const POUCHES: u64 = 700;

/// Height of the anvil's flat top, of the storm's.
const CEILING: f64 = 0.84;

/// How far the anvil reaches downwind, upwind and across, of the storm's width.
const DOWNWIND: f64 = 1.8;
const UPWIND: f64 = 0.42;
const ACROSS: f64 = 0.75;

/// Grows the anvil on the tower.
pub(super) fn spread(growth: &Growth, pile: &mut Pile) {
    let top = summit(pile);
    let key = mixed(u64::from(growth.seed), 7);
    overshoot(growth, top, key, pile);
    let first = pile.lumps().len();
    sheets(growth, top, key, pile);
    let sheets = first..pile.lumps().len();
    fibres(growth, top, mixed(key, 2), pile);
    pouches(growth, top, sheets, mixed(key, 3), pile);
}

/// Middle of the highest lump.
fn summit(pile: &Pile) -> DVec3 {
    let tops = pile.lumps().iter().map(|lump| (lump.center.y + lump.radii.y, lump.center));
    tops.fold((0.0, DVec3::ZERO), |best, top| if top.0 > best.0 { top } else { best }).1
}

/// The dome of the strongest updraught, above the anvil.
fn overshoot(growth: &Growth, top: DVec3, key: u64, pile: &mut Pile) {
    let size = 0.15 * growth.width;
    let first = pile.lumps().len();
    for (i, aside, lift) in [(0, -0.2, -0.8), (1, -0.75, -0.35), (2, 0.7, -0.3), (3, 0.0, 0.15)] {
        let dice = &mut Dice::new(mixed(key, 40 + i));
        let aside = DVec3::new(aside, 0.0, 0.0) + 0.35 * dice.disc();
        let center = (top + size * aside).with_y(growth.height - (1.05 - lift) * size);
        let radii = size * DVec3::new(1.1 - 0.3 * lift, 0.9 - 0.3 * lift.abs(), 1.1 - 0.3 * lift);
        let key = mixed(key, 50 + i);
        pile.put(Lump { center, radii, turn: DQuat::IDENTITY, size, generation: 0, part: Part::Heap, key });
    }
    let least = growth.least(0.0);
    let brood = Brood { tries: 14, ratio: (0.28, 0.5), seat: 0.88, lowest: -0.1, least };
    let parents = first..pile.lumps().len();
    let next = parents.end;
    pile.grow(parents, &brood);
    let parents = next..pile.lumps().len();
    pile.grow(parents, &Brood { tries: 6, ..brood });
}

/// How far the anvil reaches from the tower in the horizontal direction of the unit vector `way`, of the storm's
/// width: an oval whose one focus is the tower.
fn reach(way: DVec3) -> f64 {
    let far = if way.x > 0.0 { DOWNWIND } else { UPWIND };
    let across = way.z / ACROSS;
    let ahead = way.x / far;
    1.0 / (across * across + ahead * ahead).sqrt()
}

/// Half the thickness of the anvil at a share of its reach in a horizontal direction, of the storm's width: it ends
/// blunt where it spreads against the wind, and thin downwind.
fn half_thickness(out: f64, way: DVec3) -> f64 {
    let inner = (1.0 - out).max(0.0);
    0.012 + 0.062 * inner * inner + 0.04 * out * (-way.x).max(0.0)
}

/// A place in the anvil: its share of the reach, a horizontal direction, and the place at its flat top.
fn place(growth: &Growth, top: DVec3, disc: DVec3, out: f64) -> (DVec3, DVec3) {
    // The disc drawn out to the oval.
    let stretch = if disc.x > 0.0 { DOWNWIND } else { UPWIND };
    let flat = DVec3::new(disc.x * stretch, 0.0, disc.z * ACROSS).normalize_or(DVec3::X);
    let at = top + out * reach(flat) * growth.width * flat;
    (flat, at.with_y(growth.height * CEILING))
}

/// The turn of what the wind above draws out of the tower: it spreads like a fan.
fn out_from(top: DVec3, wide: f64, at: DVec3) -> DQuat {
    let source = top - DVec3::X * 0.75 * wide;
    along((at - source).with_y(0.0))
}

/// Flat sheets that overlap under one level, thick at the tower, thin at the rim: the underside is a wedge.
fn sheets(growth: &Growth, top: DVec3, key: u64, pile: &mut Pile) {
    let wide = growth.width;
    for i in 0..SHEETS {
        let dice = &mut Dice::new(mixed(key, 100 + i));
        let disc = dice.disc();
        let out = (disc.length() * dice.between(0.8, 1.0)).min(0.92);
        let (flat, at) = place(growth, top, disc, out);
        // The wind draws out what it meets from behind.
        let drawn = 1.0 - 0.45 * out * (-flat.x).max(0.0);
        let radii = wide
            * DVec3::new(
                dice.between(0.3, 0.48) * (1.0 - 0.3 * out) * drawn,
                half_thickness(out, flat) * dice.between(0.8, 1.2),
                dice.between(0.2, 0.32) * (1.0 - 0.5 * out),
            );
        // Tops near one level.
        let center = at + DVec3::Y * (wide * 0.006 * dice.between(-1.0, 1.0) - radii.y);
        let size = wide * (1.0 - out);
        let turn = out_from(top, wide, center);
        let key = mixed(key, 900 + i);
        pile.put(Lump { center, radii, turn, size, generation: 0, part: Part::Ice, key });
    }
    // The neck, where the tower widens into it.
    for i in 0..9 {
        let dice = &mut Dice::new(mixed(key, 700 + i));
        let down = (i as f64 + 0.5) / 9.0;
        let radii = wide * DVec3::new(0.34 - 0.12 * down, 0.045, 0.3 - 0.1 * down) * dice.between(0.85, 1.1);
        let center = (top + wide * (0.06 * (1.0 - down) * DVec3::X + 0.07 * dice.disc()))
            .with_y(growth.height * CEILING - wide * (0.05 + 0.13 * down));
        let key = mixed(key, 800 + i);
        let (turn, size) = (DQuat::IDENTITY, wide);
        pile.put(Lump { center, radii, turn, size, generation: 0, part: Part::Ice, key });
    }
}

/// Long thin plumes of ice that the wind draws out of the rim.
fn fibres(growth: &Growth, top: DVec3, key: u64, pile: &mut Pile) {
    let wide = growth.width;
    for i in 0..FIBRES {
        let dice = &mut Dice::new(mixed(key, i));
        let disc = dice.disc();
        // More of them at the rim.
        let low = dice.unit();
        let out = 1.12 - 0.5 * low * low;
        let (flat, at) = place(growth, top, disc, out);
        if flat.x < -0.2 {
            continue;
        }
        let down = 0.5 + 0.5 * flat.x;
        let long = wide * dice.between(0.12, 0.2) * (1.0 + 1.1 * down * dice.unit());
        let radii = DVec3::new(long, wide * dice.between(0.007, 0.014), long * dice.between(0.07, 0.2));
        let center = at - DVec3::Y * (radii.y + wide * half_thickness(out, flat) * dice.between(-0.2, 0.8));
        let turn = out_from(top, wide, center);
        let (size, key) = (0.3 * wide * (1.2 - out), mixed(key, i));
        pile.put(Lump { center, radii, turn, size, generation: 1, part: Part::Ice, key });
    }
}

/// Mammatus: pouches that sink out of the sheets, in patches downwind of the tower.
fn pouches(growth: &Growth, top: DVec3, sheets: Range<usize>, key: u64, pile: &mut Pile) {
    let wide = growth.width;
    let sheets = pile.lumps()[sheets].to_vec();
    let mut taken: Vec<(DVec3, f64)> = Vec::new();
    for i in 0..POUCHES {
        let dice = &mut Dice::new(mixed(key, i));
        let size = wide * dice.between(0.024, 0.05);
        let at =
            top + wide * DVec3::new(dice.between(0.25, 1.25), 0.0, 0.55 * ACROSS * dice.between(-1.0, 1.0));
        let crowded = |(other, width): &(DVec3, f64)| other.distance(at) < 0.72 * (size + width);
        let Some(under) = underside(&sheets, at).filter(|_| !taken.iter().any(crowded)) else { continue };
        taken.push((at, size));
        let radii = size * DVec3::new(1.0, dice.between(0.5, 0.75), 1.0);
        // Half of it hangs out, and less far from the middle of the patch.
        let center = at.with_y(under + dice.between(-0.1, 0.4) * radii.y);
        let (turn, key) = (DQuat::IDENTITY, mixed(key, i));
        pile.put(Lump { center, radii, turn, size, generation: 2, part: Part::Pouch, key });
    }
}

/// Height of the lowest point of `sheets` over or under the place `at`, metres.
fn underside(sheets: &[Lump], at: DVec3) -> Option<f64> {
    let under = |sheet: &Lump| {
        let p = sheet.turn.inverse() * (at - sheet.center).with_y(0.0) / sheet.radii;
        let inside = 1.0 - p.x * p.x - p.z * p.z;
        // Rims are too thin to carry them.
        // Its edge is a veil: the ice begins behind.
        (inside > 0.3).then(|| sheet.center.y - 0.5 * sheet.radii.y * inside.sqrt())
    };
    sheets.iter().filter_map(under).reduce(f64::min)
}
