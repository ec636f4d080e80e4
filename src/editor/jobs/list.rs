//! The window of the queue: a row a job.

use eframe::egui::{self, Align2, Color32, Context, Label, ProgressBar, RichText, ScrollArea, Ui, vec2};
use egui_phosphor::regular as icon;

use super::{
    queue::{Job, Jobs, State},
    shell_line,
};
use crate::editor::labels::name_widget;

impl Jobs {
    /// Shows the queue, where it is open: over the view, and none of what is around it moves.
    pub fn show(&mut self, ctx: &Context) {
        let (mut open, mut gone) = (self.is_open, None);
        let window = egui::Window::new("Jobs").open(&mut open).collapsible(true).resizable(true);
        let place = window.default_width(460.0).pivot(Align2::RIGHT_TOP);
        place.default_pos(ctx.content_rect().right_top() + vec2(-352.0, 150.0)).show(ctx, |ui| {
            if self.jobs.is_empty() {
                ui.weak("Nothing is to be done. The File menu has pictures, sequences and exports.");
            }
            ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                for (index, job) in self.jobs.iter_mut().enumerate() {
                    if ui.push_id(index, |ui| row(ui, job)).inner {
                        gone = Some(index);
                    }
                    ui.separator();
                }
            });
        });
        self.is_open = open;
        if let Some(index) = gone {
            self.remove(index);
        }
    }
}

/// A job; true where it shall be taken away.
fn row(ui: &mut Ui, job: &mut Job) -> bool {
    let name = job.order.output.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut gone = false;
    ui.horizontal(|ui| {
        ui.strong(job.order.title);
        ui.label(&name).on_hover_text(job.order.output.display().to_string());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| gone = buttons(ui, job, &name));
    });
    state(ui, job);
    let line = shell_line(&job.order.words);
    ui.horizontal(|ui| {
        let copy = ui.small_button(icon::COPY).on_hover_text("Copies the command line");
        name_widget(ui, &copy, &format!("Copy the command of {name}"));
        if copy.clicked() {
            ui.ctx().copy_text(line.clone());
        }
        let text = RichText::new(&line).monospace().weak().size(11.0);
        ui.add(Label::new(text).truncate()).on_hover_text(&line);
    });
    gone
}

fn buttons(ui: &mut Ui, job: &mut Job, name: &str) -> bool {
    let button = |ui: &mut Ui, text: &str| {
        let response = ui.small_button(text);
        name_widget(ui, &response, &format!("{text} {name}"));
        response.clicked()
    };
    if !job.is_under_way() {
        return button(ui, "Remove");
    }
    if !job.stopping && button(ui, "Cancel") {
        job.cancel();
    }
    match job.state {
        State::Working(_) if !job.stopping && button(ui, "Pause") => job.pause(),
        State::Paused(_) if button(ui, "Resume") => job.resume(),
        _ => {}
    }
    false
}

fn state(ui: &mut Ui, job: &Job) {
    let (error, weak) = (ui.visuals().error_fg_color, ui.visuals().weak_text_color());
    let say = |ui: &mut Ui, color: Color32, text: &str| {
        ui.add(Label::new(RichText::new(text).color(color)).wrap().selectable(true));
    };
    match &job.state {
        State::Waiting => say(ui, weak, "waits for the others"),
        State::Working(process) | State::Paused(process) => {
            let text = match (&job.state, job.stopping) {
                (_, true) => "stopping where files are whole".to_owned(),
                (State::Paused(_), _) => format!("paused at {:.1} %", 100.0 * process.share()),
                _ => format!("{:.1} %", 100.0 * process.share()),
            };
            ui.add(ProgressBar::new(process.share()).text(text));
        }
        State::Done(told) => say(ui, weak, told),
        State::Failed(why) => say(ui, error, why),
        State::Cancelled => say(ui, weak, "cancelled"),
    }
}
