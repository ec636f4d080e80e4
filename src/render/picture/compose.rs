//! From scene-referred light to the screen.

use crate::{
    gpu,
    scene::{Tone, ToneCurve},
};

/// `Compose` of `shaders/compose.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ComposeUniform {
    pub(crate) exposure: f32,
    pub(crate) curve: u32,
    pub(crate) padding: [f32; 2],
}

/// Factor at 0 stops: the sunlit side of a thick cloud, about 0.25 of the sun's
/// irradiance per steradian, comes out just below white.
pub(super) const BASE: f64 = 6.0;

impl ComposeUniform {
    /// For a tone.
    pub fn new(tone: Tone) -> Self {
        let curve = match tone.curve {
            ToneCurve::Filmic => 0,
            ToneCurve::Soft => 1,
            ToneCurve::Linear => 2,
            ToneCurve::Natural => 3,
            ToneCurve::Photo => 4,
        };
        Self { exposure: (BASE * tone.stops.exp2()) as f32, curve, padding: [0.0; 2] }
    }
}

/// The pass that finishes a picture for a screen.
pub(super) struct Compose {
    pipeline: wgpu::RenderPipeline,
}

impl Compose {
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        Self { pipeline: gpu::screen_pipeline(device, ("compose", &[]), &[], format) }
    }

    pub fn draw(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        picture: &wgpu::TextureView,
        target: &wgpu::TextureView,
        tone: Tone,
    ) {
        let uniform = gpu::uniform_buffer(device, "compose", &ComposeUniform::new(tone));
        let layout = self.pipeline.get_bind_group_layout(0);
        let resources =
            [Some(uniform.as_entire_binding()), Some(wgpu::BindingResource::TextureView(picture))];
        let group = gpu::bind_group(device, "compose", &layout, &resources);
        gpu::draw_screen(encoder, "compose", &self.pipeline, &group, target);
    }
}
