//! All that stands around a cloud and changes the diffuse light that comes to it: layers above and below, other clouds beside.

mod beside;
mod between;
mod body;
mod slab;

use glam::{DVec3, Vec4};

use super::field::{DIRECTIONS, levels};
use crate::frame::{CloudFrame, Frame};
use beside::{Beside, Bodies, FromBeside};
use between::{Between, Strata};
use slab::LEVELS;

/// Directions by four.
const FOURS: usize = DIRECTIONS / 4;

/// What stands around a cloud; nothing where both are none.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Around {
    between: Option<Between>,
    beside: Option<Beside>,
}

impl Around {
    /// The same for light of the sky, which no beam comes of.
    pub fn of_sky(&self) -> Self {
        Self { between: self.between.map(Between::of_sky), beside: self.beside.clone() }
    }

    /// Whether both do the same to light but for this share of it.
    pub fn is_near(&self, other: &Self, share: f64) -> bool {
        let [a, b] = [self, other].map(|around| around.between.unwrap_or(Between::NONE));
        self.beside == other.beside && a.is_near(&b, share)
    }

    /// Whether light comes in as if nothing else were there.
    pub fn is_nothing(&self) -> bool {
        self.between.is_none() && self.beside.is_none()
    }

    /// What it makes of light, in that of a sun in direction `to_sun`.
    pub fn told(&self, to_sun: DVec3) -> Told {
        Told {
            between: self.between.unwrap_or(Between::NONE),
            beside: self.beside.as_ref().map_or(FromBeside::NONE, |beside| beside.told(to_sun)),
        }
    }
}

/// What it makes of light, by direction.
pub(super) struct Told {
    between: Between,
    beside: FromBeside,
}

/// `Around` of `shaders/moments_around.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct AroundUniform {
    pub(crate) rows: [Vec4; 2 * LEVELS],
    pub(crate) through: [Vec4; 2],
    pub(crate) weights: [Vec4; 2],
    pub(crate) open: [Vec4; FOURS],
    pub(crate) returned: [Vec4; FOURS],
    pub(crate) shaded: [Vec4; FOURS],
}

impl Told {
    /// The sun's light that comes scattered, by direction, for each unit of its irradiance, 1/sr.
    pub fn sunlight(&self) -> Vec<f32> {
        let Self { between, beside } = self;
        let level = |direction| between.sun[direction / (DIRECTIONS / LEVELS)];
        (0..DIRECTIONS).map(|i| beside.open[i] * level(i) + between.beam * beside.sun[i]).collect()
    }

    pub fn uniform(&self) -> AroundUniform {
        let levels_of = |values: [f32; LEVELS]| {
            [0, 4].map(|first| {
                Vec4::from_array(std::array::from_fn(|i| *values.get(first + i).unwrap_or(&0.0)))
            })
        };
        let weights = std::array::from_fn(|i| (0.5 * levels()[i].1) as f32 / (DIRECTIONS / LEVELS) as f32);
        let rows = self.between.rows.map(levels_of);
        let fours = |values: &[f32; DIRECTIONS]| std::array::from_fn(|i| Vec4::from_slice(&values[4 * i..]));
        AroundUniform {
            rows: std::array::from_fn(|i| rows[i / 2][i % 2]),
            through: levels_of(self.between.through),
            weights: levels_of(weights),
            open: fours(&self.beside.open),
            returned: fours(&self.beside.returned),
            shaded: fours(&self.beside.shaded),
        }
    }
}

/// What stands around the clouds of a frame.
pub(super) struct Surroundings<'a> {
    strata: Strata<'a>,
    bodies: Bodies<'a>,
}

impl<'a> Surroundings<'a> {
    /// In the light of a sun at the sine `elevation`; `grounded` tells whether there is a ground that it lights.
    pub fn of(frame: &'a Frame, elevation: f64, grounded: bool) -> Self {
        Self { strata: Strata::of(&frame.clouds, elevation), bodies: Bodies::of(frame, grounded) }
    }

    /// What is around cloud `number`.
    pub fn around(&self, number: usize, cloud: &CloudFrame) -> Around {
        Around { between: self.strata.around(number, cloud), beside: self.bodies.beside(number) }
    }
}
