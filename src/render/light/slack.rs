//! How far what light was made for may be from what is there, so that it is kept while things move a little.

use glam::{DVec3, Vec3};

use super::{
    around::Around,
    field::FieldKey,
    prepare::Wanted,
    sun::{BoxKey, Shade, SunKey},
};
use crate::frame::{Shared, SkySettings, medium::Medium};

/// What is let pass of one cloud.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slack {
    /// Angle by which the sun turned, rad.
    pub turn: f64,
    /// Way of noise and of other clouds, m: half of that of a shadow on the cloud's far side while the sun turns so far.
    pub way: f64,
}

impl Slack {
    /// For a cloud of this half-extent, m, where the sun may turn by so many degrees.
    pub fn new(turn_deg: f64, half: DVec3) -> Self {
        let turn = turn_deg.to_radians();
        Self { turn, way: 0.5 * turn * half.length() }
    }

    /// Whether light that was made for one is good enough for the other.
    pub fn covers(self, made: &Wanted, wanted: &Wanted) -> bool {
        both(&made.sun, &wanted.sun, |a, b| self.sun(a, b))
            && both(&made.openness, &wanted.openness, |a, b| self.space(a, b))
            && both(&made.field, &wanted.field, |a, b| self.field(a, b))
            && both(&made.sky_field, &wanted.sky_field, |(a, sky), (b, other)| {
                self.field(a, b) && both(sky, other, |a, b| self.sky(a, b))
            })
    }

    fn sun(self, a: &SunKey, b: &SunKey) -> bool {
        a.mapped == b.mapped
            && self.space(&a.of, &b.of)
            && a.shades.len() == b.shades.len()
            && a.shades.iter().zip(&b.shades).all(|(a, b)| self.shade(a, b))
    }

    fn shade(self, a: &Shade, b: &Shade) -> bool {
        f64::from(a.offset.distance(b.offset)) <= self.way && self.space(&a.of, &b.of)
    }

    fn space(self, a: &BoxKey, b: &BoxKey) -> bool {
        // A box may get a voxel more where the light turns.
        let alike = a.voxels.iter().zip(b.voxels).all(|(&a, b)| a.abs_diff(b) <= 1 + a / 8);
        alike && self.direction(a.light_box.along, b.light_box.along) && self.medium(&a.medium, &b.medium)
    }

    fn direction(self, a: Vec3, b: Vec3) -> bool {
        f64::from(a.angle_between(b)) <= self.turn
    }

    fn medium(self, a: &Shared<Medium>, b: &Shared<Medium>) -> bool {
        a.is(b) || a == b || a.is_near(b, self.way)
    }

    fn field(self, a: &FieldKey, b: &FieldKey) -> bool {
        a.cells == b.cells
            && a.flash == b.flash
            && self.medium(&a.medium, &b.medium)
            && self.around(&a.around, &b.around)
    }

    fn around(self, a: &Around, b: &Around) -> bool {
        a == b || a.is_near(b, self.turn)
    }

    fn sky(self, a: &SkySettings, b: &SkySettings) -> bool {
        let mut turned = *a;
        turned.uniform.to_sun = b.uniform.to_sun;
        turned == *b && self.direction(a.uniform.to_sun, b.uniform.to_sun)
    }
}

/// Whether there are both, and alike, or neither.
fn both<T>(a: &Option<T>, b: &Option<T>, alike: impl Fn(&T, &T) -> bool) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => alike(a, b),
        (None, None) => true,
        _ => false,
    }
}
