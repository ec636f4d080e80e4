//! What comes before a picture: where the clouds are in it, and all that its light needs. Where nothing changed since
//! the last picture nothing is done.

use std::sync::Arc;

use rayon::prelude::*;

use super::{Flush, Lamp, Renderer, Room, Target, far_to_near};
use crate::{
    frame::{CloudFrame, Frame, LitBy},
    render::{
        Settings,
        light::Clouds,
        march::{Cover, Crossings, Draw, MANY, Parts, Seen, Touching},
    },
};

/// Pictures for which a light that does not shine keeps what it has.
const FLICKER: u32 = 120;

/// What was last prepared.
pub(super) struct Prepared {
    frame: Frame,
    settings: Settings,
    /// Which clouds have a volume of depths.
    baked: Vec<bool>,
}

/// What was last drawn of it.
#[derive(Clone)]
pub(super) struct Drawn {
    /// How often the march had filled what it binds, the entry and the format.
    pub by: (u64, &'static str, wgpu::TextureFormat),
    /// Visibilities of clouds that cross.
    pub crossing: Arc<[Draw]>,
    pub draws: Arc<[Draw]>,
}

/// Where the clouds are in the picture.
#[derive(Default)]
pub(super) struct Covers {
    parts: Option<Parts>,
    all: Vec<Cover>,
    /// Which clouds touch, and of which clouds that is.
    touching: Touching,
    of: Clouds,
}

impl Covers {
    pub fn all(&self) -> &[Cover] {
        &self.all
    }

    /// Finds those of `frame`, some of whose clouds are `baked`.
    fn find(&mut self, frame: &Frame, baked: &[bool]) {
        let known = self.parts.take().filter(|parts| parts.are_of(&frame.camera));
        let parts = &*self.parts.insert(known.unwrap_or_else(|| Parts::new(&frame.camera)));
        if !self.of.are_of(frame) {
            (self.of, self.touching) = (Clouds::of(frame), Touching::find(&frame.clouds));
        }
        let touching = &self.touching;
        let cover = |(number, (cloud, &baked)): (usize, (&CloudFrame, &bool))| {
            cover(parts, frame, cloud, baked, touching.any(number))
        };
        frame.clouds.par_iter().zip(baked).enumerate().map(cover).collect_into_vec(&mut self.all);
    }
}

/// Where a cloud is in the picture; with distances where it may cross others.
fn cover(parts: &Parts, frame: &Frame, cloud: &CloudFrame, baked: bool, crosses: bool) -> Cover {
    let eye = (frame.camera_position - cloud.origin).as_vec3();
    let medium = &cloud.medium;
    if let Some(layer) = &medium.layer {
        let bend = 0.5 / frame.sky.uniform.atmosphere.ground_radius;
        let mut cover = Cover::of_layer(&frame.camera, eye, layer, bend);
        if crosses {
            cover.measure_layer(&frame.camera, eye, layer, bend);
        }
        return cover;
    }
    // The index of a mesh or a volume tells rays where something is.
    let baked = baked || medium.is_held();
    let many = if baked { usize::MAX } else { MANY };
    let half = medium.is_of_ellipsoids().then(|| cloud.half.as_vec3());
    let seen = Seen { eye, ellipsoids: &medium.ellipsoids, half, many };
    let mut cover = Cover::new(parts, &seen);
    if crosses {
        cover.measure(&frame.camera, &seen);
    }
    if baked {
        cover.candidates.clear();
    }
    cover
}

impl Renderer {
    /// Whether `target` holds `frame` as this renderer drew it there last, if the caller did not touch it since: then
    /// nothing need be drawn, and the device does nothing. Never where the caller's depth is part of the target, nor
    /// while clouds wait for their light or [`Settings`] are others.
    pub fn shows(&self, frame: &Frame, target: &Target<'_>) -> bool {
        let shown = self.shown.as_ref();
        target.depth.is_none()
            && shown.is_some_and(|(color, sky)| color == target.color && *sky == target.sky)
            && self.is_prepared(frame)
    }

    /// Whether all that `frame` needs is at hand, from the last picture.
    fn is_prepared(&self, frame: &Frame) -> bool {
        let same = |prepared: &Prepared| prepared.settings == self.settings && prepared.frame == *frame;
        let is_dark = |lamp: &Lamp| lamp.dark_for > 0;
        self.lights_waiting() == 0
            && !self.further.iter().flatten().any(is_dark)
            && self.prepared.as_ref().is_some_and(same)
    }

    pub(super) fn prepare(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame, flush: Flush<'_>) {
        if self.settings.counting {
            self.counters.clear(encoder);
        }
        self.march.begin();
        if self.is_prepared(frame) {
            return;
        }
        (self.drawn, self.shown) = (None, None);
        self.media.begin(self.settings.bake_from);
        self.media.plan(frame.clouds.iter().map(|cloud| &*cloud.medium));
        self.find(frame);
        let further = frame.lit_apart();
        self.keep_lamps(&further);
        self.prepare_media(encoder, frame, &further);
        let room = Room {
            device: &self.device,
            queue: &self.queue,
            settings: &self.settings,
            timing: self.timing.as_ref(),
            media: &self.media,
            covers: self.covers.all(),
            crossings: &self.crossings,
        };
        let for_sun = self.settings.of_sun(frame);
        self.sun.prepare_sky(&room, encoder, frame);
        self.sun.prepare(&Room { settings: &for_sun, ..room }, encoder, frame, None, flush);
        for (number, frame) in &further {
            let Some(lamp) = &mut self.further[*number] else { continue };
            let above = frame.by == LitBy::Sky;
            if above {
                lamp.prepare_sky(&room, encoder, frame);
            }
            lamp.prepare(&room, encoder, frame, (!above).then_some(&self.sun.sky), flush);
        }
        self.crossings = self.find_crossings(frame);
    }

    /// Where clouds that have their light cross.
    fn find_crossings(&mut self, frame: &Frame) -> Crossings {
        if !self.settings.crossings {
            return Crossings::default();
        }
        let mut order = far_to_near(frame);
        order.retain(|&cloud| self.sun.is_ready(cloud));
        Crossings::find(&self.device, frame, &self.covers.touching, &order, self.covers.all())
    }

    /// Finds where the clouds are in the picture, where they or the camera moved, and keeps what it was prepared for.
    fn find(&mut self, frame: &Frame) {
        // Told before: what is of the device may not go from thread to thread in a browser.
        let baked: Vec<_> = frame.clouds.iter().map(|cloud| self.media.is_baked(&cloud.medium)).collect();
        let same = |prepared: &Prepared| {
            let before = &prepared.frame;
            before.camera == frame.camera
                && before.camera_position == frame.camera_position
                && before.sky.uniform.atmosphere == frame.sky.uniform.atmosphere
                && before.clouds == frame.clouds
                && prepared.baked == baked
        };
        if !self.prepared.as_ref().is_some_and(same) {
            self.covers.find(frame, &baked);
        }
        self.prepared = Some(Prepared { frame: frame.clone(), settings: self.settings, baked });
    }

    /// One for each light beside the sun that shines; what others held is given back after a while, for some flicker.
    fn keep_lamps(&mut self, further: &[(usize, Frame)]) {
        for (number, lamp) in self.further.iter_mut().enumerate() {
            if further.iter().any(|(shining, _)| *shining == number) {
                lamp.get_or_insert_with(|| Lamp::new(&self.device)).dark_for = 0;
            } else if lamp.as_mut().is_some_and(|lamp| lamp.stays_dark() > FLICKER) {
                *lamp = None;
            }
        }
    }

    /// Bakes what is seen or casts a shadow in any light.
    fn prepare_media(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        further: &[(usize, Frame)],
    ) {
        let mut wanted = self.sun.find(frame, &self.settings, self.covers.all());
        for (number, frame) in further {
            let Some(lamp) = &mut self.further[*number] else { continue };
            let own = lamp.find(frame, &self.settings, self.covers.all());
            wanted.iter_mut().zip(own).for_each(|(wanted, own)| *wanted |= own);
        }
        for (cloud, _) in frame.clouds.iter().zip(wanted).filter(|(_, wanted)| *wanted) {
            self.media.prepare(encoder, &cloud.medium);
        }
    }
}
