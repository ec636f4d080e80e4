//! The viewport: the cloud, and everything that is drawn over it and done to it with the
//! mouse. Edits the document through [`Document`] only.

mod canvas;
mod commands;
mod hand;
mod lens;
mod navigation;
mod pace;
mod settings;
mod statistics;

use std::time::Duration;

use eframe::egui::{Color32, Rect, Response, Sense, Ui, pos2};
use glam::DVec2;

pub use canvas::{Canvas, Stage, Subject};
pub use commands::{COMMANDS, Entry, ViewCommand, find};
pub use lens::{Lens, Ray};
pub use navigation::{Navigation, Side};
pub use settings::{Axes, Layer, Pivot, Tool, ViewSettings};
pub use statistics::Statistics;

use self::hand::{Hand, Hold};
use super::Document;
use crate::{gpu::Gpu, scene};

/// The viewport of the editor.
pub struct Viewport {
    /// What a person chose; to be kept between sessions.
    pub settings: ViewSettings,
    view: Navigation,
    opened: bool,
    hand: Hand,
    speed: f64,
    rect: Rect,
    canvas: Canvas,
}

impl Viewport {
    /// A viewport on the window's device.
    pub fn new(render_state: &egui_wgpu::RenderState) -> Self {
        let (device, queue) = (render_state.device.clone(), render_state.queue.clone());
        let gpu = Gpu::from_device(device, queue, render_state.adapter.get_info());
        Self {
            settings: ViewSettings::default(),
            view: Navigation::default(),
            opened: false,
            hand: Hand::Free,
            speed: 1.0,
            rect: Rect::from_min_max(pos2(0.0, 0.0), pos2(16.0, 9.0)),
            canvas: Canvas::new(gpu, render_state.renderer.clone()),
        }
    }

    /// Draws the cloud and what is over it, and does what mouse and keys say.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document) {
        self.rect = whole_pixels(ui.available_rect_before_wrap(), ui.pixels_per_point());
        let response = ui.allocate_rect(self.rect, Sense::click_and_drag());
        if !self.opened {
            self.look_through(document);
        }
        self.keys(ui, &response, document);
        self.navigate(ui, &response, document);
        self.draw_picture(ui, document);
    }

    /// Does what a key, a menu or the palette asked for.
    pub fn run(&mut self, command: ViewCommand, document: &mut Document) {
        match command {
            ViewCommand::FrameSelected | ViewCommand::FrameAll => {
                if let Some(bounds) = document.scene().bounds() {
                    self.view.frame(bounds, self.aspect());
                }
            }
            ViewCommand::LookFrom(side) => self.view.look_from(side),
            ViewCommand::ToggleOrthographic => self.view.orthographic ^= true,
            ViewCommand::LookThroughSceneCamera => self.look_through(document),
            ViewCommand::ToggleOutlines => self.settings.outlines ^= true,
            ViewCommand::ToggleGrid => self.settings.grid ^= true,
            ViewCommand::ToggleMeasure => self.settings.measure ^= true,
            ViewCommand::Show(layer) => self.settings.layer = layer,
            ViewCommand::UseTool(tool) => self.settings.tool = tool,
            _ => {}
        }
    }

    /// The device that it draws with.
    pub fn gpu(&self) -> &Gpu {
        self.canvas.gpu()
    }

    /// What was drawn and how long it took.
    pub fn statistics(&self) -> &Statistics {
        &self.canvas.statistics
    }

    /// Whether the picture is final and nothing asks for another frame.
    pub fn at_rest(&self) -> bool {
        self.canvas.at_rest()
    }

    /// The view as a camera of a scene.
    pub fn camera(&self) -> scene::Camera {
        self.view.camera(self.aspect())
    }

    /// Looks as the scene's camera does: to be called when another document is opened.
    pub fn look_through(&mut self, document: &Document) {
        let scene = document.scene();
        let camera = scene.camera();
        let focus = scene.bounds().map_or(camera.target, |(low, high)| 0.5 * (low + high));
        self.view = Navigation::through(&camera, focus);
        self.opened = true;
    }

    fn aspect(&self) -> f64 {
        f64::from(self.rect.width().max(1.0) / self.rect.height().max(1.0))
    }

    fn keys(&mut self, ui: &Ui, response: &Response, document: &mut Document) {
        if !response.contains_pointer() || self.hand != Hand::Free || ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let shortcut = |entry: &&Entry| {
            entry.shortcut.is_some_and(|keys| {
                ui.input_mut(|i| i.modifiers.matches_exact(keys.modifiers) && i.consume_shortcut(&keys))
            })
        };
        if let Some(entry) = COMMANDS.iter().find(shortcut) {
            self.run(entry.command, document);
        }
    }

    fn navigate(&mut self, ui: &Ui, response: &Response, document: &Document) {
        let view = &mut self.view;
        let lens = view.lens(self.rect);
        let depth = view.distance;
        let (pivot, _) = (view.pivot, document);
        let hold = |at: DVec2| Hold { under: lens.at_depth(at, depth), about: pivot };
        self.hand.update(ui, response, view, &mut self.speed, hold);
        hand::wheel(ui, response, &self.hand, view, &mut self.speed, hold);
    }

    fn draw_picture(&mut self, ui: &Ui, document: &Document) {
        let pixels = self.rect.size() * ui.pixels_per_point();
        let mut size = [pixels.x, pixels.y].map(|n| (n.round() as u32).max(1));
        let most = if self.settings.largest == 0 { 8192 } else { self.settings.largest };
        if size[0] > most {
            size =
                [most, (f64::from(size[1]) * f64::from(most) / f64::from(size[0])).round().max(1.0) as u32];
        }
        let subject = Subject {
            scene: document.shared_scene(),
            camera: self.view.camera(self.aspect()),
            size,
            layer: self.settings.layer,
            rays: 2,
        };
        let budget = Duration::from_secs_f64(1.0 / self.settings.frames_per_second.clamp(5.0, 120.0));
        self.canvas.measure(self.settings.measure);
        if let Some(after) = self.canvas.update(subject, document.scene().exposure, budget) {
            ui.ctx().request_repaint_after(after);
        }
        let painter = ui.painter_at(self.rect);
        if let Some(image) = self.canvas.image() {
            painter.image(
                image,
                self.rect,
                Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)),
                Color32::WHITE,
            );
        }
    }
}

/// A rectangle whose picture has whole pixels.
fn whole_pixels(rect: Rect, pixels_per_point: f32) -> Rect {
    let round = |x: f32| (x * pixels_per_point).round() / pixels_per_point;
    Rect::from_min_max(pos2(round(rect.min.x), round(rect.min.y)), pos2(round(rect.max.x), round(rect.max.y)))
}
