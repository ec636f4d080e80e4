//! Layers to the horizon.

use glam::DVec3;

use super::{Preset, camera};
use crate::scene::{
    Camera, Cloud, Droplets, Edge, Layer, Noise, Phase, Projection, Scene, Species, SunPosition,
};

/// Asymmetry of the light that ice scatters; crystals have no glory.
const ICE: Phase = Phase::HenyeyGreenstein { g: 0.8 };

/// The layer of a preset; none where it is none.
pub(super) fn cloud(preset: Preset, seed: u32) -> Option<Cloud> {
    let (layer, droplets, edge) = match preset {
        Preset::Stratus => stratus(),
        Preset::Stratocumulus => stratocumulus(),
        Preset::Altocumulus => altocumulus(),
        Preset::Mackerel => mackerel(),
        Preset::Cirrostratus => cirrostratus(),
        Preset::Cirrus => cirrus(),
        _ => return None,
    };
    let noise = Noise { seed, ..Noise::default() };
    let cloud = Cloud::layered(preset.name(), Layer { seed, ..layer });
    Some(Cloud { droplets, edge, noise: Some(noise), ..cloud })
}

fn water(concentration_per_cm3: f64, effective_radius_um: f64) -> Droplets {
    Droplets { concentration_per_cm3, effective_radius_um, ..Droplets::default() }
}

fn ice(concentration_per_cm3: f64) -> Droplets {
    Droplets { phase: ICE, ..water(concentration_per_cm3, 20.0) }
}

fn edge(boundary: f64, wispiness: f64) -> Edge {
    Edge { boundary, wispiness }
}

type Make = (Layer, Droplets, Edge);

/// Grey from horizon to horizon, optical depth 13.
fn stratus() -> Make {
    let layer = Layer {
        base: 450.0,
        thickness: 250.0,
        coverage: 1.0,
        scale: 1500.0,
        heaps: 0.45,
        cells: 0.0,
        bulge: 0.35,
        ..Layer::default()
    };
    (layer, water(150.0, 7.5), edge(90.0, 0.7))
}

/// Closed cells with some gaps, optical depth up to 15.
fn stratocumulus() -> Make {
    let layer = Layer {
        base: 1100.0,
        thickness: 380.0,
        coverage: 0.82,
        scale: 900.0,
        stretch: 1.4,
        heading_deg: 70.0,
        heaps: 0.9,
        cells: 0.8,
        bulge: 0.25,
        ..Layer::default()
    };
    (layer, water(80.0, 9.0), edge(90.0, 0.2))
}

/// Small heaps side by side, optical depth up to 6.
fn altocumulus() -> Make {
    let layer = Layer {
        base: 4200.0,
        thickness: 260.0,
        coverage: 0.62,
        scale: 430.0,
        stretch: 1.3,
        heading_deg: 120.0,
        heaps: 1.0,
        cells: 0.85,
        bulge: 0.35,
        ..Layer::default()
    };
    (layer, water(70.0, 8.0), edge(70.0, 0.35))
}

/// Rows of ripples, thin enough for the sky to shine through.
fn mackerel() -> Make {
    let layer = Layer {
        base: 6200.0,
        thickness: 170.0,
        coverage: 0.55,
        scale: 260.0,
        stretch: 3.0,
        heading_deg: 65.0,
        heaps: 1.0,
        cells: 1.0,
        bulge: 0.4,
        ..Layer::default()
    };
    (layer, water(45.0, 8.0), edge(60.0, 0.6))
}

/// A veil of ice that hardly dims the sun, optical depth 0.6: columns of 40 um, 0.02 g in each cubic metre.
fn cirrostratus() -> Make {
    let layer = Layer {
        base: 8000.0,
        thickness: 800.0,
        coverage: 1.0,
        scale: 9000.0,
        stretch: 4.0,
        heading_deg: 80.0,
        heaps: 0.8,
        cells: 0.0,
        bulge: 0.4,
        ..Layer::default()
    };
    (layer, Droplets::of_mass(Species::Ice, 0.0245), edge(400.0, 1.0))
}

/// Streaks of ice along the shear of the wind, optical depth up to 0.8.
fn cirrus() -> Make {
    let layer = Layer {
        base: 8800.0,
        thickness: 700.0,
        coverage: 0.5,
        scale: 2400.0,
        stretch: 7.0,
        heading_deg: 35.0,
        heaps: 1.0,
        cells: 0.0,
        bulge: 0.45,
        ..Layer::default()
    };
    (layer, ice(0.6), edge(200.0, 1.0))
}

/// From the ground up to a layer, the horizon low in the picture.
pub(super) fn look_up(scene: &mut Scene) {
    let eye = DVec3::new(0.0, scene.ground.altitude + 1.7, 0.0);
    scene.camera = Some(Camera {
        projection: Projection::Perspective { vertical_fov_deg: 60.0 },
        ..camera(eye, eye + DVec3::new(0.0, 420.0, -1000.0))
    });
}

/// Up to the sun, wide enough for the halo of 22 degrees around it.
pub(super) fn look_at_the_halo(scene: &mut Scene) {
    scene.sun.position = SunPosition::Angles { azimuth_deg: 180.0, elevation_deg: 28.0 };
    let eye = DVec3::new(0.0, scene.ground.altitude + 1.7, 0.0);
    scene.camera = Some(Camera {
        projection: Projection::Perspective { vertical_fov_deg: 65.0 },
        ..camera(eye, eye + DVec3::new(0.0, 480.0, 1000.0))
    });
}
