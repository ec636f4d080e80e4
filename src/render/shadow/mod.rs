//! Shadows of clouds on the ground, in the air and on layers: one map of the sun's light for the whole scene
//! (`shaders/lib/sun_map.wgsl`), put together from the volumes of optical depth that clouds have anyway, and what the
//! air before the camera lacks of light for it; and, for each layer, one of all others before it. All are made again only when
//! something in them changed.

mod casters;
mod layout;
mod map;
mod splat;

use std::collections::HashMap;

use wgpu::TextureView;

pub(super) use casters::{Caster, may_shade};
use layout::SQUARES;
#[cfg(test)]
pub(crate) use layout::SunMapUniform;
use map::Map;
#[cfg(test)]
pub(crate) use splat::CasterUniform;
use splat::Splat;

use super::{light::begins_before, sky::Sky};
use crate::{
    frame::{Frame, Rays, SkySettings},
    gpu::{self, ComputeProgram, TextureDesc, Timing},
};

/// Texels of the air's volume: finer across than the air itself needs, for the edges of beams.
const AIR: [u32; 3] = [128, 72, 32];

/// The sun's light that the clouds of a picture leave, for shaders of the caller: the module `sun_map` of
/// [`crate::gpu::link`] reads it.
pub struct SunMap<'a> {
    /// Its `SunMap`, uniform or storage. Points are told in metres from the camera of the frame that was drawn last.
    pub uniform: &'a wgpu::Buffer,
    /// Its `lit`, all layers.
    pub lit: &'a TextureView,
}

/// What shaders read of shadows.
pub(super) struct Shadows {
    /// Whether anything casts one.
    pub cast: bool,
    /// Whether the air's is made.
    pub in_air: bool,
    reach: f64,
    all: Map,
    /// Of what stands before layers, by the layer's number.
    on_layers: HashMap<usize, Map>,
    air: TextureView,
    splat: Option<Splat>,
    shade_air: Option<ComputeProgram>,
    air_made: Option<AirMade>,
}

/// What the air's volume depends on; `map` is the number of the map.
#[derive(PartialEq)]
struct AirMade {
    rays: Rays,
    position: [u64; 3],
    sky: SkySettings,
    map: u32,
}

impl Shadows {
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            cast: false,
            in_air: false,
            reach: 1.0,
            all: Map::new(device),
            on_layers: HashMap::new(),
            air: gpu::view(&air_texture(device, [1; 3])),
            splat: None,
            shade_air: None,
            air_made: None,
        }
    }

    /// The same for the caller, where clouds cast shadows.
    pub fn sun_map(&self) -> Option<SunMap<'_>> {
        self.cast.then_some(SunMap { uniform: &self.all.uniform, lit: &self.all.lit })
    }

    /// The map's numbers, and the share of light that it holds, in the order in which shaders bind them.
    pub fn map(&self) -> (&wgpu::Buffer, &TextureView) {
        self.all.bindings()
    }

    /// The same as [`Shadows::map`], of what stands before a cloud, where its light needs it.
    pub fn on(&self, number: usize) -> Option<(wgpu::Buffer, TextureView)> {
        let (map, lit) = self.on_layers.get(&number)?.bindings();
        Some((map.clone(), lit.clone()))
    }

    /// What the air before the camera lacks.
    pub fn air(&self) -> &TextureView {
        &self.air
    }

    /// How far from the camera the air's goes, m.
    pub fn reach(&self) -> f32 {
        self.reach as f32
    }

    /// There are none on ground and air in this picture.
    pub fn none(&mut self) {
        (self.cast, self.in_air) = (false, false);
    }

    /// There are none on layers in this picture.
    pub fn none_on_layers(&mut self) {
        self.on_layers.clear();
    }

    /// Brings the maps of what stands before layers up to date; tells how many were made. `casters` know their clouds.
    pub fn prepare_on_layers(
        &mut self,
        inputs: &ShadowInputs<'_>,
        encoder: &mut wgpu::CommandEncoder,
        casters: &[Caster],
        texels: u32,
    ) -> u32 {
        let clouds = &inputs.frame.clouds;
        let along = -inputs.frame.sun.to_sun;
        let is_layer = |number: &usize| clouds.get(*number).is_some_and(|cloud| cloud.medium.layer.is_some());
        self.on_layers.retain(|number, _| is_layer(number));
        let mut made = 0;
        for layer in (0..clouds.len()).filter(is_layer) {
            let before =
                |other: usize| other != layer && begins_before(&clouds[other], &clouds[layer], along);
            let own: Vec<_> = casters.iter().filter(|caster| before(caster.number)).cloned().collect();
            let map = self.on_layers.entry(layer).or_insert_with(|| Map::new(inputs.device));
            match map.prepare(&mut self.splat, inputs, encoder, &own, texels, 0.0) {
                Some(is_made) => made += u32::from(is_made),
                None => drop(self.on_layers.remove(&layer)),
            }
        }
        made
    }

    /// Brings the map of `texels` along an edge up to date for what `casters` there are, and, where wanted, the
    /// shadow in the air; tells how many were made.
    pub fn prepare(
        &mut self,
        inputs: &ShadowInputs<'_>,
        encoder: &mut wgpu::CommandEncoder,
        casters: &[Caster],
        texels: u32,
    ) -> u32 {
        let reach = casters::reach(inputs.frame, casters);
        let Some(is_made) = self.all.prepare(&mut self.splat, inputs, encoder, casters, texels, reach) else {
            self.none();
            return 0;
        };
        (self.cast, self.reach) = (true, reach);
        u32::from(is_made) + self.prepare_air(inputs, encoder)
    }

    fn prepare_air(&mut self, inputs: &ShadowInputs<'_>, encoder: &mut wgpu::CommandEncoder) -> u32 {
        let frame = inputs.frame;
        self.in_air = inputs.aerial;
        let wanted = AirMade {
            rays: frame.camera.rays(),
            position: frame.camera_position.to_array().map(f64::to_bits),
            sky: frame.sky,
            map: self.all.number,
        };
        if !inputs.aerial || self.air_made.as_ref() == Some(&wanted) {
            return 0;
        }
        let program =
            self.shade_air.get_or_insert_with(|| ComputeProgram::new(inputs.device, "air_shadow", &[]));
        if self.air_made.is_none() {
            self.air = gpu::view(&air_texture(inputs.device, AIR));
        }
        let sky = inputs.sky;
        let texture = |view| Some(wgpu::BindingResource::TextureView(view));
        let resources = [
            Some(sky.atmosphere().as_entire_binding()),
            Some(sky.camera().as_entire_binding()),
            Some(self.all.uniform.as_entire_binding()),
            texture(sky.transmittance()),
            texture(&self.all.lit),
            Some(wgpu::BindingResource::Sampler(sky.sampler())),
            texture(&self.air),
        ];
        let group = program.bind(inputs.device, &resources);
        let stamps = inputs.timing.and_then(|timing| timing.compute("air shadow"));
        program.dispatch_over(encoder, &[&group], [AIR[0], AIR[1], 1], stamps);
        self.air_made = Some(wanted);
        1
    }
}

/// What shadows are made with.
#[derive(Clone, Copy)]
pub(super) struct ShadowInputs<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub frame: &'a Frame,
    pub sky: &'a Sky,
    /// Whether the air shows.
    pub aerial: bool,
    pub timing: Option<&'a Timing>,
}

fn air_texture(device: &wgpu::Device, size: [u32; 3]) -> wgpu::Texture {
    let (format, usage) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::STORAGE_BINDING);
    gpu::texture(device, &TextureDesc { label: "air shadow", size, mips: 1, format, usage })
}
