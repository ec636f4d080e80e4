//! What the passes that prepare light share.

use glam::DVec3;

use super::model::Needs;
use crate::{
    frame::LitBy,
    gpu::Timing,
    render::{medium::Media, sky::Sky},
};

/// What the passes share.
pub(in crate::render) struct Inputs<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub media: &'a Media,
    pub to_sun: DVec3,
    pub by: LitBy,
    pub needs: Needs,
    pub lit_by_sky: bool,
    pub sky: &'a Sky,
    /// [`Settings::light_slack_deg`](crate::render::Settings::light_slack_deg).
    pub slack_deg: f64,
    pub timing: Option<&'a Timing>,
}
