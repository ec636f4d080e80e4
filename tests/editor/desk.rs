//! The whole editor without a window around it, driven as a person would.

use std::{path::Path, time::Duration};

use eframe::egui::{self, Vec2, vec2};
use egui_kittest::{
    Harness,
    wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup},
};
use nephos::{
    editor::{Editor, Options, Places, jobs::Program, viewport::Stage},
    scene::Scene,
};

use crate::patience;

/// An editor that is made in the first frame, when there is something to make it with.
pub struct Desk {
    editor: Option<Editor>,
    state: egui_wgpu::RenderState,
    options: Options,
}

pub type Window<'a> = Harness<'a, Desk>;

/// The least window that everything must fit into.
pub const SMALL: Vec2 = vec2(1280.0, 720.0);

impl Desk {
    pub fn editor(&mut self) -> &mut Editor {
        self.editor.as_mut().expect("made in the first frame")
    }

    pub fn scene(&self) -> &Scene {
        self.editor.as_ref().expect("made in the first frame").document().scene()
    }

    fn ui(&mut self, ui: &mut egui::Ui) {
        let editor = self.editor.get_or_insert_with(|| {
            let mut editor = Editor::new(ui.ctx(), &self.state, self.options.clone());
            // Clouds are not what is tested here, and cost seconds on two cores.
            let settings = &mut editor.viewport_mut().settings;
            (settings.largest, settings.finest) = (64, Stage::Moving);
            editor
        });
        let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(ui.ctx().content_rect()));
        editor.ui(&mut inner);
    }
}

/// Opens the editor with its own files in `folder`.
pub fn open(folder: &Path, scene: Option<&Path>) -> Window<'static> {
    open_sized(folder, scene, SMALL, 1.0)
}

/// The same in a window of `size` points of `scale` pixels.
pub fn open_sized(folder: &Path, scene: Option<&Path>, size: Vec2, scale: f32) -> Window<'static> {
    let state = create_render_state(default_wgpu_setup(), egui_wgpu::RendererOptions::PREDICTABLE);
    let mut options = Options::new(scene.map(Path::to_owned), Places::within(folder));
    options.keep_after = Duration::ZERO;
    // The program that was built, not this test.
    options.program = nephos::cli::program()
        .map(|program| Program { path: env!("CARGO_BIN_EXE_nephos").into(), ..program });
    let desk = Desk { editor: None, state: state.clone(), options };
    let mut window = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(scale)
        .renderer(WgpuTestRenderer::from_render_state(state))
        .build_ui_state(|ui, desk: &mut Desk| desk.ui(ui), desk);
    window.run_steps(3);
    window
}

/// Steps until `done`.
pub fn wait(window: &mut Window<'_>, what: &str, done: impl FnMut(&mut Desk) -> bool) {
    patience::wait(window, what, |desk| desk.editor().has_jobs(), done);
}

/// Writes what is seen, for people.
pub fn shoot(window: &mut Window<'_>, name: &str) {
    let device = window.state().state.device.clone();
    patience::shoot(window, &device, name);
}
