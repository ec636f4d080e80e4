//! Clouds that grow: the same everywhere, flat below, in one piece, and short in files.

use glam::DVec3;
use nephos::scene::{
    Cloud, Ellipsoid, Growth, GrowthKind, MAX_ELLIPSOIDS, Preset, Scene, Timeline,
    timeline::{Key, Track},
};

/// Least and greatest number of ellipsoids of each kind as it is usual.
const COUNTS: [(GrowthKind, usize, usize); 7] = [
    (GrowthKind::Humilis, 120, 1400),
    (GrowthKind::Mediocris, 250, 2000),
    (GrowthKind::Congestus, 400, 2400),
    (GrowthKind::Cumulonimbus, 1000, 2400),
    (GrowthKind::Fractus, 80, 500),
    (GrowthKind::ClosedCells, 500, 2400),
    (GrowthKind::OpenCells, 400, 2400),
];

fn scene_of(growth: Growth) -> Scene {
    Scene { clouds: vec![Cloud::grown("one", growth)], ..Scene::default() }
}

/// Half the extent of an ellipsoid along a unit vector through its middle, m.
fn radius_along(ellipsoid: &Ellipsoid, way: DVec3) -> f64 {
    1.0 / (ellipsoid.orientation.inverse() * way / ellipsoid.radii).length()
}

fn overlap(a: &Ellipsoid, b: &Ellipsoid) -> bool {
    let distance = a.center.distance(b.center);
    let way = (b.center - a.center).normalize_or(DVec3::X);
    distance < radius_along(a, way) + radius_along(b, way)
}

#[test]
fn a_seed_gives_one_cloud_and_another_seed_another() {
    for kind in GrowthKind::ALL {
        let grown = |seed| Growth::new(kind, seed).ellipsoids();
        assert_eq!(grown(7), grown(7), "{kind:?}");
        assert_ne!(grown(7), grown(8), "{kind:?}");
    }
}

#[test]
fn each_kind_has_enough_lumps_and_not_too_many() {
    for (kind, least, most) in COUNTS {
        for seed in 0..6 {
            let count = Growth::new(kind, seed).ellipsoids().len();
            assert!((least..=most).contains(&count), "{kind:?} {seed}: {count}");
        }
    }
}

#[test]
fn bases_are_flat_and_at_the_height_of_the_place() {
    let uneven = [GrowthKind::Fractus, GrowthKind::ClosedCells];
    for kind in GrowthKind::ALL.into_iter().filter(|kind| !uneven.contains(kind)) {
        let growth = Growth { place: DVec3::new(30.0, 700.0, -20.0), ..Growth::new(kind, 3) };
        let cloud = Cloud::grown("cloud", growth);
        assert_eq!(cloud.level, Some(700.0), "{kind:?}");
        // What is below the level is cut off; most of each lump is above it. Middles are in decimetres.
        assert!(cloud.ellipsoids.iter().all(|e| e.center.y > 699.9), "{kind:?}");
        let cut = cloud.ellipsoids.iter().filter(|e| e.bounds().0.y < 700.0).count();
        assert!(cut >= 10, "{kind:?}: {cut}");
        assert_eq!(cloud.bounds().unwrap().0.y, 700.0, "{kind:?}");
    }
}

/// Height above the base of what of an ellipsoid is on a vertical line, m.
fn top_at(ellipsoid: &Ellipsoid, growth: &Growth, x: f64, z: f64) -> Option<f64> {
    let to_unit = |v: DVec3| ellipsoid.orientation.inverse() * v / ellipsoid.radii;
    let (from, along) = (to_unit(growth.place + DVec3::new(x, 0.0, z) - ellipsoid.center), to_unit(DVec3::Y));
    let (a, b, c) = (along.length_squared(), along.dot(from), from.length_squared() - 1.0);
    let top = (-b + (b * b - a * c).sqrt()) / a;
    (top > 0.0).then_some(top)
}

#[test]
fn flat_clouds_are_no_plates_with_a_chimney() {
    let (mut low, mut all) = (0, 0);
    for seed in 0..8 {
        let growth =
            Growth { width: 900.0, height: 300.0, lean: 0.0, ..Growth::new(GrowthKind::Mediocris, seed) };
        let lumps = growth.ellipsoids();
        for i in 0..40 * 40 {
            let [x, z] = [i % 40, i / 40].map(|j| growth.width * (f64::from(j) / 39.0 - 0.5));
            let top = lumps.iter().filter_map(|lump| top_at(lump, &growth, x, z)).fold(0.0, f64::max);
            all += usize::from(top > 0.0);
            low += usize::from(top > 0.0 && top < 0.25 * growth.height);
        }
    }
    let share = low as f64 / all as f64;
    eprintln!("{share:.3} of {all} columns are low");
    assert!(share < 0.2, "{share}");
}

#[test]
fn no_lump_floats_alone() {
    for kind in GrowthKind::ALL {
        for seed in 0..4 {
            let lumps = Growth::new(kind, seed).ellipsoids();
            let touches = |i: usize| (0..lumps.len()).any(|j| j != i && overlap(&lumps[i], &lumps[j]));
            let alone = (0..lumps.len()).filter(|i| !touches(*i)).count();
            // A patch of stratocumulus may be a single flat lump.
            let few = if matches!(kind, GrowthKind::ClosedCells | GrowthKind::OpenCells) {
                lumps.len() / 50
            } else {
                0
            };
            assert!(alone <= few, "{kind:?} {seed}: {alone} of {}", lumps.len());
        }
    }
}

#[test]
fn numbers_are_followed() {
    for kind in [GrowthKind::Humilis, GrowthKind::Mediocris, GrowthKind::Congestus] {
        let usual = Growth::new(kind, 5);
        let size = |growth: &Growth| {
            let (low, high) = scene_of(growth.clone()).bounds().unwrap();
            high - low
        };
        let tall = size(&Growth { height: 1.5 * usual.height, ..usual.clone() });
        let ratio = tall.y / size(&usual).y;
        assert!((1.3..1.7).contains(&ratio), "{kind:?}: {ratio}");
        let wide = size(&Growth { width: 2.0 * usual.width, ..usual.clone() });
        assert!(wide.x > 1.3 * size(&usual).x, "{kind:?}: {wide} {}", size(&usual));
        let few = Growth { detail: 0.2, ..usual.clone() }.ellipsoids().len();
        assert!(2 * few < usual.ellipsoids().len(), "{kind:?}: {few}");
        let old = size(&Growth { age: 1.0, ..usual.clone() });
        assert!(old.y < 0.85 * size(&usual).y, "{kind:?}");
    }
}

#[test]
fn leaning_goes_where_the_heading_says() {
    let upright = Growth { lean: 0.0, ..Growth::new(GrowthKind::Congestus, 5) };
    let top = |growth: &Growth| {
        let lumps = growth.ellipsoids();
        lumps.into_iter().max_by(|a, b| a.center.y.total_cmp(&b.center.y)).unwrap().center
    };
    let straight = top(&upright);
    for (heading_deg, to) in [(90.0, DVec3::X), (0.0, DVec3::NEG_Z), (270.0, DVec3::NEG_X), (180.0, DVec3::Z)]
    {
        let turned = Growth { heading_deg, ..upright.clone() };
        let leaning = top(&Growth { lean: 0.6, ..turned.clone() }) - top(&turned);
        assert!(leaning.with_y(0.0).dot(to) > 400.0, "{heading_deg}: {leaning}");
    }
    assert_eq!(straight, top(&upright));
}

/// The same chance falls for a lump whatever its neighbours do: a slider that moves a little moves little.
#[test]
fn a_number_that_changes_a_little_changes_little() {
    let usual = Growth::new(GrowthKind::Congestus, 2);
    let higher = Growth { height: usual.height * 1.01, ..usual.clone() };
    let (a, b) = (usual.ellipsoids(), higher.ellipsoids());
    let near = |e: &Ellipsoid| b.iter().any(|o| o.center.distance(e.center) < 60.0);
    let kept = a.iter().filter(|e| near(e)).count();
    assert!(kept * 10 > a.len() * 8, "{kept} of {}", a.len());
}

#[test]
fn a_file_says_how_it_grows_and_no_more() {
    let scene = scene_of(Growth { width: 700.0, ..Growth::new(GrowthKind::Mediocris, 9) });
    let text = scene.to_json();
    assert!(!text.contains("ellipsoids") && text.len() < 3000, "{}", text.len());
    assert_eq!(Scene::from_json(&text).unwrap(), scene);
    assert_eq!(Scene::from_json(&text).unwrap().to_json(), text);
}

#[test]
fn what_is_left_out_is_as_usual_for_the_kind() {
    let read = |text: &str| Scene::from_json(text).unwrap().clouds.remove(0).growth.unwrap();
    let growth = read(r#"{"clouds": [{"growth": {"kind": "congestus", "seed": 4}}]}"#);
    assert_eq!(growth, Growth::new(GrowthKind::Congestus, 4));
    let half = read(r#"{"clouds": [{"growth": {"kind": "congestus", "width": 1300}}]}"#);
    assert_eq!(half.height, 0.5 * Growth::new(GrowthKind::Congestus, 0).height);
}

#[test]
fn a_hand_that_changes_an_ellipsoid_leaves_ellipsoids_in_the_file() {
    let mut scene = scene_of(Growth::new(GrowthKind::Humilis, 1));
    scene.clouds[0].ellipsoids[3].density = 0.5;
    let read = Scene::from_json(&scene.to_json()).unwrap();
    assert_eq!(read.clouds[0].growth, None);
    assert_eq!(read.clouds[0].ellipsoids, scene.clouds[0].ellipsoids);
}

#[test]
fn what_grows_is_checked_at_the_door() {
    for (text, words) in [
        (
            r#"{"clouds": [{"growth": {"kind": "humilis", "width": 0}}]}"#,
            "clouds[0].growth.width: 0 is out of range: expected 1 to 100000 metres",
        ),
        (r#"{"clouds": [{"growth": {"kind": "humulis"}}]}"#, "did you mean `humilis`?"),
        (
            r#"{"clouds": [{"growth": {"kind": "humilis"}, "ellipsoids": [{"center": [0,0,0], "radii": [1,1,1]}]}]}"#,
            "it has both `growth` and 1 `ellipsoids`: leave out",
        ),
        (r#"{"clouds": [{"growth": {"kind": "humilis", "hight": 3}}]}"#, "did you mean `height`?"),
        (r#"{"clouds": [{"growth": {"seed": 3}}]}"#, "missing field `kind`"),
    ] {
        let error = Scene::from_json(text).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let many =
        format!(r#"{{"clouds": [{}]}}"#, vec![r#"{"growth": {"kind": "cumulonimbus"}}"#; 80].join(", "));
    let error = Scene::from_json(&many).unwrap_err().to_string();
    assert!(error.contains(&format!("expected at most {MAX_ELLIPSOIDS}")), "{error}");
}

#[test]
fn tracks_move_a_growth_and_not_what_grew() {
    let track = |path: &str, low: f64, high: f64| Timeline {
        tracks: vec![Track { path: path.to_owned(), keys: vec![Key::new(0.0, low), Key::new(10.0, high)] }],
        ..Timeline::default()
    };
    let mut scene = scene_of(Growth::new(GrowthKind::Mediocris, 1));
    scene.timeline = Some(track("clouds['one'].growth.height", 300.0, 900.0));
    scene.validate().unwrap();
    let height = |time: f64| scene.at(time).unwrap().bounds().unwrap().1.y - 1000.0;
    assert!(height(10.0) > 1.8 * height(0.0), "{} {}", height(0.0), height(10.0));
    scene.timeline = Some(track("clouds[0].growth.height", 300.0, 90_000.0));
    assert!(scene.validate().unwrap_err().to_string().contains("1 to 30000 metres"));
    scene.timeline = Some(track("clouds[0].ellipsoids[2].density", 0.0, 1.0));
    let error = scene.validate().unwrap_err().to_string();
    assert!(error.contains("animate a number of its growth, such as clouds['one'].growth.height"), "{error}");
}

#[test]
fn a_program_may_say_only_how_a_cloud_grows() {
    let growth = Growth::new(GrowthKind::Humilis, 1);
    let bare = Scene {
        clouds: vec![Cloud { growth: Some(growth.clone()), ..Cloud::default() }],
        ..Scene::default()
    };
    assert_eq!(bare.at(0.0).unwrap().clouds[0].ellipsoids, growth.ellipsoids());
}

#[test]
fn a_cloud_is_carried_with_its_growth() {
    let mut cloud = Cloud::grown("one", Growth::new(GrowthKind::Humilis, 1));
    let before = cloud.bounds().unwrap();
    cloud.shift(DVec3::new(100.0, -50.0, 7.0));
    assert!(cloud.is_as_grown());
    assert!((cloud.bounds().unwrap().0 - before.0).distance(DVec3::new(100.0, -50.0, 7.0)) < 1e-6);
}

#[test]
fn extremes_of_all_numbers_grow_something_valid() {
    for kind in GrowthKind::ALL {
        for (width, height) in [(1.0, 1.0), (1e5, 1.0), (1.0, 3e4), (1e5, 3e4)] {
            for (lean, coverage, age, detail) in [(-2.0, 0.05, 0.0, 0.0), (2.0, 1.0, 1.0, 1.0)] {
                let growth = Growth {
                    width,
                    height,
                    lean,
                    coverage,
                    age,
                    detail,
                    heading_deg: -77.0,
                    ..Growth::new(kind, 4)
                };
                let scene = scene_of(growth);
                let count = scene.clouds[0].ellipsoids.len();
                assert!((1..=2400).contains(&count), "{kind:?} {width} {height}: {count}");
                scene.validate().unwrap();
            }
        }
    }
}

#[test]
fn a_sky_of_cumuli_has_sizes_by_a_power_law_on_one_level() {
    for seed in 0..5 {
        let scene = Preset::Field.scene(seed);
        scene.validate().unwrap();
        assert!((60..=200).contains(&scene.clouds.len()), "{}", scene.clouds.len());
        let growths: Vec<&Growth> = scene.clouds.iter().filter_map(|cloud| cloud.growth.as_ref()).collect();
        assert_eq!(growths.len(), scene.clouds.len());
        assert!(growths.iter().all(|growth| growth.place.y == growths[0].place.y));
        let wider = |than: f64| growths.iter().filter(|growth| growth.width > than).count();
        assert!(wider(400.0) > 2 * wider(1000.0), "{} {}", wider(400.0), wider(1000.0));
    }
}

#[test]
#[ignore = "prints the table of docs/growth.md"]
fn table() {
    for kind in GrowthKind::ALL {
        let counts: Vec<usize> = (0..6).map(|seed| Growth::new(kind, seed).ellipsoids().len()).collect();
        let since = std::time::Instant::now();
        let rounds: u32 = 5;
        (0..rounds).for_each(|seed| drop(Growth::new(kind, seed).ellipsoids()));
        let ms = 1e3 * since.elapsed().as_secs_f64() / f64::from(rounds);
        let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
        println!("| {kind:?} | {least} to {most} | {ms:.1} |");
    }
}
