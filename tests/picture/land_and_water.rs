//! Ground that is more than even: land keeps its mean and its detail, water mirrors the sky by Fresnel's equations and
//! glitters where it should. Also the twins of `ground_point` and `ground_diffuse`.

use glam::DVec3;
#[cfg(feature = "export")]
use nephos::render::Frame;
use nephos::render::{Quality, Transport};
use nephos::scene::{
    Atmosphere, Camera, Ground, GroundColors, GroundKind, GroundPicture, Land, Projection, Scene, Sky,
    SunPosition, Water,
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

fn picture_of(scene: &Scene, size: [u32; 2]) -> Vec<Rgb> {
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
    let even = picture_of(&scene(GroundKind::Even, from_above.clone()), [64, 64]);
    let varied = picture_of(&scene(land(1.0), from_above.clone()), [64, 64]);
    let (a, b) = (mean(&even), mean(&varied));
    assert!((0..3).all(|c| (b[c] / a[c] - 1.0).abs() < 0.01), "{a:?} {b:?}");
    assert_eq!(even, picture_of(&scene(land(0.0), from_above), [64, 64]));
}

#[test]
fn a_pixel_of_land_has_the_mean_of_what_it_sees() {
    let over = camera(600.0, DVec3::new(0.0, -0.25, -1.0), 40.0);
    let size = [96, 64];
    let [even, varied] =
        [GroundKind::Even, land(1.0)].map(|kind| picture_of(&scene(kind, over.clone()), size));
    let spread = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    };
    let ratio: Vec<f64> = varied.iter().zip(&even).map(|(a, b)| a[1] / b[1]).collect();
    assert!(spread(&ratio[48 * 96..]) > 0.15, "{}", spread(&ratio[48 * 96..]));
    // Sixteen pixels for each; the horizon is in row 14, where a pixel sees kilometres.
    let fine = picture_of(&scene(land(1.0), over), [4 * 96, 4 * 64]);
    let off = |x: usize, y: usize| {
        let sixteen = (0..16).map(|k| fine[(4 * y + k / 4) * 4 * 96 + 4 * x + k % 4][1]);
        varied[y * 96 + x][1] / (sixteen.sum::<f64>() / 16.0) - 1.0
    };
    for rows in [16..24, 24..40, 40..64] {
        let off: Vec<f64> =
            rows.clone().flat_map(|y| (0..96).map(move |x| (x, y))).map(|(x, y)| off(x, y)).collect();
        let rms = (off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64).sqrt();
        assert!(rms < 0.06, "{rows:?}: {rms}");
    }
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
        let [mirrored, sky] = [&water, &above].map(|scene| mean(&picture_of(scene, [4, 4])));
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
        let light = |wind| {
            mean(&picture_of(&scene(GroundKind::Water(Water { wind }), camera(2.0, d, 0.5)), [4, 4]))[1]
        };
        [light(1.0), light(10.0)]
    };
    let (middle, aside) = (towards(0.0), towards(25.0));
    assert!(middle[0] > 2.0 * middle[1], "{middle:?}");
    assert!(aside[1] > 2.0 * aside[0], "{aside:?}");
    // The density of slopes is 1 / (pi variance) where it mirrors the sun; little hides little there.
    let ratio = (0.003 + 0.00512 * 10.0) / (0.003 + 0.00512);
    assert!((middle[0] / middle[1] / ratio - 1.0).abs() < 0.1, "{} {ratio}", middle[0] / middle[1]);
}

#[test]
fn a_picture_lies_where_it_should_with_the_light_of_its_colours() {
    // North-west, north-east, south-west, south-east.
    let colors = [[0.5, 0.1, 0.1], [0.1, 0.5, 0.1], [0.1, 0.1, 0.5], [0.9, 0.9, 0.9]];
    let mut picture = GroundPicture::default().with_colors(GroundColors::new(2, colors.to_vec()).unwrap());
    (picture.width, picture.x, picture.z) = (4000.0, 500.0, -300.0);
    let kind = GroundKind::Picture(picture);
    // From right above, north is up.
    let position = DVec3::new(500.0, 3000.0, -300.0);
    let target = DVec3::new(500.0, 0.0, -300.01);
    let from_above = Camera {
        position,
        target,
        projection: Projection::Orthographic { height: 6000.0 },
        ..Camera::default()
    };
    let edge = 24;
    let [even, drawn] =
        [GroundKind::Even, kind].map(|kind| picture_of(&scene(kind, from_above.clone()), [edge, edge]));
    let albedo = Ground::default().albedo;
    // The light of the ground alone: what air adds is the same in both.
    let share = |x: u32, y: u32, c: usize| {
        let i = (y * edge + x) as usize;
        (drawn[i][c] - even[i][c]) / even[0][c]
    };
    for c in 0..3 {
        // Of all quadrants alike: what the air lets through of the light there.
        let through = share(16, 16, c) / (0.9 - albedo[c]);
        assert!(through > 0.0);
        for (k, color) in colors.iter().enumerate() {
            // Middles of the quadrants, 1 km from the picture's middle; a pixel is 250 m.
            let (x, y) = (7 + 9 * (k as u32 % 2), 7 + 9 * (k as u32 / 2));
            let off = share(x, y, c) / through - (f64::from(color[c]) - albedo[c]);
            assert!(off.abs() < 0.005, "{k} {c}: {off}");
        }
    }
    // Around it nothing changes.
    assert!((0..3).all(|c| share(1, 12, c) == 0.0 && share(12, 22, c) == 0.0));
}

#[test]
#[cfg(feature = "export")]
fn pictures_of_the_ground_are_read_from_beside_the_scene_or_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    image::RgbImage::from_pixel(3, 2, image::Rgb([188, 0, 255]))
        .save(folder.path().join("land.png"))
        .unwrap();
    let path = folder.path().join("scene.json");
    let load = |picture: &str| {
        let text = format!(r#"{{"ground": {{"kind": {{"picture": {{{picture}}}}}}}}}"#);
        std::fs::write(&path, text).unwrap();
        Scene::load(&path)
    };
    let scene = load(r#""file": "land.png", "width": 3000"#).unwrap();
    assert_eq!(scene.ground.kind.picture().unwrap().colors().unwrap().size(), [3, 2]);
    assert!(Frame::new(&scene, [4, 4]).is_ok());
    // In another folder the path leads to the same file.
    let other = folder.path().join("below");
    std::fs::create_dir(&other).unwrap();
    scene.save(other.join("scene.json")).unwrap();
    let moved = Scene::load(other.join("scene.json")).unwrap();
    assert!(moved.ground.kind.picture().unwrap().colors().is_some());
    std::fs::write(folder.path().join("text.png"), b"nothing").unwrap();
    for (picture, words) in [
        (r#""file": """#, "name the picture"),
        (r#""file": "none.png""#, "none.png"),
        (r#""file": "text.png""#, "no PNG picture"),
        (r#""file": "land.png", "width": 0"#, "10 to 10000000 metres"),
        (r#""file": "land.png", "x": 1e9"#, "metres"),
    ] {
        let told = load(picture).unwrap_err().to_string();
        assert!(told.contains(words) && told.contains("ground"), "{told}");
    }
    let unread = Scene::from_json(r#"{"ground": {"kind": {"picture": {"file": "land.png"}}}}"#).unwrap();
    let told = Frame::new(&unread, [4, 4]).unwrap_err().to_string();
    assert!(told.contains("was not read"), "{told}");
}

#[test]
fn ground_is_finite_from_everywhere_and_at_any_sun() {
    let kinds = [
        land(1.0),
        GroundKind::Land(Land { variation: 1.0, field_width: 10.0 }),
        GroundKind::Land(Land { variation: 1.0, field_width: 1e5 }),
        GroundKind::Water(Water { wind: 0.0 }),
        GroundKind::Water(Water { wind: 20.0 }),
    ];
    let mut renderer = renderer(Quality::DRAFT, Transport::default());
    for kind in kinds {
        for (place, d) in [
            (DVec3::new(0.0, 0.01, 0.0), DVec3::new(0.0, -1.0, -1e-3)),
            (DVec3::new(9e6, 1.7, -9e6), DVec3::new(1.0, 0.0, 1.0)),
            (DVec3::new(0.0, -500.0, 0.0), DVec3::new(1.0, 0.3, 0.0)),
            (DVec3::new(-3e4, 3e5, 0.0), DVec3::new(0.0, -1.0, 0.1)),
        ] {
            for projection in [
                Projection::Perspective { vertical_fov_deg: 90.0 },
                Projection::Orthographic { height: 1e5 },
                Projection::Equirectangular,
            ] {
                let camera = Camera { position: place, target: place + d, projection, ..Camera::default() };
                let mut scene = scene(kind.clone(), camera);
                for elevation_deg in [-5.0, 0.0, 90.0] {
                    scene.sun.position = SunPosition::Angles { azimuth_deg: 45.0, elevation_deg };
                    let picture = draw(&mut renderer, &scene, [8, 8], true);
                    let is_light = |p: &[f32; 4]| p.iter().all(|x| x.is_finite() && *x >= 0.0);
                    assert!(
                        picture.pixels.iter().all(is_light),
                        "{kind:?} {place} {projection:?} {elevation_deg}"
                    );
                }
            }
        }
    }
}
