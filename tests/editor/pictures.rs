//! Pictures of the editor for its pages: `cargo test --release --all-features --test editor pictures -- --ignored` draws them
//! anew in `docs/pictures`.

use std::path::Path;

use crate::desk::{Window, open_sized, shoot, wait};
use eframe::egui::vec2;
use egui_kittest::kittest::Queryable;
use nephos::{
    editor::{EllipsoidId, Selection, viewport::Stage},
    scene::{Preset, Scene, SunPosition},
};

/// Opens `scene` from a file of this name, goes where `look` leads, and shoots the window as `name` where its view rests.
fn page(scene: &Scene, file: &str, name: &str, look: impl FnOnce(&mut Window<'_>)) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    scene.save(&path).unwrap();
    let mut window = open_sized(folder.path(), Some(&path), vec2(1440.0, 900.0), 1.0);
    let settings = &mut window.state_mut().editor().viewport_mut().settings;
    (settings.largest, settings.finest) = (4096, Stage::Final);
    look(&mut window);
    window.run_steps(4);
    wait(&mut window, "a view at rest", |desk| desk.editor().viewport_mut().at_rest());
    shoot(&mut window, name);
    let made = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/pictures").join(format!("{name}.png"));
    std::fs::copy(made, kept).unwrap();
}

#[test]
#[ignore = "draws the pictures of docs/editor.md"]
fn the_pictures_of_the_pages() {
    let scene = Preset::Mediocris.scene(1);
    page(&scene, "mediocris.json", "editor", |window| {
        let one = Selection::of([EllipsoidId { cloud: 0, ellipsoid: 12 }]);
        window.state_mut().editor().document_mut().select(one);
    });
    let mut backlit = Scene { name: "backlit".to_owned(), ..scene };
    backlit.sun.position = SunPosition::Angles { azimuth_deg: 28.0, elevation_deg: 14.0 };
    page(&backlit, "backlit.json", "editor-world", |window| window.get_by_label("World panel").click());
}
