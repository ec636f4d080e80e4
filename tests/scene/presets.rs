//! Presets: the same clouds everywhere, in the proportions of their kind.

use std::fs;

use nephos::scene::{Ellipsoid, MAX_ELLIPSOIDS, Phase, Preset, Scene, Sky};

/// Presets whose clouds are heaps over a flat base.
const HEAPS: [Preset; 4] = [Preset::Humilis, Preset::Mediocris, Preset::Congestus, Preset::Cumulonimbus];

fn ellipsoids(scene: &Scene) -> impl Iterator<Item = &Ellipsoid> {
    scene.clouds.iter().flat_map(|cloud| &cloud.ellipsoids)
}

#[test]
fn presets_survive_a_round_trip() {
    for preset in Preset::ALL {
        for seed in [0, 1, u64::MAX] {
            let scene = preset.scene(seed);
            assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene, "{preset}");
        }
    }
}

#[test]
fn example_files_are_what_the_presets_give() {
    // To renew one: nephos new --preset NAME --force -o examples/scenes/NAME.json
    for preset in Preset::ALL {
        let path = format!("{}/examples/scenes/{preset}.json", env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(&path).unwrap();
        assert!(text == preset.scene(1).to_json(), "{path} is stale");
        assert_eq!(Scene::load(&path).unwrap(), preset.scene(1));
    }
}

#[test]
fn presets_are_valid_and_of_moderate_size() {
    for preset in Preset::ALL {
        for seed in 0..10 {
            let scene = preset.scene(seed);
            scene.validate().unwrap();
            let count = ellipsoids(&scene).count();
            let expected = match preset {
                Preset::Sphere => 1..=1,
                Preset::Kol | Preset::Glory => 8..=8,
                Preset::Fractus => 80..=500,
                Preset::Field => 5000..=MAX_ELLIPSOIDS,
                Preset::Drift => 150..=2400,
                Preset::Humilis => 100..=700,
                _ if scene.layers().next().is_some() => 0..=0,
                _ => 250..=2400,
            };
            assert!(expected.contains(&count), "{preset} {seed}: {count}");
        }
    }
}

#[test]
fn presets_differ_by_seed_and_by_nothing_else() {
    for preset in Preset::ALL {
        assert_eq!(preset.scene(7), preset.scene(7));
        assert_ne!(preset.scene(7), preset.scene(8));
        assert_ne!(preset.scene(7).noise.seed, preset.scene(7 << 32 | 9).noise.seed);
    }
}

#[test]
fn heaps_have_a_flat_base_and_nothing_below_it() {
    for preset in HEAPS.into_iter().chain([Preset::OpenCells]) {
        for seed in 0..10 {
            let scene = preset.scene(seed);
            assert!(scene.clouds.iter().all(|cloud| cloud.level == Some(1000.0)), "{preset} {seed}");
            let wide = ellipsoids(&scene).filter(|e| e.bounds().0.y < 1000.0 && e.center.y > 1000.0);
            assert!(wide.count() >= 5, "{preset} {seed}");
            assert_eq!(scene.bounds().unwrap().0.y, 1000.0, "{preset} {seed}");
        }
    }
}

#[test]
fn presets_have_the_proportions_of_their_kind() {
    for seed in 0..30 {
        let size = |preset: Preset| {
            let (min, max) = preset.scene(seed).bounds().unwrap();
            max - min
        };
        let humilis = size(Preset::Humilis);
        assert!((240.0..650.0).contains(&humilis.x) && humilis.y < 0.7 * humilis.x, "{humilis}");
        let mediocris = size(Preset::Mediocris);
        assert!((0.4..1.3).contains(&(mediocris.y / mediocris.x)), "{mediocris}");
        let congestus = size(Preset::Congestus);
        assert!((1900.0..3000.0).contains(&congestus.y), "{congestus}");
        let storm = size(Preset::Cumulonimbus);
        assert!((9000.0..11_000.0).contains(&storm.y) && storm.x > 1.5 * storm.y, "{storm}");
        let tower = size(Preset::Tower);
        assert!(tower.y > tower.z && tower.y > 1800.0, "{tower}");
        let kol = size(Preset::Kol);
        assert!((390.0..410.0).contains(&kol.x), "{kol}");
    }
}

#[test]
fn density_grows_with_height_and_tops_are_crisp() {
    for preset in HEAPS {
        let cloud = &preset.scene(1).clouds[0];
        assert!(cloud.stratification > 0.5 && cloud.edge.wispiness <= 0.15, "{preset}");
        assert!(cloud.noise.is_some() && cloud.growth.is_some(), "{preset}");
    }
}

#[test]
fn the_sun_stands_at_the_side_and_the_horizon_low_in_the_picture() {
    for preset in HEAPS.into_iter().chain([Preset::Fractus, Preset::Tower, Preset::Field]) {
        let scene = preset.scene(1);
        let (camera, to_sun) = (scene.camera(), scene.sun.to_sun());
        let aside = to_sun.with_y(0.0).normalize().dot(camera.forward().with_y(0.0).normalize());
        // 60 to 75 degrees from behind the camera.
        assert!((-0.5..=-0.25).contains(&aside), "{preset}: {aside}");
        assert!((25.0..=35.0).contains(&to_sun.y.asin().to_degrees()), "{preset}");
        // Half the picture is tan(20 degrees) high: the horizon is in the lower third of it.
        let rise = camera.forward().y / camera.forward().with_y(0.0).length();
        assert!((0.12..0.34).contains(&rise), "{preset}: {rise}");
        let (low, _) = scene.clouds[0].bounds().unwrap();
        assert!(camera.position.y < low.y, "{preset}");
    }
}

#[test]
fn glory_is_seen_with_the_sun_behind_and_the_fogbow_in_the_picture() {
    let scene = Preset::Glory.scene(1);
    let camera = scene.camera();
    assert!(camera.forward().dot(scene.sun.to_sun()) < -1.0 + 1e-9);
    assert!(camera.position.y > scene.bounds().unwrap().1.y + 100.0);
    assert!(camera.projection.vertical_fov(1.0).unwrap().to_degrees() >= 84.0);
    assert_eq!(scene.clouds[0].droplets.phase, Phase::Mie);
    assert!(matches!(scene.sky, Sky::Atmosphere(_)));
}

#[test]
fn preset_names_are_read_and_near_ones_offered() {
    for preset in Preset::ALL {
        assert_eq!(preset.to_string().parse::<Preset>().unwrap(), preset);
    }
    let error = "cumulonimbis".parse::<Preset>().unwrap_err().to_string();
    assert!(error.contains("did you mean `cumulonimbus`?"), "{error}");
    assert!(error.contains("humilis, mediocris, congestus"), "{error}");
}
