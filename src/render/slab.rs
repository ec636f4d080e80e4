//! The table of slabs as the shaders take it.

use crate::{
    gpu::{self, TextureDesc},
    tables,
};

/// The source moments as a texture: x the sun, y the depth, z the thickness within a half of
/// the numbers within a set. `None` where the embedded table is damaged, which a test excludes.
pub(super) fn upload(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<wgpu::TextureView> {
    let grid = tables::slab_moments().ok()?;
    let length = |axis: usize| grid.axes[axis].values.len() as u32;
    let size = [length(4), length(3), length(2) * length(1) * length(0)];
    let texture = gpu::texture(
        device,
        &TextureDesc {
            label: "slab moments",
            size,
            mips: 1,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::empty(),
        },
    );
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&grid.values),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * size[0]),
            rows_per_image: Some(size[1]),
        },
        texture.size(),
    );
    Some(texture.create_view(&Default::default()))
}
