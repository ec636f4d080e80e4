//! What a person does with the editor: clicks, keys, words in fields.

use std::{fs, path::Path};

use crate::desk::Window;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, accesskit::Role};
use egui_kittest::kittest::Queryable;
use nephos::{
    editor::{Action, EllipsoidId},
    scene::Preset,
};

pub fn id(cloud: usize, ellipsoid: usize) -> EllipsoidId {
    EllipsoidId { cloud, ellipsoid }
}

/// Clicks what is called `label`, and lets the editor answer.
pub fn click(window: &mut Window<'_>, label: &str) {
    window.get_by_label(label).scroll_to_me();
    window.run_steps(3);
    window.get_by_label(label).click();
    window.run_steps(4);
}

pub fn press(window: &mut Window<'_>, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(4);
}

/// Types `text` into the field `label` and enters it.
pub fn enter(window: &mut Window<'_>, label: &str, text: &str) {
    window.get_by_role_and_label(Role::SpinButton, label).scroll_to_me();
    window.run_steps(3);
    window.get_by_role_and_label(Role::SpinButton, label).click();
    window.run_steps(3);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(2);
    press(window, Modifiers::NONE, Key::Enter);
}

/// Types `text` into the line `label`.
pub fn fill(window: &mut Window<'_>, label: &str, text: &str) {
    window.get_by_role_and_label(Role::TextInput, label).scroll_to_me();
    window.run_steps(3);
    window.get_by_role_and_label(Role::TextInput, label).focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(3);
}

pub fn perform(window: &mut Window<'_>, action: Action) {
    let ctx = window.ctx.clone();
    window.state_mut().editor().perform(&ctx, action);
    window.run_steps(4);
}

pub fn dirty(window: &mut Window<'_>) -> bool {
    window.state_mut().editor().document().is_dirty()
}

/// What the bar tells, in one line.
pub fn told(window: &mut Window<'_>) -> String {
    window.state_mut().editor().told().join(" | ")
}

/// Puts `text` into the path field of the editor's own window for files and agrees.
pub fn choose(window: &mut Window<'_>, path: &Path, button: &str) {
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
pub fn own_file_window(folder: &Path) {
    fs::create_dir_all(folder.join("settings")).unwrap();
    fs::write(folder.join("settings/editor.json"), r#"{"own_file_window": true}"#).unwrap();
}

pub fn scene_file(folder: &Path, preset: Preset) -> std::path::PathBuf {
    let path = folder.join("scene.json");
    preset.scene(1).save(&path).unwrap();
    path
}

/// Moves the mouse to `pos`, and presses or lets go there.
pub fn mouse(window: &mut Window<'_>, pos: Pos2, pressed: Option<bool>) {
    window.event(Event::PointerMoved(pos));
    if let Some(pressed) = pressed {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        window.event(Event::PointerButton { pos, button, pressed, modifiers });
    }
    window.run_steps(1);
}

/// Where the view is: between the panels.
pub fn view_rect(window: &mut Window<'_>) -> Rect {
    window.state_mut().editor().viewport_mut().rect()
}
