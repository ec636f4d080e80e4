//! The panels beside the view.

use crate::{
    desk::{Window, open, shoot, wait},
    hands::{click, enter, id, mouse, perform, press, scene_file},
};
use eframe::egui::{Event, Key, Modifiers, accesskit::Role, vec2};
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use nephos::{
    editor::{
        Action, Selection,
        viewport::{Stage, ViewCommand},
    },
    scene::Preset,
};

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
