//! How a renderer draws, as one value.

use super::{Quality, Transport};
use crate::frame::Frame;

/// From so many ellipsoids on a volume of depths is the cheaper way: docs/scale.md.
const BAKE_FROM: u32 = 256;

/// What a renderer is told once and may be told anew between pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How much work a picture gets.
    pub quality: Quality,
    /// How light inside a cloud is found.
    pub transport: Transport,
    /// Whether the air between camera and clouds dims them and shines itself; without it the
    /// light is that of the clouds alone, as path traced pictures have it.
    pub aerial: bool,
    /// Whether clouds cast shadows on the ground and in the air, where there is an atmosphere.
    pub shadows: bool,
    /// Whether the ground hides clouds below and behind it, where the sky is an atmosphere.
    pub ground: bool,
    /// Whether clouds that pass through one another hide each other place by place, for which they are marched twice where
    /// they cross; else each is drawn whole, far ones first.
    pub crossings: bool,
    /// Clouds whose light is made for one picture, at most; those that wait for their turn keep
    /// what they have, of another moment, and are not drawn while they have none. For windows in which
    /// something moves.
    pub lights_at_once: u32,
    /// Light in a cloud is kept while the sun has turned by no more degrees than these, and while noise that wanders
    /// through it, and clouds before it, have gone no farther than half the way that the end of a shadow in it does by
    /// that. 0: made anew whatever moves. For games and windows: docs/motion.md has errors and times.
    pub light_slack_deg: f64,
    /// Clouds of so many ellipsoids or more are drawn from a volume of depths that is baked once a
    /// shape; those of fewer ask each ellipsoid.
    pub bake_from: u32,
    /// Whether to count work; slower.
    pub counting: bool,
}

impl Settings {
    /// The same for the sun of `frame`: nothing is made of one that does not shine.
    pub(super) fn of_sun(&self, frame: &Frame) -> Self {
        if frame.is_dark() { Self { transport: Transport::DARK, ..*self } } else { *self }
    }
}

impl Default for Settings {
    /// Final quality, the most accurate light, all of it at once.
    fn default() -> Self {
        Self {
            quality: Quality::default(),
            transport: Transport::default(),
            aerial: true,
            shadows: true,
            ground: true,
            crossings: true,
            lights_at_once: u32::MAX,
            light_slack_deg: 0.0,
            bake_from: BAKE_FROM,
            counting: false,
        }
    }
}
