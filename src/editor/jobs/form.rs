//! The window that asks what a job shall be like: a row for each option of its command.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use eframe::egui::{Button, ComboBox, Context, Grid, Label, RichText, ScrollArea, TextEdit, Ui};
use egui_phosphor::regular as icon;

use super::{Asked, Kind, Program, shell_line};
use crate::editor::{labels::name_widget, palette::Answer, theme::modal};

/// The option that names the file to write.
const OUTPUT: &str = "output";
/// What stands for the scene's file as long as there is none.
const SCENE: &str = "SCENE";

/// What a person wants of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobWish {
    /// To choose the file in a window.
    Choose,
    /// To have it done.
    Begin,
}

/// What kind of job, and the options that were given; they stay while the editor runs.
#[derive(Debug, Default)]
pub struct JobForm {
    kind: usize,
    /// By kind and name.
    values: BTreeMap<(usize, String), String>,
    /// The last line that was checked, and what is wrong with it.
    checked: Option<(Vec<String>, Option<String>)>,
}

impl JobForm {
    /// Begins to ask for job number `kind` of `program`, for `scene`, on the adapter of that name.
    pub fn begin(&mut self, program: &Program, kind: usize, scene: Option<&Path>, adapter: &str) {
        self.kind = kind;
        let Some(about) = program.kinds.get(kind) else { return };
        let path = scene.map_or_else(|| PathBuf::from(about.file), |scene| beside(scene, about.file));
        let path = std::path::absolute(&path).unwrap_or(path);
        let known = (OUTPUT.to_owned(), path.display().to_string());
        for (name, value) in [known, ("adapter".to_owned(), adapter.to_owned())] {
            if about.options.iter().any(|option| option.name == name) {
                self.values.entry((kind, name)).or_insert(value);
            }
        }
    }

    /// Another scene is edited: its files are others.
    pub fn forget_files(&mut self) {
        self.values.retain(|(_, name), _| name != OUTPUT);
    }

    /// The file to write.
    pub fn output(&self) -> PathBuf {
        PathBuf::from(self.value(OUTPUT).trim())
    }

    /// Sets the file to write.
    pub fn set_output(&mut self, path: &Path) {
        self.values.insert((self.kind, OUTPUT.to_owned()), path.display().to_string());
    }

    /// The kind of job.
    pub fn kind<'a>(&self, program: &'a Program) -> Option<&'a Kind> {
        program.kinds.get(self.kind)
    }

    fn value(&self, name: &str) -> &str {
        self.values.get(&(self.kind, name.to_owned())).map_or("", String::as_str)
    }

    /// The words behind the program's name, for the scene in the file `scene`.
    pub fn words(&self, kind: &Kind, scene: &str) -> Vec<String> {
        let option = |option: &Asked| {
            let value = self.value(&option.name).trim();
            match (option.takes_value, value) {
                (_, "") => None,
                (false, _) => Some(format!("--{}", option.name)),
                (true, value) if value == option.default => None,
                (true, value) => Some(format!("--{}={value}", option.name)),
            }
        };
        let given = kind.options.iter().filter_map(option);
        kind.words.iter().cloned().chain([scene.to_owned()]).chain(given).collect()
    }

    /// Shows the window.
    pub fn show(&mut self, ctx: &Context, program: &Program) -> Answer<JobWish> {
        let mut answer = Answer::Open;
        let Some(kind) = program.kinds.get(self.kind) else { return Answer::Closed };
        let modal = modal(ctx, "job").show(ctx, |ui| {
            ui.set_width(560.0);
            ui.heading(kind.title);
            ui.add(Label::new(RichText::new(&kind.about).weak()).wrap());
            ui.add_space(8.0);
            let room = (ui.ctx().content_rect().height() - 330.0).max(160.0);
            ScrollArea::vertical().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
                Grid::new("job").num_columns(2).spacing([14.0, 6.0]).show(ui, |ui| {
                    for option in &kind.options {
                        if self.row(ui, option) {
                            answer = Answer::Chosen(JobWish::Choose);
                        }
                    }
                });
            });
            ui.add_space(6.0);
            if let Some(wish) = self.foot(ui, program, kind) {
                answer = wish;
            }
        });
        if modal.should_close() && answer == Answer::Open {
            return Answer::Closed;
        }
        answer
    }

    /// An option; true where a file is to be chosen in a window.
    fn row(&mut self, ui: &mut Ui, option: &Asked) -> bool {
        let title = titled(&option.name);
        let value = self.values.entry((self.kind, option.name.clone())).or_default();
        ui.weak(&title).on_hover_text(&option.help);
        let mut chooses = false;
        if !option.takes_value {
            let mut on = !value.is_empty();
            let response = ui.checkbox(&mut on, first_sentence(&option.help)).on_hover_text(&option.help);
            name_widget(ui, &response, &title);
            if response.changed() {
                *value = if on { "on".to_owned() } else { String::new() };
            }
        } else if option.values.is_empty() {
            ui.horizontal(|ui| {
                let is_output = option.name == OUTPUT;
                let hint = if option.default.is_empty() { &option.value } else { &option.default };
                let field = TextEdit::singleline(value).hint_text(hint.as_str());
                let response = ui.add(field.desired_width(if is_output { 330.0 } else { 140.0 }));
                name_widget(ui, &response, &title);
                response.on_hover_text(&option.help);
                if is_output {
                    chooses = ui.button(format!("{} Choose...", icon::FOLDER_OPEN)).clicked();
                } else {
                    let text = RichText::new(first_sentence(&option.help)).weak().size(11.0);
                    ui.add(Label::new(text).truncate()).on_hover_text(&option.help);
                }
            });
        } else {
            let usual = if option.default.is_empty() { "as usual" } else { &option.default };
            let shown = if value.is_empty() { usual } else { value.as_str() }.to_owned();
            let response =
                ComboBox::from_id_salt(&option.name).width(160.0).selected_text(&shown).show_ui(ui, |ui| {
                    if option.default.is_empty() {
                        ui.selectable_value(value, String::new(), "as usual").on_hover_text(&option.help);
                    }
                    for (name, about) in &option.values {
                        let response = ui.selectable_label(shown == *name, name);
                        if response.on_hover_text(about).clicked() {
                            value.clone_from(name);
                        }
                    }
                });
            name_widget(ui, &response.response, &title);
        }
        ui.end_row();
        chooses
    }

    /// What is wrong, the command line, and the buttons.
    fn foot(&mut self, ui: &mut Ui, program: &Program, kind: &Kind) -> Option<Answer<JobWish>> {
        let words = self.words(kind, SCENE);
        if self.checked.as_ref().is_none_or(|(checked, _)| *checked != words) {
            let problem = (program.check)(&words).err();
            self.checked = Some((words.clone(), problem));
        }
        let problem = self.checked.as_ref().and_then(|(_, problem)| problem.clone());
        if let Some(problem) = &problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        let replaces = problem.is_none() && self.output().is_file();
        if replaces {
            ui.colored_label(ui.visuals().warn_fg_color, "There is such a file: it will be replaced.");
        }
        let whole: Vec<_> = [program.path.display().to_string()].into_iter().chain(words).collect();
        let line = RichText::new(shell_line(&whole)).monospace().weak().size(11.0);
        ui.add(Label::new(line).wrap());
        ui.add_space(8.0);
        let mut answer = None;
        ui.horizontal(|ui| {
            let title = if replaces { "Begin and replace" } else { "Begin" };
            let begin = Button::new(RichText::new(format!("{} {title}", icon::PLAY)).strong());
            let begin = begin.fill(ui.visuals().selection.bg_fill);
            let response = ui.add_enabled(problem.is_none(), begin);
            name_widget(ui, &response, "Begin");
            if response.clicked() {
                answer = Some(Answer::Chosen(JobWish::Begin));
            }
            if ui.button("Cancel").clicked() {
                answer = Some(Answer::Closed);
            }
        });
        answer
    }
}

/// `file` in the folder of `scene`, called as that is in place of "scene".
fn beside(scene: &Path, file: &str) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    scene.with_file_name(file.replacen("scene", &stem, 1))
}

/// "color-space" as "Color space".
fn titled(name: &str) -> String {
    let words = name.replace('-', " ");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn first_sentence(help: &str) -> &str {
    help.split_once([':', ';']).map_or(help, |(first, _)| first).split(". ").next().unwrap_or(help)
}
