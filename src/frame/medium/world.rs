//! All clouds of a frame in one frame of coordinates, for those that ask all at once.

use glam::{DVec3, Vec3};

use super::{
    BodyUniform, Common, DEPTH_VOLUME, ELLIPSOIDS, EllipsoidUniform, LAYER, LayerShape, Medium, MeshShape,
    Species, VOLUME, VolumeShape,
    mixed::{MIXED, MOST_LAYERS, MOST_MESHES, MOST_VOLUMES, Mixed},
    mixture::Fields,
    upload_noise,
};
use crate::{
    Error, Result,
    frame::{CloudFrame, Frame, Shared},
    gpu::{Gpu, Role, view},
};

/// The clouds of a frame: their union.
pub(crate) struct World {
    /// Its origin: the middle of all clouds that end, or that of a layer.
    pub origin: DVec3,
    /// Cloud after cloud.
    pub ellipsoids: Vec<EllipsoidUniform>,
    /// What holds meshes and volumes, and is not seen.
    pub holders: Vec<EllipsoidUniform>,
    /// What they are made of: each kind once.
    pub species: Vec<Shared<Species>>,
    /// The clouds.
    pub bodies: Vec<BodyUniform>,
    pub layers: Vec<Part<LayerShape>>,
    pub meshes: Vec<Part<MeshShape>>,
    pub volumes: Vec<Part<VolumeShape>>,
    /// What the only volume is a mixture of, by body.
    pub fields: Option<Fields>,
}

/// A layer, a mesh or a volume.
#[derive(Debug, Clone)]
pub(crate) struct Part<T> {
    pub shape: T,
    /// The origin of its own frame in that of all, m.
    pub origin: Vec3,
    /// Its body.
    pub body: u32,
}

impl World {
    /// All clouds of a frame.
    pub fn new(frame: &Frame) -> Self {
        let mut world = Self::without_layers(frame);
        let layers = frame.clouds.iter().filter_map(|cloud| Some((cloud, cloud.medium.layer.as_ref()?)));
        for (cloud, layer) in layers {
            if world.bodies.is_empty() {
                world.origin = cloud.origin;
            }
            let part = world.part(cloud, layer.clone());
            world.layers.push(part);
        }
        world
    }

    /// The clouds that end.
    pub fn without_layers(frame: &Frame) -> Self {
        if let Some((volume, fields)) = mixture(frame) {
            return Self::of_mixture(frame, volume, fields);
        }
        let (low, high) = frame.bounds().unwrap_or_default();
        // What is alone is in its own frame.
        let mut ends = frame.clouds.iter().filter(|cloud| cloud.medium.layer.is_none());
        let alone = match (ends.next(), ends.next()) {
            (Some(cloud), None) if cloud.medium.is_held() => Some(cloud.origin),
            _ => None,
        };
        let mut world = Self::empty(alone.unwrap_or(0.5 * (low + high)));
        for cloud in &frame.clouds {
            if cloud.medium.is_held() {
                world.holders.extend(cloud.medium.moved(cloud.origin - world.origin, 0));
            }
            if let Some(volume) = &cloud.medium.volume {
                let part = world.part(cloud, volume.clone());
                world.volumes.push(part);
            } else if let Some(mesh) = &cloud.medium.mesh {
                let part = world.part(cloud, mesh.clone());
                world.meshes.push(part);
            } else if cloud.medium.layer.is_none() {
                let (offset, body) = (cloud.origin - world.origin, world.bodies.len() as u32);
                world.ellipsoids.extend(cloud.medium.moved(offset, body));
                let table = cloud.medium.species_among(&mut world.species);
                world.bodies.push(cloud.medium.body_at(offset, table));
            }
        }
        world
    }

    fn empty(origin: DVec3) -> Self {
        let (ellipsoids, species, bodies) = Default::default();
        let (layers, meshes, volumes, holders) = Default::default();
        Self { origin, ellipsoids, holders, species, bodies, layers, meshes, volumes, fields: None }
    }

    /// Several volumes on one grid: a body each, in the frame of the first.
    fn of_mixture(frame: &Frame, volume: VolumeShape, fields: Fields) -> Self {
        let mut world = Self::empty(frame.clouds[0].origin);
        for cloud in &frame.clouds {
            let (offset, body) = (cloud.origin - world.origin, world.bodies.len() as u32);
            world.holders.extend(cloud.medium.moved(offset, body));
            let table = cloud.medium.species_among(&mut world.species);
            world.bodies.push(cloud.medium.body_at(offset, table));
        }
        world.volumes.push(Part { shape: volume, origin: Vec3::ZERO, body: 0 });
        world.fields = Some(fields);
        world
    }

    /// A cloud in its own frame.
    fn part<T>(&mut self, cloud: &CloudFrame, shape: T) -> Part<T> {
        let medium: &Medium = &cloud.medium;
        let (origin, body) = ((cloud.origin - self.origin).as_vec3(), self.bodies.len() as u32);
        let table = medium.species_among(&mut self.species);
        self.bodies.push(BodyUniform { table, ..medium.body });
        Part { shape, origin, body }
    }

    /// Whether there is nothing but a layer, a mesh, a volume or a mixture.
    pub fn is_alone(&self) -> bool {
        self.bodies.len() == 1 || self.fields.is_some()
    }

    /// Refuses frames that hold more than there is room for.
    ///
    /// # Errors
    /// [`Error::Argument`] where there are too many layers, meshes or volumes.
    pub fn check_room(&self) -> Result<()> {
        for (count, most, what) in [
            (self.layers.len(), MOST_LAYERS, "layers"),
            (self.meshes.len(), MOST_MESHES, "meshes"),
            (self.volumes.len(), MOST_VOLUMES, "volumes"),
        ] {
            if count > most {
                return Err(Error::Argument(format!(
                    "at most {most} {what} are path traced together, and the scene shows {count}: hide some of them"
                )));
            }
        }
        Ok(())
    }

    /// Refuses frames with a volume among other clouds: `done` says what is done to the clouds.
    ///
    /// # Errors
    /// [`Error::Argument`] where there is one, but for volumes that lie on one grid.
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
        match (self.layers.len(), self.meshes.len(), self.volumes.len()) {
            (0, 0, 0) => ELLIPSOIDS,
            (1, _, _) if self.is_alone() => LAYER,
            (_, 1, _) if self.is_alone() => DEPTH_VOLUME,
            (_, _, 1) if self.is_alone() => VOLUME,
            _ => MIXED,
        }
    }

    /// What shaders bind for it as their group of the medium.
    pub fn bind(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let (device, queue) = (&gpu.device, &gpu.queue);
        let common = Common::new(device, &self.bodies, view(&upload_noise(device, queue)));
        match (self.layers.as_slice(), self.meshes.as_slice(), self.volumes.as_slice()) {
            ([], [], []) => common.bind_ellipsoids(device, layout, &self.ellipsoids),
            ([Part { shape, .. }], _, _) if self.is_alone() => {
                common.bind_layer(device, layout, &shape.uniform, &shape.tile.upload(device, queue))
            }
            (_, [Part { shape, .. }], _) if self.is_alone() => {
                common.bind_depths(device, layout, &shape.upload(device, queue), shape.extinction)
            }
            (_, _, [Part { shape, .. }]) if self.is_alone() => {
                let textures = match &self.fields {
                    Some(fields) => fields.upload(&shape.bricks, device, queue),
                    None => shape.bricks.upload(device, queue),
                };
                common.bind_volume(device, layout, &shape.uniform, &textures)
            }
            _ => common.bind_mixed(device, layout, &self.ellipsoids, &Mixed::new(gpu, self)),
        }
    }
}

/// The volumes of a frame where there are several, on one grid, and nothing else.
fn mixture(frame: &Frame) -> Option<(VolumeShape, Fields)> {
    (frame.clouds.len() > 1).then(|| VolumeShape::mixed(&frame.clouds))?
}
