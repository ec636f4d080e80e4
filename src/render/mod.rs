//! The real-time renderer: one file a pass, with the same stem as its shader.

mod camera;
mod sky;

pub use camera::CameraUniform;
pub use sky::{AtmosphereUniform, Redone, Sky, SkySettings, SkyUniform};
