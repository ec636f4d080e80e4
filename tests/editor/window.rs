//! The viewport without a window around it.

use eframe::egui::{self, Pos2, Vec2};
use egui_kittest::{
    Harness,
    wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup},
};
use glam::DVec3;
use nephos::{
    editor::{
        Document,
        viewport::{Lens, Stage, ViewCommand, Viewport},
    },
    scene::{Camera, Cloud, Ellipsoid, Projection, Scene},
};

use crate::patience;

/// A viewport and the document that it shows.
pub struct App {
    pub viewport: Viewport,
    pub document: Document,
}

pub type Window<'a> = Harness<'a, App>;

pub fn lump(center: [f64; 3]) -> Ellipsoid {
    Ellipsoid::new(center.into(), DVec3::new(170.0, 110.0, 150.0))
}

/// Two lumps beside each other, seen from the south at their height.
pub fn two_lumps() -> Scene {
    let ellipsoids = vec![lump([-200.0, 1000.0, 0.0]), lump([220.0, 1000.0, 0.0])];
    let camera = Camera {
        position: DVec3::new(0.0, 1000.0, 1500.0),
        target: DVec3::new(0.0, 1000.0, 0.0),
        roll_deg: 0.0,
        projection: Projection::default(),
        ..Camera::default()
    };
    let clouds = vec![Cloud { ellipsoids, ..Cloud::default() }];
    Scene { clouds, camera: Some(camera), ..Scene::default() }
}

/// Opens a viewport of `size` points on the software adapter.
pub fn open(scene: Scene, size: Vec2) -> Window<'static> {
    open_until(scene, size, Stage::Final)
}

/// The same where clouds are not what is looked at: they stay drafts.
pub fn sketch(scene: Scene, size: Vec2) -> Window<'static> {
    open_until(scene, size, Stage::Moving)
}

fn open_until(scene: Scene, size: Vec2, finest: Stage) -> Window<'static> {
    let state = create_render_state(default_wgpu_setup(), egui_wgpu::RendererOptions::PREDICTABLE);
    let mut app = App { viewport: Viewport::new(&state), document: Document::new(scene) };
    app.viewport.settings.finest = finest;
    let mut dressed = false;
    let ui = move |ui: &mut egui::Ui, app: &mut App| {
        if !std::mem::replace(&mut dressed, true) {
            let mut fonts = egui::FontDefinitions::default();
            egui_phosphor::add_to_fonts(&mut fonts, egui_phosphor::Variant::Regular);
            ui.ctx().set_fonts(fonts);
        }
        let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(ui.ctx().content_rect()));
        app.viewport.ui(&mut inner, &mut app.document);
    };
    let mut window = Harness::builder()
        .with_size(size)
        .renderer(WgpuTestRenderer::from_render_state(state))
        .build_ui_state(ui, app);
    window.step();
    window
}

/// Steps until nothing asks for another frame.
pub fn rest(window: &mut Window<'_>) {
    rest_until(window, |app| app.viewport.at_rest());
}

/// Lets the hand rest and steps until something is so.
pub fn rest_until(window: &mut Window<'_>, so: impl Fn(&App) -> bool) {
    window.step();
    patience::wait(window, "what is waited for", |_| false, |app| so(app));
}

/// Where the centre of an ellipsoid is on the screen.
pub fn at(window: &Window<'_>, ellipsoid: usize) -> Pos2 {
    let app = window.state();
    let lens = Lens::new(&app.viewport.camera(), window.ctx.content_rect());
    lens.place(app.document.scene().clouds[0].ellipsoids[ellipsoid].center).expect("before the camera")
}

/// Writes what is seen, for people.
pub fn shoot(window: &mut Window<'_>, name: &str) {
    let device = window.state().viewport.gpu().device.clone();
    patience::shoot(window, &device, name);
}

/// Runs a command and goes where it leads at once.
pub fn run(window: &mut Window<'_>, command: ViewCommand) {
    let app = window.state_mut();
    app.viewport.run(command, &mut app.document);
}
