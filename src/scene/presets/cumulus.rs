//! The cumulus family, from fair weather to thunderstorm.

use glam::DVec3;

use super::dice::Dice;
use super::heap::{Edges, Growth, Heap};
use crate::scene::{Cloud, Edge, Ellipsoid};

/// Fair weather: 200 to 500 m wide, wider than tall, base at 1000 m.
pub(super) fn humilis(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(1000.0);
    base_layer(dice, &mut heap, 5, 95.0, 75.0, 0.5);
    heap.grow(dice, &Growth { children: (2, 3), up: 0.5, out: 0.2 });
    heap.grow(dice, &Growth { children: (1, 2), up: 0.6, out: 0.3 });
    heap.into_cloud("humilis", &Edges { boundary: 22.0, base: 0.4, top: 0.2 })
}

/// About as tall as wide, 800 m, base at 1000 m.
pub(super) fn mediocris(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(1000.0);
    base_layer(dice, &mut heap, 5, 240.0, 215.0, 0.6);
    trunk(dice, &mut heap, &[(260.0, 250.0), (440.0, 230.0), (600.0, 180.0)]);
    heap.grow(dice, &Growth { children: (2, 3), up: 0.5, out: 0.4 });
    heap.grow(dice, &Growth { children: (1, 2), up: 0.6, out: 0.5 });
    heap.into_cloud("mediocris", &Edges { boundary: 45.0, base: 0.35, top: 0.15 })
}

/// A tower of 2 to 3 km, taller than wide, with cauliflower turrets.
pub(super) fn congestus(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(1000.0);
    base_layer(dice, &mut heap, 5, 380.0, 330.0, 0.55);
    trunk(
        dice,
        &mut heap,
        &[(500.0, 470.0), (850.0, 440.0), (1200.0, 410.0), (1550.0, 400.0), (1850.0, 360.0), (2100.0, 290.0)],
    );
    heap.grow(dice, &Growth { children: (2, 3), up: 0.4, out: 0.7 });
    heap.grow(dice, &Growth { children: (1, 1), up: 0.6, out: 0.8 });
    heap.into_cloud("congestus", &Edges { boundary: 70.0, base: 0.35, top: 0.05 })
}

/// A thunderstorm: a tower of 6 to 9 km under a spread anvil of ice.
pub(super) fn cumulonimbus(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(1000.0);
    base_layer(dice, &mut heap, 6, 1200.0, 1100.0, 0.4);
    trunk(
        dice,
        &mut heap,
        &[
            (1300.0, 1500.0),
            (2300.0, 1350.0),
            (3300.0, 1300.0),
            (4300.0, 1250.0),
            (5300.0, 1200.0),
            (6200.0, 1100.0),
        ],
    );
    heap.grow(dice, &Growth { children: (2, 3), up: 0.3, out: 0.8 });
    heap.grow(dice, &Growth { children: (0, 1), up: 0.5, out: 0.8 });
    let mut cloud = heap.into_cloud("cumulonimbus", &Edges { boundary: 180.0, base: 0.35, top: 0.1 });
    cloud.ellipsoids.extend(anvil(dice, 7600.0));
    cloud
}

/// Small torn shreds under a shower or in the morning, base at 600 m.
pub(super) fn fractus(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(600.0);
    for _ in 0..dice.count(10, 16) {
        let p = dice.disc() * DVec3::new(220.0, 0.0, 120.0);
        let size = dice.between(0.5, 1.0);
        let radii = size * DVec3::new(90.0, 26.0, 50.0);
        let lift = dice.between(0.0, 60.0);
        heap.put(dice, p + DVec3::Y * (600.0 + radii.y + lift), radii);
    }
    let mut cloud = heap.into_cloud("fractus", &Edges { boundary: 24.0, base: 0.95, top: 0.85 });
    for shred in &mut cloud.ellipsoids {
        shred.density = 0.4;
    }
    cloud
}

/// Flat lumps side by side on the base: `radius` across, `flatness` times as tall,
/// within `spread` of the axis; metres.
fn base_layer(dice: &mut Dice, heap: &mut Heap, count: usize, radius: f64, spread: f64, flatness: f64) {
    for i in 0..count {
        let across = 2.0 * (i as f64 + 0.5) / count as f64 - 1.0;
        let jitter = dice.disc();
        let p = spread * DVec3::new(1.2 * across + 0.25 * jitter.x, 0.0, 0.7 * jitter.z);
        // The middle is the largest.
        let size = radius * dice.between(0.8, 1.0) * (1.0 - 0.25 * across * across);
        let shape = DVec3::new(dice.between(0.95, 1.15), 0.85 * flatness, dice.between(0.8, 1.0));
        heap.lay(dice, p, size * shape);
    }
}

/// Lumps one above the other, each (height above the base, radius) in metres, the
/// axis wandering a little.
fn trunk(dice: &mut Dice, heap: &mut Heap, lumps: &[(f64, f64)]) {
    let mut axis = DVec3::ZERO;
    for &(height, radius) in lumps {
        axis += 0.25 * radius * dice.disc();
        let radius = radius * dice.between(0.9, 1.1);
        let shape = DVec3::new(dice.between(0.9, 1.1), 0.9, dice.between(0.9, 1.1));
        heap.put(dice, axis + DVec3::Y * (1000.0 + height), radius * shape);
    }
}

/// Thin wispy sheets that spread downwind (east) from the top of a tower, `altitude` in metres.
fn anvil(dice: &mut Dice, altitude: f64) -> Vec<Ellipsoid> {
    let mut heap = Heap::on(altitude - 400.0);
    for i in 0..8 {
        let along = i as f64 / 7.0;
        let jitter = dice.disc();
        let p = DVec3::new(-1200.0 + 5200.0 * along + 500.0 * jitter.x, 0.0, 1300.0 * jitter.z);
        let thickness = 520.0 - 260.0 * along;
        let radii = DVec3::new(dice.between(1900.0, 2500.0), thickness, dice.between(1500.0, 2100.0));
        let center = p + DVec3::Y * (altitude + dice.between(-60.0, 160.0) + 120.0 * along);
        heap.put(dice, center, radii);
    }
    let ice = Edge { boundary: 250.0, wispiness: 0.85 };
    let mut sheets = heap.into_cloud("anvil", &Edges { boundary: 250.0, base: 0.85, top: 0.85 }).ellipsoids;
    for sheet in &mut sheets {
        sheet.density = 0.3;
        sheet.edge = Some(ice.clone());
    }
    sheets
}
