//! A map of the sun's light, and what it was made of.

use wgpu::TextureView;

use super::{
    ShadowInputs,
    casters::Caster,
    layout::{self, Layout},
    splat::{self, Splat, lit_texture},
};
use crate::gpu;

/// What shaders read of a map.
pub(super) struct Map {
    pub uniform: wgpu::Buffer,
    pub lit: TextureView,
    /// How often it was made.
    pub number: u32,
    texture: Option<wgpu::Texture>,
    made: Option<Made>,
}

/// What the map holds.
struct Made {
    layout: Layout,
    casters: Vec<Caster>,
}

impl Map {
    /// A map in which all is lit.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            uniform: gpu::uniform_buffer(device, "sun map", &layout::NONE),
            lit: splat::view_of(&lit_texture(device, 1)),
            number: 0,
            texture: None,
            made: None,
        }
    }

    /// Its numbers, and the share of light that it holds, in the order in which shaders bind them.
    pub fn bindings(&self) -> (&wgpu::Buffer, &TextureView) {
        (&self.uniform, &self.lit)
    }

    /// Brings it up to date for what `casters` there are, with `texels` along an edge; the air's shadow ends at `reach`, m.
    /// Tells whether it was made; nothing where nothing casts a shadow.
    pub fn prepare(
        &mut self,
        splat: &mut Option<Splat>,
        inputs: &ShadowInputs<'_>,
        encoder: &mut wgpu::CommandEncoder,
        casters: &[Caster],
        texels: u32,
        reach: f64,
    ) -> Option<bool> {
        let ShadowInputs { device, frame, .. } = *inputs;
        let layout = Layout::new(casters, frame.sun.to_sun, frame.camera_position, texels)?;
        let endless = casters.iter().any(Caster::is_endless);
        let uniform = layout.uniform(frame.camera_position, frame.sun.radius, reach, endless);
        inputs.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let is_made = self.made.as_ref().is_some_and(|made| made.layout == layout && made.casters == casters);
        if !is_made {
            let splat = splat.get_or_insert_with(|| Splat::new(device));
            self.lit = splat.draw(inputs, encoder, &layout, &uniform, casters, &mut self.texture);
            self.made = Some(Made { layout, casters: casters.to_vec() });
            self.number += 1;
        }
        Some(!is_made)
    }
}
