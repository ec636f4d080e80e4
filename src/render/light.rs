//! Light inside a cloud, prepared in the cloud's own frame: sun maps and the volume of
//! optical depth to the sun, and the volume of openness to sky and ground. Redone only
//! when the sun, the shape or the noise changed.

use glam::{DVec3, Vec3};

use super::{ellipsoids::EllipsoidUniform, frame::CloudFrame, noise::NoiseFrame};
use crate::gpu::{self, ComputeProgram, TextureDesc, Timing};

/// `LightBox` of `shaders/lib/light_box.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightBox {
    pub(super) corner: Vec3,
    pub(super) size_x: f32,
    pub(super) across_x: Vec3,
    pub(super) size_y: f32,
    pub(super) across_y: Vec3,
    pub(super) size_z: f32,
    pub(super) along: Vec3,
    pub(super) before: f32,
    pub(super) own: u32,
    pub(super) all: u32,
    pub(super) chop: f32,
    pub(super) asymmetry: f32,
}

impl LightBox {
    /// The tightest box around the first `own` ellipsoids with columns along `along`,
    /// square across, one texel of `resolution` wider; the other ellipsoids cast shadows.
    fn new(ellipsoids: &[EllipsoidUniform], own: usize, along: DVec3, resolution: u32) -> Self {
        let along = along.as_vec3();
        let across_x = along.any_orthonormal_vector();
        let across_y = along.cross(across_x);
        let (mine, others) = ellipsoids.split_at(own);
        let [x, y, z] = [across_x, across_y, along].map(|axis| extent(mine, axis));
        let texel = (x.1 - x.0).max(y.1 - y.0) / (resolution - 2) as f32;
        let across = texel * resolution as f32;
        let middle = [x, y].map(|(low, high)| 0.5 * (low + high - across));
        let start = z.0 - texel;
        let before = start - extent(others, along).0;
        Self {
            corner: middle[0] * across_x + middle[1] * across_y + start * along,
            size_x: across,
            across_x,
            size_y: across,
            across_y,
            size_z: z.1 - z.0 + 2.0 * texel,
            along,
            before: before.max(0.0),
            own: own as u32,
            all: ellipsoids.len() as u32,
            chop: 0.0,
            asymmetry: 0.0,
        }
    }

    fn voxels(&self, resolution: u32) -> [u32; 3] {
        let along = (self.size_z / self.size_x * resolution as f32).ceil() as u32;
        [resolution, resolution, along.clamp(4, 2 * resolution)]
    }
}

fn extent(ellipsoids: &[EllipsoidUniform], axis: Vec3) -> (f32, f32) {
    ellipsoids.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), e| {
        let (center, half) = (e.center.dot(axis), e.support(axis));
        (low.min(center - half), high.max(center + half))
    })
}

/// The programs that prepare light.
pub(super) struct LightPass {
    sun_maps: ComputeProgram,
    sun_normals: ComputeProgram,
    sky_volume: ComputeProgram,
    mips: ComputeProgram,
}

/// What a cloud's light depends on.
#[derive(Clone, PartialEq)]
struct Key {
    ellipsoids: Vec<EllipsoidUniform>,
    noise: NoiseFrame,
    seed: u32,
    light_box: LightBox,
}

/// The prepared light of one cloud.
pub(super) struct CloudLight {
    /// Width of a voxel of the sun's volume, m.
    pub voxel: f32,
    pub sun_box: LightBox,
    pub sky_box: LightBox,
    pub sun_volume: wgpu::TextureView,
    pub sun_depths: wgpu::TextureView,
    pub sun_normals: wgpu::TextureView,
    pub sky_volume: wgpu::TextureView,
    sun_key: Key,
    sky_key: Option<Key>,
}

/// What the passes share.
pub(super) struct Inputs<'a> {
    pub device: &'a wgpu::Device,
    pub noise_volume: &'a wgpu::TextureView,
    pub repeat: &'a wgpu::Sampler,
    pub seed: u32,
    pub to_sun: DVec3,
    pub resolution: u32,
    pub sky_light: bool,
    pub timing: Option<&'a Timing>,
}

impl LightPass {
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            sun_maps: ComputeProgram::new(device, "sun_maps", &[]),
            sun_normals: ComputeProgram::new(device, "sun_normals", &[]),
            sky_volume: ComputeProgram::new(device, "sky_volume", &[]),
            mips: ComputeProgram::new(device, "mips", &[]),
        }
    }

    /// Light for `cloud`, taken over from `before` where nothing it depends on changed.
    /// Counts the volumes that were redone in `redone`.
    pub fn prepare(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        cloud: &CloudFrame,
        before: Option<CloudLight>,
        redone: &mut u32,
    ) -> CloudLight {
        let sun_key = key(inputs, cloud, -inputs.to_sun, inputs.resolution);
        let sky_resolution = (inputs.resolution / 2).clamp(8, 48);
        let sky_key = inputs.sky_light.then(|| key(inputs, cloud, DVec3::NEG_Y, sky_resolution));
        let (mut sun, mut sky) = (None, None);
        if let Some(before) = before {
            if before.sun_key == sun_key {
                sun = Some((before.sun_volume, before.sun_depths, before.sun_normals));
            }
            if before.sky_key == sky_key {
                sky = Some(before.sky_volume);
            }
        }
        let (sun_volume, sun_depths, sun_normals) = sun.unwrap_or_else(|| {
            *redone += 1;
            self.sun(encoder, inputs, &sun_key)
        });
        let sky_volume = sky.unwrap_or_else(|| match &sky_key {
            Some(sky_key) => {
                *redone += 1;
                self.sky(encoder, inputs, sky_key, sky_resolution)
            }
            None => view(&volume(inputs.device, "no sky volume", [1, 1, 1])),
        });
        CloudLight {
            voxel: sun_key.light_box.size_x / inputs.resolution as f32,
            sun_box: sun_key.light_box,
            sky_box: sky_key.as_ref().map_or(sun_key.light_box, |key| key.light_box),
            sun_volume,
            sun_depths,
            sun_normals,
            sky_volume,
            sun_key,
            sky_key,
        }
    }

    fn sun(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        key: &Key,
    ) -> (wgpu::TextureView, wgpu::TextureView, wgpu::TextureView) {
        let device = inputs.device;
        let voxels = key.light_box.voxels(inputs.resolution);
        let sun_volume = view(&volume(device, "sun volume", voxels));
        let [depths, normals] =
            ["sun depths", "sun normals"].map(|label| map(device, label, inputs.resolution));
        let [depths_0, normals_0] = [&depths, &normals].map(|map| level(map, 0));
        let buffers = Buffers::new(inputs, key);
        let mut resources = buffers.bindings(inputs);
        resources.extend([&sun_volume, &depths_0].map(texture));
        let group = self.sun_maps.bind(device, &resources);
        let groups = inputs.resolution.div_ceil(8);
        let stamps = || inputs.timing.and_then(|timing| timing.compute("sun maps"));
        self.sun_maps.dispatch(encoder, &group, [groups, groups, 1], stamps());
        let resources =
            [Some(buffers.light_box.as_entire_binding()), texture(&depths_0), texture(&normals_0)];
        let group = self.sun_normals.bind(device, &resources);
        self.sun_normals.dispatch(encoder, &group, [groups, groups, 1], stamps());
        for map in [&depths, &normals] {
            self.fill_mips(encoder, inputs, map);
        }
        (sun_volume, view(&depths), view(&normals))
    }

    fn sky(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        key: &Key,
        resolution: u32,
    ) -> wgpu::TextureView {
        let sky_volume = view(&volume(inputs.device, "sky volume", key.light_box.voxels(resolution)));
        let buffers = Buffers::new(inputs, key);
        let mut resources = buffers.bindings(inputs);
        resources.push(texture(&sky_volume));
        let group = self.sky_volume.bind(inputs.device, &resources);
        let groups = resolution.div_ceil(8);
        let stamps = inputs.timing.and_then(|timing| timing.compute("sky volume"));
        self.sky_volume.dispatch(encoder, &group, [groups, groups, 1], stamps);
        sky_volume
    }

    fn fill_mips(&self, encoder: &mut wgpu::CommandEncoder, inputs: &Inputs<'_>, map: &wgpu::Texture) {
        for mip in 1..map.mip_level_count() {
            let [source, target] = [mip - 1, mip].map(|mip| level(map, mip));
            let resources = [&source, &target].map(texture);
            let group = self.mips.bind(inputs.device, &resources);
            let groups = (map.width() >> mip).max(1).div_ceil(8);
            let stamps = inputs.timing.and_then(|timing| timing.compute("sun maps"));
            self.mips.dispatch(encoder, &group, [groups, groups, 1], stamps);
        }
    }
}

fn key(inputs: &Inputs<'_>, cloud: &CloudFrame, along: DVec3, resolution: u32) -> Key {
    let ellipsoids = cloud.with_occluders(along);
    let mut light_box = LightBox::new(&ellipsoids, cloud.ellipsoids.len(), along, resolution);
    light_box.chop = cloud.optics.chop;
    light_box.asymmetry = cloud.optics.asymmetry;
    Key { ellipsoids, noise: cloud.noise, seed: inputs.seed, light_box }
}

struct Buffers {
    light_box: wgpu::Buffer,
    ellipsoids: wgpu::Buffer,
    noise: wgpu::Buffer,
}

impl Buffers {
    fn new(inputs: &Inputs<'_>, key: &Key) -> Self {
        Self {
            light_box: gpu::uniform_buffer(inputs.device, "light box", &key.light_box),
            ellipsoids: gpu::storage_buffer(inputs.device, "ellipsoids and occluders", &key.ellipsoids),
            noise: gpu::uniform_buffer(inputs.device, "noise frame", &key.noise),
        }
    }

    fn bindings<'a>(&'a self, inputs: &'a Inputs<'_>) -> Vec<Option<wgpu::BindingResource<'a>>> {
        vec![
            Some(self.light_box.as_entire_binding()),
            Some(self.ellipsoids.as_entire_binding()),
            Some(self.noise.as_entire_binding()),
            Some(wgpu::BindingResource::TextureView(inputs.noise_volume)),
            Some(wgpu::BindingResource::Sampler(inputs.repeat)),
        ]
    }
}

fn volume(device: &wgpu::Device, label: &str, size: [u32; 3]) -> wgpu::Texture {
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

fn texture(view: &wgpu::TextureView) -> Option<wgpu::BindingResource<'_>> {
    Some(wgpu::BindingResource::TextureView(view))
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

fn level(texture: &wgpu::Texture, mip: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        base_mip_level: mip,
        mip_level_count: Some(1),
        ..Default::default()
    })
}
