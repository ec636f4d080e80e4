//! Sunlight through a cloud: the volume of optical depth to the sun, and the maps of the cloud as the
//! sun sees it.

use std::collections::HashMap;

use glam::Vec3;
use wgpu::TextureView;

use super::{boxes::LightBox, bricks::Bricks, inputs::Inputs};
use crate::{
    frame::{
        Shared,
        medium::{Medium, MediumKind},
    },
    gpu::{self, ComputeProgram, TextureDesc},
};

/// What a volume in a light box depends on.
#[derive(Clone, PartialEq)]
pub(super) struct BoxKey {
    pub medium: Shared<Medium>,
    pub light_box: LightBox,
    pub voxels: [u32; 3],
}

impl BoxKey {
    pub fn new(medium: &Shared<Medium>, along: Vec3, resolution: u32) -> Self {
        let light_box = LightBox::around(medium, along, resolution);
        Self { medium: medium.clone(), voxels: light_box.voxels(resolution), light_box }
    }
}

/// What the sun's volume and maps depend on.
#[derive(Clone, PartialEq)]
pub(super) struct SunKey {
    pub of: BoxKey,
    /// Whether anything reads the maps.
    pub mapped: bool,
    /// Other clouds before it.
    pub shades: Vec<Shade>,
}

/// A cloud that stands before another.
#[derive(Clone, PartialEq)]
pub(super) struct Shade {
    pub of: BoxKey,
    /// Its origin in the frame of the other, m.
    pub offset: Vec3,
}

/// Optical depth to the sun, its part in the shadow of other clouds, and that of the cloud alone, in a box along the
/// light; maps of depths and normals.
#[derive(Clone)]
pub(super) struct SunVolume {
    pub volume: TextureView,
    pub maps: Option<[TextureView; 2]>,
}

impl SunVolume {
    /// Without any sun, as behind a wall.
    pub fn dark(inputs: &Inputs<'_>) -> Self {
        let wall = [half::f16::MAX, half::f16::ZERO, half::f16::ZERO, half::f16::ZERO];
        let texture = gpu::half_texture(inputs.device, inputs.queue, "no sun", [1; 3], &[wall]);
        Self { volume: gpu::view(&texture), maps: None }
    }

    pub fn textures(&self) -> impl Iterator<Item = &TextureView> {
        [&self.volume].into_iter().chain(self.maps.iter().flatten())
    }
}

/// The programs, compiled when first needed.
#[derive(Default)]
pub(super) struct SunPass {
    /// By medium, with maps or without.
    volumes: HashMap<(MediumKind, bool), ComputeProgram>,
    maps: Option<MapsPass>,
    /// Of the first cloud before another, and of those after it.
    shades: [Option<ComputeProgram>; 2],
    linear: Option<wgpu::Sampler>,
}

impl SunPass {
    /// The volume and the maps of a cloud alone.
    pub fn make(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        key: &BoxKey,
        mapped: bool,
    ) -> SunVolume {
        let device = inputs.device;
        let BoxKey { medium, light_box, voxels } = key;
        let resolution = voxels[0];
        let volume = gpu::view(&volume(device, "sun volume", *voxels));
        let map_resolution = if mapped { resolution } else { 1 };
        let depths = map(device, "sun depths", map_resolution);
        let kind = inputs.media.kind(medium);
        let program = self.volumes.entry((kind, mapped)).or_insert_with(|| {
            let overrides = [("MAPPED", f64::from(u8::from(mapped)))];
            ComputeProgram::with_roles(device, "sun_maps", &[kind.role()], &overrides)
        });
        let bricks = Bricks::of(light_box, medium, *voxels);
        let uniform = gpu::uniform_buffer(device, "light box", light_box);
        let buffers = [
            gpu::storage_buffer(device, "bricks", &bricks.lists),
            gpu::storage_buffer(device, "ellipsoids of bricks", &bricks.candidates),
        ];
        let depths_0 = gpu::mip(&depths, 0);
        let mut resources = vec![Some(uniform.as_entire_binding())];
        resources.extend(buffers.iter().map(|buffer| Some(buffer.as_entire_binding())));
        resources.extend([&volume, &depths_0].map(|view| Some(wgpu::BindingResource::TextureView(view))));
        let group = program.bind(device, &resources);
        let stamps = inputs.timing.and_then(|timing| timing.compute("sun maps"));
        program.dispatch_over(
            encoder,
            &[&group, inputs.media.group(medium)],
            [resolution, resolution, 1],
            stamps,
        );
        let maps = mapped.then(|| {
            let pass = self.maps.get_or_insert_with(|| MapsPass::new(device));
            pass.finish(encoder, inputs, &uniform, depths)
        });
        SunVolume { volume, maps }
    }

    /// The volume of a cloud in the shadow of all that `key` tells of, whose volumes `others` are in that order.
    pub fn shade(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        key: &SunKey,
        alone: &TextureView,
        others: &[TextureView],
    ) -> TextureView {
        let device = inputs.device;
        let linear = self.linear.get_or_insert_with(|| gpu::linear_clamp(device));
        let BoxKey { light_box, voxels, .. } = &key.of;
        let own = gpu::uniform_buffer(device, "light box", light_box);
        let mut before = alone.clone();
        for (i, (shade, other)) in key.shades.iter().zip(others).enumerate() {
            let program = self.shades[usize::from(i > 0)].get_or_insert_with(|| {
                ComputeProgram::new(device, "sun_shade", &[("FIRST", f64::from(u8::from(i == 0)))])
            });
            let volume = gpu::view(&volume(device, "sun volume", *voxels));
            let moved = shade.of.light_box.moved(shade.offset);
            let other_box = gpu::uniform_buffer(device, "light box of another", &moved);
            let texture = |view| Some(wgpu::BindingResource::TextureView(view));
            let resources = [
                Some(own.as_entire_binding()),
                Some(other_box.as_entire_binding()),
                texture(&before),
                texture(other),
                Some(wgpu::BindingResource::Sampler(linear)),
                texture(&volume),
            ];
            let group = program.bind(device, &resources);
            let stamps = inputs.timing.and_then(|timing| timing.compute("sun maps"));
            program.dispatch_over(encoder, &[&group], [voxels[0], voxels[1], 1], stamps);
            before = volume;
        }
        before
    }
}

/// Normals from depths, and the mips of both.
struct MapsPass {
    normals: ComputeProgram,
    mips: ComputeProgram,
}

impl MapsPass {
    fn new(device: &wgpu::Device) -> Self {
        let program = |name| ComputeProgram::new(device, name, &[]);
        Self { normals: program("sun_normals"), mips: program("mips") }
    }

    fn finish(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        light_box: &wgpu::Buffer,
        depths: wgpu::Texture,
    ) -> [TextureView; 2] {
        let device = inputs.device;
        let normals = map(device, "sun normals", depths.width());
        let views = [&depths, &normals].map(|map| gpu::mip(map, 0));
        let mut resources = vec![Some(light_box.as_entire_binding())];
        resources.extend(views.iter().map(|view| Some(wgpu::BindingResource::TextureView(view))));
        let group = self.normals.bind(device, &resources);
        let texels = [depths.width(), depths.height(), 1];
        let stamps = inputs.timing.and_then(|timing| timing.compute("sun maps"));
        self.normals.dispatch_over(encoder, &[&group], texels, stamps);
        for map in [&depths, &normals] {
            self.fill_mips(encoder, inputs, map);
        }
        [gpu::view(&depths), gpu::view(&normals)]
    }

    fn fill_mips(&self, encoder: &mut wgpu::CommandEncoder, inputs: &Inputs<'_>, map: &wgpu::Texture) {
        for mip in 1..map.mip_level_count() {
            let views = [mip - 1, mip].map(|mip| gpu::mip(map, mip));
            let resources = views.each_ref().map(|view| Some(wgpu::BindingResource::TextureView(view)));
            let group = self.mips.bind(inputs.device, &resources);
            let texels = (map.width() >> mip).max(1);
            let stamps = inputs.timing.and_then(|timing| timing.compute("sun maps"));
            self.mips.dispatch_over(encoder, &[&group], [texels, texels, 1], stamps);
        }
    }
}

/// A volume that shaders fill.
pub(super) fn volume(device: &wgpu::Device, label: &str, size: [u32; 3]) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::STORAGE_BINDING;
    gpu::texture(
        device,
        &TextureDesc { label, size, mips: 1, format: wgpu::TextureFormat::Rgba16Float, usage },
    )
}

fn map(device: &wgpu::Device, label: &str, resolution: u32) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::STORAGE_BINDING;
    let (size, mips) = ([resolution, resolution, 0], resolution.ilog2() + 1);
    gpu::texture(device, &TextureDesc { label, size, mips, format: wgpu::TextureFormat::Rgba16Float, usage })
}
