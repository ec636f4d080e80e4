//! Where things of a scene are and point: sun, camera, bounds.

use glam::{DMat3, DQuat, DVec3};
use nephos::scene::{Camera, Cloud, Ellipsoid, Preset, Projection, Scene, Sun, SunPosition};
use proptest::prelude::*;

fn ellipsoids(scene: &Scene) -> impl Iterator<Item = &Ellipsoid> {
    scene.clouds.iter().flat_map(|cloud| &cloud.ellipsoids)
}

fn by_angles(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let position = SunPosition::Angles { azimuth_deg, elevation_deg };
    Sun { position, ..Sun::default() }.to_sun()
}

fn by_place(latitude_deg: f64, longitude_deg: f64, time: &str) -> DVec3 {
    let place = SunPosition::Place { latitude_deg, longitude_deg, time: time.to_owned(), hours: 0.0 };
    place.to_sun().unwrap()
}

/// Azimuth clockwise from north (-z) and elevation, degrees.
fn angles(v: DVec3) -> (f64, f64) {
    let azimuth = v.x.atan2(-v.z).to_degrees().rem_euclid(360.0);
    (azimuth, v.y.asin().to_degrees())
}

#[test]
fn compass_directions_are_those_of_the_map() {
    let rounding = 1e-15;
    assert!(by_angles(0.0, 0.0).distance(DVec3::NEG_Z) < rounding);
    assert!(by_angles(90.0, 0.0).distance(DVec3::X) < rounding);
    assert!(by_angles(180.0, 0.0).distance(DVec3::Z) < rounding);
    assert!(by_angles(270.0, 0.0).distance(DVec3::NEG_X) < rounding);
    assert!(by_angles(123.0, 90.0).distance(DVec3::Y) < rounding);
    let direction = SunPosition::Direction(DVec3::new(0.0, 3.0, 4.0));
    let to_sun = direction.to_sun().unwrap();
    assert!(to_sun.distance(DVec3::new(0.0, 0.6, 0.8)) < rounding);
}

#[test]
fn sun_by_place_is_that_of_the_spa_report() {
    // Reda and Andreas (2008), NREL/TP-560-34302, table A5.1: topocentric elevation
    // before refraction 39.872046 degrees, azimuth 194.340241. They have delta T = 67 s
    // and 1830 m of altitude, we an estimate and none: less than 0.001 degrees.
    let to_sun = by_place(39.742476, -105.1786, "2003-10-17T12:30:30-07:00");
    let (azimuth, elevation) = angles(to_sun);
    assert!((elevation - 39.872046).abs() < 1e-3, "{elevation}");
    assert!((azimuth - 194.340241).abs() < 1e-3, "{azimuth}");
    // With refraction their zenith angle is 50.11162: we are 0.0163 degrees lower.
    assert!((90.0 - elevation - 50.11162 - 0.0163).abs() < 1e-3);
}

#[test]
fn sun_of_the_equinox_stands_over_the_equator() {
    // 2026-03-20 14:46 UTC; solar noon is where the mean sun and the equation of time
    // (-7.5 minutes) put it: 15 degrees an hour west of Greenwich.
    let longitude = -15.0 * (14.0 + 46.0 / 60.0 - 12.0 - 7.5 / 60.0);
    let to_sun = by_place(0.0, longitude, "2026-03-20T14:46:00Z");
    assert!(to_sun.y.acos().to_degrees() < 0.1, "{to_sun}");
    // In the morning it stands in the east, in the evening in the west.
    assert!(by_place(0.0, 0.0, "2026-03-20T07:00:00Z").x > 0.9);
    assert!(by_place(0.0, 0.0, "2026-03-20T17:00:00Z").x < -0.9);
    // At noon it is in the south of London and in the north of Sydney.
    assert!(by_place(51.5, 0.0, "2026-03-20T12:00:00Z").z > 0.0);
    assert!(by_place(-33.9, 151.2, "2026-03-20T02:00:00Z").z < 0.0);
}

#[test]
fn time_zones_name_the_same_moment() {
    let utc = by_place(48.0, 11.0, "2026-06-21T16:30:00Z");
    let summer_time = by_place(48.0, 11.0, "2026-06-21T18:30:00+02:00");
    assert_eq!(utc, summer_time);
}

#[test]
fn bounds_of_a_turned_ellipsoid_are_exact() {
    // A quarter turn about y swaps x and z.
    let quarter = Ellipsoid {
        orientation: DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
        ..Ellipsoid::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(10.0, 20.0, 40.0))
    };
    let (min, max) = quarter.bounds();
    assert!(min.distance(DVec3::new(-39.0, -18.0, -7.0)) < 1e-12);
    assert!(max.distance(DVec3::new(41.0, 22.0, 13.0)) < 1e-12);

    // An eighth of a turn about z: both half extents are sqrt((a^2 + b^2) / 2).
    let eighth = Ellipsoid {
        orientation: DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4),
        ..Ellipsoid::new(DVec3::ZERO, DVec3::new(30.0, 40.0, 5.0))
    };
    let half = 1250.0_f64.sqrt();
    let (_, max) = eighth.bounds();
    assert!(max.distance(DVec3::new(half, half, 5.0)) < 1e-12, "{max}");
}

#[test]
fn bounds_of_empty_things_are_none() {
    assert_eq!(Scene::default().bounds(), None);
    assert_eq!(Cloud::default().bounds(), None);
}

#[test]
fn camera_looks_where_it_says() {
    let camera = Camera {
        position: DVec3::ZERO,
        target: DVec3::new(5.0, 0.0, 0.0),
        roll_deg: 0.0,
        projection: Projection::default(),
        ..Camera::default()
    };
    let rounding = 1e-12;
    let axes = DMat3::from_quat(camera.world_from_camera());
    assert!(axes.x_axis.distance(DVec3::Z) < rounding, "right of east is south");
    assert!(axes.y_axis.distance(DVec3::Y) < rounding);
    assert!(axes.z_axis.distance(DVec3::NEG_X) < rounding);

    // Turned clockwise by a quarter, what was up points to the right.
    let rolled = Camera { roll_deg: 90.0, ..camera.clone() };
    let axes = DMat3::from_quat(rolled.world_from_camera());
    assert!(axes.y_axis.distance(DVec3::Z) < rounding);

    // Straight down, north is up.
    let down = Camera { target: DVec3::NEG_Y, ..camera };
    let axes = DMat3::from_quat(down.world_from_camera());
    assert!(axes.y_axis.distance(DVec3::NEG_Z) < rounding);
    assert!(axes.x_axis.distance(DVec3::X) < rounding);
}

#[test]
fn lens_and_field_of_view_agree() {
    // 36 mm film behind 50 mm, 3:2: 2 atan(12 / 50) = 26.99 degrees.
    let lens = Projection::Lens { focal_length_mm: 50.0, sensor_width_mm: 36.0 };
    let found = lens.vertical_fov(1.5).unwrap().to_degrees();
    assert!((found - 26.991_467).abs() < 1e-5, "{found}");
    assert_eq!(Projection::Equirectangular.vertical_fov(2.0), None);
}

#[test]
fn automatic_camera_stands_in_the_south_and_frames_all_clouds() {
    for preset in Preset::ALL {
        let mut scene = preset.scene(1);
        scene.camera = None;
        scene.ground.altitude = 100.0;
        let camera = scene.camera();
        assert_eq!(camera.position.y, 101.7);
        if scene.bounds().is_none() {
            // Layers are everywhere.
            assert!(camera.forward().y > 0.0 && scene.layers().next().is_some());
            continue;
        }
        assert!(camera.position.z > scene.bounds().unwrap().1.z);
        assert!(camera.forward().z < 0.0 && camera.forward().x.abs() < 1e-9);
        assert_framed(&scene, &camera);
        scene.camera = Some(camera);
        scene.validate().unwrap();
    }
    // The clouds of a valley, below the eye, are framed too.
    let valley = Scene {
        clouds: vec![Cloud {
            ellipsoids: vec![Ellipsoid::new(DVec3::NEG_Y * 900.0, DVec3::splat(100.0))],
            ..Cloud::default()
        }],
        ..Scene::default()
    };
    assert_framed(&valley, &valley.camera());
}

/// All ellipsoids' boxes lie within the 16:9 picture of a perspective `camera`.
fn assert_framed(scene: &Scene, camera: &Camera) {
    let half_height = (0.5 * camera.projection.vertical_fov(16.0 / 9.0).unwrap()).tan();
    assert!(half_height <= 20.0_f64.to_radians().tan() + 1e-9);
    let camera_from_world = camera.world_from_camera().inverse();
    for ellipsoid in ellipsoids(scene) {
        let (min, max) = ellipsoid.bounds();
        for corner in [min, max, DVec3::new(min.x, max.y, max.z), DVec3::new(max.x, min.y, max.z)] {
            let p = camera_from_world * (corner - camera.position);
            assert!(p.z < 0.0);
            assert!(p.y.abs() <= -p.z * half_height, "{corner}");
            assert!(p.x.abs() <= -p.z * half_height * 16.0 / 9.0, "{corner}");
        }
    }
}

#[test]
fn camera_of_an_empty_scene_sees_the_horizon() {
    let scene = Scene::from_json(r#"{"ground":{"altitude":50}}"#).unwrap();
    let camera = scene.camera();
    assert_eq!(camera.position, DVec3::new(0.0, 51.7, 0.0));
    let elevation = camera.forward().y.asin().to_degrees();
    assert!((0.0..20.0).contains(&elevation), "{elevation}");
}

fn vector(low: f64, high: f64) -> impl Strategy<Value = DVec3> {
    [low..high, low..high, low..high].prop_map(DVec3::from_array)
}

prop_compose! {
    fn any_ellipsoid()(
        center in vector(-1e7, 1e7),
        radii in vector(0.01, 1e5),
        axis in vector(-1.0, 1.0),
        angle in -7.0..7.0f64,
    ) -> Ellipsoid {
        let orientation = DQuat::from_axis_angle(axis.normalize_or(DVec3::Y), angle);
        Ellipsoid { orientation, ..Ellipsoid::new(center, radii) }
    }
}

proptest! {
    #[test]
    fn bounds_touch_the_ellipsoid(ellipsoid in any_ellipsoid(), to in vector(-1.0, 1.0)) {
        let (min, max) = ellipsoid.bounds();
        let rounding = 1e-9 * (1.0 + max.abs().max(min.abs()).max_element());
        // No point of the surface lies outside...
        let p = ellipsoid.center + ellipsoid.orientation * (ellipsoid.radii * to.normalize_or(DVec3::Y));
        prop_assert!(p.cmpge(min - rounding).all() && p.cmple(max + rounding).all());
        // ...and the extreme one in +x, at A^2 x / |A x| for A = R diag(r), touches the box.
        let scaled = ellipsoid.radii * (ellipsoid.orientation.inverse() * DVec3::X);
        let extreme = ellipsoid.center + ellipsoid.orientation * (ellipsoid.radii * scaled.normalize());
        prop_assert!((extreme.x - max.x).abs() <= rounding);
    }
}
