//! The light of one cloud: what it is made for, what it holds, and how a model of light binds it.

use glam::{Vec3, Vec4};
use wgpu::{BindGroup, TextureView};

use super::{
    around::Around,
    boxes::LightBox,
    field::{Eyes, Field, FieldKey, FieldPass, SolvedLight},
    inputs::Inputs,
    model::{Parts, Transport},
    openness::{Openness, OpennessPass},
    plan::Detail,
    slack::Slack,
    sun::{BoxKey, Shade, SunKey, SunPass, SunVolume},
};
use crate::{
    frame::{CloudFrame, SkySettings, medium::SpeciesTextures},
    gpu,
};

/// Columns along an edge of a layer's box over those of other clouds: a period holds many heaps.
const FINER_COLUMNS: u32 = 4;

/// What a cloud's light is made for; where that is the same, so is the light.
#[derive(Clone, PartialEq)]
pub(super) struct Wanted {
    pub(super) sun: Option<SunKey>,
    pub(super) openness: Option<BoxKey>,
    /// Of light that is solved for; that of the sun depends on `sun`, too.
    pub(super) field: Option<FieldKey>,
    pub(super) sky_field: Option<(FieldKey, Option<SkySettings>)>,
}

impl Wanted {
    /// Light for `cloud` in the shadow and the light of what is around it.
    pub fn new(
        inputs: &Inputs<'_>,
        cloud: &CloudFrame,
        shades: Vec<Shade>,
        around: Around,
        detail: Detail,
    ) -> Self {
        let medium = &cloud.medium;
        let sky_resolution = (detail.resolution / 4).clamp(8, 32);
        let flash = cloud.flash(inputs.by).unwrap_or(Vec4::ZERO);
        // Light from within it has none of theirs.
        let around = if flash.w > 0.0 { Around::default() } else { around };
        let field = |cells, around| FieldKey { medium: medium.clone(), cells, flash, around };
        let needs = inputs.needs;
        Self {
            sun: needs.sun.then(|| SunKey {
                of: box_of(inputs, cloud, detail),
                mapped: needs.maps,
                // Nothing shades what shines from within.
                shades: if flash.w > 0.0 { Vec::new() } else { shades },
            }),
            openness: (needs.openness(inputs.lit_by_sky))
                .then(|| BoxKey::new(medium, Vec3::NEG_Y, sky_resolution)),
            sky_field: (needs.field && inputs.lit_by_sky)
                .then(|| (field((detail.cells / 2).max(8), around.of_sky()), inputs.sky.settings())),
            field: needs.field.then(|| field(detail.cells, around)),
        }
    }

    /// No more than what a cloud out of view casts its shadow with.
    pub fn shadow(inputs: &Inputs<'_>, of: BoxKey) -> Self {
        let sun = SunKey { of, mapped: false, shades: Vec::new() };
        Self { sun: inputs.needs.sun.then_some(sun), openness: None, field: None, sky_field: None }
    }

    /// Other clouds that stand before it.
    pub fn shades(&self) -> &[Shade] {
        self.sun.as_ref().map_or(&[], |sun| &sun.shades)
    }
}

/// The box that a cloud's optical depth to the sun is told in.
pub(super) fn box_of(inputs: &Inputs<'_>, cloud: &CloudFrame, detail: Detail) -> BoxKey {
    let finer = if cloud.medium.layer.is_some() && detail != Detail::SHADOW { FINER_COLUMNS } else { 1 };
    BoxKey::new(&cloud.medium, -inputs.to_sun.as_vec3(), finer * detail.resolution)
}

impl Wanted {
    /// Whether a ball shines in it, and no sun.
    fn is_flash(&self) -> bool {
        self.field.as_ref().is_some_and(|field| field.flash.w > 0.0)
    }
}

/// The prepared light of one cloud.
pub(in crate::render) struct CloudLight {
    pub(super) sun: Option<SunVolume>,
    pub(super) openness: Option<Openness>,
    pub(super) field: Option<Field>,
    made_for: Wanted,
    bytes: u64,
    /// How a model binds it.
    bound: Option<(Transport, BindGroup)>,
}

/// `Light` of `shaders/light/sunlight.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightUniform {
    pub(crate) sun: LightBox,
    pub(crate) sky: LightBox,
    pub(crate) field_low: Vec3,
    pub(crate) mean_free_path: f32,
    pub(crate) field_scale: Vec3,
    padding: f32,
    pub(crate) flash: Vec4,
}

impl CloudLight {
    fn new(
        made_for: Wanted,
        sun: Option<SunVolume>,
        openness: Option<Openness>,
        field: Option<Field>,
    ) -> Self {
        let textures = sun.iter().flat_map(SunVolume::textures);
        let textures = textures.chain(openness.iter().map(|openness| &openness.volume));
        let solved = field.iter().flat_map(|field| [&field.sun].into_iter().chain(&field.sky));
        let bytes = textures.map(|view| bytes(view.texture())).sum::<u64>()
            + solved.map(SolvedLight::bytes).sum::<u64>();
        Self { sun, openness, field, made_for, bytes, bound: None }
    }

    /// Memory of its textures, bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The volume of optical depth to the sun, and its box.
    pub(super) fn sunlight(&self) -> Option<(LightBox, &TextureView)> {
        Some((self.made_for.sun.as_ref()?.of.light_box, &self.sun.as_ref()?.volume))
    }

    /// The box of the optical depth that `cloud` casts its shadow with, whatever else stood before the sun.
    pub(super) fn shades(&self, cloud: &CloudFrame, inputs: &Inputs<'_>) -> Option<&BoxKey> {
        let along = LightBox::way(&cloud.medium, -inputs.to_sun.as_vec3());
        let sun = self.made_for.sun.as_ref()?;
        (sun.of.medium == cloud.medium && sun.of.light_box.along == along).then_some(&sun.of)
    }

    /// The volume of optical depth to the sun in this box.
    pub(super) fn volume_in(&self, of: &BoxKey) -> Option<&TextureView> {
        self.made_for.sun.as_ref().filter(|sun| sun.of == *of)?;
        Some(&self.sun.as_ref()?.volume)
    }

    /// Whether nothing that it depends on has changed.
    pub(super) fn is(&self, wanted: &Wanted) -> bool {
        self.made_for == *wanted
    }

    /// Whether it is, or was made for what is near enough.
    pub(super) fn is_near(&self, wanted: &Wanted, slack: Slack) -> bool {
        self.is(wanted) || (slack.turn > 0.0 && slack.covers(&self.made_for, wanted))
    }

    /// Whether it has all the parts, if of another moment.
    pub(super) fn stands_in_for(&self, wanted: &Wanted) -> bool {
        let parts = |w: &Wanted| {
            let maps = w.sun.as_ref().map(|sun| sun.mapped);
            (maps, w.openness.is_some(), w.field.is_some(), w.sky_field.is_some())
        };
        parts(&self.made_for) == parts(wanted)
    }

    /// How `transport` binds it, where that was asked for last.
    pub fn bound(&self, transport: Transport) -> Option<&BindGroup> {
        self.bound.as_ref().filter(|(known, _)| *known == transport).map(|(_, group)| group)
    }

    /// How `transport` binds the light of `cloud`, made when first asked for.
    pub fn group(&mut self, binding: &Binding<'_>, cloud: &CloudFrame) -> &BindGroup {
        let known = self.bound.take().filter(|(transport, _)| *transport == binding.transport);
        let bound = known.unwrap_or_else(|| (binding.transport, self.bind(binding, cloud)));
        &self.bound.insert(bound).1
    }

    fn bind(&self, binding: &Binding<'_>, cloud: &CloudFrame) -> BindGroup {
        let uniform = gpu::uniform_buffer(binding.device, "light", &self.uniform(cloud));
        let parts =
            Parts { light: self, species: binding.species, tables: binding.tables, dark: binding.dark };
        let mut resources =
            vec![Some(uniform.as_entire_binding()), Some(wgpu::BindingResource::Sampler(binding.linear))];
        for (place, view) in (binding.transport.0.textures)(&parts) {
            let place = place as usize;
            resources.resize(resources.len().max(place + 1), None);
            resources[place] = Some(wgpu::BindingResource::TextureView(view));
        }
        gpu::bind_group(binding.device, "light", binding.layout, &resources)
    }

    fn uniform(&self, cloud: &CloudFrame) -> LightUniform {
        let medium = &cloud.medium;
        let sun = self.made_for.sun.as_ref().map(|key| key.of.light_box);
        let sky = self.made_for.openness.as_ref().map(|key| key.light_box);
        let (low, extent) = self
            .field
            .as_ref()
            .map_or((Vec3::ZERO, Vec3::ONE), |field| (field.field_box.low, field.field_box.extent));
        let densest = medium.densest().max(1e-6);
        LightUniform {
            sun: sun.or(sky).unwrap_or_else(bytemuck::Zeroable::zeroed),
            sky: sky.or(sun).unwrap_or_else(bytemuck::Zeroable::zeroed),
            field_low: low,
            mean_free_path: 1.0 / (densest * (1.0 - medium.species.truncated)),
            field_scale: extent.recip(),
            padding: 0.0,
            flash: self.made_for.field.as_ref().map_or(Vec4::ZERO, |field| field.flash),
        }
    }
}

/// What a model binds beside the light of a cloud.
pub(in crate::render) struct Binding<'a> {
    pub device: &'a wgpu::Device,
    pub transport: Transport,
    pub layout: &'a wgpu::BindGroupLayout,
    pub species: &'a SpeciesTextures,
    pub tables: &'a [TextureView],
    pub linear: &'a wgpu::Sampler,
    pub dark: &'a TextureView,
}

/// The programs that prepare light, compiled when first needed.
#[derive(Default)]
pub(super) struct LightPass {
    pub sun: SunPass,
    openness: OpennessPass,
    field: Option<FieldPass>,
    eyes: Eyes,
}

impl LightPass {
    /// The light of a cloud that is `wanted`, taken over from `before` where nothing it depends on
    /// changed; `alone` is its own optical depth to the sun where that is known, and `others` those of what shades it.
    /// Counts the volumes that were redone in `redone`.
    #[allow(clippy::too_many_arguments, reason = "what is wanted, and what is known of it")]
    pub fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        wanted: Wanted,
        before: Option<CloudLight>,
        alone: Option<SunVolume>,
        others: &[TextureView],
        redone: &mut u32,
    ) -> CloudLight {
        let mut known = Known::of(before, &wanted);
        let sun = wanted.sun.as_ref().map(|key| {
            known.sun.take().unwrap_or_else(|| {
                *redone += 1;
                if wanted.is_flash() {
                    return SunVolume::dark(inputs);
                }
                let alone = alone.or(known.alone.take());
                let alone = alone.unwrap_or_else(|| self.sun.make(encoder, inputs, &key.of, key.mapped));
                let volume = self.sun.shade(encoder, inputs, key, &alone.volume, others);
                SunVolume { volume, ..alone }
            })
        });
        let openness = wanted.openness.as_ref().map(|key| {
            known.openness.take().unwrap_or_else(|| {
                *redone += 1;
                self.openness.make(encoder, inputs, key)
            })
        });
        let field = wanted.field.as_ref().zip(wanted.sun.as_ref()).zip(sun.as_ref());
        let field = field.map(|((key, sun_key), sun)| {
            let pass = self.field.get_or_insert_with(|| FieldPass::new(inputs.device));
            let light = (&sun_key.of, &sun.volume);
            let mut count = || *redone += 1;
            let sky = wanted.sky_field.as_ref().map(|(key, _)| key);
            pass.make(encoder, inputs, key, sky, light, (known.field_of_sun, known.field_of_sky), &mut count)
        });
        CloudLight::new(wanted, sun, openness, field)
    }

    /// Finds what of solved light goes to the eyes of clouds ([`super::field::eye_of`]), where those have moved.
    pub fn see<'a>(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        lights: impl Iterator<Item = (&'a mut CloudLight, Vec4)>,
    ) {
        let fields = lights.filter_map(|(light, eye)| Some((light.field.as_mut()?, eye)));
        if let Some(pass) = &self.field {
            self.eyes.see(pass, encoder, inputs, fields);
        }
    }
}

/// Parts of a cloud's light that need not be made again.
#[derive(Default)]
struct Known {
    sun: Option<SunVolume>,
    /// Its own optical depth, in whatever shadow.
    alone: Option<SunVolume>,
    openness: Option<Openness>,
    field_of_sun: Option<SolvedLight>,
    field_of_sky: Option<SolvedLight>,
}

impl Known {
    fn of(before: Option<CloudLight>, wanted: &Wanted) -> Self {
        let Some(CloudLight { sun, openness, field, made_for, .. }) = before else { return Self::default() };
        let same_kind = made_for.is_flash() == wanted.is_flash();
        let same_sun = same_kind && made_for.sun == wanted.sun;
        let own = |wanted: &Wanted| wanted.sun.as_ref().map(|sun| (sun.of.clone(), sun.mapped));
        // A volume in shadow tells what the cloud is alone, but to a pass that shades it anew.
        let is_alone = made_for.shades().is_empty() || !wanted.shades().is_empty();
        let alone = sun.clone().filter(|_| same_kind && is_alone && own(&made_for) == own(wanted));
        let (field_of_sun, field_of_sky) = field.map(|field| (field.sun, field.sky)).unzip();
        Self {
            sun: sun.filter(|_| same_sun),
            alone,
            openness: openness.filter(|_| made_for.openness == wanted.openness),
            field_of_sun: field_of_sun.filter(|_| same_sun && made_for.field == wanted.field),
            field_of_sky: field_of_sky.flatten().filter(|_| made_for.sky_field == wanted.sky_field),
        }
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
