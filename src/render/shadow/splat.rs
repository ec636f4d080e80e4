//! The pass that draws clouds into the map of the sun's light.

use wgpu::TextureView;

use super::{
    SQUARES, ShadowInputs,
    casters::Caster,
    layout::{ENDLESS, LAYERS, Layout, SunMapUniform},
};
use crate::{
    gpu::{self, Pack, Shader, Strips, strip_pipeline},
    render::light::LightBox,
};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// `Caster` of `shaders/sun_map.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CasterUniform {
    pub(crate) light_box: LightBox,
    pub(crate) tiles: f32,
    pub(crate) turning: f32,
    padding: [f32; 2],
}

pub(super) struct Splat {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    linear: wgpu::Sampler,
}

impl Splat {
    pub fn new(device: &wgpu::Device) -> Self {
        let shader = Shader::new(device, "sun_map", &[]);
        let layout = shader.groups[0].clone().expect("the shader declares group 0");
        Self { pipeline: pipeline(device, &shader), layout, linear: gpu::linear_clamp(device) }
    }

    /// Draws all `casters` into a map of this `layout`, whose places `uniform` tells from the camera: into the texture
    /// that is there where it has the right size.
    pub fn draw(
        &self,
        inputs: &ShadowInputs<'_>,
        encoder: &mut wgpu::CommandEncoder,
        layout: &Layout,
        uniform: &SunMapUniform,
        casters: &[Caster],
        lit: &mut Option<wgpu::Texture>,
    ) -> TextureView {
        let device = inputs.device;
        let eye = inputs.frame.camera_position;
        // Level, whatever way the square leans.
        let reach = ENDLESS / inputs.frame.sun.to_sun.y;
        let tiles = |caster: &Caster| caster.light_box.tiles(reach);
        let mut pack = Pack::default();
        let map = pack.add(std::slice::from_ref(uniform));
        let boxes: Vec<_> = casters
            .iter()
            .map(|caster| {
                pack.add(&[CasterUniform {
                    light_box: caster.light_box.moved((caster.origin - eye).as_vec3()),
                    tiles: tiles(caster) as f32,
                    turning: caster.turning,
                    padding: [0.0; 2],
                }])
            })
            .collect();
        let buffer = pack.buffer(device, "sun map of clouds");
        let groups: Vec<_> = casters
            .iter()
            .zip(boxes)
            .map(|(caster, light_box)| {
                let resources = [
                    Some(map.binding(&buffer)),
                    Some(light_box.binding(&buffer)),
                    Some(wgpu::BindingResource::TextureView(&caster.volume)),
                    Some(wgpu::BindingResource::Sampler(&self.linear)),
                ];
                gpu::bind_group(device, "sun map", &self.layout, &resources)
            })
            .collect();
        let known = lit.take().filter(|lit| lit.width() == layout.texels);
        let lit = lit.insert(known.unwrap_or_else(|| lit_texture(device, layout.texels)));
        for square in 0..layout.squares.len() as u32 {
            let mut pass = begin(encoder, lit, square, inputs);
            pass.set_pipeline(&self.pipeline);
            for (group, caster) in groups.iter().zip(casters) {
                pass.set_bind_group(0, group, &[]);
                pass.draw(4 * square..4 * square + 4, 0..tiles(caster).pow(2));
            }
        }
        view_of(lit)
    }
}

/// Begins a pass over the layers of a `square`, all lit.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    lit: &wgpu::Texture,
    square: u32,
    inputs: &ShadowInputs<'_>,
) -> wgpu::RenderPass<'a> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store };
    let layer = |i: usize| {
        lit.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: LAYERS as u32 * square + i as u32,
            array_layer_count: Some(1),
            ..Default::default()
        })
    };
    let layers: [TextureView; LAYERS] = std::array::from_fn(layer);
    let attachment =
        |view| Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("sun map"),
        color_attachments: &layers.each_ref().map(attachment),
        timestamp_writes: inputs.timing.and_then(|timing| timing.render("sun map")),
        ..Default::default()
    })
}

/// Shares of light, four planes a texel, layer by layer.
pub(super) fn lit_texture(device: &wgpu::Device, texels: u32) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("sun map"),
        size: wgpu::Extent3d {
            width: texels,
            height: texels,
            depth_or_array_layers: (SQUARES * LAYERS) as u32,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

/// All layers of it.
pub(super) fn view_of(lit: &wgpu::Texture) -> TextureView {
    let dimension = Some(wgpu::TextureViewDimension::D2Array);
    lit.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}

/// What a cloud lets through multiplies what others did.
fn pipeline(device: &wgpu::Device, shader: &Shader) -> wgpu::RenderPipeline {
    let times = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    };
    let target = Some(wgpu::ColorTargetState {
        format: FORMAT,
        blend: Some(wgpu::BlendState { color: times, alpha: times }),
        write_mask: wgpu::ColorWrites::ALL,
    });
    let targets = &vec![target; LAYERS];
    let strips = Strips { label: "sun map", entries: ["footprint", "light"], overrides: &[], targets };
    strip_pipeline(device, shader, &strips)
}
