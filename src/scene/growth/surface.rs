//! What the surface of a grown cloud is like: the one place where lumps get their density and edges.

use super::pile::{Lump, Part};
use super::{Growth, GrowthKind};
use crate::scene::Edge;

/// Density and edge of a lump.
pub(super) fn of(growth: &Growth, lump: &Lump) -> (f64, Option<Edge>) {
    let share = (lump.center.y / growth.height).clamp(0.0, 1.0);
    let least = lump.radii.min_element();
    let (density, boundary, wispiness) = match lump.part {
        Part::Heap => {
            let widest = match growth.kind {
                GrowthKind::ClosedCells | GrowthKind::OpenCells => 0.35 * growth.height,
                _ => 0.09 * growth.width,
            };
            let soft = 0.45 * (1.0 - 2.2 * share).max(0.0) + 0.6 * growth.age * growth.age;
            (heaped(share) * (1.0 - 0.5 * growth.age), widest.min(0.9 * least), soft)
        }
        Part::Ice => (0.08 + 0.17 * (lump.size / growth.width), 0.9 * least, 0.9),
        Part::Pouch => (0.25, 0.8 * least, 0.5),
        Part::Shred => (0.45 * (1.0 - 0.4 * growth.age), 1.2 * least, 0.9),
    };
    let edge = Edge { boundary: tenth(boundary), wispiness: hundredth(wispiness.clamp(0.0, 1.0)) };
    (hundredth(density), Some(edge))
}

/// Density at a share of the height: liquid water grows about evenly with height, extinction with its 2/3 power.
fn heaped(share: f64) -> f64 {
    // x^(2/3) to 0.03, without a power that platforms round their own way.
    let root = share.sqrt();
    0.35 + 0.65 * (0.65 * share + 0.35 * root)
}

fn tenth(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

fn hundredth(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
