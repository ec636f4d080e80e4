//! What the passes that prepare light share.

use glam::DVec3;

use super::model::Needs;
use crate::{frame::LitBy, gpu::Timing, render::sky::Sky};

/// What the passes share.
pub(in crate::render) struct Inputs<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub to_sun: DVec3,
    pub by: LitBy,
    pub needs: Needs,
    pub lit_by_sky: bool,
    pub sky: &'a Sky,
    pub timing: Option<&'a Timing>,
}
