//! Small pictures for tests.

use nephos::{
    export::Picture,
    render::{Frame, Quality, Renderer, Target, Transport},
    scene::Scene,
};

use super::gpu;

/// A renderer on the device of the tests.
pub fn renderer(quality: Quality, transport: Transport) -> Renderer {
    let mut renderer = Renderer::new(&gpu().device, &gpu().queue, wgpu::TextureFormat::Rgba16Float);
    renderer.settings.quality = quality;
    renderer.settings.transport = transport;
    renderer
}

/// Linear, premultiplied pixels of a scene; without the sky behind the clouds where `sky` is false.
pub fn draw(renderer: &mut Renderer, scene: &Scene, size: [u32; 2], sky: bool) -> Picture {
    let frame = Frame::new(scene, size).expect("the scene is valid");
    let texture = renderer.picture("test", size, wgpu::TextureFormat::Rgba16Float);
    let view = texture.create_view(&Default::default());
    let target = Target { color: &view, depth: None, sky };
    renderer.render_in_pieces(gpu(), &frame, &target, &mut |_| ()).expect("the device works");
    Picture::read(gpu(), &texture).expect("the device works")
}

/// A scene from JSON.
pub fn scene(text: &str) -> Scene {
    Scene::from_json(text).expect("the scene is valid")
}
