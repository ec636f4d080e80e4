//! Small pictures for tests.

use std::sync::{Mutex, PoisonError};

use nephos::{
    export::Picture,
    render::{Film, Quality, Renderer, Settings, Transport},
    scene::Scene,
};

use super::gpu;

/// The same steps along rays, in light that costs little: for what has nothing to do with how fine light is.
pub const fn in_coarse_light(quality: Quality) -> Quality {
    Quality { light_resolution: 16, light_cells: 12, ..quality }
}

/// A renderer on the device of the tests.
pub fn renderer(quality: Quality, transport: Transport) -> Renderer {
    let mut renderer = Renderer::new(&gpu().device, &gpu().queue, wgpu::TextureFormat::Rgba16Float);
    renderer.settings.quality = quality;
    renderer.settings.transport = transport;
    renderer
}

/// Lends a renderer that others drew with, whose programs are compiled: where it is not asked what a renderer made.
pub fn lent<T>(quality: Quality, transport: Transport, draw: impl FnOnce(&mut Renderer) -> T) -> T {
    static IDLE: Mutex<Vec<Renderer>> = Mutex::new(Vec::new());
    let idle = || IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    let known = idle().pop();
    let mut renderer = known.unwrap_or_else(|| renderer(quality, transport));
    renderer.settings = Settings { quality, transport, ..Settings::default() };
    let drawn = draw(&mut renderer);
    idle().push(renderer);
    drawn
}

/// Linear, premultiplied pixels of a scene; without the sky behind the clouds where `sky` is false.
pub fn draw(renderer: &mut Renderer, scene: &Scene, size: [u32; 2], sky: bool) -> Picture {
    let film = Film::new(size, 1);
    let frame = film.frame(scene).expect("the scene is valid");
    film.take(gpu(), renderer, &frame, sky, &mut |_| ()).expect("the device works")
}

/// A scene from JSON.
pub fn scene(text: &str) -> Scene {
    Scene::from_json(text).expect("the scene is valid")
}
