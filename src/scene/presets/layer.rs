//! Layers: a field of stratocumulus, and a sheet for the glory.

use glam::DVec3;

use super::dice::Dice;
use super::heap::{Edges, Growth, Heap};
use crate::scene::Cloud;

/// A field of twenty flat clouds over 6 by 5 km, base at 1200 m.
pub(super) fn stratocumulus(dice: &mut Dice) -> Vec<Cloud> {
    let mut clouds = Vec::new();
    for row in 0..4 {
        for column in 0..5 {
            let grid = DVec3::new(column as f64 - 2.0, 0.0, row as f64 - 1.5);
            let place = 1150.0 * (grid + 0.25 * dice.disc());
            clouds.push(roll(dice, place, &format!("roll {}", clouds.len() + 1)));
        }
    }
    clouds
}

/// One flat cloud around the horizontal place `p`, metres.
fn roll(dice: &mut Dice, p: DVec3, name: &str) -> Cloud {
    let mut heap = Heap::on(1200.0);
    for _ in 0..dice.count(2, 3) {
        let size = dice.between(0.7, 1.0);
        let radii = size * DVec3::new(dice.between(330.0, 420.0), 85.0, dice.between(260.0, 330.0));
        let place = p + 280.0 * dice.disc();
        heap.lay(dice, place, radii);
    }
    let flat = Growth { children: (1, 2), up: 0.3, out: 0.3 };
    heap.grow(dice, &flat);
    let mut cloud = heap.into_cloud(name, &Edges { boundary: 45.0, base: 0.4, top: 0.25 });
    for lump in cloud.ellipsoids.iter_mut().filter(|lump| lump.radii.y > 90.0) {
        // Under an inversion the tops are pressed flat; the bottom stays where it is.
        let bottom = lump.center.y - lump.radii.y;
        lump.radii.y = 90.0;
        lump.center.y = bottom + lump.radii.y;
    }
    cloud
}

/// A thin sheet, 7 km across, its tops near 1120 m: a screen for glory and fogbow.
pub(super) fn sheet(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(1000.0);
    for row in 0..8 {
        for column in 0..8 {
            let grid = DVec3::new(column as f64 - 3.5, 0.0, row as f64 - 4.5);
            let place = 850.0 * (grid + 0.2 * dice.disc());
            let thickness = dice.between(50.0, 62.0);
            let radii = DVec3::new(dice.between(900.0, 1050.0), thickness, dice.between(900.0, 1050.0));
            heap.lay(dice, place, radii);
        }
    }
    heap.into_cloud("sheet", &Edges { boundary: 20.0, base: 0.3, top: 0.3 })
}
