//! Layers: a sheet for the glory, and the rolls of the corpus.

use glam::DVec3;

use super::heap::{Edges, Heap};
use crate::scene::Cloud;
use crate::scene::dice::Dice;

#[cfg(feature = "measure")]
const FIELD: Edges = Edges { boundary: 85.0, base: 0.4, top: 0.2 };

const SHEET: Edges = Edges { boundary: 40.0, base: 0.5, top: 0.5 };

/// A field of twenty flat clouds over 6 by 5 km, base at 1200 m.
#[cfg(feature = "measure")]
pub(super) fn rolls(dice: &mut Dice) -> Vec<Cloud> {
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

#[cfg(feature = "measure")]
/// One flat cloud around the horizontal place `p`, metres.
fn roll(dice: &mut Dice, p: DVec3, name: &str) -> Cloud {
    let mut heap = Heap::on(1200.0);
    for _ in 0..dice.count(6, 8) {
        let away = dice.disc();
        let place = p + away * DVec3::new(480.0, 0.0, 330.0);
        // Thickest in the middle.
        let size = dice.between(0.8, 1.0) * (1.0 - 0.3 * away.length_squared());
        let radii = size * DVec3::new(300.0, dice.between(90.0, 125.0), 240.0);
        heap.lay(dice, place, radii);
    }
    heap.into_cloud(name, &FIELD)
}

/// A thin sheet, 9 km across, its tops near 1120 m: a screen for glory and fogbow. Its
/// lumps are so wide that they do not show: only the noise does.
/// It reaches far to the north, where the presets' camera looks.
pub(super) fn sheet(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(1000.0);
    for i in 0..8 {
        let place = DVec3::new(0.0, 0.0, -1800.0) + 400.0 * dice.disc();
        let wide = 3600.0 + 150.0 * f64::from(i);
        let thin = dice.between(58.0, 64.0);
        heap.lay(dice, place, DVec3::new(wide, thin, wide));
    }
    heap.into_cloud("sheet", &SHEET)
}
