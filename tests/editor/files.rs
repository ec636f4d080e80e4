//! Work as files: made, saved, found again, dropped in; nothing of it is lost.

use std::{fs, path::Path};

use crate::{
    desk::{Window, open, shoot},
    hands::{
        choose, click, dirty, enter, id, mouse, own_file_window, perform, press, scene_file, told, view_rect,
    },
};
use eframe::egui::{self, Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use nephos::{
    editor::{
        Action, Selection,
        viewport::{Lens, Tool},
    },
    scene::{Preset, Scene},
};

#[test]
fn a_cloud_is_made_moved_undone_typed_saved_and_found_again() {
    let folder = tempfile::tempdir().unwrap();
    own_file_window(folder.path());
    let mut window = open(folder.path(), None);
    shoot(&mut window, "editor_welcome");
    window.get_by_label_contains("Empty sky").click();
    window.run_steps(4);
    for _ in 0..3 {
        click(&mut window, "Add ellipsoid");
    }
    assert_eq!(window.state().scene().clouds[0].ellipsoids.len(), 3);

    // Select in the outliner, then drag the upward arrow of the gizmo in the view.
    click(&mut window, "ellipsoid 2");
    let selection = window.state_mut().editor().document().selection().clone();
    assert_eq!(selection, Selection::one(id(0, 1)));
    window.state_mut().editor().viewport_mut().settings.tool = Tool::Move;
    let before = window.state().scene().clone();
    drag_up(&mut window, before.clouds[0].ellipsoids[1].center);
    let moved = window.state().scene().clouds[0].ellipsoids[1].center - before.clouds[0].ellipsoids[1].center;
    assert!(moved.y > 10.0 && moved.x.abs() < 1e-6 && moved.z.abs() < 1e-6, "{moved}");

    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.state().scene(), &before);

    enter(&mut window, "Centre Y", "1234.5");
    assert_eq!(window.state().scene().clouds[0].ellipsoids[1].center.y, 1234.5);
    enter(&mut window, "Radii X", "77");
    shoot(&mut window, "editor_object");

    let path = folder.path().join("my cloud.json");
    press(&mut window, Modifiers::COMMAND, Key::S);
    choose(&mut window, &path, "Save");
    assert!(!dirty(&mut window), "{}", told(&mut window));
    let scene = window.state().scene().clone();
    drop(window);

    let window = open(folder.path(), Some(&path));
    assert_eq!(window.state().scene(), &scene);
    assert_eq!(Scene::load(&path).unwrap(), scene);
    assert_eq!(scene.clouds[0].ellipsoids[1].radii.x, 77.0);
}

/// Drags the gizmo at `center` upwards by its arrow.
fn drag_up(window: &mut Window<'_>, center: DVec3) {
    let view = view_rect(window);
    let camera = window.state_mut().editor().viewport_mut().camera();
    let at = Lens::new(&camera, view).place(center).unwrap();
    // Within the arrow, above the ball in its middle.
    let grip = at - vec2(0.0, 60.0);
    mouse(window, grip, None);
    mouse(window, grip, Some(true));
    for step in 1..=4 {
        mouse(window, grip - vec2(0.0, 15.0 * step as f32), None);
    }
    mouse(window, grip - vec2(0.0, 60.0), Some(false));
}

#[test]
fn work_that_is_not_saved_is_not_thrown_away_without_a_question() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    let edit = |window: &mut Window<'_>, stops: f64| {
        window.state_mut().editor().document_mut().edit("Expose", |scene| scene.exposure = stops);
        window.run_steps(2);
    };
    edit(&mut window, 1.0);
    press(&mut window, Modifiers::COMMAND, Key::N);
    shoot(&mut window, "editor_unsaved");
    click(&mut window, "Cancel");
    assert_eq!(window.state().scene().exposure, 1.0);

    perform(&mut window, Action::New);
    click(&mut window, "Save");
    assert_eq!(Scene::load(&path).unwrap().exposure, 1.0);
    assert_eq!(window.state().scene(), &Scene::default());

    edit(&mut window, 2.0);
    perform(&mut window, Action::NewFrom(Preset::Sphere));
    click(&mut window, "Don't save");
    assert_eq!(window.state().scene(), &Preset::Sphere.scene(1));

    // The same at the cross of the window.
    assert!(dirty(&mut window));
    let root = window.input_mut().viewports.get_mut(&egui::ViewportId::ROOT).unwrap();
    root.events.push(egui::ViewportEvent::Close);
    window.step();
    let output = &window.output().viewport_output[&egui::ViewportId::ROOT];
    assert!(output.commands.contains(&egui::ViewportCommand::CancelClose));
    window.run_steps(3);
    window.get_by_label("Save the changes?");
}

#[test]
fn a_broken_file_tells_what_is_wrong_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    let broken = folder.path().join("broken.json");
    fs::write(&broken, r#"{"exposure": "bright"}"#).unwrap();
    drop_file(&mut window, &broken);
    let told = told(&mut window);
    assert!(told.contains("broken.json") && told.contains("exposure"), "{told}");
    assert_eq!(window.state_mut().editor().session().path(), Some(path.as_path()));
    assert_eq!(window.state().scene(), &Preset::Kol.scene(1));
    shoot(&mut window, "editor_broken");

    let other = folder.path().join("other.json");
    Preset::Sphere.scene(1).save(&other).unwrap();
    drop_file(&mut window, &other);
    assert_eq!(window.state().scene(), &Preset::Sphere.scene(1));
    let recent = window.state_mut().editor().settings().recent.clone();
    assert_eq!(recent, [other, path]);
}

#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn drop_file(window: &mut Window<'_>, path: &Path) {
    window.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path.to_owned())));
    window.run_steps(4);
}

#[test]
fn a_volume_that_is_dropped_is_added_with_its_numbers_and_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let volume = folder.path().join("smoke.vdb");
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes/grids.vdb"), &volume).unwrap();
    let mut window = open(folder.path(), Some(&path));
    drop_file(&mut window, &volume);
    assert_eq!(window.state().scene().clouds.len(), 2, "{}", told(&mut window));
    let added = |window: &Window<'_>| window.state().scene().clouds[1].volume.clone().unwrap();
    assert_eq!(added(&window).file, "smoke.vdb");
    assert!(window.state().scene().clouds[1].bounds().unwrap().0.y >= 0.0, "it stands above the ground");
    // It was selected: the inspector has its numbers.
    window.get_by_label_contains("`density` of smoke.vdb");
    enter(&mut window, "Extinction at 1", "0.25");
    assert_eq!(added(&window).extinction, 0.25);
    assert!(added(&window).read_grid().is_some());
    window.run_steps(4);
    shoot(&mut window, "volume");
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(!dirty(&mut window), "{}", told(&mut window));
    let saved = Scene::load(&path).unwrap();
    assert!(saved.clouds[1].volume.as_ref().unwrap().read_grid().is_some());
    // What is no volume is told, and nothing is added.
    let bad = folder.path().join("bad.vdb");
    fs::write(&bad, b"nothing").unwrap();
    drop_file(&mut window, &bad);
    assert_eq!(window.state().scene().clouds.len(), 2);
    assert!(told(&mut window).contains("bad.vdb"), "{}", told(&mut window));
}

#[test]
fn a_cloud_with_a_mesh_opens_with_its_numbers_and_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    fs::write(folder.path().join("rock.obj"), tetrahedron).unwrap();
    let text = r#"{"clouds": [{"name": "boulder", "mesh": {"file": "rock.obj", "scale": 300, "place": [0, 900, 0]}}]}"#;
    fs::write(&path, text).unwrap();
    let mut window = open(folder.path(), Some(&path));
    window.get_by_label("boulder").click();
    window.run_steps(4);
    window.get_by_label_contains("rock.obj: 4 triangles");
    enter(&mut window, "Metres per unit", "400");
    let mesh = |window: &Window<'_>| window.state().scene().clouds[0].mesh.clone().unwrap();
    assert_eq!(mesh(&window).scale, 400.0);
    assert!(mesh(&window).surface().is_some(), "what was read stays");
    window.run_steps(4);
    shoot(&mut window, "mesh");
    press(&mut window, Modifiers::COMMAND, Key::S);
    let saved = Scene::load(&path).unwrap();
    assert_eq!(saved.clouds[0].mesh.as_ref().unwrap().file, "rock.obj");
}

#[test]
fn a_picture_that_is_dropped_paints_the_selected_layer() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Stratus);
    let picture = folder.path().join("cover.png");
    image::GrayImage::from_fn(8, 8, |x, _| image::Luma([32 * x as u8])).save(&picture).unwrap();
    let mut window = open(folder.path(), Some(&path));
    let map = |window: &Window<'_>| window.state().scene().clouds[0].map().cloned();
    let document = window.state_mut().editor().document_mut();
    let selection = Selection::cloud(document.scene(), 0);
    document.select(selection);
    window.run_steps(2);
    drop_file(&mut window, &picture);
    let painted = map(&window).unwrap_or_else(|| panic!("{}", told(&mut window)));
    assert_eq!((painted.file.as_str(), painted.cover().unwrap().size()), ("cover.png", [8, 8]));
    window.get_by_label_contains("painted by cover.png");
    enter(&mut window, "Size of the map", "12000");
    assert_eq!(map(&window).unwrap().size, 12000.0);
    window.run_steps(4);
    shoot(&mut window, "painted");
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(Scene::load(&path).unwrap().clouds[0].map().unwrap().cover().is_some());
    // What is no picture is told, and the map stays.
    fs::write(&picture, b"nothing").unwrap();
    drop_file(&mut window, &picture);
    assert!(told(&mut window).contains("no PNG picture"), "{}", told(&mut window));
    assert!(map(&window).unwrap().cover().is_some());
}

#[test]
fn a_picture_that_is_dropped_is_laid_on_the_ground() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Humilis);
    let picture = folder.path().join("land.png");
    image::RgbImage::from_fn(8, 4, |x, _| image::Rgb([32 * x as u8, 90, 20])).save(&picture).unwrap();
    let mut window = open(folder.path(), Some(&path));
    let laid = |window: &Window<'_>| window.state().scene().ground.kind.picture().cloned();
    window.run_steps(2);
    drop_file(&mut window, &picture);
    let ground = laid(&window).unwrap_or_else(|| panic!("{}", told(&mut window)));
    assert_eq!((ground.file.as_str(), ground.colors().unwrap().size()), ("land.png", [8, 4]));
    window.run_steps(4);
    shoot(&mut window, "ground");
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(Scene::load(&path).unwrap().ground.kind.picture().unwrap().colors().is_some());
    // What is no picture is told, and the ground stays.
    fs::write(&picture, b"nothing").unwrap();
    drop_file(&mut window, &picture);
    assert!(told(&mut window).contains("no PNG picture"), "{}", told(&mut window));
    assert!(laid(&window).unwrap().colors().is_some());
}

#[test]
fn a_read_only_file_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let mut window = open(folder.path(), Some(&path));
    assert!(told(&mut window).contains("read-only"));
    window.state_mut().editor().document_mut().edit("Expose", |scene| scene.exposure = 1.0);
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(told(&mut window).contains("save under another name"), "{}", told(&mut window));
    assert!(dirty(&mut window));
    assert_eq!(Scene::load(&path).unwrap(), Preset::Kol.scene(1));
}

#[test]
fn a_file_that_another_program_changed_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    Preset::Sphere.scene(1).save(&path).unwrap();
    // Saving asks before it replaces what the other wrote.
    window.state_mut().editor().document_mut().edit("Expose", |scene| scene.exposure = 1.0);
    perform(&mut window, Action::Save);
    click(&mut window, "Cancel");
    assert_eq!(Scene::load(&path).unwrap(), Preset::Sphere.scene(1));
    // Whoever comes back to the window is told.
    window.input_mut().focused = false;
    window.step();
    window.input_mut().focused = true;
    window.run_steps(3);
    click(&mut window, "Read it again");
    assert_eq!(window.state().scene(), &Preset::Sphere.scene(1));
    assert!(!dirty(&mut window));
}

#[test]
fn unsaved_work_comes_back_after_a_crash() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    window.state_mut().editor().document_mut().edit("Expose", |scene| scene.exposure = 3.0);
    window.run_steps(2);
    let recovery = folder.path().join("recovery");
    let copies = || {
        let files = fs::read_dir(&recovery).unwrap().map(|entry| entry.unwrap().path());
        files.filter(|path| path.extension().is_some_and(|e| e == "json")).collect::<Vec<_>>()
    };
    // A copy without a lock is what a process leaves that was killed.
    let left = recovery.join("killed.json");
    fs::copy(&copies()[0], &left).unwrap();
    // A living editor's work is not offered to another.
    let mut other = open(folder.path(), None);
    shoot(&mut other, "editor_recover");
    assert_eq!(other.query_all_by_label("Restore").count(), 1);
    drop(window);
    assert!(copies() == std::slice::from_ref(&left));

    click(&mut other, "Restore");
    assert_eq!(other.state().scene().exposure, 3.0);
    assert!(dirty(&mut other));
    assert_eq!(other.state_mut().editor().session().path(), Some(path.as_path()));
    assert!(!left.exists() && copies().len() == 1);
    assert_eq!(Scene::load(&path).unwrap().exposure, 0.0);
    // What is saved need not be kept.
    perform(&mut other, Action::Save);
    assert_eq!((copies().len(), Scene::load(&path).unwrap().exposure), (0, 3.0));
}
