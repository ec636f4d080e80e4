//! Clouds from ellipsoids, fractal noise and Mie scattering, on the GPU.

#[cfg(feature = "cli")]
pub mod cli;
mod error;
#[cfg(feature = "export")]
pub mod export;
mod files;
pub mod gpu;
pub mod optics;
pub mod render;
pub mod scene;
pub mod tables;

pub use error::{Error, Result};
