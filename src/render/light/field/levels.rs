//! Boxes, grids and cells that light is solved for on.

use glam::{UVec3, Vec3, Vec4};

use crate::{
    frame::medium::{EllipsoidUniform, Medium, MeshShape},
    gpu::{self, Made},
};

/// `Field` of `shaders/lib/field.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct FieldUniform {
    pub(crate) low: Vec3,
    pub(crate) directions: u32,
    pub(crate) cell: Vec3,
    pub(crate) lights: u32,
    pub(crate) size: UVec3,
    pub(crate) truncated: f32,
    pub(crate) scattering: Vec4,
    pub(crate) beam: Vec4,
    pub(crate) flash: Vec4,
    pub(crate) repeats: u32,
    pub(super) padding: [u32; 3],
}

/// Cells across a layer, at least, over those along it.
const ACROSS: f32 = 0.25;
/// Fewest cells along an axis.
const FEWEST: u32 = 6;
/// A box that holds the field of a cloud: its least corner and its extent, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::render::light) struct FieldBox {
    pub low: Vec3,
    pub extent: Vec3,
    /// Whether it repeats itself along x and z.
    pub repeats: bool,
}

impl FieldBox {
    /// The box of a cloud, or of a period of a layer.
    pub fn new(medium: &Medium) -> Self {
        if let Some(layer) = &medium.layer {
            let half = layer.half().as_vec3();
            return Self { low: -half, extent: 2.0 * half, repeats: true };
        }
        let (low, high) = EllipsoidUniform::bounds(&medium.ellipsoids);
        let (low, high) = medium.volume.as_ref().map_or((low, high), |volume| volume.clip(low, high));
        let (low, high) = medium.mesh.as_ref().map_or((low, high), MeshShape::bounds);
        Self { low, extent: (high - low).max(Vec3::splat(1e-3)), repeats: false }
    }

    /// Cells along each axis, `most` along the longest: as near to cubes as they can be, but that layers, however
    /// thin, have a share of them across.
    pub fn size(&self, most: u32) -> UVec3 {
        let mut cells = most as f32 * self.extent / self.extent.max_element();
        if self.repeats {
            cells.y = cells.y.max(ACROSS * most as f32);
        }
        cells.round().as_uvec3().clamp(UVec3::splat(FEWEST.min(most)), UVec3::splat(most))
    }
}

/// A field and what is known in its cells.
pub(super) struct Level {
    pub uniform: FieldUniform,
    pub buffer: wgpu::Buffer,
    /// Extinction, 1/m.
    pub cells: wgpu::Buffer,
    /// Moments by light and cell: of the light that is given, of what is scattered of it, and how much the
    /// last round changed that.
    pub given: wgpu::Buffer,
    pub moments: wgpu::Buffer,
    pub change: wgpu::Buffer,
}

impl Level {
    pub fn new(device: &wgpu::Device, uniform: FieldUniform) -> Self {
        let count = u64::from(cells(&uniform));
        let moments = |label| scratch(device, label, count * u64::from(uniform.lights) * 64);
        Self {
            buffer: gpu::uniform_buffer(device, "field", &uniform),
            cells: scratch(device, "field cells", count * 4),
            given: moments("given light"),
            moments: moments("moments"),
            change: moments("change of moments"),
            uniform,
        }
    }
}

/// Cells along the longest axis of each field, coarse ones first: halves down to `least`.
pub(super) fn sizes(most: u32, least: u32) -> Vec<u32> {
    let mut sizes = vec![most.max(2)];
    while sizes[0] >= 2 * least {
        sizes.insert(0, sizes[0] / 2);
    }
    sizes
}

pub(super) fn cells(uniform: &FieldUniform) -> u32 {
    uniform.size.element_product()
}

/// A buffer that shaders alone write.
pub(super) fn scratch(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    Made::one(|made| &mut made.buffers);
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}
