//! The density of a frame in voxels, for tools that take volumes.
//!
//! How it works. Space is cut into blocks of 8 by 8 by 8 voxels, the leaves of OpenVDB; only
//! those that an ellipsoid reaches into are kept. The GPU finds the mean extinction of their
//! voxels with the density that pictures are drawn with, some blocks a dispatch: memory and
//! time of a dispatch stay the same however large the volume is.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3, IVec3, Vec3};

use crate::{
    Error, Result,
    frame::{Frame, medium::World},
    gpu::{self, ComputeProgram, Gpu},
    scene::{BLOCK_EDGE, BLOCK_VOXELS, Block},
};

/// Most voxels of all blocks: 2 GiB of them.
const MOST_VOXELS: usize = 1 << 29;
/// Blocks of one dispatch: about a tenth of a second on two CPU cores.
const BLOCKS_AT_ONCE: usize = 128;

/// `Voxels` of `shaders/voxels.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct VoxelsUniform {
    pub(crate) edge_x: Vec3,
    pub(crate) samples: u32,
    pub(crate) edge_y: Vec3,
    pub(crate) blocks: u32,
    pub(crate) edge_z: Vec3,
    padding: f32,
}

/// `Block` of `shaders/voxels.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BlockUniform {
    pub(crate) corner: Vec3,
    pub(crate) first: u32,
    pub(crate) count: u32,
    padding: [u32; 3],
}

/// How a volume lies in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VoxelGrid {
    /// Edge of a voxel, m.
    pub voxel: f64,
    /// Turns directions of the volume into those of the world: a rotation.
    pub world_from_volume: DMat3,
    /// Samples along each edge of a voxel; the voxel holds their mean.
    pub samples: u32,
}

/// The density of a frame: the middle of voxel `i` is at `voxel * i` in the volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Voxels {
    /// How it lies in the world.
    pub grid: VoxelGrid,
    /// Blocks that hold anything, in order of x, then y, then z.
    pub blocks: Vec<Block>,
}

impl VoxelGrid {
    /// A volume along the axes of the world, Y up, of 27 samples a voxel.
    pub fn new(voxel: f64) -> Self {
        Self { voxel, world_from_volume: DMat3::IDENTITY, samples: 3 }
    }

    /// The same with Z up, as Blender and Unreal have it: north is Y.
    #[must_use]
    pub fn z_up(self) -> Self {
        Self { world_from_volume: DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y), ..self }
    }

    /// Edge of a voxel such that the longest edge of all clouds' bounds has `resolution` of them, m.
    ///
    /// # Errors
    /// [`Error::Argument`] where there is no cloud.
    pub fn voxel_of(frame: &Frame, resolution: u32) -> Result<f64> {
        let (low, high) = frame.bounds().ok_or_else(empty)?;
        Ok((high - low).max_element() / f64::from(resolution))
    }

    /// Middle of a block in the world, m.
    fn middle(&self, index: IVec3) -> DVec3 {
        self.world_from_volume * (self.voxel * (f64::from(BLOCK_EDGE) * (index.as_dvec3() + 0.5) - 0.5))
    }

    /// Least corner of a block in the world, m.
    fn corner(&self, index: IVec3) -> DVec3 {
        self.world_from_volume * (self.voxel * (f64::from(BLOCK_EDGE) * index.as_dvec3() - 0.5))
    }
}

fn empty() -> Error {
    Error::Argument(
        "the scene has no cloud that is not hidden: there is no density to write (layers, which have no end, are left \
         out)"
            .to_owned(),
    )
}

impl Voxels {
    /// Samples the density of all clouds of `frame`, the densest where they overlap; tells the
    /// share done.
    ///
    /// # Errors
    /// [`Error::Argument`] where there is no cloud or there would be too many voxels,
    /// [`Error::Gpu`] when the device fails.
    pub fn sample(gpu: &Gpu, frame: &Frame, grid: VoxelGrid, progress: &mut dyn FnMut(f64)) -> Result<Self> {
        frame.bounds().ok_or_else(empty)?;
        World::check_volumes(frame, "written as voxels")?;
        let world = World::without_layers(frame);
        let reached = reached(&world, &grid)?;
        let sampler = Sampler::new(gpu, &world, grid);
        let list: Vec<_> = reached.into_iter().collect();
        let mut blocks = Vec::new();
        for (done, batch) in list.chunks(BLOCKS_AT_ONCE).enumerate() {
            blocks.extend(sampler.blocks(batch)?);
            progress((done * BLOCKS_AT_ONCE + batch.len()) as f64 / list.len() as f64);
        }
        Ok(Self { grid, blocks })
    }

    /// Numbers of the first and the last voxel that hold anything; `None` where none does.
    pub fn bounds(&self) -> Option<(IVec3, IVec3)> {
        self.filled().map(|(at, _)| (at, at)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Voxels that hold anything: their numbers and extinctions, 1/m.
    pub fn filled(&self) -> impl Iterator<Item = (IVec3, f32)> {
        self.blocks.iter().flat_map(Block::filled)
    }
}

/// Which ellipsoids reach into which blocks, in order of x, y, z.
type Reached = BTreeMap<[i32; 3], Vec<u32>>;

fn reached(world: &World, grid: &VoxelGrid) -> Result<Reached> {
    let origin = world.origin;
    let volume_from_world = grid.world_from_volume.transpose();
    let width = f64::from(BLOCK_EDGE) * grid.voxel;
    let radius = (0.5 * 3f64.sqrt() * width) as f32;
    let mut reached = Reached::new();
    // What holds others is not asked.
    let holders = world.holders.iter().map(|e| (e, None));
    let asked = (0u32..).zip(&world.ellipsoids).map(|(i, e)| (e, Some(i)));
    for (e, own) in asked.chain(holders) {
        let center = volume_from_world * (origin + e.center.as_dvec3());
        let axes = grid.world_from_volume.to_cols_array_2d().map(|axis| DVec3::from(axis).as_vec3());
        let half = DVec3::from(axes.map(|axis| f64::from(e.support(axis))));
        // Blocks begin half a voxel before their first voxel's middle.
        let number = |p: DVec3| ((p + 0.5 * grid.voxel) / width).floor();
        let (first, last) = (number(center - half), number(center + half));
        let count = (last - first + 1.0).element_product();
        if count * BLOCK_VOXELS as f64 > 8.0 * MOST_VOXELS as f64 || last.abs().max_element() > 1e8 {
            return Err(too_many(grid.voxel));
        }
        let (first, last) = (first.as_ivec3(), last.as_ivec3());
        for x in first.x..=last.x {
            for y in first.y..=last.y {
                for z in first.z..=last.z {
                    let middle = (grid.middle(IVec3::new(x, y, z)) - origin).as_vec3();
                    if e.reaches(middle, radius) {
                        reached.entry([x, y, z]).or_default().extend(own);
                    }
                }
            }
        }
        if reached.len() * BLOCK_VOXELS > MOST_VOXELS {
            return Err(too_many(grid.voxel));
        }
    }
    Ok(reached)
}

fn too_many(voxel: f64) -> Error {
    Error::Argument(format!(
        "voxels of {voxel} m are more than {} million, which is all that is written: make them larger",
        MOST_VOXELS / 1_000_000
    ))
}

/// What is the same for all blocks.
struct Sampler<'a> {
    gpu: &'a Gpu,
    program: ComputeProgram,
    grid: VoxelGrid,
    origin: DVec3,
    medium: wgpu::BindGroup,
    extinctions: wgpu::Buffer,
}

impl<'a> Sampler<'a> {
    fn new(gpu: &'a Gpu, world: &World, grid: VoxelGrid) -> Self {
        let device = &gpu.device;
        let program = ComputeProgram::with_roles(device, "voxels", &[world.role()], &[]);
        let values = vec![[0f32; BLOCK_VOXELS]; BLOCKS_AT_ONCE];
        Self {
            medium: world.bind(gpu, &program.layout(1)),
            program,
            grid,
            origin: world.origin,
            extinctions: gpu::storage_buffer(device, "extinctions", &values),
            gpu,
        }
    }

    /// Those of a batch of blocks that hold anything.
    fn blocks(&self, batch: &[([i32; 3], Vec<u32>)]) -> Result<Vec<Block>> {
        let device = &self.gpu.device;
        let mut candidates = Vec::<u32>::new();
        let uniforms: Vec<_> = (batch.iter())
            .map(|(index, list)| {
                let first = candidates.len() as u32;
                candidates.extend(list);
                let corner = (self.grid.corner(IVec3::from(*index)) - self.origin).as_vec3();
                BlockUniform { corner, first, count: list.len() as u32, padding: [0; 3] }
            })
            .collect();
        let voxels = gpu::uniform_buffer(device, "voxels", &self.uniform(batch.len()));
        let uniforms = gpu::storage_buffer(device, "blocks", &uniforms);
        let candidates = gpu::storage_buffer(device, "candidates", &candidates);
        let resources = [&voxels, &uniforms, &candidates, &self.extinctions]
            .map(|buffer| Some(buffer.as_entire_binding()));
        let group = self.program.bind(device, &resources);
        let mut encoder = device.create_command_encoder(&Default::default());
        let voxels = (batch.len() * BLOCK_VOXELS) as u32;
        self.program.dispatch_over(&mut encoder, &[&group, &self.medium], [voxels, 1, 1], None);
        self.gpu.queue.submit([encoder.finish()]);
        let values: Vec<[f32; BLOCK_VOXELS]> = gpu::read_buffer(self.gpu, &self.extinctions)?;
        let block = |((index, _), values): (&([i32; 3], _), [f32; BLOCK_VOXELS])| Block {
            index: IVec3::from(*index),
            values: Box::new(values),
        };
        let filled = |block: &Block| block.values.iter().any(|&value| value > 0.0);
        Ok(batch.iter().zip(values).map(block).filter(filled).collect())
    }

    fn uniform(&self, blocks: usize) -> VoxelsUniform {
        let edges = self.grid.world_from_volume * self.grid.voxel;
        VoxelsUniform {
            edge_x: edges.x_axis.as_vec3(),
            samples: self.grid.samples,
            edge_y: edges.y_axis.as_vec3(),
            blocks: blocks as u32,
            edge_z: edges.z_axis.as_vec3(),
            padding: 0.0,
        }
    }
}
