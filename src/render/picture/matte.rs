//! One cloud of a picture by itself: its opacity and distance before those that stand before it are put over it.

use half::f16;

use crate::{
    Result,
    gpu::{self, Gpu},
    render::{
        Renderer,
        march::{Cover, MATTE},
    },
};

/// Bytes of a pixel.
const BYTES: u32 = 4;

/// One cloud of a picture by itself, in the part of the picture that it may touch; read back when asked for.
pub struct Matte {
    /// Which cloud of the moment it is: [`Scene::at`](crate::scene::Scene::at) has them in this order.
    pub cloud: usize,
    /// Left, top, right and bottom of the part, pixels.
    area: [u32; 4],
    buffer: wgpu::Buffer,
}

/// What a cloud is in a pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MattePixel {
    /// Opacity, 0 to 1.
    pub alpha: f32,
    /// Mean distance of what is seen of it, m, times opacity.
    pub distance: f32,
}

/// The texture that all mattes of a picture are drawn into, one after another, and where this one is kept.
pub(super) struct MatteTarget {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    area: [u32; 4],
    buffer: wgpu::Buffer,
}

impl Matte {
    pub(super) fn new(device: &wgpu::Device, cloud: usize, cover: &Cover) -> Self {
        let areas = cover.tiles.iter().map(|tile| tile.area);
        let join =
            |a: [u32; 4], b: [u32; 4]| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])];
        let area = areas.reduce(join).unwrap_or_default();
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("matte"),
            size: u64::from(row_bytes(area)) * u64::from(area[3] - area[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Self { cloud, area, buffer }
    }

    /// Left, top, right and bottom of the part of the picture, in rays, that it may touch.
    pub fn area(&self) -> [u32; 4] {
        self.area
    }

    /// The rays of that part, row by row.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<MattePixel>> {
        let halves: Vec<f16> = gpu::read_buffer(gpu, &self.buffer)?;
        let [left, _, right, _] = self.area;
        let (row, wide) = ((row_bytes(self.area) / 2) as usize, 2 * (right - left) as usize);
        let pixel = |pair: &[f16]| MattePixel { distance: 1e3 * pair[0].to_f32(), alpha: pair[1].to_f32() };
        Ok(halves.chunks_exact(row).flat_map(|row| row[..wide].chunks_exact(2).map(pixel)).collect())
    }
}

impl MatteTarget {
    pub fn new(texture: &wgpu::Texture, matte: &Matte) -> Self {
        let (area, buffer) = (matte.area, matte.buffer.clone());
        Self { texture: texture.clone(), view: gpu::view(texture), area, buffer }
    }

    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Records that what was drawn is kept: the next one goes into the same texture.
    pub fn keep(&self, encoder: &mut wgpu::CommandEncoder) {
        let [left, top, right, bottom] = self.area;
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: left, y: top, z: 0 },
                ..self.texture.as_image_copy()
            },
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row_bytes(self.area)),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d { width: right - left, height: bottom - top, depth_or_array_layers: 1 },
        );
    }
}

/// Bytes of a row as copies have them.
fn row_bytes([left, _, right, _]: [u32; 4]) -> u32 {
    (BYTES * (right - left)).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

impl Renderer {
    pub(super) fn matte_texture(&self, size: [u32; 2]) -> wgpu::Texture {
        self.picture("matte", size, MATTE)
    }
}
