//! Ground that is more than even: land keeps its mean and its detail, water mirrors the sky by Fresnel's equations and
//! glitters where it should. Also the twins of `ground_point` and `ground_diffuse`.

use glam::DVec3;
use nephos::render::{Quality, Transport};
use nephos::scene::{
    Atmosphere, Camera, Ground, GroundKind, Land, Projection, Scene, Sky, SunPosition, Water,
};

use crate::common::picture::{draw, renderer};

type Rgb = [f64; 3];

/// Clear air and a sun in the south-west, without clouds.
fn scene(kind: GroundKind, camera: Camera) -> Scene {
    let mut scene = Scene { camera: Some(camera), ..Scene::default() };
    scene.sky = Sky::Atmosphere(Atmosphere { haze: 1.0, ..Atmosphere::default() });
    scene.sun.position = SunPosition::Angles { azimuth_deg: 230.0, elevation_deg: 35.0 };
    scene.ground = Ground { kind, ..Ground::default() };
    scene
}

/// From `altitude` in direction `d`, `degrees` from top to bottom.
fn camera(altitude: f64, d: DVec3, degrees: f64) -> Camera {
    let position = DVec3::new(0.0, altitude, 0.0);
    let projection = Projection::Perspective { vertical_fov_deg: degrees };
    Camera { position, target: position + d, projection, ..Camera::default() }
}

fn picture(scene: &Scene, size: [u32; 2]) -> Vec<Rgb> {
    let picture = draw(&mut renderer(Quality::DRAFT, Transport::default()), scene, size, true);
    picture.pixels.iter().map(|p| [p[0], p[1], p[2]].map(f64::from)).collect()
}

fn mean(pixels: &[Rgb]) -> Rgb {
    std::array::from_fn(|c| pixels.iter().map(|p| p[c]).sum::<f64>() / pixels.len() as f64)
}

fn land(variation: f64) -> GroundKind {
    GroundKind::Land(Land { variation, ..Land::default() })
}

#[test]
fn land_has_the_light_of_even_ground_on_average() {
    // Some 90 km around, so that the largest woods count too.
    let from_above = camera(40e3, DVec3::new(1e-3, -1.0, 0.0), 96.0);
    let even = picture(&scene(GroundKind::Even, from_above.clone()), [64, 64]);
    let varied = picture(&scene(land(1.0), from_above.clone()), [64, 64]);
    let (a, b) = (mean(&even), mean(&varied));
    assert!((0..3).all(|c| (b[c] / a[c] - 1.0).abs() < 0.01), "{a:?} {b:?}");
    assert_eq!(even, picture(&scene(land(0.0), from_above), [64, 64]));
}

#[test]
fn land_has_detail_near_by_and_none_that_flickers_far_away() {
    let over = camera(600.0, DVec3::new(0.0, -0.25, -1.0), 40.0);
    let size = [96, 64];
    let [even, varied] = [GroundKind::Even, land(1.0)].map(|kind| picture(&scene(kind, over.clone()), size));
    let ratio: Vec<f64> = varied.iter().zip(&even).map(|(a, b)| a[1] / b[1]).collect();
    let spread = |rows: std::ops::Range<usize>| {
        let part = &ratio[rows.start * 96..rows.end * 96];
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        (part.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / part.len() as f64).sqrt()
    };
    assert!(spread(48..64) > 0.15, "{}", spread(48..64));
    // Just under the horizon, which is in row 14, a pixel sees kilometres.
    assert!(spread(15..17) < 0.5 * spread(48..64), "{}", spread(15..17));
    // The same ground from a metre to the side: what is seen moves by less than a pixel.
    let moved = Camera { position: over.position + DVec3::X, target: over.target + DVec3::X, ..over };
    let other = picture(&scene(land(1.0), moved), size);
    let change = varied.iter().zip(&other).map(|(a, b)| (a[1] - b[1]).abs() / a[1]).fold(0.0, f64::max);
    assert!(change < 0.1, "{change}");
}

/// Fresnel's share, by the angle of the refracted ray.
fn fresnel(incidence: f64) -> f64 {
    let refracted = (incidence.sin() / 1.34).asin();
    let (sum, difference) = (incidence + refracted, incidence - refracted);
    0.5 * ((difference.sin() / sum.sin()).powi(2) + (difference.tan() / sum.tan()).powi(2))
}

#[test]
fn calm_water_mirrors_the_sky_by_fresnels_equations() {
    for degrees in [20.0f64, 45.0, 60.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        // Towards the north, away from the sun.
        let [down, up] = [-cosine, cosine].map(|y| camera(2.0, DVec3::new(0.0, y, -sine), 1.0));
        // No light from below the surface.
        let mut water = scene(GroundKind::Water(Water { wind: 0.0 }), down);
        water.ground.albedo = [0.02; 3];
        let mut above = scene(GroundKind::Even, up);
        above.ground.albedo = [0.02; 3];
        let [mirrored, sky] = [&water, &above].map(|scene| mean(&picture(scene, [4, 4])));
        for c in 0..3 {
            let share = mirrored[c] / sky[c];
            // Slopes of 3 degrees are left where no wind is, and both the share and the sky rise towards the horizon.
            assert!((share / fresnel(degrees.to_radians()) - 1.0).abs() < 0.1, "{degrees}, {c}: {share}");
        }
    }
}

#[test]
fn the_glitter_is_brightest_where_water_mirrors_the_sun_and_wider_in_wind() {
    let elevation = 35f64.to_radians();
    // The sun stands at azimuth 230 degrees, clockwise from north.
    let (east, south) = (230f64.to_radians().sin(), -(230f64.to_radians().cos()));
    let towards = |tilt: f64| {
        let (sine, cosine) = (elevation + tilt.to_radians()).sin_cos();
        let d = DVec3::new(cosine * east, -sine, cosine * south);
        let light =
            |wind| mean(&picture(&scene(GroundKind::Water(Water { wind }), camera(2.0, d, 0.5)), [4, 4]))[1];
        [light(1.0), light(10.0)]
    };
    let (middle, aside) = (towards(0.0), towards(25.0));
    assert!(middle[0] > 2.0 * middle[1], "{middle:?}");
    assert!(aside[1] > 2.0 * aside[0], "{aside:?}");
    // The density of slopes is 1 / (pi variance) where it mirrors the sun; little hides little there.
    let ratio = (0.003 + 0.00512 * 10.0) / (0.003 + 0.00512);
    assert!((middle[0] / middle[1] / ratio - 1.0).abs() < 0.1, "{} {ratio}", middle[0] / middle[1]);
}
