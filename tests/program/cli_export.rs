//! `nephos export` and `nephos fill` as a user calls them.

use std::{fs, path::PathBuf};

use crate::readers;

use assert_cmd::Command;
use nephos::scene::Scene;

const SMALL: &str = r#"{"clouds":[{"name":"one","edge":{"boundary":30},
    "ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]}]}"#;

struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.json"), SMALL).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, words: &str) -> Command {
        let mut command = Command::cargo_bin("nephos").unwrap();
        command.current_dir(self.folder.path()).args(words.split_whitespace());
        if let (Ok(name), true) = (std::env::var("NEPHOS_ADAPTER"), words.starts_with("export")) {
            command.args(["--adapter", &name]);
        }
        command
    }

    fn told(&self, words: &str) -> String {
        String::from_utf8(self.command(words).assert().success().get_output().stdout.clone()).unwrap()
    }

    /// What it complains of, which is no panic; it leaves no file but those that were there.
    fn complaint(&self, words: &str) -> String {
        let before = fs::read_dir(self.folder.path()).unwrap().count();
        let output = self.command(words).assert().failure().get_output().stderr.clone();
        let text = String::from_utf8(output).unwrap();
        assert!(!text.contains("panicked"), "{text}");
        assert_eq!(fs::read_dir(self.folder.path()).unwrap().count(), before, "{words}");
        text
    }
}

#[test]
fn each_kind_is_written() {
    let desk = Desk::new();
    let told = desk.told("export volume scene.json -o a.vdb --voxel 10");
    assert!(told.contains("voxels of 10 m") && told.contains("a.vdb"), "{told}");
    desk.told("export volume scene.json -o a.vol --resolution 16 --samples 1 --up z");
    desk.told("export sky scene.json -o sky.hdr --size 8");
    desk.told("export sky scene.json -o sky.exr --layout strip --size 8");
    let told = desk.told("export sky scene.json -o sky.png --layout cubemap --size 8");
    assert!(told.contains("auto exposure"), "{told}");
    desk.told("export sky scene.json -o sky.ktx2 --size 8");
    let told = desk.told("export shadow scene.json -o shadow.png --size 8 --center -600,600 --extent 500");
    assert!(told.contains("500.0 m around x -600.0 z 600.0 at y 0.0"), "{told}");
    let told = desk.told(
        "export flipbook scene.json -o book.png --frames 2 --tile 16 --quality draft --turns -1 --travel 0 --cloud one",
    );
    assert!(told.contains("auto exposure"), "{told}");
    desk.told("export sixway scene.json -o six.exr --tile 16 --quality draft");
    desk.told(
        "export impostor scene.json -o card.png --views 2 --tile 16 --quality draft --from below --tone soft --exposure -1",
    );
    desk.told("export camera scene.json -o shot.glb");
    for name in
        "a.vdb a.vol sky.hdr sky.exr sky.px.png sky.nz.png sky.ktx2 shadow.png book.png book_motion.png \
        six_positive.exr six_negative.exr card.png card_normal.png card_depth.png shot.glb"
            .split_whitespace()
    {
        assert!(fs::metadata(desk.path(name)).unwrap().len() > 60, "{name}");
    }
    let size = |name: &str| image::image_dimensions(desk.path(name)).unwrap();
    assert_eq!((size("book.png"), size("card.png"), size("sky.hdr")), ((32, 16), (32, 32), (16, 8)));
}

#[test]
fn volumes_over_time_are_those_of_their_moments_in_voxels_of_one_size() {
    let desk = Desk::new();
    let windy = SMALL.strip_suffix('}').unwrap().to_owned() + r#","wind":{"velocity":[50,0,0]}}"#;
    fs::write(desk.path("windy.json"), windy).unwrap();
    let told =
        desk.told("export volume windy.json -o v.####.vdb --frames -1-3:4 --fps 2 --voxel 20 --samples 1");
    assert!(told.contains("2 frames with voxels of 20 m"), "{told}");
    assert!(desk.path("v.-001.vdb").exists());
    // Frame 3 of two a second is at one second.
    desk.told("export volume windy.json -o one.vdb --time 1 --voxel 20 --samples 1");
    assert_eq!(fs::read(desk.path("v.0003.vdb")).unwrap(), fs::read(desk.path("one.vdb")).unwrap());
    assert_ne!(fs::read(desk.path("v.-001.vdb")).unwrap(), fs::read(desk.path("one.vdb")).unwrap());
    let told = desk.complaint("export volume windy.json -o v.vdb --frames 1-2");
    assert!(told.contains("no place for the frame's number"), "{told}");
    let told = desk.complaint("export volume windy.json -o w.#.vdb");
    assert!(told.contains("say which frames"), "{told}");
}

/// Filters take colours of their neighbours from under alpha 0: they are those of the nearest cloud.
#[test]
fn what_stands_under_alpha_0_is_the_nearest_cloud() {
    let desk = Desk::new();
    desk.told("render scene.json -o still.png --width 48 --height 27 --quality draft --transport single --transparent");
    desk.told("export flipbook scene.json -o book.png --frames 2 --tile 24 --quality draft");
    desk.told("export sixway scene.json -o six.png --tile 24 --quality draft");
    desk.told("export impostor scene.json -o card.png --views 2 --tile 24 --quality draft");
    let read = |name: &str| image::open(desk.path(name)).unwrap().to_rgba8();
    let opacity = read("six_positive.png");
    for name in
        ["still.png", "book.png", "six_positive.png", "six_negative.png", "card.png", "card_normal.png"]
    {
        let picture = read(name);
        let alpha = |x, y| {
            if name.starts_with("six") { opacity.get_pixel(x, y)[3] } else { picture.get_pixel(x, y)[3] }
        };
        let seen: Vec<_> = picture.enumerate_pixels().filter(|&(x, y, _)| alpha(x, y) > 0).collect();
        let mut hidden = 0;
        for (x, y, own) in picture.enumerate_pixels().filter(|&(x, y, _)| alpha(x, y) == 0) {
            let distance = |(i, j): (u32, u32)| i.abs_diff(x).pow(2) + j.abs_diff(y).pow(2);
            let least = seen.iter().map(|&(i, j, _)| distance((i, j))).min().unwrap();
            let near = seen
                .iter()
                .filter(|&&(i, j, _)| f64::from(distance((i, j))).sqrt() < f64::from(least).sqrt() + 0.5);
            assert!(near.clone().any(|(.., cloud)| cloud.0[..3] == own.0[..3]), "{name} {x} {y}: {own:?}");
            hidden += 1;
        }
        assert!(hidden > 100, "{name}");
    }
}

#[test]
fn a_picture_by_the_exported_camera_is_the_scenes_own() {
    let desk = Desk::new();
    desk.told("export camera scene.json -o shot.glb");
    let draw = "render scene.json --width 32 --height 18 --quality draft --transport single";
    desk.told(&format!("{draw} -o own.png"));
    desk.told(&format!("{draw} -o taken.png --camera shot.glb#camera"));
    let [own, taken] = ["own.png", "taken.png"].map(|name| image::open(desk.path(name)).unwrap().to_rgb8());
    let far = own.as_raw().iter().zip(taken.as_raw()).filter(|(a, b)| a.abs_diff(**b) > 3).count();
    // The file has floats: rays are off by a ten-thousandth of a pixel.
    assert!(far < 10, "{far}");
    let text = desk.complaint(&format!("{draw} -o other.png --camera shot.glb#other"));
    assert!(text.contains("no camera `other`"), "{text}");
}

#[test]
fn a_filled_mesh_is_a_scene() {
    let desk = Desk::new();
    let corners = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
    let faces = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";
    fs::write(desk.path("box.obj"), format!("{corners}{faces}")).unwrap();
    let told = desk.told("fill box.obj -o box.json --scale 100 --at -5,1000,0 --count 8 --points 24");
    assert!(told.contains("8 ellipsoids") && told.contains("% overlap"), "{told}");
    let scene = Scene::load(desk.path("box.json")).unwrap();
    let (low, high) = scene.bounds().unwrap();
    assert!((0.5 * (low + high)).distance(glam::DVec3::new(-5.0, 1000.0, 0.0)) < 15.0);
    // Larger by half an edge, and where ellipsoids bulge.
    assert!((high - low).min_element() > 180.0 && (high - low).max_element() < 290.0, "{}", high - low);
    fs::write(desk.path("open.obj"), format!("{corners}f 1 4 3 2\n")).unwrap();
    assert!(!told.contains("below the ground"), "{told}");
    let told = desk.told("fill box.obj -o low.json --count 2 --points 8");
    assert!(told.contains("below the ground") && told.contains("--at"), "{told}");
    assert!(desk.complaint("fill open.obj -o open.json").contains("mesh is open"));
}

#[test]
fn a_mesh_itself_is_the_boundary_of_a_cloud() {
    let desk = Desk::new();
    let corners = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
    let faces = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\n";
    fs::create_dir(desk.path("meshes")).unwrap();
    fs::write(desk.path("meshes/box.obj"), format!("{corners}{faces}f 2 3 7 6\n")).unwrap();
    let told = desk.told("fill meshes/box.obj --exact -o box.json --scale 100 --at -5,1000,0");
    assert!(told.contains("within 12 triangles") && !told.contains("openings"), "{told}");
    let scene = Scene::load(desk.path("box.json")).unwrap();
    let mesh = scene.clouds[0].mesh.as_ref().unwrap();
    assert_eq!((mesh.file.as_str(), mesh.scale), ("meshes/box.obj", 100.0));
    let (low, high) = scene.bounds().unwrap();
    assert_eq!((low.to_array(), high.to_array()), ([-105.0, 900.0, -100.0], [95.0, 1100.0, 100.0]));
    // A fifth of the radius of the ball that has as much volume over area.
    assert!((scene.clouds[0].edge.boundary - 20.0).abs() < 1e-9);
    // Saved elsewhere it finds its mesh again.
    scene.save(desk.path("meshes/beside.json")).unwrap();
    assert_eq!(
        Scene::load(desk.path("meshes/beside.json")).unwrap().clouds[0].mesh.as_ref().unwrap().file,
        "box.obj"
    );
    fs::write(desk.path("lidless.obj"), format!("{corners}{faces}")).unwrap();
    assert!(desk.told("fill lidless.obj --exact -o lidless.json").contains("openings"));
    fs::write(desk.path("sheet.obj"), format!("{corners}f 1 4 3 2\n")).unwrap();
    fs::write(desk.path("points.csv"), "0,0,0\n1,0,0\n").unwrap();
    for (words, part) in [
        ("fill sheet.obj --exact -o a.json", "is open"),
        ("fill points.csv --exact -o a.json", "have no surface"),
        ("fill gone.obj --exact -o a.json", "gone.obj"),
        ("fill meshes/box.obj --exact --count 3 -o a.json", "--count"),
    ] {
        let text = desk.complaint(words);
        assert!(text.contains(part), "{words}: {text}");
    }
}

#[test]
fn what_cannot_be_is_refused_in_words() {
    let desk = Desk::new();
    fs::write(desk.path("empty.json"), "{}").unwrap();
    for (words, part) in [
        ("export volume scene.json -o a.abc", "does not end in .vdb or .vol"),
        ("export volume empty.json -o a.vdb", "no cloud"),
        ("export volume scene.json -o a.vdb --voxel 0", "above 0"),
        ("export volume scene.json -o a.vdb --voxel 0.0001", "make them larger"),
        ("export volume scene.json -o missing/a.vdb --voxel 20", "no folder"),
        ("export sky scene.json -o a.ktx2 --size 10", "no multiple of 4"),
        ("export sky scene.json -o a.ktx2 --layout strip", "--layout strip is not for .ktx2 files"),
        ("export shadow scene.json -o a.exr --center 3", "2 numbers"),
        ("export flipbook scene.json -o a.png --cloud two", "`one`"),
        ("export sixway scene.json -o a.png --tile 4096 --frames 9", "fewer or smaller"),
        ("export impostor empty.json -o a.png", "no cloud"),
        ("export camera scene.json -o a.fbx", ".glb or .gltf"),
        ("export camera scene.json -o a.glb --animated", "--frames 1-240"),
        ("export camera scene.json -o a.gltf --frames 1-4", "does not end in .glb"),
        ("export camera scene.json -o a.glb --fps 24", "--animated"),
        ("export volume scene.json -o a.vol --half", "--half is for .vdb files"),
        ("export volume scene.json -o a.vol --velocity", "--velocity is for .vdb files"),
        ("render scene.json -o a.exr --layers=light,deep", "deep"),
        ("fill scene.json -o a.json", ".obj"),
    ] {
        let text = desk.complaint(words);
        assert!(text.contains(part), "{words}: {text}");
    }
}

/// The channels of an EXR file, sorted.
fn channels(path: &PathBuf) -> Vec<String> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    image.layer_data.channel_data.list.iter().map(|channel| channel.name.to_string()).collect()
}

#[test]
fn layers_are_those_that_were_named() {
    let desk = Desk::new();
    let written = |words: &str| {
        desk.told(&format!(
            "render scene.json -o a.exr {words} --quality draft --transport single --width 16 --height 9"
        ));
        channels(&desk.path("a.exr"))
    };
    assert_eq!(written("--layers=depth"), ["A", "B", "G", "R", "planar.Z"]);
    assert_eq!(written("--layers=motion"), ["A", "B", "G", "R", "motion.X", "motion.Y"]);
    let all = written("--layers=light,distance,normal,depth,position,motion,clouds");
    let plain = written("--layers");
    assert!(plain.iter().all(|name| all.contains(name)), "{plain:?}");
    for name in ["depth.Z", "lit.sun.R", "lit.sky.B", "multiple.G", "normal.X", "transmittance.Y"] {
        assert!(plain.iter().any(|own| own == name), "{name}: {plain:?}");
    }
    for name in ["CryptoCloud00.R", "CryptoCloud02.A", "planar.Z", "position.Y", "motion.Y"] {
        assert!(!plain.iter().any(|own| own == name) && all.iter().any(|own| own == name), "{name}");
    }
    let around = SMALL.replacen(
        '{',
        r#"{"camera":{"position":[0,900,1000],"target":[0,900,0],"projection":"equirectangular"},"#,
        1,
    );
    fs::write(desk.path("around.json"), around).unwrap();
    let size = "--quality draft --transport single --width 16 --height 8";
    let text = desk.complaint(&format!("render around.json -o b.exr --layers=depth {size}"));
    assert!(text.contains("`depth`") && text.contains("equirectangular"), "{text}");
    desk.told(&format!("render around.json -o b.exr --layers=distance,position {size}"));
}

#[test]
fn a_flight_goes_out_and_comes_back() {
    let desk = Desk::new();
    let moving = SMALL.replacen(
        '{',
        r#"{"camera":{"position":[0,900,1000],"target":[0,900,0],"shift_x":0.1},
        "timeline":{"length":1,"fps":12,"tracks":[{"path":"camera.position[0]","keys":[
            {"time":0,"value":0,"interpolation":"linear"},{"time":1,"value":240}]}]},"#,
        1,
    );
    fs::write(desk.path("moving.json"), moving).unwrap();
    desk.told("export camera moving.json -o shot.glb --animated");
    let camera = nephos::import::MovingCamera::read(&desk.path("shot.glb"), None).unwrap();
    for frame in 0..12 {
        let time = f64::from(frame) / 12.0;
        let found = camera.at(time);
        assert!((found.position.x - 240.0 * time).abs() < 1e-3 && found.shift_x == 0.1, "{time}: {found:?}");
    }
    assert!((camera.length() - 11.0 / 12.0).abs() < 1e-6);
    desk.told("export camera moving.json -o slow.glb --frames 1-7:3 --fps 3");
    let slow = nephos::import::MovingCamera::read(&desk.path("slow.glb"), None).unwrap();
    assert!((slow.length() - 2.0).abs() < 1e-6 && (slow.at(1.0).position.x - 240.0).abs() < 1e-3);
}

#[test]
fn cameras_that_move_are_taken_where_they_are_at_that_moment() {
    let desk = Desk::new();
    let moving = SMALL.replacen(
        '{',
        r#"{"camera":{"position":[0,900,1000],"target":[0,900,0]},
        "timeline":{"length":10,"tracks":[{"path":"camera.position[0]","keys":[
            {"time":0,"value":0,"interpolation":"linear"},{"time":10,"value":500}]}]},"#,
        1,
    );
    fs::write(desk.path("scene.json"), moving).unwrap();
    let position = |words: &str| {
        desk.command(&format!("export camera scene.json -o shot.gltf{words}")).assert().success();
        let text = fs::read_to_string(desk.path("shot.gltf")).unwrap();
        let file: serde_json::Value = serde_json::from_str(&text).unwrap();
        let node = file["nodes"].as_array().unwrap().iter().find(|node| node["camera"].is_number()).unwrap();
        let number = |name: &str, i: usize| node[name].get(i).and_then(serde_json::Value::as_f64);
        number("translation", 0).or(number("matrix", 12)).unwrap()
    };
    assert_eq!([position(""), position(" --time 4")], [0.0, 200.0]);
}

#[test]
fn layers_have_the_names_that_compositors_expect() {
    let desk = Desk::new();
    desk.told(
        "render scene.json -o layers.exr --layers --quality draft --transport single --width 32 --height 18",
    );
    let path = desk.path("layers.exr");
    let Some(told) = readers::program("exrheader", &[path.to_str().unwrap()]) else { return };
    // Colours are half floats; Nuke's depth is `depth.Z`, as float.
    for color in ["", "sky.", "single.", "multiple.", "air."] {
        for channel in ["R", "G", "B"] {
            assert!(
                told.contains(&format!("    {color}{channel}, 16-bit floating-point")),
                "{color}{channel}: {told}"
            );
        }
    }
    for line in
        ["    A, 16-bit", "    transmittance.Y, 16-bit", "    normal.X, 16-bit", "    depth.Z, 32-bit"]
    {
        assert!(told.contains(line), "{line}: {told}");
    }
}
