//! One light of a scene: what is kept of it from frame to frame, and what it adds to a picture.

use super::{Flush, View, far_to_near};
use crate::{
    frame::{CloudFrame, Frame, LitBy},
    gpu::Timing,
    render::{
        SceneDepth, Settings,
        light::{Inputs, LightStore, Occluders, Presence, Request},
        march::{Counters, Cover, Crossings, Draw, March, VISIBILITY},
        medium::Media,
        shadow::{ShadowInputs, Shadows, may_shade},
        sky::Sky,
    },
};

/// Sine of the elevation from which a light casts shadows: below it they are as long as the air is deep.
const LOWEST_LIGHT: f64 = 5e-3;

/// The sun, or a light beside it.
pub(super) struct Lamp {
    /// In the clouds.
    pub clouds: LightStore,
    /// Of air and ground. Of lights of clouds alone it is not used.
    pub sky: Sky,
    pub shadows: Shadows,
    presence: Vec<Presence>,
    /// Which clouds stand before each.
    before: Occluders,
    /// Tables and maps that were made so far.
    pub redone: u32,
    /// Pictures since it shone last.
    pub dark_for: u32,
}

/// What all lights of a picture share.
#[derive(Clone, Copy)]
pub(super) struct Room<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub settings: &'a Settings,
    pub timing: Option<&'a Timing>,
    pub media: &'a Media,
    pub covers: &'a [Cover],
    pub crossings: &'a Crossings,
}

/// What a picture of clouds is drawn as.
#[derive(Clone, Copy)]
pub(super) struct Way<'a> {
    pub depth: Option<&'a SceneDepth<'a>>,
    pub entry: &'static str,
    pub format: wgpu::TextureFormat,
    /// Whether the light comes on top of what is there, which has the clouds in it.
    pub adds: bool,
    /// Whether each cloud is drawn into a picture of its own, too.
    pub mattes: bool,
}

impl Way<'_> {
    /// Light, or what is where, over what is there.
    pub fn over(entry: &'static str, format: wgpu::TextureFormat) -> Self {
        Self { depth: None, entry, format, adds: false, mattes: false }
    }
}

impl Lamp {
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            clouds: LightStore::default(),
            sky: Sky::new(device),
            shadows: Shadows::new(device),
            presence: Vec::new(),
            before: Occluders::default(),
            redone: 0,
            dark_for: 0,
        }
    }

    /// Another picture without it; tells how many there were.
    pub fn stays_dark(&mut self) -> u32 {
        self.clouds.waiting = 0;
        self.dark_for += 1;
        self.dark_for
    }

    /// Tells what is wanted of each cloud; says which are.
    pub fn find(&mut self, frame: &Frame, settings: &Settings, covers: &[Cover]) -> Vec<bool> {
        let shaded = is_shaded(frame, settings.shadows) || may_shade_layers(frame, settings.shadows);
        // Light from within is solved for, or there is none.
        let in_fields = settings.transport.0.needs.field;
        let is_flash = matches!(frame.by, LitBy::Flash(..));
        let presence = |(cloud, cover): (&CloudFrame, &Cover)| {
            if is_flash && (!in_fields || cloud.flash(frame.by).is_none()) {
                return Presence::Away;
            }
            // Under a layer there is no place that it does not shade.
            if !cover.tiles.is_empty() || (shaded && cloud.medium.layer.is_some()) {
                Presence::Seen
            } else if shaded && may_shade(frame, cloud) {
                Presence::Shading
            } else {
                Presence::Away
            }
        };
        self.presence = frame.clouds.iter().zip(covers).map(presence).collect();
        if settings.transport.0.needs.sun && !is_flash {
            self.before.find(frame);
            self.ask_for_shades();
        } else {
            self.before.clear();
        }
        self.presence.iter().map(|here| *here != Presence::Away).collect()
    }

    /// Clouds that shade those in view are asked for their shadow at the least.
    fn ask_for_shades(&mut self) {
        for (shaded, before) in self.before.lists().iter().enumerate() {
            if self.presence[shaded] != Presence::Seen {
                continue;
            }
            for &other in before {
                let presence = &mut self.presence[other as usize];
                if *presence == Presence::Away {
                    *presence = Presence::Shading;
                }
            }
        }
    }

    /// Makes what air and ground have of it.
    pub fn prepare_sky(&mut self, room: &Room<'_>, encoder: &mut wgpu::CommandEncoder, frame: &Frame) {
        let Room { device, queue, timing, .. } = *room;
        self.redone += self.sky.prepare(device, queue, encoder, &frame.sky, &frame.camera, timing).count();
        self.sky.prepare_ground(device, queue, encoder, &frame.ground_settings(), timing);
    }

    /// Makes its light in the clouds and then its shadows, under this sky or under its own.
    pub fn prepare(
        &mut self,
        room: &Room<'_>,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        sky: Option<&Sky>,
        flush: Flush<'_>,
    ) {
        let Settings { quality, transport, lights_at_once, light_slack_deg, .. } = room.settings;
        let own = sky.unwrap_or(&self.sky);
        let inputs = Inputs {
            device: room.device,
            queue: room.queue,
            media: room.media,
            to_sun: frame.sun.to_sun,
            by: frame.by,
            needs: transport.0.needs,
            lit_by_sky: frame.by == LitBy::Sky && own.lights(),
            sky: own,
            slack_deg: *light_slack_deg,
            timing: room.timing,
        };
        let asked = Request {
            frame,
            quality,
            presence: &self.presence,
            before: self.before.lists(),
            most: *lights_at_once,
        };
        self.clouds.prepare(encoder, &inputs, &asked, flush);
        self.prepare_shadows(room, encoder, frame);
    }

    fn prepare_shadows(&mut self, room: &Room<'_>, encoder: &mut wgpu::CommandEncoder, frame: &Frame) {
        let shadows = room.settings.shadows;
        let inputs = ShadowInputs {
            device: room.device,
            queue: room.queue,
            frame,
            sky: &self.sky,
            aerial: room.settings.aerial,
            timing: room.timing,
        };
        let (on_ground, on_layers) = (is_shaded(frame, shadows), may_shade_layers(frame, shadows));
        let casters = self.clouds.casters();
        let texels = room.settings.quality.shadow_texels;
        if on_layers {
            self.redone += self.shadows.prepare_on_layers(&inputs, encoder, casters, texels / 2);
        } else {
            self.shadows.none_on_layers();
        }
        if on_ground {
            self.redone += self.shadows.prepare(&inputs, encoder, casters, texels);
        } else {
            self.shadows.none();
        }
    }

    /// Draws the sky in its light over the whole of a target, or on top of what is there.
    pub fn draw_sky(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        target: (&wgpu::TextureView, wgpu::TextureFormat),
        adds: bool,
        timing: Option<&Timing>,
    ) {
        self.sky.draw_shaded(device, encoder, target, adds, &self.shadows, timing);
    }

    /// Whether a cloud is in the picture with its light.
    pub fn is_ready(&mut self, cloud: usize) -> bool {
        self.presence[cloud] == Presence::Seen && self.clouds.get(cloud).is_some()
    }

    /// Whether a cloud is drawn by this entry: visibilities are of those that cross others.
    fn is_drawn(&self, cloud: usize, room: &Room<'_>, entry: &str) -> bool {
        self.presence[cloud] == Presence::Seen && (entry != VISIBILITY || room.crossings.of(cloud).is_some())
    }

    /// The clouds in the picture, far ones first, each with its number.
    pub fn draws(
        &mut self,
        room: &Room<'_>,
        (march, counters): (&mut March, &Counters),
        frame: &Frame,
        sky: Option<&Sky>,
        way: Way<'_>,
    ) -> Vec<(usize, Draw)> {
        let Way { depth, entry, format, adds, mattes } = way;
        let order: Vec<_> =
            far_to_near(frame).into_iter().filter(|&i| self.is_drawn(i, room, entry)).collect();
        let (sky, shadows, settings) = (sky.unwrap_or(&self.sky), &self.shadows, room.settings);
        let crossings = room.crossings;
        let view =
            View { frame, settings, depth, sky, shadows, crossings, counters, entry, format, adds, mattes };
        march.prepare(&view, &order, room.covers, room.media, &mut self.clouds)
    }
}

/// Whether clouds may cast shadows on layers.
fn may_shade_layers(frame: &Frame, shadows: bool) -> bool {
    let is_layer = |cloud: &CloudFrame| cloud.medium.layer.is_some();
    let parallel = !matches!(frame.by, LitBy::Flash(..));
    shadows
        && parallel
        && frame.sun.to_sun.y > LOWEST_LIGHT
        && frame.clouds.len() > 1
        && frame.clouds.iter().any(is_layer)
}

/// Whether clouds cast shadows on ground and air in a picture of `frame`.
fn is_shaded(frame: &Frame, shadows: bool) -> bool {
    shadows && frame.by == LitBy::Sky && frame.sky.atmosphere && frame.sun.to_sun.y > LOWEST_LIGHT
}
