//! `nephos new` and `nephos schema`: what they write, and what they refuse to overwrite.
#![cfg(feature = "cli")]

use std::fs;
use std::path::Path;

use clap::Parser;
use nephos::Error;
use nephos::cli::new::New;
use nephos::cli::schema::Schema;
use nephos::scene::{Preset, Scene, schema};

#[derive(Parser)]
enum Line {
    New(New),
    Schema(Schema),
}

fn run(words: &[&str], output: &Path) -> nephos::Result<()> {
    let output = ["-o", output.to_str().unwrap()];
    let words = ["nephos"].iter().chain(words).chain(&output);
    match Line::parse_from(words) {
        Line::New(new) => new.run(),
        Line::Schema(schema) => schema.run(),
    }
}

#[test]
fn new_writes_the_preset_of_its_seed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.json");
    run(&["new", "--preset", "congestus", "--seed", "9"], &path).unwrap();
    assert_eq!(Scene::load(&path).unwrap(), Preset::Congestus.scene(9));
}

#[test]
fn new_overwrites_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.json");
    fs::write(&path, "mine").unwrap();
    let error = run(&["new", "--preset", "kol"], &path).unwrap_err();
    assert!(
        matches!(&error, Error::Argument(text) if text.contains("--force")),
        "{error}"
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    run(&["new", "--preset", "kol", "--force"], &path).unwrap();
    assert_eq!(Scene::load(&path).unwrap(), Preset::Kol.scene(1));
}

#[test]
fn mistyped_preset_is_answered_with_the_nearest_and_all_others() {
    let words = ["nephos", "new", "--preset", "congestos"];
    let answer = Line::try_parse_from(words).err().unwrap().to_string();
    assert!(answer.contains("'congestus'"), "{answer}");
    assert!(answer.contains("humilis"), "{answer}");
}

#[test]
fn schema_is_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.schema.json");
    run(&["schema"], &path).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.ends_with("}\n"));
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&text).unwrap(),
        schema()
    );
}
