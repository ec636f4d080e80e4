//! The real-time renderer: `light` is what a cloud receives, `march` what is seen of it, `sky` what is
//! behind, `picture` the ways to draw it all. What is there comes from [`crate::frame`].

mod light;
mod march;
mod medium;
mod picture;
mod quality;
mod settings;
mod shadow;
mod sky;

pub use light::Transport;
#[cfg(test)]
pub(crate) use light::{AroundUniform, BRICK, FieldUniform, LightBox, LightUniform};
#[cfg(feature = "slabs")]
pub use light::{DirectTextures, FunctionTextures};
#[cfg(test)]
pub(crate) use march::{
    CROSSING_CELL, CloudUniform, MOST_NODES, Tile,
    voxels::{BlockUniform, VoxelsUniform},
};
pub use march::{
    Counts, Variant,
    voxels::{VoxelGrid, Voxels},
};
pub use picture::{
    Blur, Film, HeatMap, Layers, LightLayers, Matte, MattePixel, Picture, Pieces, Renderer, Resolve,
    SceneDepth, Shown, Target, metered_alone,
};
#[cfg(test)]
pub(crate) use picture::{ComposeUniform, ResolveUniform, resolve_uniform};
pub use quality::Quality;
pub use settings::Settings;
pub use shadow::SunMap;
#[cfg(test)]
pub(crate) use shadow::{CasterUniform, SunMapUniform};
pub use sky::{Redone, Sky};

pub use crate::frame::Frame;
