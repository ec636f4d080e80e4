//! Textures, samplers and buffers in the few shapes that the passes use.

use half::f16;

use super::made::Made;

/// What a texture is made for.
pub struct TextureDesc<'a> {
    /// Shown in graphics debuggers.
    pub label: &'a str,
    /// Width, height, depth; a depth of 0 means a 2-D texture.
    pub size: [u32; 3],
    /// Number of mip levels.
    pub mips: u32,
    /// Texel format.
    pub format: wgpu::TextureFormat,
    /// Uses beyond sampling, writing and copying out.
    pub usage: wgpu::TextureUsages,
}

/// Makes the texture; it can always be sampled, written from the CPU and copied out.
pub fn texture(device: &wgpu::Device, desc: &TextureDesc<'_>) -> wgpu::Texture {
    let dimension = if desc.size[2] == 0 { wgpu::TextureDimension::D2 } else { wgpu::TextureDimension::D3 };
    Made::one(|made| &mut made.textures);
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(desc.label),
        size: wgpu::Extent3d {
            width: desc.size[0],
            height: desc.size[1],
            depth_or_array_layers: desc.size[2].max(1),
        },
        mip_level_count: desc.mips,
        sample_count: 1,
        dimension,
        format: desc.format,
        usage: desc.usage
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// A view of all of a texture.
pub(crate) fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

/// A view of one mip level.
pub(crate) fn mip(texture: &wgpu::Texture, level: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        base_mip_level: level,
        mip_level_count: Some(1),
        ..Default::default()
    })
}

/// An `Rgba16Float` texture with these texels, x fastest, then y, then z; `size` as in
/// [`TextureDesc`]. There must be as many texels as the size takes.
pub fn half_texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    size: [u32; 3],
    texels: &[[f16; 4]],
) -> wgpu::Texture {
    let (format, usage) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureUsages::empty());
    let texture = texture(device, &TextureDesc { label, size, mips: 1, format, usage });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(size[0] * size_of::<[f16; 4]>() as u32),
        rows_per_image: Some(size[1]),
    };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(texels), layout, texture.size());
    texture
}

/// Trilinear sampler that repeats, for the noise volume.
pub fn linear_repeat(device: &wgpu::Device) -> wgpu::Sampler {
    sampler(device, wgpu::AddressMode::Repeat)
}

/// Trilinear sampler that clamps to the edge, for tables and maps.
pub fn linear_clamp(device: &wgpu::Device) -> wgpu::Sampler {
    sampler(device, wgpu::AddressMode::ClampToEdge)
}

/// The same within one mip level, for textures that have no others.
pub(crate) fn linear_clamp_flat(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        mipmap_filter: wgpu::MipmapFilterMode::Nearest,
        ..linear(wgpu::AddressMode::ClampToEdge)
    })
}

/// Linear sampler of a volume whose layers repeat themselves, but do not follow upon one another.
pub(crate) fn linear_repeat_layers(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_w: wgpu::AddressMode::ClampToEdge,
        ..linear(wgpu::AddressMode::Repeat)
    })
}

fn sampler(device: &wgpu::Device, address: wgpu::AddressMode) -> wgpu::Sampler {
    device.create_sampler(&linear(address))
}

fn linear(address: wgpu::AddressMode) -> wgpu::SamplerDescriptor<'static> {
    wgpu::SamplerDescriptor {
        label: Some("linear"),
        address_mode_u: address,
        address_mode_v: address,
        address_mode_w: address,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    }
}

/// What a buffer must be good for that shaders take as uniform: some devices get it as storage.
pub(crate) const UNIFORM: wgpu::BufferUsages =
    wgpu::BufferUsages::UNIFORM.union(wgpu::BufferUsages::STORAGE).union(wgpu::BufferUsages::COPY_DST);

/// A uniform buffer with these contents, writable later.
pub fn uniform_buffer<T: bytemuck::Pod>(device: &wgpu::Device, label: &str, value: &T) -> wgpu::Buffer {
    filled_buffer(device, label, UNIFORM, bytemuck::bytes_of(value))
}

/// A storage buffer with these contents; an empty slice still makes one (zeroed)
/// element, because buffers of no size are not allowed.
pub fn storage_buffer<T: bytemuck::Pod>(device: &wgpu::Device, label: &str, values: &[T]) -> wgpu::Buffer {
    let one = [T::zeroed()];
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    filled_buffer(device, label, usage, bytemuck::cast_slice(if values.is_empty() { &one } else { values }))
}

/// On a device that is lost the buffer stays empty: what waits for the device tells of the loss.
/// (`create_buffer_init` of wgpu panics.)
pub(super) fn filled_buffer(
    device: &wgpu::Device,
    label: &str,
    usage: wgpu::BufferUsages,
    contents: &[u8],
) -> wgpu::Buffer {
    Made::one(|made| &mut made.buffers);
    let size = (contents.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: true,
    });
    if let Ok(mut range) = buffer.get_mapped_range_mut(..) {
        range.slice(..contents.len()).copy_from_slice(contents);
        drop(range);
        buffer.unmap();
    }
    buffer
}
