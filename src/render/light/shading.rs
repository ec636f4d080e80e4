//! Shadows of clouds on clouds: what casts them is each cloud's own optical depth to the sun, which is made for its own
//! light anyway, or for nothing else where it is out of view.

use std::collections::HashMap;

use wgpu::TextureView;

use super::{
    inputs::Inputs,
    plan::Detail,
    prepare::{CloudLight, box_of},
    sun::{BoxKey, Shade, SunPass, SunVolume},
};
use crate::frame::{CloudFrame, Frame};

/// What the clouds of a frame cast their shadows with.
pub(super) struct Shading<'a> {
    frame: &'a Frame,
    /// Which clouds stand before each.
    before: &'a [Vec<u32>],
    /// Where each cloud's own optical depth is told; none where nothing asks for it.
    boxes: Vec<Option<BoxKey>>,
}

impl<'a> Shading<'a> {
    /// Of clouds whose own light is as fine as `details` tell; `others` are the boxes of those without any.
    pub fn new(
        inputs: &Inputs<'_>,
        frame: &'a Frame,
        before: &'a [Vec<u32>],
        details: &[Option<Detail>],
        others: impl Fn(usize) -> Option<BoxKey>,
    ) -> Self {
        let wanted = inputs.needs.sun;
        let key = |(number, (cloud, detail)): (usize, (&CloudFrame, &Option<Detail>))| match detail {
            Some(detail) => wanted.then(|| box_of(inputs, cloud, *detail)),
            None => others(number),
        };
        Self { frame, before, boxes: frame.clouds.iter().zip(details).enumerate().map(key).collect() }
    }

    /// The box of a cloud.
    pub fn of(&self, number: usize) -> Option<&BoxKey> {
        self.boxes[number].as_ref()
    }

    /// Numbers of the clouds that stand before a cloud.
    pub fn numbers(&self, number: usize) -> impl Iterator<Item = usize> {
        let before = self.before.get(number).into_iter().flatten().map(|&other| other as usize);
        before.filter(|&other| self.boxes[other].is_some())
    }

    /// What its light depends on of them.
    pub fn shades(&self, number: usize) -> Vec<Shade> {
        let origin = self.frame.clouds[number].origin;
        let shade = |other: usize| {
            let offset = (self.frame.clouds[other].origin - origin).as_vec3();
            Some(Shade { of: self.of(other)?.clone(), offset })
        };
        self.numbers(number).filter_map(shade).collect()
    }
}

/// Optical depths of clouds that others asked for before their own light was made.
#[derive(Default)]
pub(super) struct Ahead(HashMap<usize, (BoxKey, SunVolume)>);

impl Ahead {
    /// That of a cloud, where it is known in this box.
    pub fn take(&mut self, number: usize, of: Option<&BoxKey>) -> Option<SunVolume> {
        let (key, volume) = self.0.remove(&number)?;
        (Some(&key) == of).then_some(volume)
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Volumes of all clouds before a cloud, in the order of their [`Shading::shades`]: of `light` that is there, or made.
    pub fn before<'l>(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        (shading, number): (&Shading<'_>, usize),
        (pass, light): (&mut SunPass, impl Fn(usize) -> Option<&'l CloudLight>),
    ) -> Vec<TextureView> {
        let mut volume = |other: usize| {
            let of = shading.of(other)?;
            if let Some(view) = light(other).and_then(|light| light.volume_in(of)) {
                return Some(view.clone());
            }
            let known = self.take(other, Some(of));
            let made = known.unwrap_or_else(|| pass.make(encoder, inputs, of, inputs.needs.maps));
            let view = made.volume.clone();
            self.0.insert(other, (of.clone(), made));
            Some(view)
        };
        shading.numbers(number).filter_map(&mut volume).collect()
    }
}
