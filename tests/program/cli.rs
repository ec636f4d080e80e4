//! The program as a user calls it: what it writes, what it refuses, what it says.

use std::{fs, path::Path};

use assert_cmd::Command;
use nephos::scene::{Preset, Scene, Species, schema};

const SMALL: &str = r#"{"clouds":[{"ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]}]}"#;

fn nephos(words: &[&str]) -> Command {
    let mut command = Command::cargo_bin("nephos").unwrap();
    command.args(words);
    match std::env::var("NEPHOS_ADAPTER") {
        Ok(name) if words[0] == "render" => command.args(["--adapter", &name]),
        _ => &mut command,
    };
    command
}

/// Runs and gives what it wrote to the standard output; fails where the program fails.
fn told(words: &[&str]) -> String {
    String::from_utf8(nephos(words).assert().success().get_output().stdout.clone()).unwrap()
}

/// Runs, expects exit code `code`, and gives the complaint, which is never a panic.
fn complaint(words: &[&str], code: i32) -> String {
    let output = nephos(words).assert().code(code).get_output().stderr.clone();
    let text = String::from_utf8(output).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    text
}

fn in_folder(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).to_str().unwrap().to_owned()
}

/// Renders the smallest scene to `picture` in `folder` with more words; gives the picture's
/// path and what the program told.
fn render_small(folder: &tempfile::TempDir, picture: &str, words: &str) -> (String, String) {
    let (scene, picture) = (in_folder(folder, "scene.json"), in_folder(folder, picture));
    fs::write(&scene, SMALL).unwrap();
    let mut all = vec!["render", &scene, "-o", &picture];
    all.extend(words.split_whitespace());
    let report = told(&all);
    (picture, report)
}

#[cfg(all(feature = "editor", target_os = "linux"))]
#[test]
fn without_a_desktop_the_editor_says_so_and_alone_there_is_help() {
    let output = |words: &[&str]| {
        let mut command = Command::cargo_bin("nephos").unwrap();
        command.args(words).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, text) = output(&["edit"]);
    assert!(code == Some(1) && text.contains("there is no desktop"), "{text}");
    let (code, text) = output(&[]);
    assert!(code == Some(2) && text.contains("Usage: nephos") && text.contains("render"), "{text}");
}

#[test]
fn new_writes_the_preset_of_its_seed() {
    let folder = tempfile::tempdir().unwrap();
    let path = in_folder(&folder, "cloud.json");
    told(&["new", "--preset", "congestus", "--seed", "9", "-o", &path]);
    assert_eq!(Scene::load(&path).unwrap(), Preset::Congestus.scene(9));
}

#[test]
fn new_overwrites_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let path = in_folder(&folder, "cloud.json");
    fs::write(&path, "mine").unwrap();
    assert!(complaint(&["new", "--preset", "kol", "-o", &path], 1).contains("--force"));
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    told(&["new", "--preset", "kol", "--force", "-o", &path]);
    assert_eq!(Scene::load(&path).unwrap(), Preset::Kol.scene(1));
}

#[test]
fn mistyped_preset_is_answered_with_the_nearest_and_all_others() {
    let answer = complaint(&["new", "--preset", "congestos"], 2);
    assert!(answer.contains("'congestus'") && answer.contains("humilis"), "{answer}");
}

/// Names of files and of cameras may hold what parts them.
#[test]
fn cameras_are_found_whose_names_hold_a_hash() {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_folder(&folder, "scene.json");
    fs::write(&scene, SMALL).unwrap();
    let file = in_folder(&folder, "take #3.gltf");
    let node = |name: &str, fov: f64| {
        (
            serde_json::json!({"name": name, "camera": fov as u32}),
            serde_json::json!({"type": "perspective", "perspective": {"yfov": 0.1 + fov, "znear": 0.1}}),
        )
    };
    let (nodes, cameras): (Vec<_>, Vec<_>) =
        [node("A", 0.0), node("#2", 1.0), node("C #1 # end", 2.0)].into_iter().unzip();
    let document = serde_json::json!({"asset": {"version": "2.0"}, "nodes": nodes, "cameras": cameras});
    fs::write(&file, document.to_string()).unwrap();
    let draw = |camera: &str| {
        let picture = in_folder(&folder, "a.png");
        let words = ["render", &scene, "-o", &picture, "--width", "4", "--height", "4", "--quality", "draft"];
        nephos(&[&words[..], &["--camera", camera]].concat()).assert()
    };
    for name in ["", "#A", "##2", "#C #1 # end"] {
        draw(&format!("{file}{name}")).success();
    }
    let refused = draw(&format!("{file}#2")).failure();
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(told.contains("no camera `2`") && told.contains("`#2`"), "{told}");
}

/// Each option says what it takes, in its own words.
#[test]
fn numbers_that_are_none_are_told_by_the_option() {
    for (words, part) in [
        ("new --preset kol --seed -3", "whole number from 0"),
        ("new --preset kol --seed 1.5", "whole number from 0"),
        ("new --preset kol --seed 1 --seed 2", "cannot be used multiple times"),
        ("new --preset kol --force", "--output"),
        ("render a.json -o a.png --time nan", "a number from"),
        ("render a.json -o a.png --time 1e300", "a number from"),
        ("render a.json -o a.png --width -5", "-5 is not in 1..=8192"),
        ("render a.json -o a.png --transport path --noise 5", "a share above 0"),
        ("render a.json -o a.png --transport path --noise nan", "a share above 0"),
        ("render a.json -o a.png --transport path --seconds inf", "a number above 0"),
        ("render a.json -o a.png --exposure nan", "from -20 to 20"),
        ("sequence a.json -o a.##.png --fps -24", "24000/1001"),
        ("export camera a.json -o a.glb --aspect 1e300", "a number above 0"),
        ("export shadow a.json -o a.exr --altitude inf", "a number from"),
        ("export shadow a.json -o a.exr --center 1,1e300", "2 numbers"),
        ("export flipbook a.json -o a.png --travel nan", "from 0 to"),
        ("export volume a.json -o a.vdb --resolution -1", "-1 is not in"),
        ("fill a.obj -o a.json --at 0,nan,0", "3 numbers"),
        ("fill a.obj -o a.json --seed -1", "whole number from 0"),
        ("bench reference --noise nan", "a share above 0"),
        ("bench reference --seconds -1", "a number above 0"),
    ] {
        let words: Vec<_> = words.split_whitespace().collect();
        let answer = complaint(&words, 2);
        assert!(answer.contains(part), "{words:?}: {answer}");
    }
}

/// No word is taken that means nothing for the job.
#[test]
fn words_without_effect_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_folder(&folder, "scene.json");
    fs::write(&scene, SMALL).unwrap();
    for (words, part) in [
        ("render SCENE -o a.png --spp 8", "--spp 8 is for --transport path"),
        ("render SCENE -o a.png --noise 0.1", "--noise 0.1 is for --transport path"),
        ("sequence SCENE -o a.##.png --frames 1 --seconds 3", "--seconds 3 is for --transport path"),
        ("sequence SCENE -o a.mp4 --frames 1 --spp 8", "--spp 8 is for --transport path"),
        ("sequence SCENE -o a.##.png --frames 1 --from b.##.png", "--from is for movies"),
        ("export sixway SCENE -o a.png --turns 2", "--turns is for several frames"),
        ("export sixway SCENE -o a.png --travel 0", "--travel is for several frames"),
        ("export flipbook SCENE -o a.png --frames 2 --columns 3", "--columns 3 is more than the 2 frames"),
    ] {
        let words: Vec<_> =
            words.split_whitespace().map(|word| if word == "SCENE" { &scene } else { word }).collect();
        let answer = complaint(&words, 1);
        assert!(answer.contains(part), "{words:?}: {answer}");
    }
}

#[test]
fn schema_is_written_whole() {
    let text = told(&["schema"]);
    assert!(text.ends_with("}\n"));
    assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), schema());
}

#[test]
fn render_writes_a_png_of_the_size_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let words = "--width 50 --height 30 --quality draft --transport single --json";
    let (picture, report) = render_small(&folder, "cloud.png", words);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["width"], 50);
    assert_eq!(image::image_dimensions(&picture).unwrap(), (50, 30));
}

#[test]
fn render_stats_count_work() {
    let folder = tempfile::tempdir().unwrap();
    let (_, report) = render_small(
        &folder,
        "cloud.png",
        "--width 64 --height 36 --quality draft --transport single --stats --json",
    );
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let count = |name: &str| report["counts"][name].as_u64().unwrap();
    assert!(count("rays") >= count("rays_hit") && count("rays_hit") > 100);
    assert_eq!(count("noise_reads"), 2 * count("density_evaluations"));
}

#[test]
fn layers_add_up_to_the_beauty() {
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    let (picture, _) = render_small(&folder, "cloud.exr", "--width 48 --height 27 --quality draft --layers");
    let image = read_first_flat_layer_from_file(&picture).unwrap();
    let channel = |name: &str| -> Vec<f32> {
        let list = &image.layer_data.channel_data.list;
        let found = list.iter().find(|channel| channel.name.to_string() == name);
        found.unwrap_or_else(|| panic!("no channel {name}")).sample_data.values_as_f32().collect()
    };
    let through = channel("transmittance.Y");
    for c in ["R", "G", "B"] {
        let [beauty, sky, single, multiple, air] =
            ["", "sky.", "single.", "multiple.", "air."].map(|layer| channel(&format!("{layer}{c}")));
        for i in 0..beauty.len() {
            let sum = sky[i] * through[i] + single[i] + multiple[i] + air[i];
            // Each of five half floats is off by up to 1/2048.
            assert!((beauty[i] - sum).abs() <= 4e-3 * beauty[i].abs() + 1e-4, "{c} {i}: {} {sum}", beauty[i]);
        }
    }
    let depth = channel("depth.Z");
    assert!(through.iter().zip(&depth).all(|(t, d)| *t < 1.0 || *d == 1e10));
    assert!(depth.iter().any(|d| *d > 100.0 && *d < 1e5));
}

#[test]
fn bad_input_ends_in_a_sentence_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let good = in_folder(&folder, "good.json");
    let bad = in_folder(&folder, "bad.json");
    fs::write(&good, SMALL).unwrap();
    fs::write(&bad, SMALL.replace("radii", "radius")).unwrap();
    let picture = in_folder(&folder, "out.png");
    let cases: &[(&[&str], i32, &str)] = &[
        (&["render", &bad, "-o", &picture], 1, "bad.json: clouds[0].ellipsoids[0]"),
        (&["render", "missing.json", "-o", &picture], 1, "missing.json"),
        (&["render", &good, "-o", "out.jpeg"], 1, ".png"),
        (&["render", &good, "-o", &picture, "--layers"], 1, ".exr"),
        (&["render", &good, "-o", &picture, "--width", "0"], 2, "1..=8192"),
        (&["render", &good, "-o", &picture, "--adapter", "no such adapter"], 1, "no such adapter"),
        (
            &["render", &good, "-o", "/no/such/folder/out.png", "--width", "8", "--height", "8"],
            1,
            "/no/such/folder",
        ),
    ];
    for (words, code, fragment) in cases {
        let mut command = Command::cargo_bin("nephos").unwrap();
        let output = command.args(*words).assert().code(*code).get_output().stderr.clone();
        let text = String::from_utf8(output).unwrap();
        assert!(text.contains(fragment) && !text.contains("panicked"), "{words:?}: {text}");
    }
    assert!(!Path::new(&picture).exists());
}

#[test]
fn options_that_cannot_be_obeyed_are_refused_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, picture) = (in_folder(&folder, "scene.json"), in_folder(&folder, "out.exr"));
    fs::write(&scene, SMALL).unwrap();
    let cases: [(&str, &[&str]); 8] = [
        (
            "--width 4096 --height 16 --supersample 8",
            &[
                "--supersample 8 of 4096x16 pixels",
                "32768 rays across",
                "--supersample 2",
                "at most 1024 pixels",
            ],
        ),
        ("--width 16 --height 8192 --supersample 2", &["16384 rays across", "--supersample 1"]),
        ("--transport path --supersample 2", &["--supersample 2 and --transport path", "--spp"]),
        ("--transport path --quality draft", &["--quality draft and --transport path", "--spp"]),
        ("--transport path --layers", &["--layers and --transport path"]),
        ("--transport path --stats", &["--stats", "--transport path", "leave one out"]),
        ("--spp 12", &["--spp 12 is for --transport path"]),
        ("--seconds 5", &["--seconds 5 is for --transport path"]),
    ];
    for (words, fragments) in cases {
        let mut all = vec!["render", scene.as_str(), "-o", picture.as_str()];
        all.extend(words.split_whitespace());
        let text = complaint(&all, 1);
        for fragment in fragments {
            assert!(text.contains(fragment), "{words}: {text}");
        }
    }
    assert!(!Path::new(&picture).exists());
}

#[test]
fn as_many_rays_are_drawn_as_were_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let rays = |words: &str| {
        let words = format!("--width 16 --height 9 --transport emitter --stats --json {words}");
        let report: serde_json::Value =
            serde_json::from_str(&render_small(&folder, "cloud.png", &words).1).unwrap();
        report["counts"]["rays"].as_u64().unwrap()
    };
    // Four times as many, but that tiles without a cloud are left out more closely.
    let [four, eight] = ["4", "8"].map(|rays_across| rays(&format!("--supersample {rays_across}")));
    assert!(eight > 2 * four, "{four} {eight}");
    assert_eq!(rays("--quality final"), rays("--quality final --supersample 2"));
}

#[test]
fn no_adapter_ends_in_a_sentence_that_helps() {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_folder(&folder, "scene.json");
    fs::write(&scene, SMALL).unwrap();
    let mut command = nephos(&["info"]);
    // Points the Vulkan loader at nothing, as on a machine without drivers.
    command.env("VK_DRIVER_FILES", "/nowhere").env("VK_ICD_FILENAMES", "/nowhere");
    if cfg!(target_os = "linux") {
        let output = command.assert().failure().get_output().stderr.clone();
        assert!(String::from_utf8(output).unwrap().contains("mesa-vulkan-drivers"));
    }
}

/// Behind a Vulkan layer that tells of half of the texels along a picture that are asked for.
#[cfg(target_os = "linux")]
#[test]
fn an_adapter_whose_limits_are_too_low_ends_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, picture) = (in_folder(&folder, "scene.json"), in_folder(&folder, "out.png"));
    fs::write(&scene, SMALL).unwrap();
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/layers/low_limits.c");
    let library = in_folder(&folder, "low_limits.so");
    let built = std::process::Command::new("cc")
        .args(["-shared", "-fPIC", "-Werror", "-o", &library, source])
        .status();
    let Ok(built) = built else {
        eprintln!("skipped: there is no C compiler here to make a Vulkan layer with");
        return;
    };
    assert!(built.success());
    let name = "VK_LAYER_NEPHOS_low_limits";
    let manifest = serde_json::json!({"file_format_version": "1.1.0", "layer": {
        "name": name, "description": "few texels", "type": "INSTANCE", "library_path": library,
        "api_version": "1.3.0", "implementation_version": "1"}});
    fs::write(in_folder(&folder, "low_limits.json"), manifest.to_string()).unwrap();
    let mut command = nephos(&["render", &scene, "-o", &picture, "--width", "8", "--height", "8"]);
    command.env("VK_LAYER_PATH", folder.path()).env("VK_INSTANCE_LAYERS", name);
    let output = command.assert().code(1).get_output().stderr.clone();
    let text = String::from_utf8(output).unwrap();
    for word in ["would not open", "max_texture_dimension_2d", "8192", "4096", "--adapter NAME"] {
        assert!(text.contains(word), "{text}");
    }
    assert!(!text.contains("panicked") && !Path::new(&picture).exists(), "{text}");
}

#[cfg(unix)]
#[test]
fn output_through_a_link_goes_where_the_link_points() {
    let folder = tempfile::tempdir().unwrap();
    let [file, link, device] = ["file.json", "link.json", "device.json"].map(|name| folder.path().join(name));
    fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    told(&["new", "--preset", "kol", "--force", "-o", link.to_str().unwrap()]);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(Scene::load(&file).unwrap(), Preset::Kol.scene(1));
    // A device stays a device.
    std::os::unix::fs::symlink("/dev/null", &device).unwrap();
    told(&["new", "--preset", "kol", "--force", "-o", device.to_str().unwrap()]);
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

/// Pixels of some channels of an EXR file, channel by channel.
fn exr_channels(path: &str, names: &[&str]) -> Vec<Vec<f32>> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    let list = &image.layer_data.channel_data.list;
    let values = |name: &&str| {
        let found = list.iter().find(|channel| channel.name == **name);
        found.unwrap_or_else(|| panic!("no channel {name}")).sample_data.values_as_f32().collect()
    };
    names.iter().map(values).collect()
}

const TRACED: [&str; 11] =
    ["R", "G", "B", "A", "cloud.R", "cloud.G", "cloud.B", "cloud.A", "error.R", "error.G", "error.B"];

#[test]
fn a_path_traced_picture_that_was_resumed_is_the_one_made_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let words =
        |samples: u32| format!("--width 16 --height 9 --transport path --json --resume --spp {samples}");
    let told_samples = |(_, report): &(String, String)| {
        serde_json::from_str::<serde_json::Value>(report).unwrap()["samples"].as_u64().unwrap()
    };
    let whole = render_small(&folder, "whole.exr", &words(24));
    let part = render_small(&folder, "part.exr", &words(9));
    assert_eq!(told_samples(&part), 9);
    let part = render_small(&folder, "part.exr", &words(24));
    assert_eq!((told_samples(&whole), told_samples(&part)), (24, 24));
    for ((a, b), name) in
        exr_channels(&whole.0, &TRACED).iter().zip(exr_channels(&part.0, &TRACED)).zip(TRACED)
    {
        for (a, b) in a.iter().zip(b) {
            // Half floats of the beauty, rounding of the others.
            assert!((a - b).abs() <= 2e-3 * a.abs() + 1e-6, "{name}: {a} {b}");
        }
    }
    // What is good enough already stays as it is.
    assert_eq!(told_samples(&render_small(&folder, "part.exr", &words(12))), 24);
}

#[test]
fn path_tracing_ends_by_noise_or_time() {
    let folder = tempfile::tempdir().unwrap();
    let report = |words: &str| -> serde_json::Value {
        let words = format!("--width 16 --height 9 --transport path --json {words}");
        serde_json::from_str(&render_small(&folder, "truth.png", &words).1).unwrap()
    };
    let noise = report("--noise 0.2");
    assert!(noise["noise"].as_f64().unwrap() <= 0.2 && noise["samples"].as_u64().unwrap() >= 24);
    assert!(report("--seconds 0.5")["samples"].as_u64().unwrap() > 0);
}

#[test]
fn only_the_same_picture_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let words = "--width 8 --height 8 --transport path --spp 3";
    let (picture, _) = render_small(&folder, "truth.exr", words);
    let [scene, other, half] = ["scene.json", "other.json", "half.exr"].map(|name| in_folder(&folder, name));
    fs::write(&other, SMALL.replace("70", "71")).unwrap();
    let complain = |scene: &str, picture: &str, words: &str, fragment: &str| {
        let mut all = vec!["render", scene, "-o", picture];
        all.extend(words.split_whitespace());
        let text = complaint(&all, 1);
        assert!(text.contains(fragment), "{text}");
    };
    let path = "--width 8 --height 8 --transport path --resume";
    complain(&other, &picture, path, "is a picture of another scene");
    complain(&scene, &picture, "--width 8 --height 9 --transport path --resume", "has 8x8 pixels, not 8x9");
    render_small(&folder, "half.exr", "--width 8 --height 8 --quality draft --transport single");
    complain(&scene, &half, path, "no path traced picture");
    complain(&scene, &in_folder(&folder, "truth.png"), path, "ends in .exr");
    complain(&scene, &picture, "--resume", "--resume is for --transport path");
    complain(&scene, &picture, "--noise 0.1", "--noise 0.1 is for --transport path");
}

#[test]
fn tables_that_cannot_be_made_or_compared_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let text = complaint(&["tables", "slab", "-o", &in_folder(&folder, "missing")], 1);
    assert!(text.contains("missing"), "{text}");
    let text = complaint(&["tables", "check", "--samples", "0"], 1);
    assert!(text.contains("--samples 0"), "{text}");
}

#[test]
fn auto_exposure_is_told_and_can_be_given_by_hand() {
    let folder = tempfile::tempdir().unwrap();
    let usual = "--width 64 --height 36 --quality draft --transport single --json";
    let stops = |report: &str| {
        serde_json::from_str::<serde_json::Value>(report).unwrap()["auto_exposure_stops"].as_f64()
    };
    let (metered, report) = render_small(&folder, "metered.png", usual);
    let found = stops(&report).unwrap();
    let (by_hand, report) =
        render_small(&folder, "by_hand.png", &format!("{usual} --auto-exposure off --exposure {found}"));
    assert_eq!(stops(&report), None);
    assert_eq!(fs::read(&metered).unwrap(), fs::read(&by_hand).unwrap());
    // An exposure comes on top; the curve is another matter.
    let (brighter, report) = render_small(&folder, "brighter.png", &format!("{usual} --exposure 1"));
    assert_eq!(stops(&report), Some(found));
    assert_ne!(fs::read(&metered).unwrap(), fs::read(&brighter).unwrap());
    let (_, text) = render_small(&folder, "text.png", &usual.replace(" --json", ""));
    assert!(text.contains(&format!("auto exposure {found:+.2} stops")), "{text}");
    // Files that hold the light itself have none.
    assert_eq!(stops(&render_small(&folder, "light.exr", usual).1), None);
    let (scene, map) = (in_folder(&folder, "scene.json"), in_folder(&folder, "map"));
    for (words, thing) in [
        ("render -o .exr --exposure 1", "EXR"),
        ("render -o .exr --tone filmic", "EXR"),
        ("render -o .exr --auto-exposure on", "EXR"),
        ("export sky -o .hdr --tone filmic", ".hdr"),
        ("export impostor -o .exr --exposure 1", "EXR"),
        ("export sixway -o .png --auto-exposure off", "light map"),
    ] {
        let words: Vec<String> = words.split(' ').map(|word| word.replace('.', &format!("{map}."))).collect();
        let mut all: Vec<&str> = words.iter().map(String::as_str).collect();
        all.push(&scene);
        let text = complaint(&all, 1);
        assert!(text.contains(thing) && text.contains("leave it out"), "{text}");
    }
}

#[test]
fn kinds_of_water_come_in_as_clouds_of_their_species() {
    let folder = tempfile::tempdir().unwrap();
    let (weather, scene) = (in_folder(&folder, "storm.nc"), in_folder(&folder, "storm.json"));
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/storm.nc"), &weather).unwrap();
    let of = |scene: &str| {
        let clouds = Scene::load(scene).unwrap().clouds;
        clouds
            .into_iter()
            .map(|c| (c.name, c.droplets.species, c.droplets.effective_radius_um))
            .collect::<Vec<_>>()
    };
    told(&["import", &weather, "-o", &scene, "--kinds"]);
    let wanted = [("QCLOUD", Species::Water, 10.0), ("QRAIN", Species::Rain, 500.0)];
    assert_eq!(of(&scene), wanted.map(|(name, species, radius_um)| (name.to_owned(), species, radius_um)));
    told(&["import", &weather, "-o", &scene, "--grid", "QRAIN"]);
    assert_eq!(of(&scene), [("storm".to_owned(), Species::Rain, 500.0)]);
    told(&["import", &weather, "-o", &scene]);
    assert_eq!(of(&scene), [("storm".to_owned(), Species::Water, 6.0)]);
    let volume = in_folder(&folder, "some.vdb");
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/grids.vdb"), &volume).unwrap();
    assert!(complaint(&["import", &volume, "-o", &scene, "--kinds"], 1).contains("leave out --kinds"));
}

#[test]
fn import_tells_what_is_in_a_volume_and_makes_a_scene_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, scene) = (in_folder(&folder, "some.vdb"), in_folder(&folder, "some.json"));
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/grids.vdb"), &volume).unwrap();
    let text = told(&["import", &volume]);
    for word in
        ["density", "tiles", "not empty", "voxels of 0.5000 x 0.5000 x 0.5000 m", "level set", "vec3s"]
    {
        assert!(text.contains(word), "{text}\n  lacks {word}");
    }
    let text =
        told(&["import", &volume, "-o", &scene, "--extinction", "0.2", "--up", "z", "--at", "0,-500,0"]);
    assert!(text.contains("extinction 0.2 a metre") && text.contains("below the ground"), "{text}");
    let read = Scene::load(&scene).unwrap();
    let cloud = read.clouds[0].volume.as_ref().unwrap();
    assert_eq!(
        (cloud.file.as_str(), cloud.grid.as_deref(), cloud.extinction),
        ("some.vdb", Some("density"), 0.2)
    );
    assert!(read.bounds().is_some());
    // A brick has no head to tell it by.
    let brick = in_folder(&folder, "brick.raw");
    fs::write(&brick, [0.5f32; 24].iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>()).unwrap();
    assert!(complaint(&["import", &brick], 1).contains("no volume that is read"));
    let words = ["import", &brick, "--size", "2,3,4", "--voxel", "10,10,20"];
    assert!(complaint(&words, 1).contains("other order"));
    let text = told(&[&words[..], &["--endian", "big", "-o", &scene]].concat());
    assert!(
        text.contains("2 x 3 x 4 voxels of 10.0000 x 10.0000 x 20.0000 m, 24 not empty, up to 0.5000"),
        "{text}"
    );
    assert!(Scene::load(&scene).unwrap().bounds().is_some());
    assert!(complaint(&["import", &brick, "--size", "2,3,4.5"], 1).contains("whole numbers"));
    assert!(
        complaint(&["import", &volume, "-o", &scene, "--grid", "fire"], 1).contains("has no grid `fire`")
    );
}

#[test]
fn import_makes_a_scene_of_a_sequence_that_is_as_long_as_it() {
    let folder = tempfile::tempdir().unwrap();
    for step in 1..=6 {
        let floats: Vec<u8> = (0..8).flat_map(|i| (0.1 * (i * step) as f32).to_le_bytes()).collect();
        fs::write(folder.path().join(format!("smoke.{step:03}.raw")), floats).unwrap();
    }
    let (files, scene) = (in_folder(&folder, "smoke.%03d.raw"), in_folder(&folder, "scene.json"));
    let words = ["import", &files, "--size", "2,2,2", "-o", &scene, "--fps", "12"];
    let text = told(&words);
    assert!(text.contains("6 steps, 1 to 6"), "{text}");
    let made = Scene::load(&scene).unwrap();
    assert_eq!((made.name.as_str(), made.timeline.as_ref().unwrap().length), ("smoke", 0.5));
    let moment = made.at(0.25).unwrap();
    assert_eq!(moment.clouds[0].volume.as_ref().unwrap().file, "smoke.004.raw");
    let none = in_folder(&folder, "fog.####.raw");
    let problem = complaint(&["import", &none, "--size", "2,2,2"], 1);
    assert!(problem.contains("there is no file of it"), "{problem}");
    let one = in_folder(&folder, "smoke.003.raw");
    let problem = complaint(&["import", &one, "--size", "2,2,2", "--times"], 1);
    assert!(problem.contains("holds one time"), "{problem}");
}

#[test]
fn import_makes_a_cloud_of_each_field_that_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let weather = format!("{}/tests/data/volumes/storm.nc", env!("CARGO_MANIFEST_DIR"));
    let scene = in_folder(&folder, "scene.json");
    told(&["import", &weather, "-o", &scene, "--field", "QRAIN=rain", "--field", "QCLOUD"]);
    let made = Scene::load(&scene).unwrap();
    let of: Vec<_> = made.clouds.iter().map(|cloud| (cloud.name.as_str(), cloud.droplets.species)).collect();
    assert_eq!(of, [("QRAIN", Species::Rain), ("QCLOUD", Species::Water)]);
    let wrong = complaint(&["import", &weather, "--field", "QRAIN=fog"], 2);
    assert!(wrong.contains("water, rain, ice, snow, graupel"), "{wrong}");
    let missing = complaint(&["import", &weather, "-o", &scene, "--field", "ql"], 1);
    assert!(missing.contains("no grid `ql`: it has"), "{missing}");
}
