//! All clouds of a frame in one frame of coordinates, for those that ask all at once.

use glam::DVec3;

use super::{BodyUniform, Common, ELLIPSOIDS, EllipsoidUniform, LAYER, LayerShape, Species, upload_noise};
use crate::{
    frame::{CloudFrame, Frame, Shared},
    gpu::{Gpu, Role, view},
};

/// The union of all clouds but layers; a layer where that is all there is.
pub(crate) struct World {
    /// Its origin: the middle of all clouds.
    pub origin: DVec3,
    /// Cloud after cloud.
    pub ellipsoids: Vec<EllipsoidUniform>,
    /// What they are made of: each kind once.
    pub species: Vec<Shared<Species>>,
    /// The clouds.
    pub bodies: Vec<BodyUniform>,
    /// The layer.
    pub layer: Option<LayerShape>,
}

impl World {
    pub fn new(frame: &Frame) -> Self {
        if let [cloud] = frame.clouds.as_slice()
            && let Some(layer) = &cloud.medium.layer
        {
            return Self::of_layer(cloud, layer);
        }
        let (low, high) = frame.bounds().unwrap_or_default();
        let origin = 0.5 * (low + high);
        let (mut ellipsoids, mut bodies, mut species) = (Vec::new(), Vec::new(), Vec::new());
        for cloud in frame.clouds.iter().filter(|cloud| cloud.medium.layer.is_none()) {
            let offset = cloud.origin - origin;
            ellipsoids.extend(cloud.medium.moved(offset, bodies.len() as u32));
            bodies.push(cloud.medium.body_at(offset, cloud.medium.species_among(&mut species)));
        }
        Self { origin, ellipsoids, species, bodies, layer: None }
    }

    fn of_layer(cloud: &CloudFrame, layer: &LayerShape) -> Self {
        let medium = &cloud.medium;
        Self {
            origin: cloud.origin,
            ellipsoids: Vec::new(),
            species: vec![medium.species.clone()],
            bodies: vec![medium.body],
            layer: Some(layer.clone()),
        }
    }

    /// The module that fills the role of the medium.
    pub fn role(&self) -> Role<'static> {
        if self.layer.is_some() { LAYER } else { ELLIPSOIDS }
    }

    /// What shaders bind for it as their group of the medium.
    pub fn bind(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let noise_volume = view(&upload_noise(&gpu.device, &gpu.queue));
        let common = Common::new(&gpu.device, &self.bodies, noise_volume);
        if let Some(layer) = &self.layer {
            let tile = layer.tile.upload(&gpu.device, &gpu.queue);
            return common.bind_layer(&gpu.device, layout, &layer.uniform, &tile);
        }
        common.bind_ellipsoids(&gpu.device, layout, &self.ellipsoids)
    }
}
