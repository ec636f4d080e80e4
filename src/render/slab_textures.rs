//! Tables of slabs as textures.

use half::f16;

use super::Transport;
use crate::gpu;
use crate::optics::slab::SETS;
use crate::tables::{Grid, slab_functions, slab_moments, slab_radiance};

/// Where Kol's and Bouthors' slabs take their light from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum SlabTable {
    /// Bouthors' functions, as Kol has them.
    #[default]
    Functions,
    /// The direct table, which is closer to what it tells of.
    Direct,
}

/// The tables that a transport needs, at most.
#[derive(Debug, Default)]
pub(super) enum SlabTextures {
    #[default]
    None,
    Moments(wgpu::TextureView),
    Functions(FunctionTextures),
    /// The functions too: where light entered is told by them alone.
    Direct(DirectTextures, FunctionTextures),
}

impl SlabTextures {
    /// Those of a transport; none where an embedded table is damaged, which a test excludes.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, transport: Transport, table: SlabTable) -> Self {
        let functions = || FunctionTextures::new(device, queue);
        let made = match (transport, table) {
            (Transport::Slab, _) => moments(device, queue).map(Self::Moments),
            (Transport::SlabKol | Transport::SlabBouthors, SlabTable::Functions) => {
                functions().map(Self::Functions)
            }
            (Transport::SlabKol | Transport::SlabBouthors, SlabTable::Direct) => {
                DirectTextures::new(device, queue)
                    .zip(functions())
                    .map(|(direct, functions)| Self::Direct(direct, functions))
            }
            _ => None,
        };
        made.unwrap_or_default()
    }

    pub fn is_direct(&self) -> bool {
        matches!(self, Self::Direct(..))
    }

    pub fn volume(&self) -> Option<&wgpu::TextureView> {
        match self {
            Self::Moments(moments) => Some(moments),
            Self::Direct(direct, _) => Some(&direct.modes),
            Self::None | Self::Functions(_) => None,
        }
    }

    pub fn angles(&self) -> Option<&wgpu::TextureView> {
        match self {
            Self::Functions(functions) => Some(&functions.angle),
            Self::Direct(direct, _) => Some(&direct.phase),
            Self::None | Self::Moments(_) => None,
        }
    }

    /// View, sun, collector, offset.
    pub fn planes(&self) -> Option<[&wgpu::TextureView; 4]> {
        match self {
            Self::Functions(f) | Self::Direct(_, f) => Some([&f.view, &f.sun, &f.collector, &f.offset]),
            Self::None | Self::Moments(_) => None,
        }
    }
}

/// The source moments: x the sun, y the depth, z the thickness within a half of the numbers
/// within a set.
fn moments(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<wgpu::TextureView> {
    let grid = slab_moments().ok()?;
    let length = |axis: usize| grid.axes[axis].values.len() as u32;
    let size = [length(4), length(3), length(2) * length(1) * length(0)];
    Some(upload(device, queue, "slab moments", size, &texels(grid)))
}

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
    gpu::half_texture(device, queue, label, size, texels).create_view(&Default::default())
}
