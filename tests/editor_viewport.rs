//! The viewport as a person drives it, without a window, on the software adapter too.
#![cfg(feature = "editor")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2, Vec2, pos2, vec2};
use egui_kittest::{
    Harness,
    wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup},
};
use nephos::{
    editor::{Document, viewport::Viewport},
    scene::{Cloud, Ellipsoid, Scene},
};

/// A viewport and the document that it shows.
pub struct App {
    pub viewport: Viewport,
    pub document: Document,
}

pub type Window<'a> = Harness<'a, App>;

fn two_lumps() -> Scene {
    let ellipsoids = vec![
        Ellipsoid::new(glam::DVec3::new(-150.0, 1000.0, 0.0), glam::DVec3::new(180.0, 120.0, 160.0)),
        Ellipsoid::new(glam::DVec3::new(200.0, 1050.0, 0.0), glam::DVec3::new(140.0, 110.0, 140.0)),
    ];
    Scene { clouds: vec![Cloud { ellipsoids, ..Cloud::default() }], ..Scene::default() }
}

pub fn open(scene: Scene, size: Vec2) -> Window<'static> {
    let state = create_render_state(default_wgpu_setup(), egui_wgpu::RendererOptions::PREDICTABLE);
    let mut viewport = Viewport::new(&state);
    viewport.settings.frames_per_second = 5.0;
    let app = App { viewport, document: Document::new(scene) };
    let ui = |ui: &mut egui::Ui, app: &mut App| app.viewport.ui(ui, &mut app.document);
    Harness::builder()
        .with_size(size)
        .with_max_steps(8)
        .renderer(WgpuTestRenderer::from_render_state(state))
        .build_ui_state(ui, app)
}

/// Steps until nothing asks for another frame.
pub fn rest(window: &mut Window<'_>) {
    std::thread::sleep(std::time::Duration::from_millis(180));
    for _ in 0..4000 {
        window.step();
        if window.state().viewport.at_rest() {
            return;
        }
    }
    panic!("the viewport never comes to rest");
}

pub fn shoot(window: &mut Window<'_>, name: &str) {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    window.render().unwrap().save(folder.join(format!("{name}.png"))).unwrap();
}

#[test]
fn comes_to_rest_in_final_quality_and_then_does_nothing() {
    let mut window = open(two_lumps(), vec2(160.0, 90.0));
    rest(&mut window);
    let statistics = window.state().viewport.statistics().clone();
    assert_eq!((statistics.quality, statistics.rays, statistics.resolution), ("final", 2, [160, 90]));
    for _ in 0..5 {
        window.step();
    }
    assert_eq!(window.state().viewport.statistics().pictures, statistics.pictures);
    assert_eq!(window.state().viewport.statistics().light_updates, statistics.light_updates);
    shoot(&mut window, "rest");
}
