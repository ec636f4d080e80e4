//! Tables of slabs as textures.

use half::f16;

use wgpu::TextureView;

use crate::{
    Result, gpu,
    optics::slab::{SETS, slab_functions, slab_moments, slab_radiance},
    tables::Grid,
};

/// The source moments: x the sun, y the depth, z the thickness within a half of the numbers
/// within a set.
pub(super) fn moments(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<TextureView> {
    let grid = slab_moments()?;
    let length = |axis: usize| grid.axes[axis].values.len() as u32;
    let size = [length(4), length(3), length(2) * length(1) * length(0)];
    Ok(upload(device, queue, "slab moments", size, &texels(grid)))
}

/// The direct table, for `slab_direct` of `shaders/lib/slab_direct.wgsl`.
#[derive(Debug, Clone)]
pub struct DirectTextures {
    /// 3-D: view within set, depth, sun within thickness.
    pub modes: TextureView,
    /// 2-D: sine of half the scattering angle, set.
    pub phase: TextureView,
}

/// Bouthors' functions, for `shaders/lib/slab_functions.wgsl`; all 2-D.
#[derive(Debug, Clone)]
pub struct FunctionTextures {
    /// Scattering angle, thickness within set.
    pub angle: TextureView,
    /// View, thickness within set.
    pub view: TextureView,
    /// Sun, thickness within set.
    pub sun: TextureView,
    /// View within half of the numbers, set.
    pub collector: TextureView,
    /// View, sun within set.
    pub offset: TextureView,
}

impl DirectTextures {
    /// From the embedded table.
    ///
    /// # Errors
    /// [`crate::Error::Table`] where that is damaged.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let direct = slab_radiance()?;
        let length = |axis: usize| direct.modes.axes[axis].values.len() as u32;
        let size = [length(4) * length(3), length(2), length(1) * length(0)];
        Ok(Self {
            modes: upload(device, queue, "slab radiance", size, &texels(&direct.modes)),
            phase: table(device, queue, &direct.phase),
        })
    }

    /// In the order of `shaders/light/slab_lookup_direct.wgsl`.
    pub(super) fn lookup(self) -> Vec<TextureView> {
        vec![self.modes, self.phase]
    }
}

impl FunctionTextures {
    /// From the embedded tables.
    ///
    /// # Errors
    /// [`crate::Error::Table`] where they are damaged.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let (functions, collector) = slab_functions()?;
        let shared = texels(&collector.shared);
        let views = collector.shared.axes[1].values.len();
        // Both halves of the numbers side by side.
        let halves: Vec<[f16; 4]> = shared
            .chunks_exact(2 * views)
            .flat_map(|set| (0..2).flat_map(move |half| set.iter().skip(half).step_by(2).copied()))
            .collect();
        let size = [2 * views as u32, SETS as u32, 0];
        Ok(Self {
            angle: table(device, queue, &functions.angle),
            view: table(device, queue, &functions.view),
            sun: table(device, queue, &functions.sun),
            collector: upload(device, queue, "slab collector", size, &halves),
            offset: table(device, queue, &collector.offset),
        })
    }

    /// In the order of `shaders/light/slab_lookup_functions.wgsl`.
    pub(super) fn lookup(self) -> Vec<TextureView> {
        vec![self.angle, self.view, self.sun]
    }

    /// Where light entered, in the order of `shaders/light/slab_bouthors.wgsl`.
    pub(super) fn collectors(&self) -> Vec<TextureView> {
        vec![self.collector.clone(), self.offset.clone()]
    }
}

/// A table whose last axis is the width of a texture and whose others are its height.
fn table(device: &wgpu::Device, queue: &wgpu::Queue, grid: &Grid) -> TextureView {
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
) -> TextureView {
    gpu::half_texture(device, queue, label, size, texels).create_view(&Default::default())
}
