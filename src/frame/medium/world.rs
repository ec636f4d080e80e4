//! All clouds of a frame in one frame of coordinates, for those that ask all at once.

use glam::DVec3;

use super::{Common, EllipsoidUniform, NoiseFrame, Species, SpeciesUniform, upload_noise};
use crate::{
    frame::{Frame, Shared},
    gpu::{Gpu, view},
};

/// The union of all clouds.
pub(crate) struct World {
    /// Its origin: the middle of all clouds.
    pub origin: DVec3,
    pub ellipsoids: Vec<EllipsoidUniform>,
    /// What they are made of: each kind once.
    pub species: Vec<Shared<Species>>,
    noise: NoiseFrame,
    seed: u32,
}

impl World {
    pub fn new(frame: &Frame) -> Self {
        let (low, high) = frame.bounds().unwrap_or_default();
        let origin = 0.5 * (low + high);
        let (mut ellipsoids, mut species) = (Vec::new(), Vec::<Shared<Species>>::new());
        for cloud in &frame.clouds {
            let index = cloud.medium.species_among(&mut species);
            ellipsoids.extend(cloud.medium.moved(cloud.origin - origin, index));
        }
        let noise = NoiseFrame::new(&frame.noise, origin);
        Self { origin, ellipsoids, species, noise, seed: frame.noise.seed }
    }

    /// What shaders bind for it as their group of the medium.
    pub fn bind(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let species: Vec<SpeciesUniform> = self.species.iter().map(|species| species.uniform()).collect();
        let noise_volume = view(&upload_noise(&gpu.device, &gpu.queue, self.seed));
        let common = Common::new(&gpu.device, &species, &self.noise, noise_volume);
        common.bind_ellipsoids(&gpu.device, layout, &self.ellipsoids)
    }
}
