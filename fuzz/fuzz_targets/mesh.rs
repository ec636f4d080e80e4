//! Any bytes are a mesh or an error; a mesh is filled, or is told to enclose nothing.
#![no_main]

use std::io::Write;

use libfuzzer_sys::fuzz_target;
use nephos::import::{Inside, fill, read_mesh};

fuzz_target!(|bytes: &[u8]| {
    let ending = match bytes.first() {
        Some(b'g') => ".glb",
        Some(b'{') => ".gltf",
        _ => ".obj",
    };
    let mut file = tempfile::Builder::new().suffix(ending).tempfile().expect("a file for the bytes");
    file.write_all(bytes).expect("there is room for them");
    if let Ok(mesh) = read_mesh(file.path()) {
        let _ = fill(&Inside::new(&mesh, 8), 2, 1);
    }
});
