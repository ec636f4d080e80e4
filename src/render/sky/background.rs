//! The pipelines that draw the sky behind everything: one for each kind of sky and target.

use wgpu::TextureFormat;

use crate::gpu;

/// The background's pipeline, of one kind of sky, into one kind of target.
pub(super) struct Background {
    pub kind: BackgroundKind,
    pub format: TextureFormat,
    pub pipeline: wgpu::RenderPipeline,
    pub group: wgpu::BindGroup,
}

/// What is compiled in.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct BackgroundKind {
    pub atmosphere: bool,
    pub sun_disc: bool,
}

pub(super) fn background_pipeline(
    device: &wgpu::Device,
    format: TextureFormat,
    kind: BackgroundKind,
) -> wgpu::RenderPipeline {
    let overrides = [("ATMOSPHERE", f64::from(kind.atmosphere)), ("SUN_DISC", f64::from(kind.sun_disc))];
    gpu::screen_pipeline(device, "sky", &overrides, format)
}
