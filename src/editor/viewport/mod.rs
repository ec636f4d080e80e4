//! The viewport: the cloud, and everything that is drawn over it and done to it with the
//! mouse. Edits the document through [`Document`] only.

mod canvas;
mod commands;
mod compare;
mod compass;
mod easel;
mod error_map;
mod gizmo;
mod hand;
mod hud;
mod ink;
mod lens;
mod mouse;
mod navigation;
mod operation;
mod outline;
mod overlay;
mod pace;
mod pick;
mod screen;
mod settings;
mod space;
mod stage;
mod statistics;
mod subject;
mod transform;
mod truth;
mod work;

use std::time::Duration;

use eframe::egui::{Color32, Painter, Pos2, Rect, Response, Sense, Ui, WidgetInfo, WidgetType, pos2};

pub use commands::{COMMANDS, Entry, ViewCommand, find, take};
pub use error_map::Numbers;
pub use lens::{Lens, Ray};
pub use navigation::{Navigation, Side};
pub use settings::{Axes, Layer, Pivot, Tool, ViewSettings};
pub use stage::Stage;
pub use statistics::Statistics;

use self::{
    easel::{Easel, Order},
    hand::Hand,
    mouse::{Boxing, Hover},
    operation::{Kind, Operation},
    subject::Subject,
    truth::Truth,
};
use super::Document;
use crate::{
    gpu::Gpu,
    render::{Film, Quality},
    scene::{Bounds, Camera, Ellipsoid, Scene},
};

/// Seconds in which the view goes to another one.
const GLIDE: f64 = 0.22;

/// The viewport of the editor.
pub struct Viewport {
    /// What a person chose; to be kept between sessions.
    pub settings: ViewSettings,
    view: Navigation,
    glide: Option<Glide>,
    opened: bool,
    hand: Hand,
    speed: f64,
    rect: Rect,
    hover: Hover,
    boxing: Boxing,
    clicked: Option<Pos2>,
    wish: Option<Kind>,
    operation: Option<Operation>,
    easel: Easel,
    /// The scene's camera when it was seen last.
    camera: Option<Camera>,
    /// Whether the truth is shown beside the preview.
    truth: bool,
}

/// The preview against the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Samples of each pixel of the truth.
    pub samples: u32,
    /// How far they are from each other.
    pub numbers: Numbers,
}

/// A way from one view to another.
struct Glide {
    from: Navigation,
    to: Navigation,
    /// In the window's time, s; not begun while there is none.
    began: Option<f64>,
}

impl Viewport {
    /// A viewport on the window's device.
    pub fn new(render_state: &egui_wgpu::RenderState) -> Self {
        let (device, queue) = (render_state.device.clone(), render_state.queue.clone());
        let gpu = Gpu::from_device(device, queue, render_state.adapter.get_info());
        Self {
            settings: ViewSettings::default(),
            view: Navigation::default(),
            glide: None,
            opened: false,
            hand: Hand::Free,
            speed: 1.0,
            rect: Rect::from_min_max(pos2(0.0, 0.0), pos2(16.0, 9.0)),
            hover: Hover::default(),
            boxing: Boxing::Off,
            clicked: None,
            wish: None,
            operation: None,
            easel: Easel::new(gpu, render_state.renderer.clone()),
            camera: None,
            truth: false,
        }
    }

    /// Draws the cloud and what is over it, and does what mouse and keys say.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document) {
        self.rect = whole_pixels(ui.available_rect_before_wrap(), ui.pixels_per_point());
        let response = ui.allocate_rect(self.rect, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, "Viewport"));
        if !self.opened {
            self.look_through(document);
        }
        self.follow_camera(document);
        self.keys(ui, &response, document);
        self.mouse(ui, &response, document);
        self.go_on_gliding(ui);
        let painter = ui.painter_at(self.rect);
        self.draw_picture(ui, &painter, document);
        self.draw_over(ui, &painter, document);
        self.divide(ui);
        self.hud(ui, document);
    }

    /// Does what a key, a menu or the palette asked for.
    pub fn run(&mut self, command: ViewCommand, document: &mut Document) {
        use ViewCommand::*;
        match command {
            Move => self.wish = Some(Kind::Move),
            Rotate => self.wish = Some(Kind::Rotate),
            Scale => self.wish = Some(Kind::Scale),
            UseTool(tool) => self.settings.tool = tool,
            ToggleLocal => self.settings.axes = self.settings.axes.other(),
            NextPivot => self.settings.pivot = self.settings.pivot.next(),
            ToggleSnap => self.settings.snap ^= true,
            SelectBox => self.boxing = Boxing::Armed,
            FrameSelected => self.frame(bounds_of_selected(document).or(bounds_of_visible(document))),
            FrameAll => self.frame(bounds_of_visible(document)),
            LookFrom(side) => self.glide_to(|view| view.look_from(side)),
            ToggleOrthographic => self.view.orthographic ^= true,
            LookThroughSceneCamera => {
                let view = Navigation { framed: true, ..through(document) };
                self.glide_to(|to| *to = view);
            }
            SaveView(number) => self.save_view(number),
            RecallView(number) => {
                if let Some(view) = self.saved_view(number) {
                    self.glide_to(|to| *to = view);
                }
            }
            ToggleOutlines => self.settings.outlines ^= true,
            ToggleGrid => self.settings.grid ^= true,
            Show(layer) => self.settings.layer = layer,
            ToggleTruth => self.toggle_truth(),
            ToggleErrorMap => self.toggle_error_map(),
            ToggleMeasure => self.settings.measure ^= true,
        }
    }

    /// Where it was drawn last.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// The device that it draws with.
    pub fn gpu(&self) -> &Gpu {
        self.easel.gpu()
    }

    /// What was drawn and how long it took.
    pub fn statistics(&self) -> &Statistics {
        &self.easel.seen().statistics
    }

    /// What auto exposure adds to the scene's exposure, stops, where it has one.
    pub fn metered(&self) -> Option<f64> {
        self.easel.seen().metered
    }

    /// How far the preview is from the truth, where that is shown.
    pub fn comparison(&self) -> Option<Comparison> {
        let (samples, numbers) = self.easel.seen().truth.numbers.filter(|_| self.truth)?;
        Some(Comparison { samples, numbers })
    }

    /// Whether the picture is final and nothing asks for another frame.
    pub fn at_rest(&self) -> bool {
        let truth = &self.easel.seen().truth;
        let told = !self.truth || truth.done || truth.error.is_some();
        self.easel.at_rest() && self.glide.is_none() && told
    }

    /// Whether all keys belong to the viewport now: an axis or a number is expected, or
    /// letters fly. The shell then leaves its own shortcuts alone.
    pub fn takes_keys(&self) -> bool {
        self.operation.is_some() || self.wish.is_some() || self.hand.flies()
    }

    /// The view as a camera of a scene.
    pub fn camera(&self) -> Camera {
        self.view.camera(self.aspect())
    }

    /// Where new things go: the middle of the view, m.
    pub fn focus(&self) -> glam::DVec3 {
        self.view.pivot
    }

    /// Looks as the scene's camera does: to be called when another document is opened.
    pub fn look_through(&mut self, document: &Document) {
        self.view = through(document);
        self.glide = None;
        self.opened = true;
    }

    fn aspect(&self) -> f64 {
        f64::from(self.rect.width().max(1.0) / self.rect.height().max(1.0))
    }

    fn save_view(&mut self, number: usize) {
        if let Some(view) = self.settings.views.get_mut(number.wrapping_sub(1)) {
            *view = Some(self.view.clone());
        }
    }

    fn saved_view(&self, number: usize) -> Option<Navigation> {
        self.settings.views.get(number.wrapping_sub(1)).cloned().flatten()
    }

    fn frame(&mut self, bounds: Option<Bounds>) {
        let aspect = self.aspect();
        if let Some(bounds) = bounds {
            self.glide_to(|view| view.frame(bounds, aspect));
        }
    }

    fn glide_to(&mut self, change: impl FnOnce(&mut Navigation)) {
        let mut to = self.glide.take().map_or_else(|| self.view.clone(), |glide| glide.to);
        change(&mut to);
        self.glide = Some(Glide { from: self.view.clone(), to, began: None });
    }

    fn go_on_gliding(&mut self, ui: &Ui) {
        let Some(glide) = &mut self.glide else { return };
        let now = ui.input(|i| i.time);
        let share = ((now - *glide.began.get_or_insert(now)) / GLIDE).clamp(0.0, 1.0);
        let eased = share * share * (3.0 - 2.0 * share);
        self.view = glide.from.toward(&glide.to, eased);
        if share >= 1.0 {
            self.glide = None;
        } else {
            ui.ctx().request_repaint();
        }
    }

    fn keys(&mut self, ui: &Ui, response: &Response, document: &mut Document) {
        if self.takes_keys() || !response.contains_pointer() || ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let pressed = |entry: &&Entry| entry.shortcut.is_some_and(|keys| ui.input_mut(|i| take(i, &keys)));
        if let Some(entry) = COMMANDS.iter().find(pressed) {
            self.run(entry.command, document);
            ui.ctx().request_repaint();
        }
    }

    fn draw_picture(&mut self, ui: &Ui, painter: &Painter, document: &Document) {
        let size = self.pixels(ui.pixels_per_point());
        let subject = Subject {
            scene: document.shared_scene(),
            camera: self.view.seen(self.aspect()),
            size,
            layer: if self.truth { Layer::Beauty } else { self.settings.layer },
            rays: Film::of_quality(size, &Quality::FINAL).rays(),
            finest: self.settings.finest,
        };
        let budget = Duration::from_secs_f64(1.0 / self.settings.frames_per_second.clamp(5.0, 120.0));
        let (tone, measure, truth) = (document.scene().tone(), self.settings.measure, self.truth);
        self.easel.ask(Order { subject, tone, budget, measure, truth }, ui.ctx());
        if let Some(image) = self.easel.seen().image {
            painter.image(image, self.rect, compare::WHOLE, Color32::WHITE);
        }
        self.draw_truth(painter);
    }

    /// A view through the scene's camera stays there when curves move the camera. An automatic one is where
    /// it was when one looked: it would jump at each edit.
    fn follow_camera(&mut self, document: &Document) {
        let Some(camera) = document.scene().camera.clone() else {
            self.camera = None;
            return;
        };
        let before = self.camera.replace(camera.clone());
        let moved = before.filter(|before| *before != camera);
        if self.glide.is_none() && moved.is_some_and(|before| self.is_at(&before)) {
            self.view = Navigation { framed: self.view.framed, ..through(document) };
        }
    }

    /// Whether the view is the scene's camera.
    fn looks_through(&self, scene: &Scene) -> bool {
        self.is_at(&scene.camera())
    }

    fn is_at(&self, camera: &Camera) -> bool {
        let view = self.view.camera(self.aspect());
        let near = 1e-6 * self.view.distance;
        camera.position.distance(view.position) < near && camera.forward().distance(view.forward()) < 1e-6
    }

    /// Whether the picture is light, not numbers.
    fn shows_light(&self) -> bool {
        !matches!(self.settings.layer, Layer::Transmittance | Layer::Normal | Layer::Cost)
    }

    /// Size of the picture: the screen's, unless that is more than wanted.
    fn pixels(&self, pixels_per_point: f32) -> [u32; 2] {
        let size = self.rect.size() * pixels_per_point;
        let most = if self.settings.largest == 0 { Film::WIDEST } else { self.settings.largest };
        let mut shrink = (most as f32 / size.x.max(size.y).max(1.0)).min(1.0);
        if self.truth {
            // Both sides have the same pixels, as many as paths can be traced for.
            let pixels = Truth::pixels(self.easel.gpu(), self.settings.truth_pixels);
            shrink = shrink.min((pixels as f32 / size.x.max(1.0) / size.y.max(1.0)).sqrt());
        }
        [size.x, size.y].map(|n| ((n * shrink).round() as u32).max(1))
    }

    fn draw_over(&self, ui: &Ui, painter: &Painter, document: &Document) {
        let (scene, selection) = (document.scene(), document.selection());
        let world = self.view.lens(self.rect);
        let lens = self.scene_lens(document);
        if self.settings.grid && self.shows_light() {
            overlay::grid(painter, &world, scene.ground.altitude, self.view.pivot, self.view.distance);
            overlay::horizon(painter, &world, scene.ground.altitude);
            if let Some(camera) = &scene.camera {
                overlay::camera(painter, &world, camera);
            }
        }
        if self.view.framed && self.glide.is_none() && self.looks_through(scene) {
            overlay::frame(painter, self.rect, navigation::PICTURE_ASPECT as f32);
        }
        // Between truth and preview nothing shall stand that is not needed.
        let mouse = ui.input(|input| input.pointer.hover_pos());
        let mouse = mouse.filter(|at| self.settings.outlines && !self.truth && self.rect.contains(*at));
        overlay::outlines(painter, &lens, scene, selection, self.hover.ellipsoid, mouse);
        if let Some(area) = self.box_area(ui) {
            let found = pick::in_box(scene, &lens, area);
            overlay::centers(painter, &lens, scene, |id| found.contains(&id));
            overlay::selection_box(painter, area);
        }
        if let Some(operation) = &self.operation {
            hud::draw_operation(ui, painter, &lens, operation);
        }
        if let Some(gizmo) = self.gizmo(document) {
            let lit = self.operation.as_ref().map(|operation| operation.constraint).or(self.hover.handle);
            gizmo.draw(painter, &lens, lit);
        }
    }
}

fn through(document: &Document) -> Navigation {
    let camera = document.scene().camera();
    let focus = bounds_of_visible(document).map_or(camera.target, |(low, high)| 0.5 * (low + high));
    Navigation::through(&camera, focus)
}

fn bounds_of_selected(document: &Document) -> Option<Bounds> {
    let ids = &document.selection().ellipsoids;
    union(document, ids.iter().filter_map(|id| document.ellipsoid(*id)))
}

fn bounds_of_visible(document: &Document) -> Option<Bounds> {
    union(document, pick::visible(document.scene()).map(|(_, ellipsoid)| ellipsoid))
}

/// Bounds where the wind has carried them.
fn union<'a>(document: &Document, ellipsoids: impl Iterator<Item = &'a Ellipsoid>) -> Option<Bounds> {
    let (low, high) = ellipsoids.map(Ellipsoid::bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let blown = mouse::blown(document);
    Some((low + blown, high + blown))
}

/// A rectangle whose picture has whole pixels.
fn whole_pixels(rect: Rect, pixels_per_point: f32) -> Rect {
    let round = |x: f32| (x * pixels_per_point).round() / pixels_per_point;
    Rect::from_min_max(pos2(round(rect.min.x), round(rect.min.y)), pos2(round(rect.max.x), round(rect.max.y)))
}
