//! A picture under way.

use std::time::Duration;

use super::{settings::Layer, stage::Stage};
use crate::render::{Layers, Pieces, Shown};

/// Steps a ray that get the brightest colour of the cost layer.
pub(super) const COST_RANGE: f32 = 1000.0;

/// A picture under way.
pub struct Work {
    /// What is left to draw.
    pub pieces: Pieces,
    /// What it is drawn into.
    pub source: Source,
    /// What it will be.
    pub stage: Stage,
    /// Rays across a pixel.
    pub rays: u32,
    /// What 1 stands for in its light.
    pub unit: f32,
    /// Rays across the width and the height.
    pub size: [u32; 2],
    /// Time that the light took.
    pub began: Duration,
    /// Time so far.
    pub spent: Duration,
}

/// What a picture is drawn into before it is shown.
pub enum Source {
    /// All light.
    Beauty(wgpu::Texture),
    /// The light apart.
    Layers(Box<Layers>),
    /// Work of each pixel.
    Cost(wgpu::Texture),
}

impl Source {
    /// The texture of a layer, and how it is shown.
    pub fn shown(&self, layer: Layer) -> (&wgpu::Texture, Shown) {
        match (self, layer) {
            (Self::Beauty(texture), _) => (texture, Shown::Beauty),
            (Self::Cost(texture), _) => (texture, Shown::Heat(COST_RANGE)),
            (Self::Layers(layers), Layer::Multiple) => (&layers.sun.multiple, Shown::Light),
            (Self::Layers(layers), Layer::Ambient) => (&layers.sun.ambient, Shown::Light),
            (Self::Layers(layers), Layer::Air) => (&layers.sun.air, Shown::Light),
            (Self::Layers(layers), Layer::Transmittance) => (&layers.sun.single, Shown::Transmittance),
            (Self::Layers(layers), Layer::Normal) => (&layers.normal, Shown::Normal),
            (Self::Layers(layers), _) => (&layers.sun.single, Shown::Light),
        }
    }
}
