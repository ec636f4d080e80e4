//! Pictures on the CPU.

use half::f16;

use crate::{
    Result,
    gpu::{self, Gpu},
};

/// Linear RGBA, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Pixels, row by row.
    pub pixels: Vec<[f32; 4]>,
}

impl Picture {
    /// Reads back an `Rgba16Float` texture.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Self> {
        let bytes = gpu::read_texture(gpu, texture, 0)?;
        let halves: Vec<[f16; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let pixels = halves.into_iter().map(|pixel| pixel.map(f16::to_f32)).collect();
        Ok(Self { width: texture.width() as usize, height: texture.height() as usize, pixels })
    }
}
