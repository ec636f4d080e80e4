//! Clouds that grow, with the water, the edges and the noise of their kind.

use crate::scene::{Cloud, Droplets, Edge, Growth, GrowthKind};

/// A cloud of a kind as it is usual, grown from `seed`.
pub(super) fn cloud(name: &str, growth: Growth) -> Cloud {
    let (droplets, edge) = (droplets(growth.kind), edge(&growth));
    Cloud { droplets, edge, ..Cloud::grown(name, growth) }
}

/// The one place where grown clouds get their water.
fn droplets(kind: GrowthKind) -> Droplets {
    let (concentration_per_cm3, effective_radius_um) = match kind {
        GrowthKind::Humilis | GrowthKind::Fractus => (300.0, 7.0),
        GrowthKind::Mediocris | GrowthKind::ClosedCells => (250.0, 8.0),
        GrowthKind::Congestus | GrowthKind::OpenCells => (200.0, 9.0),
        GrowthKind::Cumulonimbus => (100.0, 11.0),
    };
    Droplets { concentration_per_cm3, effective_radius_um, ..Droplets::default() }
}

/// The one place where grown clouds get their edges.
fn edge(growth: &Growth) -> Edge {
    Edge { boundary: (0.05 * growth.width.min(2.0 * growth.height)).round(), wispiness: 0.2 }
}

/// Size of the largest billows of the noise, metres.
pub(super) fn noise_scale(growth: &Growth) -> f64 {
    (0.09 * growth.width.min(2.5 * growth.height)).round()
}
