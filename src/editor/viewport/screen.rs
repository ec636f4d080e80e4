//! What the canvas shows: textures that egui knows, on the window's device or in its memory.

use std::sync::Arc;

use eframe::egui::{ColorImage, TextureHandle, TextureId, TextureOptions, mutex::RwLock};
use wgpu::TextureView;

use super::canvas::{Canvas, SCREEN, view};
use crate::{Result, gpu, scene::Tone};

/// Where egui finds what is drawn.
pub enum Shelf {
    /// In textures of the window's device.
    Device(Arc<RwLock<egui_wgpu::Renderer>>),
    /// In memory: the device is another.
    Memory,
}

/// A texture that egui shows.
pub struct Screen {
    texture: wgpu::Texture,
    hung: Hung,
}

/// How egui knows a texture.
enum Hung {
    Texture(TextureId),
    Pixels(TextureHandle),
    /// Not yet.
    Nowhere,
}

impl Screen {
    /// Its name for egui.
    pub fn id(&self) -> Option<TextureId> {
        match &self.hung {
            Hung::Texture(id) => Some(*id),
            Hung::Pixels(handle) => Some(handle.id()),
            Hung::Nowhere => None,
        }
    }
}

impl Canvas {
    /// Only exposure or tone curve changed.
    pub(super) fn compose_again(&mut self) -> Result<()> {
        let mut slot = self.screen.take();
        if let (Some(linear), Some(Screen { texture: screen, .. })) = (&self.linear, &slot) {
            let (mut encoder, tone) = (self.encoder(), self.tone().in_unit(self.unit));
            self.renderer.compose(&mut encoder, &view(linear), &view(screen), SCREEN, tone);
            self.gpu.queue.submit([encoder.finish()]);
            self.hang(&mut slot)?;
        }
        self.screen = slot;
        Ok(())
    }

    /// Finishes a linear picture for the screen.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn compose_into(
        &mut self,
        slot: &mut Option<Screen>,
        linear: &wgpu::Texture,
        tone: Tone,
    ) -> Result<()> {
        let screen = self.fit(slot, [linear.width(), linear.height()]);
        let mut encoder = self.encoder();
        self.renderer.compose(&mut encoder, &view(linear), &screen, SCREEN, tone);
        self.submit(encoder)?;
        self.hang(slot)
    }

    /// The texture of a slot, made anew where its size is another.
    pub(super) fn fit(&self, slot: &mut Option<Screen>, size: [u32; 2]) -> TextureView {
        if let Some(Screen { texture, .. }) = slot
            && [texture.width(), texture.height()] == size
        {
            return view(texture);
        }
        let texture = self.renderer.picture("viewport on the screen", size, SCREEN);
        let target = view(&texture);
        let mut hung = slot.take().map_or(Hung::Nowhere, |screen| screen.hung);
        if let Shelf::Device(egui) = &self.shelf {
            let (mut egui, filter) = (egui.write(), wgpu::FilterMode::Linear);
            if let Hung::Texture(id) = hung {
                egui.update_egui_texture_from_wgpu_texture(&self.gpu.device, &target, filter, id);
            } else {
                hung = Hung::Texture(egui.register_native_texture(&self.gpu.device, &target, filter));
            }
        }
        *slot = Some(Screen { texture, hung });
        target
    }

    /// Takes what was drawn into a slot over to egui, where that does not see the texture itself.
    pub(super) fn hang(&self, slot: &mut Option<Screen>) -> Result<()> {
        let (Some(Screen { texture, hung }), Shelf::Memory) = (slot, &self.shelf) else { return Ok(()) };
        let bytes = gpu::read_texture(&self.gpu, texture, 0)?;
        let size = [texture.width(), texture.height()].map(|n| n as usize);
        let image = ColorImage::from_rgba_premultiplied(size, &bytes);
        match hung {
            Hung::Pixels(handle) => handle.set(image, TextureOptions::LINEAR),
            hung => {
                *hung = Hung::Pixels(self.window.load_texture("viewport", image, TextureOptions::LINEAR));
            }
        }
        Ok(())
    }
}
