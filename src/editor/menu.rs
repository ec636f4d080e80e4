//! The menu bar, the head of the outliner, the bar below.

use eframe::egui::{
    Align, Button, Context, Layout, MenuBar, PopupCloseBehavior, ProgressBar, RichText, Ui,
    containers::menu::{MenuButton, MenuConfig},
};
use egui_phosphor::regular as icon;

use super::{
    actions::{Action, about, entries, entry},
    app::Editor,
    asking::Then,
    labels::name_widget,
    theme::modal,
};
use crate::scene::Preset;

impl Editor {
    /// The menu bar.
    pub(super) fn menu(&mut self, ui: &mut Ui) {
        MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| self.file_menu(ui));
            ui.menu_button("Edit", |ui| self.edit_menu(ui));
            ui.menu_button("Add", |ui| self.add_menu(ui));
            for menu in ["Select", "Transform", "View"] {
                ui.menu_button(menu, |ui| self.group(ui, menu));
            }
            // Several things to show or not: the menu stays open.
            let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
            MenuButton::new("Show").config(stays).ui(ui, |ui| self.group(ui, "Show"));
            ui.menu_button("Window", |ui| self.group(ui, "Window"));
            ui.menu_button("Help", |ui| self.group(ui, "Help"));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let text = RichText::new(format!("{} Render", icon::IMAGE)).strong();
                let button = Button::new(text).fill(ui.visuals().selection.bg_fill).frame(true);
                let response = ui.add_enabled(self.can(Action::Job(0)), button);
                if response.on_hover_text("Draws the final picture into a file.").clicked() {
                    self.perform(ui.ctx(), Action::Job(0));
                }
                self.quick(ui, Action::Redo, icon::ARROW_CLOCKWISE);
                self.quick(ui, Action::Undo, icon::ARROW_COUNTER_CLOCKWISE);
                let mark = if self.document.is_dirty() { "•" } else { "" };
                ui.weak(format!("{}{mark}", self.session.name()));
            });
        });
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        self.item(ui, Action::New);
        ui.menu_button("New from preset", |ui| self.presets(ui, Action::NewFrom));
        self.item(ui, Action::Open);
        ui.menu_button("Open recent", |ui| self.recent_files(ui));
        ui.separator();
        for action in [Action::Save, Action::SaveAs, Action::Revert] {
            self.item(ui, action);
        }
        ui.separator();
        self.item(ui, Action::Job(0));
        self.item(ui, Action::Job(1));
        ui.menu_button("Export", |ui| self.group(ui, "Export"));
        self.item(ui, Action::ToggleJobs);
        ui.separator();
        let own = &mut self.settings.own_file_window;
        ui.checkbox(own, "Choose files in the editor's own window")
            .on_hover_text("For systems whose own window for files does not come up.");
        ui.separator();
        self.item(ui, Action::Quit);
    }

    fn recent_files(&mut self, ui: &mut Ui) {
        let recent = self.settings.recent.clone();
        if recent.is_empty() {
            ui.weak("No file yet");
        }
        for path in recent {
            let name = path.file_name().map_or_else(|| path.as_os_str().into(), ToOwned::to_owned);
            let button = ui.button(name.to_string_lossy());
            if button.on_hover_text(path.display().to_string()).clicked() {
                self.ask(ui.ctx(), Then::Open(path));
            }
        }
    }

    fn edit_menu(&mut self, ui: &mut Ui) {
        for entry in entries().iter().filter(|entry| entry.menu == "Edit") {
            self.item(ui, entry.action);
            if matches!(entry.action, Action::Redo | Action::Rename | Action::Grow | Action::Lock) {
                ui.separator();
            }
        }
    }

    fn add_menu(&mut self, ui: &mut Ui) {
        self.item(ui, Action::AddEllipsoid);
        self.item(ui, Action::AddCloud);
        ui.separator();
        self.presets(ui, Action::AddPreset);
    }

    fn presets(&mut self, ui: &mut Ui, action: fn(Preset) -> Action) {
        for preset in Preset::ALL {
            let name = preset.name();
            let title = format!("{}{}", name[..1].to_uppercase(), &name[1..]);
            if ui.button(title).on_hover_text(about(preset)).clicked() {
                self.perform(ui.ctx(), action(preset));
            }
        }
    }

    /// All entries of one menu.
    fn group(&mut self, ui: &mut Ui, menu: &str) {
        for entry in entries().iter().filter(|entry| entry.menu == menu) {
            self.item(ui, entry.action);
        }
    }

    fn item(&mut self, ui: &mut Ui, action: Action) {
        let Some(entry) = entry(action) else { return };
        let step = match action {
            Action::Undo => self.document.undo_name(),
            Action::Redo => self.document.redo_name(),
            _ => None,
        };
        let name = step.map_or_else(|| entry.name.to_string(), |step| format!("{}: {step}", entry.name));
        let keys = entry.shortcuts.first().map(|keys| ui.ctx().format_shortcut(keys)).unwrap_or_default();
        let button = Button::new(name).shortcut_text(keys);
        let response = ui.add_enabled(self.can(action), button).on_hover_text(entry.help.as_ref());
        if response.clicked() {
            self.perform(ui.ctx(), action);
        }
    }

    /// A button that is only an icon.
    fn quick(&mut self, ui: &mut Ui, action: Action, mark: &str) {
        let Some(entry) = entry(action) else { return };
        let keys = entry.shortcuts.first().map(|keys| ui.ctx().format_shortcut(keys)).unwrap_or_default();
        let response = ui
            .add_enabled(self.can(action), Button::new(mark))
            .on_hover_text(format!("{} ({keys})\n{}", entry.name, entry.help));
        name_widget(ui, &response, entry.name.as_ref());
        if response.clicked() {
            self.perform(ui.ctx(), action);
        }
    }

    /// Title of the outliner, and buttons that add to it.
    pub(super) fn outliner_head(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.strong("Scene");
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                self.quick(ui, Action::AddCloud, icon::CLOUD);
                self.quick(ui, Action::AddEllipsoid, icon::PLUS);
            });
        });
        ui.separator();
    }

    /// The bar below: what is selected, what the view does, a job under way.
    pub(super) fn status(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.weak(self.selected());
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.weak(if self.document.is_dirty() { "changes not saved" } else { "" });
                if let Some((count, share)) = self.jobs.under_way() {
                    let bar = ProgressBar::new(share).desired_width(160.0).show_percentage();
                    let response = ui.add(bar);
                    name_widget(ui, &response, "Job under way");
                    if ui.small_button(format!("{count} under way")).clicked() {
                        self.jobs.is_open ^= true;
                    }
                }
            });
        });
    }

    fn selected(&self) -> String {
        let (scene, selection) = (self.document.scene(), self.document.selection());
        let all: usize = scene.clouds.iter().map(|cloud| cloud.ellipsoids.len()).sum();
        let plural = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let chosen = selection.ellipsoids.len();
        let whole = format!("{} in {}", plural(all, "ellipsoid"), plural(scene.clouds.len(), "cloud"));
        if chosen == 0 { whole } else { format!("{chosen} selected of {whole}") }
    }

    /// What this program is; true where it was closed.
    pub(super) fn about(&self, ctx: &Context) -> bool {
        let mut closed = false;
        let modal = modal(ctx, "about").show(ctx, |ui| {
            ui.set_width(380.0);
            ui.heading(format!("nephos {}", env!("CARGO_PKG_VERSION")));
            ui.add_space(6.0);
            ui.label("Clouds from ellipsoids, fractal noise and Mie scattering.");
            ui.add_space(6.0);
            let adapter = &self.viewport.gpu().adapter;
            ui.weak(format!("{} ({}, {})", adapter.name, adapter.backend, adapter.driver));
            ui.add_space(10.0);
            closed = ui.button("Close").clicked();
        });
        closed || modal.should_close()
    }
}
