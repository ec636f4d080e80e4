//! The optics of a cloud's droplets as the shaders take them: a few numbers, and a
//! table of the phase function split into its forward peak and the rest.

use half::f16;

use crate::{
    Result,
    optics::{
        peak::Chopped,
        phase::{Phase, angle_at},
    },
    scene::Droplets,
};

/// Texels of the phase table along the scattering angle; `phase_coordinate` of
/// `shaders/lib/phase.wgsl` tells which angle each one holds.
const ANGLES: usize = 1024;

/// Optics of a cloud. Absorption and the forward peak are taken out of the medium
/// together: of the extinction k, the peak takes albedo * f * k, and what is left scatters
/// less than it removes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CloudOptics {
    /// Share of extinction in the forward peak that transport leaves out.
    pub chop: f32,
    /// Asymmetry of the phase function without its peak, green.
    pub asymmetry: f32,
    /// Single-scattering albedo of the medium without the peak.
    pub albedo: f32,
    /// Two rows of RGB and one unused, per steradian: albedo times phase function of the
    /// medium without peak, and the peak itself, normalised.
    pub table: Vec<[f16; 4]>,
}

impl CloudOptics {
    pub fn new(droplets: &Droplets) -> Result<Self> {
        let chopped = Chopped::new(Phase::of(droplets)?);
        let chop = droplets.albedo * chopped.f;
        let wide = |channel, theta| droplets.albedo * chopped.wide(channel, theta) / (1.0 - chop);
        let peak = |channel, theta| chopped.peak(channel, theta) / chopped.f.max(1e-9);
        let row = |value: &dyn Fn(usize, f64) -> f64| -> Vec<[f16; 4]> {
            let texel = |i| {
                [0, 1, 2, 1]
                    .map(|channel| f16::from_f64(value(channel, angle_at((i as f64 + 0.5) / ANGLES as f64))))
            };
            (0..ANGLES).map(texel).collect()
        };
        Ok(Self {
            chop: chop as f32,
            asymmetry: chopped.asymmetry[1] as f32,
            albedo: (droplets.albedo * (1.0 - chopped.f) / (1.0 - chop)) as f32,
            table: [row(&wide), row(&peak)].concat(),
        })
    }

    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::TextureView {
        let texture = crate::gpu::texture(
            device,
            &crate::gpu::TextureDesc {
                label: "phase table",
                size: [ANGLES as u32, 2, 0],
                mips: 1,
                format: wgpu::TextureFormat::Rgba16Float,
                usage: wgpu::TextureUsages::empty(),
            },
        );
        queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(&self.table),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(8 * ANGLES as u32),
                rows_per_image: None,
            },
            texture.size(),
        );
        texture.create_view(&Default::default())
    }
}
