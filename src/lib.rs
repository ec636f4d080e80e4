//! Clouds from ellipsoids, fractal noise and Mie scattering, on the GPU.

#![warn(missing_docs)]

#[cfg(feature = "cli")]
pub mod cli;
mod error;
pub mod optics;
pub mod scene;
pub mod tables;

pub use error::{Error, Result};
