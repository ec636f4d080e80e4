//! The sky behind the clouds and the light that it throws on them.
//!
//! Hillaire's tables (`shaders/lib/atmosphere.wgsl` has the sources) depend on one
//! another and on ever more of the scene, and each is made again only when something
//! it depends on has changed:
//!
//! ```text
//! atmosphere, ground -> transmittance -> multiple scattering -> ground light
//!   + height of the sun, height of the camera -> sky view
//!   + height of the sun, irradiance           -> sky light
//!   + sun, camera                             -> aerial volume
//! ```
//!
//! A sky without an atmosphere has no tables; then single texels stand in for them, so
//! that other passes can bind the same things.

mod background;
mod ground;
mod land;
mod smooth;
mod tables;

use glam::Vec3;
use half::f16;
use wgpu::TextureView;

use super::shadow::Shadows;
use crate::{
    frame::{AERIAL_REACH, CameraUniform, GroundSettings, GroundShader, SkySettings, SkyUniform},
    gpu::{self, Made, Timing, view},
};
use background::{Background, BackgroundKind, Bound};
use ground::GroundPass;
use tables::{SKY_LIGHT, Tables, table};

/// Which tables [`Sky::prepare`] made again.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Redone {
    /// Transmittance, multiple scattering and ground light.
    pub atmosphere: bool,
    /// What the camera sees of the sky.
    pub sky_view: bool,
    /// What falls on the clouds.
    pub sky_light: bool,
    /// The air between the camera and the clouds.
    pub aerial: bool,
}

impl Redone {
    /// How many tables that were.
    pub fn count(self) -> u32 {
        3 * u32::from(self.atmosphere)
            + [self.sky_view, self.sky_light, self.aerial].map(u32::from).iter().sum::<u32>()
    }
}

/// The sky pass. Call [`Sky::prepare`] and then bind its tables or [`Sky::draw`].
pub struct Sky {
    sky_uniform: wgpu::Buffer,
    camera_uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
    sky_light_texture: wgpu::Texture,
    sky_light: TextureView,
    white_texture: wgpu::Texture,
    white: TextureView,
    no_air_texture: wgpu::Texture,
    no_air: TextureView,
    tables: Option<Tables>,
    backgrounds: Vec<Background>,
    unshaded: Shadows,
    /// The kind of background that was last prepared.
    current: BackgroundKind,
    /// What the tables hold.
    made: Option<Wanted>,
    /// What the ground is like.
    ground: GroundPass,
    /// What was last bound to draw it, and the group of that.
    bound: Option<(Bound, wgpu::BindGroup)>,
}

/// All that tables depend on.
#[derive(Clone, Copy, PartialEq)]
struct Wanted {
    settings: SkySettings,
    camera: CameraUniform,
}

impl Wanted {
    /// Which tables must be made for `self` where those of `before` are at hand.
    fn redo(&self, before: Option<&Self>) -> Redone {
        if !self.settings.atmosphere {
            return Redone::default();
        }
        let Some(before) = before.filter(|before| before.settings.atmosphere) else {
            return Redone { atmosphere: true, sky_view: true, sky_light: true, aerial: true };
        };
        let (new, old) = (&self.settings.uniform, &before.settings.uniform);
        let (eye, old_eye) = (&self.camera, &before.camera);
        let atmosphere = new.atmosphere != old.atmosphere;
        let sun_height = atmosphere || new.to_sun.y != old.to_sun.y;
        let altitude = eye.altitude != old_eye.altitude;
        let rays = eye.rays() != old_eye.rays();
        Redone {
            atmosphere,
            sky_view: sun_height || altitude,
            sky_light: sun_height
                || new.irradiance != old.irradiance
                || new.light_altitude != old.light_altitude,
            aerial: atmosphere
                || new.to_sun != old.to_sun
                || new.aerial_reach != old.aerial_reach
                || altitude
                || rays,
        }
    }
}

impl Sky {
    /// A sky without tables yet.
    pub fn new(device: &wgpu::Device) -> Self {
        let zeroed = |label, size| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: gpu::UNIFORM,
                mapped_at_creation: false,
            })
        };
        let sky_light_texture = table(device, "sky light", SKY_LIGHT);
        let white_texture = table(device, "no absorption", [1, 1, 0]);
        let no_air_texture = table(device, "no air", [1, 1, 1]);
        Self {
            sky_uniform: zeroed("sky", size_of::<SkyUniform>() as u64),
            camera_uniform: zeroed("sky camera", size_of::<CameraUniform>() as u64),
            sampler: gpu::linear_clamp(device),
            sky_light: view(&sky_light_texture),
            sky_light_texture,
            white: view(&white_texture),
            white_texture,
            no_air: view(&no_air_texture),
            no_air_texture,
            tables: None,
            backgrounds: Vec::new(),
            unshaded: Shadows::new(device),
            current: BackgroundKind {
                atmosphere: false,
                sun_disc: false,
                shaded: false,
                ground: GroundShader::Even,
                adds: false,
            },
            made: None,
            ground: GroundPass::default(),
            bound: None,
        }
    }

    /// Brings the tables up to date: records those whose inputs changed since the last
    /// call, and tells which. Once for each submission of `encoder`.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        settings: &SkySettings,
        camera: &CameraUniform,
        timing: Option<&Timing>,
    ) -> Redone {
        let wanted = Wanted { settings: *settings, camera: *camera };
        if self.made == Some(wanted) {
            return Redone::default();
        }
        Made::one(|made| &mut made.writes);
        queue.write_buffer(&self.sky_uniform, 0, bytemuck::bytes_of(&settings.uniform));
        queue.write_buffer(&self.camera_uniform, 0, bytemuck::bytes_of(camera));
        let redo = wanted.redo(self.made.as_ref());
        if settings.atmosphere {
            let tables = self.tables.get_or_insert_with(|| {
                Tables::new(device, &self.sky_uniform, &self.camera_uniform, &self.sampler, &self.sky_light)
            });
            let fills = [
                (redo.atmosphere, &tables.fill_atmosphere[..]),
                (redo.sky_view, std::slice::from_ref(&tables.fill_sky_view)),
                (redo.sky_light, std::slice::from_ref(&tables.fill_sky_light)),
                (redo.aerial, std::slice::from_ref(&tables.fill_aerial)),
            ];
            for fill in fills.iter().filter(|(wanted, _)| *wanted).flat_map(|(_, fills)| *fills) {
                fill.run(encoder, timing);
            }
        } else {
            self.write_plain(queue, settings.uniform.radiance);
        }
        let sunlit = settings.uniform.irradiance != Vec3::ZERO;
        self.current = BackgroundKind {
            atmosphere: settings.atmosphere,
            sun_disc: sunlit && camera.projection != CameraUniform::ORTHOGRAPHIC,
            shaded: false,
            ground: GroundShader::Even,
            adds: false,
        };
        self.made = Some(wanted);
        redo
    }

    /// Brings up to date what the picture of such ground is made of. After [`Sky::prepare`]; where it is not called the
    /// ground is even.
    pub fn prepare_ground(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        ground: &GroundSettings,
        timing: Option<&Timing>,
    ) {
        let Some((made, tables)) =
            self.made.filter(|made| made.settings.atmosphere).zip(self.tables.as_ref())
        else {
            return self.ground.none();
        };
        let sources = (tables, &self.sky_uniform, &self.sampler);
        self.ground.prepare((device, queue), encoder, (ground, &made.settings), sources, timing);
    }

    /// The single texels that stand in for the tables of an atmosphere.
    fn write_plain(&self, queue: &wgpu::Queue, radiance: Vec3) {
        write_texels(queue, &self.white_texture, &[[1.0; 4]]);
        write_texels(queue, &self.no_air_texture, &[[0.0, 0.0, 0.0, 1.0]]);
        write_texels(queue, &self.sky_light_texture, &[light_texel(radiance); 3]);
    }

    /// What the radiance of sky and ground is found from, in the order of the bindings of
    /// `sky_light`; without an atmosphere single texels stand in for its tables.
    pub(super) fn sources(&self) -> [wgpu::BindingResource<'_>; 5] {
        let tables = self.tables.as_ref().filter(|_| self.has_atmosphere());
        let [transmittance, multiple, ground] = tables
            .map_or([&self.white; 3], |tables| [&tables.transmittance, &tables.multiple, &tables.ground]);
        [
            self.sky_uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(transmittance),
            wgpu::BindingResource::TextureView(multiple),
            wgpu::BindingResource::TextureView(ground),
            wgpu::BindingResource::Sampler(&self.sampler),
        ]
    }

    /// What was last prepared, as far as light on clouds depends on it.
    pub(super) fn settings(&self) -> Option<SkySettings> {
        self.made.map(|made| made.settings)
    }

    /// `Camera` of `shaders/lib/camera.wgsl` as it was last prepared.
    pub(super) fn camera(&self) -> &wgpu::Buffer {
        &self.camera_uniform
    }

    /// `Sky` of `shaders/lib/atmosphere.wgsl` as it was last prepared. It begins with
    /// its `Atmosphere`, and can be bound as one.
    pub fn atmosphere(&self) -> &wgpu::Buffer {
        &self.sky_uniform
    }

    /// Whether there is an atmosphere. Where there is none, a shader need not read the
    /// transmittance and the air.
    pub fn has_atmosphere(&self) -> bool {
        self.current.atmosphere
    }

    /// Whether any light falls on the clouds from sky and ground.
    pub fn lights(&self) -> bool {
        self.made.is_some_and(|made| {
            let sky = &made.settings.uniform;
            let light = if made.settings.atmosphere { sky.irradiance } else { sky.radiance };
            light != Vec3::ZERO
        })
    }

    /// Distance at which the aerial volume ends, metres: `aerial_perspective` needs it.
    pub fn aerial_range(&self) -> f32 {
        self.made.map_or(AERIAL_REACH, |made| made.settings.uniform.aerial_reach)
    }

    /// Transmittance to the top of the atmosphere, for `sun_irradiance_at`. A white
    /// texel where there is no atmosphere: ask again after [`Sky::prepare`].
    pub fn transmittance(&self) -> &TextureView {
        self.active().map_or(&self.white, |tables| &tables.transmittance)
    }

    /// What falls on the clouds, for the shader function `light_of_sky`, in the scene's
    /// units. Always the same texture.
    pub fn sky_light(&self) -> &TextureView {
        &self.sky_light
    }

    /// The air before the camera, for `aerial_perspective`. A clear texel where there is
    /// no atmosphere: ask again after [`Sky::prepare`].
    pub fn aerial(&self) -> &TextureView {
        self.active().map_or(&self.no_air, |tables| &tables.aerial)
    }

    /// Irradiance of the ground by the height of the sun. A white texel where there is no atmosphere.
    fn ground_light(&self) -> &TextureView {
        self.active().map_or(&self.white, |tables| &tables.ground)
    }

    /// What the camera sees of sky and ground. A white texel where there is no atmosphere.
    pub fn sky_view(&self) -> &TextureView {
        self.active().map_or(&self.white, |tables| &tables.sky_view)
    }

    /// Bilinear, clamped to the edge: the sampler of all these tables.
    pub fn sampler(&self) -> &wgpu::Sampler {
        &self.sampler
    }

    fn active(&self) -> Option<&Tables> {
        self.tables.as_ref().filter(|_| self.current.atmosphere)
    }
}

/// `light_texel` of `shaders/lib/atmosphere.wgsl`.
fn light_texel(radiance: Vec3) -> [f32; 4] {
    let exponent = radiance.max_element().max(1e-10).log2().floor().clamp(-14.0, 15.0).exp2();
    (radiance / exponent).extend(exponent).to_array()
}

/// Fills a texture of one row.
fn write_texels(queue: &wgpu::Queue, texture: &wgpu::Texture, texels: &[[f32; 4]]) {
    let halves: Vec<f16> = texels.as_flattened().iter().copied().map(f16::from_f32).collect();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: None, rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&halves), layout, texture.size());
}
