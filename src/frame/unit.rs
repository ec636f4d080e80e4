//! In which unit the light of a frame is computed. Half floats hold 6e-5 to 65504 and no more: suns in lux would
//! be cut, and faint ones would be dark. Light is linear, so that a factor on all lights is one on the picture.

use glam::Vec3;

use super::{CameraUniform, Frame, FrameLight, LitBy, Sun};

/// Lights of which the strongest is within these are taken as they are.
const AS_THEY_ARE: [f32; 2] = [1.0 / 64.0, 4.0];
/// The sun's disc may be so bright, and is then well below the largest half float.
const BRIGHTEST: f32 = 40_000.0;
/// Flashes so many times as strong as the sun leave the unit as it is, so that their flicker has no light made anew.
const BRIGHT_FLASH: f32 = 64.0;
/// The middle of the disc over its mean, at most.
const LIMB: f32 = 1.4;

impl Frame {
    /// What 1 in its pictures stands for, in the unit of the scene's lights: 1, but for scenes whose lights are far
    /// from that. [`Film`](crate::render::Film) and the path tracer give light in the scene's own unit; who draws into
    /// textures of their own multiplies by this. It is a power of two.
    pub fn unit(&self) -> f32 {
        self.unit
    }

    /// The strongest of its lights.
    fn strongest(&self) -> f32 {
        self.strongest_light().max(self.sky.uniform.radiance.max_element())
    }

    /// Irradiance of the strongest of its suns; one that has set long ago is none beside others.
    pub(crate) fn strongest_light(&self) -> f32 {
        let sun = if self.sun_counts() { self.sun.irradiance } else { Vec3::ZERO };
        let strength = |light: &FrameLight| match light.by {
            LitBy::Flash(..) => light.sun.irradiance / BRIGHT_FLASH,
            LitBy::Sky | LitBy::Key => light.sun.irradiance,
        };
        let lights = self.lights.iter().map(strength);
        lights.fold(sun, Vec3::max).max_element()
    }

    /// Whether the sun is to be seen or there is nothing else: the disc of one that has set long ago may be cut.
    fn sun_counts(&self) -> bool {
        !self.sun.has_set(self.sky.atmosphere) || self.lights.is_empty()
    }

    /// Whether neither its sun nor its sky shine on anything.
    pub(crate) fn is_dark(&self) -> bool {
        let sun = self.sun.has_set(self.sky.atmosphere) || self.sun.irradiance == Vec3::ZERO;
        sun && (self.sky.atmosphere || self.sky.uniform.radiance == Vec3::ZERO)
    }

    /// The frame with its lights in the unit that suits them.
    pub(super) fn in_its_unit(self) -> Self {
        let strongest = self.strongest();
        let fits = strongest == 0.0 || (AS_THEY_ARE[0]..=AS_THEY_ARE[1]).contains(&strongest);
        if fits { self } else { self.in_unit(strongest.log2().floor().exp2()) }
    }

    /// The same in a unit in which the sun's disc is not too bright either, as it is drawn in pixels of this size.
    pub(crate) fn holding_the_disc(self) -> Self {
        // As `disc_radiance` of the shaders has it.
        let pixel = self.camera.pixel;
        let of_disc = |sun: &Sun| {
            let radius = sun.radius.max(0.5 * pixel);
            let area = std::f32::consts::PI * (radius * radius + pixel * pixel / 12.0);
            LIMB * sun.irradiance.max_element() / area / BRIGHTEST
        };
        let moons = self.lights.iter().filter(|light| light.by == LitBy::Sky);
        let sun = Some(&self.sun).filter(|_| self.sun_counts());
        let excess = moons.map(|light| &light.sun).chain(sun).map(of_disc).fold(0.0, f32::max);
        let seen = self.camera.projection != CameraUniform::ORTHOGRAPHIC && excess.is_finite();
        if seen && excess > 1.0 { self.in_unit(excess.log2().ceil().exp2()) } else { self }
    }

    /// The same with a unit that is so many times as large.
    fn in_unit(mut self, unit: f32) -> Self {
        let sky = &mut self.sky.uniform;
        let own = [&mut self.sun.irradiance, &mut sky.irradiance, &mut sky.radiance];
        let further = self.lights.iter_mut().map(|light| &mut light.sun.irradiance);
        own.into_iter().chain(further).for_each(|light: &mut Vec3| *light /= unit);
        Self { unit: self.unit * unit, ..self }
    }
}
