//! What every module of a medium binds, and its groups for each.

use super::{
    BodyUniform, DepthVolume, DepthVolumeUniform, EllipsoidUniform, LayerUniform, TileTextures,
    VolumeTextures, VolumeUniform, mixed::Mixed,
};
use crate::gpu;

/// What every module of a medium binds: the bodies and the noise.
pub(crate) struct Common {
    bodies: wgpu::Buffer,
    noise_volume: wgpu::TextureView,
    repeat: wgpu::Sampler,
}

impl Common {
    pub fn new(device: &wgpu::Device, bodies: &[BodyUniform], noise_volume: wgpu::TextureView) -> Self {
        Self {
            bodies: gpu::storage_buffer(device, "bodies", bodies),
            noise_volume,
            repeat: gpu::linear_repeat(device),
        }
    }

    /// A group in which `first` is binding 0, what is here follows, then `rest`.
    fn group(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        first: &wgpu::Buffer,
        rest: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let mut resources: Vec<_> =
            [first, &self.bodies].map(|buffer| Some(buffer.as_entire_binding())).into();
        resources.push(Some(wgpu::BindingResource::TextureView(&self.noise_volume)));
        resources.push(Some(wgpu::BindingResource::Sampler(&self.repeat)));
        resources.extend(rest.iter().cloned().map(Some));
        gpu::bind_group(device, "medium", layout, &resources)
    }

    /// For `shaders/medium/ellipsoids.wgsl`.
    pub fn bind_ellipsoids(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        ellipsoids: &[EllipsoidUniform],
    ) -> wgpu::BindGroup {
        self.group(device, layout, &gpu::storage_buffer(device, "ellipsoids", ellipsoids), &[])
    }

    /// For `shaders/medium/layer.wgsl`.
    pub fn bind_layer(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        layer: &LayerUniform,
        tile: &TileTextures,
    ) -> wgpu::BindGroup {
        let rest = [wgpu::BindingResource::TextureView(&tile.field), tile.peaks.as_entire_binding()];
        self.group(device, layout, &gpu::uniform_buffer(device, "layer", layer), &rest)
    }

    /// For `shaders/medium/volume.wgsl`.
    pub fn bind_volume(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        volume: &VolumeUniform,
        textures: &VolumeTextures,
    ) -> wgpu::BindGroup {
        let sampler = gpu::linear_clamp_flat(device);
        let rest = [
            textures.index.as_entire_binding(),
            wgpu::BindingResource::TextureView(&textures.atlas),
            wgpu::BindingResource::Sampler(&sampler),
        ];
        self.group(device, layout, &gpu::uniform_buffer(device, "volume", volume), &rest)
    }

    /// For `shaders/medium/mixed.wgsl`.
    pub(super) fn bind_mixed(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        ellipsoids: &[EllipsoidUniform],
        mixed: &Mixed,
    ) -> wgpu::BindGroup {
        let sampler = gpu::linear_clamp_flat(device);
        let texture = |view| wgpu::BindingResource::TextureView(view);
        let rest = [
            mixed.uniform.as_entire_binding(),
            texture(&mixed.fields),
            texture(&mixed.index),
            texture(&mixed.atlas),
            wgpu::BindingResource::Sampler(&sampler),
            texture(&mixed.depths),
        ];
        self.group(device, layout, &gpu::storage_buffer(device, "ellipsoids", ellipsoids), &rest)
    }

    /// For `shaders/medium/depth_volume.wgsl`.
    pub fn bind_depths(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        volume: &DepthVolume,
        densest: f32,
    ) -> wgpu::BindGroup {
        let uniform = DepthVolumeUniform { core: densest, ..volume.uniform };
        let uniform = gpu::uniform_buffer(device, "depth volume", &uniform);
        let sampler = gpu::linear_clamp_flat(device);
        let rest = [
            volume.index.as_entire_binding(),
            wgpu::BindingResource::TextureView(&volume.atlas),
            wgpu::BindingResource::Sampler(&sampler),
        ];
        self.group(device, layout, &uniform, &rest)
    }
}
