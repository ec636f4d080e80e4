//! What is there: shape, noise and particles of a cloud, in the cloud's own frame. Preview, light,
//! truth and exports ask modules of `shaders/medium`: all of them the ellipsoids, and preview and light of
//! large heaps the volume of depths that is baked from those. Of meshes all ask such a volume.

mod atlas;
mod body;
mod bricks;
mod common;
mod depth_volume;
mod ellipsoids;
mod layer;
mod layer_field;
mod layer_tile;
mod mesh;
mod mixed;
mod mixture;
mod noise;
mod noise_volume;
mod species;
mod volume;
mod world;

use std::hash::{DefaultHasher, Hasher};

use glam::DVec3;

pub(crate) use atlas::VolumeTextures;
pub(crate) use body::{BodyUniform, smooth_rise};
pub(crate) use bricks::Bricks as VolumeBricks;
#[cfg(test)]
pub(crate) use bricks::{CELLS as VOLUME_CELLS, LEVELS as VOLUME_LEVELS};
pub(crate) use common::Common;
#[cfg(test)]
pub(crate) use depth_volume::{BrickUniform, CELLS};
pub(crate) use depth_volume::{DEPTH_VOLUME, DepthVolume, DepthVolumeUniform, Plan};
pub(crate) use ellipsoids::EllipsoidUniform;
pub(crate) use layer::{LAYER, LayerShape, LayerUniform};
#[cfg(test)]
pub(crate) use layer_tile::SQUARES;
pub(crate) use layer_tile::{Tile, TileTextures};
pub(crate) use mesh::MeshShape;
pub use mixed::MIXED;
#[cfg(test)]
pub(crate) use mixed::{
    MOST_LAYERS, MOST_MESHES, MOST_VOLUMES, MixedUniform, PlacedLayerUniform, PlacedMeshUniform,
    PlacedVolumeUniform, ROW as MIXED_ROW,
};
#[cfg(test)]
pub(crate) use noise::FINE;
pub(crate) use noise::NoiseFrame;
pub(crate) use noise_volume::upload as upload_noise;
pub use noise_volume::{SIZE as NOISE_SIZE, bake as bake_noise};
#[cfg(test)]
pub(crate) use species::PEAKS;
pub(crate) use species::{Species, SpeciesTextures, SpeciesUniform};
pub(crate) use volume::{VOLUME, VolumeShape, VolumeUniform};
pub(crate) use world::{Part, World};

use crate::{
    Result,
    frame::Shared,
    gpu::Role,
    scene::{self, Cloud},
};

/// Modules that fill the role of the medium.
pub const MEDIA: &[Role<'static>] = &[ELLIPSOIDS, DEPTH_VOLUME, LAYER, VOLUME];

/// The medium as a union of ellipsoids.
pub(crate) const ELLIPSOIDS: Role<'static> =
    ("medium", include_str!("../../../shaders/medium/ellipsoids.wgsl"));

/// Which module fills the role of the medium: quick to compare and to hash, as the module's text is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum MediumKind {
    Ellipsoids,
    DepthVolume,
    Layer,
    Volume,
}

impl MediumKind {
    pub fn role(self) -> Role<'static> {
        match self {
            Self::Ellipsoids => ELLIPSOIDS,
            Self::DepthVolume => DEPTH_VOLUME,
            Self::Layer => LAYER,
            Self::Volume => VOLUME,
        }
    }
}

/// What a cloud is made of.
#[derive(Debug)]
pub(crate) struct Medium {
    /// Differs where ellipsoids or body do, but for a chance of 2^-64.
    pub fingerprint: u64,
    /// Differs where its depths do, but for chance: not where all of it is thinner.
    pub shape: u64,
    pub ellipsoids: Vec<EllipsoidUniform>,
    /// Their middles, m from the origin of the cloud's frame.
    centers: Vec<DVec3>,
    pub body: BodyUniform,
    /// Its shape where it is a layer, and so has no ellipsoids.
    pub layer: Option<LayerShape>,
    /// Its shape where a mesh is its boundary: its ellipsoids hold that, and are not seen.
    pub mesh: Option<MeshShape>,
    /// Its shape where it is a volume: its ellipsoids hold that, and are not seen.
    pub volume: Option<VolumeShape>,
    /// Its noise, the size of whose largest features is `scale`, m, as seen from `origin`.
    noise: scene::Noise,
    scale: f64,
    origin: DVec3,
    pub species: Shared<Species>,
}

/// Whether shaders see the same: wherever in the world it is, as a cloud that drifts with its noise. Ellipsoids are
/// told by the fingerprint: a thousand clouds are compared in each frame.
impl PartialEq for Medium {
    fn eq(&self, other: &Self) -> bool {
        self.fingerprint == other.fingerprint
            && self.layer == other.layer
            && self.mesh == other.mesh
            && self.volume == other.volume
            && self.species == other.species
    }
}

impl Medium {
    /// What `cloud` is made of, which lies in the box of `bounds`, in a frame whose origin is at `origin`.
    /// Its noise is that of its scene where it has none.
    ///
    /// # Errors
    /// Where its droplets have no phase function.
    pub fn new(cloud: &Cloud, noise: &scene::Noise, bounds: scene::Bounds, origin: DVec3) -> Result<Self> {
        let noise = cloud.noise.as_ref().unwrap_or(noise).clone();
        let (scale, species) = (noise.scale_in(bounds), Species::of(&cloud.droplets)?);
        let frame = NoiseFrame::new(&noise, scale, origin);
        let own = (bounds.0 - origin, bounds.1 - origin);
        let steady = steady_depth(cloud);
        let body = BodyUniform::new(cloud, own, origin.y, frame, species.uniform(), steady.is_finite());
        let ellipsoids = cloud.ellipsoids.iter();
        let mut medium = Self {
            fingerprint: 0,
            shape: 0,
            ellipsoids: ellipsoids.clone().map(|e| EllipsoidUniform::new(cloud, e, origin, steady)).collect(),
            centers: ellipsoids.map(|e| e.center - origin).collect(),
            body,
            layer: None,
            mesh: None,
            volume: None,
            noise,
            scale,
            origin,
            species,
        };
        let mut hasher = DefaultHasher::new();
        let densest = medium.densest().max(f32::MIN_POSITIVE);
        for ellipsoid in &medium.ellipsoids {
            let share = (1e4 * ellipsoid.extinction / densest).round();
            hasher.write(bytemuck::bytes_of(&EllipsoidUniform { extinction: share, ..*ellipsoid }));
        }
        hasher.write(bytemuck::bytes_of(&[medium.body.power, medium.body.reach, medium.body.level]));
        medium.shape = hasher.finish();
        hasher.write(bytemuck::bytes_of(&densest));
        hasher.write(bytemuck::bytes_of(&medium.body));
        medium.fingerprint = hasher.finish();
        Ok(medium)
    }

    /// What a layer is made of, in the frame whose origin is a corner of it. Its noise is that of its scene
    /// where it has none, and repeats as the layer does.
    ///
    /// # Errors
    /// Where its droplets have no phase function.
    pub fn of_layer(cloud: &Cloud, shape: LayerShape, noise: &scene::Noise) -> Result<Self> {
        let noise = cloud.noise.as_ref().unwrap_or(noise).clone();
        let (species, origin) = (Species::of(&cloud.droplets)?, shape.anchor());
        let scale = cloud.layer.as_ref().map_or(1.0, |layer| layer.billows(&noise));
        let stretched = cloud.layer.as_ref().map_or(DVec3::ZERO, scene::Layer::lengthening);
        let frame = NoiseFrame::repeating(&noise, scale, origin, shape.period, stretched);
        let half = shape.half();
        let level = Cloud { level: Some(origin.y - half.y), ..cloud.clone() };
        let body = BodyUniform::new(&level, (-half, half), origin.y, frame, species.uniform(), false);
        let mut hasher = DefaultHasher::new();
        hasher.write(bytemuck::bytes_of(&shape.uniform));
        hasher.write(bytemuck::bytes_of(&body));
        let fingerprint = hasher.finish();
        Ok(Self {
            fingerprint,
            shape: fingerprint,
            ellipsoids: Vec::new(),
            centers: Vec::new(),
            body,
            layer: Some(shape),
            mesh: None,
            volume: None,
            noise,
            scale,
            origin,
            species,
        })
    }

    /// What a volume is made of, in a frame whose origin is at `origin`, where it lies in the box of `bounds`.
    ///
    /// # Errors
    /// Where it was not read or is too large, or its droplets have no phase function.
    pub fn of_volume(
        cloud: &Cloud,
        volume: &scene::Volume,
        noise: &scene::Noise,
        bounds: scene::Bounds,
        origin: DVec3,
    ) -> Result<Self> {
        let shape = VolumeShape::new(volume, origin)?;
        let mut medium = Self::new(cloud, noise, bounds, origin)?;
        medium.ellipsoids = shape.proxies(cloud, volume, origin);
        medium.centers = medium.ellipsoids.iter().map(|proxy| proxy.center.as_dvec3()).collect();
        let mut hasher = DefaultHasher::new();
        hasher.write(bytemuck::bytes_of(&shape.uniform));
        hasher.write(bytemuck::bytes_of(&medium.body));
        hasher.write_usize(std::ptr::from_ref(&*shape.bricks).addr());
        medium.fingerprint = hasher.finish();
        medium.shape = medium.fingerprint;
        medium.volume = Some(shape);
        Ok(medium)
    }

    /// What a cloud is made of that has a mesh as its boundary, in a frame whose origin is at `origin`, where it lies in the
    /// box of `bounds`.
    ///
    /// # Errors
    /// Where it was not read, or its droplets have no phase function.
    pub fn of_mesh(
        cloud: &Cloud,
        mesh: &scene::Mesh,
        noise: &scene::Noise,
        bounds: scene::Bounds,
        origin: DVec3,
    ) -> Result<Self> {
        let shape = MeshShape::new(cloud, mesh, origin)?;
        let mut medium = Self::new(cloud, noise, bounds, origin)?;
        medium.ellipsoids = shape.proxies(cloud, mesh, origin);
        medium.centers = medium.ellipsoids.iter().map(|proxy| proxy.center.as_dvec3()).collect();
        let mut hasher = DefaultHasher::new();
        shape.hash_into(&mut hasher);
        medium.shape = hasher.finish();
        hasher.write(bytemuck::bytes_of(&medium.densest()));
        hasher.write(bytemuck::bytes_of(&medium.body));
        medium.fingerprint = hasher.finish();
        medium.mesh = Some(shape);
        Ok(medium)
    }

    /// Whether it is the same but for noise that was carried by no more than `way`, m.
    pub fn is_near(&self, other: &Self, way: f64) -> bool {
        let of_noise = [self.noise_at(), other.noise_at()];
        self.shape == other.shape
            && self.densest() == other.densest()
            && BodyUniform { noise: other.body.noise, ..self.body } == other.body
            && self.is_of_ellipsoids()
            && other.is_of_ellipsoids()
            && self.species == other.species
            && self.scale == other.scale
            && of_noise[0].distance_to(&of_noise[1], self.body.reach.into()) <= way
    }

    /// Its noise, shifted as the frame is.
    fn noise_at(&self) -> scene::Noise {
        scene::Noise { offset: self.noise.offset - self.origin, ..self.noise.clone() }
    }

    /// Whether its ellipsoids are its shape.
    pub fn is_of_ellipsoids(&self) -> bool {
        self.layer.is_none() && !self.is_held()
    }

    /// Whether its ellipsoids hold its shape and are not seen: rays find their way in that by themselves.
    pub fn is_held(&self) -> bool {
        self.mesh.is_some() || self.volume.is_some()
    }

    /// Its ellipsoids moved by `offset`, m, in body `body` of a table.
    pub fn moved(&self, offset: DVec3, body: u32) -> impl Iterator<Item = EllipsoidUniform> {
        self.ellipsoids.iter().zip(&self.centers).map(move |(e, c)| e.placed(*c + offset, body))
    }

    /// Its body in a frame from which its own is seen at `offset`, m. Its species has place `table` among others.
    pub fn body_at(&self, offset: DVec3, table: u32) -> BodyUniform {
        let noise = NoiseFrame::new(&self.noise, self.scale, self.origin - offset);
        self.body.moved(noise, offset, table)
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

    /// Extinction of the densest ellipsoid or of the layer, 1/m.
    pub fn densest(&self) -> f32 {
        if let Some(layer) = &self.layer {
            return layer.uniform.extinction;
        }
        self.ellipsoids.iter().fold(0.0, |most, e| e.extinction.max(most))
    }
}

/// How deep below the surface of a lump extinction changes with nothing but height, m: nowhere where lumps
/// have densities of their own.
fn steady_depth(cloud: &Cloud) -> f64 {
    let densities = || cloud.ellipsoids.iter().map(|ellipsoid| ellipsoid.density);
    if densities().fold(0.0, f64::max) > densities().fold(f64::INFINITY, f64::min) {
        return f64::INFINITY;
    }
    let boundaries = cloud.ellipsoids.iter().map(|ellipsoid| cloud.edge_of(ellipsoid).boundary);
    let thickest = boundaries.fold(0.0, f64::max);
    if cloud.dilution > 0.0 { DILUTED * thickest } else { thickest }
}

/// Depth behind a displaced boundary, in boundaries, down to which droplets are lost, and with it the
/// depth below the surface: `shaders/lib/density.wgsl`.
const DILUTED: f64 = 3.0;
