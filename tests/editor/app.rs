//! The editor as a person drives it, from the first ellipsoid to the final picture.

use std::{fs, path::Path};

use crate::desk::{Window, open, open_sized, shoot, wait};
use eframe::egui::{self, Event, Key, Modifiers, PointerButton, Pos2, Rect, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::DVec3;
use nephos::{
    editor::{
        Action, EllipsoidId, Selection, Settings,
        viewport::{Lens, Stage, Tool, ViewCommand},
    },
    scene::{Preset, Scene},
};

fn id(cloud: usize, ellipsoid: usize) -> EllipsoidId {
    EllipsoidId { cloud, ellipsoid }
}

/// Clicks what is called `label`, and lets the editor answer.
fn click(window: &mut Window<'_>, label: &str) {
    window.get_by_label(label).scroll_to_me();
    window.run_steps(3);
    window.get_by_label(label).click();
    window.run_steps(4);
}

fn press(window: &mut Window<'_>, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(4);
}

/// Types `text` into the field `label` and enters it.
fn enter(window: &mut Window<'_>, label: &str, text: &str) {
    window.get_by_role_and_label(Role::SpinButton, label).scroll_to_me();
    window.run_steps(3);
    window.get_by_role_and_label(Role::SpinButton, label).click();
    window.run_steps(3);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(2);
    press(window, Modifiers::NONE, Key::Enter);
}

/// Types `text` into the line `label`.
fn fill(window: &mut Window<'_>, label: &str, text: &str) {
    window.get_by_role_and_label(Role::TextInput, label).scroll_to_me();
    window.run_steps(3);
    window.get_by_role_and_label(Role::TextInput, label).focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(3);
}

fn perform(window: &mut Window<'_>, action: Action) {
    let ctx = window.ctx.clone();
    window.state_mut().editor().perform(&ctx, action);
    window.run_steps(4);
}

fn dirty(window: &mut Window<'_>) -> bool {
    window.state_mut().editor().document().is_dirty()
}

/// What the bar tells, in one line.
fn told(window: &mut Window<'_>) -> String {
    window.state_mut().editor().told().join(" | ")
}

/// Puts `text` into the path field of the editor's own window for files and agrees.
fn choose(window: &mut Window<'_>, path: &Path, button: &str) {
    let field = window.get_by_label("Path of the file");
    field.focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(1);
    window.event(Event::Text(path.display().to_string()));
    window.run_steps(2);
    click(window, button);
}

/// Settings that make the editor choose files in its own window.
fn own_file_window(folder: &Path) {
    fs::create_dir_all(folder.join("settings")).unwrap();
    fs::write(folder.join("settings/editor.json"), r#"{"own_file_window": true}"#).unwrap();
}

fn scene_file(folder: &Path, preset: Preset) -> std::path::PathBuf {
    let path = folder.join("scene.json");
    preset.scene(1).save(&path).unwrap();
    path
}

// --- From nothing to a file and back ------------------------------------------------

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

/// Moves the mouse to `pos`, and presses or lets go there.
fn mouse(window: &mut Window<'_>, pos: Pos2, pressed: Option<bool>) {
    window.event(Event::PointerMoved(pos));
    if let Some(pressed) = pressed {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        window.event(Event::PointerButton { pos, button, pressed, modifiers });
    }
    window.run_steps(1);
}

/// Where the view is: between the panels.
fn view_rect(window: &mut Window<'_>) -> Rect {
    window.state_mut().editor().viewport_mut().rect()
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

// --- Panels ---------------------------------------------------------------------------

#[test]
fn the_outliner_names_hides_locks_orders_and_finds() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    click(&mut window, "ellipsoid 3");
    press(&mut window, Modifiers::NONE, Key::F2);
    window.event(Event::Text("turret".to_owned()));
    window.run_steps(1);
    press(&mut window, Modifiers::NONE, Key::Enter);
    let name = |window: &Window<'_>, i: usize| window.state().scene().clouds[0].ellipsoids[i].name.clone();
    assert_eq!(name(&window, 2).as_deref(), Some("turret"));

    click(&mut window, "Hide turret");
    click(&mut window, "Lock ellipsoid 1");
    let cloud = &window.state().scene().clouds[0];
    assert!(cloud.ellipsoids[2].hidden && cloud.ellipsoids[0].locked);

    let row = |window: &Window<'_>, label: &str| window.get_by_label(label).rect().center();
    let (from, to) = (row(&window, "turret"), row(&window, "ellipsoid 1") - vec2(0.0, 6.0));
    mouse(&mut window, from, Some(true));
    mouse(&mut window, from + vec2(0.0, -12.0), None);
    mouse(&mut window, to, None);
    mouse(&mut window, to, Some(false));
    window.run_steps(3);
    assert_eq!(name(&window, 0).as_deref(), Some("turret"));

    window.get_by_label("Search the outliner").focus();
    window.run_steps(1);
    window.event(Event::Text("turr".to_owned()));
    window.run_steps(3);
    shoot(&mut window, "editor_outliner");
    assert!(window.query_by_label("turret").is_some() && window.query_by_label("ellipsoid 4").is_none());
}

#[test]
fn the_inspector_changes_all_that_is_selected_and_resets() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    let ids = [id(0, 5), id(0, 6), id(0, 7)];
    window.state_mut().editor().document_mut().select(Selection::of(ids));
    window.run_steps(3);
    enter(&mut window, "Density", "0.5");
    let density = |window: &Window<'_>| {
        window.state().scene().clouds[0].ellipsoids.iter().map(|e| e.density).collect::<Vec<_>>()
    };
    assert_eq!(density(&window), [1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5]);
    click(&mut window, "Its own edge");
    let edges = window.state().scene().clouds[0].ellipsoids.iter().filter(|e| e.edge.is_some()).count();
    assert_eq!(edges, 3);
    click(&mut window, "Reset Density");
    assert_eq!(density(&window), [1.0; 8]);
    // What can't be is cut off at the limits of the file.
    enter(&mut window, "Effective radius", "99");
    assert_eq!(window.state().scene().clouds[0].droplets.effective_radius_um, 20.0);
    for _ in 0..4 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(window.state().scene(), &Preset::Kol.scene(1));
}

#[test]
fn the_world_is_lit_and_exposed_by_its_panel() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    click(&mut window, "World panel");
    shoot(&mut window, "editor_world");
    click(&mut window, "Back light");
    // Its camera looks north; the sun then stands before it.
    let scene = window.state().scene();
    assert!(scene.sun.to_sun().dot(scene.camera().forward()) > 0.8);
    enter(&mut window, "Haze", "4");
    enter(&mut window, "Exposure", "-1.5");
    enter(&mut window, "Billow size", "95");
    let scene = window.state().scene();
    assert_eq!((scene.exposure, scene.noise.scale), (-1.5, Some(95.0)));
    // An exposure of one's own comes on top of what is metered, as long as that is not switched off.
    assert!(scene.is_metered());
    assert!(scene.to_json().contains("\"haze\": 4.0"));
    click(&mut window, "Auto exposure");
    assert!(!window.state().scene().is_metered());

    // Every kind of everything has its rows, whose words the schema must have.
    window.state_mut().editor().document_mut().edit("All", |scene| {
        scene.sun.position = nephos::scene::SunPosition::Place {
            latitude_deg: 52.0,
            longitude_deg: 5.0,
            time: "2026-06-21T18:30:00+02:00".to_owned(),
            hours: 0.0,
        };
        scene.sky = nephos::scene::Sky::Uniform { radiance: [0.1; 3] };
        scene.clouds[0].droplets.phase = nephos::scene::Phase::HenyeyGreenstein { g: 0.8 };
    });
    window.run_steps(3);
    enter(&mut window, "Day of the year", "80");
    assert!(window.state().scene().to_json().contains("2026-03-21T18:30:00+02:00"));
    for section in ["Camera", "Ground", "Wind and time"] {
        click(&mut window, section);
    }
    use nephos::scene::Projection;
    for projection in [
        Projection::Lens { focal_length_mm: 35.0, sensor_width_mm: 36.0 },
        Projection::Orthographic { height: 100.0 },
        Projection::Equirectangular,
    ] {
        window.state_mut().editor().document_mut().edit("Camera", |scene| {
            let mut camera = scene.camera();
            camera.projection = projection;
            scene.camera = Some(camera);
        });
        window.run_steps(2);
    }
    click(&mut window, "Object panel");
    click(&mut window, "kol");
    assert!(window.query_by_label("Asymmetry").is_some());
}

#[test]
fn the_sun_is_dragged_on_its_dial_in_one_step() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    click(&mut window, "World panel");
    let dial = window.get_by_label_contains("Sun dial").rect();
    mouse(&mut window, dial.center() + vec2(0.0, 20.0), Some(true));
    for x in [10.0, 20.0, 31.0] {
        mouse(&mut window, dial.center() + vec2(x, 0.0), None);
    }
    mouse(&mut window, dial.center() + vec2(31.0, 0.0), Some(false));
    window.run_steps(2);
    // To the right of the middle, half way to the horizon at 62 points: east, half way up.
    let to_sun = window.state().scene().sun.to_sun();
    let expected = DVec3::new(1.0, 1.0, 0.0).normalize();
    // Angles are rounded to tenths of degrees.
    assert!(to_sun.distance(expected) < 0.005, "{to_sun}");
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.state().scene(), &Preset::Kol.scene(1));
}

#[test]
fn a_light_is_added_moved_named_made_lightning_and_taken_away() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    let add = format!("{} Add a light", egui_phosphor::regular::PLUS);
    click(&mut window, "World panel");
    click(&mut window, "Lights");
    click(&mut window, &add);
    let source = |window: &Window<'_>| window.state().scene().lights[0].source.clone();
    assert_eq!(source(&window).kind(), "key");
    let sun = window.state().scene().sun.clone();
    let kind = |window: &Window<'_>| window.get_by_role_and_label(Role::ComboBox, "What shines").click();
    window.get_by_role_and_label(Role::ComboBox, "What shines").scroll_to_me();
    window.run_steps(3);
    kind(&window);
    window.run_steps(4);
    click(&mut window, "Lightning");
    assert_eq!(source(&window).kind(), "lightning");
    assert_eq!(window.state().scene().sun, sun);
    click(&mut window, &add);
    click(&mut window, "Remove lightning1");
    let lights = &window.state().scene().lights;
    assert_eq!(lights.iter().map(|light| light.source.kind()).collect::<Vec<_>>(), ["key"]);
    for _ in 0..4 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(window.state().scene(), &Preset::Kol.scene(1));
}

#[test]
fn the_view_panel_chooses_layers_and_tells_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    click(&mut window, "View panel");
    click(&mut window, "Multiple scattering");
    let layer = window.state_mut().editor().viewport_mut().settings.layer;
    assert_eq!(layer, nephos::editor::viewport::Layer::Multiple);
    click(&mut window, "Count and time");
    window.state_mut().editor().viewport_mut().settings.finest = Stage::Preview;
    perform(&mut window, Action::View(ViewCommand::Show(nephos::editor::viewport::Layer::Beauty)));
    wait(&mut window, "a counted picture", |desk| desk.editor().viewport_mut().statistics().counts.is_some());
    window.run_steps(2);
    shoot(&mut window, "editor_view");
    assert!(window.query_by_label("density evaluations").is_some());
}

#[test]
fn heaps_grow_from_the_panel() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    click(&mut window, "ellipsoid 1");
    click(&mut window, "Grow heaps");
    window.get_by_role_and_label(Role::Button, "Grow").click();
    window.run_steps(4);
    let grown = window.state().scene().clouds[0].ellipsoids.len();
    assert!((4..=5).contains(&grown), "{grown}");
}

// --- Commands -------------------------------------------------------------------------

#[test]
fn the_palette_finds_and_runs_a_command() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    press(&mut window, Modifiers::NONE, Key::F3);
    window.event(Event::Text("add: humi".to_owned()));
    window.run_steps(3);
    shoot(&mut window, "editor_palette");
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(window.state().scene().clouds.len(), 2);
    assert!(window.query_by_label("Find a command").is_none());
}

#[test]
fn keys_work_and_letters_in_a_text_field_are_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    let selected =
        |window: &mut Window<'_>| window.state_mut().editor().document().selection().ellipsoids.len();
    press(&mut window, Modifiers::NONE, Key::A);
    assert_eq!(selected(&mut window), 8);
    press(&mut window, Modifiers::ALT, Key::A);
    assert_eq!(selected(&mut window), 0);
    click(&mut window, "ellipsoid 2");
    press(&mut window, Modifiers::COMMAND, Key::I);
    assert_eq!(selected(&mut window), 7);
    click(&mut window, "ellipsoid 2");
    press(&mut window, Modifiers::NONE, Key::H);
    assert!(window.state().scene().clouds[0].ellipsoids[1].hidden);
    press(&mut window, Modifiers::ALT, Key::H);
    assert_eq!(window.state().scene(), &Preset::Kol.scene(1));
    click(&mut window, "ellipsoid 2");
    press(&mut window, Modifiers::NONE, Key::X);
    assert_eq!(window.state().scene().clouds[0].ellipsoids.len(), 7);
    window.get_by_label("Search the outliner").focus();
    window.run_steps(2);
    press(&mut window, Modifiers::NONE, Key::X);
    press(&mut window, Modifiers::NONE, Key::H);
    assert_eq!(window.state().scene().clouds[0].ellipsoids.len(), 7);
    press(&mut window, Modifiers::NONE, Key::F6);
    assert!(window.query_by_label("World panel").is_none());
    press(&mut window, Modifiers::NONE, Key::F8);
    assert!(window.query_by_label("Back light").is_some());
    press(&mut window, Modifiers::NONE, Key::F1);
    shoot(&mut window, "editor_shortcuts");
    assert!(window.query_by_label("Search the shortcuts").is_some());
}

#[test]
fn the_final_picture_is_the_one_of_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    perform(&mut window, Action::Job(0));
    fill(&mut window, "Width", "48");
    fill(&mut window, "Height", "27");
    shoot(&mut window, "editor_picture");
    click(&mut window, "Begin");
    assert!(window.state_mut().editor().has_jobs());
    wait(&mut window, "the picture", |desk| !desk.editor().has_jobs());
    shoot(&mut window, "editor_jobs");
    assert!(told(&mut window).contains("scene.png"), "{}", told(&mut window));
    let adapter = window.state_mut().editor().viewport_mut().gpu().adapter.name.clone();
    let (there, expected) = (folder.path().join("scene.png"), folder.path().join("cli.png"));
    let mut command = assert_cmd::Command::cargo_bin("nephos").unwrap();
    command.args(["render", "--width", "48", "--height", "27", "--adapter", &adapter, "-o"]);
    command.args([&expected, &path]).assert().success();
    assert_eq!(fs::read(there).unwrap(), fs::read(expected).unwrap());
}

#[test]
fn a_cancelled_picture_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    press(&mut window, Modifiers::NONE, Key::F12);
    // Far more than is drawn before it is paused.
    fill(&mut window, "Width", "1200");
    fill(&mut window, "Height", "1200");
    click(&mut window, "Begin");
    wait(&mut window, "the program", |desk| {
        desk.editor().jobs_mut().under_way().is_some_and(|(_, share)| share > 0.0)
    });
    click(&mut window, "Pause scene.png");
    window.get_by_label("Resume scene.png");
    click(&mut window, "Resume scene.png");
    click(&mut window, "Cancel scene.png");
    wait(&mut window, "the end of it", |desk| !desk.editor().has_jobs());
    assert!(told(&mut window).contains("cancelled"), "{}", told(&mut window));
    assert!(!folder.path().join("scene.png").exists());
    click(&mut window, "Remove scene.png");
    assert!(window.query_by_label("Remove scene.png").is_none());
}

#[test]
fn a_job_that_fails_tells_why_in_a_sentence_and_the_next_one_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    // A scene without a timeline has no length.
    perform(&mut window, Action::Job(1));
    click(&mut window, "Begin");
    perform(&mut window, Action::Job(8));
    click(&mut window, "Begin");
    wait(&mut window, "the end of both", |desk| !desk.editor().has_jobs());
    assert!(told(&mut window).contains("say which frames, such as --frames 1-240"), "{}", told(&mut window));
    assert!(folder.path().join("scene.glb").exists());
    shoot(&mut window, "editor_jobs_failed");
}

#[test]
fn words_that_the_command_line_refuses_are_told_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    perform(&mut window, Action::Job(0));
    fill(&mut window, "Width", "0");
    assert!(window.query_by_label_contains("invalid value '0' for '--width").is_some());
    assert!(window.get_by_label("Begin").accesskit_node().is_disabled());
}

// --- The whole ------------------------------------------------------------------------

#[test]
fn at_rest_nothing_asks_for_another_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Sphere);
    let mut window = open(folder.path(), Some(&path));
    window.state_mut().editor().viewport_mut().settings.finest = Stage::Preview;
    wait(&mut window, "rest", |desk| desk.editor().viewport_mut().at_rest());
    window.run_steps(8);
    let output = &window.output().viewport_output[&egui::ViewportId::ROOT];
    // Far longer than a frame: the screen stays as it is until something happens.
    assert!(output.repaint_delay.as_secs() > 60, "{:?}", output.repaint_delay);
}

#[test]
fn everything_fits_the_least_window_light_and_at_high_density() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene_file(folder.path(), Preset::Kol);
    let mut window = open(folder.path(), Some(&path));
    let view = view_rect(&mut window);
    assert!(view.width() > 600.0 && view.height() > 600.0, "{view}");
    drop(window);
    let mut window = open_sized(folder.path(), Some(&path), vec2(1280.0, 720.0), 2.0);
    perform(&mut window, Action::Look(nephos::editor::Look::Light));
    click(&mut window, "ellipsoid 6");
    for label in ["Centre Z", "Density", "Reset Centre"] {
        let rect = window.get_by_label(label).rect();
        assert!(window.ctx.content_rect().contains_rect(rect), "{label}: {rect}");
    }
    shoot(&mut window, "editor_light");
}

#[test]
fn settings_are_remembered_and_a_bad_one_spoils_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let places = nephos::editor::Places::within(folder.path());
    let mut window = open(folder.path(), None);
    perform(&mut window, Action::Look(nephos::editor::Look::Light));
    perform(&mut window, Action::ToggleOutliner);
    window.state_mut().editor().viewport_mut().settings.outlines = false;
    window.state_mut().editor().write_settings();
    let settings = Settings::load(&places);
    assert_eq!((settings.look, settings.shows("outliner")), (nephos::editor::Look::Light, false));
    assert_eq!(settings.viewport["outlines"], false);
    let file = folder.path().join("settings/editor.json");
    fs::write(&file, r#"{"look": "light", "zoom": "large", "unknown": 1}"#).unwrap();
    assert_eq!(Settings::load(&places).look, nephos::editor::Look::Light);
    fs::write(&file, "nonsense").unwrap();
    assert_eq!(Settings::load(&places), Settings::default());
}
