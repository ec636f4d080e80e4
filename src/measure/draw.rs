//! Pictures of the renderer, as they are held against references.

use crate::{
    Result,
    export::Picture,
    gpu::Gpu,
    render::{Frame, Quality, Renderer, Target},
    scene::Scene,
};

const HDR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A renderer of the light of clouds alone: path traced pictures have no air before them.
pub fn renderer(gpu: &Gpu) -> Renderer {
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, HDR);
    renderer.settings.aerial = false;
    renderer
}

/// Rays across a pixel, as `nephos render` takes them: 2 for what is kept, else 1.
pub fn rays_across(quality: &Quality) -> u32 {
    if *quality == Quality::FINAL { 2 } else { 1 }
}

/// The clouds of `scene` without background, squares of `rays` by `rays` rays averaged.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn clouds(
    gpu: &Gpu,
    renderer: &mut Renderer,
    scene: &Scene,
    size: [u32; 2],
    rays: u32,
) -> Result<Picture> {
    let frame = Frame::new(scene, size.map(|n| n * rays))?;
    Ok(drawn(gpu, renderer, &frame)?.reduced(rays as usize))
}

/// The same by single rays that are as thin as can be: no detail is left out, and no step is
/// lengthened, because a pixel would not show it.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn thin_rays(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, size: [u32; 2]) -> Result<Picture> {
    let mut frame = Frame::new(scene, size)?;
    frame.camera.pixel *= 1e-3;
    drawn(gpu, renderer, &frame)
}

fn drawn(gpu: &Gpu, renderer: &mut Renderer, frame: &Frame) -> Result<Picture> {
    let texture = renderer.picture("drawn", frame.size(), HDR);
    let view = texture.create_view(&Default::default());
    let target = Target { color: &view, depth: None, sky: false };
    renderer.render_in_pieces(gpu, frame, &target, &mut |_| ())?;
    Picture::read(gpu, &texture)
}

/// The sky of `scene` without clouds.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn sky(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, size: [u32; 2]) -> Result<Picture> {
    let frame = Frame::new(scene, size)?;
    let texture = renderer.picture("sky", size, HDR);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.render_sky(&mut encoder, &frame, &texture.create_view(&Default::default()));
    gpu.queue.submit([encoder.finish()]);
    Picture::read(gpu, &texture)
}

/// `clouds` over `sky` as a screen shows them, RGBA of 8 bits.
///
/// # Errors
/// Where the device fails.
pub fn finished(
    gpu: &Gpu,
    renderer: &mut Renderer,
    scene: &Scene,
    clouds: &Picture,
    sky: &Picture,
) -> Result<Vec<u8>> {
    let mut composed = clouds.clone();
    composed.put_over(sky);
    composed.finished(gpu, renderer, scene.tone())
}
