//! `nephos sequence` as a user calls it: frames, movies, what is kept and what is drawn again.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    time::Duration,
};

use glam::DVec3;
use nephos::scene::{
    Scene,
    timeline::{Interpolation, Key, Timeline, Track},
};
use serde_json::Value;

/// What the words of a test do not say otherwise.
const USUAL: [(&str, &str); 4] =
    [("--width", "32"), ("--height", "18"), ("--quality", "draft"), ("--transport", "single")];

/// One cloud in a wind, in a loop of a second of 12 frames.
fn looping() -> Scene {
    let text = r#"{"clouds":[{"name":"a","ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]}],
        "wind":{"velocity":[30,0,0]},"timeline":{"length":1,"fps":12,"loop":true,"tracks":[]}}"#;
    Scene::from_json(text).unwrap()
}

fn moving(path: &str, keys: [f64; 2]) -> Scene {
    let keys = [0.0, 1.0]
        .map(|time| Key { interpolation: Interpolation::Linear, ..Key::new(time, keys[time as usize]) });
    let track = Track { path: path.to_owned(), keys: keys.to_vec() };
    let timeline = Timeline { length: 1.0, fps: 12.0, looped: false, tracks: vec![track] };
    let still = Scene { wind: Default::default(), timeline: None, ..looping() };
    Scene { camera: Some(still.camera()), timeline: Some(timeline), ..still }
}

struct Place(tempfile::TempDir);

impl Place {
    fn of(scene: &Scene) -> Self {
        let folder = tempfile::tempdir().unwrap();
        scene.save(folder.path().join("scene.json")).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, output: &str, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nephos"));
        command.arg("sequence").arg(self.path("scene.json")).arg("-o").arg(self.path(output));
        command.args(words.split_whitespace()).arg("--json");
        // Path traced pictures have no quality.
        let set = |word: &str| words.contains(word) || (word == "--quality" && words.contains("path"));
        let usual = USUAL.iter().filter(|(word, _)| !set(word));
        command.args(usual.flat_map(|(word, value)| [word, value]));
        if let Ok(name) = std::env::var("NEPHOS_ADAPTER") {
            command.args(["--adapter", &name]);
        }
        command
    }

    fn run(&self, output: &str, words: &str) -> Output {
        self.command(output, words).output().unwrap()
    }

    fn report(&self, output: &str, words: &str) -> Value {
        let output = self.run(output, words);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }

    fn complaint(&self, output: &str, words: &str) -> String {
        let output = self.run(output, words);
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && !text.contains("panicked"), "{text}");
        text
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }
}

fn counts(report: &Value) -> [u64; 4] {
    ["frames", "drawn", "found", "repeated"].map(|name| report[name].as_u64().unwrap())
}

/// Mean difference of two PNG pictures, 0 to 255.
fn difference(place: &Place, a: &str, b: &str) -> f64 {
    let [a, b] = [a, b].map(|name| image::open(place.path(name)).unwrap().into_rgb8().into_raw());
    let sum: u64 = a.iter().zip(&b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len() as f64
}

#[test]
fn a_loop_closes_and_its_frames_do_not_depend_on_order_or_shard() {
    let place = Place::of(&looping());
    assert_eq!(counts(&place.report("all/f.###.png", "")), [12, 12, 0, 0]);
    // The frame after the last is the first, bit for bit; the last leads to it as the first leads on.
    place.report("more/f.###.png", "--frames 13");
    assert_eq!(place.bytes("all/f.001.png"), place.bytes("more/f.013.png"));
    let steps: Vec<f64> = (1..=12)
        .map(|i| {
            let next = i % 12 + 1;
            difference(&place, &format!("all/f.{i:03}.png"), &format!("all/f.{next:03}.png"))
        })
        .collect();
    let mean = steps[..11].iter().sum::<f64>() / 11.0;
    assert!(mean > 0.1 && steps[11] < 2.0 * mean, "{steps:?}");
    // Backwards and in three shards it is the same.
    for shard in ["3/3", "1/3", "2/3"] {
        let report = place.report("parts/f.###.png", &format!("--shard {shard}"));
        assert_eq!(counts(&report), [4, 4, 0, 0]);
    }
    for i in 1..=12 {
        assert_eq!(
            place.bytes(&format!("all/f.{i:03}.png")),
            place.bytes(&format!("parts/f.{i:03}.png")),
            "{i}"
        );
    }
}

#[test]
fn whole_frames_of_the_same_scene_are_kept_and_others_drawn_again() {
    for ending in ["png", "exr"] {
        let place = Place::of(&looping());
        let output = format!("f.##.{ending}");
        let name = |i: u32| format!("f.{i:02}.{ending}");
        assert_eq!(counts(&place.report(&output, "--frames 1-4")), [4, 4, 0, 0]);
        let whole = place.bytes(&name(2));
        // One cut short as by a full disk, one gone, one of something else; frames 5 and 6 are new.
        fs::write(place.path(&name(2)), &whole[..whole.len() - 30]).unwrap();
        fs::remove_file(place.path(&name(3))).unwrap();
        fs::write(place.path(&name(4)), "no picture").unwrap();
        assert_eq!(counts(&place.report(&output, "--frames 1-6")), [6, 5, 1, 0]);
        // Attributes of EXR files have no order.
        let sorted = |mut bytes: Vec<u8>| {
            bytes.sort_unstable();
            bytes
        };
        assert!(sorted(place.bytes(&name(2))) == sorted(whole), "{ending}");
        assert_eq!(counts(&place.report(&output, "--frames 1-6")), [6, 0, 6, 0]);
        // Another size, another scene: all of it anew.
        assert_eq!(counts(&place.report(&output, "--frames 1-6 --supersample 2")), [6, 6, 0, 0]);
        let mut scene = looping();
        scene.exposure = 1.0;
        scene.save(place.path("scene.json")).unwrap();
        assert_eq!(counts(&place.report(&output, "--frames 1-6")), [6, 6, 0, 0]);
        // A name is seen in no picture.
        scene.name = "another".to_owned();
        scene.save(place.path("scene.json")).unwrap();
        assert_eq!(counts(&place.report(&output, "--frames 1-6")), [6, 0, 6, 0]);
    }
}

#[test]
fn all_frames_have_one_auto_exposure_whichever_are_drawn_and_it_is_told() {
    // From day to dusk: metered one by one, frames would differ by stops.
    let place = Place::of(&moving("sun.position.angles.elevation_deg", [40.0, 1.0]));
    let stops = |report: &Value| report["auto_exposure_stops"].as_f64();
    let [all, last] = ["--frames 1,12", "--frames 12"].map(|frames| {
        let name = frames.split(',').count();
        let report = place.report(&format!("{name}.##.png"), frames);
        (stops(&report), place.bytes(&format!("{name}.12.png")))
    });
    assert!(all.0.is_some() && all == last, "{:?} {:?}", all.0, last.0);
    let by_hand = format!("--frames 12 --auto-exposure off --exposure {}", all.0.unwrap());
    let report = place.report("hand.##.png", &by_hand);
    // The stamps differ, the pixels don't.
    assert_eq!((stops(&report), difference(&place, "hand.12.png", "1.12.png")), (None, 0.0));
    // EXR files are never exposed.
    assert_eq!(stops(&place.report("light.##.exr", "--frames 12")), None);
    // What the other frames are like tells how this one is exposed.
    let mut scene = Scene::load(place.path("scene.json")).unwrap();
    scene.timeline.as_mut().unwrap().tracks[0].keys[0].value = 80.0;
    scene.save(place.path("scene.json")).unwrap();
    assert_eq!(counts(&place.report("1.##.png", "--frames 12")), [1, 1, 0, 0]);
}

#[test]
fn what_did_not_change_is_not_done_again() {
    let updates = |report: &Value| report["light_updates"].as_u64().unwrap();
    // Exposure has nothing to do with light.
    let place = Place::of(&moving("exposure", [0.0, 2.0]));
    let one = place.report("one.#.png", "--frames 1");
    let all = place.report("f.##.png", "");
    assert_eq!((counts(&all), updates(&all)), ([12, 12, 0, 0], updates(&one)));
    assert!(updates(&one) > 0);
    // The sun changes all of it, in every frame.
    let place = Place::of(&moving("sun.position.angles.elevation_deg", [45.0, 30.0]));
    let sun = place.report("f.##.png", "");
    assert!(updates(&sun) >= 12, "{sun}");
    // Frames that show the same are drawn once.
    let still = place.report("s.##.png", "--frames 12-20");
    assert_eq!(counts(&still), [9, 2, 0, 7]);
    assert_eq!(place.bytes("s.13.png"), place.bytes("s.20.png"));
    assert_ne!(place.bytes("s.12.png"), place.bytes("s.13.png"));
}

#[test]
fn a_sequence_that_was_killed_goes_on_and_leaves_no_half_frame() {
    let place = Place::of(&looping());
    let mut child =
        place.command("f.##.png", "--width 160 --height 90").stdout(Stdio::null()).spawn().unwrap();
    let second = place.path("f.02.png");
    while !second.exists() {
        assert!(child.try_wait().unwrap().is_none() || second.exists(), "it ended without a second frame");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let there = (1..=12).filter(|i| place.path(&format!("f.{i:02}.png")).exists());
    let there: Vec<u32> = there.collect();
    for i in &there {
        image::open(place.path(&format!("f.{i:02}.png"))).unwrap();
    }
    let [frames, drawn, found, _] = counts(&place.report("f.##.png", "--width 160 --height 90"));
    assert_eq!((frames, found, drawn), (12, there.len() as u64, 12 - there.len() as u64));
}

#[test]
fn path_traced_frames_are_kept_only_when_done() {
    let place = Place::of(&looping());
    let words = "--transport path --spp 3 --frames 1-2 --width 8 --height 5";
    assert_eq!(counts(&place.report("t.#.exr", words)), [2, 2, 0, 0]);
    assert_eq!(counts(&place.report("t.#.exr", words)), [2, 0, 2, 0]);
    assert_eq!(counts(&place.report("t.#.exr", &words.replace("spp 3", "spp 4"))), [2, 2, 0, 0]);
}

#[test]
fn what_was_left_out_and_what_says_the_same_are_one_picture() {
    let place = Place::of(&looping());
    let drawn = |words: &str| counts(&place.report("f.##.png", &format!("--frames 1-2 {words}")))[1];
    assert_eq!(drawn("--transport slab-kol"), 2);
    assert_eq!(drawn("--transport slab-kol --supersample 1"), 0);
    assert_eq!(drawn("--transport slab-kol --supersample 2"), 2);
}

#[test]
fn what_cannot_be_is_told_before_the_first_frame() {
    let mut scene = looping();
    scene.timeline = None;
    let still = Place::of(&scene);
    assert!(still.complaint("f.##.png", "").contains("--frames 1-240"));
    assert_eq!(counts(&still.report("f.##.png", "--frames 1-2 --fps 12")), [2, 2, 0, 0]);

    let place = Place::of(&looping());
    let cases = [
        ("frame.png", "", "####"),
        ("f.#.jpeg", "", "neither .png nor .exr"),
        ("f.#.png", "--layers", ".exr"),
        ("f.#.png", "--frames 9-1", "runs backwards"),
        ("f.#.png", "--shard 3/2", "I from 1 to N"),
        ("f.#.png", "--fps 12.5", "no whole number"),
        ("f.#.png", "--fps 0", "above 0"),
        ("f.#.png", "--adapter nobody", "nobody"),
        ("f.#.png", "--from g.#.png", "--from is for movies"),
        ("m.mp4", "--from g.#.exr", "made of .png files"),
        ("m.mp4", "--shard 1/2", "--shard is not for movies"),
        ("m.webm", "--transparent", "--transparent is not for movies"),
    ];
    for (output, words, fragment) in cases {
        let text = place.complaint(output, words);
        assert!(text.contains(fragment), "{output} {words}: {text}");
    }
    // The camera runs into its target in the last frame: told before anything is drawn.
    let mut scene = moving("camera.position[0]", [500.0, 0.0]);
    let camera = scene.camera.as_mut().unwrap();
    (camera.position, camera.target) = (DVec3::new(500.0, 100.0, 300.0), DVec3::ZERO);
    let timeline = scene.timeline.as_mut().unwrap();
    let keys = timeline.tracks[0].keys.clone();
    for (axis, value) in [(1, 100.0), (2, 300.0)] {
        let mut keys = keys.clone();
        keys[0].value = value;
        timeline.tracks.push(Track { path: format!("camera.position[{axis}]"), keys });
    }
    let place = Place::of(&scene);
    let text = place.complaint("f.##.png", "--frames 1-13");
    assert!(text.contains("camera.target") && text.contains("at 1 seconds"), "{text}");
    assert!(!place.path("f.01.png").exists());
}

// --- Movies -------------------------------------------------------------------------

fn there(tool: &str) -> bool {
    let found = Command::new(tool).arg("-version").output().is_ok();
    if !found {
        eprintln!("skipped: there is no {tool} here; install it to run this test");
    }
    found
}

/// Size, frames, frames per second and format of a movie, as ffprobe counts them.
fn probed(movie: &Path) -> (u64, u64, String, String, String) {
    let output = Command::new("ffprobe")
        .args(["-v", "error", "-count_frames", "-show_streams", "-of", "json"])
        .arg(movie)
        .output()
        .unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let stream = &found["streams"][0];
    let text = |name: &str| stream[name].as_str().unwrap_or_default().to_owned();
    let number = |name: &str| stream[name].as_u64().unwrap();
    (number("width"), number("height"), text("nb_read_frames"), text("r_frame_rate"), text("codec_name"))
}

/// What a movie says of its colours: range, matrix, curve and primaries.
fn tags(movie: &Path) -> Vec<String> {
    let entries = "stream=color_range,color_space,color_transfer,color_primaries";
    let words = ["-v", "error", "-select_streams", "v", "-show_entries", entries, "-of", "json"];
    let output = Command::new("ffprobe").args(words).arg(movie).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let tag = |name: &str| found["streams"][0][name].as_str().unwrap_or_default().to_owned();
    ["color_range", "color_space", "color_transfer", "color_primaries"].map(tag).into()
}

fn mean_colour(picture: &Path) -> [f64; 3] {
    let pixels = image::open(picture).unwrap().into_rgb8();
    let count = f64::from(pixels.width() * pixels.height());
    let sum = pixels.pixels().fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|c| sum[c] + f64::from(pixel[c])));
    sum.map(|sum| sum / count)
}

#[test]
fn movies_hold_every_frame_in_the_colours_of_the_pictures() {
    if !there("ffmpeg") || !there("ffprobe") {
        return;
    }
    let place = Place::of(&looping());
    place.report("f.##.png", "--width 33");
    for (movie, codec) in [("m.mp4", "h264"), ("m.webm", "vp9")] {
        assert_eq!(counts(&place.report(movie, "--width 33"))[..2], [12, 12]);
        // Players want even sizes.
        let expected = (34, 18, "12".to_owned(), "12/1".to_owned(), codec.to_owned());
        assert_eq!(probed(&place.path(movie)), expected);
        assert_eq!(tags(&place.path(movie)), ["tv", "bt709", "bt709", "bt709"], "{movie}");
        let out = place.path("back.png");
        let words = ["-v", "error", "-y", "-i", movie, "-frames:v", "1", "-vf", "crop=33:18:0:0", "back.png"];
        let done = Command::new("ffmpeg").args(words).current_dir(place.0.path()).status().unwrap();
        assert!(done.success() && out.exists());
        // Small coloured details are lost to chroma of half the size; the mean colour is not. The
        // colours of television of old would shift it by 5 and more.
        let [picture, back] = ["f.01.png", "back.png"].map(|name| mean_colour(&place.path(name)));
        let apart = picture.iter().zip(back).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 2.5, "{movie}: {picture:?} {back:?}");
    }
    let left: Vec<_> =
        fs::read_dir(place.0.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().contains(".tmp")), "{left:?}");
}

#[test]
fn a_movie_is_made_of_the_frames_that_are_there_and_what_is_missing_is_drawn() {
    if !there("ffmpeg") || !there("ffprobe") {
        return;
    }
    let place = Place::of(&looping());
    place.report("f.##.png", "");
    let from = format!("--from {}", place.path("f.##.png").display());
    // All are there: no adapter is asked for.
    let report = place.report("m.mp4", &format!("{from} --adapter nobody"));
    assert_eq!(counts(&report), [12, 0, 12, 0]);
    fs::remove_file(place.path("f.03.png")).unwrap();
    assert_eq!(counts(&place.report("m.mp4", &from)), [12, 1, 11, 0]);
    assert_eq!(probed(&place.path("m.mp4")).2, "12");
    // Frames of another quality are others.
    assert_eq!(counts(&place.report("m.mp4", &format!("{from} --quality preview --frames 1-2")))[1], 2);
}

// --- Render farms -------------------------------------------------------------------

/// The Open Job Description template as its own command line tool runs it: `pip install openjd-cli`.
#[test]
fn the_job_template_is_valid_and_renders_and_encodes() {
    let template = concat!(env!("CARGO_MANIFEST_DIR"), "/farm/sequence.yaml");
    if Command::new("openjd").arg("--version").output().is_err() {
        eprintln!("skipped: there is no openjd here; `pip install openjd-cli` to run this test");
        return;
    }
    let checked = Command::new("openjd").args(["check", template]).output().unwrap();
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    if !there("ffmpeg") || !there("ffprobe") {
        return;
    }
    let place = Place::of(&looping());
    let program = Path::new(env!("CARGO_BIN_EXE_nephos")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let [scene, output] = ["scene.json", "out"].map(|name| place.path(name).display().to_string());
    let run = |words: &[&str]| {
        let parameters = [
            format!("Scene={scene}"),
            format!("Output={output}"),
            "Frames=1-12".to_owned(),
            "Fps=12".to_owned(),
            "Shards=3".to_owned(),
            "Width=32".to_owned(),
            "Height=18".to_owned(),
            "Quality=draft".to_owned(),
        ];
        let mut command = Command::new("openjd");
        command.args(["run", template]).args(words).env("PATH", &path);
        for parameter in &parameters {
            command.args(["-p", parameter]);
        }
        let ran = command.output().unwrap();
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stdout));
    };
    // One part, as one worker draws it; then all of it, with what is there left alone.
    run(&["--step", "Render", "--task-param", "Shard=2"]);
    let there = (1..=12).filter(|i| place.path(&format!("out/frame.{i:04}.png")).exists());
    assert_eq!(there.collect::<Vec<u32>>(), [2, 5, 8, 11]);
    let stamp = fs::metadata(place.path("out/frame.0002.png")).unwrap().modified().unwrap();
    run(&["--step", "Encode", "--run-dependencies"]);
    assert_eq!(fs::metadata(place.path("out/frame.0002.png")).unwrap().modified().unwrap(), stamp);
    assert!((1..=12).all(|i| place.path(&format!("out/frame.{i:04}.png")).exists()));
    let (width, height, frames, rate, _) = probed(&place.path("out/sequence.mp4"));
    assert_eq!((width, height, frames.as_str(), rate.as_str()), (32, 18, "12", "12/1"));
}

#[cfg(unix)]
#[test]
fn the_slurm_array_renders_and_encodes() {
    if !there("ffmpeg") || !there("ffprobe") {
        return;
    }
    let place = Place::of(&looping());
    let program = Path::new(env!("CARGO_BIN_EXE_nephos")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    for task in ["1", "2", "0"] {
        let ran = Command::new("sh")
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/farm/slurm.sh"))
            .args([place.path("scene.json"), place.path("out")])
            .envs([("SLURM_ARRAY_TASK_ID", task), ("SLURM_ARRAY_TASK_COUNT", "2"), ("PATH", &path)])
            .envs([
                ("FRAMES", "1-12"),
                ("OPTIONS", "--width 32 --height 18 --quality draft --transport single"),
            ])
            .output()
            .unwrap();
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    }
    assert_eq!(probed(&place.path("out/sequence.mp4")).2, "12");
}

#[test]
fn without_ffmpeg_the_program_says_what_to_do_and_writes_nothing() {
    let place = Place::of(&looping());
    let output = place.command("m.mp4", "").env("PATH", place.0.path()).output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && text.contains("apt-get install ffmpeg"), "{text}");
    assert!(text.contains("frame.####.png") && !place.path("m.mp4").exists());
}

#[cfg(unix)]
#[test]
fn a_failing_ffmpeg_is_quoted_and_leaves_no_half_movie() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::of(&looping());
    fs::create_dir(place.path("bin")).unwrap();
    let broken = place.path("bin/ffmpeg");
    fs::write(&broken, "#!/bin/sh\necho 'Unknown encoder libx264' >&2\nexit 1\n").unwrap();
    fs::set_permissions(&broken, fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:/usr/bin:/bin", place.path("bin").display());
    let output = place.command("m.mp4", "--frames 1-4").env("PATH", path).output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && text.contains("Unknown encoder libx264"), "{text}");
    assert!(!place.path("m.mp4").exists());
}

#[test]
fn names_and_numbers_of_frames_are_those_of_other_programs() {
    let place = Place::of(&looping());
    place.report("out/a.%03d.png", "--frames -1-1");
    place.report("out/b_$F2.png", "--frames -12 --fps 24000/1000");
    for name in ["a.-01.png", "a.000.png", "a.001.png", "b_-12.png"] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
}
