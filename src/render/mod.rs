//! The real-time renderer: one file a pass, with the same stem as its shader.

mod camera;

pub use camera::CameraUniform;
