//! What EXR files say of themselves, read by a reader that is not ours.

use std::{fs, path::Path};

use assert_cmd::Command as Program;
use nephos::scene::Scene;

use crate::readers;

const SCENE: &str = r#"{"clouds":[{"name":"one","ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]}],
    "sun":{"position":{"angles":{"azimuth_deg":200,"elevation_deg":40}},"irradiance":[2.0,1.0,0.5]},
    "camera":{"position":[0,900,800],"target":[0,900,0],"projection":{"perspective":{"vertical_fov_deg":40}}},
    "exposure":1.5,"timeline":{"length":2,"fps":24,"tracks":[]}}"#;

fn told(folder: &Path, words: &str) {
    let mut command = Program::cargo_bin("nephos").unwrap();
    command.current_dir(folder).args(words.split_whitespace());
    if let Ok(name) = std::env::var("NEPHOS_ADAPTER") {
        command.args(["--adapter", &name]);
    }
    command.assert().success();
}

fn started() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    Scene::from_json(SCENE).unwrap();
    fs::write(folder.path().join("scene.json"), SCENE).unwrap();
    folder
}

/// What OpenEXR's own tool tells of a file; nothing where there is none.
fn header(file: &Path) -> Option<String> {
    let text = readers::program("exrheader", &[&file.display().to_string()])?;
    Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

#[test]
fn frames_say_camera_rate_time_and_colours_in_the_names_of_openexr() {
    let folder = started();
    let size = "--width 32 --height 16 --quality draft --transport single";
    told(
        folder.path(),
        &format!(
            "sequence scene.json -o f.####.exr --frames 26 --fps 24000/1001 --color-space acescg {size}"
        ),
    );
    let Some(text) = header(&folder.path().join("f.0026.exr")) else { return };
    for line in [
        "framesPerSecond (type rational): 24000/1001",
        "fieldOfViewVertical (type float): 40",
        // Twice as wide as high: 2 atan(2 tan 20).
        "fieldOfViewHorizontal (type float): 72.1",
        "exposure (type float): 1.5",
        "software (type string): \"nephos ",
        "red (0.713 0.293)",
        "white (0.32168 0.33767)",
        "time 00:00:01:01",
        // Points are rows before the matrix: the last row takes the camera's place away.
        "worldToCamera (type m44f):",
        "-900 -800 1)",
        "worldToNDC (type m44f):",
    ] {
        assert!(text.contains(line), "`{line}` is missing in: {text}");
    }
}

#[test]
fn acescg_is_the_same_light_in_other_numbers() {
    let folder = started();
    let render = |name: &str, more: &str| {
        let words = format!(
            "render scene.json -o {name} --width 16 --height 16 --quality draft --transport single {more}"
        );
        told(folder.path(), &words);
        let image = exr::prelude::read_first_rgba_layer_from_file(
            folder.path().join(name),
            |size, _| vec![vec![[0f32; 4]; size.width()]; size.height()],
            |rows, at, (r, g, b, a): (f32, f32, f32, f32)| rows[at.y()][at.x()] = [r, g, b, a],
        );
        image.unwrap().layer_data.channel_data.pixels.concat()
    };
    let [scene, aces] = [render("a.exr", ""), render("b.exr", "--color-space acescg")];
    // The matrix from Rec. 709 to AP1 with Bradford's adaption, as colour-science.org tells it.
    let matrix =
        [[0.613097, 0.339523, 0.047379], [0.070194, 0.916354, 0.013452], [0.020616, 0.10957, 0.869815]];
    let brightest = scene.iter().flatten().fold(0f32, |most, c| most.max(*c));
    for (own, other) in scene.iter().zip(&aces) {
        for (row, c) in matrix.iter().zip(other) {
            let expected: f32 = row.iter().zip(own).map(|(m, c)| m * c).sum();
            // Half floats have 11 bits, on both sides.
            assert!((expected - c).abs() < 2e-3 * brightest, "{own:?} {other:?}");
        }
        assert_eq!(own[3], other[3]);
    }
}

#[test]
fn words_about_light_are_refused_where_there_is_none() {
    let folder = started();
    for words in [
        "render scene.json -o a.png --color-space acescg",
        "render scene.json -o a.png --white-luminance 100",
        "export sky scene.json -o a.hdr --color-space acescg",
        "export flipbook scene.json -o a.png --color-space rec709",
        "export sixway scene.json -o a.exr --color-space rec709",
    ] {
        let mut command = Program::cargo_bin("nephos").unwrap();
        let output = command.current_dir(folder.path()).args(words.split(' ')).assert().failure();
        let text = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert!(text.contains("leave it out"), "{words}: {text}");
    }
}

#[test]
fn sequences_and_exports_take_the_camera_of_another_file() {
    let folder = started();
    let up = Scene::from_json(&SCENE.replace("[0,900,0],\"proj", "[0,5000,799],\"proj")).unwrap();
    up.save(folder.path().join("up.json")).unwrap();
    told(folder.path(), "export camera up.json -o up.glb");
    let size = "--width 16 --height 8 --quality draft --transport single";
    told(folder.path(), &format!("sequence scene.json -o a.#.png --frames 1 --camera up.glb {size}"));
    told(folder.path(), &format!("render up.json -o b.png {size}"));
    told(folder.path(), &format!("sequence scene.json -o c.#.png --frames 1 {size}"));
    let [a, b, c] =
        ["a.1.png", "b.png", "c.1.png"].map(|name| image::open(folder.path().join(name)).unwrap());
    let apart = |x: &image::DynamicImage, y: &image::DynamicImage| {
        let pairs = x.as_bytes().iter().zip(y.as_bytes()).map(|(x, y)| u32::from(x.abs_diff(*y)));
        pairs.max().unwrap()
    };
    assert!(apart(&a, &b) <= 2 && apart(&a, &c) > 20, "{} {}", apart(&a, &b), apart(&a, &c));
}

/// A camera 800 m south that rises from 900 m by 2000 m in a second, as the child of a node that moves.
fn rising(folder: &Path) {
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    let bytes = [floats(&[0.0, 1.0]), floats(&[0.0, 0.0, 0.0, 0.0, 2000.0, 0.0])].concat();
    fs::write(folder.join("rise.bin"), &bytes).unwrap();
    let document = serde_json::json!({
        "asset": {"version": "2.0"},
        "nodes": [{"name": "crane", "children": [1]}, {"camera": 0, "translation": [0, 900, 800]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 40f64.to_radians(), "znear": 0.1}}],
        "buffers": [{"uri": "rise.bin", "byteLength": 32}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 8}, {"buffer": 0, "byteOffset": 8, "byteLength": 24}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "animations": [{
            "samplers": [{"input": 0, "output": 1}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}],
    });
    fs::write(folder.join("rise.gltf"), document.to_string()).unwrap();
}

#[test]
fn an_animated_camera_is_where_its_nodes_are_at_each_frame_whatever_the_rate() {
    let folder = started();
    rising(folder.path());
    let size = "--width 16 --height 16 --quality draft --transport single";
    // Half a second in: frame 13 of 24 a second, and frame 7 of 12.
    told(folder.path(), &format!("sequence scene.json -o a.#.exr --frames 13 --camera rise.gltf {size}"));
    told(
        folder.path(),
        &format!("sequence scene.json -o b.#.exr --frames 7 --fps 12 --camera rise.gltf {size}"),
    );
    told(folder.path(), &format!("render scene.json -o c.exr --time 0.5 --camera rise.gltf {size}"));
    for name in ["a.13.exr", "b.7.exr", "c.exr"] {
        let Some(text) = header(&folder.path().join(name)) else { return };
        assert!(text.contains("-1900 -800 1)"), "{name}: {text}");
    }
}

#[test]
fn a_scene_without_a_timeline_is_as_long_as_its_camera_moves() {
    let folder = started();
    rising(folder.path());
    let still = SCENE.split(",\"timeline\"").next().unwrap().to_owned() + "}";
    fs::write(folder.path().join("scene.json"), still).unwrap();
    let size = "--width 8 --height 8 --quality draft --transport single";
    told(folder.path(), &format!("sequence scene.json -o f.#.png --fps 4 --camera rise.gltf {size}"));
    assert_eq!((1..9).filter(|n| folder.path().join(format!("f.{n}.png")).exists()).count(), 4);
}
