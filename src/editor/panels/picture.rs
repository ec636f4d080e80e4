//! The window that asks for a final picture.

use std::path::{Path, PathBuf};

use eframe::egui::{Context, DragValue, Grid, RichText, TextEdit, Ui};
use egui_phosphor::regular as icon;

use crate::{
    editor::{labels::name_widget, palette::Answer, still::Still, theme::modal},
    render::Quality,
};

/// Sizes that pictures are often wanted in.
const SIZES: [(&str, [u32; 2]); 4] =
    [("960 x 540", [960, 540]), ("HD", [1920, 1080]), ("4K", [3840, 2160]), ("Square", [1080, 1080])];

/// What a person wants of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PictureWish {
    /// To choose the file in a window.
    Choose,
    /// To have it drawn.
    Render,
}

/// What to draw and where to put it; kept while the editor runs.
#[derive(Debug, Clone)]
pub struct PicturePanel {
    /// Width and height, pixels.
    pub size: [u32; 2],
    quality: usize,
    transparent: bool,
    layers: bool,
    /// The file as it is being typed.
    pub path: String,
}

impl Default for PicturePanel {
    fn default() -> Self {
        let last = Quality::PRESETS.len() - 1;
        Self { size: [1920, 1080], quality: last, transparent: false, layers: false, path: String::new() }
    }
}

impl PicturePanel {
    /// Names a file beside the scene's where none was named yet.
    pub fn suggest(&mut self, scene: Option<&Path>) {
        if self.path.is_empty() {
            let name = scene.map_or_else(|| PathBuf::from("cloud.png"), |scene| scene.with_extension("png"));
            let name = std::path::absolute(&name).unwrap_or(name);
            self.path = name.display().to_string();
        }
    }

    /// What is wanted.
    pub fn still(&self) -> Still {
        Still {
            size: self.size,
            quality: Quality::PRESETS[self.quality].1,
            transparent: self.transparent,
            layers: self.layers,
            path: PathBuf::from(self.path.trim()),
        }
    }

    /// Shows the window.
    pub fn show(&mut self, ctx: &Context) -> Answer<PictureWish> {
        let mut answer = Answer::Open;
        let modal = modal(ctx, "picture").show(ctx, |ui| {
            ui.set_width(460.0);
            ui.heading("Render picture");
            ui.add_space(8.0);
            Grid::new("picture").num_columns(2).spacing([14.0, 8.0]).show(ui, |ui| {
                self.size_row(ui);
                self.quality_row(ui);
                ui.weak("Sky");
                ui.checkbox(&mut self.transparent, "Leave it out: clouds on a transparent ground");
                ui.end_row();
                ui.weak("Layers");
                let is_exr = self.path.trim().to_lowercase().ends_with(".exr");
                let text = "The light apart, for compositors (EXR only)";
                ui.add_enabled(is_exr, eframe::egui::Checkbox::new(&mut self.layers, text));
                ui.end_row();
                if self.path_row(ui) {
                    answer = Answer::Chosen(PictureWish::Choose);
                }
            });
            let problem = self.still().check().err();
            if let Some(problem) = &problem {
                ui.colored_label(ui.visuals().error_fg_color, problem.to_string());
            }
            let replaces = problem.is_none() && Path::new(self.path.trim()).exists();
            if replaces {
                ui.colored_label(ui.visuals().warn_fg_color, "There is such a file: it will be replaced.");
            }
            ui.add_space(10.0);
            ui.horizontal(|ui| {
                let title = if replaces { "Render and replace" } else { "Render" };
                let render =
                    eframe::egui::Button::new(RichText::new(format!("{} {title}", icon::IMAGE)).strong())
                        .fill(ui.visuals().selection.bg_fill);
                if ui.add_enabled(problem.is_none(), render).clicked() {
                    answer = Answer::Chosen(PictureWish::Render);
                }
                if ui.button("Cancel").clicked() {
                    answer = Answer::Closed;
                }
            });
        });
        if modal.should_close() && answer == Answer::Open {
            return Answer::Closed;
        }
        answer
    }

    fn size_row(&mut self, ui: &mut Ui) {
        ui.weak("Size");
        ui.horizontal(|ui| {
            for (n, name) in self.size.iter_mut().zip(["Width", "Height"]) {
                let response = ui.add(DragValue::new(n).range(1..=8192).suffix(" px"));
                name_widget(ui, &response, name);
            }
            for (name, size) in SIZES {
                ui.selectable_value(&mut self.size, size, name);
            }
        });
        ui.end_row();
    }

    fn quality_row(&mut self, ui: &mut Ui) {
        ui.weak("Quality");
        ui.horizontal(|ui| {
            for (i, (name, _)) in Quality::PRESETS.iter().enumerate() {
                let title = format!("{}{}", name[..1].to_uppercase(), &name[1..]);
                ui.selectable_value(&mut self.quality, i, title);
            }
        });
        ui.end_row();
    }

    /// Whether a window was asked for to choose the file in.
    fn path_row(&mut self, ui: &mut Ui) -> bool {
        ui.weak("File");
        let clicked = ui.horizontal(|ui| {
            let response = ui.add(TextEdit::singleline(&mut self.path).desired_width(270.0));
            name_widget(ui, &response, "File of the picture");
            ui.button(format!("{} Choose...", icon::FOLDER_OPEN)).clicked()
        });
        ui.end_row();
        clicked.inner
    }
}
