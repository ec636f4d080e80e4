//! Where files go: links, long and foreign names, old files, and places that cannot be written.

use std::{ffi::OsString, fs, path::Path};

use assert_cmd::Command;

const SCENE: &str =
    r#"{"clouds":[{"edge":{"boundary":30},"ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]}]}"#;

fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.json"), SCENE).unwrap();
    folder
}

/// `words` and then the output.
fn command(folder: &Path, words: &str, output: impl Into<OsString>) -> Command {
    let mut command = Command::cargo_bin("nephos").unwrap();
    command.current_dir(folder).args(words.split_whitespace()).arg("-o").arg(output.into());
    command
}

fn names(folder: &Path) -> usize {
    fs::read_dir(folder).unwrap().count()
}

const STILL: &str = "render scene.json --width 8 --height 8 --quality draft --transport single";
const MOVIE: &str =
    "sequence scene.json --frames 1-2 --width 8 --height 8 --quality draft --transport single";

fn has_ffmpeg() -> bool {
    let found = std::process::Command::new("ffmpeg").arg("-version").output().is_ok();
    if !found {
        eprintln!("skipped: there is no ffmpeg for movies");
    }
    found
}

#[test]
fn names_may_be_as_long_as_they_can_be() {
    let desk = desk();
    let long = |ending: &str| "x".repeat(255 - ending.len()) + ending;
    command(desk.path(), "new --preset sphere --force", long(".json")).assert().success();
    command(desk.path(), STILL, long(".png")).assert().success();
    command(desk.path(), "export camera scene.json", long(".glb")).assert().success();
    if has_ffmpeg() {
        command(desk.path(), MOVIE, long(".mp4")).assert().success();
        fs::remove_file(desk.path().join(long(".mp4"))).unwrap();
    }
    assert_eq!(names(desk.path()), 4);
    // Too long once the map is named: that is told before an adapter is looked for.
    let words = "export impostor scene.json --adapter nobodys";
    let refused = command(desk.path(), words, long(".png")).assert().failure();
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(told.contains("cannot write") && told.contains("x_normal.png"), "{told}");
}

#[cfg(unix)]
#[test]
fn names_need_be_no_text() {
    use std::os::unix::ffi::OsStringExt;
    let desk = desk();
    let name = |ending: &str| OsString::from_vec([b"H\xf6he", ending.as_bytes()].concat());
    command(desk.path(), "new --preset sphere --force", name(".json")).assert().success();
    let told = command(desk.path(), &format!("{STILL} --json"), name(".png")).assert().success();
    assert!(serde_json::from_slice::<serde_json::Value>(&told.get_output().stdout).is_ok());
    command(desk.path(), "export impostor scene.json --views 2 --tile 8", name(".png")).assert().success();
    command(desk.path(), MOVIE, name(".##.png")).assert().success();
    for expected in [".json", ".png", "_normal.png", "_depth.png", ".01.png", ".02.png"] {
        assert!(desk.path().join(name(expected)).exists(), "{expected}");
    }
    if has_ffmpeg() {
        command(desk.path(), MOVIE, name(":a.mp4")).assert().success();
        assert!(desk.path().join(name(":a.mp4")).exists());
    }
}

#[cfg(unix)]
#[test]
fn files_behind_links_are_replaced_and_keep_their_mode() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let desk = desk();
    let path = |name: &str| desk.path().join(name);
    fs::create_dir(path("there")).unwrap();
    let mut kinds = vec![
        ("new --preset sphere --force", "a.json"),
        (STILL, "a.png"),
        ("export camera scene.json", "a.gltf"),
    ];
    if has_ffmpeg() {
        kinds.push((MOVIE, "a.webm"));
    }
    for (words, name) in kinds {
        let file = path("there").join(name);
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(Path::new("there").join(name), path(name)).unwrap();
        command(desk.path(), words, name).assert().success();
        assert!(path(name).is_symlink(), "{name}");
        assert_ne!(fs::read(&file).unwrap(), b"old", "{name}");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640, "{name}");
        // A link to nothing yet.
        fs::remove_file(&file).unwrap();
        command(desk.path(), words, name).assert().success();
        assert!(path(name).is_symlink() && file.is_file(), "{name}");
    }
}

#[test]
fn places_that_cannot_be_written_are_told_before_the_work() {
    let desk = desk();
    fs::create_dir(desk.path().join("folder.png")).unwrap();
    fs::create_dir(desk.path().join("folder.exr")).unwrap();
    fs::create_dir(desk.path().join("a_depth.png")).unwrap();
    fs::create_dir(desk.path().join("sky.ny.hdr")).unwrap();
    let before = names(desk.path());
    for (words, output, part) in [
        (STILL, "missing/a.png", "no folder `missing`"),
        (STILL, "folder.png", "is a folder"),
        ("export volume scene.json", "missing/a.vdb", "no folder `missing`"),
        ("export shadow scene.json", "folder.exr", "is a folder"),
        ("export flipbook scene.json", "missing/a.png", "no folder `missing`"),
        ("export sixway scene.json", "scene.json/a.png", "cannot write"),
        ("export impostor scene.json", "a.png", "a_depth.png"),
        ("export sky scene.json --layout cubemap", "sky.hdr", "sky.ny.hdr"),
    ] {
        let refused = command(desk.path(), &format!("{words} --adapter nobodys"), output).assert().failure();
        let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(told.contains(part), "{words} -o {output}: {told}");
        assert_eq!(names(desk.path()), before, "{words} -o {output}");
    }
    // A device takes what it is given.
    #[cfg(unix)]
    command(desk.path(), "new --preset sphere --force", "/dev/null").assert().success();
}
