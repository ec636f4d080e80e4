//! What is drawn of the clouds: which, in what order, in which lights.

use std::{collections::HashMap, sync::Arc};

use super::{Drawn, Renderer, Room, Way};
use crate::{
    frame::{Frame, LitBy},
    render::{
        Settings, Transport,
        march::{Draw, VISIBILITY},
    },
};

impl Renderer {
    /// The clouds in the picture in all lights, far ones first: those of the last picture where they are the same.
    pub(super) fn draws(&mut self, frame: &Frame, way: Way<'_>) -> Drawn {
        let wanted = (self.march.filled, way.entry, way.format);
        if let Some(drawn) = self.drawn.as_ref().filter(|drawn| way.depth.is_none() && drawn.by == wanted) {
            return drawn.clone();
        }
        let crossing = self.crossing_draws(frame, way);
        let mut draws = self.draws_of(frame, None, way);
        for (number, frame) in frame.lit_apart() {
            let own = self.draws_of(&frame, Some(number), Way { adds: true, ..way });
            draws = each_over_its_own(draws, own);
        }
        let draws: Arc<[Draw]> = in_order(draws);
        let by = (self.march.filled, way.entry, way.format);
        let drawn = Drawn { by, crossing, draws };
        // With a caller's depth other distances are told.
        self.drawn = way.depth.is_none().then(|| drawn.clone());
        drawn
    }

    /// The clouds that cross others into their visibilities.
    pub(super) fn crossing_draws(&mut self, frame: &Frame, way: Way<'_>) -> Arc<[Draw]> {
        if self.crossings.is_empty() {
            return Arc::default();
        }
        self.march.make_room(&self.crossings);
        in_order(self.draws_of(frame, None, Way { entry: VISIBILITY, ..way }))
    }

    /// Clouds in a light that not all of them have, among the others, which are dark and stand before some.
    pub(super) fn among_dark(
        &mut self,
        frame: &Frame,
        own: Vec<(usize, Draw)>,
        way: Way<'_>,
    ) -> Vec<(usize, Draw)> {
        let dark = Settings { transport: Transport::DARK, ..self.settings };
        let all = self.draws_with(&dark, frame, None, way);
        let mut own: HashMap<usize, Draw> = own.into_iter().collect();
        all.into_iter().map(|(cloud, dark)| (cloud, own.remove(&cloud).unwrap_or(dark))).collect()
    }

    /// The same in the light of the sun, or of another by its number.
    pub(super) fn draws_of(
        &mut self,
        frame: &Frame,
        number: Option<usize>,
        way: Way<'_>,
    ) -> Vec<(usize, Draw)> {
        let settings = if number.is_none() { self.settings.of_sun(frame) } else { self.settings };
        self.draws_with(&settings, frame, number, way)
    }

    /// The same with other settings.
    fn draws_with(
        &mut self,
        settings: &Settings,
        frame: &Frame,
        number: Option<usize>,
        way: Way<'_>,
    ) -> Vec<(usize, Draw)> {
        let room = Room {
            device: &self.device,
            queue: &self.queue,
            settings,
            timing: self.timing.as_ref(),
            media: &self.media,
            covers: self.covers.all(),
            crossings: &self.crossings,
        };
        let march = (&mut self.march, &self.counters);
        let Some(number) = number else { return self.sun.draws(&room, march, frame, None, way) };
        let sky = (frame.by != LitBy::Sky).then_some(&self.sun.sky);
        let lamp = self.further[number].as_mut();
        lamp.map_or_else(Vec::new, |lamp| lamp.draws(&room, march, frame, sky, way))
    }
}

/// Clouds in one light after the same clouds in those before; clouds that have none of those have none at all.
fn each_over_its_own(draws: Vec<(usize, Draw)>, own: Vec<(usize, Draw)>) -> Vec<(usize, Draw)> {
    let mut own: HashMap<usize, Draw> = own.into_iter().collect();
    let mut all = Vec::with_capacity(draws.len() + own.len());
    let mut draws = draws.into_iter().peekable();
    while let Some((cloud, draw)) = draws.next() {
        all.push((cloud, draw));
        if draws.peek().is_none_or(|(next, _)| *next != cloud) {
            all.extend(own.remove(&cloud).map(|draw| (cloud, draw)));
        }
    }
    all
}

/// The clouds by number, far ones first. What is beyond a layer, in height, is farther than it, however near it is.
pub(super) fn far_to_near(frame: &Frame) -> Vec<usize> {
    let eye = frame.camera_position;
    let is_layer = |i: usize| frame.clouds[i].medium.layer.is_some();
    let height = |i: usize| frame.clouds[i].origin.y - eye.y;
    let layers: Vec<usize> = (0..frame.clouds.len()).filter(|&i| is_layer(i)).collect();
    let before = |i: usize, layer: usize| {
        let (far, near) = (height(i), height(layer));
        layer != i && far.signum() == near.signum() && near.abs() < far.abs()
    };
    let layers_before = |i: usize| layers.iter().filter(|&&layer| before(i, layer)).count();
    let distance = |i: usize| (frame.clouds[i].origin - eye).length();
    let mut order: Vec<usize> = (0..frame.clouds.len()).collect();
    order.sort_by(|&a, &b| {
        let beyond = layers_before(b).cmp(&layers_before(a)).then(is_layer(b).cmp(&is_layer(a)));
        beyond.then(distance(b).total_cmp(&distance(a)))
    });
    order
}

/// Without the numbers of the clouds.
pub(super) fn in_order(draws: Vec<(usize, Draw)>) -> Arc<[Draw]> {
    draws.into_iter().map(|(_, draw)| draw).collect()
}
