//! Pictures on the CPU.

use half::f16;

use super::Renderer;
use crate::{
    Result,
    gpu::{self, Gpu},
    scene::Tone,
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

    /// The means of squares of `n` by `n` pixels.
    pub fn reduced(&self, n: usize) -> Self {
        let (width, height) = (self.width / n, self.height / n);
        let mean = |i: usize| {
            let (x, y) = (n * (i % width), n * (i / width));
            let mut sum = [0.0; 4];
            for row in y..y + n {
                for pixel in &self.pixels[row * self.width + x..][..n] {
                    sum.iter_mut().zip(pixel).for_each(|(sum, c)| *sum += c / (n * n) as f32);
                }
            }
            sum
        };
        Self { width, height, pixels: (0..width * height).map(mean).collect() }
    }

    /// Pictures of one size side by side, `columns` in a row, from the top left; what is left of the last row is empty.
    pub fn in_rows(tiles: &[Self], columns: usize) -> Self {
        let [width, height] = tiles.first().map_or([0; 2], |tile| [tile.width, tile.height]);
        let rows = tiles.len().div_ceil(columns);
        let mut pixels = vec![[0.0; 4]; columns * width * rows * height];
        for (i, tile) in tiles.iter().enumerate() {
            let corner = i / columns * height * columns * width + i % columns * width;
            for (y, row) in tile.pixels.chunks_exact(width).enumerate() {
                pixels[corner + y * columns * width..][..width].copy_from_slice(row);
            }
        }
        Self { width: columns * width, height: rows * height, pixels }
    }

    /// The same with so many times the light.
    #[must_use]
    pub fn times(mut self, factor: f32) -> Self {
        if factor != 1.0 {
            self.pixels.iter_mut().for_each(|pixel| pixel[..3].iter_mut().for_each(|c| *c *= factor));
        }
        self
    }

    /// Adds the colours of another picture of its size; alpha stays.
    pub fn add_light(&mut self, other: &Self) {
        for (pixel, other) in self.pixels.iter_mut().zip(&other.pixels) {
            pixel[..3].iter_mut().zip(other).for_each(|(pixel, other)| *pixel += other);
        }
    }

    /// Puts this picture, whose colours are multiplied by alpha, over another of its size.
    pub fn put_over(&mut self, behind: &Self) {
        for (pixel, behind) in self.pixels.iter_mut().zip(&behind.pixels) {
            let through = 1.0 - pixel[3];
            pixel.iter_mut().zip(behind).for_each(|(pixel, behind)| *pixel += through * behind);
        }
    }

    /// The picture as screens show it: exposed and tone-mapped, RGBA of 8 bits in sRGB.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn finished(&self, gpu: &Gpu, renderer: &mut Renderer, tone: Tone) -> Result<Vec<u8>> {
        let size = [self.width as u32, self.height as u32];
        // Half floats hold what a screen shows of light in whatever unit.
        let exposed = tone.stops.round();
        let linear = self.clone().times(exposed.exp2() as f32).upload(gpu);
        let tone = Tone { stops: tone.stops - exposed, ..tone };
        let finished = renderer.picture("finished", size, wgpu::TextureFormat::Rgba8Unorm);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let views = [&linear, &finished].map(|texture| texture.create_view(&Default::default()));
        renderer.compose(&mut encoder, &views[0], &views[1], finished.format(), tone);
        gpu.queue.submit([encoder.finish()]);
        gpu::read_texture(gpu, &finished, 0)
    }

    /// An `Rgba16Float` texture with these pixels, to be composed.
    pub fn upload(&self, gpu: &Gpu) -> wgpu::Texture {
        let size = [self.width as u32, self.height as u32, 0];
        let halves: Vec<[f16; 4]> =
            self.pixels.iter().map(|pixel| pixel.map(|c| f16::from_f32(c.min(65504.0)))).collect();
        gpu::half_texture(&gpu.device, &gpu.queue, "picture", size, &halves)
    }
}
