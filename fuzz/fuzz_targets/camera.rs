//! Any bytes are a glTF file with a camera or an error; what a camera sees is valid or refused.
#![no_main]

use std::io::Write;

use libfuzzer_sys::fuzz_target;
use nephos::{import::read_camera, scene::Scene};

fuzz_target!(|bytes: &[u8]| {
    let mut file = tempfile::NamedTempFile::new().expect("a file for the bytes");
    file.write_all(bytes).expect("there is room for them");
    let _ = read_camera(file.path(), Some("camera"));
    if let Ok(camera) = read_camera(file.path(), None) {
        let _ = Scene::default().seen_by(camera).validate();
    }
});
