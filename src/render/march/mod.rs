//! What is seen: the pass that marches clouds, one draw a cloud, far ones first, over tiles that the
//! cloud can touch.

mod counts;
mod crossings;
mod parts;
mod shelves;
mod tiles;
mod variant;
pub(super) mod voxels;

use std::{collections::HashMap, ops::Range};

use glam::{Vec3, Vec4};
use wgpu::{BindGroup, TextureView};

pub(super) use counts::Counters;
pub use counts::Counts;
#[cfg(test)]
pub(crate) use crossings::CELL as CROSSING_CELL;
pub(super) use crossings::{Crossings, Touching};
pub(super) use parts::Parts;
#[cfg(test)]
pub(crate) use tiles::Tile;
pub(super) use tiles::{Cover, MANY, Seen};

use crossings::Visibilities;
use shelves::{Groups, Layouts, Shelves};
pub use variant::Variant;
pub(super) use variant::{EVERYTHING, MATTE, PLACES, VISIBILITY};
use variant::{is_lit, pipeline, variant};

use super::{
    SceneDepth, Settings, Transport,
    light::{Binding, CloudLight, LightStore},
    medium::Media,
    shadow::Shadows,
    sky::Sky,
};
use crate::{
    frame::{
        CameraUniform, CloudFrame, Frame, LitBy, Shared,
        medium::{MediumKind, Species, SpeciesTextures},
    },
    gpu::{self, Shader, Shelf},
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
    pub crossings: &'a Crossings,
    pub counters: &'a Counters,
    pub entry: &'static str,
    pub format: wgpu::TextureFormat,
    /// Whether the light comes on top of what is there.
    pub adds: bool,
    /// Whether each cloud is drawn into a picture of its own, too.
    pub mattes: bool,
}

impl View<'_> {
    /// The map by which others shade a cloud, where its light is looked for.
    fn shade(&self, number: usize) -> Option<(wgpu::Buffer, TextureView)> {
        is_lit(self.entry).then(|| self.shadows.on(number)).flatten()
    }
}

/// A cloud ready to be drawn.
#[derive(Clone)]
pub(super) struct Draw {
    pipeline: wgpu::RenderPipeline,
    /// From this one of its tiles on it crosses others.
    crossing: Option<(u32, wgpu::RenderPipeline)>,
    groups: Groups,
    /// Where the cloud's numbers lie, bytes.
    offset: u32,
    medium: BindGroup,
    /// Where the model has any.
    light: Option<BindGroup>,
    /// The first of its tiles among all.
    first: u32,
    pub tiles: u32,
}

impl Draw {
    /// Records one piece of it after `before`, whose state the pass has: only what differs is set.
    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>, tiles: Range<u32>, before: Option<&Self>) {
        let same = |is: &dyn Fn(&Self) -> bool| before.is_some_and(is);
        if !same(&|before| before.crossing.is_none() && before.pipeline == self.pipeline) {
            pass.set_pipeline(&self.pipeline);
        }
        pass.set_bind_group(0, &self.groups.own, &[self.offset]);
        if !same(&|before| before.medium == self.medium) {
            pass.set_bind_group(1, &self.medium, &[]);
        }
        if let Some(light) = &self.light
            && !same(&|before| before.light.as_ref() == Some(light))
        {
            pass.set_bind_group(2, light, &[]);
        }
        if !same(&|before| before.groups.vertices == self.groups.vertices) {
            pass.set_bind_group(3, &self.groups.vertices, &[]);
        }
        let crossing =
            self.crossing.as_ref().map_or(tiles.end, |(from, _)| (*from).clamp(tiles.start, tiles.end));
        if tiles.start < crossing {
            pass.draw(0..4, self.first + tiles.start..self.first + crossing);
        }
        if let Some((_, pipeline)) = self.crossing.as_ref().filter(|_| crossing < tiles.end) {
            pass.set_pipeline(pipeline);
            pass.draw(0..4, self.first + crossing..self.first + tiles.end);
        }
    }
}

/// Pipelines of the march, compiled when first needed.
pub(super) struct March {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// By medium, model of light, and whether a map shades the cloud.
    shaders: HashMap<(MediumKind, Transport, bool), Shader>,
    pipelines: HashMap<(Variant, wgpu::TextureFormat), wgpu::RenderPipeline>,
    /// What each call of a picture binds, in order.
    shelves: Vec<Shelves>,
    calls: usize,
    /// How often what is bound was filled anew.
    pub filled: u64,
    /// Tables of models of light.
    tables: HashMap<Transport, Vec<TextureView>>,
    /// Of the species of clouds drawn lately.
    species: Vec<(Shared<Species>, SpeciesTextures)>,
    linear: wgpu::Sampler,
    no_depth: TextureView,
    dark: TextureView,
    visibilities: Visibilities,
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
            shelves: Vec::new(),
            calls: 0,
            filled: 0,
            tables: HashMap::new(),
            species: Vec::new(),
            linear: gpu::linear_clamp(device),
            no_depth: gpu::view(&gpu::texture(device, &NO_DEPTH)),
            visibilities: Visibilities::new(device, 0),
            dark: gpu::view(&gpu::half_texture(device, queue, "dark", [1; 3], &[Default::default()])),
        }
    }

    /// Begins another picture.
    pub fn begin(&mut self) {
        self.calls = 0;
    }

    /// Makes room for the visibilities of these crossings.
    pub fn make_room(&mut self, crossings: &Crossings) {
        self.visibilities.make_room(&self.device, crossings);
    }

    /// Records that none of them is known.
    pub fn clear_visibilities(&self, encoder: &mut wgpu::CommandEncoder, crossings: &Crossings) {
        self.visibilities.clear(encoder, crossings);
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
        let Some(&first) = seen.first() else { return Vec::new() };
        let uniforms: Vec<_> = seen.iter().map(|&i| uniform(shared, &frame.clouds[i])).collect();
        let covers: Vec<_> =
            seen.iter().map(|&i| shared.crossings.of(i).map_or(&covers[i], |own| &own.cover)).collect();
        // Group 0 is the same whatever fills the roles, but for the map that shades.
        let mut layout = |number: usize, group: usize| {
            let variant = variant(shared, number, media.kind(&frame.clouds[number].medium), false);
            self.compiled(&variant, shared.format);
            let layouts = &self.shaders[&key(&variant)].groups;
            layouts.get(group).and_then(Clone::clone).expect("the march declares groups 0 and 3")
        };
        let of_vertices = layout(first, 3);
        let own = [false, true].map(|shaded| {
            let one = seen.iter().find(|&&i| shared.shade(i).is_some() == shaded);
            one.map(|&number| layout(number, 0))
        });
        let layouts = Layouts { own, of_vertices };
        if self.shelves.len() == self.calls {
            self.shelves.push(Shelves::default());
        }
        let shelves = &mut self.shelves[self.calls];
        self.calls += 1;
        self.filled += 1;
        let (firsts, buffers) = shelves.fill(&self.device, &self.queue, shared, &uniforms, &covers);
        let own = (&self.no_depth, self.visibilities.buffer(), &self.linear);
        let groups = shelves.groups(&self.device, shared, &layouts, buffers, &seen, own);
        let draw = |(place, &i): (usize, &usize)| {
            let light = lights.get(i).expect("those without light were left out");
            let medium = &frame.clouds[i].medium;
            let (pipeline, light) = self.lit(shared, i, media.kind(medium), light);
            let kind = media.kind(medium);
            let (offset, medium) = (Shelf::offset(place), media.group(medium).clone());
            let (mut first, mut tiles) = (firsts[place], covers[place].tiles.len() as u32);
            let mut crossing = None;
            if let Some(crossed) = shared.crossings.of(i) {
                if shared.entry == VISIBILITY {
                    (first, tiles) = (first + crossed.alone, tiles - crossed.alone);
                } else {
                    let pipeline = self.compiled(&variant(shared, i, kind, true), shared.format);
                    crossing = Some((crossed.alone, pipeline));
                }
            }
            let groups = groups[place].clone();
            (i, Draw { pipeline, crossing, groups, offset, medium, light, first, tiles })
        };
        seen.iter().enumerate().map(draw).collect()
    }

    /// The pipeline of a variant, compiled where it is not there.
    fn compiled(&mut self, variant: &Variant, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
        if let Some(known) = self.pipelines.get(&(*variant, format)) {
            return known.clone();
        }
        let new = || Shader::new(&self.device, "march", &variant.roles());
        let shader = self.shaders.entry(key(variant)).or_insert_with(new);
        let made = pipeline(&self.device, shader, variant, format);
        self.pipelines.insert((*variant, format), made.clone());
        made
    }

    /// The pipeline of a cloud, and the group of its light where the model has any.
    fn lit(
        &mut self,
        shared: &View<'_>,
        number: usize,
        kind: MediumKind,
        light: &mut CloudLight,
    ) -> (wgpu::RenderPipeline, Option<BindGroup>) {
        let cloud = &shared.frame.clouds[number];
        let variant = variant(shared, number, kind, false);
        let pipeline = self.compiled(&variant, shared.format);
        let transport = variant.transport;
        if let Some(known) = light.bound(transport) {
            return (pipeline, Some(known.clone()));
        }
        let Some(layout) = self.shaders[&key(&variant)].groups.get(2).and_then(Option::as_ref) else {
            return (pipeline, None);
        };
        let (device, queue) = (&self.device, &self.queue);
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
        (pipeline, Some(light.group(&binding, cloud).clone()))
    }

    /// What has been compiled so far.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        self.pipelines.keys().map(|(variant, _)| variant)
    }
}

/// What decides about a shader's text.
fn key(variant: &Variant) -> (MediumKind, Transport, bool) {
    (variant.medium, variant.transport, variant.shaded)
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
