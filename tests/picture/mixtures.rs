//! Volumes on one grid as a mixture: the path tracer takes each field by its share at every point.
#![cfg(all(feature = "export", feature = "import"))]

use std::sync::Arc;

use crate::common;

use common::{
    gpu,
    truth::{Measured, assert_agree, mean, opacity, trace},
};
use glam::{DAffine3, DVec3};
use nephos::{
    optics::phase::Phase,
    render::{Frame, VoxelGrid, Voxels},
    scene::{Camera, Cloud, Droplets, Grid, Projection, Scene, Sky, Species, Sun, SunPosition, Volume},
};

/// Voxels along an edge of a box, 10 m each.
const SIDE: u32 = 16;

/// A box of the values that a function gives, by the number of a voxel along x.
fn grid(value: impl Fn(u32) -> f32) -> Arc<Grid> {
    let place = DAffine3::from_scale(DVec3::splat(10.0)) * DAffine3::from_translation(DVec3::splat(-7.5));
    let values = (0..SIDE.pow(3)).map(|i| value(i % SIDE));
    Arc::new(Grid::dense("box".to_owned(), place, [SIDE; 3], values).unwrap())
}

fn cloud(species: Species, extinction: f64, grid: &Arc<Grid>) -> Cloud {
    let volume = Volume { extinction, place: DVec3::new(0.0, 1000.0, 0.0), ..Volume::default() };
    let mut cloud = Cloud::of_volume(species.name(), volume.with_grid(grid.clone()));
    cloud.droplets =
        Droplets { species, effective_radius_um: species.usual_radius_um(), ..Droplets::default() };
    cloud
}

/// Clouds that light goes through which was turned by `theta_deg` degrees, seen over `height` m of their middle.
fn seen(clouds: Vec<Cloud>, theta_deg: f64, height: f64) -> Scene {
    let theta = theta_deg.to_radians();
    let to_sun = DVec3::new(0.0, theta.sin(), -theta.cos());
    Scene {
        clouds,
        sky: Sky::None,
        sun: Sun {
            position: SunPosition::Direction(to_sun),
            irradiance: [1.0; 3],
            angular_diameter_deg: 0.0,
        },
        camera: Some(Camera {
            position: DVec3::new(0.0, 1000.0, 600.0),
            target: DVec3::new(0.0, 1000.0, 0.0),
            projection: Projection::Orthographic { height },
            roll_deg: 0.0,
            ..Camera::default()
        }),
        ..Scene::default()
    }
}

#[test]
fn halves_of_one_species_are_that_species() {
    let even = grid(|_| 1.0);
    let whole = seen(vec![cloud(Species::Water, 0.02, &even)], 70.0, 120.0);
    let parts = [0.25, 0.35, 0.4].map(|share| cloud(Species::Water, 0.02 * share, &even));
    let halves = seen(parts.to_vec(), 70.0, 120.0);
    let [whole, halves] = [whole, halves].map(|scene| trace(&scene, [8; 2], 3000));
    let results = [0, 1, 2].map(|c| (format!("channel {c}"), mean(&halves, c), mean(&whole, c)));
    assert_agree(&results);
}

#[test]
fn a_thin_mixture_scatters_by_its_shares_at_each_point() {
    // All rain on the left and all water on the right, and in the middle as much of both.
    let rain = grid(|x| (1.0 - x as f32 / 15.0).max(1e-3));
    let water = grid(|x| (x as f32 / 15.0).max(1e-3));
    let clouds = vec![cloud(Species::Rain, 2e-4, &rain), cloud(Species::Water, 2e-4, &water)];
    let phases = [0, 1].map(|i| Phase::of(&clouds[i].droplets).unwrap());
    let theta_deg = 138.8;
    let mut scene = seen(clouds, theta_deg, 1.0);
    let mut results = Vec::new();
    for (x, share) in [(-60.0, 1.5 / 15.0), (0.0, 0.5), (60.0, 13.5 / 15.0)] {
        let camera = scene.camera.as_mut().unwrap();
        (camera.position.x, camera.target.x) = (x, x);
        let found = trace(&scene, [4; 2], 20_000);
        for channel in [0, 2] {
            let [rain, water] = [0, 1].map(|i| phases[i].value(channel, theta_deg.to_radians()));
            // Voxels end half an edge beyond their middles on both sides, evenly to nothing: 160 m in all.
            let wanted = 2e-4 * 160.0 * (rain * (1.0 - share) + water * share);
            let wanted = Measured { value: wanted, error: 0.015 * wanted };
            results.push((format!("at {x} m, channel {channel}"), mean(&found, channel), wanted));
        }
    }
    assert_agree(&results);
}

#[test]
fn volumes_on_other_grids_dim_one_another_and_are_not_written_together() {
    let even = grid(|_| 1.0);
    let mut behind = cloud(Species::Rain, 0.002, &even);
    behind.volume.as_mut().unwrap().place.z -= 405.0;
    let scene = seen(vec![cloud(Species::Water, 0.003, &even), behind], 70.0, 20.0);
    let found = opacity(&trace(&scene, [8; 2], 300));
    let wanted = 1.0 - (-160.0 * 0.005f64).exp();
    assert!((found - wanted).abs() < 0.015, "{found} for {wanted}");
    let frame = Frame::new(&scene, [8; 2]).unwrap();
    let written = Voxels::sample(gpu(), &frame, VoxelGrid::new(20.0), &mut |_| ());
    let refused = written.err().unwrap().to_string();
    assert!(refused.contains("on the same grid") && refused.contains("hide"), "{refused}");
}
