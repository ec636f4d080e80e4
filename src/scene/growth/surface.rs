//! What the surface of a grown cloud is like: the one place where lumps get their density and edges.

use super::Growth;
use super::pile::{Lump, Part};
use crate::scene::Edge;

/// The thickest boundary that an edge may have, metres.
const THICKEST: f64 = 1e4;

/// Density and edge of a lump; heaps have the edge of their cloud, and heaps and shreds of one cloud the same
/// density.
pub(super) fn of(growth: &Growth, lump: &Lump) -> (f64, Option<Edge>) {
    let thinned = 1.0 - 0.6 * growth.age * growth.age;
    let least = lump.radii.min_element();
    let own =
        |boundary: f64, wispiness: f64| Some(Edge { boundary: tenth(boundary.min(THICKEST)), wispiness });
    let chance = (lump.key >> 40) as f64 / (1u64 << 24) as f64;
    let (density, edge) = match lump.part {
        Part::Heap => (thinned, None),
        Part::Shred => (thinned, own(1.3 * least, hundredth(0.5 + 0.3 * chance))),
        // Thick ice near the tower keeps its billows, thin ice is all threads.
        Part::Ice => {
            let near = (lump.size / growth.width).clamp(0.0, 1.0);
            (0.04 + 0.32 * near * near, own(least, hundredth(0.9 - 0.45 * near)))
        }
        Part::Pouch => (0.2, own(0.35 * least, 0.4)),
    };
    (hundredth(density), edge)
}

fn tenth(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

fn hundredth(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
