//! Exact counts of work, from the variant of the cloud shader that counts.

use crate::{Result, gpu};

/// Work of the clouds of one frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// Pixels launched: one ray each.
    pub rays: u64,
    /// Rays that met droplets.
    pub rays_hit: u64,
    /// Steps along rays, those through homogeneous cores included.
    pub steps: u64,
    /// Evaluations of the density along rays.
    pub density_evaluations: u64,
    /// Reads of the noise volume.
    pub noise_reads: u64,
    /// Reads of what the model of light binds: volumes, maps and tables; not of phase functions.
    pub map_reads: u64,
    /// Ellipsoids that a ray or a point was compared with.
    pub ellipsoids: u64,
    /// Reads of a baked volume of depths, and of its index.
    pub volume_reads: u64,
}

impl Counts {
    /// Names and numbers, in order.
    pub fn named(&self) -> [(&'static str, u64); 8] {
        [
            ("rays", self.rays),
            ("rays that hit", self.rays_hit),
            ("steps", self.steps),
            ("density evaluations", self.density_evaluations),
            ("noise reads", self.noise_reads),
            ("map reads", self.map_reads),
            ("ellipsoids", self.ellipsoids),
            ("volume reads", self.volume_reads),
        ]
    }
}

const COUNTERS: usize = 8;

/// The buffer that the shader counts in.
pub(in crate::render) struct Counters(wgpu::Buffer);

impl Counters {
    pub fn new(device: &wgpu::Device) -> Self {
        Self(gpu::storage_buffer(device, "counters", &[[0u32; 2]; COUNTERS]))
    }

    pub fn buffer(&self) -> &wgpu::Buffer {
        &self.0
    }

    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.0, 0, None);
    }

    pub fn read(&self, gpu: &gpu::Gpu) -> Result<Counts> {
        let pairs: Vec<[u32; 2]> = gpu::read_buffer(gpu, &self.0)?;
        let total = |i: usize| u64::from(pairs[i][1]) << 32 | u64::from(pairs[i][0]);
        Ok(Counts {
            rays: total(0),
            rays_hit: total(1),
            steps: total(2),
            density_evaluations: total(3),
            noise_reads: total(4),
            map_reads: total(5),
            ellipsoids: total(6),
            volume_reads: total(7),
        })
    }
}
