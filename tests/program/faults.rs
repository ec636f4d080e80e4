//! What is wrong from outside: damaged files, disks that are full, folders that are none. It ends
//! in an error, never in a panic or in half a file.

use std::{fs, path::Path};

use assert_cmd::Command;
use nephos::{
    import::{Inside, fill, read_camera, read_mesh},
    scene::Scene,
    tables::{Grids, MieTables},
};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{RngCore, SeedableRng},
};

/// Files of each kind that are tried; `cargo fuzz` in `fuzz/` tries more.
const TRIES: usize = 4000;

/// Names and bytes.
fn corpus(name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = format!("{}/fuzz/corpus/{name}", env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.sort();
    let name = |file: &Path| file.file_name().unwrap().to_str().unwrap().to_owned();
    files.into_iter().map(|file| (name(&file), fs::read(file).unwrap())).collect()
}

/// Cuts, flips, repeats or replaces a piece of the bytes.
fn damage(bytes: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    const TOKENS: [&[u8]; 10] = [
        b"{",
        b"[[[[",
        b"}",
        b"null",
        b"-1",
        b"1e309",
        b"\"\\u0000\"",
        b"18446744073709551616",
        b",",
        b"\xff",
    ];
    let mut below = |most: usize| random.next_u32() as usize % most.max(1);
    let at = below(bytes.len());
    match below(5) {
        0 => bytes.truncate(at),
        1 if !bytes.is_empty() => bytes[at] ^= 1 << below(8),
        2 => {
            let end = (at + below(40)).min(bytes.len());
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
        3 => {
            let end = (at + below(8)).min(bytes.len());
            bytes.splice(at..end, TOKENS[below(TOKENS.len())].iter().copied());
        }
        _ => {
            bytes.drain(at..(at + below(8)).min(bytes.len()));
        }
    }
}

/// Tries damaged files, the same in each run.
fn try_damaged(name: &str, read: impl Fn(&str, &[u8])) {
    let files = corpus(name);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for tried in 0..TRIES {
        let (name, mut bytes) = files[tried % files.len()].clone();
        for _ in 0..=random.next_u32() % 4 {
            damage(&mut bytes, &mut random);
        }
        read(&name, &bytes);
    }
}

#[test]
fn damaged_scenes_are_refused_or_valid() {
    try_damaged("scene", |_, bytes| {
        if let Ok(scene) = Scene::from_json(&String::from_utf8_lossy(bytes)) {
            scene.validate().unwrap();
            assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
        }
    });
}

/// Whether the bytes are a table of either kind.
fn reads(bytes: &[u8]) -> bool {
    Grids::decode("tried", bytes).is_ok() || MieTables::decode(bytes).is_ok()
}

#[test]
fn damaged_tables_are_refused() {
    for (name, bytes) in corpus("tables") {
        assert!(reads(&bytes), "{name} is whole");
    }
    try_damaged("tables", |_, bytes| {
        reads(bytes);
    });
}

#[test]
fn a_flipped_bit_of_a_table_is_found() {
    for (_, whole) in corpus("tables") {
        for place in (0..whole.len()).step_by(whole.len() / 97 + 1) {
            let mut bytes = whole.clone();
            bytes[place] ^= 0x10;
            assert!(!reads(&bytes), "byte {place}");
            assert!(!reads(&whole[..place]), "cut at {place}");
        }
    }
}

/// Tries damaged files by name; those of the corpus itself are whole.
fn try_damaged_files(name: &str, read: impl Fn(&Path) -> bool) {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, bytes: &[u8]| {
        let file = folder.path().join(name);
        fs::write(&file, bytes).unwrap();
        read(&file)
    };
    for (name, bytes) in corpus(name) {
        assert!(read(&name, &bytes), "{name} is whole");
    }
    try_damaged(name, |name, bytes| {
        read(name, bytes);
    });
}

#[test]
fn damaged_meshes_are_refused_or_filled() {
    try_damaged_files("mesh", |file| {
        let mesh = read_mesh(file);
        // Some coordinates are damaged into great ones, and some corners into none.
        mesh.is_ok_and(|mesh| fill(&Inside::new(&mesh, 8), 2, 1).is_ok())
    });
}

#[test]
fn damaged_cameras_are_refused_or_valid() {
    try_damaged_files("camera", |file| {
        let camera = read_camera(file, Some("camera")).or_else(|_| read_camera(file, None));
        camera.is_ok_and(|camera| Scene::default().seen_by(camera).validate().is_ok())
    });
}

#[test]
fn depths_and_counts_without_end_are_refused() {
    let deep = "[".repeat(1_000_000);
    let many = format!(r#"{{"clouds": [{}{{}}]}}"#, "{},".repeat(100_000));
    for (text, word) in [(deep, "expected"), (many, "too many")] {
        let error = Scene::from_json(&text).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
}

fn refused(words: &[&str], scene: &str) -> String {
    let command = Command::cargo_bin("nephos").unwrap().args(words).write_stdin(scene).assert().failure();
    let text = String::from_utf8(command.get_output().stderr.clone()).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    text
}

#[test]
fn outputs_that_cannot_be_written_are_told_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let small = ["--width", "8", "--height", "8", "--quality", "draft", "--transport", "single"];
    let folder_path = folder.path().to_str().unwrap();
    let taken = format!("{folder_path}/taken.png");
    fs::create_dir(&taken).unwrap();
    let nowhere = format!("{folder_path}/no/such/a.exr");
    for path in [taken.as_str(), nowhere.as_str()] {
        let text = refused(&[&["render", "-", "-o", path], &small[..]].concat(), "{}");
        assert!(text.contains(path), "{text}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside");
}

/// Not even an administrator writes there.
#[test]
#[cfg(target_os = "linux")]
fn folders_that_nobody_may_write_in_are_told() {
    let small = ["--width", "8", "--height", "8", "--quality", "draft", "--transport", "single"];
    for words in [&["render", "-", "-o", "/sys/a.png"][..], &["render", "-", "-o", "/sys/a.exr"]] {
        let text = refused(&[words, &small[..]].concat(), "{}");
        assert!(text.contains("/sys/a."), "{text}");
        assert!(
            text.contains("denied") || text.contains("Read-only") || text.contains("permitted"),
            "{text}"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.json");
    fs::write(&scene, "{}").unwrap();
    let words = ["sequence", scene.to_str().unwrap(), "-o", "/sys/nephos/a.####.png", "--frames", "1-2"];
    let text = refused(&[&words, &small[..]].concat(), "");
    assert!(text.contains("cannot create `/sys/nephos`"), "{text}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["full.png", "full.exr"] {
        let link = folder.path().join(name);
        std::os::unix::fs::symlink("/dev/full", &link).unwrap();
        let link = link.to_str().unwrap();
        let small = ["--width", "8", "--height", "8", "--quality", "draft", "--transport", "single"];
        let text = refused(&[&["render", "-", "-o", link], &small[..]].concat(), "{}");
        assert!(text.contains("No space left"), "{text}");
    }
    let text = refused(&["new", "--preset", "kol", "-o", "/dev/full", "--force"], "");
    assert!(text.contains("No space left"), "{text}");
}
