//! Copies of textures and buffers back to the CPU.

use super::Gpu;
use crate::{Error, Result};

/// Most bytes that are read back at once: a buffer can hold as much everywhere, a large picture is larger.
const BAND: u64 = 1 << 26;

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
    let row = (width * texel) as usize;
    let padded = (width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let mut bytes = Vec::with_capacity(row * height as usize * depth as usize);
    for (origin, extent) in bands([width, height, depth], (BAND / u64::from(padded)) as u32) {
        let lines = read_band(gpu, texture, mip, padded, origin, extent)?;
        lines.chunks(padded as usize).for_each(|line| bytes.extend_from_slice(&line[..row]));
    }
    Ok(bytes)
}

/// The whole where it has no more than `most` rows, else bands of so many, slice by slice.
fn bands(
    [width, height, depth]: [u32; 3],
    most: u32,
) -> impl Iterator<Item = (wgpu::Origin3d, wgpu::Extent3d)> {
    let whole = u64::from(height) * u64::from(depth) <= u64::from(most);
    let (rows, slices) = if whole { (height, depth) } else { (most.clamp(1, height), 1) };
    (0..depth).step_by(slices as usize).flat_map(move |z| {
        (0..height).step_by(rows as usize).map(move |y| {
            let extent =
                wgpu::Extent3d { width, height: rows.min(height - y), depth_or_array_layers: slices };
            (wgpu::Origin3d { x: 0, y, z }, extent)
        })
    })
}

/// Rows of `padded` bytes of a part of a texture.
fn read_band(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    mip_level: u32,
    padded: u32,
    origin: wgpu::Origin3d,
    extent: wgpu::Extent3d,
) -> Result<Vec<u8>> {
    let rows = u64::from(extent.height) * u64::from(extent.depth_or_array_layers);
    let staging = staging(gpu, u64::from(padded) * rows);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let aspect = wgpu::TextureAspect::All;
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { texture, mip_level, origin, aspect },
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: Some(extent.height),
            },
        },
        extent,
    );
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &staging)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_every_row_once_and_are_no_larger_than_asked() {
        for (size, most) in
            [([8, 5, 3], 100), ([8, 5, 3], 15), ([8, 5, 3], 14), ([8, 5, 1], 2), ([8, 5, 2], 0)]
        {
            let mut rows: Vec<_> = bands(size, most)
                .flat_map(|(origin, extent)| {
                    assert!(extent.height * extent.depth_or_array_layers <= most.max(1));
                    let slices = origin.z..origin.z + extent.depth_or_array_layers;
                    slices.flat_map(move |z| (origin.y..origin.y + extent.height).map(move |y| (z, y)))
                })
                .collect();
            let found = rows.len();
            rows.dedup();
            assert!(found == rows.len() && rows.is_sorted() && found as u32 == size[1] * size[2]);
        }
    }
}
