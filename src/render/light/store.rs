//! The light of all clouds: made for those in the picture, kept between frames, and dropped where
//! it would take more memory than a scene may have.

use std::collections::{HashMap, VecDeque};

use super::{
    field::eye_of,
    inputs::Inputs,
    plan::{Detail, allowance, plan},
    prepare::{CloudLight, LightPass, Wanted, box_of},
    shading::{Ahead, Shading},
};
use crate::{
    frame::{CloudFrame, Frame},
    render::{Quality, medium::Media, shadow::Caster},
};

/// Where a cloud is, exactly: light that was made for it is found again by this, whichever
/// number the cloud has now.
type Place = [u64; 3];

fn place(cloud: &CloudFrame) -> Place {
    cloud.origin.to_array().map(f64::to_bits)
}

/// Light of a cloud.
struct Kept {
    place: Place,
    /// Which of the clouds it was in the last picture.
    number: usize,
    light: CloudLight,
    /// Number of the picture that it was made for.
    made: u64,
}

/// What a picture wants of a cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) enum Presence {
    /// It is in view, and lit.
    Seen,
    /// Its shadow may be.
    Shading,
    Away,
}

/// Light by cloud.
#[derive(Default)]
pub(in crate::render) struct LightStore {
    pass: LightPass,
    lights: Vec<Option<Kept>>,
    /// Of clouds that are not in the picture.
    away: Vec<Kept>,
    ahead: Ahead,
    pictures: u64,
    /// How many volumes were made so far.
    pub redone: u32,
    /// Clouds of the last picture whose light is of another moment, or is yet to be made.
    pub waiting: u32,
}

impl LightStore {
    /// Light of cloud `index` of the frame that was prepared last; none where it is out of view.
    pub fn get(&mut self, index: usize) -> Option<&mut CloudLight> {
        self.lights.get_mut(index)?.as_mut().map(|kept| &mut kept.light)
    }

    /// What clouds of the frame cast shadows with, by their numbers: of those whose light is there.
    pub fn casters(&self, frame: &Frame) -> Vec<(usize, Caster)> {
        let lights = frame.clouds.iter().zip(&self.lights).enumerate();
        lights
            .filter_map(|(number, (cloud, kept))| {
                let (light_box, volume) = kept.as_ref()?.light.sunlight()?;
                let turning = 1.0 - cloud.medium.species.asymmetry;
                let caster = Caster { origin: cloud.origin, light_box, volume: volume.clone(), turning };
                Some((number, caster))
            })
            .collect()
    }

    /// Memory of all textures of light, bytes.
    pub fn bytes(&self) -> u64 {
        self.lights.iter().flatten().chain(&self.away).map(|kept| kept.light.bytes()).sum()
    }

    /// Makes what the clouds lack of light by their `presence`, for `most` clouds: those first that have none or
    /// the oldest. Each is in the shadow of those `before` it. `flush` may submit what is recorded so far, after each of them, and end it.
    #[allow(clippy::too_many_arguments, reason = "light, clouds, and how much of it")]
    pub fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        media: &Media,
        frame: &Frame,
        quality: &Quality,
        presence: &[Presence],
        before: &[Vec<u32>],
        most: u32,
        flush: &mut dyn FnMut(&mut wgpu::CommandEncoder) -> bool,
    ) {
        self.pictures += 1;
        self.waiting = 0;
        let (mut known, mut rest) = self.found(frame);
        let in_view: Vec<_> = presence.iter().map(|here| *here == Presence::Seen).collect();
        let details = plan(quality, &frame.clouds, &in_view, &frame.camera, frame.camera_position);
        let planned: u64 = details.iter().flatten().map(|detail| detail.bytes()).sum();
        let seen = in_view.iter().filter(|seen| **seen).count();
        let mut spare = allowance(quality, seen).saturating_sub(planned);
        let casts = |index: usize| {
            (presence[index] == Presence::Shading && inputs.needs.sun).then(|| {
                let kept = known[index].as_ref().filter(|kept: &&Kept| kept.light.bytes() <= spare);
                let cloud = &frame.clouds[index];
                // What it had when it was in view does, and is there when it comes back.
                let of = kept.and_then(|kept| kept.light.shades(cloud, inputs).cloned());
                of.unwrap_or_else(|| box_of(inputs, cloud, Detail::SHADOW))
            })
        };
        let shading = Shading::new(inputs, frame, before, &details, casts);
        let mut order: Vec<_> = (0..frame.clouds.len()).collect();
        // Shadows of clouds out of view come last.
        order.sort_by_key(|&index| (!in_view[index], known[index].as_ref().map(|kept| kept.made)));
        self.lights.resize_with(frame.clouds.len(), || None);
        let mut left = most;
        for index in order {
            let cloud = &frame.clouds[index];
            let before = known[index].take();
            let wanted = match (details[index], shading.of(index)) {
                (Some(detail), _) => Wanted::new(inputs, cloud, shading.shades(index), detail),
                (None, Some(of)) => {
                    let has = |kept: &Kept| kept.light.volume_in(of).is_some() && kept.light.bytes() <= spare;
                    if before.as_ref().is_some_and(has) {
                        let (place, number) = (place(cloud), index);
                        self.lights[index] = before.map(|kept| Kept { place, number, ..kept });
                        spare -= self.lights[index].as_ref().map_or(0, |kept| kept.light.bytes());
                        continue;
                    }
                    Wanted::shadow(inputs, of.clone())
                }
                (None, None) => {
                    rest.extend(before.map(|kept| Kept { number: index, ..kept }));
                    continue;
                }
            };
            let is_current = before.as_ref().is_some_and(|kept| kept.light.is(&wanted));
            self.lights[index] = if is_current || left == 0 {
                self.waiting += u32::from(!is_current);
                let place = place(cloud);
                before.filter(|kept| kept.light.stands_in_for(&wanted)).map(|kept| Kept {
                    place,
                    number: index,
                    ..kept
                })
            } else {
                let light = |other: usize| {
                    let kept = self.lights[other].as_ref().or(known[other].as_ref());
                    kept.map(|kept| &kept.light)
                };
                let shades = !wanted.shades().is_empty();
                let others = if shades {
                    let (of, made) = ((&shading, index), (&mut self.pass.sun, light));
                    self.ahead.before(encoder, inputs, media, of, made)
                } else {
                    Vec::new()
                };
                let alone = self.ahead.take(index, shading.of(index));
                let before = before.map(|kept| kept.light);
                let redone = &mut self.redone;
                let light = self.pass.prepare(encoder, inputs, media, wanted, before, alone, &others, redone);
                left = if flush(encoder) { left - 1 } else { 0 };
                Some(Kept { place: place(cloud), number: index, light, made: self.pictures })
            };
            if let Some(kept) = &mut self.lights[index] {
                let eye = eye_of(&frame.camera, frame.camera_position, cloud.origin);
                self.pass.see(encoder, inputs, &mut kept.light, eye);
            }
        }
        if self.waiting == 0 {
            self.ahead.clear();
        }
        self.keep(frame, rest, allowance(quality, seen));
    }

    /// The light kept for each cloud of `frame`, and the light that is left. Clouds are known by
    /// where they are, and of several in one place by their number; a cloud that has moved is
    /// known by its number alone.
    fn found(&mut self, frame: &Frame) -> (Vec<Option<Kept>>, Vec<Kept>) {
        let lights = std::mem::take(&mut self.lights);
        let before: Vec<_> = lights.iter().map(|light| light.as_ref().map(|kept| kept.place)).collect();
        let mut known: HashMap<Place, VecDeque<Kept>> = HashMap::new();
        for kept in lights.into_iter().flatten().chain(std::mem::take(&mut self.away)) {
            known.entry(kept.place).or_default().push_back(kept);
        }
        let mut own = |place: Place, number: usize| {
            let there = known.get_mut(&place)?;
            there.remove(there.iter().position(|kept| kept.number == number)?)
        };
        let places: Vec<_> = frame.clouds.iter().map(place).collect();
        let mut found: Vec<_> = places.iter().zip(0..).map(|(&place, number)| own(place, number)).collect();
        for (kept, place) in found.iter_mut().zip(&places).filter(|(kept, _)| kept.is_none()) {
            *kept = known.get_mut(place).and_then(VecDeque::pop_front);
        }
        for (kept, place) in found.iter_mut().zip(&before).filter(|(kept, _)| kept.is_none()) {
            *kept = place.and_then(|place| known.get_mut(&place)).and_then(VecDeque::pop_front);
        }
        (found, known.into_values().flatten().collect())
    }

    /// Keeps light of clouds of the frame that are out of view, as long as all of it fits.
    fn keep(&mut self, frame: &Frame, mut rest: Vec<Kept>, most: u64) {
        let numbers: HashMap<_, _> = frame.clouds.iter().map(place).zip(0..).collect();
        rest.retain(|kept| numbers.contains_key(&kept.place));
        rest.sort_by_key(|kept| numbers[&kept.place]);
        let mut total = self.bytes();
        self.away.extend(rest.into_iter().take_while(|kept| {
            total += kept.light.bytes();
            total <= most
        }));
    }
}
