//! All clouds of a frame in one frame of coordinates, for those that ask all at once.

use glam::DVec3;

use super::{
    BodyUniform, Common, ELLIPSOIDS, EllipsoidUniform, LAYER, LayerShape, Species, VOLUME, VolumeShape,
    mixture::Fields, upload_noise,
};
use crate::{
    Error, Result,
    frame::{CloudFrame, Frame, Shared},
    gpu::{Gpu, Role, view},
};

/// The union of all clouds but layers and volumes; a layer or a volume where that is all there is.
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
    /// The volume, which its ellipsoids hold.
    pub volume: Option<VolumeShape>,
    /// What it is a mixture of, by body.
    pub fields: Option<Fields>,
}

impl World {
    pub fn new(frame: &Frame) -> Self {
        if let [cloud] = frame.clouds.as_slice()
            && let Some(layer) = &cloud.medium.layer
        {
            return Self::of_layer(cloud, layer);
        }
        if let [cloud] = frame.clouds.as_slice()
            && let Some(volume) = &cloud.medium.volume
        {
            return Self::of_volume(cloud, volume);
        }
        if let Some((volume, fields)) = mixture(frame) {
            return Self::of_mixture(frame, volume, fields);
        }
        let (low, high) = frame.bounds().unwrap_or_default();
        let origin = 0.5 * (low + high);
        let (mut ellipsoids, mut bodies, mut species) = (Vec::new(), Vec::new(), Vec::new());
        for cloud in frame.clouds.iter().filter(|cloud| cloud.medium.is_of_ellipsoids()) {
            let offset = cloud.origin - origin;
            ellipsoids.extend(cloud.medium.moved(offset, bodies.len() as u32));
            bodies.push(cloud.medium.body_at(offset, cloud.medium.species_among(&mut species)));
        }
        Self { origin, ellipsoids, species, bodies, layer: None, volume: None, fields: None }
    }

    fn of_layer(cloud: &CloudFrame, layer: &LayerShape) -> Self {
        let medium = &cloud.medium;
        Self {
            origin: cloud.origin,
            ellipsoids: Vec::new(),
            species: vec![medium.species.clone()],
            bodies: vec![medium.body],
            layer: Some(layer.clone()),
            volume: None,
            fields: None,
        }
    }

    fn of_volume(cloud: &CloudFrame, volume: &VolumeShape) -> Self {
        let medium = &cloud.medium;
        Self {
            origin: cloud.origin,
            ellipsoids: medium.ellipsoids.clone(),
            species: vec![medium.species.clone()],
            bodies: vec![medium.body],
            layer: None,
            volume: Some(volume.clone()),
            fields: None,
        }
    }

    /// Several volumes on one grid: a body each, in the frame of the first.
    fn of_mixture(frame: &Frame, volume: VolumeShape, fields: Fields) -> Self {
        let origin = frame.clouds[0].origin;
        let (mut ellipsoids, mut bodies, mut species) = (Vec::new(), Vec::new(), Vec::new());
        for cloud in &frame.clouds {
            let offset = cloud.origin - origin;
            ellipsoids.extend(cloud.medium.moved(offset, bodies.len() as u32));
            bodies.push(cloud.medium.body_at(offset, cloud.medium.species_among(&mut species)));
        }
        Self { origin, ellipsoids, species, bodies, layer: None, volume: Some(volume), fields: Some(fields) }
    }

    /// Refuses frames that it is not all of: `done` says what is done to the clouds.
    ///
    /// # Errors
    /// [`Error::Argument`] where there is a volume among other clouds that do not lie on its grid.
    pub fn check_volumes(frame: &Frame, done: &str) -> Result<()> {
        let volumes = frame.clouds.iter().filter(|cloud| cloud.medium.volume.is_some()).count();
        if volumes > 0 && frame.clouds.len() > 1 && mixture(frame).is_none() {
            return Err(Error::Argument(format!(
                "a volume is {done} only by itself or with up to three others on the same grid, and the scene shows {volumes} of \
                 them among {} clouds: hide all but one volume, or the volumes",
                frame.clouds.len()
            )));
        }
        Ok(())
    }

    /// The module that fills the role of the medium.
    pub fn role(&self) -> Role<'static> {
        match (&self.layer, &self.volume) {
            (Some(_), _) => LAYER,
            (None, Some(_)) => VOLUME,
            (None, None) => ELLIPSOIDS,
        }
    }

    /// What shaders bind for it as their group of the medium.
    pub fn bind(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let noise_volume = view(&upload_noise(&gpu.device, &gpu.queue));
        let common = Common::new(&gpu.device, &self.bodies, noise_volume);
        if let Some(layer) = &self.layer {
            let tile = layer.tile.upload(&gpu.device, &gpu.queue);
            return common.bind_layer(&gpu.device, layout, &layer.uniform, &tile);
        }
        if let Some(volume) = &self.volume {
            let textures = match &self.fields {
                Some(fields) => fields.upload(&volume.bricks, &gpu.device, &gpu.queue),
                None => volume.bricks.upload(&gpu.device, &gpu.queue),
            };
            return common.bind_volume(&gpu.device, layout, &volume.uniform, &textures);
        }
        common.bind_ellipsoids(&gpu.device, layout, &self.ellipsoids)
    }
}

/// The volumes of a frame where there are several, on one grid, and nothing else.
fn mixture(frame: &Frame) -> Option<(VolumeShape, Fields)> {
    (frame.clouds.len() > 1).then(|| VolumeShape::mixed(&frame.clouds))?
}
