//! The moment of a picture as far as the light of its clouds depends on it: while it is the same, light that was good
//! for a cloud still is, and nothing has to be compared cloud by cloud.

use glam::DVec3;

use super::{inputs::Inputs, model::Needs};
use crate::frame::{CloudFrame, Frame, LitBy, Shared, SkySettings, medium::Medium};

/// All that light depends on but for how fine it is.
pub(super) struct Moment {
    clouds: Vec<(DVec3, Shared<Medium>)>,
    to_sun: DVec3,
    by: LitBy,
    needs: Needs,
    lit_by_sky: bool,
    sky: Option<SkySettings>,
}

impl Moment {
    pub fn new(inputs: &Inputs<'_>, frame: &Frame) -> Self {
        Self {
            clouds: frame.clouds.iter().map(|cloud| (cloud.origin, cloud.medium.clone())).collect(),
            to_sun: inputs.to_sun,
            by: inputs.by,
            needs: inputs.needs,
            lit_by_sky: inputs.lit_by_sky,
            sky: inputs.sky.settings(),
        }
    }

    /// Whether a picture is of it.
    pub fn is(&self, inputs: &Inputs<'_>, frame: &Frame) -> bool {
        let same = |(known, cloud): (&(DVec3, Shared<Medium>), &CloudFrame)| {
            known.0 == cloud.origin && known.1 == cloud.medium
        };
        self.to_sun == inputs.to_sun
            && self.by == inputs.by
            && self.needs == inputs.needs
            && self.lit_by_sky == inputs.lit_by_sky
            && self.sky == inputs.sky.settings()
            && self.clouds.len() == frame.clouds.len()
            && self.clouds.iter().zip(&frame.clouds).all(same)
    }
}
