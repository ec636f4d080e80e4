//! Commands by name: a field, a list, Enter.

use eframe::egui::{Align, Context, Key, Layout, Modifiers, RichText, ScrollArea, TextEdit, Ui, vec2};

use super::{
    actions::{Action, Entry, entries},
    labels::name_widget,
    theme::modal,
};

/// The palette while it is open.
#[derive(Debug, Default)]
pub struct Palette {
    search: String,
    chosen: usize,
}

/// What became of an open window.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer<T> {
    /// It stays open.
    Open,
    /// It was closed without a choice.
    Closed,
    /// It was closed with this choice.
    Chosen(T),
}

impl Palette {
    /// Shows it; `enabled` tells what can be done now.
    pub fn show(&mut self, ctx: &Context, enabled: impl Fn(Action) -> bool) -> Answer<Action> {
        let mut answer = Answer::Open;
        let modal = modal(ctx, "palette").show(ctx, |ui| {
            ui.set_width(460.0);
            let field = TextEdit::singleline(&mut self.search).hint_text("Find a command");
            let response = ui.add(field.desired_width(f32::INFINITY));
            name_widget(ui, &response, "Find a command");
            response.request_focus();
            if response.changed() {
                self.chosen = 0;
            }
            let found: Vec<_> = found(&self.search).into_iter().filter(|e| enabled(e.action)).collect();
            let moved = self.step(ui, found.len());
            ui.add_space(6.0);
            if let Some(action) = self.list(ui, &found, moved) {
                answer = Answer::Chosen(action);
            }
            if ui.input(|input| input.key_pressed(Key::Enter)) {
                answer = found.get(self.chosen).map_or(Answer::Open, |entry| Answer::Chosen(entry.action));
            }
        });
        if modal.should_close() && answer == Answer::Open {
            return Answer::Closed;
        }
        answer
    }

    /// Moves the choice by the arrow keys; whether it moved.
    fn step(&mut self, ui: &Ui, count: usize) -> bool {
        let (down, up) = ui.input_mut(|input| {
            (
                input.count_and_consume_key(Modifiers::NONE, Key::ArrowDown),
                input.count_and_consume_key(Modifiers::NONE, Key::ArrowUp),
            )
        });
        self.chosen = (self.chosen + down).saturating_sub(up).min(count.saturating_sub(1));
        down + up > 0
    }

    fn list(&self, ui: &mut Ui, found: &[&'static Entry], moved: bool) -> Option<Action> {
        let mut picked = None;
        if found.is_empty() {
            ui.weak("No command's name contains this.");
        }
        ScrollArea::vertical().max_height(320.0).auto_shrink([false, true]).show(ui, |ui| {
            for (i, entry) in found.iter().enumerate() {
                let response = ui.selectable_label(i == self.chosen, entry.name.as_ref());
                let rect = response.rect.with_max_x(ui.max_rect().right());
                let keys = entry.shortcuts.first().map(|keys| ui.ctx().format_shortcut(keys));
                let builder = eframe::egui::UiBuilder::new()
                    .max_rect(rect.shrink2(vec2(6.0, 0.0)))
                    .layout(Layout::right_to_left(Align::Center));
                ui.scope_builder(builder, |ui| ui.weak(keys.unwrap_or_default()));
                if i == self.chosen {
                    ui.label(RichText::new(entry.help.as_ref()).small().weak());
                    if moved {
                        response.scroll_to_me(None);
                    }
                }
                if response.clicked() {
                    picked = Some(entry.action);
                }
            }
        });
        picked
    }
}

/// The commands that `search` may mean, the likeliest first.
fn found(search: &str) -> Vec<&'static Entry> {
    let wanted = search.trim().to_lowercase();
    let mut found: Vec<(u8, &Entry)> =
        entries().iter().filter_map(|entry| Some((rank(entry, &wanted)?, entry))).collect();
    found.sort_by_key(|(rank, _)| *rank);
    found.into_iter().map(|(_, entry)| entry).collect()
}

/// How well an entry fits, 0 best; nothing where it does not.
fn rank(entry: &Entry, wanted: &str) -> Option<u8> {
    let name = entry.name.to_lowercase();
    if name.starts_with(wanted) {
        return Some(0);
    }
    if name.contains(wanted) {
        return Some(1);
    }
    let words: Vec<&str> = wanted.split_whitespace().collect();
    let whole = format!("{name} {} {}", entry.menu, entry.help).to_lowercase();
    words.iter().all(|word| whole.contains(word)).then_some(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_the_name_finds_a_command() {
        let first = |search: &str| found(search)[0].action;
        assert_eq!(first("undo"), Action::Undo);
        assert_eq!(first("save as"), Action::SaveAs);
        assert_eq!(first("render p"), Action::Job(0));
        assert_eq!(first("shreds add"), Action::AddPreset(crate::scene::Preset::Fractus));
        assert!(found("no such command").is_empty());
        assert_eq!(found("").len(), entries().len());
    }
}
