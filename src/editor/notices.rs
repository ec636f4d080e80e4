//! What the editor has to tell: cards over the foot of the window, which move nothing.

use std::time::{Duration, Instant};

use eframe::egui::{
    self, Align, Align2, Area, Context, Frame, Id, Layout, Margin, Order, RichText, Stroke, Ui, vec2,
};
use egui_phosphor::regular as icon;

/// How long good news stays.
const NEWS: Duration = Duration::from_secs(6);

#[derive(Debug, Clone, PartialEq)]
struct Notice {
    text: String,
    /// Problems stay until they are dismissed.
    problem: bool,
    since: Instant,
}

/// What was told and not dismissed yet.
#[derive(Debug, Default)]
pub struct Notices(Vec<Notice>);

impl Notices {
    /// Tells that something went well.
    pub fn news(&mut self, text: impl Into<String>) {
        self.0.retain(|notice| notice.problem);
        self.0.push(Notice { text: text.into(), problem: false, since: Instant::now() });
    }

    /// Tells that something did not go well: the sentence of an error.
    pub fn problem(&mut self, text: impl ToString) {
        let text = text.to_string();
        self.0.retain(|notice| notice.text != text);
        self.0.push(Notice { text, problem: true, since: Instant::now() });
    }

    /// Takes away what was told before.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// What is told at present.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|notice| notice.text.as_str())
    }

    /// Shows what there is to tell.
    pub fn show(&mut self, ctx: &Context) {
        if self.0.is_empty() {
            return;
        }
        Area::new(Id::new("notices"))
            .order(Order::Foreground)
            .anchor(Align2::CENTER_BOTTOM, vec2(0.0, -72.0))
            .show(ctx, |ui| {
                ui.set_width((ui.ctx().content_rect().width() - 40.0).clamp(200.0, 640.0));
                self.ui(ui);
            });
    }

    fn ui(&mut self, ui: &mut Ui) {
        self.0.retain(|notice| notice.problem || notice.since.elapsed() < NEWS);
        if self.0.iter().any(|notice| !notice.problem) {
            ui.ctx().request_repaint_after(NEWS);
        }
        let mut dismissed = None;
        for (i, notice) in self.0.iter().enumerate() {
            let visuals = ui.visuals();
            let (mark, color) = match notice.problem {
                true => (icon::WARNING, visuals.error_fg_color),
                false => (icon::CHECK_CIRCLE, visuals.hyperlink_color),
            };
            let frame = Frame::new()
                .fill(visuals.extreme_bg_color)
                .stroke(Stroke::new(1.0, color.gamma_multiply(0.6)))
                .corner_radius(4)
                .inner_margin(Margin::symmetric(8, 4));
            frame.show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.label(RichText::new(mark).color(color).size(15.0));
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        if ui.small_button("Dismiss").clicked() {
                            dismissed = Some(i);
                        }
                        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                            ui.add(egui::Label::new(&notice.text).wrap().selectable(true));
                        });
                    });
                });
            });
        }
        if let Some(i) = dismissed {
            self.0.remove(i);
        }
    }
}
