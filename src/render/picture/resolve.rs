//! From several rays a pixel to one, and from layers to something to look at.

use std::collections::HashMap;

use crate::gpu;

/// `Resolve` of `shaders/resolve.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ResolveUniform {
    pub(crate) rays: u32,
    pub(crate) shown: u32,
    pub(crate) range: f32,
    pub(crate) padding: u32,
    pub(crate) stops: [[f32; 4]; STOPS],
}

const STOPS: usize = 10;

/// What a texture holds, and so how it is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown {
    /// Light with its opacity, linear: goes on to [`Renderer::compose`](super::Renderer::compose).
    Beauty,
    /// One layer of light over black, linear: goes on to `compose`.
    Light,
    /// How much of what is behind gets through: white where all does. For the screen.
    Transmittance,
    /// Directions: x, y, z as red, green, blue, the middle being 0. For the screen.
    Normal,
    /// The first channel as a heat map up to this value, logarithmic. For the screen.
    Heat(f32),
}

/// Colours for numbers.
pub struct HeatMap;

impl HeatMap {
    /// Colours of equal distance, as the screen shows them (sRGB, 0 to 1): matplotlib's
    /// inferno by N. Smith and S. van der Walt (CC0), perceptually uniform.
    pub const STOPS: [[f32; 3]; STOPS] = [
        [0.000, 0.000, 0.016],
        [0.106, 0.047, 0.255],
        [0.290, 0.047, 0.420],
        [0.471, 0.110, 0.427],
        [0.647, 0.173, 0.376],
        [0.812, 0.267, 0.275],
        [0.929, 0.412, 0.145],
        [0.984, 0.608, 0.024],
        [0.969, 0.820, 0.239],
        [0.988, 1.000, 0.643],
    ];

    /// The colour of a place on the scale, 0 to 1.
    pub fn color(x: f32) -> [f32; 3] {
        let x = (STOPS - 1) as f32 * x.clamp(0.0, 1.0);
        let i = (x as usize).min(STOPS - 2);
        let (low, high) = (Self::STOPS[i], Self::STOPS[i + 1]);
        std::array::from_fn(|c| low[c] + (high[c] - low[c]) * (x - i as f32))
    }

    /// Where `value` is on the scale that ends at `range`.
    pub fn place(value: f32, range: f32) -> f32 {
        ((1.0 + value.max(0.0)).log2() / (1.0 + range).log2()).clamp(0.0, 1.0)
    }
}

/// The pass that shows what was drawn.
#[derive(Default)]
pub struct Resolve {
    pipelines: HashMap<wgpu::TextureFormat, wgpu::RenderPipeline>,
}

impl Resolve {
    /// Records the pass from `picture`, which has `rays` times the width and height of
    /// `target`, into `target` of `format`: `Rgba16Float` where light stays linear.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        (picture, rays, shown): (&wgpu::TextureView, u32, Shown),
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
    ) {
        let pipeline = self
            .pipelines
            .entry(format)
            .or_insert_with(|| gpu::screen_pipeline(device, ("resolve", &[]), &[], format));
        let uniform = gpu::uniform_buffer(device, "resolve", &uniform(rays, shown));
        let resources =
            [Some(uniform.as_entire_binding()), Some(wgpu::BindingResource::TextureView(picture))];
        let group = gpu::bind_group(device, "resolve", &pipeline.get_bind_group_layout(0), &resources);
        gpu::draw_screen(encoder, "resolve", pipeline, &group, target);
    }
}

pub(crate) fn uniform(rays: u32, shown: Shown) -> ResolveUniform {
    let (number, range) = match shown {
        Shown::Beauty => (0, 1.0),
        Shown::Light => (1, 1.0),
        Shown::Transmittance => (2, 1.0),
        Shown::Normal => (3, 1.0),
        Shown::Heat(range) => (4, range),
    };
    let stops = HeatMap::STOPS.map(|[r, g, b]| [r, g, b, 1.0]);
    ResolveUniform { rays, shown: number, range, padding: 0, stops }
}
