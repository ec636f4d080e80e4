//! Any text is a scene or an error; a scene that is read is valid and is written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephos::scene::Scene;

fuzz_target!(|text: &str| {
    if let Ok(scene) = Scene::from_json(text) {
        let again = Scene::from_json(&scene.to_json()).expect("what is written can be read");
        assert_eq!(again, scene);
    }
});
