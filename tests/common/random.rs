//! Random valid scenes, small and from all over what a scene may be, for tests of properties.

use std::{
    cell::RefCell,
    time::{Duration, Instant},
};

use glam::{DQuat, DVec3};
use nephos::scene::{
    Camera, Cloud, Droplets, Edge, Ellipsoid, Noise, Phase, Projection, Scene, Sky, Sun, SunPosition,
};
use proptest::{
    prelude::*,
    test_runner::{Config, FileFailurePersistence, RngAlgorithm, TestRng, TestRunner},
};

/// What is asked of scenes: of half of them, of 99 in a hundred, and of each. Where they are too few
/// to tell, each is one of the 99.
#[derive(Clone, Copy)]
pub struct Bounds {
    pub half: f64,
    pub most: f64,
    pub all: f64,
}

/// So many scenes tell what is one in a hundred.
pub const ENOUGH: u32 = 100;

/// Measures `cases` scenes that show something, the same every time, and asks that no value be above
/// its bound; what fails is shrunk and its seed kept. Says the worst values, and writes their scenes
/// to `target/tmp`. With NEPHOS_GO_ON it goes on past what fails; with NEPHOS_SCENE it measures the
/// scene in that file, and no other.
pub fn check<S: Strategy<Value = Scene>>(
    cases: u32,
    strategy: &S,
    bounds: Bounds,
    measure: impl Fn(Scene) -> Option<f64>,
) {
    if let Ok(path) = std::env::var("NEPHOS_SCENE") {
        return check_file(&path, bounds, measure);
    }
    let kept = FileFailurePersistence::Direct("tests/picture/random_scenes.seeds");
    let config = Config {
        cases,
        max_shrink_iters: 60,
        max_global_rejects: 4 * cases + 100,
        failure_persistence: Some(Box::new(kept)),
        source_file: Some("tests/picture/random_scenes.rs"),
        ..Config::default()
    };
    let each = if cases < ENOUGH { bounds.most } else { bounds.all };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let go_on = std::env::var_os("NEPHOS_GO_ON").is_some();
    let (values, start) = (RefCell::new(Vec::new()), Instant::now());
    let result = TestRunner::new_with_rng(config, rng).run(strategy, |scene| {
        let value = measure(scene.clone()).ok_or_else(|| TestCaseError::reject("nothing is seen"))?;
        values.borrow_mut().push((value, scene));
        prop_assert!(value <= each || go_on, "{value:.2e}, and at most {each} is expected");
        Ok(())
    });
    let [half, most] = report(values.into_inner(), bounds, start.elapsed());
    if let Err(failure) = result {
        panic!("{failure}");
    }
    if cases >= ENOUGH {
        assert!(half <= bounds.half, "half of the scenes are above {half:.2e}");
        assert!(most <= bounds.most, "one in a hundred scenes is above {most:.2e}");
    }
}

#[allow(clippy::print_stdout, reason = "what was asked for")]
fn check_file(path: &str, bounds: Bounds, measure: impl Fn(Scene) -> Option<f64>) {
    let text = std::fs::read_to_string(path).expect("NEPHOS_SCENE names a file");
    let value = measure(Scene::from_json(&text).expect("the scene is valid"));
    println!("{}: {value:.4?} of {:.0e}", name(), bounds.all);
    assert!(value.is_none_or(|value| value <= bounds.all));
}

/// The name of the test.
fn name() -> String {
    std::thread::current().name().unwrap_or("property").replace("::", "-")
}

/// One line of what was measured, by the name of the test; gives what half and 99 % are below.
#[allow(clippy::print_stdout, reason = "what a long run measured")]
fn report(mut values: Vec<(f64, Scene)>, bounds: Bounds, time: Duration) -> [f64; 2] {
    let name = name();
    values.sort_by(|a, b| b.0.total_cmp(&a.0));
    let [half, most] = [2, 100].map(|part| values[values.len() / part].0);
    println!(
        "{name}: {} scenes, half below {half:.1e} of {:.0e}, 99 % below {most:.1e} of {:.0e}, all below {:.1e} of {:.0e}, {:.0} s",
        values.len(),
        bounds.half,
        bounds.most,
        values[0].0,
        bounds.all,
        time.as_secs_f64()
    );
    for (i, (value, scene)) in values.iter().take(3).enumerate() {
        let path = format!("{}/{name}-{i}.json", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, scene.to_json()).expect("the folder of the build can be written");
        println!("    {value:.1e} {path}");
    }
    [half, most]
}

/// Numbers whose logarithms are evenly spread.
fn log(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

fn direction() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0, 0.0..std::f64::consts::TAU).prop_map(|(y, angle): (f64, f64)| {
        let level = (1.0 - y * y).sqrt();
        DVec3::new(level * angle.cos(), y, level * angle.sin())
    })
}

fn turn() -> impl Strategy<Value = DQuat> {
    (direction(), 0.0..std::f64::consts::PI).prop_map(|(axis, angle)| DQuat::from_axis_angle(axis, angle))
}

fn edge() -> impl Strategy<Value = Edge> {
    (prop_oneof![1 => Just(0.0), 5 => log(0.3, 300.0)], 0.0..=1.0)
        .prop_map(|(boundary, wispiness)| Edge { boundary, wispiness })
}

/// An ellipsoid within some 300 m.
fn ellipsoid() -> impl Strategy<Value = Ellipsoid> {
    let radii = [log(3.0, 400.0), log(3.0, 400.0), log(3.0, 400.0)];
    let density = prop_oneof![4 => Just(1.0), 1 => 0.0..3.0];
    (direction(), 0.0..300.0, radii, turn(), density, proptest::option::of(edge())).prop_map(
        |(way, out, radii, orientation, density, edge)| Ellipsoid {
            orientation,
            density,
            edge,
            ..Ellipsoid::new(out * way, radii.into())
        },
    )
}

/// Few kinds, for their tables take time.
fn droplets() -> impl Strategy<Value = Droplets> {
    let kind = prop_oneof![
        3 => Just((Phase::Mie, 1.0)),
        1 => Just((Phase::HenyeyGreenstein { g: -0.5 }, 1.0)),
        1 => Just((Phase::Isotropic, 0.9)),
    ];
    (log(0.1, 1e5), kind).prop_map(|(concentration_per_cm3, (phase, albedo))| Droplets {
        concentration_per_cm3,
        phase,
        albedo,
        ..Droplets::default()
    })
}

fn cloud() -> impl Strategy<Value = Cloud> {
    let place = (direction(), 0.0..1000.0);
    let level = proptest::option::weighted(0.25, -200.0..100.0f64);
    let body = (0.0..=1.0, share(), share(), proptest::option::weighted(0.25, noise()), level);
    (proptest::collection::vec(ellipsoid(), 1..6), droplets(), edge(), place, body).prop_map(
        |(mut ellipsoids, droplets, edge, (way, out), (blend, stratification, dilution, noise, level))| {
            let middle: DVec3 = 1500.0 * DVec3::Y + out * way;
            ellipsoids.iter_mut().for_each(|e| e.center += middle);
            let level = level.map(|above| middle.y + above);
            Cloud {
                ellipsoids,
                droplets,
                edge,
                blend,
                level,
                stratification,
                dilution,
                noise,
                ..Cloud::default()
            }
        },
    )
}

/// Often none at all.
fn share() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 1 => 0.0..=1.0]
}

/// Noise of any kind whose size is that of its cloud.
fn noise() -> impl Strategy<Value = Noise> {
    (any::<u32>(), 0.0..=1.0, 2.0..=2.9, turn()).prop_map(|(seed, detail, dimension, rotation)| Noise {
        seed,
        detail,
        dimension,
        rotation,
        ..Noise::default()
    })
}

fn camera() -> impl Strategy<Value = Camera> {
    let projection = prop_oneof![
        4 => (5.0..120.0).prop_map(|vertical_fov_deg| Projection::Perspective { vertical_fov_deg }),
        1 => log(10.0, 5000.0).prop_map(|height| Projection::Orthographic { height }),
        1 => Just(Projection::Equirectangular),
    ];
    (direction(), log(1.0, 1e4), 0.0..360.0, projection).prop_map(|(way, distance, roll_deg, projection)| {
        Camera { position: distance * way, target: DVec3::ZERO, roll_deg, projection, ..Camera::default() }
    })
}

fn looking_at(target: DVec3, camera: Camera) -> Camera {
    Camera { position: target + camera.position, target, ..camera }
}

fn sky() -> impl Strategy<Value = Sky> {
    prop_oneof![2 => Just(Sky::default()), 1 => Just(white()), 1 => Just(Sky::None)]
}

/// The same light from everywhere.
pub fn white() -> Sky {
    Sky::Uniform { radiance: [1.0; 3] }
}

/// Any scene.
pub fn scenes() -> impl Strategy<Value = Scene> {
    let clouds = proptest::collection::vec(cloud(), 1..4);
    let noise = (log(1.0, 1000.0), noise());
    let sun = (0.0..360.0, -10.0..90.0);
    (clouds, noise, sun, sky(), camera()).prop_map(
        |(clouds, (scale, noise), (azimuth_deg, elevation_deg), sky, camera)| Scene {
            camera: Some(looking_at(clouds[0].ellipsoids[0].center, camera)),
            clouds,
            noise: Noise { scale: Some(scale), ..noise },
            sun: Sun { position: SunPosition::Angles { azimuth_deg, elevation_deg }, ..Sun::default() },
            sky,
            ..Scene::default()
        },
    )
}
