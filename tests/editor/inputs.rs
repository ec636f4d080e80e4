//! No input is lost, however late the editor comes to look at it.

use crate::desk::{Window, open, shoot};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use nephos::{
    editor::{EllipsoidId, Selection},
    scene::Preset,
};

fn key(key: Key, modifiers: Modifiers) -> Vec<Event> {
    let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    vec![
        Event::ModifiersChanged(modifiers),
        event(true),
        event(false),
        Event::ModifiersChanged(Modifiers::NONE),
    ]
}

/// A letter or a number as a keyboard sends it: a key and its text.
fn typed(text: &str) -> Vec<Event> {
    let one = |c: char| {
        let mut events = key(Key::from_name(&c.to_uppercase().to_string()).unwrap(), Modifiers::NONE);
        events.insert(2, Event::Text(c.to_string()));
        events
    };
    text.chars().flat_map(one).collect()
}

fn click(pos: Pos2) -> Vec<Event> {
    let button = |pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    vec![Event::PointerMoved(pos), button(true), button(false)]
}

/// All of `events` come before the editor looks for the first time: a frame that took long.
fn at_once(window: &mut Window<'_>, events: Vec<Event>) {
    window.input_mut().events.extend(events);
    // More frames than they can take.
    let frames = window.input_mut().events.len() + 8;
    window.run_steps(frames);
}

fn lumps(window: &Window<'_>) -> usize {
    window.state().scene().clouds[0].ellipsoids.len()
}

fn place(window: &Window<'_>, label: &str) -> Pos2 {
    window.get_by_label(label).rect().center()
}

fn started(folder: &std::path::Path) -> Window<'static> {
    let path = folder.join("scene.json");
    Preset::Kol.scene(1).save(&path).unwrap();
    open(folder, Some(&path))
}

#[test]
fn two_hundred_inputs_in_one_frame_all_count() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = started(folder.path());
    let before = lumps(&window);
    let mut events = Vec::new();
    // 60 keys, 60 clicks on a button, 40 keys, and 40 clicks on a switch: 200.
    (0..60).for_each(|_| events.extend(key(Key::A, Modifiers::SHIFT)));
    let plus = place(&window, "Add ellipsoid");
    (0..60).for_each(|_| events.extend(click(plus)));
    (0..40).for_each(|_| events.extend(key(Key::Z, Modifiers::COMMAND)));
    let view = place(&window, "View panel");
    let object = place(&window, "Object panel");
    (0..20).for_each(|_| events.extend([click(view), click(object)].concat()));
    at_once(&mut window, events);
    assert_eq!(lumps(&window), before + 60 + 60 - 40);
    // Each of the clicks was where the mouse was then: the last one on `Object`.
    window.get_by_label("Centre X");
    shoot(&mut window, "editor_inputs");
}

#[test]
fn a_number_typed_right_behind_the_click_goes_into_the_field() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = started(folder.path());
    window.state_mut().editor().document_mut().select(Selection::one(EllipsoidId { cloud: 0, ellipsoid: 1 }));
    window.run_steps(3);
    let before = window.state().scene().clone();
    let camera = window.state_mut().editor().viewport_mut().camera();
    let field = place(&window, "Centre Y");
    // 7, 1 and 0 would turn the view, X would delete the lump.
    let events = [click(field), typed("710"), key(Key::Enter, Modifiers::NONE)].concat();
    at_once(&mut window, events);
    let mut wanted = before.clone();
    wanted.clouds[0].ellipsoids[1].center.y = 710.0;
    assert_eq!(window.state().scene(), &wanted);
    assert_eq!(window.state_mut().editor().viewport_mut().camera(), camera);
}

#[test]
fn a_command_found_by_its_name_in_one_breath_runs() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = started(folder.path());
    let before = lumps(&window);
    let events =
        [key(Key::F3, Modifiers::NONE), typed("addellipsoid"), key(Key::Escape, Modifiers::NONE)].concat();
    at_once(&mut window, events);
    assert_eq!(lumps(&window), before, "letters went past the palette");
    let all = [key(Key::F3, Modifiers::NONE), typed("ellipsoid"), key(Key::Enter, Modifiers::NONE)].concat();
    at_once(&mut window, all);
    assert_eq!(lumps(&window), before + 1);
}

#[test]
fn a_menu_is_opened_and_chosen_from_before_it_was_painted() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = started(folder.path());
    let before = lumps(&window);
    let add = place(&window, "Add");
    let under = add + vec2(0.0, 30.0);
    at_once(&mut window, [click(add), click(under)].concat());
    assert_eq!(lumps(&window), before + 1);
}
