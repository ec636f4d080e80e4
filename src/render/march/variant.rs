//! What the march is compiled for.

use super::{MOST_NODES, View};
use crate::{
    frame::{LitBy, medium::MediumKind},
    gpu::{self, ADDS, Role, Shader, Strips, strip_pipeline},
    render::Transport,
};

/// Entries that tell what is where, without light and with it apart.
pub(in crate::render) const PLACES: &str = "places";
pub(in crate::render) const EVERYTHING: &str = "everything";

/// Entry that tells how far rays see, for clouds that cross.
pub(in crate::render) const VISIBILITY: &str = "visibility";

/// Of mattes: distance and opacity.
pub(in crate::render) const MATTE: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Float;

/// Pictures of the usual format that an entry draws into.
fn pictures(entry: &str) -> usize {
    match entry {
        "layers" => 4,
        PLACES => 2,
        EVERYTHING => 6,
        _ => 1,
    }
}

/// What the march is compiled for: what a scene does not use is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Variant {
    /// The model of light.
    pub transport: Transport,
    /// The entry function.
    pub entry: &'static str,
    pub(super) medium: MediumKind,
    counting: bool,
    atmosphere: bool,
    aerial: bool,
    air_shaded: bool,
    air_lit: bool,
    adds: bool,
    mattes: bool,
    normals: bool,
    flash: bool,
    moons: u32,
    sky_light: bool,
    scene_depth: bool,
    ground: bool,
    peak: bool,
    absorbing: bool,
    repeats: bool,
    pub(super) shaded: bool,
    crosses: bool,
    light_nodes: u32,
    max_steps: u32,
}

impl Variant {
    /// What fills the shader's roles.
    pub fn roles(&self) -> Vec<Role<'static>> {
        let shade: &[_] = if self.shaded { &[gpu::in_place_of("shade", "shade_map")] } else { &[] };
        [&[self.medium.role()], self.transport.roles(), shade].concat()
    }

    /// Flags and numbers.
    pub fn overrides(&self) -> [(&'static str, f64); 19] {
        let flag = |on: bool| f64::from(u8::from(on));
        [
            ("COUNTING", flag(self.counting)),
            ("ATMOSPHERE", flag(self.atmosphere)),
            ("AERIAL", flag(self.aerial)),
            ("AIR_SHADED", flag(self.air_shaded)),
            ("MOONS", f64::from(self.moons)),
            ("FLASH", flag(self.flash)),
            ("AIR_LIT", flag(self.air_lit)),
            ("SKY_LIGHT", flag(self.sky_light)),
            ("SCENE_DEPTH", flag(self.scene_depth)),
            ("GROUND", flag(self.ground)),
            ("LIT", flag(is_lit(self.entry))),
            ("CROSSES", flag(self.crosses)),
            ("VISIBILITY", flag(self.entry == VISIBILITY)),
            ("NORMALS", flag(self.normals)),
            ("PEAK", flag(self.peak)),
            ("ABSORBING", flag(self.absorbing)),
            ("REPEATS", flag(self.repeats)),
            ("LIGHT_NODES", f64::from(self.light_nodes)),
            ("MAX_STEPS", f64::from(self.max_steps)),
        ]
    }
}

/// Which way a cloud faces and how far one sees into it has nothing to do with light.
pub(super) fn is_lit(entry: &str) -> bool {
    !matches!(entry, PLACES | VISIBILITY)
}

/// That of cloud `number` in a picture, alone or where it crosses others.
pub(super) fn variant(shared: &View<'_>, number: usize, medium: MediumKind, crosses: bool) -> Variant {
    let cloud = &shared.frame.clouds[number];
    let settings = shared.settings;
    let species = &cloud.medium.species;
    let (lit, hides) = (is_lit(shared.entry), shared.entry != PLACES);
    let hides_discs = settings.transport.0.needs.sun || settings.transport == Transport::DARK;
    let has_peak = species.truncated > 0.0 && hides_discs;
    let is_flash = matches!(shared.frame.by, LitBy::Flash(..));
    let above = shared.frame.by == LitBy::Sky;
    let has_air = shared.sky.has_atmosphere();
    let aerial = has_air && settings.aerial;
    let lowest = cloud.origin.y - cloud.half.y;
    Variant {
        transport: settings.transport,
        entry: shared.entry,
        medium,
        counting: settings.counting || shared.entry == "cost",
        atmosphere: has_air && above,
        aerial,
        air_shaded: aerial && above && shared.shadows.in_air,
        air_lit: above,
        adds: shared.adds,
        mattes: shared.mattes,
        normals: matches!(shared.entry, PLACES | EVERYTHING),
        flash: is_flash,
        moons: if hides { shared.frame.moons() } else { 0 },
        sky_light: lit && above && shared.sky.lights(),
        scene_depth: shared.depth.is_some(),
        // Between two points above the level of the ground below the camera there is none of it.
        ground: settings.ground && has_air && lowest < shared.frame.ground,
        peak: hides && has_peak && !is_flash,
        absorbing: species.albedo < 1.0,
        repeats: cloud.medium.layer.is_some(),
        shaded: shared.shade(number).is_some(),
        crosses,
        // Light from within changes fast along a ray.
        light_nodes: if is_flash { MOST_NODES } else { settings.quality.light_nodes.clamp(1, MOST_NODES) },
        max_steps: settings.quality.max_steps,
    }
}

/// The pipeline of a variant into a target of `format`.
pub(super) fn pipeline(
    device: &wgpu::Device,
    shader: &Shader,
    variant: &Variant,
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let overrides = shader.known(&variant.overrides());
    let over = if variant.adds { ADDS } else { wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING };
    let draws = variant.entry != VISIBILITY;
    let blend = draws.then_some(over);
    let write_mask = if draws { wgpu::ColorWrites::ALL } else { wgpu::ColorWrites::empty() };
    let target = |format| Some(wgpu::ColorTargetState { format, blend, write_mask });
    let mut targets = vec![target(format); pictures(variant.entry)];
    targets.extend(variant.mattes.then(|| target(MATTE)));
    let strips = Strips {
        label: "clouds",
        entries: ["quad", variant.entry],
        overrides: &overrides,
        targets: &targets,
    };
    strip_pipeline(device, shader, &strips)
}
