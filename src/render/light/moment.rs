//! The moment of a picture as far as the light of its clouds depends on it: while it is the same, light that was good
//! for a cloud still is, and nothing has to be compared cloud by cloud.

use glam::DVec3;

use super::{inputs::Inputs, model::Needs};
use crate::frame::{CloudFrame, Frame, LitBy, Shared, SkySettings, medium::Medium};

/// The clouds of a frame: what they are and where.
#[derive(Default)]
pub(in crate::render) struct Clouds(Vec<(DVec3, Shared<Medium>)>);

impl Clouds {
    pub fn of(frame: &Frame) -> Self {
        Self(frame.clouds.iter().map(|cloud| (cloud.origin, cloud.medium.clone())).collect())
    }

    /// Whether a frame has the same.
    pub fn are_of(&self, frame: &Frame) -> bool {
        let same = |((origin, medium), cloud): (&(DVec3, Shared<Medium>), &CloudFrame)| {
            *origin == cloud.origin && *medium == cloud.medium
        };
        self.0.len() == frame.clouds.len() && self.0.iter().zip(&frame.clouds).all(same)
    }
}

/// All that light depends on but for how fine it is.
pub(super) struct Moment {
    clouds: Clouds,
    to_sun: DVec3,
    by: LitBy,
    needs: Needs,
    lit_by_sky: bool,
    sky: Option<SkySettings>,
}

impl Moment {
    pub fn new(inputs: &Inputs<'_>, frame: &Frame) -> Self {
        Self {
            clouds: Clouds::of(frame),
            to_sun: inputs.to_sun,
            by: inputs.by,
            needs: inputs.needs,
            lit_by_sky: inputs.lit_by_sky,
            sky: inputs.sky.settings(),
        }
    }

    /// Whether a picture is of it.
    pub fn is(&self, inputs: &Inputs<'_>, frame: &Frame) -> bool {
        self.to_sun == inputs.to_sun
            && self.by == inputs.by
            && self.needs == inputs.needs
            && self.lit_by_sky == inputs.lit_by_sky
            && self.sky == inputs.sky.settings()
            && self.clouds.are_of(frame)
    }
}
