//! Questions and small windows over everything else.

use std::time::SystemTime;

use eframe::egui::{Context, Grid, RichText, ScrollArea, TextEdit, Ui};
use egui_phosphor::regular as icon;

use super::{
    actions::{about, entries},
    labels::name_widget,
    palette::Answer,
    recovery::Kept,
    theme::modal,
};
use crate::scene::Preset;

/// What to do about unsaved work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unsaved {
    /// Save it first.
    Save,
    /// Throw it away.
    Discard,
}

/// What to do about a file that another program changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Changed {
    /// Read the file.
    Reload,
    /// Leave the file and go on; saving will replace it.
    Keep,
}

/// What to do about work that was left behind.
#[derive(Debug, Clone, PartialEq)]
pub enum Recover {
    /// Go on with it.
    Restore(Box<Kept>),
    /// Throw it away.
    Discard(Box<Kept>),
}

/// What a new user begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beginning {
    /// An empty sky.
    Empty,
    /// A preset.
    Preset(Preset),
    /// A file.
    Open,
}

/// Asks about unsaved work of `name`.
pub fn unsaved(ctx: &Context, name: &str) -> Answer<Unsaved> {
    let text =
        format!("\"{name}\" has changes that are not saved. They are lost if you go on without saving.");
    let answers = [("Save", Unsaved::Save), ("Don't save", Unsaved::Discard)];
    question(ctx, "Save the changes?", &text, &answers, "Cancel")
}

/// Asks about a file that another program changed; `dirty` where there is work to lose.
pub fn changed(ctx: &Context, name: &str, dirty: bool) -> Answer<Changed> {
    let loss = if dirty { " Reading it again loses your changes, which undo can't bring back." } else { "" };
    let text = format!("Another program changed, moved or deleted \"{name}\".{loss}");
    let answers = [("Read it again", Changed::Reload), ("Go on with mine", Changed::Keep)];
    question(ctx, "The file has changed", &text, &answers, "")
}

/// Asks whether to write over what another program wrote.
pub fn overwrite(ctx: &Context, name: &str) -> Answer<()> {
    let text =
        format!("Another program changed \"{name}\" since you opened it. Saving replaces what it wrote.");
    question(ctx, "Replace the file?", &text, &[("Replace", ())], "Cancel")
}

fn question<T: Clone>(
    ctx: &Context,
    title: &'static str,
    text: &str,
    answers: &[(&str, T)],
    cancel: &str,
) -> Answer<T> {
    let mut given = None;
    let modal = modal(ctx, title).show(ctx, |ui| {
        ui.set_width(400.0);
        ui.heading(title);
        ui.add_space(6.0);
        ui.label(text);
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            for (i, (name, answer)) in answers.iter().enumerate() {
                let name = RichText::new(*name);
                let response = ui.button(if i == 0 { name.strong() } else { name });
                if i == 0 && ui.memory(|memory| memory.focused().is_none()) {
                    response.request_focus();
                }
                if response.clicked() {
                    given = Some(Answer::Chosen(answer.clone()));
                }
            }
            if !cancel.is_empty() && ui.button(cancel).clicked() {
                given = Some(Answer::Closed);
            }
        });
    });
    // A question without "Cancel" wants one of its answers.
    let closed = modal.should_close() && !cancel.is_empty();
    given.unwrap_or(if closed { Answer::Closed } else { Answer::Open })
}

/// Offers what an earlier editor left behind when it ended without a word.
pub fn recover(ctx: &Context, kept: &[Kept]) -> Answer<Recover> {
    let mut given = Answer::Open;
    modal(ctx, "recover").show(ctx, |ui| {
        ui.set_width(480.0);
        ui.heading("Unsaved work was found");
        ui.add_space(6.0);
        ui.label("The editor ended before this was saved. Restoring it changes no file until you save.");
        ui.add_space(8.0);
        ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
            for kept in kept {
                ui.horizontal(|ui| {
                    if ui.button(RichText::new("Restore").strong()).clicked() {
                        given = Answer::Chosen(Recover::Restore(Box::new(kept.clone())));
                    }
                    if ui.button("Discard").clicked() {
                        given = Answer::Chosen(Recover::Discard(Box::new(kept.clone())));
                    }
                    ui.label(told(kept));
                });
            }
        });
        ui.add_space(8.0);
        if ui.button("Later").on_hover_text("Asks again at the next start.").clicked() {
            given = Answer::Closed;
        }
    });
    given
}

fn told(kept: &Kept) -> String {
    let name = kept.file.as_deref().and_then(|file| file.file_name());
    let name = name.map_or("Untitled".into(), |name| name.to_string_lossy());
    let minutes = SystemTime::now().duration_since(kept.at).unwrap_or_default().as_secs() / 60;
    let ago = match minutes {
        0 => "just now".to_owned(),
        1 => "a minute ago".to_owned(),
        2..120 => format!("{minutes} minutes ago"),
        120..2880 => format!("{} hours ago", minutes / 60),
        _ => format!("{} days ago", minutes / 1440),
    };
    let ellipsoids: usize = kept.scene.clouds.iter().map(|cloud| cloud.ellipsoids.len()).sum();
    format!("{name}, {ellipsoids} ellipsoids, {ago}")
}

/// What to begin with.
pub fn welcome(ctx: &Context) -> Answer<Beginning> {
    let mut given = Answer::Open;
    let modal = modal(ctx, "welcome").show(ctx, |ui| {
        ui.set_width(460.0);
        ui.heading("Begin a sky");
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let empty = ui.button(RichText::new(format!("{} Empty sky", icon::SUN)).strong());
            if empty.on_hover_text("You place ellipsoids; the cloud forms around them.").clicked() {
                given = Answer::Chosen(Beginning::Empty);
            }
            if ui.button(format!("{} Open a file...", icon::FOLDER_OPEN)).clicked() {
                given = Answer::Chosen(Beginning::Open);
            }
        });
        ui.add_space(10.0);
        ui.weak("Or from a preset:");
        Grid::new("presets").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
            for preset in Preset::ALL {
                if ui.button(format!("{} {preset}", icon::CLOUD)).clicked() {
                    given = Answer::Chosen(Beginning::Preset(preset));
                }
                ui.weak(about(preset));
                ui.end_row();
            }
        });
    });
    if modal.should_close() && given == Answer::Open {
        return Answer::Closed;
    }
    given
}

/// All keys, and what the mouse does.
#[derive(Debug, Default)]
pub struct Shortcuts {
    search: String,
}

/// What the mouse does in the view.
const MOUSE: [(&str, &str); 9] = [
    ("Left click", "Select; with Shift, one more or one less"),
    ("Left drag", "Select by a box, or drag the gizmo"),
    ("Middle drag", "Orbit"),
    ("Alt + left drag", "Orbit, without a middle button"),
    ("Shift + middle drag", "Pan"),
    ("Wheel", "Come nearer, go farther"),
    ("Right drag + W A S D Q E", "Fly; Shift is faster"),
    ("Ctrl during a drag", "Snap to round numbers"),
    ("Shift during a drag", "Ten times finer"),
];

impl Shortcuts {
    /// Shows the list; true where it was closed.
    pub fn show(&mut self, ctx: &Context) -> bool {
        let mut closed = false;
        let modal = modal(ctx, "shortcuts").show(ctx, |ui| {
            ui.set_width(560.0);
            ui.heading("Keyboard and mouse");
            ui.add_space(4.0);
            let field =
                TextEdit::singleline(&mut self.search).hint_text("Search").desired_width(f32::INFINITY);
            let response = ui.add(field);
            name_widget(ui, &response, "Search the shortcuts");
            ui.add_space(4.0);
            ScrollArea::vertical().max_height(420.0).auto_shrink(false).show(ui, |ui| self.list(ui));
            ui.add_space(6.0);
            closed = ui.button("Close").clicked();
        });
        closed || modal.should_close()
    }

    fn list(&self, ui: &mut Ui) {
        let wanted = self.search.to_lowercase();
        let fits = |text: &str| text.to_lowercase().contains(&wanted);
        let keyed = entries().iter().filter(|entry| !entry.shortcuts.is_empty());
        let mut keyed: Vec<_> = keyed.filter(|entry| fits(&entry.name) || fits(&entry.help)).collect();
        let mouse: Vec<_> = MOUSE.iter().filter(|(_, what)| fits(what)).collect();
        if !mouse.is_empty() {
            table(ui, "Mouse in the view", mouse.iter().map(|(keys, what)| (keys.to_string(), *what, "")));
        }
        while let Some(menu) = keyed.first().map(|entry| entry.menu) {
            let rows: Vec<_> = keyed.extract_if(.., |entry| entry.menu == menu).collect();
            let format = |entry: &super::actions::Entry| {
                let keys = entry.shortcuts.iter().map(|keys| ui.ctx().format_shortcut(keys));
                keys.collect::<Vec<_>>().join(", ")
            };
            let rows: Vec<_> =
                rows.iter().map(|entry| (format(entry), entry.name.as_ref(), entry.help.as_ref())).collect();
            table(ui, menu, rows.into_iter());
        }
    }
}

fn table<'a>(ui: &mut Ui, title: &str, rows: impl Iterator<Item = (String, &'a str, &'a str)>) {
    ui.add_space(6.0);
    ui.strong(title);
    Grid::new(title).num_columns(2).striped(true).min_col_width(170.0).show(ui, |ui| {
        for (keys, what, help) in rows {
            ui.monospace(keys);
            let label = ui.label(what);
            if !help.is_empty() {
                label.on_hover_text(help);
            }
            ui.end_row();
        }
    });
}
