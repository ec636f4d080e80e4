//! Small pictures for tests.

use nephos::{
    export::Picture,
    render::{Film, Quality, Renderer, Transport},
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
