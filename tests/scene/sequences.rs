//! Sequences of volumes: which step is there at a time, what is read of them and when.

use std::{
    fs,
    path::{Path, PathBuf},
};

use nephos::{
    render::Frame,
    scene::{Scene, Volume},
};

/// Voxels along an edge of a step.
const EDGE: usize = 8;

/// A step that is empty but for one voxel of value 1, at (`x`, 3, 3), in floats.
fn brick(x: usize) -> Vec<u8> {
    let at = |i: usize| if i == x + EDGE * (3 + EDGE * 3) { 1.0f32 } else { 0.0 };
    (0..EDGE.pow(3)).flat_map(|i| at(i).to_le_bytes()).collect()
}

/// A folder with steps of these numbers, each of which has its voxel one farther.
fn folder(numbers: &[i32]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (i, number) in numbers.iter().enumerate() {
        fs::write(step(folder.path(), *number), brick(i % EDGE)).unwrap();
    }
    folder
}

fn step(folder: &Path, number: i32) -> PathBuf {
    folder.join(format!("blob.{number:04}.raw"))
}

/// A scene in `folder` whose volume has these fields, too.
fn load(folder: &Path, fields: &str, rest: &str) -> nephos::Result<Scene> {
    let path = folder.join("scene.json");
    let volume = format!(r#"{{"file": "blob.####.raw", "raw": {{"size": [8, 8, 8]}}{fields}}}"#);
    fs::write(&path, format!(r#"{{"clouds": [{{"volume": {volume}}}]{rest}}}"#)).unwrap();
    Scene::load(path)
}

fn volume(scene: &Scene) -> &Volume {
    scene.clouds[0].volume.as_ref().unwrap()
}

/// Where the voxel is that is not 0 at `time`, s; `None` where nothing is.
fn voxel(scene: &Scene, time: f64) -> Option<i32> {
    let moment = scene.at(time).unwrap();
    let volume = moment.clouds[0].volume.as_ref()?;
    let (at, _) = volume.read_grid().unwrap().filled().next().unwrap();
    Some(at.x)
}

#[test]
fn at_each_time_the_step_is_there_that_is_nearest() {
    let folder = folder(&[11, 12, 13, 14]);
    let scene = load(folder.path(), r#", "sequence": {"fps": 2, "start": 1}"#, "").unwrap();
    assert_eq!(volume(&scene).steps(), Some((11, 14, 4)));
    let at = |time| voxel(&scene, time);
    assert_eq!([1.0, 1.2, 1.3, 2.0, 2.5, 99.0, 0.0, -7.0].map(at), [0, 0, 1, 2, 3, 3, 0, 0].map(Some));
    // What a moment has is one file, by its name.
    let moment = scene.at(2.0).unwrap();
    assert_eq!((volume(&moment).file.as_str(), &volume(&moment).sequence), ("blob.0013.raw", &None));
    assert!(moment != scene.at(2.5).unwrap() && moment == scene.at(2.1).unwrap());
    // In what order moments are asked for changes nothing.
    assert_eq!([2.5, 1.0, 2.0, 1.5, 2.5].map(at), [3, 0, 2, 1, 3].map(Some));
}

#[test]
fn without_a_word_a_sequence_has_a_step_a_frame() {
    let folder = folder(&[1, 2, 3, 4]);
    let timeline = r#", "timeline": {"length": 1, "fps": 10}"#;
    let scene = load(folder.path(), "", timeline).unwrap();
    assert_eq!([0.0, 0.1, 0.2, 0.9].map(|time| voxel(&scene, time)), [0, 1, 2, 3].map(Some));
    let scene = load(folder.path(), "", "").unwrap();
    assert_eq!([0.0, 1.0 / 24.0, 0.1].map(|time| voxel(&scene, time)), [0, 1, 2].map(Some));
}

#[test]
fn beyond_its_ends_it_holds_goes_round_or_is_nothing() {
    let folder = folder(&[1, 2, 3]);
    let fields = r#", "sequence": {"fps": 1, "before": "nothing", "after": "loop"}"#;
    let scene = load(folder.path(), fields, "").unwrap();
    assert_eq!(
        [-1.0, 0.0, 2.0, 3.0, 4.0].map(|time| voxel(&scene, time)),
        [None, Some(0), Some(2), Some(0), Some(1)]
    );
    // Nothing is a frame, too.
    assert!(Frame::new(&Scene { time: -1.0, ..scene.clone() }, [8, 8]).is_ok());
    assert!(Frame::new(&Scene { time: 1.0, ..scene }, [8, 8]).is_ok());
}

#[test]
fn starts_can_be_animated_and_loops_of_the_timeline_close() {
    let folder = folder(&[1, 2, 3, 4]);
    let timeline = r#", "timeline": {"length": 4, "fps": 1, "loop": true, "tracks": [{"path": "clouds[0].volume.sequence.start", "keys":
        [{"time": 0, "value": 0, "interpolation": "step"}, {"time": 3, "value": 2}]}]}"#;
    let scene = load(folder.path(), r#", "sequence": {"fps": 1}"#, timeline).unwrap();
    assert_eq!([0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|time| voxel(&scene, time)), [0, 1, 2, 1, 0, 1].map(Some));
}

#[test]
fn a_missing_step_is_told_by_its_number_when_it_is_needed() {
    let folder = folder(&[1, 2, 4, 5]);
    let scene = load(folder.path(), r#", "sequence": {"fps": 1}"#, "").unwrap();
    assert_eq!([voxel(&scene, 1.0), voxel(&scene, 3.0)], [1, 2].map(Some));
    let told = scene.at(2.0).unwrap_err().to_string();
    for part in [
        "clouds[0].volume.file",
        "step 3 is missing",
        "blob.0003.raw",
        "1, 2, 4, 5",
        "increment",
        "2 seconds",
    ] {
        assert!(told.contains(part), "{told}\n  lacks\n{part}");
    }
    let tens = self::folder(&[0, 10, 20]);
    let scene = load(tens.path(), r#", "sequence": {"fps": 1, "increment": 10}"#, "").unwrap();
    assert_eq!((volume(&scene).steps(), voxel(&scene, 2.0)), (Some((0, 20, 3)), Some(2)));
    let last = load(tens.path(), r#", "sequence": {"fps": 1, "increment": 10, "last": 30}"#, "").unwrap();
    assert!(last.at(3.0).unwrap_err().to_string().contains("step 30 is missing"));
}

#[test]
fn what_is_wrong_with_a_sequence_is_told_with_the_way_out() {
    let folder = folder(&[1, 2]);
    let told = |fields: &str| load(folder.path(), fields, "").unwrap_err().to_string();
    let cases = [
        (r#", "sequence": {"fps": 0}"#, "clouds[0].volume.sequence.fps: 0 is out of range"),
        (r#", "sequence": {"increment": 0}"#, "expected 1 to 1000000"),
        (r#", "sequence": {"start": 1e9}"#, "out of range: expected -10000000 to 10000000 seconds"),
        (r#", "sequence": {"first": 3, "last": 2}"#, "2 comes before the first step, 3"),
        (r#", "sequence": {"first": 3}"#, "step 3 is missing"),
        (r#", "sequence": {"after": "ping"}"#, "unknown choice `ping`"),
    ];
    for (fields, expected) in cases {
        let found = told(fields);
        assert!(found.contains(expected), "{found}\n  lacks\n{expected}");
    }
    let named = |file: &str, more: &str| {
        let path = folder.path().join("other.json");
        fs::write(&path, format!(r#"{{"clouds": [{{"volume": {{"file": "{file}"{more}}}}}]}}"#)).unwrap();
        Scene::load(&path).unwrap_err().to_string()
    };
    let none = named("none.####.vdb", "");
    assert!(none.contains("names a sequence, and there is no file of it"), "{none}");
    assert!(named("a.####.####.vdb", "").contains("two places"));
    assert!(named("nowhere/a.####.vdb", "").contains("cannot read"));
    let alone = named("blob.0001.raw", r#", "raw": {"size": [8, 8, 8]}, "sequence": {}"#);
    assert!(alone.contains("holds one time") && alone.contains("####"), "{alone}");
}

#[test]
fn a_damaged_step_is_told_when_it_is_seen_and_read_anew_when_it_is_whole() {
    let folder = folder(&[1, 2, 3]);
    let scene = load(folder.path(), r#", "sequence": {"fps": 1}"#, "").unwrap();
    let whole = fs::read(step(folder.path(), 2)).unwrap();
    fs::write(step(folder.path(), 2), &whole[..40]).unwrap();
    let second = Scene { time: 1.0, ..scene };
    let told = Frame::new(&second, [8, 8]).unwrap_err().to_string();
    assert!(told.contains("blob.0002.raw") && told.contains("40 bytes"), "{told}");
    fs::write(step(folder.path(), 2), whole).unwrap();
    assert!(Frame::new(&second, [8, 8]).is_ok());
}

#[test]
fn a_step_that_stays_is_read_once() {
    let folder = folder(&[1, 2, 3, 4, 5, 6, 7, 8]);
    let scene = load(folder.path(), r#", "sequence": {"fps": 1}"#, "").unwrap();
    assert_eq!(voxel(&scene, 1.0), Some(1));
    fs::remove_file(step(folder.path(), 2)).unwrap();
    assert_eq!([voxel(&scene, 1.0), voxel(&scene, 1.2)], [1, 1].map(Some));
    // What was long ago is not kept.
    assert_eq!([3.0, 5.0, 7.0].map(|time| voxel(&scene, time)), [3, 5, 7].map(Some));
    assert!(volume(&scene.at(1.0).unwrap()).read_grid().is_none());
}

#[test]
fn between_steps_there_is_what_is_asked_for() {
    let folder = folder(&[1, 3]);
    let between = |fields: &str, time: f64| {
        let fields = format!(
            r#", "up": "z", "scale": 2, "sequence": {{"fps": 0.5, "increment": 2, "interval": 4 {fields}}}"#
        );
        let scene = load(folder.path(), &fields, "").unwrap();
        let moment = scene.at(time).unwrap();
        let grid = volume(&moment).read_grid().unwrap();
        let mut found: Vec<_> = grid.filled().map(|(at, value)| (at.to_array(), value)).collect();
        found.sort_by_key(|(at, _)| *at);
        found
    };
    let [first, last] = [([0, 3, 3], 1.0), ([1, 3, 3], 1.0)];
    assert_eq!(between("", 0.9), [first]);
    assert_eq!(between(r#", "between": "blend""#, 0.5), [([0, 3, 3], 0.75), ([1, 3, 3], 0.25)]);
    // A voxel of 2 m in 4 s of its own; the half of the way to the second step is half a voxel.
    let moving = r#", "velocity": [0.5, 0, 0]"#;
    assert_eq!(between(moving, 1.0), [([0, 3, 3], 0.5), ([1, 3, 3], 0.5)]);
    assert_eq!((between(moving, 0.0), between(moving, 2.0)), (vec![first], vec![last]));
    assert_eq!(between(r#", "between": "nearest", "velocity": [0.5, 0, 0]"#, 0.9), [first]);
    // z is up in the file, and y goes north there: at the half, 0.5 voxels of 2 voxels up and as many north.
    let up = between(r#", "velocity": [0, 1, -1]"#, 1.0);
    assert_eq!(up, [([0, 4, 4], 0.5), ([1, 2, 2], 0.5)]);
}

#[test]
fn what_between_steps_can_not_be_is_told() {
    let folder = folder(&[1, 2]);
    let told = |fields: &str| {
        let fields = format!(r#", "sequence": {{"fps": 1, {fields}}}"#);
        load(folder.path(), &fields, "").and_then(|scene| scene.at(0.5)).unwrap_err().to_string()
    };
    let flow = told(r#""between": "flow""#);
    for part in ["blob.####.raw", "no grid of velocities", "give `velocity`", "\"blend\""] {
        assert!(flow.contains(part), "{flow}\n  lacks\n{part}");
    }
    assert!(
        told(r#""velocity": [0, 2000, 0]"#)
            .contains("2000 is out of range: expected -1000 to 1000 metres per second")
    );
    assert!(told(r#""interval": 0"#).contains("out of range"));
    assert!(told(r#""between": "warp""#).contains("unknown choice `warp`"));
}

#[test]
fn scenes_of_sequences_are_saved_elsewhere_and_read_again() {
    let folder = folder(&[1, 2]);
    let scene = load(folder.path(), r#", "sequence": {"fps": 1, "after": "nothing"}"#, "").unwrap();
    let other = tempfile::tempdir().unwrap();
    let there = other.path().join("scene.json");
    scene.save(&there).unwrap();
    let read = Scene::load(&there).unwrap();
    assert_eq!((voxel(&read, 1.0), voxel(&read, 2.0)), (Some(1), None));
    assert_eq!(volume(&read).sequence, volume(&scene).sequence);
    assert!(volume(&read).file.ends_with("blob.####.raw"), "{}", volume(&read).file);
}

#[test]
fn a_file_may_be_called_like_a_sequence() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("blob.####.raw"), brick(5)).unwrap();
    let scene = load(folder.path(), "", "").unwrap();
    assert_eq!((volume(&scene).steps(), voxel(&scene, 3.0)), (None, Some(5)));
}

#[test]
fn all_times_of_a_weather_file_are_steps() {
    let folder = tempfile::tempdir().unwrap();
    let storm = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/storm.nc");
    fs::copy(&storm, folder.path().join("storm.nc")).unwrap();
    let path = folder.path().join("scene.json");
    let write = |fields: &str| {
        fs::write(
            &path,
            format!(r#"{{"clouds": [{{"volume": {{"file": "storm.nc", "up": "z", {fields}}}}}]}}"#),
        )
        .unwrap();
        Scene::load(&path)
    };
    let scene = write(r#""sequence": {"fps": 0.0002777777777777778}"#).unwrap();
    assert_eq!(volume(&scene).steps(), Some((0, 1, 2)));
    let total = |scene: &Scene, time: f64| {
        let moment = scene.at(time).unwrap();
        let grid = volume(&moment).read_grid().unwrap().clone();
        (volume(&moment).step, grid.total)
    };
    let still = [0, 1].map(|step| total(&write(&format!(r#""step": {step}"#)).unwrap(), 0.0));
    assert_eq!([total(&scene, 0.0), total(&scene, 3600.0)], still);
    assert_ne!(still[0].1, still[1].1);
    let both = write(r#""step": 1, "sequence": {}"#).unwrap_err().to_string();
    assert!(both.contains("both `step`") && both.contains("leave out one"), "{both}");
    let beyond = write(r#""sequence": {"fps": 1, "last": 2}"#).unwrap().at(2.0).unwrap_err().to_string();
    assert!(beyond.contains("step 2 is missing") && beyond.contains("times 0 to 1"), "{beyond}");
}
