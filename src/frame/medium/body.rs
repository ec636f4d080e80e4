//! What is the same all over a cloud, as the shaders see it.

use glam::DVec3;

use super::{NoiseFrame, SpeciesUniform};
use crate::scene::Cloud;

/// `Body` of `shaders/lib/body.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BodyUniform {
    pub(crate) noise: NoiseFrame,
    pub(crate) species: SpeciesUniform,
    pub(crate) power: f32,
    pub(crate) reach: f32,
    pub(crate) base: f32,
    pub(crate) inverse_height: f32,
    pub(crate) stratification: f32,
    pub(crate) dilution: f32,
    pub(crate) level: f32,
    pub(crate) uneven: f32,
    pub(crate) table: u32,
    pub(crate) padding: [u32; 3],
}

/// Exponents with which depths of lumps are joined: creases between them, and one smooth body.
const POWERS: [f64; 2] = [8.0, 2.0];

/// The level of a cloud that has none, m: below all.
const NO_LEVEL: f32 = -1e30;

impl BodyUniform {
    /// That of `cloud`, whose box goes from `low` to `high` in a frame whose origin is at the height `origin`, m;
    /// it is made of `species`, and its noise is `noise`;
    /// whether all its lumps are equally dense.
    pub fn new(
        cloud: &Cloud,
        (low, high): (DVec3, DVec3),
        origin: f64,
        noise: NoiseFrame,
        species: SpeciesUniform,
        equal: bool,
    ) -> Self {
        let uneven = !equal || cloud.stratification > 0.0 || cloud.level.is_some();
        let deepest = cloud.ellipsoids.iter().map(|e| e.radii.min_element()).fold(1e-3, f64::max);
        Self {
            noise,
            species,
            power: (POWERS[0] + (POWERS[1] - POWERS[0]) * cloud.blend) as f32,
            reach: deepest as f32,
            base: low.y as f32,
            inverse_height: (1.0 / (high.y - low.y).max(1e-6)) as f32,
            stratification: cloud.stratification as f32,
            dilution: cloud.dilution as f32,
            level: cloud.level.map_or(NO_LEVEL, |level| (level - origin) as f32),
            uneven: f32::from(u8::from(uneven)),
            table: 0,
            padding: [0; 3],
        }
    }

    /// The most that extinction may be up to the height `top`, m, over that at its own top: the profile of
    /// `shaders/lib/body.wgsl`, which grows with height, and a little for its rounding.
    pub(crate) fn most_profile(&self, top: f32) -> f32 {
        (1.001 * self.profile(top)).min(1.0)
    }

    /// Extinction at the height `y`, m, over that at the top.
    fn profile(&self, y: f32) -> f32 {
        let height = ((y - self.base) * self.inverse_height).clamp(1e-4, 1.0);
        1.0 + self.stratification * (height.powf(2.0 / 3.0) - 1.0)
    }

    /// The share of extinction that is left at the height `y` and a `depth` below a displaced boundary, m: the profile, and
    /// `undiluted` of `shaders/lib/density.wgsl`.
    pub(crate) fn kept(&self, y: f64, depth: f64, boundary: f64) -> f64 {
        let diluted = 1.0 - smooth_rise(depth / (2.0 * boundary.max(1e-3)));
        f64::from(self.profile(y as f32)) * (1.0 - f64::from(self.dilution) * diluted)
    }

    /// The same body seen from an origin that is `offset` from its own, m, with its noise read from there.
    pub fn moved(self, noise: NoiseFrame, offset: DVec3, table: u32) -> Self {
        let y = offset.y as f32;
        Self { noise, base: self.base + y, level: self.level + y, table, ..self }
    }
}

/// The same as in `shaders/lib/density.wgsl`.
pub(crate) fn smooth_rise(x: f64) -> f64 {
    let y = x.clamp(0.0, 1.0);
    y * y * y * (y * (6.0 * y - 15.0) + 10.0)
}
