//! The media of clouds on the device: what shaders bind for each, made once a shape.

use std::collections::HashMap;

use wgpu::{BindGroup, BindGroupLayout, TextureView};

use crate::{
    frame::{
        Shared,
        medium::{
            Common, DepthVolume, LayerShape, Medium, MediumKind, Plan, Tile, TileTextures, VolumeBricks,
            VolumeTextures, upload_noise,
        },
    },
    gpu::{ComputeProgram, Shader, view},
};

/// Media that were in one of the last pictures.
pub(super) struct Media {
    device: wgpu::Device,
    queue: wgpu::Queue,
    kept: HashMap<u64, Vec<Kept>>,
    noise: Option<TextureView>,
    picture: u64,
    /// Clouds of so many ellipsoids or more have a baked volume.
    bake_from: u32,
    /// How many volumes of depths were made so far.
    pub baked: u32,
    layouts: HashMap<MediumKind, BindGroupLayout>,
    bake: Option<ComputeProgram>,
    /// Fields of layers.
    tiles: Vec<(Shared<Tile>, TileTextures)>,
    /// Bricks of volumes of files, with the last picture that each was in.
    bricks: Vec<(Shared<VolumeBricks>, VolumeTextures, u64)>,
    /// By shape, with the last picture that each was in.
    volumes: HashMap<u64, (Volume, u64)>,
}

/// The volume of depths of a shape with enough ellipsoids.
enum Volume {
    /// Ellipsoids are asked: bricks would be too coarse, or there is no memory left for them.
    Unsuited,
    Planned(Box<Plan>),
    Baked(Box<DepthVolume>),
}

struct Kept {
    medium: Shared<Medium>,
    kind: MediumKind,
    group: BindGroup,
    /// The last picture that it was in.
    picture: u64,
}

/// Memory of all volumes of depths, bytes: shapes beyond it are asked, ellipsoid by ellipsoid.
const MOST_BYTES: u64 = 256 << 20;
/// Fields of layers that are kept.
const MOST_TILES: usize = 8;
/// Pictures for which what is not in them is kept.
const KEPT_FOR: u64 = 2;

impl Media {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            device: device.clone(),
            queue: queue.clone(),
            kept: HashMap::new(),
            noise: None,
            picture: 0,
            bake_from: u32::MAX,
            baked: 0,
            layouts: HashMap::new(),
            bake: None,
            tiles: Vec::new(),
            bricks: Vec::new(),
            volumes: HashMap::new(),
        }
    }

    /// Begins a picture in which clouds of `bake_from` ellipsoids or more have a baked volume: forgets
    /// what the last pictures had not.
    pub fn begin(&mut self, bake_from: u32) {
        self.bake_from = bake_from;
        self.picture += 1;
        let oldest = self.picture.saturating_sub(KEPT_FOR);
        self.kept.retain(|_, list| {
            list.retain(|kept| kept.picture >= oldest);
            !list.is_empty()
        });
        self.volumes.retain(|_, (_, picture)| *picture >= oldest);
        self.bricks.retain(|(_, _, picture)| *picture >= oldest);
    }

    /// Plans the volumes of those `media` that have enough ellipsoids and none yet.
    pub fn plan<'a>(&mut self, media: impl Iterator<Item = &'a Medium>) {
        let many = u64::from(self.bake_from);
        let has_many = |medium: &&Medium| medium.is_of_ellipsoids() && medium.ellipsoids.len() as u64 >= many;
        for medium in media.filter(has_many) {
            let has_room = self.bytes() < MOST_BYTES;
            let planned = || match Plan::new(&medium.ellipsoids, medium.body.level).filter(|_| has_room) {
                Some(plan) => Volume::Planned(Box::new(plan)),
                None => Volume::Unsuited,
            };
            self.volumes.entry(medium.shape).or_insert_with(|| (planned(), 0)).1 = self.picture;
        }
    }

    /// Whether a medium has a volume of depths.
    pub fn is_baked(&self, medium: &Medium) -> bool {
        medium.is_of_ellipsoids()
            && medium.ellipsoids.len() as u64 >= u64::from(self.bake_from)
            && self.volumes.get(&medium.shape).is_some_and(|(volume, _)| !matches!(volume, Volume::Unsuited))
    }

    /// Which module fills the role of the medium.
    pub fn kind(&self, medium: &Medium) -> MediumKind {
        match &medium.layer {
            Some(_) => MediumKind::Layer,
            None if medium.volume.is_some() => MediumKind::Volume,
            None if medium.mesh.is_some() || self.is_baked(medium) => MediumKind::DepthVolume,
            None => MediumKind::Ellipsoids,
        }
    }

    /// Makes what shaders bind for `medium`, where it is not there.
    pub fn prepare(&mut self, encoder: &mut wgpu::CommandEncoder, medium: &Shared<Medium>) {
        let (kind, picture) = (self.kind(medium), self.picture);
        if let Some(volume) = &medium.volume {
            self.keep_bricks(&volume.bricks);
        }
        if medium.mesh.is_some()
            && let Some((_, last)) = self.volumes.get_mut(&medium.shape)
        {
            *last = picture;
        }
        let known = self.kept.get_mut(&medium.fingerprint).into_iter().flatten();
        let mut known = known.filter(|kept| kept.kind == kind && kept.medium == *medium);
        if let Some(kept) = known.next() {
            // The next comparison is one of pointers.
            (kept.picture, kept.medium) = (picture, medium.clone());
            return;
        }
        drop(known);
        let group = self.bind(encoder, medium, kind);
        let kept = Kept { medium: medium.clone(), kind, group, picture };
        self.kept.entry(medium.fingerprint).or_default().push(kept);
    }

    /// What shaders bind as group 1 for a medium that was prepared.
    pub fn group(&self, medium: &Shared<Medium>) -> &BindGroup {
        let kind = self.kind(medium);
        let known = self.kept.get(&medium.fingerprint).into_iter().flatten();
        let found = known.into_iter().find(|kept| kept.kind == kind && kept.medium == *medium);
        &found.expect("media of clouds in the picture are prepared before their light").group
    }

    /// Uploads the bricks of a volume where they are not there, and keeps them.
    fn keep_bricks(&mut self, bricks: &Shared<VolumeBricks>) -> &VolumeTextures {
        let known = self.bricks.iter().position(|(known, ..)| known.is(bricks));
        let place = known.unwrap_or_else(|| {
            let textures = bricks.upload(&self.device, &self.queue);
            self.bricks.push((bricks.clone(), textures, 0));
            self.bricks.len() - 1
        });
        let (_, textures, picture) = &mut self.bricks[place];
        *picture = self.picture;
        textures
    }

    /// Memory of the bricks of volumes of files, bytes.
    pub fn brick_bytes(&self) -> u64 {
        self.bricks.iter().map(|(bricks, ..)| bricks.bytes()).sum()
    }

    /// Memory of all baked volumes, bytes.
    pub fn bytes(&self) -> u64 {
        let bytes = |(volume, _): &(Volume, u64)| match volume {
            Volume::Baked(volume) => volume.bytes(),
            Volume::Unsuited | Volume::Planned(_) => 0,
        };
        self.volumes.values().map(bytes).sum()
    }

    fn bind(&mut self, encoder: &mut wgpu::CommandEncoder, medium: &Medium, kind: MediumKind) -> BindGroup {
        let (device, queue) = (&self.device, &self.queue);
        let noise = self.noise.get_or_insert_with(|| view(&upload_noise(device, queue))).clone();
        let common = Common::new(device, &[medium.body], noise);
        // Any shader that has the role declares its group.
        let layout = self
            .layouts
            .entry(kind)
            .or_insert_with(|| {
                let groups = Shader::new(&self.device, "sky_volume", &[kind.role()]).groups;
                groups.into_iter().nth(1).flatten().expect("a medium binds what is there")
            })
            .clone();
        if let Some(layer) = &medium.layer {
            let tile = tile(&mut self.tiles, device, queue, layer);
            return common.bind_layer(device, &layout, &layer.uniform, &tile);
        }
        if let Some(volume) = &medium.volume {
            let textures = self.keep_bricks(&volume.bricks).clone();
            return common.bind_volume(&self.device, &layout, &volume.uniform, &textures);
        }
        if let Some(mesh) = &medium.mesh {
            let uploaded = || {
                self.baked += 1;
                (Volume::Baked(Box::new(mesh.upload(device, queue))), self.picture)
            };
            self.volumes.entry(medium.shape).or_insert_with(uploaded);
        }
        let Some((volume, _)) =
            self.volumes.get_mut(&medium.shape).filter(|_| kind == MediumKind::DepthVolume)
        else {
            return common.bind_ellipsoids(&self.device, &layout, &medium.ellipsoids);
        };
        if let Volume::Planned(plan) = volume {
            let program =
                self.bake.get_or_insert_with(|| ComputeProgram::new(&self.device, "depth_bake", &[]));
            self.baked += 1;
            let shape = (medium.ellipsoids.as_slice(), &medium.body);
            *volume = Volume::Baked(Box::new(DepthVolume::bake(device, encoder, program, shape, plan)));
        }
        match volume {
            Volume::Baked(volume) => common.bind_depths(device, &layout, volume, medium.densest()),
            Volume::Unsuited | Volume::Planned(_) => {
                common.bind_ellipsoids(&self.device, &layout, &medium.ellipsoids)
            }
        }
    }
}

/// The field of a layer on the device.
fn tile(
    known: &mut Vec<(Shared<Tile>, TileTextures)>,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    layer: &LayerShape,
) -> TileTextures {
    if let Some((_, textures)) = known.iter().find(|(tile, _)| *tile == layer.tile) {
        return textures.clone();
    }
    let textures = layer.tile.upload(device, queue);
    known.truncate(MOST_TILES - 1);
    known.insert(0, (layer.tile.clone(), textures.clone()));
    textures
}
