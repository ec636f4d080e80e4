//! Scenes over time: curves, paths, lives, wind, and loops that close.

use glam::DVec3;
use nephos::scene::{
    Cloud, Evaporation, Life, Noise, Preset, Scene, Timeline,
    timeline::{Curve, Interpolation, Key, Owner, Place, Track, owner_path},
};

fn key(time: f64, value: f64, interpolation: Interpolation) -> Key {
    Key { interpolation, ..Key::new(time, value) }
}

fn curve(keys: &[Key]) -> Curve {
    Curve::new(keys, None).unwrap()
}

fn track(path: &str, keys: &[Key]) -> Track {
    Track { path: path.to_owned(), keys: keys.to_vec() }
}

fn scene(tracks: Vec<Track>) -> Scene {
    Scene { timeline: Some(Timeline { tracks, ..Timeline::default() }), ..heap() }
}

/// A heap whose ellipsoids are its own: it does not grow.
fn heap() -> Scene {
    let mut scene = Preset::Humilis.scene(1);
    scene.clouds[0].growth = None;
    scene.clouds[0].evaporation = Evaporation::default();
    scene.clouds[0].ellipsoids.truncate(30);
    scene
}

/// A cloud in a loop of ten seconds, with wind.
fn looping() -> Scene {
    let mut scene = scene(Vec::new());
    scene.timeline.as_mut().unwrap().looped = true;
    scene.wind.velocity = DVec3::new(12.0, 0.0, -3.0);
    scene
}

fn complaint(scene: &Scene) -> String {
    scene.validate().unwrap_err().to_string()
}

// --- Curves -------------------------------------------------------------------------

#[test]
fn steps_stay_lines_go_evenly_and_both_hold_outside() {
    let curve = curve(&[
        key(1.0, 5.0, Interpolation::Step),
        key(3.0, 9.0, Interpolation::Linear),
        key(5.0, 1.0, Interpolation::Linear),
    ]);
    let expected = [(0.0, 5.0), (1.0, 5.0), (2.9, 5.0), (3.0, 9.0), (4.0, 5.0), (5.0, 1.0), (99.0, 1.0)];
    for (time, value) in expected {
        assert_eq!(curve.at(time), value, "at {time}");
    }
}

#[test]
fn cubic_follows_the_bezier_curve_of_its_handles() {
    // Handles at a third of the way give time = parameter: the value is Bernstein's sum.
    let keys = [
        Key { after: Some([2.0, 6.0]), ..Key::new(0.0, 1.0) },
        Key { before: Some([-2.0, 3.0]), ..Key::new(6.0, 4.0) },
    ];
    let curve = curve(&keys);
    for i in 0..=60 {
        let s = f64::from(i) / 60.0;
        let r = 1.0 - s;
        let expected = r * r * r + 3.0 * r * r * s * 7.0 + 3.0 * r * s * s * 7.0 + s * s * s * 4.0;
        assert!((curve.at(6.0 * s) - expected).abs() < 1e-12, "{s}");
    }
    // One by hand where times are no thirds: x(s) = s^3 + 3 s^2 (1-s) = 1/2 for handles of full length.
    let ease = [
        Key { after: Some([1.0, 0.0]), ..Key::new(0.0, 0.0) },
        Key { before: Some([-1.0, 0.0]), ..Key::new(1.0, 1.0) },
    ];
    let ease = Curve::new(&ease, None).unwrap();
    // In the middle time stands still along the curve: a double finds the place to its cube root.
    assert!((ease.at(0.5) - 0.5).abs() < 2e-5);
    let s: f64 = 0.2;
    let time = 3.0 * s * (1.0 - s).powi(2) + s.powi(3);
    assert!((ease.at(time) - s * s * (3.0 - 2.0 * s)).abs() < 1e-12);
}

#[test]
fn handles_that_are_too_long_never_turn_time_back() {
    let keys = [
        Key { after: Some([50.0, 10.0]), ..Key::new(0.0, 0.0) },
        Key { before: Some([-70.0, -10.0]), ..Key::new(1.0, 1.0) },
    ];
    let curve = curve(&keys);
    let mut before = curve.at(0.0);
    for i in 1..=1000 {
        let now = curve.at(f64::from(i) / 1000.0);
        assert!((now - before).abs() < 0.1 && now >= before - 1e-12, "jumps or turns at {i}");
        before = now;
    }
}

#[test]
fn smooth_handles_stay_between_their_keys() {
    let values = [0.0, 1.0, 1.0, 0.2, 0.21, 5.0, 4.0];
    let keys: Vec<Key> = values.iter().enumerate().map(|(i, v)| Key::new((i * i) as f64, *v)).collect();
    let curve = curve(&keys);
    for pair in keys.windows(2) {
        let (low, high) = (pair[0].value.min(pair[1].value), pair[0].value.max(pair[1].value));
        for i in 0..=50 {
            let time = pair[0].time + (pair[1].time - pair[0].time) * f64::from(i) / 50.0;
            let value = curve.at(time);
            assert!(value >= low - 1e-12 && value <= high + 1e-12, "{value} at {time}");
        }
    }
    // What stays the same stays the same to the last bit: nothing is drawn again for it.
    let still = Curve::new(&[Key::new(0.0, 0.1), Key::new(1.0, 0.1), Key::new(7.0, 0.1)], None).unwrap();
    assert!((0..700).all(|i| still.at(f64::from(i) * 0.01) == 0.1));
}

#[test]
fn integral_is_that_of_the_curve() {
    let keys = [
        key(1.0, 2.0, Interpolation::Step),
        key(2.0, -1.0, Interpolation::Linear),
        Key { after: Some([0.9, 3.0]), ..Key::new(4.0, 3.0) },
        Key { before: Some([-0.2, 1.0]), ..Key::new(7.0, 0.5) },
    ];
    for period in [None, Some(8.0)] {
        let curve = Curve::new(&keys, period).unwrap();
        // The midpoint rule in steps of 1 ms: its error is below 1e-4 here, most of it at jumps.
        let (mut sum, step) = (0.0, 1e-3);
        for i in 0..20_000 {
            let time = f64::from(i) * step;
            if i % 1000 == 0 {
                let exact = curve.integral(time);
                assert!((exact - sum).abs() < 4e-3, "{period:?} at {time}: {exact}, summed up {sum}");
            }
            sum += step * curve.at(time + 0.5 * step);
        }
    }
}

#[test]
fn in_a_loop_the_last_key_leads_to_the_first() {
    let keys = [Key::new(1.0, 0.0), Key::new(4.0, 6.0), Key::new(9.0, 2.0)];
    let curve = Curve::new(&keys, Some(10.0)).unwrap();
    for (a, b) in [(0.0, 10.0), (0.5, 10.5), (3.0, -7.0), (9.5, 29.5)] {
        assert_eq!(curve.at(a), curve.at(b), "{a} and {b}");
    }
    // No jump and no kink anywhere, the seam included.
    let slope = |time: f64| (curve.at(time + 1e-5) - curve.at(time - 1e-5)) / 2e-5;
    for i in 0..1000 {
        let time = f64::from(i) * 0.01;
        assert!((slope(time + 1e-4) - slope(time - 1e-4)).abs() < 5e-3, "a kink at {time}");
    }
}

// --- Paths --------------------------------------------------------------------------

#[test]
fn every_number_of_a_scene_has_a_path_and_can_be_moved() {
    // All leaves of the JSON of a scene with everything, found without a list.
    fn leaves(value: &serde_json::Value, path: &str, found: &mut Vec<String>) {
        match value {
            serde_json::Value::Number(_) => found.push(path.to_owned()),
            serde_json::Value::Array(list) => {
                list.iter().enumerate().for_each(|(i, v)| leaves(v, &format!("{path}[{i}]"), found));
            }
            serde_json::Value::Object(fields) => fields.iter().for_each(|(name, v)| {
                leaves(v, &if path.is_empty() { name.clone() } else { format!("{path}.{name}") }, found);
            }),
            _ => {}
        }
    }
    let mut scene = Preset::Sphere.scene(1);
    scene.clouds[0].life = Some(Life { birth: 0.0, death: 9.0, forming: 1.0, dissolving: 1.0 });
    let mut paths = Vec::new();
    leaves(&serde_json::to_value(&scene).unwrap(), "", &mut paths);
    paths.retain(|path| path != "format" && path != "time");
    assert!(paths.len() > 45, "{paths:?}");
    for path in paths {
        let place = Place::find(&path, &scene).unwrap();
        let now = place.read(&scene).unwrap();
        let target = now * 0.9 + 0.04;
        let mut moving = scene.clone();
        moving.timeline = Some(Timeline {
            tracks: vec![track(&path, &[Key::new(0.0, now), Key::new(10.0, target)])],
            ..Timeline::default()
        });
        moving.validate().unwrap();
        let posed = moving.posed(10.0);
        let reached = place.read(&posed).unwrap();
        let whole = path.ends_with("seed");
        let turned = path.contains("orientation") || path.contains("rotation");
        let expected = if whole { target.round() } else { target };
        assert!(turned || reached == expected, "{path}: {reached}, not {expected}");
        assert!(reached != now || whole || turned, "{path} does not move");
    }
}

#[test]
fn paths_by_name_follow_their_object_and_numbers_their_place() {
    let mut scene = heap();
    scene.clouds.push(scene.clouds[0].clone());
    scene.clouds[1].name = "it's [\\odd]".to_owned();
    scene.clouds[1].ellipsoids[1].name = None;
    scene.clouds[1].ellipsoids[3].name = Some("top".to_owned());
    let path = owner_path(Owner::Ellipsoid(1, 3), &scene) + ".center[1]";
    assert_eq!(path, "clouds['it\\'s [\\\\odd]'].ellipsoids['top'].center[1]");
    let place = Place::find(&path, &scene).unwrap();
    assert_eq!((place.owner, place.path(&scene)), (Owner::Ellipsoid(1, 3), path.clone()));
    scene.clouds.swap(0, 1);
    scene.clouds[0].ellipsoids.swap(0, 3);
    assert_eq!(Place::find(&path, &scene).unwrap().owner, Owner::Ellipsoid(0, 0));
    assert_eq!(owner_path(Owner::Ellipsoid(0, 1), &scene), "clouds['it\\'s [\\\\odd]'].ellipsoids[1]");
}

#[test]
fn the_sun_goes_by_a_clock() {
    let text = |hours: &str, time: &str| {
        format!(
            r#"{{"sun":{{"position":{{"place":{{"latitude_deg":52,"longitude_deg":5,"time":"{time}"{hours}}}}}}},
            "timeline":{{"length":4,"tracks":[{{"path":"sun.position.place.hours","keys":[
            {{"time":0,"value":0,"interpolation":"linear"}},{{"time":4,"value":8}}]}}]}}}}"#
        )
    };
    let scene = Scene::from_json(&text("", "2026-06-21T08:00:00Z")).unwrap();
    let noon = Scene::from_json(&text("", "2026-06-21T12:00:00Z")).unwrap();
    let [moved, still] = [scene.at(2.0).unwrap(), noon.at(0.0).unwrap()].map(|scene| scene.sun.to_sun());
    assert!(moved.distance(still) < 1e-12, "{moved} {still}");
    assert!(moved.distance(scene.at(0.0).unwrap().sun.to_sun()) > 0.5);
}

// --- At the door --------------------------------------------------------------------

#[test]
fn a_scene_without_a_timeline_is_written_as_before_and_one_with_it_survives() {
    let still = heap();
    assert!(!still.to_json().contains("timeline") && !still.to_json().contains("life"));
    let mut moving = scene(vec![track(
        "clouds['humilis'].ellipsoids[2].center[1]",
        &[
            key(0.25, 0.1 + 0.2, Interpolation::Step),
            Key { before: Some([-0.1, 1.0 / 3.0]), after: Some([0.5, -2.0]), ..Key::new(3.0, 1e3) },
        ],
    )]);
    moving.clouds[0].life = Some(Life { birth: -3.0, death: 20.0, forming: 4.0, dissolving: 5.0 });
    assert_eq!(Scene::from_json(&moving.to_json()).unwrap(), moving);
}

#[test]
fn complaints_name_the_track_the_value_and_the_way_out() {
    let two = |path: &str| vec![track(path, &[Key::new(0.0, 0.5), Key::new(1.0, 0.6)])];
    let cases = [
        ("clouds['humilus'].edge.wispiness", "did you mean 'humilis'"),
        ("clouds[7].edge.wispiness", "no cloud [7]: there are 1"),
        ("clouds[0].ellipsoids[999].density", "no ellipsoid [999]"),
        ("clouds[0].edge.wispines", "unknown field `wispines`"),
        ("clouds[0].egde.wispiness", "did you mean `edge`"),
        ("sun.position.place.latitude_deg", "Known: angles"),
        ("sky", "an object is not a number"),
        ("name", "text is not a number"),
        ("camera.position[3]", "the list ends at [2]"),
        ("camera.position.x", "x, y and z are [0], [1] and [2]"),
        ("camera.position", "a list is no number: add [0]"),
        ("clouds[0].hidden", "hidden"),
        ("noise..scale", "it can't be read from"),
        ("clouds['humilis.name", "it can't be read from"),
        ("format", "can't be animated"),
        ("", "it is empty"),
    ];
    for (path, fragment) in cases {
        let text = complaint(&scene(two(path)));
        let place = text.starts_with("timeline.tracks[0].path: ") && text.contains(&format!("`{path}`"));
        assert!(place && text.contains(fragment), "{path}: {text}");
    }

    let wisp = "clouds[0].edge.wispiness";
    let keys = |keys: &[Key]| complaint(&scene(vec![track(wisp, keys)]));
    assert!(keys(&[]).contains("tracks[0].keys: a track needs at least one key"));
    assert!(keys(&[Key::new(0.0, 0.5), Key::new(0.0, 0.6)]).contains("keys[1].time: 0 comes after 0"));
    assert!(keys(&[Key::new(11.0, 0.5)]).contains("0 to 10 seconds"));
    assert!(keys(&[Key::new(1.0, f64::NAN)]).contains("keys[0].value"));
    let text = keys(&[Key::new(0.0, 0.5), Key::new(1.0, 1.6)]);
    assert!(
        text.contains("reach 1.6") && text.contains("clouds[0].edge.wispiness: 1.6 is out of range"),
        "{text}"
    );
    let over = [Key { after: Some([0.3, 0.7]), ..Key::new(0.0, 0.5) }, Key::new(1.0, 0.5)];
    assert!(keys(&over).contains("reach 1.2"), "{}", keys(&over));
    let back = [Key { after: Some([-0.3, 0.0]), ..Key::new(0.0, 0.5) }, Key::new(1.0, 0.5)];
    assert!(keys(&back).contains("keys[0].after"));
    assert!(complaint(&scene([two(wisp), two(wisp)].concat())).contains("two tracks"));

    let mut odd = looping();
    odd.timeline.as_mut().unwrap().fps = 29.97;
    assert!(complaint(&odd).contains("299.7"), "{}", complaint(&odd));
    let mut twins = scene(two("clouds['humilis'].edge.wispiness"));
    twins.clouds.push(twins.clouds[0].clone());
    assert!(complaint(&twins).contains("more than one cloud is called 'humilis'"));
    let mut dead = looping();
    dead.clouds[0].life = Some(Life { birth: 7.0, death: 4.0, forming: 1.0, dissolving: 1.0 });
    dead.validate().unwrap();
    dead.timeline.as_mut().unwrap().looped = false;
    assert!(complaint(&dead).contains("clouds[0].life: death at 4 seconds"), "{}", complaint(&dead));
    let lived = |birth, death, forming| {
        let mut scene = looping();
        scene.clouds[0].life = Some(Life { birth, death, forming, dissolving: 1.0 });
        complaint(&scene)
    };
    assert!(lived(1.0, 3.0, 1.5).contains("forming and dissolving take 2.5 seconds of a life of 2"));
    assert!(lived(1.0, 13.0, 0.5).contains("must lie in the loop, from 0 to 10 seconds"));
    let misspelt = Scene::from_json(r#"{"timeline":{"lenght":3}}"#).unwrap_err().to_string();
    assert!(misspelt.contains("did you mean `length`"), "{misspelt}");
}

#[test]
fn curves_that_together_make_no_scene_are_told_with_the_moment() {
    let mut scene = scene(Vec::new());
    let camera = scene.camera.clone().unwrap();
    let timeline = scene.timeline.as_mut().unwrap();
    for axis in 0..3 {
        let keys =
            [key(0.0, camera.position[axis], Interpolation::Linear), Key::new(4.0, camera.target[axis])];
        timeline.tracks.push(track(&format!("camera.position[{axis}]"), &keys));
    }
    scene.validate().unwrap();
    scene.at(3.0).unwrap();
    let text = scene.at(4.0).unwrap_err().to_string();
    assert!(text.starts_with("camera.target") && text.contains("at 4 seconds"), "{text}");
}

#[test]
fn a_moment_of_a_scene_that_is_not_valid_ends_in_the_sentence_of_validation() {
    let at = |scene: &Scene| scene.at(0.5).unwrap_err().to_string();
    let keyed =
        |path: &str, value: f64| scene(vec![track(path, &[Key::new(0.0, 0.5), Key::new(1.0, value)])]);
    let mut cases = vec![
        keyed("clouds[0].edge.wispines", 0.6),
        keyed("clouds[0].edge.wispiness", f64::NAN),
        keyed("clouds[0].edge.wispiness", 1e9),
        keyed("clouds[0].name", 0.6),
        keyed("time", 0.6),
        keyed("clouds[9].edge.wispiness", 0.6),
        // A gale that is over counts: clouds are where it brought them.
        scene(vec![track(
            "wind.velocity[0]",
            &[key(0.0, 1e300, Interpolation::Step), key(0.25, 5.0, Interpolation::Linear)],
        )]),
        scene(vec![track("exposure", &[])]),
        scene(vec![track("exposure", &[Key::new(5.0, 0.5), Key::new(1.0, 0.5)])]),
    ];
    for length in [0.0, f64::NAN, f64::INFINITY, -1.0] {
        let mut odd = looping();
        odd.timeline.as_mut().unwrap().length = length;
        cases.push(odd);
    }
    let mut flat = looping();
    flat.clouds[0].ellipsoids[0].radii.x = f64::NAN;
    cases.push(flat);
    for case in &cases {
        assert_eq!(at(case), complaint(case));
    }
}

// --- Moments ------------------------------------------------------------------------

#[test]
fn a_moment_depends_on_its_time_alone() {
    let mut scene = looping();
    let wind = track("wind.velocity[2]", &[Key::new(0.0, 3.0), Key::new(7.0, -20.0)]);
    let turn = track("clouds[0].ellipsoids[1].orientation[1]", &[Key::new(0.0, 0.8), Key::new(5.0, -0.3)]);
    scene.timeline.as_mut().unwrap().tracks = vec![wind, turn];
    let times: Vec<f64> = (0..48).map(|i| f64::from(i) / 4.7).collect();
    let forwards: Vec<Scene> = times.iter().map(|t| scene.at(*t).unwrap()).collect();
    let mut backwards: Vec<Scene> = times.iter().rev().map(|t| scene.at(*t).unwrap()).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    // A moment is a still scene: its own moment is itself.
    assert!(forwards.iter().all(|moment| moment.at(moment.time).unwrap() == *moment));
}

#[test]
fn another_camera_is_not_moved_by_the_curves_of_the_scenes_own() {
    let mut scene = scene(vec![track("camera.position[0]", &[Key::new(0.0, 1.0), Key::new(5.0, 90.0)])]);
    let mut camera = scene.camera();
    assert_eq!(scene.at(5.0).unwrap().camera().position.x, 90.0);
    camera.position.x = 7.0;
    assert_eq!(scene.seen_by(camera.clone()).at(5.0).unwrap().camera(), camera);
    // Without one of its own a scene is seen from where its clouds are at the start.
    scene.camera = None;
    scene.timeline = None;
    assert_eq!(scene.at(60.0).unwrap().camera(), scene.camera());
}

#[test]
fn wind_that_changes_carries_by_its_integral() {
    let mut scene = scene(vec![track(
        "wind.velocity[0]",
        &[key(0.0, 0.0, Interpolation::Linear), key(10.0, 20.0, Interpolation::Linear)],
    )]);
    scene.wind.velocity = DVec3::new(99.0, 0.0, 2.0);
    let start = scene.clouds[0].ellipsoids[0].center;
    let moved = scene.at(6.0).unwrap().clouds[0].ellipsoids[0].center - start;
    assert!(moved.distance(DVec3::new(36.0, 0.0, 12.0)) < 1e-9, "{moved}");
}

#[test]
fn noise_is_renewed_by_the_integral_of_its_rate_and_a_whole_number_of_times_in_a_loop() {
    let times = |scene: &Scene, time: f64| scene.at(time).unwrap().noise.renewed;
    let mut steady = scene(Vec::new());
    steady.noise.rate = 6.0;
    assert!((times(&steady, 5.0).times - 0.5).abs() < 1e-12);
    let keys = [key(0.0, 0.0, Interpolation::Linear), key(10.0, 12.0, Interpolation::Linear)];
    let faster = scene(vec![track("noise.rate", &keys)]);
    // 12 a minute after 10 s: half of that for 10 s.
    assert!((times(&faster, 10.0).times - 1.0).abs() < 1e-9, "{:?}", times(&faster, 10.0));
    let moment = faster.at(5.0).unwrap();
    assert_eq!((moment.noise.rate, moment.at(0.0).unwrap().noise), (0.0, moment.noise.clone()));
    let mut looped = looping();
    looped.noise.rate = 17.0;
    let length = looped.timeline.as_ref().unwrap().length;
    let (whole, round) = (17.0 * length / 60.0, times(&looped, 0.5 * length));
    assert_eq!(f64::from(round.round), whole.round().max(1.0));
    assert!((round.times - 0.5 * f64::from(round.round)).abs() < 1e-9);
    assert_eq!(times(&looped, length), times(&looped, 0.0));
    looped.clouds[0].noise = Some(Noise { rate: 40.0, ..Noise::default() });
    assert!(looped.at(0.3).unwrap().clouds[0].noise.as_ref().unwrap().renewed.times > 0.0);
}

#[test]
fn without_a_timeline_a_moment_is_the_scene_carried_by_the_wind() {
    let scene = heap();
    let moment = scene.at(30.0).unwrap();
    let moved = moment.clouds[0].ellipsoids[4].center - scene.clouds[0].ellipsoids[4].center;
    assert!(moved.distance(30.0 * scene.wind.velocity) < 1e-9);
    assert_eq!((moment.camera, moment.time), (scene.camera, 0.0));
}

/// Where in a cloud's own noise each of its lumps is, in billows.
fn in_noise(cloud: &Cloud) -> Vec<DVec3> {
    let noise = cloud.noise.as_ref().unwrap();
    let size = noise.scale_in(cloud.bounds().unwrap());
    cloud.ellipsoids.iter().map(|e| (e.center - noise.offset) / size).collect()
}

#[test]
fn a_clouds_own_noise_goes_with_it_in_wind_and_in_growth() {
    let mut scene = scene(Vec::new());
    scene.wind.velocity = DVec3::new(3.0, 0.5, -7.0);
    let offset = DVec3::new(40.0, 10.0, -20.0);
    scene.clouds[0].noise = Some(Noise { offset, ..Noise::default() });
    let still = in_noise(&scene.clouds[0]);
    let apart = |cloud: &Cloud| {
        let pairs = in_noise(cloud).into_iter().zip(&still).map(|(a, b)| a.distance(*b));
        pairs.fold(0.0, f64::max)
    };
    let blown = scene.at(60.0).unwrap();
    assert!(apart(&blown.clouds[0]) < 1e-9);
    assert!(blown.clouds[0].noise.as_ref().unwrap().offset.distance(offset) > 100.0, "it has moved");
    assert_eq!(blown.noise, scene.noise, "the scene's stands in the world");
    scene.clouds[0].life = Some(Life { birth: 2.0, death: 8.0, forming: 2.0, dissolving: 3.0 });
    for time in [2.4, 3.5, 5.0, 7.2] {
        let grown = scene.at(time).unwrap();
        assert!(apart(&grown.clouds[0]) < 1e-9, "{time}: billows grow as it does");
    }
}

#[test]
fn a_life_begins_and_ends_with_nothing_and_is_whole_between() {
    let mut scene = scene(Vec::new());
    scene.wind.velocity = DVec3::X;
    scene.clouds[0].life = Some(Life { birth: 2.0, death: 8.0, forming: 2.0, dissolving: 3.0 });
    let cloud = |time: f64| scene.at(time).unwrap().clouds.remove(0);
    for time in [0.0, 2.0, 8.0, 9.0] {
        assert!(cloud(time).ellipsoids.is_empty(), "{time}");
    }
    // Half way it is what and where the scene has it.
    assert_eq!(cloud(5.0).ellipsoids, scene.clouds[0].ellipsoids);
    let (young, old) = (cloud(2.4), cloud(7.2));
    let ratio = young.ellipsoids[0].density / scene.clouds[0].ellipsoids[0].density;
    assert!((ratio - 0.104).abs() < 1e-9, "x^2 (3 - 2x) at 0.2 is 0.104, not {ratio}");
    assert!(young.ellipsoids[0].radii.x < 0.6 * scene.clouds[0].ellipsoids[0].radii.x);
    assert!(old.edge.wispiness > 0.6);
    assert_eq!(young.bounds().unwrap().0.y, scene.clouds[0].bounds().unwrap().0.y, "it grows from its base");
}

#[test]
fn frame_times_close_a_loop_to_the_last_bit() {
    for (length, fps) in [(10.0, 24.0), (10.01, 30000.0 / 1001.0), (7.0 / 3.0, 30.0), (0.7, 10.0)] {
        let timeline = Timeline { length, fps, looped: true, tracks: Vec::new() };
        let frames = i64::from(timeline.frames());
        for index in 0..frames {
            assert_eq!(timeline.time_of(index), timeline.time_of(index + frames));
            assert_eq!(timeline.time_of(index), timeline.time_of(index - 3 * frames));
            assert_eq!(timeline.wrapped(timeline.time_of(index)), timeline.time_of(index));
        }
    }
}

/// What moves: where each ellipsoid is, times how much of it there is.
fn water(scene: &Scene) -> (DVec3, f64) {
    let all = scene.clouds.iter().flat_map(|cloud| &cloud.ellipsoids);
    all.fold((DVec3::ZERO, 0.0), |(sum, mass), e| {
        let own = e.density * e.radii.element_product();
        (sum + own * e.center, mass + own)
    })
}

#[test]
fn loops_close_without_a_jump_with_and_without_lives() {
    let plain = looping();
    let mut living = looping();
    living.clouds[0].life = Some(Life { birth: 7.0, death: 4.0, forming: 2.0, dissolving: 2.5 });
    for scene in [plain, living] {
        assert_eq!(scene.at(0.0).unwrap(), scene.at(10.0).unwrap());
        assert_eq!(scene.at(0.0).unwrap(), scene.at(-20.0).unwrap());
        let step = |time: f64| {
            let [(a, m), (b, n)] = [time, time + 0.01].map(|time| water(&scene.at(time).unwrap()));
            (a.distance(b) + (m - n).abs()) / water(&heap()).1
        };
        let steps: Vec<f64> = (0..1000).map(|i| step(f64::from(i) * 0.01)).collect();
        let greatest = steps.iter().copied().fold(0.0, f64::max);
        // Neighbours in time differ by little: a jump of the cloud would be a hundred times as much.
        let jump = steps.windows(2).map(|two| (two[1] - two[0]).abs()).fold(0.0, f64::max);
        assert!(jump < 0.05 * greatest, "{jump} of {greatest}");
    }
}

#[test]
fn a_cloud_that_hands_over_to_itself_is_whole_at_every_moment() {
    let scene = looping();
    for i in 0..100 {
        let moment = scene.at(f64::from(i) * 0.1).unwrap();
        let full = scene.clouds[0].ellipsoids[0].density;
        let all = moment.clouds.iter().flat_map(|cloud| &cloud.ellipsoids);
        let densest = all.map(|e| e.density).fold(0.0, f64::max);
        assert!((densest - full).abs() < 1e-12, "{densest} at {i}");
        // What fades is a cloud of its own, so that it thins nothing else.
        let alike = |cloud: &Cloud| cloud.ellipsoids.iter().all(|e| e.density == cloud.ellipsoids[0].density);
        assert!(moment.clouds.len() <= 2 && moment.clouds.iter().all(alike), "{i}");
    }
}

#[test]
fn both_clouds_of_a_loop_have_their_noise_with_them() {
    let mut scene = looping();
    scene.clouds[0].noise = Some(Noise::default());
    let still = in_noise(&scene.clouds[0]);
    let moment = scene.at(4.0).unwrap();
    assert_eq!(moment.clouds.len(), 2);
    for cloud in &moment.clouds {
        let worst = in_noise(cloud).into_iter().zip(&still).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{worst}");
    }
}
