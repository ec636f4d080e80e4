//! Volumes of other programs: what is read of them, and what is refused in a sentence.

use std::{collections::HashMap, fs, path::PathBuf};

use glam::{DVec3, IVec3};
use nephos::import::{Choice, Raw, found_in, parse_volume, read_volume};
use nephos::{
    render::Frame,
    scene::{Grid, Scene},
};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{RngCore, SeedableRng},
};

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes").join(name)
}

fn values(grid: &Grid) -> HashMap<[i32; 3], f32> {
    grid.filled().map(|(at, value)| (at.to_array(), value)).collect()
}

/// What `write_volumes.py` wrote as density, by its own formula.
fn bump(at: IVec3) -> f32 {
    let p = (at - IVec3::new(-3, 5, 100)).as_dvec3();
    let size = DVec3::new(20.0, 12.0, 9.0);
    let inside = p.cmpge(DVec3::ZERO).all() && p.cmplt(size).all();
    let square = ((p - 0.5 * (size - 1.0)) / (0.5 * size)).length_squared();
    if inside { (1024.0 * (1.0 - square).max(0.0)).round_ties_even() as f32 / 1024.0 } else { 0.0 }
}

fn assert_bump(grid: &Grid) {
    let found = values(grid);
    let mut filled = 0;
    for x in -5..20 {
        for y in 3..20 {
            for z in 98..112 {
                let value = found.get(&[x, y, z]).copied().unwrap_or_default();
                assert_eq!(value, bump(IVec3::new(x, y, z)), "{x} {y} {z}");
                filled += usize::from(value > 0.0);
            }
        }
    }
    assert!(filled > 700, "{filled}");
}

#[test]
fn grids_packed_by_blosc_come_in_exactly_with_their_place() {
    let grid = read_volume(&data("grids.vdb"), &Choice::default()).unwrap();
    assert_eq!((grid.name.as_str(), grid.count), ("density", values(&grid).len()));
    assert_bump(&grid);
    // Half a unit a voxel, moved.
    let middle = grid.place.transform_point3(DVec3::new(6.0, 10.0, 104.0));
    assert!(middle.distance(DVec3::new(13.0, 25.0, 82.0)) < 1e-12, "{middle}");
}

#[test]
fn halves_come_in_exactly_with_inactive_values() {
    let grid = read_volume(&data("half.vdb"), &Choice::default()).unwrap();
    assert_bump(&grid);
    let found = &values(&grid);
    let row = |y: i32| (32..52).map(move |x| found.get(&[x, y, 100]).copied().unwrap_or_default());
    let inactive: Vec<_> = row(5).filter(|value| *value > 0.0).collect();
    assert_eq!(inactive, [0.5, 0.5, 0.5, 0.5, 0.25, 0.5, 0.25, 0.5]);
    assert_eq!(row(6).filter(|value| *value == 0.125).count(), 4);
}

#[test]
fn other_numbers_pipes_and_old_formats_come_in_exactly() {
    for name in ["double.vdb", "stream.vdb", "old.vdb"] {
        assert_bump(&read_volume(&data(name), &Choice::default()).unwrap_or_else(|error| panic!("{error}")));
    }
}

#[test]
fn tiles_are_filled_and_turned_spaces_read() {
    let grid = read_volume(&data("grids.vdb"), &Choice { grid: Some("tiles"), ..Choice::default() }).unwrap();
    let found = values(&grid);
    assert_eq!(found.len(), 128 * 128 * 128 + 512 + 1);
    assert_eq!((found[&[128, 0, 0]], found[&[255, 127, 127]]), (0.25, 0.25));
    assert_eq!((found[&[256, 0, 0]], found[&[263, 7, 7]], found[&[264, 3, 2]]), (0.5, 0.5, 0.75));
    // Rows of its matrix are where axes go.
    let p = grid.place.transform_point3(DVec3::new(1.0, 10.0, 100.0));
    assert!(p.distance(DVec3::new(7.0 - 20.0, 8.0 + 2.0, 9.0 + 300.0)) < 1e-12, "{p}");
    assert!(grid.voxel().distance(DVec3::new(2.0, 2.0, 3.0)) < 1e-12);
}

#[test]
fn a_file_tells_all_its_grids_and_why_some_are_not_drawn() {
    let found = found_in(&data("grids.vdb"), &Choice::default()).unwrap();
    let told: Vec<_> = found.iter().map(|f| (f.name.as_str(), f.grid.is_ok())).collect();
    assert_eq!(told, [("density", true), ("tiles", true), ("surface", false), ("velocity", false)]);
    let why = |name: &str| {
        read_volume(&data("grids.vdb"), &Choice { grid: Some(name), ..Choice::default() })
            .unwrap_err()
            .to_string()
    };
    assert!(
        why("surface").contains("level set") && why("surface").contains("fog volume"),
        "{}",
        why("surface")
    );
    assert!(why("velocity").contains("vec3s"), "{}", why("velocity"));
    let missing = why("fire");
    assert!(missing.contains("no grid `fire`") && missing.contains("`density`"), "{missing}");
    assert!(missing.contains("grids.vdb"), "{missing}");
}

/// What is wrong with bytes.
fn refused(bytes: &[u8], raw: Option<&Raw>) -> String {
    parse_volume(bytes, &Choice { raw: raw.copied(), ..Choice::default() }).unwrap_err()
}

#[test]
fn what_is_damaged_or_foreign_is_refused_in_a_sentence() {
    let whole = fs::read(data("grids.vdb")).unwrap();
    for length in [9, 60, 300, 5000, whole.len() / 2] {
        assert!(refused(&whole[..length], None).contains("ends early"), "{length}");
    }
    let mut old = whole.clone();
    old[8] = 199;
    assert!(refused(&old, None).contains("version 199"));
    assert!(refused(b"PK\x03\x04 and more", None).contains("no volume that is read"));
    assert!(refused(b"", None).contains("no volume that is read"));
    let folder = read_volume(&data(""), &Choice::default()).unwrap_err().to_string();
    assert!(folder.contains("is no file"), "{folder}");
}

/// A volume of Mitsuba's with these values.
fn vol(size: [i32; 3], values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    [1, size[0], size[1], size[2], 1].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    [0.0f32, 10.0, 20.0, 4.0, 13.0, 22.0].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    values.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes
}

#[test]
fn mitsubas_volumes_come_in_and_bad_values_do_not() {
    let mut values: Vec<f32> = (0..24).map(|i| i as f32).collect();
    let grid = parse_volume(&vol([4, 3, 2], &values), &Choice::default()).unwrap();
    let found = self::values(&grid);
    assert_eq!(found.len(), 23);
    assert_eq!((found[&[1, 0, 0]], found[&[0, 1, 0]], found[&[0, 0, 1]]), (1.0, 4.0, 12.0));
    let p = grid.place.transform_point3(DVec3::new(3.0, 0.0, 1.0));
    assert!(p.distance(DVec3::new(3.5, 10.5, 21.5)) < 1e-6, "{p}");
    values[7] = f32::NAN;
    assert!(refused(&vol([4, 3, 2], &values), None).contains("1 values in `density` that are no numbers"));
    values[7] = -5.0;
    let negative = refused(&vol([4, 3, 2], &values), None);
    assert!(negative.contains("1 negative values") && negative.contains("-5"), "{negative}");
    // What a filter leaves is taken as none, and told.
    values[7] = -0.01;
    assert_eq!(parse_volume(&vol([4, 3, 2], &values), &Choice::default()).unwrap().clamped, 1);
    assert!(refused(&vol([4, 3, 2], &[0.0; 24]), None).contains("nothing above 0"));
    assert!(refused(&vol([4, 3, 3], &values), None).contains("ends early"));
    assert!(refused(&vol([40_000, 3, 3], &values), None).contains("40000 x 3 x 3"));
}

#[test]
fn bricks_of_floats_come_in_by_their_size_and_the_order_of_bytes() {
    let numbers: Vec<f32> = (0..24).map(|i| 0.5 * i as f32).collect();
    let big: Vec<u8> = numbers.iter().flat_map(|x| x.to_be_bytes()).collect();
    let raw = Raw { size: [2, 3, 4], big_endian: true, voxel: DVec3::new(10.0, 20.0, 30.0) };
    let grid = parse_volume(&big, &Choice { raw: Some(raw), ..Choice::default() }).unwrap();
    assert_eq!((values(&grid)[&[1, 2, 3]], grid.voxel()), (11.5, raw.voxel));
    let other = refused(&big, Some(&Raw { big_endian: false, ..raw }));
    assert!(other.contains("other order") && other.contains("endian"), "{other}");
    let wrong = refused(&big, Some(&Raw { size: [2, 3, 5], ..raw }));
    assert!(wrong.contains("96 bytes") && wrong.contains("120"), "{wrong}");
    // The weather's way to say that there is nothing.
    let mut land = big.clone();
    land[92..].copy_from_slice(&1e35f32.to_be_bytes());
    assert_eq!(parse_volume(&land, &Choice { raw: Some(raw), ..Choice::default() }).unwrap().most, 11.0);
}

#[test]
fn damaged_volumes_are_refused_or_read_and_never_end_the_program() {
    let files = [fs::read(data("half.vdb")).unwrap(), vol([4, 3, 2], &[0.5; 24])];
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (mut read, mut refused) = (0, 0);
    for tried in 0..600 {
        let mut bytes = files[usize::from(tried % 3 == 0)].clone();
        for _ in 0..=random.next_u32() % 6 {
            // Heads are short, and most of a file is masks and values.
            let reach = if random.next_u32().is_multiple_of(2) { 700 } else { bytes.len() };
            let at = random.next_u32() as usize % reach.min(bytes.len());
            match random.next_u32() % 3 {
                0 => bytes[at] ^= 1 << (random.next_u32() % 8),
                1 => bytes[at] = random.next_u32() as u8,
                _ => bytes.truncate(at.max(8)),
            }
        }
        match parse_volume(&bytes, &Choice::default()) {
            Ok(_) => read += 1,
            Err(problem) => {
                refused += 1;
                assert!(!problem.is_empty());
            }
        }
    }
    assert!(read > 20 && refused > 100, "{read} {refused}");
}

#[test]
fn weather_comes_in_by_its_kinds_of_water_and_times() {
    let found = found_in(&data("storm.nc"), &Choice::default()).unwrap();
    let names: Vec<_> = found.iter().map(|f| (f.name.as_str(), f.grid.is_ok())).collect();
    assert_eq!(names, [("density", true), ("QCLOUD", true), ("QRAIN", true)]);
    let [all, cloud, rain] = [0, 1, 2].map(|i| found[i].grid.as_ref().unwrap());
    assert!(all.quantity.contains("1/m") && all.place == cloud.place);
    let sum = |grid: &Grid| grid.filled().map(|(_, value)| f64::from(value)).sum::<f64>();
    assert!((sum(all) / (sum(cloud) + sum(rain)) - 1.0).abs() < 1e-6);
    // 10 km apart on the map, whose scale is 1.1 there.
    assert!((9000.0..9300.0).contains(&all.voxel().x), "{}", all.voxel());
    let later = read_volume(&data("storm.nc"), &Choice { step: 1, ..Choice::default() }).unwrap();
    assert_ne!(sum(&later), sum(all));
    let missing =
        read_volume(&data("storm.nc"), &Choice { step: 2, ..Choice::default() }).unwrap_err().to_string();
    assert!(
        missing.contains("has 2 times, and time 2 is asked for") && missing.contains("from 0 to 1"),
        "{missing}"
    );
    let mut bytes = fs::read(data("storm.nc")).unwrap();
    bytes.truncate(bytes.len() / 2);
    assert!(!refused(&bytes, None).is_empty());
    assert!(refused(b"CDF\x01 and nothing", None).contains("no NetCDF file that can be read"));
}

/// A folder with a scene of one volume, whose fields these are, and the file that it names.
fn folder(fields: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(data("grids.vdb"), folder.path().join("some.vdb")).unwrap();
    let path = folder.path().join("scene.json");
    let text = format!(
        r#"{{"clouds": [{{"name": "smoke", "volume": {{"file": "some.vdb", {fields}}}}}], "wind": {{"velocity": [3, 0, -2]}},
        "timeline": {{"length": 10, "tracks": [{{"path": "clouds['smoke'].volume.extinction", "keys": [
            {{"time": 0, "value": 0.2, "interpolation": "linear"}}, {{"time": 10, "value": 0.8}}]}}]}}}}"#
    );
    fs::write(&path, text).unwrap();
    (folder, path)
}

#[test]
fn a_scene_reads_its_volume_beside_it_and_keeps_it_through_time() {
    let (_folder, path) = folder(r#""up": "z", "scale": 2, "place": [100, 50, 0]"#);
    let scene = Scene::load(&path).unwrap();
    let (low, high) = scene.bounds().unwrap();
    // Voxels -2 to 15, 6 to 15, 101 to 107 are not empty and reach one farther; half a unit each, moved by 10, 20, 30.
    let corner = |x: f64, y: f64, z: f64| {
        DVec3::new(100.0 + 2.0 * (0.5 * x + 10.0), 50.0 + 2.0 * (0.5 * z + 30.0), -2.0 * (0.5 * y + 20.0))
    };
    let grid = scene.clouds[0].volume.as_ref().unwrap().read_grid().unwrap();
    let (first, last) = grid.bounds;
    let [first, last] = [first - 1, last + 1].map(IVec3::as_dvec3);
    assert!(low.distance(corner(first.x, last.y, first.z)) < 1e-9, "{low}");
    assert!(high.distance(corner(last.x, first.y, last.z)) < 1e-9, "{high}");
    let later = scene.at(5.0).unwrap();
    let volume = later.clouds[0].volume.as_ref().unwrap();
    assert_eq!((volume.extinction, volume.place), (0.5, DVec3::new(115.0, 50.0, -10.0)));
    assert!(volume.read_grid().is_some() && Frame::new(&scene, [16, 9]).is_ok());
}

#[test]
fn a_scene_that_is_saved_elsewhere_finds_its_volume() {
    let (folder, path) = folder(r#""extinction": 2"#);
    let scene = Scene::load(&path).unwrap();
    let other = tempfile::tempdir().unwrap();
    let there = other.path().join("moved.json");
    scene.save(&there).unwrap();
    let read = Scene::load(&there).unwrap();
    assert!(read.clouds[0].volume.as_ref().unwrap().read_grid().is_some());
    // Back in its own folder it has its short name.
    let back = folder.path().join("back.json");
    read.save(&back).unwrap();
    assert_eq!(Scene::load(&back).unwrap().clouds[0].volume.as_ref().unwrap().file, "some.vdb");
    // The text alone names no folder: nothing is read, and nothing is drawn.
    let unread = Scene::from_json(&scene.to_json()).unwrap();
    assert!(unread.bounds().is_none());
    let problem = Frame::new(&unread, [16, 9]).unwrap_err().to_string();
    assert!(problem.contains("some.vdb") && problem.contains("was not read"), "{problem}");
}

#[test]
fn what_is_wrong_with_a_volume_is_told_with_the_way_out() {
    let told = |cloud: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::copy(data("grids.vdb"), folder.path().join("some.vdb")).unwrap();
        let path = folder.path().join("scene.json");
        fs::write(&path, format!(r#"{{"clouds": [{cloud}]}}"#)).unwrap();
        Scene::load(&path).unwrap_err().to_string()
    };
    let cases = [
        (r#"{"volume": {}}"#, "clouds[0].volume.file: it is empty"),
        (r#"{"volume": {"file": "none.vdb"}}"#, "none.vdb"),
        (r#"{"volume": {"file": "some.vdb", "grid": "fire"}}"#, "has no grid `fire`: it has `density`"),
        (
            r#"{"volume": {"file": "some.vdb", "extinction": -1}}"#,
            "clouds[0].volume.extinction: -1 is out of range",
        ),
        (r#"{"volume": {"file": "some.vdb", "scale": 0}}"#, "clouds[0].volume.scale: 0 is out of range"),
        (r#"{"volume": {"file": "some.vdb", "scale": 1000000}}"#, "too far: change `scale` or `place`"),
        (r#"{"volume": {"file": "some.vdb", "orientation": [0, 0, 0, 0]}}"#, "clouds[0].volume.orientation"),
        (r#"{"volume": {"file": "some.vdb", "extinktion": 1}}"#, "did you mean `extinction`?"),
        (r#"{"volume": {"file": "some.vdb", "up": "x"}}"#, "unknown choice `x`"),
        (
            r#"{"volume": {"file": "some.vdb", "raw": {"size": [4, 4, 4096]}}}"#,
            "4096 is out of range: expected 1 to 2048",
        ),
        (r#"{"volume": {"file": "some.vdb"}, "layer": {}}"#, "both `layer` and `volume`"),
        (
            r#"{"volume": {"file": "some.vdb"}, "level": 900}"#,
            "both `volume` and `level`, which volumes do not have",
        ),
        (r#"{"volume": {"file": "some.vdb"}, "growth": {"kind": "humilis"}}"#, "both `volume` and `growth`"),
    ];
    for (cloud, expected) in cases {
        let found = told(cloud);
        assert!(found.contains(expected), "{found}\n  lacks\n{expected}");
    }
}
