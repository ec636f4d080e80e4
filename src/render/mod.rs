//! The real-time renderer: one file a pass, with the same stem as its shader.

mod bricks;
mod camera;
mod clouds;
mod compose;
mod ellipsoids;
mod frame;
#[cfg(test)]
mod layouts;
mod light;
mod light_box;
mod light_plan;
mod light_store;
mod moments;
mod noise;
mod occluders;
mod optics;
mod quality;
mod renderer;
mod resolve;
mod sky;
mod sky_background;
mod sky_settings;
pub mod slab_textures;
mod stats;
mod target;
mod tiles;
mod transport;
mod voxels;

pub use camera::CameraUniform;
pub(crate) use ellipsoids::EllipsoidUniform;
pub use frame::Frame;
pub(crate) use noise::{NoiseFrame, upload as upload_noise};
pub use noise::{SIZE as NOISE_SIZE, bake as bake_noise};
pub use quality::Quality;
pub use renderer::{Pieces, Renderer};
pub use resolve::{HeatMap, Resolve, Shown};
pub use sky::{Redone, Sky};
pub use sky_settings::{AtmosphereUniform, SkySettings, SkyUniform};
pub use slab_textures::SlabTable;
pub use stats::Counts;
pub use target::{Layers, SceneDepth, Target};
pub use transport::Transport;
pub use voxels::{BLOCK_EDGE, BLOCK_VOXELS, Block, VoxelGrid, Voxels};
