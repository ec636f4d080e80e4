//! STUB
use super::CameraUniform;
use crate::gpu::{self, *};
use half::f16;
pub struct SkySettings;
impl SkySettings {
    pub fn new(_: &crate::scene::Scene, _: glam::DVec3) -> Self {
        Self
    }
}
pub struct Sky {
    t: wgpu::TextureView,
    l: wgpu::TextureView,
    a: wgpu::TextureView,
    b: wgpu::Buffer,
}
impl Sky {
    pub fn new(device: &wgpu::Device) -> Self {
        let tex = |size| {
            gpu::texture(
                device,
                &TextureDesc {
                    label: "x",
                    size,
                    mips: 1,
                    format: wgpu::TextureFormat::Rgba16Float,
                    usage: wgpu::TextureUsages::empty(),
                },
            )
        };
        Self {
            t: tex([1, 1, 0]).create_view(&Default::default()),
            l: tex([3, 1, 0]).create_view(&Default::default()),
            a: tex([1, 1, 1]).create_view(&Default::default()),
            b: gpu::uniform_buffer(device, "a", &[1.0f32; 4]),
        }
    }
    pub fn prepare(
        &mut self,
        d: &wgpu::Device,
        q: &wgpu::Queue,
        _: &mut wgpu::CommandEncoder,
        _: &SkySettings,
        _: &CameraUniform,
        _: Option<&Timing>,
    ) -> u32 {
        let tex = |size: [u32; 3], v: &[[f32; 4]]| {
            let t = gpu::texture(
                d,
                &TextureDesc {
                    label: "x",
                    size,
                    mips: 1,
                    format: wgpu::TextureFormat::Rgba16Float,
                    usage: wgpu::TextureUsages::empty(),
                },
            );
            let h: Vec<[f16; 4]> = v.iter().map(|x| x.map(f16::from_f32)).collect();
            q.write_texture(
                t.as_image_copy(),
                bytemuck::cast_slice(&h),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(8 * size[0]),
                    rows_per_image: Some(1),
                },
                t.size(),
            );
            t.create_view(&Default::default())
        };
        self.l = tex([3, 1, 0], &[[0.05, 0.09, 0.17, 1.], [0.10, 0.13, 0.16, 1.], [0.04, 0.04, 0.035, 1.]]);
        self.t = tex([1, 1, 0], &[[0.9, 0.85, 0.8, 1.]]);
        self.a = tex([1, 1, 1], &[[0., 0., 0., 1.]]);
        0
    }
    pub fn draw(
        &self,
        _: &wgpu::Device,
        e: &mut wgpu::CommandEncoder,
        v: &wgpu::TextureView,
        _: wgpu::TextureFormat,
        _: Option<&Timing>,
    ) {
        e.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: v,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r: 0.04, g: 0.08, b: 0.18, a: 1.0 }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
    }
    pub fn transmittance(&self) -> &wgpu::TextureView {
        &self.t
    }
    pub fn sky_light(&self) -> &wgpu::TextureView {
        &self.l
    }
    pub fn aerial(&self) -> &wgpu::TextureView {
        &self.a
    }
    pub fn aerial_range(&self) -> f32 {
        1e5
    }
    pub fn atmosphere(&self) -> &wgpu::Buffer {
        &self.b
    }
    pub fn has_atmosphere(&self) -> bool {
        true
    }
    pub fn lights(&self) -> bool {
        true
    }
}
