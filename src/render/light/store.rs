//! The light of all clouds: made for those in the picture, kept between frames, and dropped where
//! it would take more memory than a scene may have.

use std::collections::{HashMap, VecDeque};

use super::{
    around::{Around, Surroundings},
    field::eye_of,
    inputs::Inputs,
    moment::Moment,
    plan::{Detail, allowance, plan},
    prepare::{CloudLight, LightPass, Wanted, box_of},
    shading::{Ahead, Shading},
    slack::Slack,
};
use crate::{
    frame::{CloudFrame, Frame},
    render::{Quality, shadow::Caster},
};

/// Where a cloud is, exactly: light that was made for it is found again by this, whichever
/// number the cloud has now.
type Place = [u64; 3];

fn place(cloud: &CloudFrame) -> Place {
    cloud.origin.to_array().map(f64::to_bits)
}

/// Light that is submitted at once where it is made in pieces, bytes: of one large cloud in draft quality, or of a dozen
/// that are small in the picture.
const ENOUGH: u64 = 1 << 20;

/// Light of a cloud.
struct Kept {
    place: Place,
    /// Which of the clouds it was in the last picture.
    number: usize,
    light: CloudLight,
    /// Number of the picture that it was made for.
    made: u64,
    /// What it was last found good for.
    good: Option<Good>,
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

/// What is asked of the light of a frame.
pub(in crate::render) struct Request<'a> {
    pub frame: &'a Frame,
    pub quality: &'a Quality,
    pub presence: &'a [Presence],
    /// Which clouds stand before each.
    pub before: &'a [Vec<u32>],
    /// Clouds whose light is made, at most.
    pub most: u32,
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
    moment: Option<Moment>,
    /// How many moments there were.
    moments: u64,
    /// What was last asked for, and given.
    asked: Option<Asked>,
    casters: Vec<Caster>,
    /// How many volumes were made so far.
    pub redone: u32,
    /// Clouds of the last picture whose light is of another moment, or is yet to be made.
    pub waiting: u32,
}

/// What a picture asks of the light of a moment.
#[derive(PartialEq)]
struct Asked {
    moment: u64,
    /// Light that was near enough for another slack may not be for this one.
    slack_deg: f64,
    presence: Vec<Presence>,
    details: Vec<Option<Detail>>,
    allowance: u64,
}

impl Asked {
    /// What a cloud's light is good for: the moment, its own detail, and those of the clouds before it. None for clouds
    /// out of view.
    fn of(&self, index: usize, shading: &Shading<'_>) -> Option<Good> {
        let others = shading.numbers(index).map(|other| self.details[other]);
        let (moment, slack_deg) = (self.moment, self.slack_deg);
        Some(Good { moment, slack_deg, detail: self.details[index]?, others: others.collect() })
    }
}

/// What light was last found good for.
#[derive(Clone, PartialEq)]
struct Good {
    moment: u64,
    slack_deg: f64,
    detail: Detail,
    others: Vec<Option<Detail>>,
}

impl LightStore {
    /// Light of cloud `index` of the frame that was prepared last; none where it is out of view.
    pub fn get(&mut self, index: usize) -> Option<&mut CloudLight> {
        self.lights.get_mut(index)?.as_mut().map(|kept| &mut kept.light)
    }

    /// What clouds of the frame cast shadows with: of those whose light is there.
    pub fn casters(&self) -> &[Caster] {
        &self.casters
    }

    fn found_casters(&self, frame: &Frame) -> Vec<Caster> {
        let lights = frame.clouds.iter().zip(&self.lights).enumerate();
        lights
            .filter_map(|(number, (cloud, kept))| {
                let (light_box, volume) = kept.as_ref()?.light.sunlight()?;
                let turning = 1.0 - cloud.medium.species.asymmetry;
                Some(Caster { number, origin: cloud.origin, light_box, volume: volume.clone(), turning })
            })
            .collect()
    }

    /// Memory of all textures of light, bytes.
    pub fn bytes(&self) -> u64 {
        self.lights.iter().flatten().chain(&self.away).map(|kept| kept.light.bytes()).sum()
    }

    /// Makes what the clouds lack of light: those first that have none or the oldest. `flush` may submit what is recorded so
    /// far, now and then, and end it.
    pub fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        request: &Request<'_>,
        flush: &mut dyn FnMut(&mut wgpu::CommandEncoder) -> bool,
    ) {
        let &Request { frame, quality, presence, .. } = request;
        self.pictures += 1;
        let same = self.moment.as_ref().is_some_and(|moment| moment.is(inputs, frame));
        if !same {
            self.moment = Some(Moment::new(inputs, frame));
            self.moments += 1;
        }
        let in_view: Vec<_> = presence.iter().map(|here| *here == Presence::Seen).collect();
        let details = plan(quality, &frame.clouds, &in_view, &frame.camera, frame.camera_position);
        let seen = in_view.iter().filter(|seen| **seen).count();
        let allowance = allowance(quality, seen);
        let (moment, slack_deg, presence) = (self.moments, inputs.slack_deg, presence.to_vec());
        let asked = Asked { moment, slack_deg, presence, details, allowance };
        if self.waiting > 0 || self.asked.as_ref() != Some(&asked) {
            self.waiting = 0;
            self.make(encoder, inputs, request, &asked, same, flush);
            self.casters = self.found_casters(frame);
            self.asked = Some(asked);
        }
        self.see(encoder, inputs, frame, &in_view);
    }

    /// Goes through all clouds: takes over what is good, and makes the rest. `same` tells whether they are where they were.
    fn make(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        &Request { frame, before, most, .. }: &Request<'_>,
        asked: &Asked,
        same: bool,
        flush: &mut dyn FnMut(&mut wgpu::CommandEncoder) -> bool,
    ) {
        let (mut known, mut rest) = if same { self.found_again(frame) } else { self.found(frame) };
        let planned: u64 = asked.details.iter().flatten().map(|detail| detail.bytes()).sum();
        let mut spare = asked.allowance.saturating_sub(planned);
        let casts = |index: usize| {
            (asked.presence[index] == Presence::Shading && inputs.needs.sun).then(|| {
                let kept = known[index].as_ref().filter(|kept: &&Kept| kept.light.bytes() <= spare);
                let cloud = &frame.clouds[index];
                // What it had when it was in view does, and is there when it comes back.
                let of = kept.and_then(|kept| kept.light.shades(cloud, inputs).cloned());
                of.unwrap_or_else(|| box_of(inputs, cloud, Detail::SHADOW))
            })
        };
        let shading = Shading::new(inputs, frame, before, &asked.details, casts);
        let mut order: Vec<_> = (0..frame.clouds.len()).collect();
        // Shadows of clouds out of view come last.
        order.sort_by_key(|&index| {
            (asked.presence[index] != Presence::Seen, known[index].as_ref().map(|kept| kept.made))
        });
        self.lights.resize_with(frame.clouds.len(), || None);
        let mut surroundings = None;
        let grounded = inputs.lit_by_sky && inputs.sky.has_atmosphere();
        let (mut left, mut recorded) = (most, 0);
        for index in order {
            let cloud = &frame.clouds[index];
            let before = known[index].take().map(|kept| Kept { number: index, ..kept });
            let good = asked.of(index, &shading);
            if before.as_ref().is_some_and(|kept| kept.good.is_some() && kept.good == good) {
                self.lights[index] = before;
                continue;
            }
            let wanted = match (asked.details[index], shading.of(index)) {
                (Some(detail), _) => {
                    let around = if inputs.needs.field {
                        surroundings
                            .get_or_insert_with(|| Surroundings::of(frame, inputs.to_sun.y, grounded))
                            .around(index, cloud)
                    } else {
                        Around::default()
                    };
                    Wanted::new(inputs, cloud, shading.shades(index), around, detail)
                }
                (None, Some(of)) => {
                    let has = |kept: &Kept| kept.light.volume_in(of).is_some() && kept.light.bytes() <= spare;
                    if before.as_ref().is_some_and(has) {
                        let place = place(cloud);
                        self.lights[index] = before.map(|kept| Kept { place, ..kept });
                        spare -= self.lights[index].as_ref().map_or(0, |kept| kept.light.bytes());
                        continue;
                    }
                    Wanted::shadow(inputs, of.clone())
                }
                (None, None) => {
                    rest.extend(before);
                    continue;
                }
            };
            let slack = Slack::new(inputs.slack_deg, cloud.half);
            let is_current = before.as_ref().is_some_and(|kept| kept.light.is_near(&wanted, slack));
            self.lights[index] = if is_current || left == 0 {
                self.waiting += u32::from(!is_current);
                let place = place(cloud);
                let good = good.filter(|_| is_current);
                before.filter(|kept| kept.light.stands_in_for(&wanted)).map(|kept| Kept {
                    place,
                    good,
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
                    self.ahead.before(encoder, inputs, of, made)
                } else {
                    Vec::new()
                };
                let alone = self.ahead.take(index, shading.of(index));
                let before = before.map(|kept| kept.light);
                let redone = &mut self.redone;
                let light = self.pass.prepare(encoder, inputs, wanted, before, alone, &others, redone);
                left -= 1;
                recorded += light.bytes();
                if recorded >= ENOUGH {
                    recorded = 0;
                    left = if flush(encoder) { left } else { 0 };
                }
                Some(Kept { place: place(cloud), number: index, light, made: self.pictures, good })
            };
        }
        if self.waiting == 0 {
            self.ahead.clear();
        }
        self.keep(frame, rest, asked.allowance);
    }

    /// Finds what of solved light goes to the eye, in clouds in view from which that has moved.
    fn see(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        frame: &Frame,
        in_view: &[bool],
    ) {
        let clouds = frame.clouds.iter().zip(&mut self.lights).zip(in_view).filter(|(_, seen)| **seen);
        let lights = clouds.filter_map(|((cloud, kept), _)| {
            Some((&mut kept.as_mut()?.light, eye_of(&frame.camera, frame.camera_position, cloud.origin)))
        });
        self.pass.see(encoder, inputs, lights);
    }

    /// The light kept for each cloud of a frame whose clouds are those of the last one.
    fn found_again(&mut self, frame: &Frame) -> (Vec<Option<Kept>>, Vec<Kept>) {
        let mut found = std::mem::take(&mut self.lights);
        found.resize_with(frame.clouds.len(), || None);
        let mut rest = Vec::new();
        for kept in std::mem::take(&mut self.away) {
            let same = frame.clouds.get(kept.number).is_some_and(|cloud| place(cloud) == kept.place);
            match found.get_mut(kept.number) {
                Some(empty @ None) if same => *empty = Some(kept),
                _ => rest.push(kept),
            }
        }
        (found, rest)
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
        if rest.is_empty() {
            return;
        }
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
