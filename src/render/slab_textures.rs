//! Tables of slabs that the renderer's default doesn't need, as textures.

use half::f16;

use crate::gpu::{self, TextureDesc};
use crate::optics::slab::SETS;
use crate::tables::{Grid, slab_functions, slab_radiance};

/// The direct table, for `slab_direct` of `shaders/lib/slab_direct.wgsl`.
#[derive(Debug, Clone)]
pub struct DirectTextures {
    /// 3-D: view within set, depth, sun within thickness.
    pub modes: wgpu::TextureView,
    /// 2-D: sine of half the scattering angle, set.
    pub phase: wgpu::TextureView,
}

/// Bouthors' functions, for `shaders/lib/slab_functions.wgsl`; all 2-D.
#[derive(Debug, Clone)]
pub struct FunctionTextures {
    /// Scattering angle, thickness within set.
    pub angle: wgpu::TextureView,
    /// View, thickness within set.
    pub view: wgpu::TextureView,
    /// Sun, thickness within set.
    pub sun: wgpu::TextureView,
    /// View within half of the numbers, set.
    pub collector: wgpu::TextureView,
    /// View, sun within set.
    pub offset: wgpu::TextureView,
}

impl DirectTextures {
    /// From the embedded table; `None` where that is damaged, which a test excludes.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        let direct = slab_radiance().ok()?;
        let length = |axis: usize| direct.modes.axes[axis].values.len() as u32;
        let size = [length(4) * length(3), length(2), length(1) * length(0)];
        Some(Self {
            modes: upload(device, queue, "slab radiance", size, &texels(&direct.modes)),
            phase: table(device, queue, &direct.phase),
        })
    }
}

impl FunctionTextures {
    /// From the embedded tables; `None` where they are damaged, which a test excludes.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        let (functions, collector) = slab_functions().ok()?;
        let shared = texels(&collector.shared);
        let views = collector.shared.axes[1].values.len();
        // Both halves of the numbers side by side.
        let halves: Vec<[f16; 4]> = shared
            .chunks_exact(2 * views)
            .flat_map(|set| (0..2).flat_map(move |half| set.iter().skip(half).step_by(2).copied()))
            .collect();
        let size = [2 * views as u32, SETS as u32, 0];
        Some(Self {
            angle: table(device, queue, &functions.angle),
            view: table(device, queue, &functions.view),
            sun: table(device, queue, &functions.sun),
            collector: upload(device, queue, "slab collector", size, &halves),
            offset: table(device, queue, &collector.offset),
        })
    }
}

/// A table whose last axis is the width of a texture and whose others are its height.
fn table(device: &wgpu::Device, queue: &wgpu::Queue, grid: &Grid) -> wgpu::TextureView {
    let lengths: Vec<u32> = grid.axes.iter().map(|axis| axis.values.len() as u32).collect();
    let (width, height) = lengths.split_last().map_or((1, 1), |(last, rest)| (*last, rest.iter().product()));
    upload(device, queue, &grid.name, [width, height, 0], &texels(grid))
}

/// Numbers of a table four by four; what is missing to four at a point is 0.
fn texels(grid: &Grid) -> Vec<[f16; 4]> {
    let point = |numbers: &[f16]| -> Vec<[f16; 4]> {
        let texel = |four: &[f16]| std::array::from_fn(|i| four.get(i).copied().unwrap_or(f16::ZERO));
        numbers.chunks(4).map(texel).collect()
    };
    grid.values.chunks_exact(grid.channels).flat_map(point).collect()
}

fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    size: [u32; 3],
    texels: &[[f16; 4]],
) -> wgpu::TextureView {
    let desc = TextureDesc {
        label,
        size,
        mips: 1,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::empty(),
    };
    let texture = gpu::texture(device, &desc);
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(8 * size[0]),
        rows_per_image: Some(size[1]),
    };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(texels), layout, texture.size());
    texture.create_view(&Default::default())
}
