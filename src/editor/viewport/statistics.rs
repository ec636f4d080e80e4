//! What the viewport tells of its work.

use std::time::Duration;

use super::stage::Stage;
use crate::{gpu::PassTime, render::Counts};

/// What was drawn, and how long it took.
#[derive(Debug, Clone, Default)]
pub struct Statistics {
    /// Width and height of the picture, pixels.
    pub resolution: [u32; 2],
    /// Rays across a pixel.
    pub rays: u32,
    /// Draft, preview or final.
    pub quality: &'static str,
    /// Time of the last picture, ms.
    pub ms: f64,
    /// Share of the picture under way that is drawn, 0 to 1.
    pub share: f64,
    /// Time of each pass, where measured and the adapter can.
    pub passes: Vec<PassTime>,
    /// Work, where counted.
    pub counts: Option<Counts>,
    /// Pictures drawn so far.
    pub pictures: u64,
    /// Volumes and tables of light made so far.
    pub light_updates: u32,
}

impl Statistics {
    pub(super) fn drawn(&mut self, stage: Stage, size: [u32; 2], rays: u32, spent: Duration) {
        self.resolution = size;
        self.rays = rays;
        self.quality = stage.name();
        self.ms = 1e3 * spent.as_secs_f64();
        self.pictures += 1;
    }
}
