//! Light inside a cloud, prepared in the cloud's own frame: sun maps and the volume of
//! optical depth to the sun, and the volume of openness to sky and ground. Redone only
//! when the sun, the shape or the noise changed.

use std::sync::Arc;

use glam::DVec3;

use super::{
    bricks::Bricks,
    ellipsoids::EllipsoidUniform,
    frame::CloudFrame,
    light_box::LightBox,
    light_plan::Detail,
    moments::{FieldBox, Lights, MomentsPass},
    noise::NoiseFrame,
    optics::CloudOptics,
    sky::Sky,
    sky_settings::SkySettings,
};
use crate::gpu::{self, ComputeProgram, TextureDesc, Timing};

/// The programs that prepare light.
pub(super) struct LightPass {
    /// Without the map, and with it.
    sun_maps: [Option<ComputeProgram>; 2],
    sun_normals: ComputeProgram,
    sky_volume: ComputeProgram,
    mips: ComputeProgram,
    moments: Option<MomentsPass>,
}

/// What a volume of optical depths depends on.
#[derive(Clone, PartialEq)]
struct Key {
    ellipsoids: Vec<EllipsoidUniform>,
    noise: NoiseFrame,
    seed: u32,
    light_box: LightBox,
    voxels: [u32; 3],
    /// Whether anything reads the map that is seen along the light.
    mapped: bool,
}

/// What fills a cloud, and on how many cells its light is solved for.
#[derive(Clone, PartialEq)]
struct Medium {
    ellipsoids: Vec<EllipsoidUniform>,
    noise: NoiseFrame,
    seed: u32,
    optics: Optics,
    cells: u32,
}

/// Optics, which clouds share: tables of thousands of numbers, compared only where they are not the
/// same ones.
#[derive(Clone)]
struct Optics(Arc<CloudOptics>);

impl PartialEq for Optics {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

/// What a cloud's light is made for; where that is the same, so is the light.
#[derive(Clone, PartialEq)]
pub(super) struct Wanted {
    sun: Key,
    sky: Option<Key>,
    /// Of the moments, where light is solved for; those of the sun depend on `sun`, too.
    medium: Option<Medium>,
    sky_medium: Option<(Medium, Option<SkySettings>)>,
}

impl Wanted {
    /// Light for `cloud` in the shadow of `others`.
    pub fn new(inputs: &Inputs<'_>, cloud: &CloudFrame, others: &[EllipsoidUniform], detail: Detail) -> Self {
        // What asks for no light gets the smallest.
        let resolution = if inputs.sunlit { detail.resolution } else { 16 };
        let sky_resolution = (resolution / 4).clamp(8, 32);
        let medium = |cells: u32| Medium {
            ellipsoids: cloud.ellipsoids.clone(),
            noise: cloud.noise,
            seed: inputs.seed,
            optics: Optics(cloud.optics.clone()),
            cells,
        };
        let coarse = || (medium((detail.cells / 2).max(8)), inputs.sky.settings());
        Self {
            sun: Key { mapped: inputs.mapped, ..key(inputs, cloud, others, -inputs.to_sun, resolution) },
            sky: inputs.openness.then(|| key(inputs, cloud, &[], DVec3::NEG_Y, sky_resolution)),
            medium: inputs.moments.then(|| medium(detail.cells)),
            sky_medium: (inputs.moments && inputs.lit_by_sky).then(coarse),
        }
    }
}

/// The prepared light of one cloud.
pub(super) struct CloudLight {
    pub sun_box: LightBox,
    pub sky_box: LightBox,
    pub sun_volume: wgpu::TextureView,
    pub sun_depths: wgpu::TextureView,
    pub sun_normals: wgpu::TextureView,
    pub sky_volume: wgpu::TextureView,
    pub moments: Option<CloudMoments>,
    made_for: Wanted,
}

impl CloudLight {
    /// Memory of its textures, bytes.
    pub fn bytes(&self) -> u64 {
        let moments = self.moments.iter().flat_map(|moments| [&moments.sun, &moments.sky]);
        let own = [&self.sun_volume, &self.sun_depths, &self.sun_normals, &self.sky_volume];
        own.into_iter().chain(moments).map(|view| bytes(view.texture())).sum()
    }

    /// Whether nothing that it depends on has changed.
    pub fn is(&self, wanted: &Wanted) -> bool {
        self.made_for == *wanted
    }

    /// Whether it has all the parts, if of another moment.
    pub fn stands_in_for(&self, wanted: &Wanted) -> bool {
        let parts = |w: &Wanted| [w.sky.is_some(), w.medium.is_some(), w.sky_medium.is_some()];
        parts(&self.made_for) == parts(wanted)
    }
}

/// The moments of a cloud's light, on grids in one box.
#[derive(Clone)]
pub(super) struct CloudMoments {
    pub field_box: FieldBox,
    pub sun: wgpu::TextureView,
    pub sky: wgpu::TextureView,
}

/// Moments that need not be solved for.
#[derive(Default)]
struct Solved {
    sun: Option<wgpu::TextureView>,
    sky: Option<wgpu::TextureView>,
}

/// What the passes share.
pub(super) struct Inputs<'a> {
    pub device: &'a wgpu::Device,
    pub noise_volume: &'a wgpu::TextureView,
    pub repeat: &'a wgpu::Sampler,
    pub seed: u32,
    pub to_sun: DVec3,
    /// Whether anything needs to know how open the cloud is.
    pub openness: bool,
    /// Whether light is solved for on a grid.
    pub moments: bool,
    /// Whether light is that of slabs, which are fitted to the map from the sun.
    pub mapped: bool,
    /// Whether anything asks for the light of the sun.
    pub sunlit: bool,
    pub lit_by_sky: bool,
    pub sky: &'a Sky,
    pub timing: Option<&'a Timing>,
}

impl LightPass {
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            sun_maps: [None, None],
            sun_normals: ComputeProgram::new(device, "sun_normals", &[]),
            sky_volume: ComputeProgram::new(device, "sky_volume", &[]),
            mips: ComputeProgram::new(device, "mips", &[]),
            moments: None,
        }
    }

    /// The light of `cloud` that is `wanted`, taken over from `before` where nothing it depends on
    /// changed. Counts the volumes that were redone in `redone`.
    pub fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        cloud: &CloudFrame,
        wanted: Wanted,
        before: Option<CloudLight>,
        redone: &mut u32,
    ) -> CloudLight {
        let (mut sun, mut sky) = (None, None);
        let mut known = Solved::default();
        if let Some(before) = before {
            let made_for = &before.made_for;
            if made_for.sky == wanted.sky {
                sky = Some(before.sky_volume);
            }
            if let Some(moments) = before.moments {
                let same = made_for.sun == wanted.sun && made_for.medium == wanted.medium;
                known.sun = same.then_some(moments.sun);
                known.sky = (made_for.sky_medium == wanted.sky_medium).then_some(moments.sky);
            }
            if made_for.sun == wanted.sun {
                sun = Some((before.sun_volume, before.sun_depths, before.sun_normals));
            }
        }
        let (sun_volume, sun_depths, sun_normals) = sun.unwrap_or_else(|| {
            *redone += 1;
            self.sun(encoder, inputs, &wanted.sun)
        });
        let sky_volume = sky.unwrap_or_else(|| match &wanted.sky {
            Some(sky_key) => {
                *redone += 1;
                self.sky(encoder, inputs, sky_key)
            }
            None => view(&volume(inputs.device, "no sky volume", [1, 1, 1])),
        });
        let moments = wanted.medium.as_ref().map(|medium| {
            self.moments(encoder, inputs, cloud, (&wanted, medium), &sun_volume, known, redone)
        });
        CloudLight {
            moments,
            sun_box: wanted.sun.light_box,
            sky_box: wanted.sky.as_ref().map_or(wanted.sun.light_box, |key| key.light_box),
            sun_volume,
            sun_depths,
            sun_normals,
            sky_volume,
            made_for: wanted,
        }
    }

    /// Moments of the light in `cloud`, but for those that are `known`.
    #[allow(clippy::too_many_arguments)]
    fn moments(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        cloud: &CloudFrame,
        (wanted, medium): (&Wanted, &Medium),
        sun_volume: &wgpu::TextureView,
        known: Solved,
        redone: &mut u32,
    ) -> CloudMoments {
        let pass = self.moments.get_or_insert_with(|| MomentsPass::new(inputs.device));
        let mut solve = |lights, cells| {
            *redone += 1;
            let sun = (&wanted.sun.light_box, wanted.sun.voxels, sun_volume);
            pass.solve(encoder, inputs, cloud, sun, lights, cells)
        };
        let sun = known.sun.unwrap_or_else(|| solve(Lights::Sun, medium.cells));
        let sky = known.sky.unwrap_or_else(|| match &wanted.sky_medium {
            Some((coarse, _)) => solve(Lights::Sky, coarse.cells),
            None => view(&volume(inputs.device, "no sky moments", [1, 1, 1])),
        });
        CloudMoments { field_box: FieldBox::new(&cloud.ellipsoids), sun, sky }
    }

    fn sun(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        key: &Key,
    ) -> (wgpu::TextureView, wgpu::TextureView, wgpu::TextureView) {
        let device = inputs.device;
        let resolution = key.voxels[0];
        let sun_volume = view(&volume(device, "sun volume", key.voxels));
        let map_resolution = if key.mapped { resolution } else { 1 };
        let [depths, normals] = ["sun depths", "sun normals"].map(|label| map(device, label, map_resolution));
        let [depths_0, normals_0] = [&depths, &normals].map(|map| level(map, 0));
        let buffers = Buffers::new(inputs, key);
        let mut resources = buffers.bindings(inputs);
        resources.extend([&sun_volume, &depths_0].map(texture));
        let overrides = [("MAPPED", f64::from(u8::from(key.mapped)))];
        let sun_maps = self.sun_maps[usize::from(key.mapped)]
            .get_or_insert_with(|| ComputeProgram::new(device, "sun_maps", &overrides));
        let group = sun_maps.bind(device, &resources);
        let texels = [resolution, resolution, 1];
        let stamps = || inputs.timing.and_then(|timing| timing.compute("sun maps"));
        sun_maps.dispatch_over(encoder, &group, texels, stamps());
        if key.mapped {
            let resources =
                [Some(buffers.light_box.as_entire_binding()), texture(&depths_0), texture(&normals_0)];
            let group = self.sun_normals.bind(device, &resources);
            self.sun_normals.dispatch_over(encoder, &group, texels, stamps());
            for map in [&depths, &normals] {
                self.fill_mips(encoder, inputs, map);
            }
        }
        (sun_volume, view(&depths), view(&normals))
    }

    fn sky(&self, encoder: &mut wgpu::CommandEncoder, inputs: &Inputs<'_>, key: &Key) -> wgpu::TextureView {
        let sky_volume = view(&volume(inputs.device, "sky volume", key.voxels));
        let buffers = Buffers::new(inputs, key);
        // The bindings of the sun maps, without those of the noise.
        let mut resources = buffers.bindings(inputs);
        resources[2..5].fill(None);
        resources.push(texture(&sky_volume));
        let group = self.sky_volume.bind(inputs.device, &resources);
        let stamps = inputs.timing.and_then(|timing| timing.compute("sky volume"));
        self.sky_volume.dispatch_over(encoder, &group, key.voxels, stamps);
        sky_volume
    }

    fn fill_mips(&self, encoder: &mut wgpu::CommandEncoder, inputs: &Inputs<'_>, map: &wgpu::Texture) {
        for mip in 1..map.mip_level_count() {
            let [source, target] = [mip - 1, mip].map(|mip| level(map, mip));
            let resources = [&source, &target].map(texture);
            let group = self.mips.bind(inputs.device, &resources);
            let texels = (map.width() >> mip).max(1);
            let stamps = inputs.timing.and_then(|timing| timing.compute("sun maps"));
            self.mips.dispatch_over(encoder, &group, [texels, texels, 1], stamps);
        }
    }
}

fn key(
    inputs: &Inputs<'_>,
    cloud: &CloudFrame,
    others: &[EllipsoidUniform],
    along: DVec3,
    resolution: u32,
) -> Key {
    let (mut light_box, ellipsoids) = LightBox::new(&cloud.ellipsoids, others, along.as_vec3(), resolution);
    light_box.chop = cloud.optics.chop;
    light_box.asymmetry = cloud.optics.asymmetry;
    let voxels = light_box.voxels(resolution);
    Key { ellipsoids, noise: cloud.noise, seed: inputs.seed, light_box, voxels, mapped: false }
}

/// What a pass through a light box binds.
struct Buffers {
    light_box: wgpu::Buffer,
    ellipsoids: wgpu::Buffer,
    noise: wgpu::Buffer,
    lists: wgpu::Buffer,
    candidates: wgpu::Buffer,
}

impl Buffers {
    fn new(inputs: &Inputs<'_>, key: &Key) -> Self {
        let bricks = Bricks::new(&key.light_box, &key.ellipsoids, key.voxels);
        Self {
            lists: gpu::storage_buffer(inputs.device, "bricks", &bricks.lists),
            candidates: gpu::storage_buffer(inputs.device, "ellipsoids of bricks", &bricks.candidates),
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
            Some(self.lists.as_entire_binding()),
            Some(self.candidates.as_entire_binding()),
        ]
    }
}

/// Memory of a texture of half floats, bytes; maps have mips.
fn bytes(texture: &wgpu::Texture) -> u64 {
    let level =
        |mip: u32| u64::from((texture.width() >> mip).max(1)) * u64::from((texture.height() >> mip).max(1));
    (0..texture.mip_level_count())
        .map(|mip| 8 * level(mip) * u64::from(texture.depth_or_array_layers()))
        .sum()
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
