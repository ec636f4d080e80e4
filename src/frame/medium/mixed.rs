//! Layers, meshes and volumes among other clouds, for those that ask all at once (`shaders/medium/mixed.wgsl`).

use glam::{UVec3, Vec3};

use super::{
    DepthVolumeUniform, LayerUniform, MeshShape, VolumeUniform,
    atlas::{atlas, fill_atlas, index_of, slots, slots_of, texel_of},
    depth_volume::STORED,
    layer_tile::fields,
    world::{Part, World},
};
use crate::gpu::{self, Gpu, Role, TextureDesc};

/// The medium as all that a scene has, for those that ask at points alone: it knows no rays.
pub const MIXED: Role<'static> = ("medium", include_str!("../../../shaders/medium/mixed.wgsl"));

/// Layers, meshes and volumes that there is room for.
pub(crate) const MOST_LAYERS: usize = 4;
pub(crate) const MOST_MESHES: usize = 8;
pub(crate) const MOST_VOLUMES: usize = 8;
/// Entries of a row of the index.
pub(crate) const ROW: u32 = 4096;

/// `PlacedLayer` of the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PlacedLayerUniform {
    pub(crate) layer: LayerUniform,
    pub(crate) origin: Vec3,
    pub(crate) body: u32,
}

/// `PlacedMesh` of the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PlacedMeshUniform {
    pub(crate) volume: DepthVolumeUniform,
    pub(crate) origin: Vec3,
    pub(crate) body: u32,
    pub(crate) first: u32,
    padding: [u32; 3],
}

/// `PlacedVolume` of the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PlacedVolumeUniform {
    pub(crate) volume: VolumeUniform,
    pub(crate) origin: Vec3,
    pub(crate) body: u32,
}

/// `Mixed` of the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct MixedUniform {
    pub(crate) layers: [PlacedLayerUniform; MOST_LAYERS],
    pub(crate) volumes: [PlacedVolumeUniform; MOST_VOLUMES],
    pub(crate) meshes: [PlacedMeshUniform; MOST_MESHES],
    pub(crate) layer_count: u32,
    pub(crate) volume_count: u32,
    pub(crate) mesh_count: u32,
    padding: u32,
}

/// What the shader binds of layers, meshes and volumes.
pub(super) struct Mixed {
    pub uniform: wgpu::Buffer,
    pub fields: wgpu::TextureView,
    pub index: wgpu::TextureView,
    pub atlas: wgpu::TextureView,
    pub depths: wgpu::TextureView,
}

impl Mixed {
    pub fn new(gpu: &Gpu, world: &World) -> Self {
        let Gpu { device, queue, .. } = gpu;
        let bricks: Vec<_> = world.volumes.iter().map(|part| &*part.shape.bricks).collect();
        let (firsts, mut entries) = index_of(&bricks);
        let mut uniform = MixedUniform {
            layer_count: world.layers.len() as u32,
            volume_count: world.volumes.len() as u32,
            mesh_count: world.meshes.len() as u32,
            ..bytemuck::Zeroable::zeroed()
        };
        for (to, Part { shape, origin, body }) in uniform.layers.iter_mut().zip(&world.layers) {
            *to = PlacedLayerUniform { layer: shape.uniform, origin: *origin, body: *body };
        }
        let among = slots_of(&bricks);
        for ((to, part), first) in uniform.volumes.iter_mut().zip(&world.volumes).zip(firsts) {
            let volume = part.shape.uniform.in_atlas(among, first);
            *to = PlacedVolumeUniform { volume, origin: part.origin, body: part.body };
        }
        let meshes: Vec<_> = world.meshes.iter().map(|part| &part.shape).collect();
        let stored: Vec<_> = meshes.iter().map(|mesh| mesh.depths.stored.len()).collect();
        let all = slots(stored.iter().sum());
        let mut before = 0;
        for ((to, Part { shape, origin, body }), stored) in
            uniform.meshes.iter_mut().zip(&world.meshes).zip(&stored)
        {
            let first = entries.len() as u32;
            let entry = |&entry: &u32| if entry >= STORED { entry + before } else { entry };
            entries.extend(shape.depths.index.iter().map(entry));
            before += *stored as u32;
            let (slots, texel) = ([all.x, all.y], texel_of(all));
            let volume = DepthVolumeUniform { core: shape.extinction, slots, texel, ..shape.uniform };
            *to = PlacedMeshUniform { volume, origin: *origin, body: *body, first, padding: [0; 3] };
        }
        let tiles: Vec<_> = world.layers.iter().map(|part| &*part.shape.tile).collect();
        Self {
            uniform: gpu::uniform_buffer(device, "layers, meshes and volumes", &uniform),
            fields: fields_view(gpu, &tiles),
            index: index_texture(gpu, &entries),
            atlas: atlas(device, queue, &bricks),
            depths: depth_atlas(gpu, &meshes),
        }
    }
}

/// The bricks of all meshes.
fn depth_atlas(gpu: &Gpu, meshes: &[&MeshShape]) -> wgpu::TextureView {
    let numbers = |mesh: &&MeshShape| 0..mesh.depths.stored.len();
    let all: Vec<_> = meshes.iter().flat_map(|mesh| numbers(mesh).map(move |i| (*mesh, i))).collect();
    let texels = |i: usize| all[i].0.texels(all[i].1);
    fill_atlas(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float, all.len(), texels)
}

/// All fields; where there are none, a texel that nobody reads.
fn fields_view(gpu: &Gpu, tiles: &[&super::Tile]) -> wgpu::TextureView {
    let texture = if tiles.is_empty() {
        let (format, usage) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::empty());
        gpu::texture(
            &gpu.device,
            &TextureDesc { label: "no fields", size: [1, 1, 0], mips: 1, format, usage },
        )
    } else {
        fields(&gpu.device, &gpu.queue, tiles)
    };
    let dimension = Some(wgpu::TextureViewDimension::D2Array);
    texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}

/// Entries in rows.
fn index_texture(gpu: &Gpu, entries: &[u32]) -> wgpu::TextureView {
    let rows = (entries.len() as u32).div_ceil(ROW).max(1);
    let (format, usage) = (wgpu::TextureFormat::R32Uint, wgpu::TextureUsages::empty());
    let size = [ROW, rows, 0];
    let texture =
        gpu::texture(&gpu.device, &TextureDesc { label: "volume index", size, mips: 1, format, usage });
    let mut texels = entries.to_vec();
    texels.resize((ROW * rows) as usize, 0);
    gpu.queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * ROW), rows_per_image: None },
        wgpu::Extent3d { width: ROW, height: rows, depth_or_array_layers: 1 },
    );
    gpu::view(&texture)
}

impl VolumeUniform {
    /// The same with its bricks among those of others, in an atlas of `slots`, and its index from `first` on.
    fn in_atlas(mut self, slots: UVec3, first: u32) -> Self {
        self.slots = [slots.x, slots.y];
        self.texel = texel_of(slots);
        self.levels.iter_mut().for_each(|level| level[3] += first);
        self
    }
}
