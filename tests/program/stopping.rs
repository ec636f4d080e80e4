//! Ctrl-C: work stops where files are whole, with exit code 130 and a word on what is kept.
#![cfg(unix)]

use std::{
    fs,
    io::{BufRead, BufReader, Read},
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

use nephos::export::read_estimate;

const SCENE: &str = r#"{"sky": "none", "clouds": [{"droplets": {"phase": "isotropic"}, "ellipsoids": [
    {"center": [0, 900, 0], "radii": [120, 70, 100]}]}],
    "timeline": {"length": 1000, "tracks": [{"path": "sun.position.angles.azimuth_deg",
        "keys": [{"time": 0, "value": 0}, {"time": 1000, "value": 300}]}]}}"#;

/// Starts the program in `folder` and waits until it has the adapter.
fn start(folder: &Path, words: &str) -> Child {
    fs::write(folder.join("scene.json"), SCENE).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_nephos"));
    command.args(words.split_whitespace()).current_dir(folder).env("RUST_LOG", "nephos=info");
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("opening adapter") {
        line.clear();
        assert!(lines.read_line(&mut line).unwrap() > 0, "it ended by itself");
    }
    // What is in the reader's buffer is lost, and there is nothing.
    child.stderr = Some(lines.into_inner());
    child
}

/// Presses Ctrl-C, and gives what the program said then.
fn stop(mut child: Child) -> String {
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
    assert!(said.contains("nephos: stopped: "), "{said}");
    said
}

/// Names of the files, but for the scene.
fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| name != "scene.json");
    names.sort();
    names
}

/// Waits for a file as long as the program that will write it runs.
fn wait_for(file: &Path, child: &mut Child) {
    while !file.exists() {
        let runs = child.try_wait().unwrap().is_none();
        assert!(runs || file.exists(), "it ended without `{}`", file.display());
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_picture_that_is_stopped_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let child = start(folder.path(), "render scene.json -o a.png --width 4096 --height 4096 --supersample 1");
    let said = stop(child);
    assert!(said.contains("nothing was written to `a.png`"), "{said}");
    assert_eq!(files(folder.path()), [""; 0]);
}

#[test]
fn a_path_traced_picture_that_is_stopped_keeps_its_samples_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let words = "render scene.json -o a.exr --transport path --width 16 --height 9 --resume --spp";
    let render = |samples: u32| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nephos"));
        command.args(words.split_whitespace()).arg(samples.to_string()).current_dir(folder.path());
        assert!(command.status().unwrap().success());
    };
    fs::write(folder.path().join("scene.json"), SCENE).unwrap();
    render(15);
    // However early it is stopped, what there was is kept; later, what was found since, too.
    let stopped_after = |seconds: u64| {
        let child = start(folder.path(), &format!("{words} 1000000"));
        thread::sleep(Duration::from_secs(seconds));
        let said = stop(child);
        assert_eq!(files(folder.path()), ["a.exr"], "{said}");
        said
    };
    // Ever longer, for a busy machine.
    let found = [0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512]
        .into_iter()
        .map(stopped_after)
        .find(|said| said.contains("is whole"));
    let said = found.unwrap();
    assert!(said.contains("--resume goes on"), "{said}");
    let samples = || read_estimate(&folder.path().join("a.exr")).unwrap().estimate.samples;
    let kept = samples();
    assert!(kept >= 15 && said.contains(&format!("with {kept} samples a pixel")), "{said}");
    render(kept + 30);
    assert_eq!(samples(), kept + 30);
}

#[test]
fn a_sequence_that_is_stopped_keeps_its_frames_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let words = "sequence scene.json -o frame.####.png --width 16 --height 9 --quality draft \
                 --transport single --json --frames";
    let mut child = start(folder.path(), &format!("{words} 1-9000"));
    wait_for(&folder.path().join("frame.0003.png"), &mut child);
    let said = stop(child);
    let names = files(folder.path());
    let expected: Vec<_> = (1..=names.len()).map(|i| format!("frame.{i:04}.png")).collect();
    assert_eq!(names, expected, "no more and no less");
    assert!(said.contains(&format!("{} of 9000 frames", names.len())), "{said}");
    let mut again = Command::new(env!("CARGO_BIN_EXE_nephos"));
    let more = format!("{words} 1-{}", names.len() + 1);
    let told = again.args(more.split_whitespace()).current_dir(folder.path()).output().unwrap().stdout;
    let report: serde_json::Value = serde_json::from_slice(&told).unwrap();
    assert_eq!((&report["found"], &report["drawn"]), (&names.len().into(), &1.into()), "all are whole");
}

#[test]
fn a_benchmark_that_is_stopped_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let child = start(folder.path(), "bench reference --filter kol-thick --folder references");
    stop(child);
    assert_eq!(files(&folder.path().join("references")), [""; 0]);
}
