//! In which unit the light of a frame is computed. Half floats hold 6e-5 to 65504 and no more: suns in lux would
//! be cut, and faint ones would be dark. Light is linear, so that a factor on all lights is one on the picture.

use glam::Vec3;

use super::{CameraUniform, Frame};

/// Lights of which the strongest is within these are taken as they are.
const AS_THEY_ARE: [f32; 2] = [1.0 / 64.0, 4.0];
/// The sun's disc may be so bright, and is then well below the largest half float.
const BRIGHTEST: f32 = 40_000.0;
/// The middle of the disc over its mean, at most.
const LIMB: f32 = 1.4;

impl Frame {
    /// What 1 in its pictures stands for, in the unit of the scene's lights: 1, but for scenes whose lights are far
    /// from that. [`Film`](crate::render::Film) and the path tracer give light in the scene's own unit; who draws into
    /// textures of their own multiplies by this. It is a power of two.
    pub fn unit(&self) -> f32 {
        self.unit
    }

    /// The frame with its lights in the unit that suits them.
    pub(super) fn in_its_unit(self) -> Self {
        let strongest = self.sun.irradiance.max(self.sky.uniform.radiance).max_element();
        let fits = strongest == 0.0 || (AS_THEY_ARE[0]..=AS_THEY_ARE[1]).contains(&strongest);
        if fits { self } else { self.in_unit(strongest.log2().floor().exp2()) }
    }

    /// The same in a unit in which the sun's disc is not too bright either, as it is drawn in pixels of this size.
    pub(crate) fn holding_the_disc(self) -> Self {
        // As `disc_radiance` of the shaders has it.
        let pixel = self.camera.pixel;
        let radius = self.sun.radius.max(0.5 * pixel);
        let area = std::f32::consts::PI * (radius * radius + pixel * pixel / 12.0);
        let excess = LIMB * self.sun.irradiance.max_element() / area / BRIGHTEST;
        let seen = self.camera.projection != CameraUniform::ORTHOGRAPHIC && excess.is_finite();
        if seen && excess > 1.0 { self.in_unit(excess.log2().ceil().exp2()) } else { self }
    }

    /// The same with a unit that is so many times as large.
    fn in_unit(mut self, unit: f32) -> Self {
        let lights: [&mut Vec3; 3] =
            [&mut self.sun.irradiance, &mut self.sky.uniform.irradiance, &mut self.sky.uniform.radiance];
        lights.into_iter().for_each(|light| *light /= unit);
        Self { unit: self.unit * unit, ..self }
    }
}
