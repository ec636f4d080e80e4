//! Taking a picture: what was drawn is read back, and the rays of each pixel are averaged. The command
//! line, the exports, the benchmark, the editor and the tests all take theirs here.

use super::{HDR, Picture, Pieces, Quality, Renderer, Target, view};
use crate::{Result, frame::Frame, gpu::Gpu, scene::Scene};

/// What a picture is taken on: so many pixels, each the mean of a square of rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Film {
    size: [u32; 2],
    rays: u32,
}

impl Film {
    /// Largest edge of a texture everywhere, pixels; no picture has more rays along an edge.
    pub const WIDEST: u32 = 8192;

    /// A film of `size` pixels with `rays` by `rays` rays each, or as many as a texture holds.
    pub fn new(size: [u32; 2], rays: u32) -> Self {
        Self { size, rays: rays.clamp(1, Self::most_rays(size)) }
    }

    /// A film with the rays that pictures of `quality` have: two by two in final quality, else one.
    pub fn of_quality(size: [u32; 2], quality: &Quality) -> Self {
        Self::new(size, if *quality == Quality::FINAL { 2 } else { 1 })
    }

    /// Rays along an edge of a pixel of which a texture holds a whole picture's; at least 1.
    pub fn most_rays(size: [u32; 2]) -> u32 {
        Self::WIDEST / size[0].max(size[1]).clamp(1, Self::WIDEST)
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Rays along an edge of a pixel.
    pub fn rays(&self) -> u32 {
        self.rays
    }

    /// A scene at its own time, with as many pixels as there are rays.
    ///
    /// # Errors
    /// As [`Frame::new`].
    pub fn frame(&self, scene: &Scene) -> Result<Frame> {
        Ok(Frame::new(scene, self.size.map(|n| n * self.rays))?.holding_the_disc())
    }

    /// Draws a frame of this film, before its sky or before nothing, in the unit of the scene's lights; tells the
    /// share done.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn take(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        frame: &Frame,
        sky: bool,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Picture> {
        let linear = renderer.picture("linear", frame.size(), HDR);
        let target = Target { color: &view(&linear), depth: None, sky };
        renderer.render_in_pieces(gpu, frame, &target, progress)?;
        Ok(self.read(gpu, &linear)?.times(frame.unit()))
    }

    /// The picture of a texture that a frame of this film was drawn into, in the frame's unit.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn read(&self, gpu: &Gpu, linear: &wgpu::Texture) -> Result<Picture> {
        Ok(Picture::read(gpu, linear)?.reduced(self.rays as usize))
    }
}

impl Renderer {
    /// Begins a picture of `frame` in a texture of its own, before its sky or before nothing:
    /// [`Film::take`] for callers that draw the pieces in their own time.
    pub fn begin_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        sky: bool,
    ) -> (wgpu::Texture, Pieces) {
        let linear = self.picture("linear", frame.size(), HDR);
        let pieces = self.begin_pieces(encoder, frame, &Target { color: &view(&linear), depth: None, sky });
        (linear, pieces)
    }

    /// What is behind the clouds of `frame`, in the unit of the scene's lights.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn sky_picture(&mut self, gpu: &Gpu, frame: &Frame) -> Result<Picture> {
        let sky = self.picture("sky", frame.size(), HDR);
        let mut encoder = self.encoder();
        self.render_sky(&mut encoder, frame, &view(&sky));
        gpu.queue.submit([encoder.finish()]);
        Ok(Picture::read(gpu, &sky)?.times(frame.unit()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_has_the_rays_that_it_was_asked_for_as_long_as_a_texture_holds_them() {
        let rays = |size, rays| Film::new(size, rays).rays();
        assert_eq!([rays([960, 540], 2), rays([540, 960], 8), rays([960, 540], 9)], [2, 8, 8]);
        assert_eq!([rays([4096, 1], 2), rays([1, 4097], 2), rays([8192, 8192], 8)], [2, 1, 1]);
        assert_eq!([rays([16, 9], 0), rays([9000, 9], 4), rays([0, 0], 3)], [1, 1, 3]);
        let of = |quality| Film::of_quality([960, 540], &quality).rays();
        assert_eq!([Quality::DRAFT, Quality::PREVIEW, Quality::FINAL].map(of), [1, 1, 2]);
    }
}
