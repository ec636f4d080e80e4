//! What is seen: the pass that marches clouds, one draw a cloud, far ones first, over tiles that the
//! cloud can touch.

mod counts;
mod tiles;
mod variant;
pub(super) mod voxels;

use std::{collections::HashMap, ops::Range};

use glam::{Vec3, Vec4};
use wgpu::{BindGroup, TextureView};

pub(super) use counts::Counters;
pub use counts::Counts;
#[cfg(test)]
pub(crate) use tiles::Tile;
pub(super) use tiles::{Cover, MANY};

pub use variant::Variant;
use variant::{pipeline, variant};

use super::{
    SceneDepth, Settings, Transport,
    light::{Binding, LightStore},
    medium::Media,
    shadow::Shadows,
    sky::Sky,
};
use crate::{
    frame::{
        CameraUniform, CloudFrame, Frame, LitBy, Shared,
        medium::{Species, SpeciesTextures},
    },
    gpu::{self, Pack, Place, Shader},
    scene::MAX_LIGHTS,
};

/// `Cloud` of `shaders/march.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CloudUniform {
    pub(crate) camera: Vec3,
    pub(crate) opaque: f32,
    pub(crate) to_sun: Vec3,
    pub(crate) sun_radius: f32,
    pub(crate) sun_irradiance: Vec3,
    pub(crate) aerial_range: f32,
    pub(crate) base: f32,
    pub(crate) top: f32,
    pub(crate) first_step: f32,
    pub(crate) longest_step: f32,
    pub(crate) growth: f32,
    pub(crate) lit_at_once: f32,
    pub(crate) shadow_range: f32,
    pub(crate) curvature: f32,
    pub(crate) scene_depth: [f32; 4],
    pub(crate) moons: [Vec4; MAX_LIGHTS],
}

/// What every cloud of a picture binds.
pub(super) struct View<'a> {
    pub frame: &'a Frame,
    pub settings: &'a Settings,
    pub depth: Option<&'a SceneDepth<'a>>,
    pub sky: &'a Sky,
    pub shadows: &'a Shadows,
    pub counters: &'a Counters,
    pub entry: &'static str,
    pub format: wgpu::TextureFormat,
    /// Whether the light comes on top of what is there.
    pub adds: bool,
}

/// What the march knows of a cloud in one picture, in the buffer of all clouds.
struct Packed {
    uniform: Place,
    tiles: Place,
    candidates: Place,
}

/// A cloud ready to be drawn.
pub(super) struct Draw {
    pipeline: wgpu::RenderPipeline,
    /// By number: the march's own, the medium's, the light's where the model has any, the vertices'.
    groups: Vec<(u32, BindGroup)>,
    pub tiles: u32,
}

impl Draw {
    /// Records one piece of it.
    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>, tiles: Range<u32>) {
        pass.set_pipeline(&self.pipeline);
        for (index, group) in &self.groups {
            pass.set_bind_group(*index, group, &[]);
        }
        pass.draw(0..4, tiles);
    }
}

/// Pipelines of the march, compiled when first needed.
pub(super) struct March {
    device: wgpu::Device,
    queue: wgpu::Queue,
    shaders: HashMap<(&'static str, Transport), Shader>,
    pipelines: HashMap<(Variant, wgpu::TextureFormat), wgpu::RenderPipeline>,
    /// Tables of models of light.
    tables: HashMap<Transport, Vec<TextureView>>,
    /// Of the species of clouds drawn lately.
    species: Vec<(Shared<Species>, SpeciesTextures)>,
    linear: wgpu::Sampler,
    no_depth: TextureView,
    dark: TextureView,
}

/// Most species that are kept; a scene may have more, which then wait for nothing but time.
const MOST_SPECIES: usize = 32;
/// Room for light nodes in the shader.
pub(crate) const MOST_NODES: u32 = 8;

impl March {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            device: device.clone(),
            queue: queue.clone(),
            shaders: HashMap::new(),
            pipelines: HashMap::new(),
            tables: HashMap::new(),
            species: Vec::new(),
            linear: gpu::linear_clamp(device),
            no_depth: gpu::view(&gpu::texture(device, &NO_DEPTH)),
            dark: gpu::view(&gpu::half_texture(device, queue, "dark", [1; 3], &[Default::default()])),
        }
    }

    /// Compiles what is missing and binds those `clouds`, by number, that have tiles, each with its number; those that
    /// wait for their first light are left out, and told.
    pub fn prepare(
        &mut self,
        shared: &View<'_>,
        clouds: &[usize],
        covers: &[Cover],
        media: &Media,
        lights: &mut LightStore,
    ) -> Vec<(usize, Draw)> {
        let frame = shared.frame;
        let in_view = clouds.iter().copied().filter(|&i| !covers[i].tiles.is_empty());
        let (seen, dark): (Vec<usize>, Vec<usize>) = in_view.partition(|&i| lights.get(i).is_some());
        if !dark.is_empty() {
            tracing::debug!(clouds = ?dark, "not drawn before they have light");
        }
        if seen.is_empty() {
            return Vec::new();
        }
        let mut pack = Pack::default();
        let pack_cloud = |&i: &usize| Packed {
            uniform: pack.add(&[uniform(shared, &frame.clouds[i])]),
            tiles: pack.add(&covers[i].tiles),
            candidates: pack.add(&covers[i].candidates),
        };
        let packed: Vec<_> = seen.iter().map(pack_cloud).collect();
        let camera = frame.camera.jittered(shared.settings.quality.jitter);
        let camera = gpu::uniform_buffer(&self.device, "camera", &camera);
        let buffers = [&camera, &pack.buffer(&self.device, "clouds")];
        let draw = |(&i, packed): (&usize, Packed)| {
            let light = lights.get(i).expect("those without light were left out");
            (i, self.draw_of(shared, i, buffers, packed, &covers[i], media, light))
        };
        seen.iter().zip(packed).map(draw).collect()
    }

    #[allow(clippy::too_many_arguments, reason = "a cloud, where it is in the picture, and its light")]
    fn draw_of(
        &mut self,
        shared: &View<'_>,
        number: usize,
        buffers: [&wgpu::Buffer; 2],
        packed: Packed,
        cover: &Cover,
        media: &Media,
        light: &mut super::light::CloudLight,
    ) -> Draw {
        let cloud = &shared.frame.clouds[number];
        let role = media.role(&cloud.medium);
        let variant = variant(shared, number, role);
        let transport = variant.transport;
        let (device, queue) = (&self.device, &self.queue);
        let key = (role.1, transport);
        let shader =
            self.shaders.entry(key).or_insert_with(|| Shader::new(device, "march", &variant.roles()));
        let pipeline = self
            .pipelines
            .entry((variant, shared.format))
            .or_insert_with(|| pipeline(device, shader, &variant, shared.format))
            .clone();
        let layouts = &self.shaders[&key].groups;
        let layout = |group: usize| layouts.get(group).and_then(Option::as_ref);
        let its_own = |group| layout(group).expect("the march declares groups 0 and 3");
        let mut groups = vec![
            (0, self.own_group(shared, number, its_own(0), buffers, packed)),
            (1, media.group(&cloud.medium).clone()),
            (3, self.vertex_group(shared, its_own(3))),
        ];
        if let Some(layout) = layout(2) {
            let tables = self.tables.entry(transport).or_insert_with(|| {
                (transport.0.tables)(device, queue).expect("a test decodes all embedded tables")
            });
            let place = species_place(&mut self.species, &cloud.medium.species, device, queue);
            let binding = Binding {
                device,
                transport,
                layout,
                species: &self.species[place].1,
                tables,
                linear: &self.linear,
                dark: &self.dark,
            };
            groups.push((2, light.group(&binding, cloud).clone()));
        }
        Draw { pipeline, groups, tiles: cover.tiles.len() as u32 }
    }

    /// Group 3: what light reaches the cloud's base and top.
    fn vertex_group(&self, shared: &View<'_>, layout: &wgpu::BindGroupLayout) -> BindGroup {
        let texture = |view| Some(wgpu::BindingResource::TextureView(view));
        let resources = [shared.sky.transmittance(), shared.sky.sky_light()].map(texture);
        gpu::bind_group(&self.device, "lights of the march", layout, &resources)
    }

    /// Group 0.
    fn own_group(
        &self,
        shared: &View<'_>,
        number: usize,
        layout: &wgpu::BindGroupLayout,
        [camera, clouds]: [&wgpu::Buffer; 2],
        packed: Packed,
    ) -> BindGroup {
        let sky = shared.sky;
        let texture = |view| Some(wgpu::BindingResource::TextureView(view));
        let [shade_map, shade] = shared.shadows.on(number);
        let resources = [
            Some(camera.as_entire_binding()),
            Some(packed.uniform.binding(clouds)),
            Some(packed.tiles.binding(clouds)),
            Some(packed.candidates.binding(clouds)),
            Some(sky.atmosphere().as_entire_binding()),
            Some(shared.counters.buffer().as_entire_binding()),
            Some(wgpu::BindingResource::Sampler(&self.linear)),
            texture(sky.aerial()),
            texture(shared.depth.map_or(&self.no_depth, |depth| depth.view)),
            texture(shared.shadows.air()),
            Some(shade_map),
            Some(shade),
        ];
        gpu::bind_group(&self.device, "march", layout, &resources)
    }

    /// What has been compiled so far.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        self.pipelines.keys().map(|(variant, _)| variant)
    }
}

/// Stands in where the caller drew nothing; the shader doesn't read it.
const NO_DEPTH: gpu::TextureDesc<'static> = gpu::TextureDesc {
    label: "no depth",
    size: [1, 1, 0],
    mips: 1,
    format: wgpu::TextureFormat::Depth32Float,
    usage: wgpu::TextureUsages::empty(),
};

/// Where the tables of a species are on the device, uploaded when first needed.
fn species_place(
    kept: &mut Vec<(Shared<Species>, SpeciesTextures)>,
    species: &Shared<Species>,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
) -> usize {
    kept.iter().position(|(known, _)| known.is(species)).unwrap_or_else(|| {
        kept.truncate(MOST_SPECIES - 1);
        kept.insert(0, (species.clone(), species.upload(device, queue)));
        0
    })
}

/// Half the curvature of the earth that a cloud is seen over, 1/m: none for those that end, and none where
/// lines of sight are parallel.
fn curvature(frame: &Frame, cloud: &CloudFrame) -> f32 {
    if cloud.medium.layer.is_none() || frame.camera.projection == CameraUniform::ORTHOGRAPHIC {
        return 0.0;
    }
    0.5 / frame.sky.uniform.atmosphere.ground_radius
}

/// Radius of a light's disc, rad; 0 where the sky shows none.
fn disc_radius(frame: &Frame, radius: f32) -> f32 {
    // A point is drawn as a disc too: it must not read as none.
    if frame.camera.projection == CameraUniform::ORTHOGRAPHIC { 0.0 } else { radius.max(1e-6) }
}

/// Lights beside the sun that have discs: unit vectors to them, and radii, rad.
fn moons(frame: &Frame) -> [Vec4; MAX_LIGHTS] {
    let mut moons = [Vec4::ZERO; MAX_LIGHTS];
    let discs = frame.lights().iter().filter(|light| light.by == LitBy::Sky);
    for (moon, light) in moons.iter_mut().zip(discs) {
        *moon = light.sun.to_sun.as_vec3().extend(disc_radius(frame, light.sun.radius));
    }
    moons
}

fn uniform(shared: &View<'_>, cloud: &CloudFrame) -> CloudUniform {
    let (frame, quality) = (shared.frame, &shared.settings.quality);
    CloudUniform {
        camera: (frame.camera_position - cloud.origin).as_vec3(),
        opaque: quality.opaque,
        to_sun: frame.sun.to_sun.as_vec3(),
        sun_radius: disc_radius(frame, frame.sun.radius),
        sun_irradiance: frame.sun.irradiance,
        aerial_range: shared.sky.aerial_range(),
        base: (cloud.origin.y - cloud.half.y - frame.ground) as f32,
        top: (cloud.origin.y + cloud.half.y - frame.ground) as f32,
        first_step: quality.first_step,
        longest_step: quality.longest_step,
        growth: quality.growth,
        lit_at_once: quality.lit_at_once,
        shadow_range: shared.shadows.reach(),
        curvature: curvature(frame, cloud),
        scene_depth: shared.depth.map_or([0.0; 4], |depth| depth.coefficients(&frame.camera)),
        moons: moons(frame),
    }
}
