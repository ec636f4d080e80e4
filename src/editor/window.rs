//! The window that the editor is in.

use std::{env, path::PathBuf, sync::Arc};

use eframe::egui::{self, ViewportBuilder, vec2};

use super::{Editor, Options, Places, Settings, jobs::Program};
use crate::{Error, Result, gpu};

/// Size of the window at the first start, points.
const SIZE: [f32; 2] = [1440.0, 900.0];
/// Below this, panels leave no room for the view.
const LEAST: [f32; 2] = [900.0, 560.0];

/// Whether there is a desktop to open a window on.
pub fn has_desktop() -> bool {
    let named = |name: &str| env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || named("DISPLAY") || named("WAYLAND_DISPLAY")
}

/// Opens the editor's window, with `scene` in it, on the best adapter or on the one whose name
/// contains `adapter`; returns when it is closed. `program` does jobs beside the work.
///
/// # Errors
/// [`Error::Argument`] where there is no desktop, [`Error::Adapter`] where there is no adapter.
pub fn run(scene: Option<PathBuf>, adapter: Option<String>, program: Option<Program>) -> Result<()> {
    if !has_desktop() {
        return Err(Error::Argument(
            "there is no desktop to open a window on: start this where DISPLAY or WAYLAND_DISPLAY is set; \
             `nephos render` needs neither"
                .to_owned(),
        ));
    }
    let places = Places::of_the_system()?;
    let settings = Settings::load(&places);
    let native = eframe::NativeOptions {
        viewport: window(&settings),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: graphics(adapter),
        // Our own settings remember it.
        persist_window: false,
        ..Default::default()
    };
    let options = Options { program, ..Options::new(scene, places) };
    let start =
        move |creation: &eframe::CreationContext<'_>| -> std::result::Result<Box<dyn eframe::App>, _> {
            let state = creation.wgpu_render_state.as_ref().ok_or("the window has no graphics device")?;
            Ok(Box::new(App(Editor::new(&creation.egui_ctx, state, options))))
        };
    eframe::run_native("nephos", native, Box::new(start))
        .map_err(|error| Error::Adapter(format!("the editor's window could not be opened: {error}")))
}

fn window(settings: &Settings) -> ViewportBuilder {
    let mut window = ViewportBuilder::default()
        .with_title("nephos")
        .with_app_id("nephos")
        .with_inner_size(SIZE)
        .with_min_inner_size(LEAST)
        .with_icon(icon())
        .with_drag_and_drop(true);
    if let Some(place) = &settings.window {
        let size = vec2(place.size[0].max(LEAST[0]), place.size[1].max(LEAST[1]));
        window = window.with_inner_size(size).with_maximized(place.maximized);
        if let Some(position) = place.position {
            window = window.with_position(position);
        }
    }
    window
}

/// The same choice of adapter as for everything else, among those that can show a window.
fn graphics(adapter: Option<String>) -> egui_wgpu::WgpuConfiguration {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends = wgpu::Backends::PRIMARY;
    setup.native_adapter_selector = Some(Arc::new(move |adapters, surface| {
        let shows = |a: &&wgpu::Adapter| surface.is_none_or(|surface| a.is_surface_supported(surface));
        let fit: Vec<_> = adapters.iter().filter(shows).cloned().collect();
        gpu::choose(fit, adapter.as_deref()).map_err(|error| error.to_string())
    }));
    setup.device_descriptor = Arc::new(gpu::wanted);
    egui_wgpu::WgpuConfiguration { wgpu_setup: setup.into(), ..Default::default() }
}

/// A white heap on blue: three discs.
fn icon() -> egui::IconData {
    const SIZE: usize = 64;
    const DISCS: [(f32, f32, f32); 3] = [(22.0, 38.0, 13.0), (34.0, 28.0, 15.0), (46.0, 38.0, 11.0)];
    let pixel = |i: usize| {
        let (x, y) = ((i % SIZE) as f32 + 0.5, (i / SIZE) as f32 + 0.5);
        let corner = ((x - 32.0).abs() - 20.0).max(0.0).hypot(((y - 32.0).abs() - 20.0).max(0.0));
        let inside = DISCS.iter().map(|(a, b, r)| r - (x - a).hypot(y - b)).fold(f32::MIN, f32::max);
        let flat = (51.0 - y).min(inside);
        let white = (flat + 0.5).clamp(0.0, 1.0);
        let mix = |sky: f32, cloud: f32| (sky + (cloud - sky) * white) as u8;
        [
            mix(54.0, 246.0),
            mix(110.0, 249.0),
            mix(178.0, 252.0),
            (255.0 * (11.5 - corner).clamp(0.0, 1.0)) as u8,
        ]
    };
    let rgba = (0..SIZE * SIZE).flat_map(pixel).collect();
    egui::IconData { rgba, width: SIZE as u32, height: SIZE as u32 }
}

/// The editor as the window sees it.
struct App(Editor);

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.0.ui(ui);
    }

    fn on_exit(&mut self) {
        self.0.write_settings();
    }
}
