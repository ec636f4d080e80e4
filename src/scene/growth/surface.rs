//! What the surface of a grown cloud is like: the one place where lumps get their density and edges.

use super::Growth;
use super::pile::{Lump, Part};
use crate::scene::Edge;

/// The thickest boundary that an edge may have, metres.
const THICKEST: f64 = 1e4;

/// Density and edge of a lump; heaps and shreds have the edge of their cloud, and all of one cloud the same
/// density.
pub(super) fn of(growth: &Growth, lump: &Lump) -> (f64, Option<Edge>) {
    let thinned = 1.0 - 0.6 * growth.age * growth.age;
    let least = lump.radii.min_element();
    let own =
        |boundary: f64, wispiness: f64| Some(Edge { boundary: tenth(boundary.min(THICKEST)), wispiness });
    let (density, edge) = match lump.part {
        Part::Heap | Part::Shred => (thinned, None),
        Part::Ice => (0.06 + 0.22 * (lump.size / growth.width), own(0.9 * least, 0.9)),
        Part::Pouch => (0.2, own(0.6 * least, 0.5)),
    };
    (hundredth(density), edge)
}

fn tenth(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

fn hundredth(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
