//! Clouds that grow, with the water, the edges and the noise of their kind.

use crate::scene::{Cloud, Droplets, Edge, Evaporation, Growth, GrowthKind, Noise};

/// What a kind is made of, beside its shape. All of it stands in the file, to be changed.
struct Make {
    concentration_per_cm3: f64,
    effective_radius_um: f64,
    /// Thickness of the boundary that noise shapes, of the cloud's size.
    boundary: f64,
    wispiness: f64,
    blend: f64,
    stratification: f64,
    dilution: f64,
    /// How much of it is a veil downwind, and under the base.
    lee: f64,
    veiled_base: f64,
    /// Size of the largest billows, of the cloud's size.
    billows: f64,
}

/// A cloud as it is usual for what grows: the one place where that is said.
pub(super) fn cloud(name: &str, growth: Growth) -> Cloud {
    let make = make(growth.kind);
    let size = size(&growth);
    Cloud {
        droplets: Droplets {
            concentration_per_cm3: make.concentration_per_cm3,
            effective_radius_um: make.effective_radius_um,
            ..Droplets::default()
        },
        edge: Edge { boundary: (make.boundary * size).round().max(1.0), wispiness: make.wispiness },
        blend: make.blend,
        stratification: make.stratification,
        dilution: make.dilution,
        evaporation: Evaporation { lee: make.lee, base: make.veiled_base },
        noise: Some(Noise {
            seed: growth.seed,
            scale: Some((make.billows * size).round().max(1.0)),
            ..Noise::default()
        }),
        ..Cloud::grown(name, growth)
    }
}

/// What is usual for a kind.
fn make(kind: GrowthKind) -> Make {
    let heap = Make {
        concentration_per_cm3: 300.0,
        effective_radius_um: 11.0,
        boundary: 0.036,
        wispiness: 0.0,
        blend: 0.15,
        stratification: 0.65,
        dilution: 0.2,
        lee: 0.6,
        veiled_base: 0.3,
        billows: 0.052,
    };
    match kind {
        GrowthKind::Humilis => {
            Make { concentration_per_cm3: 400.0, boundary: 0.049, wispiness: 0.05, billows: 0.058, ..heap }
        }
        GrowthKind::Mediocris => heap,
        GrowthKind::Congestus => Make { effective_radius_um: 10.0, boundary: 0.033, ..heap },
        GrowthKind::Cumulonimbus => Make {
            concentration_per_cm3: 100.0,
            effective_radius_um: 12.0,
            boundary: 0.036,
            wispiness: 0.05,
            stratification: 0.95,
            billows: 0.065,
            ..heap
        },
        GrowthKind::Fractus => Make {
            concentration_per_cm3: 450.0,
            effective_radius_um: 10.0,
            boundary: 0.09,
            wispiness: 0.35,
            stratification: 0.0,
            dilution: 0.2,
            lee: 0.6,
            billows: 0.145,
            ..heap
        },
        GrowthKind::ClosedCells | GrowthKind::OpenCells => Make {
            concentration_per_cm3: 150.0,
            boundary: 0.28,
            wispiness: 0.25,
            blend: 0.7,
            dilution: 0.0,
            lee: 0.15,
            billows: 0.7,
            ..heap
        },
    }
}

/// What lengths of the surface go by, metres: the width of a heap, the height of a layer.
fn size(growth: &Growth) -> f64 {
    match growth.kind {
        GrowthKind::ClosedCells | GrowthKind::OpenCells => growth.height,
        _ => (growth.width * growth.height.min(growth.width)).sqrt(),
    }
}
