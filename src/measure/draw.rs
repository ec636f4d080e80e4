//! Pictures of the renderer, as they are held against references.

use crate::{
    Result,
    export::Picture,
    gpu::Gpu,
    render::{Film, Frame, Renderer},
    scene::{Scene, Tone, ToneCurve},
};

const HDR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A renderer of the light of clouds alone: path traced pictures have no air before them.
pub fn renderer(gpu: &Gpu) -> Renderer {
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, HDR);
    renderer.settings.aerial = false;
    renderer
}

/// The clouds of `scene` without background.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn clouds(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, film: Film) -> Result<Picture> {
    film.take(gpu, renderer, &film.frame(scene)?, false, &mut |_| ())
}

/// The same by single rays that are as thin as can be: no detail is left out, and no step is
/// lengthened, because a pixel would not show it.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn thin_rays(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, size: [u32; 2]) -> Result<Picture> {
    let film = Film::new(size, 1);
    let mut frame = film.frame(scene)?;
    frame.camera.pixel *= 1e-3;
    film.take(gpu, renderer, &frame, false, &mut |_| ())
}

/// The sky of `scene` without clouds.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn sky(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, size: [u32; 2]) -> Result<Picture> {
    renderer.sky_picture(gpu, &Frame::new(scene, size)?)
}

/// `clouds` over `sky` as a screen shows them, RGBA of 8 bits: by the scene's own exposure and one curve, so
/// that errors compare with those of earlier versions, whatever the default is.
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
    let tone = Tone { stops: scene.exposure, curve: ToneCurve::Filmic };
    composed.finished(gpu, renderer, tone)
}
