//! Truth: an unbiased path tracer over the same frame and the same density that the
//! renderer draws, with the error of each pixel.

mod estimate;
mod grid;
mod media;
mod stop;

use std::time::Instant;

use glam::{Vec3, Vec4};

use crate::{
    Error, Result,
    frame::{CameraUniform, Frame, LitBy, SkySettings, medium::World},
    gpu::{self, ComputeProgram, Gpu},
    render::Sky,
};
pub use estimate::Estimate;
use estimate::Moments;
pub use grid::GridUniform;
pub(crate) use grid::MOST_GRIDS;
use grid::{Grid, together};
pub use media::{ANGLES, phase_table};
pub use stop::{Progress, Stop};

/// `Scene` of `shaders/path.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SceneUniform {
    pub(crate) grids: [GridUniform; MOST_GRIDS],
    pub(crate) camera: Vec3,
    pub(crate) samples: u32,
    pub(crate) to_sun: Vec3,
    pub(crate) sun_radius: f32,
    pub(crate) sun_irradiance: Vec3,
    pub(crate) altitude: f32,
    pub(crate) first: u32,
    pub(crate) rounds: u32,
    pub(crate) seed: u32,
    pub(crate) curvature: f32,
    pub(crate) flash: Vec4,
}

/// Bytes of the shader's `StoredPath`, and floats of its `Sum`.
pub(crate) const PATH_BYTES: usize = 144;
pub(crate) const SUM_FLOATS: usize = 8;
/// Time that one dispatch should take, s: short enough for a window to be drawn in between, long
/// enough not to be lost in waiting.
const PIECE: f64 = 0.075;
/// Loop rounds of the first dispatch and the least, which is worth to load and store the paths, and
/// the most. Large pictures without a graphics card take longer than [`PIECE`] for that.
const ROUNDS: [u32; 2] = [32, 1 << 16];
/// Workgroups that one row of a dispatch may have.
const MOST_GROUPS: u32 = 65535;
/// Between the seeds of lights.
const LIGHT_SEED: u32 = 0x9e37_79b9;
/// Cells of the grid, about.
const CELLS: u32 = 40 * 40 * 40;

/// A path traced picture under way: ask for more samples as often as you like.
pub struct PathTracer {
    gpu: Gpu,
    program: ComputeProgram,
    group: wgpu::BindGroup,
    medium: wgpu::BindGroup,
    uniform: SceneUniform,
    uniform_buffer: wgpu::Buffer,
    sums: wgpu::Buffer,
    unfinished: wgpu::Buffer,
    size: [u32; 2],
    lanes: u32,
    /// Rounds of a dispatch in which all threads have work: the first one after more samples were
    /// asked for. Later ones, for few long paths, have more.
    full_rounds: u32,
    /// What 1 stands for in what is summed.
    unit: f32,
    earlier: Option<Estimate>,
    /// Of lights beside the sun, each by itself.
    further: Vec<Self>,
}

/// How paths are traced. All choices have the same mean; they differ in noise and time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathOptions {
    /// The same seed gives the same picture.
    pub seed: u32,
    /// Whether a share of directions is drawn around the sun.
    pub guided: bool,
    /// Whether the sun is aimed at through the forward peak of phase functions.
    pub through_peak: bool,
    /// Paths that carry less than this are ended by chance; 0 leaves that to their length.
    pub faint: f64,
    /// Threads of each pixel; by default more for small pictures.
    pub lanes: Option<u32>,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { seed: 0, guided: true, through_peak: true, faint: 0.05, lanes: None }
    }
}

impl PathOptions {
    /// What the shader does with them, and under which sky.
    fn overrides(&self, atmosphere: bool, ground: bool, lanes: u32) -> Vec<(&'static str, f64)> {
        let mut list = vec![
            ("LANES", f64::from(lanes)),
            ("ATMOSPHERE", f64::from(u8::from(atmosphere))),
            ("GROUND", f64::from(u8::from(ground))),
            ("FAINT", self.faint),
        ];
        if !self.guided {
            list.push(("TO_SUN", 0.0));
        }
        list
    }
}

impl PathTracer {
    /// Prepares `frame`. The same `seed` gives the same picture.
    ///
    /// # Errors
    /// Where a cloud's droplets have no phase function, or the device can't hold so many pixels.
    pub fn new(gpu: &Gpu, frame: &Frame, seed: u32) -> Result<Self> {
        Self::with_options(gpu, frame, &PathOptions { seed, ..PathOptions::default() })
    }

    /// The same with more to choose.
    ///
    /// # Errors
    /// As [`PathTracer::new`].
    pub fn with_options(gpu: &Gpu, frame: &Frame, options: &PathOptions) -> Result<Self> {
        let world = World::new(frame);
        world.check_room()?;
        let further = frame.lit_apart().into_iter().map(|(number, frame)| {
            // Errors of lights add up as those of chance.
            let seed = options.seed.wrapping_add(LIGHT_SEED.wrapping_mul(1 + number as u32));
            Self::with_options(gpu, &frame, &PathOptions { seed, ..*options })
        });
        let further = further.collect::<Result<_>>()?;
        let all = Grid::of(&world, CELLS);
        let (grids, cells) = together(&all);
        let uniform = SceneUniform {
            grids,
            camera: (frame.camera_position - world.origin).as_vec3(),
            samples: 0,
            to_sun: frame.sun.to_sun.as_vec3(),
            sun_radius: frame.sun.radius,
            sun_irradiance: frame.sun.irradiance,
            altitude: (world.origin.y - frame.ground) as f32,
            first: 0,
            rounds: ROUNDS[0],
            seed: options.seed,
            curvature: curvature(frame, &world),
            flash: flash(frame, &world),
        };
        let device = &gpu.device;
        let sky = prepared_sky(gpu, frame);
        let pixels = frame.size()[0] * frame.size()[1];
        let lanes = options.lanes.unwrap_or_else(|| lanes(pixels, gpu)).max(1);
        let ground = frame.sky.atmosphere && frame.bounds().is_some_and(|(low, _)| low.y < frame.ground);
        let mut overrides = options.overrides(sky.has_atmosphere(), ground, lanes);
        overrides.push(("MANY_GRIDS", f64::from(u8::from(all.len() > 1))));
        overrides.push(("FLASH", f64::from(u8::from(uniform.flash.w > 0.0))));
        let program = ComputeProgram::with_roles(device, "path", &[world.role()], &overrides);
        let threads = threads(frame.size(), lanes, &device.limits())?;
        let uniform_buffer = gpu::uniform_buffer(device, "path scene", &uniform);
        let sums = gpu::storage_buffer(device, "sums", &vec![[0.0f32; SUM_FLOATS]; threads]);
        let unfinished = gpu::storage_buffer(device, "unfinished", &[0u32]);
        let camera = gpu::uniform_buffer(device, "camera", &frame.camera);
        let buffers = [
            gpu::storage_buffer(device, "cells", &cells),
            gpu::storage_buffer(device, "candidates", &all[0].candidates),
            gpu::storage_buffer(device, "phase tables", &phase_tables(&world, options.through_peak)?),
            gpu::storage_buffer(device, "paths", &vec![[0u8; PATH_BYTES]; threads]),
        ];
        let clamped = gpu::linear_clamp(device);
        let mut resources: Vec<_> =
            [&uniform_buffer, &camera, sky.atmosphere()].map(|b| Some(b.as_entire_binding())).into();
        resources.extend(buffers.iter().chain([&sums, &unfinished]).map(|b| Some(b.as_entire_binding())));
        resources.extend([
            Some(wgpu::BindingResource::Sampler(&clamped)),
            Some(wgpu::BindingResource::TextureView(sky.transmittance())),
            Some(wgpu::BindingResource::TextureView(sky.sky_view())),
        ]);
        let group = program.bind(device, &resources);
        Ok(Self {
            gpu: gpu.clone(),
            medium: world.bind(gpu, &program.layout(1)),
            program,
            group,
            uniform,
            uniform_buffer,
            sums,
            unfinished,
            size: frame.size(),
            lanes,
            full_rounds: ROUNDS[0],
            unit: frame.unit(),
            earlier: None,
            further,
        })
    }

    /// Goes on from an `earlier` estimate of the same frame with the same seed: its samples are
    /// counted, and the next ones have the numbers after theirs.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] where it has another number of pixels.
    pub fn after(mut self, earlier: Estimate) -> Result<Self> {
        self.uniform.first = earlier.samples;
        self.further.iter_mut().for_each(|tracer| tracer.uniform.first = earlier.samples);
        self.earlier = Some(self.estimate()?.merged(&earlier)?);
        Ok(self)
    }

    /// Samples that give each thread of a pixel, and each channel, as many.
    fn unit(&self) -> u32 {
        3 * self.lanes
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
        let mut sum = self.advance_own(samples)?;
        for tracer in &mut self.further {
            sum += tracer.advance_own(samples)?;
        }
        Ok(sum / (1 + self.further.len()) as f64)
    }

    /// The same of the sun alone.
    fn advance_own(&mut self, samples: u32) -> Result<f64> {
        let samples = samples.saturating_sub(self.uniform.first);
        let full = samples > self.uniform.samples;
        if full {
            (self.uniform.samples, self.uniform.rounds) = (samples, self.full_rounds);
        }
        self.gpu.queue.write_buffer(&self.uniform_buffer, 0, bytemuck::bytes_of(&self.uniform));
        let threads = self.size[0] * self.size[1] * self.lanes;
        let [groups, ..] = self.program.groups_over([threads, 1, 1]);
        let rows = groups.div_ceil(MOST_GROUPS);
        let started = Instant::now();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.unfinished, 0, None);
        self.program.dispatch(
            &mut encoder,
            &[&self.group, &self.medium],
            [groups.div_ceil(rows), rows, 1],
            None,
        );
        self.gpu.queue.submit([encoder.finish()]);
        let left: Vec<u32> = gpu::read_buffer(&self.gpu, &self.unfinished)?;
        let share = 1.0 - f64::from(left[0]) / f64::from(threads);
        self.uniform.rounds = paced(self.uniform.rounds, started.elapsed().as_secs_f64());
        // Where most threads were done early, there is no telling that there may be more rounds.
        if full && (share < 0.5 || self.uniform.rounds < self.full_rounds) {
            self.full_rounds = self.uniform.rounds;
        }
        Ok(share)
    }

    /// What has been found so far, in the unit of the scene's lights.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn estimate(&self) -> Result<Estimate> {
        let sums: Vec<[f32; SUM_FLOATS]> = gpu::read_buffer(&self.gpu, &self.sums)?;
        let samples = self.uniform.samples;
        let pixel = |sums: &[[f32; SUM_FLOATS]]| {
            let part = |(lane, sum): (usize, &[f32; SUM_FLOATS])| {
                let count = samples.saturating_sub(lane as u32).div_ceil(self.lanes);
                moments(sum, f64::from(count))
            };
            Moments::sum(&sums.iter().enumerate().map(part).collect::<Vec<_>>()).mean_and_error()
        };
        let (mut mean, mut error): (Vec<[f32; 4]>, Vec<[f32; 3]>) =
            sums.chunks_exact(self.lanes as usize).map(pixel).unzip();
        mean.iter_mut().for_each(|pixel| pixel[..3].iter_mut().for_each(|light| *light *= self.unit));
        error.as_flattened_mut().iter_mut().for_each(|error| *error *= self.unit);
        let mut estimate = Estimate { mean, error, samples };
        for tracer in &self.further {
            estimate.add_light(&tracer.estimate()?);
        }
        self.earlier.as_ref().map_or_else(|| Ok(estimate.clone()), |earlier| earlier.merged(&estimate))
    }
}

/// The ball that shines in place of the sun; a radius of 0 for none.
fn flash(frame: &Frame, world: &World) -> Vec4 {
    match frame.by {
        LitBy::Flash(center, radius) => (center - world.origin).as_vec3().extend(radius as f32),
        LitBy::Sky | LitBy::Key => Vec4::ZERO,
    }
}

/// Half the curvature of the earth that a layer is seen over, 1/m: none where there are other clouds.
fn curvature(frame: &Frame, world: &World) -> f32 {
    let flat = world.layers.is_empty()
        || !world.is_alone()
        || frame.camera.projection == CameraUniform::ORTHOGRAPHIC;
    if flat { 0.0 } else { 0.5 / frame.sky.uniform.atmosphere.ground_radius }
}

/// Threads of a picture, if the device can hold their paths.
fn threads([width, height]: [u32; 2], lanes: u32, limits: &wgpu::Limits) -> Result<usize> {
    let most = limits.max_storage_buffer_binding_size as usize / PATH_BYTES / lanes as usize;
    let pixels = width as usize * height as usize;
    if pixels > most {
        return Err(Error::Argument(format!(
            "a path traced picture has at most {most} pixels here, and {width}x{height} are {pixels}: make it smaller"
        )));
    }
    Ok(pixels * lanes as usize)
}

/// What a thread has summed over `count` samples.
fn moments(sum: &[f32; SUM_FLOATS], count: f64) -> Moments {
    let at = |i: usize| f64::from(sum[i]);
    Moments { count, mean: [0, 1, 2, 3].map(at), squares: [4, 5, 6].map(at) }
}

/// Loop rounds for the next dispatch, where the last one had `rounds` and took `seconds`: so many
/// that it takes about [`PIECE`].
fn paced(rounds: u32, seconds: f64) -> u32 {
    let factor = (PIECE / seconds.max(1e-6)).clamp(0.25, 4.0);
    ((f64::from(rounds) * factor) as u32).clamp(ROUNDS[0], ROUNDS[1])
}

/// Threads of each pixel: more for small pictures, so that they fill a graphics card. A power of two.
/// Adapters without one are full sooner, and then only have more paths to load and store.
fn lanes(pixels: u32, gpu: &Gpu) -> u32 {
    let threads: u32 = if gpu.adapter.kind == "Cpu" { 1 << 13 } else { 1 << 18 };
    1 << (threads / pixels.max(1)).clamp(1, 8).ilog2()
}

/// The tables of the frame's sky as clouds see it.
fn prepared_sky(gpu: &Gpu, frame: &Frame) -> Sky {
    let mut sky = Sky::new(&gpu.device);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    // Lights of clouds alone have no air above them.
    let settings = SkySettings { atmosphere: frame.sky.atmosphere && frame.by == LitBy::Sky, ..frame.sky };
    let mut eye = frame.camera;
    eye.altitude = frame.sky.uniform.light_altitude;
    sky.prepare(&gpu.device, &gpu.queue, &mut encoder, &settings, &eye, None);
    gpu.queue.submit([encoder.finish()]);
    sky
}

/// Tables by species.
fn phase_tables(world: &World, split: bool) -> Result<Vec<f32>> {
    let tables = world.species.iter().map(|species| phase_table(&species.droplets, split));
    Ok(tables.collect::<Result<Vec<_>>>()?.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dispatches_take_their_time() {
        assert_eq!(paced(512, PIECE), 512);
        assert_eq!(paced(512, 2.0 * PIECE), 256);
        assert_eq!(paced(512, 0.5 * PIECE), 1024);
        assert_eq!(paced(512, 0.01 * PIECE), 2048);
        assert_eq!(paced(64, 100.0), ROUNDS[0]);
    }

    #[test]
    fn pictures_that_the_device_cannot_hold_are_refused() {
        let limits = wgpu::Limits::default();
        assert_eq!(threads([1280, 720], 1, &limits).unwrap(), 921_600);
        let refusal = threads([1920, 1080], 1, &limits).unwrap_err().to_string();
        assert!(refusal.contains("at most 932067 pixels") && refusal.contains("1920x1080"), "{refusal}");
    }
}
