//! Scene files: what is accepted, what is refused and in which words.

use std::fs;
use std::path::Path;

use glam::{DQuat, DVec3};
use nephos::Error;
use nephos::scene::{
    Cloud, Droplets, Ellipsoid, MAX_CLOUDS, MAX_ELLIPSOIDS, Noise, Phase, Preset, Scene, SunPosition, schema,
};
use proptest::prelude::*;
use serde_json::{Value, json};

const MINIMAL: &str = r#"{"clouds":[{"ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]}]}"#;

/// Path and problem of the error that `text` gives.
fn refusal(text: &str) -> (String, String) {
    match Scene::from_json(text) {
        Err(Error::Scene { path, problem }) => (path, problem),
        other => panic!("{text} gave {other:?}"),
    }
}

// --- Files ---------------------------------------------------------------------------

#[test]
fn minimal_scene_equals_the_defaults() {
    let ellipsoid = Ellipsoid::new(DVec3::new(0.0, 900.0, 0.0), DVec3::new(120.0, 70.0, 100.0));
    let expected =
        Scene { clouds: vec![Cloud { ellipsoids: vec![ellipsoid], ..Cloud::default() }], ..Scene::default() };
    assert_eq!(Scene::from_json(MINIMAL).unwrap(), expected);
    assert_eq!(Scene::from_json("{}").unwrap(), Scene::default());
    assert_eq!(Scene::from_json("\u{feff}{}").unwrap(), Scene::default());
}

#[test]
fn default_extinction_is_kols() {
    // 400e6 * 2 pi * (6e-6)^2 = 0.090478 per metre.
    let extinction = Droplets::default().extinction();
    assert!((extinction - 0.090_477_868_423_386).abs() < 1e-12);
}

#[test]
fn billows_that_nobody_sized_are_those_of_a_cloud_of_that_size() {
    let scene = Scene::from_json(MINIMAL).unwrap();
    let bounds = scene.clouds[0].bounds().unwrap();
    // The box is 240 by 140 by 200 m.
    let size = 0.16 * (240.0 * 140.0 * 200.0_f64).cbrt();
    assert!((scene.noise.scale_in(bounds) - size).abs() < 1e-9);
    assert!((scene.largest_billows() - size).abs() < 1e-9);
    assert_eq!(Noise { scale: Some(33.0), ..Noise::default() }.scale_in(bounds), 33.0);
    let mut own = scene.clone();
    own.clouds[0].noise = Some(Noise { scale: Some(400.0), ..Noise::default() });
    assert_eq!(own.largest_billows(), 400.0);
    assert_eq!(own.noises_mut().count(), 2);
    assert_eq!(Scene::default().largest_billows(), 0.0);
    // What is left out is not written, and stays so.
    assert!(!scene.to_json().contains("\"scale\""), "{}", scene.to_json());
}

#[test]
fn vectors_stand_on_one_line() {
    let scene = Scene { name: "a [\n b".to_owned(), ..Scene::from_json(MINIMAL).unwrap() };
    let text = scene.to_json();
    assert!(text.contains("\"center\": [0.0, 900.0, 0.0],\n"), "{text}");
    assert!(text.ends_with("}\n"));
    assert_eq!(Scene::from_json(&text).unwrap(), scene);
}

#[test]
fn missing_file_is_named() {
    let error = Scene::load("no/such/scene.json").unwrap_err();
    assert!(matches!(error, Error::File { action: "read", .. }));
    assert!(error.to_string().contains("no/such/scene.json"));
}

#[test]
fn saving_replaces_the_file_and_leaves_nothing_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    fs::write(&path, "old").unwrap();
    let scene = Preset::Kol.scene(3);
    scene.save(&path).unwrap();
    assert_eq!(Scene::load(&path).unwrap(), scene);
    assert_eq!(names_in(folder.path()), ["scene.json"]);
}

#[test]
fn who_gives_an_exposure_means_it_and_all_others_are_metered() {
    let is_metered = |text: &str| Scene::from_json(text).unwrap().is_metered();
    let keyed = r#""timeline": {"tracks": [{"path": "exposure", "keys": [{"time": 0, "value": 1}]}]}"#;
    assert!(is_metered("{}") && is_metered(r#"{"exposure": 0}"#));
    assert!(!is_metered(r#"{"exposure": 0.5}"#) && !is_metered(&format!("{{{keyed}}}")));
    assert!(is_metered(r#"{"exposure": 0.5, "auto_exposure": true}"#));
    assert!(is_metered(&format!(r#"{{"auto_exposure": true, {keyed}}}"#)));
    assert!(!is_metered(r#"{"auto_exposure": false}"#));
    // Files are as they were where nothing is said.
    assert!(!Scene::default().to_json().contains("auto_exposure"));
}

#[test]
fn failing_save_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    fs::write(&path, "old").unwrap();
    let invalid = Scene { exposure: f64::NAN, ..Scene::default() };
    assert!(matches!(invalid.save(&path), Err(Error::Scene { .. })));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");

    // The last step, giving the name, fails where a folder has it.
    let taken = folder.path().join("taken");
    fs::create_dir(&taken).unwrap();
    fs::write(taken.join("inside"), "kept").unwrap();
    let error = Scene::default().save(&taken).unwrap_err();
    assert!(matches!(error, Error::File { action: "write", .. }));
    assert_eq!(fs::read_to_string(taken.join("inside")).unwrap(), "kept");
    assert_eq!(names_in(folder.path()), ["scene.json", "taken"]);
}

#[cfg(unix)]
#[test]
fn saving_through_a_link_keeps_the_link() {
    let folder = tempfile::tempdir().unwrap();
    let (real, link) = (folder.path().join("real.json"), folder.path().join("link.json"));
    fs::write(&real, "old").unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    Scene::default().save(&link).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(Scene::load(&real).unwrap(), Scene::default());
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn python_example_writes_a_valid_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.json");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/make_scene.py");
    let Ok(status) = std::process::Command::new("python3").arg(script).arg(&path).status() else {
        eprintln!("skipped: no python3");
        return;
    };
    assert!(status.success());
    assert_eq!(Scene::load(&path).unwrap().clouds[0].ellipsoids.len(), 8);
}

// --- Refusals ------------------------------------------------------------------------

/// Scenes that are refused by schema and program: text, JSON path, part of the problem.
const BAD: &[(&str, &str, &str)] = &[
    (
        r#"{"clouds":[{"ellipsoids":[{"center":[0,1,2],"radius":[1,1,1]}]}]}"#,
        "clouds[0].ellipsoids[0].radius",
        "unknown field `radius`; did you mean `radii`? Known: name, center, radii",
    ),
    (r#"{"cloud":[]}"#, "cloud", "did you mean `clouds`?"),
    (r#"{"xyzzy":1}"#, "xyzzy", "unknown field `xyzzy`. Known: $schema, format, name"),
    (
        r#"{"clouds":[{"ellipsoids":[{"center":[0,1,2]}]}]}"#,
        "clouds[0].ellipsoids[0]",
        "missing field `radii`",
    ),
    (
        r#"{"clouds":[{"ellipsoids":[{"center":[0,1],"radii":[1,1,1]}]}]}"#,
        "clouds[0].ellipsoids[0].center",
        "found 2 values, expected a list of 3 numbers",
    ),
    (
        r#"{"clouds":[{"ellipsoids":[{"center":[0,1,2,3],"radii":[1,1,1]}]}]}"#,
        "clouds[0].ellipsoids[0].center",
        "the list is longer than expected",
    ),
    (
        r#"{"clouds":[{},{"ellipsoids":[{"center":[0,0,0],"radii":[1,-3,1]}]}]}"#,
        "clouds[1].ellipsoids[0].radii[1]",
        "-3 is out of range: expected 0.01 to 100000 metres",
    ),
    (
        r#"{"clouds":[{"ellipsoids":[{"center":[0,2e7,0],"radii":[1,1,1]}]}]}"#,
        "clouds[0].ellipsoids[0].center[1]",
        "20000000 is out of range: expected -10000000 to 10000000 metres",
    ),
    (
        r#"{"clouds":[{"ellipsoids":[{"center":[0,0,0],"radii":[1,1,1],"edge":{"wispiness":2}}]}]}"#,
        "clouds[0].ellipsoids[0].edge.wispiness",
        "2 is out of range: expected 0 to 1",
    ),
    (r#"{"exposure":"bright"}"#, "exposure", "found string \"bright\", expected a number"),
    (r#"{"exposure":21}"#, "exposure", "21 is out of range: expected -20 to 20 stops"),
    (r#"{"time":1e99}"#, "time", "1e99 is out of range"),
    (r#"{"noise":{"seed":-1}}"#, "noise.seed", "expected a whole number from 0 to 4294967295"),
    (r#"{"noise":{"seed":4.5}}"#, "noise.seed", "found floating point `4.5`, expected a whole number"),
    (r#"{"noise":{"seed":4294967296.0}}"#, "noise.seed", "expected a whole number from 0 to 4294967295"),
    (r#"{"noise":{"seed":4294967296}}"#, "noise.seed", "expected a whole number from 0 to 4294967295"),
    (
        r#"{"noise":{"renewed":{"round":1e10}}}"#,
        "noise.renewed.round",
        "expected a whole number from 0 to 429",
    ),
    (
        r#"{"clouds":[{"growth":{"kind":"humilis","seed":-1.0}}]}"#,
        "clouds[0].growth.seed",
        "expected a whole number",
    ),
    (r#"{"$schema":7}"#, "$schema", "found integer `7`, expected a string"),
    (r#"{"format":1.5}"#, "format", "format 1.5, but this program reads format 1"),
    (r#"{"noise":{"dimension":3}}"#, "noise.dimension", "3 is out of range: expected 2 to 2.9"),
    (r#"{"noise":{"scale":0}}"#, "noise.scale", "0 is out of range: expected 0.1 to 100000 metres"),
    (
        r#"{"clouds":[{},{"noise":{"detail":2}}]}"#,
        "clouds[1].noise.detail",
        "2 is out of range: expected 0 to 1",
    ),
    (r#"{"clouds":[{"blend":1.5}]}"#, "clouds[0].blend", "1.5 is out of range: expected 0 to 1"),
    (
        r#"{"clouds":[{"stratification":-1}]}"#,
        "clouds[0].stratification",
        "-1 is out of range: expected 0 to 1",
    ),
    (
        r#"{"clouds":[{"level":1e9}]}"#,
        "clouds[0].level",
        "1000000000 is out of range: expected -10000000 to 10000000 metres",
    ),
    (r#"{"clouds":[{"dilution":2}]}"#, "clouds[0].dilution", "2 is out of range: expected 0 to 1"),
    (r#"{"noise":[7]}"#, "noise", "found a list, expected an object"),
    (r#"{"clouds":{}}"#, "clouds", "found an object, expected a list"),
    (r#"[]"#, "scene", "found a list, expected an object"),
    (r#"{"format":2}"#, "format", "format 2, but this program reads format 1"),
    (r#"{"format":3,"new":true}"#, "format", "format 3, but this program reads format 1"),
    (r#"{"sky":"nonee"}"#, "sky", "unknown choice `nonee`; did you mean `none`?"),
    (r#"{"sky":"atmosphere"}"#, "sky.atmosphere", "expected {\"atmosphere\": ...}"),
    (r#"{"sky":{}}"#, "sky", "expected exactly one choice"),
    (r#"{"sky":{"uniform":{"radiance":[1,1,1]},"atmosphere":{}}}"#, "sky", "expected exactly one choice"),
    (r#"{"sky":{"atmosphere":{"haze":21}}}"#, "sky.atmosphere.haze", "expected 0 to 20"),
    (r#"{"sky":{"uniform":{"radiance":[1,-1,1]}}}"#, "sky.uniform.radiance[1]", "-1 is out of range"),
    (
        r#"{"clouds":[{"droplets":{"phase":{"henyey_greenstein":{"g":1}}}}]}"#,
        "clouds[0].droplets.phase.henyey_greenstein.g",
        "1 is out of range: expected -0.99 to 0.99",
    ),
    (
        r#"{"clouds":[{"droplets":{"effective_radius_um":3}}]}"#,
        "clouds[0].droplets.effective_radius_um",
        "3 is out of range: expected 4 to 20 micrometres",
    ),
    (r#"{"sun":{"position":{"angles":[225,45]}}}"#, "sun.position.angles", "found a list"),
    (
        r#"{"sun":{"position":{"angles":{"azimuth_deg":0,"elevation_deg":91}}}}"#,
        "sun.position.angles.elevation_deg",
        "91 is out of range: expected -90 to 90 degrees",
    ),
    (r#"{"ground":{"albedo":[0,0,1.1]}}"#, "ground.albedo[2]", "1.1 is out of range"),
    (r#"{"wind":{"velocity":[0,0,2000]}}"#, "wind.velocity[2]", "metres per second"),
    (r#"{"camera":{"position":[0,0,0]}}"#, "camera", "missing field `target`"),
    (
        r#"{"camera":{"position":[0,0,0],"target":[0,0,1],"projection":{"lens":{"focal_length_mm":0}}}}"#,
        "camera.projection.lens.focal_length_mm",
        "0 is out of range: expected 0.1 to 100000 millimetres",
    ),
];

/// Scenes that only the program refuses: a schema cannot say why.
const BAD_FOR_THE_PROGRAM: &[(&str, &str, &str)] = &[
    (r#"{"time":1e999}"#, "time", "the number is too large"),
    (r#"{"time":1,"time":2}"#, "scene", "duplicate field `time`"),
    (
        r#"{"clouds":[{"ellipsoids":[{"center":[0,0,0],"radii":[1,1,1],"orientation":[0,0,0,0]}]}]}"#,
        "clouds[0].ellipsoids[0].orientation",
        "has length 0: expected a unit quaternion",
    ),
    (r#"{"noise":{"rotation":[0,0,0,0]}}"#, "noise.rotation", "has length 0"),
    (r#"{"clouds":[{"noise":{"rotation":[0,0,0,0]}}]}"#, "clouds[0].noise.rotation", "has length 0"),
    (r#"{"sun":{"position":{"direction":[0,0,0]}}}"#, "sun.position.direction", "has no direction"),
    (
        r#"{"sun":{"position":{"place":{"latitude_deg":0,"longitude_deg":0,"time":"noon"}}}}"#,
        "sun.position.place.time",
        "`noon` is no usable time",
    ),
    (
        r#"{"sun":{"position":{"place":{"latitude_deg":0,"longitude_deg":0,"time":"2026-06-21T12:00:00"}}}}"#,
        "sun.position.place.time",
        "expected date, time and zone",
    ),
    (
        r#"{"camera":{"position":[1,2,3],"target":[1,2,3]}}"#,
        "camera.target",
        "[1, 2, 3] is where the camera is",
    ),
    ("", "line 1, column 0", "the text is no JSON"),
    ("{\n  \"time\": NaN\n}", "line 2, column 11", "the text is no JSON"),
    ("{} {}", "line 1, column 4", "trailing characters"),
];

#[test]
fn refusals_name_path_value_and_expectation() {
    for (text, path, part) in BAD.iter().chain(BAD_FOR_THE_PROGRAM) {
        let (found_path, problem) = refusal(text);
        assert_eq!(found_path, *path, "{text}: {problem}");
        assert!(problem.contains(part), "{text}: {problem}");
    }
}

#[test]
fn type_errors_tell_the_line() {
    let (_, problem) = refusal("{\n  \"name\": \"x\",\n  \"time\": \"noon\"\n}");
    assert!(problem.ends_with("(line 3)"), "{problem}");
}

#[test]
fn values_that_are_no_numbers_are_refused_in_rust_too() {
    let mut scene = Scene::from_json(MINIMAL).unwrap();
    scene.clouds[0].ellipsoids[0].radii.z = f64::NAN;
    let error = scene.validate().unwrap_err().to_string();
    assert!(error.starts_with("clouds[0].ellipsoids[0].radii[2]: NaN"), "{error}");

    scene.clouds[0].ellipsoids[0] =
        Ellipsoid { orientation: DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..Ellipsoid::default() };
    let error = scene.validate().unwrap_err().to_string();
    assert!(error.contains("has length 2"), "{error}");
}

#[test]
fn quaternions_become_unit_length_on_loading() {
    let text = MINIMAL.replace("100]", "100],\"orientation\":[0,3,0,4]");
    let scene = Scene::from_json(&text).unwrap();
    let found = scene.clouds[0].ellipsoids[0].orientation;
    assert!((found - DQuat::from_xyzw(0.0, 0.6, 0.0, 0.8)).length() < 1e-15);
}

#[test]
fn too_many_clouds_and_ellipsoids_are_refused() {
    let full = Scene {
        clouds: vec![
            Cloud {
                ellipsoids: vec![Ellipsoid::default(); MAX_ELLIPSOIDS / MAX_CLOUDS],
                ..Cloud::default()
            };
            MAX_CLOUDS
        ],
        ..Scene::default()
    };
    full.validate().unwrap();

    let mut more = full.clone();
    more.clouds.push(Cloud::default());
    let error = more.validate().unwrap_err().to_string();
    assert!(error.contains("4097 clouds") && error.contains("at most 4096"), "{error}");

    let mut more = full;
    more.clouds[7].ellipsoids.push(Ellipsoid::default());
    let error = more.validate().unwrap_err().to_string();
    assert!(error.contains("65537 ellipsoids") && error.contains("at most 65536"), "{error}");
}

// --- Schema --------------------------------------------------------------------------

/// Godot, Lua and Houdini write whole numbers so.
#[test]
fn whole_numbers_with_a_point_are_whole() {
    let validator = jsonschema::validator_for(&schema()).unwrap();
    for (text, seed) in [("4.0", 4), ("4e0", 4), ("1.2E3", 1200), ("-0.0", 0), ("4294967295.0", u32::MAX)] {
        let text = format!(
            r#"{{"format":1.0,"noise":{{"seed":{text},"renewed":{{"round":{text}}}}},
               "clouds":[{{"noise":{{"seed":{text}}}}},{{"growth":{{"kind":"fractus","seed":{text}}}}}]}}"#
        );
        let scene = Scene::from_json(&text).unwrap();
        let seeds =
            [scene.noise.seed, scene.noise.renewed.round, scene.clouds[0].noise.clone().unwrap().seed];
        assert_eq!((seeds, scene.clouds[1].growth.clone().unwrap().seed), ([seed; 3], seed), "{text}");
        assert!(validator.is_valid(&serde_json::from_str(&text).unwrap()), "{text}");
    }
}

#[test]
fn a_file_may_name_its_schema_and_keeps_that() {
    let text = r#"{"$schema": "./scene.schema.json", "clouds": []}"#;
    let written = Scene::from_json(text).unwrap().to_json();
    assert!(written.starts_with("{\n  \"$schema\": \"./scene.schema.json\",\n"), "{written}");
    assert!(!Scene::default().to_json().contains("$schema"));
    let validator = jsonschema::validator_for(&schema()).unwrap();
    assert!(validator.is_valid(&serde_json::from_str(text).unwrap()));
}

#[test]
fn words_of_other_languages_are_told() {
    for (text, word) in [
        (r#"{"time": NaN}"#, "NaN"),
        (r#"{"time": -Infinity}"#, "Infinity"),
        (r#"{"time": nan}"#, "NaN"),
        (r#"{"time": -nan(ind)}"#, "NaN"),
        (r#"{"wind": {"velocity": [0, inf, 0]}}"#, "Infinity"),
        ("// mine\n{}", "comments"),
        ("{} // mine", "comments"),
        ("{\"time\": 3, /* s */ \"name\": \"\"}", "comments"),
        ("{\n# mine\n\"time\": 3}", "comments"),
        ("{\"time\": /* ä */ 3}", "comments"),
        (r#"{"auto_exposure": True}"#, "small letters"),
        (r#"{"camera": None}"#, "small letters"),
        (r#"{"time": 3 4}"#, "expected `,` or `}`"),
        (r#"{"time": }"#, "expected value"),
        ("", "EOF"),
    ] {
        let error = Scene::from_json(text).unwrap_err().to_string();
        assert!(error.contains("is no JSON") && error.contains(word), "{text}: {error}");
    }
}

#[test]
fn encodings_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    let wide = |bytes: fn(u16) -> [u8; 2]| "\u{feff}{}\n".encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    let latin = b"{\n\"name\": \"H\xf6he\"}".to_vec();
    for (bytes, word) in [
        (wide(u16::to_le_bytes), "UTF-16"),
        (wide(u16::to_be_bytes), "UTF-16"),
        (latin, "line 2 that is no UTF-8 (0xf6)"),
    ] {
        fs::write(&path, bytes).unwrap();
        let error = Scene::load(&path).unwrap_err().to_string();
        assert!(error.contains(word) && error.contains("save it as UTF-8"), "{error}");
    }
}

#[test]
fn schema_accepts_what_the_program_writes() {
    let validator = jsonschema::validator_for(&schema()).unwrap();
    for preset in Preset::ALL {
        let value: Value = serde_json::from_str(&preset.scene(5).to_json()).unwrap();
        assert!(validator.is_valid(&value), "{preset}");
    }
    for text in [MINIMAL, "{}", r#"{"camera":null}"#] {
        assert!(validator.is_valid(&serde_json::from_str(text).unwrap()), "{text}");
    }
}

#[test]
fn schema_refuses_what_the_program_refuses() {
    let validator = jsonschema::validator_for(&schema()).unwrap();
    for (text, ..) in BAD {
        let value = serde_json::from_str(text).unwrap();
        assert!(!validator.is_valid(&value), "{text}");
    }
}

#[test]
fn every_field_of_the_schema_is_described() {
    fn walk(value: &Value, path: &str) {
        if let Some(fields) = value.get("properties").and_then(Value::as_object) {
            for (name, field) in fields {
                // The name of a choice is described beside it.
                let described = field.get("description").is_some() || value.get("description").is_some();
                assert!(described, "{path}.{name}");
            }
        }
        let parts = value.as_object().into_iter().flatten();
        parts.for_each(|(name, part)| walk(part, &format!("{path}.{name}")));
        let items = value.as_array().into_iter().flatten();
        items.for_each(|item| walk(item, path));
    }
    walk(&schema(), "scene");
}

#[test]
fn ranges_in_the_descriptions_are_those_of_the_schema() {
    fn walk(value: &Value, checked: &mut usize) {
        let description = value.get("description").and_then(Value::as_str).unwrap_or_default();
        let numbers = value.get("items").unwrap_or(value);
        let limit = |name: &str| numbers.get(name).and_then(Value::as_f64);
        if let (Some(min), Some(max)) = (limit("minimum"), limit("maximum"))
            && let Some((before, _)) = description.split_once(&format!(" to {max}"))
        {
            assert!(before.contains(&format!("{min}")), "{description}");
            *checked += 1;
        } else if limit("maximum").is_some_and(|max| max.abs() < 1e7 && max != 1.0) {
            panic!("no range in: {description}");
        }
        let parts = value.as_object().into_iter().flatten();
        parts.filter(|(name, _)| *name != "items").for_each(|(_, part)| walk(part, checked));
        value.as_array().into_iter().flatten().for_each(|item| walk(item, checked));
    }
    let mut checked = 0;
    walk(&schema(), &mut checked);
    assert!(checked > 15, "{checked}");
}

#[test]
fn what_is_not_hidden_or_locked_says_nothing_of_it() {
    let mut scene = Preset::Kol.scene(1);
    assert!(!scene.to_json().contains("hidden") && !scene.to_json().contains("locked"));
    scene.clouds[0].hidden = true;
    scene.clouds[0].ellipsoids[1].locked = true;
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
}

#[test]
fn numbers_with_a_unit_say_it_in_the_schema() {
    let schema = schema();
    let unit = |kind: &str, field: &str| schema["$defs"][kind]["properties"][field]["unit"].clone();
    assert_eq!(unit("Edge", "boundary"), "metres");
    assert_eq!(unit("Droplets", "effective_radius_um"), "micrometres");
    assert_eq!(unit("Edge", "wispiness"), Value::Null);
}

// --- Properties ----------------------------------------------------------------------

fn vector(low: f64, high: f64) -> impl Strategy<Value = DVec3> {
    [low..high, low..high, low..high].prop_map(DVec3::from_array)
}

prop_compose! {
    fn any_ellipsoid()(
        center in vector(-1e7, 1e7),
        radii in vector(0.01, 1e5),
        axis in vector(-1.0, 1.0),
        angle in -7.0..7.0f64,
        density in 0.0..100.0f64,
        name in proptest::option::of(".*"),
        hidden: bool,
        locked: bool,
    ) -> Ellipsoid {
        let orientation = DQuat::from_axis_angle(axis.normalize_or(DVec3::Y), angle);
        Ellipsoid { name, orientation, density, hidden, locked, ..Ellipsoid::new(center, radii) }
    }
}

prop_compose! {
    fn any_scene()(
        name in ".*",
        ellipsoids in prop::collection::vec(any_ellipsoid(), 0..5),
        azimuth_deg in -360.0..360.0f64,
        elevation_deg in -90.0..90.0f64,
        g in -0.99..0.99f64,
        time in -1e7..1e7f64,
        seed: u32,
        shares in [0.0..=1.0f64, 0.0..=1.0f64, 0.0..=1.0f64],
        scale in proptest::option::of(0.1..1e5f64),
        dimension in 2.0..2.9f64,
        own: bool,
    ) -> Scene {
        let mut scene = Scene { name, time, ..Scene::default() };
        scene.noise.seed = seed;
        scene.sun.position = SunPosition::Angles { azimuth_deg, elevation_deg };
        let [blend, stratification, dilution] = shares;
        let noise = Noise { seed, scale, dimension, offset: DVec3::splat(time), ..Noise::default() };
        let noise = own.then_some(noise);
        let level = own.then_some(time);
        let mut cloud =
            Cloud { ellipsoids, blend, level, stratification, dilution, noise, ..Cloud::default() };
        cloud.droplets.phase = Phase::HenyeyGreenstein { g };
        scene.clouds.push(cloud);
        scene
    }
}

proptest! {
    #[test]
    fn any_valid_scene_survives_a_round_trip(scene in any_scene()) {
        scene.validate().unwrap();
        prop_assert_eq!(&Scene::from_json(&scene.to_json()).unwrap(), &scene);
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in ".*") {
        let _ = Scene::from_json(&text);
    }

    #[test]
    fn numbers_anywhere_are_read_or_refused(field in 0..6usize, number: f64) {
        let names = ["time", "exposure", "sun", "noise", "clouds", "camera"];
        let text = json!({ names[field]: number }).to_string();
        if let Ok(scene) = Scene::from_json(&text) {
            scene.validate().unwrap();
        }
    }
}
