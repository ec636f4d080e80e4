//! What is there: shape, noise and particles of a cloud, in the cloud's own frame. Preview, light,
//! truth and exports ask modules of `shaders/medium`: all of them the ellipsoids, and preview and light of
//! large heaps the volume of depths that is baked from those.

mod depth_volume;
mod ellipsoids;
mod noise;
mod species;
mod world;

use std::hash::{DefaultHasher, Hasher};

use glam::DVec3;

#[cfg(test)]
pub(crate) use depth_volume::{BrickUniform, CELLS, DepthVolumeUniform};
pub(crate) use depth_volume::{DEPTH_VOLUME, DepthVolume, Plan};
pub(crate) use ellipsoids::EllipsoidUniform;
#[cfg(test)]
pub(crate) use noise::FINE;
pub(crate) use noise::{NoiseFrame, upload as upload_noise};
pub use noise::{SIZE as NOISE_SIZE, bake as bake_noise};
pub(crate) use species::{Species, SpeciesTextures, SpeciesUniform};
pub(crate) use world::World;

use crate::{
    Result,
    frame::Shared,
    gpu,
    gpu::Role,
    scene::{self, Cloud},
};

/// Modules that fill the role of the medium.
pub const MEDIA: &[Role<'static>] = &[ELLIPSOIDS, DEPTH_VOLUME];

/// The medium as a union of ellipsoids.
pub(crate) const ELLIPSOIDS: Role<'static> =
    ("medium", include_str!("../../../shaders/medium/ellipsoids.wgsl"));

/// What a cloud is made of.
#[derive(Debug, PartialEq)]
pub(crate) struct Medium {
    /// Differs where anything does, but for chance.
    pub fingerprint: u64,
    /// Differs where the ellipsoids do, but for chance.
    pub shape: u64,
    pub ellipsoids: Vec<EllipsoidUniform>,
    /// Their middles, m from the origin of the cloud's frame.
    centers: Vec<DVec3>,
    pub noise: NoiseFrame,
    /// Seed of the noise volume.
    pub seed: u32,
    pub species: Shared<Species>,
}

impl Medium {
    /// What `cloud` is made of, in a frame whose origin is at `origin`.
    ///
    /// # Errors
    /// Where its droplets have no phase function.
    pub fn new(cloud: &Cloud, noise: &scene::Noise, origin: DVec3) -> Result<Self> {
        let ellipsoids = cloud.ellipsoids.iter();
        let mut medium = Self {
            fingerprint: 0,
            shape: 0,
            ellipsoids: ellipsoids.clone().map(|e| EllipsoidUniform::new(cloud, e, origin)).collect(),
            centers: ellipsoids.map(|e| e.center - origin).collect(),
            noise: NoiseFrame::new(noise, origin),
            seed: noise.seed,
            species: Species::of(&cloud.droplets)?,
        };
        let mut hasher = DefaultHasher::new();
        hasher.write(bytemuck::cast_slice(&medium.ellipsoids));
        medium.shape = hasher.finish();
        hasher.write(bytemuck::bytes_of(&medium.noise));
        hasher.write(bytemuck::bytes_of(&medium.species.uniform()));
        hasher.write_u32(medium.seed);
        medium.fingerprint = hasher.finish();
        Ok(medium)
    }

    /// Its ellipsoids moved by `offset`, m, made of species `species` of a table.
    pub fn moved(&self, offset: DVec3, species: u32) -> impl Iterator<Item = EllipsoidUniform> {
        self.ellipsoids.iter().zip(&self.centers).map(move |(e, c)| e.placed(*c + offset, species))
    }

    /// The place of its species in a table, to which it is added where it is not there.
    pub fn species_among(&self, table: &mut Vec<Shared<Species>>) -> u32 {
        let known = table.iter().position(|known| known.is(&self.species));
        let place = known.unwrap_or_else(|| {
            table.push(self.species.clone());
            table.len() - 1
        });
        place as u32
    }

    /// Extinction of the densest ellipsoid, 1/m.
    pub fn densest(&self) -> f32 {
        self.ellipsoids.iter().fold(0.0, |most, e| e.extinction.max(most))
    }
}

/// What every module of a medium binds: the noise and the table of species.
pub(crate) struct Common {
    species: wgpu::Buffer,
    noise: wgpu::Buffer,
    noise_volume: wgpu::TextureView,
    repeat: wgpu::Sampler,
}

impl Common {
    pub fn new(
        device: &wgpu::Device,
        species: &[SpeciesUniform],
        noise: &NoiseFrame,
        noise_volume: wgpu::TextureView,
    ) -> Self {
        Self {
            species: gpu::storage_buffer(device, "species", species),
            noise: gpu::uniform_buffer(device, "noise frame", noise),
            noise_volume,
            repeat: gpu::linear_repeat(device),
        }
    }

    /// A group in which `first` is binding 0, what is here follows, then `rest`.
    fn group(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        first: &wgpu::Buffer,
        rest: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let mut resources: Vec<_> =
            [first, &self.species, &self.noise].map(|buffer| Some(buffer.as_entire_binding())).into();
        resources.push(Some(wgpu::BindingResource::TextureView(&self.noise_volume)));
        resources.push(Some(wgpu::BindingResource::Sampler(&self.repeat)));
        resources.extend(rest.iter().cloned().map(Some));
        gpu::bind_group(device, "medium", layout, &resources)
    }

    /// For `shaders/medium/ellipsoids.wgsl`.
    pub fn bind_ellipsoids(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        ellipsoids: &[EllipsoidUniform],
    ) -> wgpu::BindGroup {
        self.group(device, layout, &gpu::storage_buffer(device, "ellipsoids", ellipsoids), &[])
    }

    /// For `shaders/medium/depth_volume.wgsl`.
    pub fn bind_depths(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        volume: &DepthVolume,
    ) -> wgpu::BindGroup {
        let sampler = gpu::linear_clamp_flat(device);
        let rest = [
            wgpu::BindingResource::TextureView(&volume.index),
            wgpu::BindingResource::TextureView(&volume.atlas),
            wgpu::BindingResource::Sampler(&sampler),
        ];
        self.group(device, layout, &volume.uniform, &rest)
    }
}
