//! Copies of textures and buffers back to the CPU.

use super::Gpu;
use crate::{Error, Result};

/// Bytes of mip level `mip` of a texture, rows and slices tightly packed.
///
/// # Errors
/// [`Error::Gpu`] when the device fails.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture, mip: u32) -> Result<Vec<u8>> {
    let size = texture.size();
    let (width, height) = ((size.width >> mip).max(1), (size.height >> mip).max(1));
    let depth = match texture.dimension() {
        wgpu::TextureDimension::D3 => (size.depth_or_array_layers >> mip).max(1),
        _ => size.depth_or_array_layers,
    };
    let texel = texture.format().block_copy_size(None).unwrap_or(1);
    let row = width * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(gpu, u64::from(padded) * u64::from(height) * u64::from(depth));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: mip,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: Some(height),
            },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: depth },
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = map(gpu, &staging)?;
    Ok(bytes.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
}

/// Contents of a buffer that has `COPY_SRC`.
///
/// # Errors
/// [`Error::Gpu`] when the device fails.
pub fn read_buffer<T: bytemuck::Pod>(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
    let staging = staging(gpu, buffer.size());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    Ok(bytemuck::pod_collect_to_vec(&map(gpu, &staging)?))
}

fn staging(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn map(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<Vec<u8>> {
    let slice = staging.slice(..);
    let (sender, receiver) = std::sync::mpsc::channel();
    slice.map_async(wgpu::MapMode::Read, move |result| {
        // The receiver only goes away after it has heard.
        let _ = sender.send(result);
    });
    gpu.finish("reading back")?;
    let failed = |reason: String| Error::Gpu { doing: "reading back".to_owned(), reason };
    receiver.recv().map_err(|error| failed(error.to_string()))?.map_err(|error| failed(error.to_string()))?;
    let view = slice.get_mapped_range().map_err(|error| failed(error.to_string()))?;
    Ok(view.to_vec())
}
