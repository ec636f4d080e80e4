//! All clouds of a frame in one frame of coordinates, for those that ask all at once.

use glam::DVec3;

use super::{BodyUniform, Common, EllipsoidUniform, Species, upload_noise};
use crate::{
    frame::{Frame, Shared},
    gpu::{Gpu, view},
};

/// The union of all clouds but layers.
pub(crate) struct World {
    /// Its origin: the middle of all clouds.
    pub origin: DVec3,
    /// Cloud after cloud.
    pub ellipsoids: Vec<EllipsoidUniform>,
    /// What they are made of: each kind once.
    pub species: Vec<Shared<Species>>,
    /// The clouds.
    pub bodies: Vec<BodyUniform>,
}

impl World {
    pub fn new(frame: &Frame) -> Self {
        let (low, high) = frame.bounds().unwrap_or_default();
        let origin = 0.5 * (low + high);
        let (mut ellipsoids, mut bodies, mut species) = (Vec::new(), Vec::new(), Vec::new());
        for cloud in frame.clouds.iter().filter(|cloud| cloud.medium.layer.is_none()) {
            let offset = cloud.origin - origin;
            ellipsoids.extend(cloud.medium.moved(offset, bodies.len() as u32));
            bodies.push(cloud.medium.body_at(offset, cloud.medium.species_among(&mut species)));
        }
        Self { origin, ellipsoids, species, bodies }
    }

    /// What shaders bind for it as their group of the medium.
    pub fn bind(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let noise_volume = view(&upload_noise(&gpu.device, &gpu.queue));
        let common = Common::new(&gpu.device, &self.bodies, noise_volume);
        common.bind_ellipsoids(&gpu.device, layout, &self.ellipsoids)
    }
}
