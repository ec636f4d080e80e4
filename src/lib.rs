//! Clouds from ellipsoids, fractal noise and Mie scattering, on the GPU.

#![warn(missing_docs)]

mod error;
pub mod scene;
pub mod optics;
pub mod tables;

pub use error::{Error, Result};
