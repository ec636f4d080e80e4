//! The timeline of the editor: keys, playing, scrubbing, dragging, undo.

use std::path::{Path, PathBuf};

use crate::{
    desk::{Window, open, shoot, wait},
    hands::click,
};
use eframe::egui::{Event, Key as Button, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use nephos::{
    editor::{Document, EllipsoidId, Selection},
    scene::{
        Preset, Scene, Timeline,
        timeline::{Interpolation, Key, Track},
    },
};

fn track(path: &str, keys: &[Key]) -> Track {
    Track { path: path.to_owned(), keys: keys.to_vec() }
}

/// A sphere on a timeline of two seconds at ten frames a second.
fn scene(tracks: Vec<Track>) -> Scene {
    Scene {
        timeline: Some(Timeline { length: 2.0, fps: 10.0, looped: false, tracks }),
        ..Preset::Sphere.scene(1)
    }
}

fn file(folder: &Path, scene: &Scene) -> PathBuf {
    let path = folder.join("scene.json");
    scene.save(&path).unwrap();
    path
}

fn press(window: &mut Window<'_>, key: Button) {
    window.key_press_modifiers(Modifiers::NONE, key);
    window.run_steps(4);
}

fn undo(window: &mut Window<'_>) {
    window.key_press_modifiers(Modifiers::COMMAND, Button::Z);
    window.run_steps(4);
}

fn center(window: &Window<'_>, label: &str) -> Pos2 {
    window.get_by_label(label).rect().center()
}

fn drag(window: &mut Window<'_>, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(from));
    window.run_steps(2);
    window.event(button(from, true));
    window.run_steps(2);
    for share in [0.3, 0.7, 1.0] {
        window.event(Event::PointerMoved(from + share * (to - from)));
        window.run_steps(2);
    }
    window.event(button(to, false));
    window.run_steps(4);
}

fn stored(window: &mut Window<'_>) -> Scene {
    Scene::clone(&window.state_mut().editor().document().file_scene())
}

fn timeline(window: &mut Window<'_>) -> Timeline {
    stored(window).timeline.unwrap()
}

fn playhead(window: &mut Window<'_>) -> f64 {
    window.state_mut().editor().document().playhead()
}

fn go_to(window: &mut Window<'_>, time: f64) {
    window.state_mut().editor().document_mut().set_playhead(time);
    window.run_steps(3);
}

// --- As a person does it ------------------------------------------------------------

#[test]
fn a_field_is_keyed_by_its_diamond_changes_over_time_and_is_undone() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), &Preset::Sphere.scene(1));
    let mut window = open(folder.path(), Some(&path));
    press(&mut window, Button::F4);
    assert_eq!(timeline(&mut window), Timeline::default());
    window.state_mut().editor().document_mut().select(Selection::one(EllipsoidId { cloud: 0, ellipsoid: 0 }));
    window.run_steps(3);

    click(&mut window, "Key Density");
    let keyed = timeline(&mut window);
    assert_eq!(keyed.tracks, [track("clouds['sphere'].ellipsoids[0].density", &[Key::new(0.0, 1.0)])]);
    go_to(&mut window, 2.0);
    // What is changed of a number with a track is a key at the playhead.
    let density = |scene: &mut Scene| scene.clouds[0].ellipsoids[0].density = 0.5;
    window.state_mut().editor().document_mut().edit("Density", density);
    window.run_steps(3);
    let keys = timeline(&mut window).tracks[0].keys.clone();
    assert_eq!(keys, [Key::new(0.0, 1.0), Key::new(2.0, 0.5)]);
    assert_eq!(stored(&mut window).clouds, Preset::Sphere.scene(1).clouds, "the file's own value stays");
    go_to(&mut window, 1.0);
    let between = window.state().scene().clouds[0].ellipsoids[0].density;
    assert!((between - 0.75).abs() < 1e-9, "half way of a smooth curve: {between}");
    window.get_by_value("0.750");
    shoot(&mut window, "editor_timeline_keyed");

    go_to(&mut window, 2.0);
    click(&mut window, "Key Density");
    assert_eq!(timeline(&mut window).tracks[0].keys.len(), 1, "a second click takes the key away");
    undo(&mut window);
    assert_eq!(timeline(&mut window).tracks[0].keys.len(), 2);
    undo(&mut window);
    assert_eq!(timeline(&mut window).tracks[0].keys.len(), 1);
    undo(&mut window);
    undo(&mut window);
    assert_eq!(stored(&mut window), Preset::Sphere.scene(1));
}

#[test]
fn keys_of_a_vector_are_set_together_and_all_of_an_ellipsoid_by_one_key() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), &scene(Vec::new()));
    let mut window = open(folder.path(), Some(&path));
    window.state_mut().editor().document_mut().select(Selection::one(EllipsoidId { cloud: 0, ellipsoid: 0 }));
    window.run_steps(3);
    click(&mut window, "Key Centre");
    let paths: Vec<String> = timeline(&mut window).tracks.into_iter().map(|track| track.path).collect();
    let expected = [0, 1, 2].map(|i| format!("clouds['sphere'].ellipsoids[0].center[{i}]"));
    assert_eq!(paths, expected);
    press(&mut window, Button::I);
    assert_eq!(timeline(&mut window).tracks.len(), 11);
}

#[test]
fn playing_keeps_to_the_clock_and_stops_at_the_end_or_goes_round() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = scene(vec![track("exposure", &[Key::new(0.0, 0.0), Key::new(9.0, 3.0)])]);
    scene.timeline.as_mut().unwrap().length = 10.0;
    let path = file(folder.path(), &scene);
    let mut window = open(folder.path(), Some(&path));
    press(&mut window, Button::Space);
    let clock = |window: &Window<'_>| window.ctx.input(|input| input.time);
    let (began, from) = (clock(&window), playhead(&mut window));
    window.run_steps(7);
    let (elapsed, moved) = (clock(&window) - began, playhead(&mut window) - from);
    assert!(elapsed > 0.1 && (moved - elapsed).abs() <= 0.11, "{moved} s in {elapsed} s");
    // Only whole frames are shown: those that are rendered.
    let frames = playhead(&mut window) * 10.0;
    assert!((frames - frames.round()).abs() < 1e-9);
    wait(&mut window, "the end", |desk| !desk.editor().is_playing());
    assert!((playhead(&mut window) - 9.9).abs() < 1e-9);
    assert!(!window.state_mut().editor().document().is_dirty(), "playing changes nothing");

    click(&mut window, "Loop");
    press(&mut window, Button::Space);
    let mut before = playhead(&mut window);
    wait(&mut window, "a second round", |desk| {
        let now = desk.editor().document().playhead();
        std::mem::replace(&mut before, now) > now
    });
    assert!(window.state_mut().editor().is_playing());
    press(&mut window, Button::Space);
    assert!(!window.state_mut().editor().is_playing());
}

#[test]
fn a_timeline_that_moves_nothing_draws_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let still = track("noise.detail", &[Key::new(0.0, 0.5), Key::new(1.0, 0.5)]);
    let mut scene = scene(vec![still]);
    scene.timeline.as_mut().unwrap().looped = true;
    let path = file(folder.path(), &scene);
    let mut window = open(folder.path(), Some(&path));
    wait(&mut window, "the final picture", |desk| desk.editor().viewport_mut().at_rest());
    let updates = window.state_mut().editor().viewport_mut().statistics().light_updates;
    press(&mut window, Button::Space);
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..60 {
        window.step();
        let editor = window.state_mut().editor();
        assert!(editor.viewport_mut().at_rest(), "the picture is begun again");
        seen.insert((editor.document().playhead() * 10.0).round() as i64);
    }
    assert!(seen.len() > 3, "it plays: {seen:?}");
    assert_eq!(window.state_mut().editor().viewport_mut().statistics().light_updates, updates);
}

#[test]
fn the_ruler_scrubs_and_the_arrows_go_from_key_to_key() {
    let folder = tempfile::tempdir().unwrap();
    let path =
        file(folder.path(), &scene(vec![track("exposure", &[Key::new(0.5, 0.0), Key::new(1.5, 1.0)])]));
    let mut window = open(folder.path(), Some(&path));
    let ruler = window.get_by_label("Ruler").rect();
    drag(&mut window, ruler.left_center() + vec2(20.0, 0.0), ruler.center());
    assert!((playhead(&mut window) - 1.0).abs() < 0.051, "{}", playhead(&mut window));
    click(&mut window, "Key after");
    assert_eq!(playhead(&mut window), 1.5);
    click(&mut window, "Key before");
    click(&mut window, "Key before");
    assert_eq!(playhead(&mut window), 0.5);
    click(&mut window, "To the start");
    assert_eq!(playhead(&mut window), 0.0);
}

#[test]
fn keys_are_dragged_on_frames_between_their_neighbours_as_one_step() {
    let folder = tempfile::tempdir().unwrap();
    let keys = [Key::new(0.0, 0.0), Key::new(0.5, 1.0), Key::new(1.0, -1.0)];
    let path = file(folder.path(), &scene(vec![track("exposure", &keys)]));
    let mut window = open(folder.path(), Some(&path));
    let [first, second, third] = [1, 2, 3].map(|i| center(&window, &format!("Key {i} of exposure")));
    let second_at = |time: f32| first + (third - first) * time;
    assert!(second.distance(second_at(0.5)) < 1.0);
    drag(&mut window, second, second_at(0.72));
    assert_eq!(timeline(&mut window).tracks[0].keys[1].time, 0.7);
    drag(&mut window, second_at(0.7), second_at(1.6));
    assert!(
        (timeline(&mut window).tracks[0].keys[1].time - 0.9).abs() < 1e-9,
        "it does not pass its neighbour"
    );
    undo(&mut window);
    undo(&mut window);
    assert_eq!(timeline(&mut window).tracks[0].keys, keys);
    // The picked key has its tools.
    click(&mut window, "Key 2 of exposure");
    click(&mut window, "Step key");
    assert_eq!(timeline(&mut window).tracks[0].keys[1].interpolation, Interpolation::Step);
    click(&mut window, "Delete key");
    assert_eq!(timeline(&mut window).tracks[0].keys, [keys[0], keys[2]]);
}

#[test]
fn curves_are_bent_by_keys_and_handles() {
    let folder = tempfile::tempdir().unwrap();
    let keys = [Key::new(0.0, 0.0), Key::new(1.0, 2.0), Key::new(2.0, 0.5)];
    let path = file(folder.path(), &scene(vec![track("exposure", &keys)]));
    let mut window = open(folder.path(), Some(&path));
    click(&mut window, "Curves");
    let point = center(&window, "Point 2");
    drag(&mut window, point, point + vec2(0.0, 30.0));
    let lowered = timeline(&mut window).tracks[0].keys[1];
    assert!(lowered.value < 1.9 && lowered.value > 0.0 && lowered.time == 1.0, "{lowered:?}");
    let handle = center(&window, "Handle after");
    drag(&mut window, handle, handle + vec2(40.0, -25.0));
    let bent = timeline(&mut window).tracks[0].keys[1];
    let [seconds, value] = bent.after.unwrap();
    assert!(seconds > 0.34 && value > 0.0 && bent.before.is_none(), "{bent:?}");
    shoot(&mut window, "editor_timeline_curves");
    undo(&mut window);
    undo(&mut window);
    assert_eq!(timeline(&mut window).tracks[0].keys, keys);
}

#[test]
fn a_view_through_the_camera_goes_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = scene(Vec::new());
    let position = scene.camera.as_ref().unwrap().position;
    let away = Key::new(2.0, position.z + 800.0);
    scene.timeline.as_mut().unwrap().tracks =
        vec![track("camera.position[2]", &[Key::new(0.0, position.z), away])];
    let path = file(folder.path(), &scene);
    let mut window = open(folder.path(), Some(&path));
    let at_first = window.state_mut().editor().viewport_mut().camera().position;
    assert!(at_first.distance(position) < 1.0, "{at_first}");
    go_to(&mut window, 2.0);
    let seen = window.state_mut().editor().viewport_mut().camera().position;
    assert!(seen.distance(position + 800.0 * DVec3::Z) < 1.0, "{seen} {position}");
}

// --- What tracks hold on to ---------------------------------------------------------

/// A document with three ellipsoids, of which the second rises.
fn document() -> Document {
    let mut scene = scene(Vec::new());
    let lump = scene.clouds[0].ellipsoids[0].clone();
    scene.clouds[0].ellipsoids = (0..3)
        .map(|i| nephos::scene::Ellipsoid {
            center: lump.center + 300.0 * f64::from(i) * DVec3::X,
            ..lump.clone()
        })
        .collect();
    let rise = track("clouds[0].ellipsoids[1].center[1]", &[Key::new(0.0, 1000.0), Key::new(2.0, 1500.0)]);
    scene.timeline.as_mut().unwrap().tracks = vec![rise];
    let mut document = Document::new(scene);
    document.set_playhead(1.0);
    document
}

fn path_of(document: &Document) -> Vec<String> {
    document.scene().timeline.iter().flat_map(|t| &t.tracks).map(|track| track.path.clone()).collect()
}

fn id(cloud: usize, ellipsoid: usize) -> EllipsoidId {
    EllipsoidId { cloud, ellipsoid }
}

#[test]
fn tracks_follow_their_object_through_every_change_of_order() {
    let one = "clouds['sphere'].ellipsoids";
    let mut document = document();
    document.select(Selection::one(id(0, 0)));
    document.delete();
    assert_eq!(path_of(&document), [format!("{one}[0].center[1]")]);
    document.undo();
    document.move_ellipsoid(id(0, 1), id(0, 3));
    assert_eq!(path_of(&document), [format!("{one}[2].center[1]")]);
    document.undo();
    document.edit("Rename", |scene| scene.clouds[0].ellipsoids[1].name = Some("top".to_owned()));
    assert_eq!(path_of(&document), [format!("{one}['top'].center[1]")]);
    document.edit("Rename", |scene| scene.clouds[0].name = "tower".to_owned());
    assert_eq!(path_of(&document), ["clouds['tower'].ellipsoids['top'].center[1]"]);
    // A copy of the same name takes nothing away: the first keeps its track.
    document.select(Selection::one(id(0, 1)));
    document.duplicate(DVec3::X * 900.0);
    assert_eq!(path_of(&document), ["clouds['tower'].ellipsoids[1].center[1]"]);
    document.select(Selection::one(id(0, 1)));
    document.group();
    assert_eq!(path_of(&document), ["clouds['cloud 1'].ellipsoids['top'].center[1]"]);
    assert!(document.take_refusal().is_none());
    document.delete();
    assert!(path_of(&document).is_empty(), "what is gone has no track");
    document.undo();
    assert_eq!(path_of(&document).len(), 1);
    document.file_scene().validate().unwrap();
}

#[test]
fn what_is_moved_by_hand_becomes_a_key_and_what_has_no_track_a_value() {
    let mut document = document();
    assert_eq!(document.scene().clouds[0].ellipsoids[1].center.y, 1250.0);
    document.edit("Move", |scene| scene.clouds[0].ellipsoids[1].center += DVec3::new(10.0, 50.0, 0.0));
    let file = document.file_scene();
    let keys = &file.timeline.as_ref().unwrap().tracks[0].keys;
    assert_eq!(keys[1], Key::new(1.0, 1300.0));
    let center = file.clouds[0].ellipsoids[1].center;
    assert_eq!((center.x, center.y), (310.0, 1000.0));
    // Time is the playhead, and no edit of the file.
    let before = document.file_scene();
    document.edit("Time", |scene| scene.time = 2.0);
    assert_eq!((document.playhead(), document.file_scene()), (2.0, before));
    assert_eq!(document.undo_name(), Some("Move"));
}
