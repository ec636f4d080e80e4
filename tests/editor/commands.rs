//! Commands, jobs, and the window as a whole.

use std::fs;

use crate::{
    desk::{Window, open, open_sized, shoot, wait},
    hands::{click, fill, perform, press, scene_file, told, view_rect},
};
use eframe::egui::{self, Event, Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use nephos::{
    editor::{Action, Settings, viewport::Stage},
    scene::Preset,
};

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
