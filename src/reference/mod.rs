//! Truth: an unbiased path tracer over the same frame and the same density that the
//! renderer draws, with the error of each pixel.

mod grid;
mod media;

use glam::{UVec3, Vec3};

use crate::{
    Result,
    gpu::{self, ComputeProgram, Gpu},
    render::{EllipsoidUniform, Frame, NoiseFrame, Sky, SkySettings, upload_noise},
};
use grid::Grid;

/// `Scene` of `shaders/path.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SceneUniform {
    pub(crate) low: Vec3,
    pub(crate) cell: f32,
    pub(crate) size: UVec3,
    pub(crate) samples: u32,
    pub(crate) camera: Vec3,
    pub(crate) seed: u32,
    pub(crate) to_sun: Vec3,
    pub(crate) sun_radius: f32,
    pub(crate) sun_irradiance: Vec3,
    pub(crate) altitude: f32,
}

/// Bytes of the shader's `Path` and `Sum`, and the loop rounds of one dispatch.
pub(crate) const PATH_BYTES: usize = 128;
pub(crate) const SUM_FLOATS: usize = 8;
/// Place of `sample` among the words of `Path`.
pub(crate) const SAMPLE_WORD: usize = 15;
const BUDGET: u32 = 512;
/// Workgroups that one row of a dispatch may have.
const MOST_GROUPS: u32 = 65535;
/// Cells along the longest axis of the grid.
const RESOLUTION: u32 = 48;

/// A path traced picture under way: ask for more samples as often as you like.
pub struct PathTracer {
    gpu: Gpu,
    program: ComputeProgram,
    group: wgpu::BindGroup,
    uniform: SceneUniform,
    uniform_buffer: wgpu::Buffer,
    sums: wgpu::Buffer,
    unfinished: wgpu::Buffer,
    size: [u32; 2],
    lanes: u32,
}

/// What has been found so far, without background: multiplied by opacity.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Mean radiance and opacity of each pixel, rows from the top.
    pub mean: Vec<[f32; 4]>,
    /// Standard error of the mean radiance, by channel.
    pub error: Vec<[f32; 3]>,
    /// Samples of each pixel.
    pub samples: u32,
}

impl PathTracer {
    /// Prepares `frame`. The same `seed` gives the same picture.
    ///
    /// # Errors
    /// Where a cloud's droplets have no phase function.
    pub fn new(gpu: &Gpu, frame: &Frame, seed: u32) -> Result<Self> {
        let world = World::new(frame)?;
        let grid = Grid::new(&world.ellipsoids, RESOLUTION);
        let uniform = SceneUniform {
            low: grid.low,
            cell: grid.cell,
            size: grid.size,
            samples: 0,
            camera: (frame.camera_position - world.origin).as_vec3(),
            seed,
            to_sun: frame.to_sun.as_vec3(),
            sun_radius: (0.5 * frame.scene.sun.angular_diameter_deg.to_radians()) as f32,
            sun_irradiance: Vec3::from(frame.scene.sun.irradiance.map(|x| x as f32)),
            altitude: (world.origin.y - frame.scene.ground.altitude) as f32,
        };
        let device = &gpu.device;
        let sky = prepared_sky(gpu, frame);
        let pixels = frame.size()[0] * frame.size()[1];
        let lanes = lanes(pixels);
        let overrides = [
            ("BUDGET", f64::from(BUDGET)),
            ("LANES", f64::from(lanes)),
            ("ATMOSPHERE", f64::from(u8::from(sky.has_atmosphere()))),
        ];
        let program = ComputeProgram::new(device, "path", &overrides);
        let threads = (pixels * lanes) as usize;
        let uniform_buffer = gpu::uniform_buffer(device, "path scene", &uniform);
        let sums = gpu::storage_buffer(device, "sums", &vec![[0.0f32; SUM_FLOATS]; threads]);
        let unfinished = gpu::storage_buffer(device, "unfinished", &[0u32]);
        let camera = gpu::uniform_buffer(device, "camera", &frame.camera);
        let noise =
            gpu::uniform_buffer(device, "noise frame", &NoiseFrame::new(&frame.scene.noise, world.origin));
        let buffers = [
            gpu::storage_buffer(device, "ellipsoids", &world.ellipsoids),
            gpu::storage_buffer(device, "media", &world.media),
            gpu::storage_buffer(device, "cells", &grid.cells),
            gpu::storage_buffer(device, "candidates", &grid.candidates),
            gpu::storage_buffer(device, "phase tables", &world.tables),
            gpu::storage_buffer(device, "paths", &new_paths(threads, lanes)),
        ];
        let noise_volume =
            upload_noise(device, &gpu.queue, frame.scene.noise.seed).create_view(&Default::default());
        let (repeat, clamped) = (gpu::linear_repeat(device), gpu::linear_clamp(device));
        let mut resources: Vec<_> =
            [&uniform_buffer, &camera, &noise, sky.atmosphere()].map(|b| Some(b.as_entire_binding())).into();
        resources.extend(buffers.iter().chain([&sums, &unfinished]).map(|b| Some(b.as_entire_binding())));
        resources.extend([
            Some(wgpu::BindingResource::TextureView(&noise_volume)),
            Some(wgpu::BindingResource::Sampler(&repeat)),
            Some(wgpu::BindingResource::Sampler(&clamped)),
            Some(wgpu::BindingResource::TextureView(sky.transmittance())),
            Some(wgpu::BindingResource::TextureView(sky.sky_view())),
        ]);
        let group = program.bind(device, &resources);
        let gpu = gpu.clone();
        Ok(Self { gpu, program, group, uniform, uniform_buffer, sums, unfinished, size: frame.size(), lanes })
    }

    /// Adds samples until each pixel has `samples`; tells the share of pixels that are
    /// done. Returning false from `progress` stops early, with what there is.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn trace(&mut self, samples: u32, progress: &mut dyn FnMut(f64) -> bool) -> Result<()> {
        loop {
            let share = self.advance(samples)?;
            if !progress(share) || share >= 1.0 {
                return Ok(());
            }
        }
    }

    /// Does one bounded piece of the work until each pixel has `samples`; tells the share of
    /// pixels that are done. Estimates count samples right where it is 1.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn advance(&mut self, samples: u32) -> Result<f64> {
        self.uniform.samples = samples;
        self.gpu.queue.write_buffer(&self.uniform_buffer, 0, bytemuck::bytes_of(&self.uniform));
        let threads = self.size[0] * self.size[1] * self.lanes;
        let groups = threads.div_ceil(64);
        let rows = groups.div_ceil(MOST_GROUPS);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.unfinished, 0, None);
        self.program.dispatch(&mut encoder, &self.group, [groups.div_ceil(rows), rows, 1], None);
        self.gpu.queue.submit([encoder.finish()]);
        let left: Vec<u32> = gpu::read_buffer(&self.gpu, &self.unfinished)?;
        Ok(1.0 - f64::from(left[0]) / f64::from(threads))
    }

    /// What has been found so far.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn estimate(&self) -> Result<Estimate> {
        let sums: Vec<[f32; SUM_FLOATS]> = gpu::read_buffer(&self.gpu, &self.sums)?;
        let (samples, lanes) = (self.uniform.samples, self.lanes);
        let counts: Vec<f64> =
            (0..lanes).map(|lane| f64::from((samples.saturating_sub(lane)).div_ceil(lanes))).collect();
        let (mean, error) = sums.chunks_exact(lanes as usize).map(|sums| merged(sums, &counts)).unzip();
        Ok(Estimate { mean, error, samples })
    }
}

/// Threads of each pixel: more for small pictures, so that they fill a graphics card. A power of two.
fn lanes(pixels: u32) -> u32 {
    const THREADS: u32 = 1 << 18;
    1 << (THREADS / pixels.max(1)).clamp(1, 8).ilog2()
}

/// Paths that have not begun: thread i of a pixel with its sample i.
fn new_paths(threads: usize, lanes: u32) -> Vec<[u32; PATH_BYTES / 4]> {
    let path = |thread: usize| {
        let mut path = [0; PATH_BYTES / 4];
        path[SAMPLE_WORD] = thread as u32 % lanes;
        path
    };
    (0..threads).map(path).collect()
}

/// Mean of colours and opacity, and standard error of the colours, of a pixel whose threads
/// took `counts` samples each (Chan et al. 1979).
fn merged(sums: &[[f32; SUM_FLOATS]], counts: &[f64]) -> ([f32; 4], [f32; 3]) {
    let n: f64 = counts.iter().sum::<f64>().max(1.0);
    let mean = [0, 1, 2, 3]
        .map(|c| sums.iter().zip(counts).map(|(sum, count)| f64::from(sum[c]) * count).sum::<f64>() / n);
    let error = [0, 1, 2].map(|c| {
        let squares: f64 = sums
            .iter()
            .zip(counts)
            .map(|(sum, count)| f64::from(sum[4 + c]) + count * (f64::from(sum[c]) - mean[c]).powi(2))
            .sum();
        (squares.max(0.0) / (n * (n - 1.0).max(1.0))).sqrt() as f32
    });
    (mean.map(|x| x as f32), error)
}

/// The tables of the frame's sky.
fn prepared_sky(gpu: &Gpu, frame: &Frame) -> Sky {
    let mut sky = Sky::new(&gpu.device);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let settings = SkySettings::new(&frame.scene, frame.to_sun);
    sky.prepare(&gpu.device, &gpu.queue, &mut encoder, &settings, &frame.camera, None);
    gpu.queue.submit([encoder.finish()]);
    sky
}

/// All clouds of a frame in one frame of coordinates.
struct World {
    origin: glam::DVec3,
    ellipsoids: Vec<EllipsoidUniform>,
    /// For each ellipsoid, the place of its droplets in `tables`.
    media: Vec<u32>,
    tables: Vec<f32>,
}

impl World {
    fn new(frame: &Frame) -> Result<Self> {
        let (low, high) = frame.scene.bounds().unwrap_or_default();
        let origin = 0.5 * (low + high);
        let mut world = Self { origin, ellipsoids: Vec::new(), media: Vec::new(), tables: Vec::new() };
        for (medium, cloud) in frame.scene.clouds.iter().enumerate() {
            world.tables.extend(media::tables(&cloud.droplets)?);
            for e in &cloud.ellipsoids {
                world.ellipsoids.push(EllipsoidUniform::new(cloud, e, origin));
                world.media.push(medium as u32);
            }
        }
        Ok(world)
    }
}
