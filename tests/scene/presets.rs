//! Presets: the same clouds everywhere, in the proportions of their kind.

use std::fs;

use nephos::scene::{Ellipsoid, Phase, Preset, Scene, Sky};

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
        for seed in 0..50 {
            let scene = preset.scene(seed);
            scene.validate().unwrap();
            let count = ellipsoids(&scene).count();
            let expected = match preset {
                Preset::Sphere => 1..=1,
                Preset::Stratocumulus | Preset::Drift => 60..=170,
                _ => 8..=80,
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
    // Files hold decimetres; the sum of centre and radius is exact to rounding.
    let rounding = 1e-6;
    for preset in HEAPS.into_iter().chain([Preset::Stratocumulus, Preset::Glory]) {
        for seed in 0..50 {
            let scene = preset.scene(seed);
            let base = if preset == Preset::Stratocumulus { 1200.0 } else { 1000.0 };
            let bottoms: Vec<f64> = ellipsoids(&scene).map(|e| e.bounds().0.y).collect();
            assert!(bottoms.iter().all(|y| *y > base - rounding), "{preset} {seed}");
            let flat = bottoms.iter().filter(|y| (**y - base).abs() < rounding);
            assert!(flat.count() >= 5, "{preset} {seed}");
            let lowest = ellipsoids(&scene).next().unwrap();
            assert!(lowest.radii.y < lowest.radii.x && lowest.radii.y < lowest.radii.z);
        }
    }
}

#[test]
fn presets_have_the_proportions_of_their_kind() {
    for seed in 0..50 {
        let size = |preset: Preset| {
            let (min, max) = preset.scene(seed).bounds().unwrap();
            max - min
        };
        let humilis = size(Preset::Humilis);
        assert!((200.0..500.0).contains(&humilis.x) && humilis.y < 0.7 * humilis.x, "{humilis}");
        let mediocris = size(Preset::Mediocris);
        assert!((0.6..1.4).contains(&(mediocris.y / mediocris.x)), "{mediocris}");
        let congestus = size(Preset::Congestus);
        assert!((2000.0..3000.0).contains(&congestus.y), "{congestus}");
        assert!(congestus.y > congestus.x.max(congestus.z), "{congestus}");
        let storm = size(Preset::Cumulonimbus);
        assert!((6000.0..9000.0).contains(&storm.y), "{storm}");
        let kol = size(Preset::Kol);
        assert!((390.0..410.0).contains(&kol.x), "{kol}");
    }
}

#[test]
fn tops_are_sharp_and_bases_wispy() {
    let scene = Preset::Congestus.scene(1);
    let by_height = |a: &&Ellipsoid, b: &&Ellipsoid| a.center.y.total_cmp(&b.center.y);
    let lowest = ellipsoids(&scene).min_by(by_height).unwrap();
    let highest = ellipsoids(&scene).max_by(by_height).unwrap();
    assert!(highest.edge.as_ref().unwrap().wispiness <= 0.15);
    assert!(lowest.edge.as_ref().unwrap().wispiness > 0.25);
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
