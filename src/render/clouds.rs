//! The pass that marches clouds: one draw a cloud, far ones first, over tiles that the
//! cloud can touch.

use std::{collections::HashMap, sync::Arc};

use glam::Vec3;

use super::{
    CameraUniform, Quality, SceneDepth, Transport,
    frame::{CloudFrame, Frame},
    light::CloudLight,
    light_box::LightBox,
    moments::FieldBox,
    optics::{CloudOptics, OpticsTextures},
    slab_textures::SlabTextures,
    stats::Counters,
    tiles::Cover,
};
use crate::gpu::{self, Pack, Place};

/// `Cloud` of `shaders/clouds.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CloudUniform {
    pub(super) camera: Vec3,
    pub(super) chop: f32,
    pub(super) to_sun: Vec3,
    pub(super) asymmetry: f32,
    pub(super) sun_irradiance: Vec3,
    pub(super) albedo: f32,
    pub(super) base: f32,
    pub(super) top: f32,
    pub(super) mean_free_path: f32,
    pub(super) aerial_range: f32,
    pub(super) first_step: f32,
    pub(super) growth: f32,
    pub(super) opaque: f32,
    pub(super) longest_step: f32,
    pub(super) lit_at_once: f32,
    pub(super) sun_radius: f32,
    pub(super) similarity: f32,
    pub(super) padding: f32,
    pub(super) scene_depth: [f32; 4],
    pub(super) degrees: [f32; 4],
    pub(super) field_low: Vec3,
    pub(super) padding_low: f32,
    pub(super) field_scale: Vec3,
    pub(super) padding_scale: f32,
    pub(super) sun: LightBox,
    pub(super) sky: LightBox,
}

/// What a variant of the shader is compiled for; all else is compiled out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    pub entry: &'static str,
    pub counting: bool,
    pub atmosphere: bool,
    pub aerial: bool,
    pub sky_light: bool,
    pub scene_depth: bool,
    pub transport: Transport,
    pub direct_table: bool,
    pub peak: bool,
    pub normals: bool,
    pub absorbing: bool,
    pub light_nodes: u32,
    pub max_steps: u32,
}

impl Variant {
    pub fn overrides(&self) -> [(&'static str, f64); 12] {
        let flag = |on: bool| f64::from(u8::from(on));
        [
            ("COUNTING", flag(self.counting)),
            ("ATMOSPHERE", flag(self.atmosphere)),
            ("AERIAL", flag(self.aerial)),
            ("SKY_LIGHT", flag(self.sky_light)),
            ("SCENE_DEPTH", flag(self.scene_depth)),
            ("TRANSPORT", f64::from(self.transport as u8)),
            ("DIRECT_TABLE", flag(self.direct_table)),
            ("PEAK", flag(self.peak)),
            ("NORMALS", flag(self.normals)),
            ("ABSORBING", flag(self.absorbing)),
            ("LIGHT_NODES", f64::from(self.light_nodes)),
            ("MAX_STEPS", f64::from(self.max_steps)),
        ]
    }
}

/// What every cloud of a frame binds.
pub(super) struct Shared<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub frame: &'a Frame,
    pub quality: &'a Quality,
    pub transport: Transport,
    pub camera: wgpu::Buffer,
    pub noise_volume: &'a wgpu::TextureView,
    pub repeat: &'a wgpu::Sampler,
    pub clamped: &'a wgpu::Sampler,
    pub transmittance: &'a wgpu::TextureView,
    pub sky_light: &'a wgpu::TextureView,
    pub aerial: &'a wgpu::TextureView,
    pub aerial_range: f32,
    pub air: &'a wgpu::Buffer,
    pub depth: Option<&'a SceneDepth<'a>>,
    pub no_depth: &'a wgpu::TextureView,
    pub counters: &'a Counters,
    pub counting: bool,
    pub atmosphere: bool,
    pub air_before_clouds: bool,
    pub lit_by_sky: bool,
    pub slab: &'a SlabTextures,
}

/// A cloud in the picture: it has tiles.
pub(super) struct Seen<'a> {
    pub cloud: &'a CloudFrame,
    pub light: &'a CloudLight,
    pub cover: &'a Cover,
}

/// What the shader knows of a cloud beside textures, in the buffer of all clouds.
struct Packed {
    uniform: Place,
    ellipsoids: Place,
    tiles: Place,
    candidates: Place,
    noise: Place,
}

impl Packed {
    fn new(pack: &mut Pack, shared: &Shared<'_>, Seen { cloud, light, cover }: &Seen<'_>) -> Self {
        Self {
            uniform: pack.add(&[uniform(shared, cloud, light)]),
            ellipsoids: pack.add(&cloud.ellipsoids),
            tiles: pack.add(&cover.tiles),
            candidates: pack.add(&cover.candidates),
            noise: pack.add(&[cloud.noise]),
        }
    }
}

/// A cloud ready to be drawn.
pub(super) struct Draw {
    variant: Variant,
    group: wgpu::BindGroup,
    pub tiles: u32,
}

/// Pipelines of the shader, compiled when first needed.
pub(super) struct CloudsPass {
    module: wgpu::ShaderModule,
    pipelines: HashMap<(Variant, wgpu::TextureFormat), wgpu::RenderPipeline>,
    /// Of the optics of clouds drawn lately.
    optics: Vec<(Arc<CloudOptics>, OpticsTextures)>,
}

/// Most optics that are kept; a scene may have more, which then wait for nothing but time.
const MOST_OPTICS: usize = 32;

impl CloudsPass {
    pub fn new(device: &wgpu::Device) -> Self {
        Self { module: gpu::shader_module(device, "clouds"), pipelines: HashMap::new(), optics: Vec::new() }
    }

    /// Compiles what is missing and binds `clouds` for `entry`.
    pub fn prepare(
        &mut self,
        shared: &Shared<'_>,
        clouds: &[Seen<'_>],
        entry: &'static str,
        format: wgpu::TextureFormat,
    ) -> Vec<Draw> {
        if clouds.is_empty() {
            return Vec::new();
        }
        let mut pack = Pack::default();
        let packed: Vec<_> = clouds.iter().map(|seen| Packed::new(&mut pack, shared, seen)).collect();
        let buffer = pack.buffer(shared.device, "clouds");
        let bound = |(seen, packed): (&Seen<'_>, Packed)| {
            let variant = variant(shared, seen.cloud, entry);
            let pipeline = self
                .pipelines
                .entry((variant, format))
                .or_insert_with(|| pipeline(shared.device, &self.module, &variant, format));
            let layout = pipeline.get_bind_group_layout(0);
            let optics = self.textures(shared, &seen.cloud.optics);
            let group = bind(shared, seen.light, optics, &buffer, packed, &layout);
            Draw { variant, group, tiles: seen.cover.tiles.len() as u32 }
        };
        clouds.iter().zip(packed).map(bound).collect()
    }

    /// What has been compiled so far.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        self.pipelines.keys().map(|(variant, _)| variant)
    }

    /// The tables of `optics` on the device, uploaded when first needed.
    fn textures(&mut self, shared: &Shared<'_>, optics: &Arc<CloudOptics>) -> &OpticsTextures {
        let place =
            self.optics.iter().position(|(known, _)| Arc::ptr_eq(known, optics)).unwrap_or_else(|| {
                self.optics.truncate(MOST_OPTICS - 1);
                self.optics.insert(0, (optics.clone(), optics.upload(shared.device, shared.queue)));
                0
            });
        &self.optics[place].1
    }

    /// Records one piece of a draw.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        format: wgpu::TextureFormat,
        draw: &Draw,
        tiles: std::ops::Range<u32>,
    ) {
        let Some(pipeline) = self.pipelines.get(&(draw.variant, format)) else { return };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &draw.group, &[]);
        pass.draw(0..4, tiles);
    }
}

fn variant(shared: &Shared<'_>, cloud: &CloudFrame, entry: &'static str) -> Variant {
    // Which way a cloud faces has nothing to do with light.
    let lit = entry != "normals";
    let emits = lit && shared.transport == Transport::Emitter;
    Variant {
        entry,
        counting: shared.counting || entry == "cost",
        atmosphere: shared.atmosphere,
        aerial: shared.atmosphere && shared.air_before_clouds,
        sky_light: lit && shared.lit_by_sky,
        scene_depth: shared.depth.is_some(),
        transport: if lit { shared.transport } else { Transport::Single },
        direct_table: lit && shared.slab.is_direct(),
        peak: lit && !emits && cloud.optics.chop > 0.0,
        normals: !lit,
        absorbing: cloud.optics.albedo < 1.0,
        light_nodes: shared.quality.light_nodes.clamp(1, MOST_NODES),
        max_steps: shared.quality.max_steps,
    }
}

/// Room for light nodes in the shader.
pub(super) const MOST_NODES: u32 = 8;

fn uniform(shared: &Shared<'_>, cloud: &CloudFrame, light: &CloudLight) -> CloudUniform {
    let frame = shared.frame;
    let optics = &cloud.optics;
    let ground = frame.scene.ground.altitude;
    let nowhere = FieldBox { low: Vec3::ZERO, extent: Vec3::ONE };
    let field = light.moments.as_ref().map_or(nowhere, |moments| moments.field_box);
    let densest = cloud.ellipsoids.iter().fold(1e-6f32, |most, e| most.max(e.extinction));
    // An emitter scatters nothing: it has no peak to leave out.
    let emits = shared.transport == Transport::Emitter;
    let chop = if emits { 0.0 } else { optics.chop };
    CloudUniform {
        camera: (frame.camera_position - cloud.origin).as_vec3(),
        chop,
        to_sun: frame.to_sun.as_vec3(),
        asymmetry: optics.asymmetry,
        sun_irradiance: Vec3::from(frame.scene.sun.irradiance.map(|x| x as f32)),
        albedo: if emits { optics.whole_albedo() } else { optics.albedo },
        base: (cloud.origin.y - cloud.half.y - ground) as f32,
        top: (cloud.origin.y + cloud.half.y - ground) as f32,
        mean_free_path: 1.0 / (densest * (1.0 - chop)),
        aerial_range: shared.aerial_range,
        first_step: shared.quality.first_step,
        growth: shared.quality.growth,
        opaque: shared.quality.opaque,
        longest_step: shared.quality.longest_step,
        lit_at_once: shared.quality.lit_at_once,
        sun_radius: if frame.camera.projection == CameraUniform::ORTHOGRAPHIC {
            0.0
        } else {
            // A point is drawn as a disc too: it must not read as none.
            ((0.5 * frame.scene.sun.angular_diameter_deg.to_radians()) as f32).max(1e-6)
        },
        similarity: optics.similarity,
        padding: 0.0,
        degrees: optics.degrees,
        scene_depth: shared.depth.map_or([0.0; 4], |depth| depth.coefficients(&frame.camera)),
        field_low: field.low,
        padding_low: 0.0,
        field_scale: field.extent.recip(),
        padding_scale: 0.0,
        sun: light.sun_box,
        sky: light.sky_box,
    }
}

fn bind(
    shared: &Shared<'_>,
    light: &CloudLight,
    optics: &OpticsTextures,
    buffer: &wgpu::Buffer,
    packed: Packed,
    layout: &wgpu::BindGroupLayout,
) -> wgpu::BindGroup {
    let texture = |view| Some(wgpu::BindingResource::TextureView(view));
    let moments = light.moments.as_ref();
    let volume = moments.map(|moments| &moments.sun).or(shared.slab.volume());
    let angles = moments.map(|_| &optics.beyond).or(shared.slab.angles());
    let planes = shared.slab.planes().unwrap_or([&optics.remainder; 4]);
    gpu::bind_group(
        shared.device,
        "cloud",
        layout,
        &[
            Some(shared.camera.as_entire_binding()),
            Some(packed.uniform.binding(buffer)),
            Some(packed.ellipsoids.binding(buffer)),
            Some(packed.tiles.binding(buffer)),
            Some(packed.candidates.binding(buffer)),
            Some(packed.noise.binding(buffer)),
            texture(shared.noise_volume),
            Some(wgpu::BindingResource::Sampler(shared.repeat)),
            Some(wgpu::BindingResource::Sampler(shared.clamped)),
            texture(&optics.phase),
            texture(&light.sun_volume),
            texture(&light.sun_depths),
            texture(&light.sun_normals),
            texture(moments.map_or(&light.sky_volume, |moments| &moments.sky)),
            texture(shared.transmittance),
            texture(shared.sky_light),
            texture(shared.aerial),
            texture(shared.depth.map_or(shared.no_depth, |depth| depth.view)),
            Some(shared.air.as_entire_binding()),
            Some(shared.counters.buffer().as_entire_binding()),
            texture(volume.unwrap_or(shared.noise_volume)),
            texture(angles.unwrap_or(&optics.remainder)),
            texture(planes[0]),
            texture(planes[1]),
            texture(planes[2]),
            texture(planes[3]),
        ],
    )
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    variant: &Variant,
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let overrides = variant.overrides();
    let options = || wgpu::PipelineCompilationOptions {
        constants: &overrides,
        zero_initialize_workgroup_memory: false,
    };
    let target = Some(wgpu::ColorTargetState {
        format,
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    });
    let targets = vec![target; if variant.entry == "layers" { 4 } else { 1 }];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("clouds"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("quad"),
            compilation_options: options(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(variant.entry),
            compilation_options: options(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
