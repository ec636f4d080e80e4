//! Moments of the light that is scattered in a cloud, solved for on a grid: the sun's, per
//! unit of it, and red, green and blue of sky and ground. Made only when sun, sky, shape, noise
//! or droplets changed.
//!
//! How it works. The medium without its forward peak is told by degrees 0 to 3 of its phase
//! function; what is left of the peak then, chi_4, is taken as going straight on (delta-M,
//! Wiscombe 1977). Light goes along 48 directions through the cells (`moments_sweep`), and
//! its moments are the source of the next round of scattering (`moments_scatter`). Rounds on
//! a coarse field are cheap and carry light far; each finer field begins with the moments
//! of the one before, so that few rounds are needed there. What the cloud shader takes is a
//! texture of the moments of degree 0 and 1 times those of the phase function, `moments_store`:
//! with 48 directions the higher ones are told worse than by the small-angle limit. What went
//! straight on or was scattered by small angles is not in them: it follows from the optical
//! depth to the sun alone and comes on top at each point, finer than any grid.
//!
//! Why not by path tracing, as the truth is: its noise would flicker while the sun moves,
//! and a round of scattering costs every cell the same few reads on any device.

use glam::{UVec3, Vec3, Vec4};

use super::{
    ellipsoids::EllipsoidUniform,
    frame::CloudFrame,
    light::{Inputs, LightBox},
    noise::NoiseFrame,
    optics::CloudOptics,
};
use crate::gpu::{self, ComputeProgram, TextureDesc};
use crate::optics::slab::angles::Quadrature;

/// `Field` of `shaders/lib/field.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct FieldUniform {
    pub(super) low: Vec3,
    pub(super) directions: u32,
    pub(super) cell: Vec3,
    pub(super) lights: u32,
    pub(super) size: UVec3,
    pub(super) ahead: f32,
    pub(super) scattering: Vec4,
    pub(super) beam: Vec4,
}

/// Levels of the quadrature, and directions of each.
const LEVELS: usize = 6;
const PLACES: usize = 8;
const DIRECTIONS: usize = LEVELS * PLACES;
/// Fewest cells along an axis.
const FEWEST: u32 = 6;

/// The programs.
pub(super) struct MomentsPass {
    entering: [ComputeProgram; 2],
    medium: ComputeProgram,
    sweep: ComputeProgram,
    start: ComputeProgram,
    scatter: ComputeProgram,
    store: ComputeProgram,
}

/// What is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lights {
    Sun,
    Sky,
}

/// A box that holds the field of a cloud: its least corner and its extent, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FieldBox {
    pub low: Vec3,
    pub extent: Vec3,
}

impl FieldBox {
    pub fn new(ellipsoids: &[EllipsoidUniform]) -> Self {
        let (low, high) = ellipsoids
            .iter()
            .map(|e| (e.center - e.half(), e.center + e.half()))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or((Vec3::ZERO, Vec3::ONE));
        Self { low, extent: (high - low).max(Vec3::splat(1e-3)) }
    }

    /// Cells along each axis, `most` along the longest: as near to cubes as they can be.
    fn size(&self, most: u32) -> UVec3 {
        let cells = most as f32 * self.extent / self.extent.max_element();
        cells.round().as_uvec3().clamp(UVec3::splat(FEWEST.min(most)), UVec3::splat(most))
    }
}

/// Of one solution.
struct Solver<'a> {
    pass: &'a MomentsPass,
    inputs: &'a Inputs<'a>,
    field_box: FieldBox,
    lights: Lights,
    optics: &'a CloudOptics,
    ellipsoids: wgpu::Buffer,
    noise: wgpu::Buffer,
    sun_box: wgpu::Buffer,
    sun_volume: &'a wgpu::TextureView,
    clamped: wgpu::Sampler,
    directions: wgpu::Buffer,
    entering: wgpu::Buffer,
    /// A field of one dark cell, from which the coarsest one begins.
    nothing: Level,
}

/// A field and what is known in its cells.
struct Level {
    uniform: FieldUniform,
    buffer: wgpu::Buffer,
    moments: wgpu::Buffer,
}

impl Level {
    fn dark(device: &wgpu::Device, lights: Lights) -> Self {
        let uniform =
            FieldUniform { size: UVec3::ONE, lights: lights.count(), ..bytemuck::Zeroable::zeroed() };
        Self::new(device, uniform)
    }

    fn new(device: &wgpu::Device, uniform: FieldUniform) -> Self {
        let bytes = u64::from(cells(&uniform)) * u64::from(uniform.lights) * 64;
        Self {
            buffer: gpu::uniform_buffer(device, "field", &uniform),
            moments: scratch(device, "moments", bytes),
            uniform,
        }
    }
}

impl MomentsPass {
    pub fn new(device: &wgpu::Device) -> Self {
        let program = |name, overrides: &[_]| ComputeProgram::new(device, name, overrides);
        let flag = |on: bool| f64::from(u8::from(on));
        Self {
            entering: [false, true].map(|air| program("moments_entering", &[("ATMOSPHERE", flag(air))])),
            medium: program("moments_medium", &[]),
            sweep: program("moments_sweep", &[]),
            start: program("moments_scatter", &[("FIRST", 1.0)]),
            scatter: program("moments_scatter", &[]),
            store: program("moments_store", &[]),
        }
    }

    /// Solves for the moments of `lights` in a cloud, `most` cells along its longest axis.
    pub fn solve(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        cloud: &CloudFrame,
        sun: (&LightBox, &wgpu::TextureView),
        lights: Lights,
        most: u32,
    ) -> wgpu::TextureView {
        let device = inputs.device;
        let ways = directions();
        let solver = Solver {
            pass: self,
            inputs,
            field_box: FieldBox::new(&cloud.ellipsoids),
            lights,
            optics: &cloud.optics,
            ellipsoids: gpu::storage_buffer(device, "ellipsoids", &cloud.ellipsoids),
            noise: gpu::uniform_buffer::<NoiseFrame>(device, "noise frame", &cloud.noise),
            sun_box: gpu::uniform_buffer(device, "sun box", sun.0),
            sun_volume: sun.1,
            clamped: gpu::linear_clamp(device),
            directions: gpu::storage_buffer(device, "directions", &ways),
            entering: gpu::storage_buffer(device, "entering light", &vec![0.0f32; 3 * DIRECTIONS]),
            nothing: Level::dark(device, lights),
        };
        let stamps = inputs.timing.and_then(|timing| timing.compute("moments"));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("moments"),
            timestamp_writes: stamps,
        });
        solver.run(&mut pass, most)
    }
}

/// Rounds of scattering on each field that are stretched, and plain ones after them, which take
/// away what turns over faster than [`LEFT`] allows for.
const ROUNDS: usize = 16;
const PLAIN: usize = 3;
/// Share of a disturbance that a plain round leaves of it, at the least (short characteristics may
/// turn it over) and at the most (light in the middle of a thick cloud fades slowly).
const LEFT: [f64; 2] = [-0.2, 0.97];

/// How far each round goes from the last moments to those that it gives: one over the roots of the
/// polynomial of Chebyshev that is least over [`LEFT`] (Richardson's method), of which all rounds
/// leave a hundredth; plain ones would take a hundred and fifty for that. In the order of
/// Lebedev and Finogenov (1971), backwards, nothing grows in between.
fn relaxations() -> [f32; ROUNDS + PLAIN] {
    let mut order = vec![1];
    while order.len() < ROUNDS {
        let twice = 4 * order.len();
        order = order.iter().flat_map(|&i| [i, twice - i]).collect();
    }
    let [least, most] = LEFT;
    std::array::from_fn(|round| {
        if round >= ROUNDS {
            return 1.0;
        }
        let odd = f64::from(order[ROUNDS - 1 - round] as u32);
        let node = (std::f64::consts::PI * odd / (2 * ROUNDS) as f64).cos();
        (1.0 / (1.0 - 0.5 * (least + most) - 0.5 * (most - least) * node)) as f32
    })
}

impl Lights {
    fn count(self) -> u32 {
        match self {
            Self::Sun => 1,
            Self::Sky => 3,
        }
    }
}

/// Levels of height, from the top, with their weights, which add up to 2: Gauss and Legendre's.
fn levels() -> Vec<(f64, f64)> {
    let rule = Quadrature::new(LEVELS);
    rule.mu.iter().zip(&rule.weight).map(|(x, weight)| (2.0 * x - 1.0, 2.0 * weight)).collect()
}

/// Azimuth of place `j` of level `k`, rad; levels are turned against each other.
fn azimuth(k: usize, j: f64) -> f64 {
    std::f64::consts::TAU * (j + 0.25 + 0.5 * (k % 2) as f64) / PLACES as f64
}

/// Directions of propagation and their weights, which add up to 4 pi: evenly many places around
/// each level. Exact for products of harmonics to degree 3.
fn directions() -> Vec<Vec4> {
    let mut ways = Vec::with_capacity(DIRECTIONS);
    for (k, (height, weight)) in levels().into_iter().enumerate() {
        let around = (1.0 - height * height).sqrt();
        let share = std::f64::consts::TAU * weight / PLACES as f64;
        ways.extend((0..PLACES).map(|j| {
            let angle = azimuth(k, j as f64);
            glam::DVec4::new(around * angle.cos(), height, around * angle.sin(), share).as_vec4()
        }));
    }
    ways
}

/// The part of the sphere that each direction's light comes from: sines of elevation and azimuths,
/// low and high.
fn patches() -> Vec<[f32; 4]> {
    let mut patches = Vec::with_capacity(DIRECTIONS);
    let mut top = 1.0;
    for (k, (_, weight)) in levels().into_iter().enumerate() {
        let bottom = top - weight;
        patches.extend((0..PLACES).map(|j| {
            let [start, end] = [-0.5, 0.5].map(|half| azimuth(k, j as f64 + half) + std::f64::consts::PI);
            // Light comes from where it does not go.
            [-top, -bottom, start, end].map(|x| x as f32)
        }));
        top = bottom;
    }
    patches
}

impl Solver<'_> {
    fn run(&self, compute: &mut wgpu::ComputePass<'_>, most: u32) -> wgpu::TextureView {
        let device = self.inputs.device;
        if self.lights == Lights::Sky {
            self.enter(compute);
        }
        let sizes = sizes(most);
        let finest = self.uniform(most);
        let numbers = u64::from(cells(&finest)) * u64::from(self.lights.count()) * DIRECTIONS as u64;
        let [radiance, source] =
            ["radiance", "source"].map(|label| scratch(device, label, numbers * size_of::<f32>() as u64));
        let relaxations =
            relaxations().map(|relaxation| gpu::uniform_buffer(device, "relaxation", &relaxation));
        let mut before: Option<Level> = None;
        for &size in &sizes {
            let level = Level::new(device, self.uniform(size));
            let medium = self.medium(compute, &level);
            let buffers = [&medium, &radiance, &source];
            self.round(compute, &self.pass.start, &level, before.as_ref(), buffers, &relaxations[0]);
            for relaxation in &relaxations {
                self.sweep(compute, &level, buffers);
                self.round(compute, &self.pass.scatter, &level, None, buffers, relaxation);
            }
            before = Some(level);
        }
        self.store(compute, before.as_ref())
    }

    /// Finds the light of sky and ground that comes in.
    fn enter(&self, compute: &mut wgpu::ComputePass<'_>) {
        let sky = self.inputs.sky;
        let program = &self.pass.entering[usize::from(sky.has_atmosphere())];
        let patches = gpu::storage_buffer(self.inputs.device, "patches of the sky", &patches());
        let mut resources = sky.sources().map(Some).to_vec();
        resources.extend([&patches, &self.entering].map(|buffer| Some(buffer.as_entire_binding())));
        let group = program.bind(self.inputs.device, &resources);
        program.record(compute, &group, [DIRECTIONS as u32, 1, 1]);
    }

    fn uniform(&self, most: u32) -> FieldUniform {
        let size = self.field_box.size(most);
        let optics = self.optics;
        let beam = -self.inputs.to_sun.as_vec3();
        let is_sun = f32::from(u8::from(self.lights == Lights::Sun));
        FieldUniform {
            low: self.field_box.low,
            directions: DIRECTIONS as u32,
            cell: self.field_box.extent / size.as_vec3(),
            lights: self.lights.count(),
            size,
            ahead: optics.albedo * optics.ahead,
            scattering: Vec4::from(
                optics
                    .chi
                    .map(|chi| optics.albedo * (chi - optics.ahead) / (1.0 - optics.albedo * optics.ahead)),
            ),
            beam: beam.extend(is_sun),
        }
    }

    /// What fills the cells of a level.
    fn medium(&self, compute: &mut wgpu::ComputePass<'_>, level: &Level) -> wgpu::Buffer {
        let device = self.inputs.device;
        let count = cells(&level.uniform);
        let filled = scratch(device, "field cells", u64::from(count) * 8);
        let group = self.pass.medium.bind(
            device,
            &[
                Some(level.buffer.as_entire_binding()),
                Some(self.sun_box.as_entire_binding()),
                Some(self.ellipsoids.as_entire_binding()),
                Some(self.noise.as_entire_binding()),
                Some(wgpu::BindingResource::TextureView(self.inputs.noise_volume)),
                Some(wgpu::BindingResource::Sampler(self.inputs.repeat)),
                Some(wgpu::BindingResource::Sampler(&self.clamped)),
                Some(wgpu::BindingResource::TextureView(self.sun_volume)),
                Some(filled.as_entire_binding()),
            ],
        );
        self.pass.medium.record(compute, &group, [count.div_ceil(64), 1, 1]);
        filled
    }

    fn sweep(&self, compute: &mut wgpu::ComputePass<'_>, level: &Level, buffers: [&wgpu::Buffer; 3]) {
        let [medium, radiance, source] = buffers;
        let resources = [&level.buffer, medium, &self.directions, &self.entering, source, radiance];
        let group = self
            .pass
            .sweep
            .bind(self.inputs.device, &resources.map(|buffer| Some(buffer.as_entire_binding())));
        self.pass.sweep.record(compute, &group, [DIRECTIONS as u32, self.lights.count(), 1]);
    }

    /// One round of scattering; the first takes the moments of the level `before`, or none.
    fn round(
        &self,
        compute: &mut wgpu::ComputePass<'_>,
        program: &ComputeProgram,
        level: &Level,
        before: Option<&Level>,
        buffers: [&wgpu::Buffer; 3],
        relaxation: &wgpu::Buffer,
    ) {
        let [medium, radiance, source] = buffers;
        let coarse = before.map_or([&self.nothing.buffer, &self.nothing.moments], |before| {
            [&before.buffer, &before.moments]
        });
        let resources = [
            &level.buffer,
            medium,
            &self.directions,
            radiance,
            &level.moments,
            source,
            coarse[0],
            coarse[1],
            relaxation,
        ];
        let group =
            program.bind(self.inputs.device, &resources.map(|buffer| Some(buffer.as_entire_binding())));
        let count = cells(&level.uniform);
        program.record(compute, &group, [count.div_ceil(64), self.lights.count(), 1]);
    }

    fn store(&self, compute: &mut wgpu::ComputePass<'_>, level: Option<&Level>) -> wgpu::TextureView {
        let device = self.inputs.device;
        let size = level.map_or(UVec3::ONE, |level| level.uniform.size);
        let texture = gpu::texture(
            device,
            &TextureDesc {
                label: "moments",
                size: [size.x, size.y, size.z * self.lights.count()],
                mips: 1,
                format: wgpu::TextureFormat::Rgba16Float,
                usage: wgpu::TextureUsages::STORAGE_BINDING,
            },
        );
        let view = texture.create_view(&Default::default());
        if let Some(level) = level {
            let degrees = gpu::uniform_buffer(device, "degrees", &self.optics.chi);
            let group = self.pass.store.bind(
                device,
                &[
                    Some(level.buffer.as_entire_binding()),
                    Some(level.moments.as_entire_binding()),
                    Some(degrees.as_entire_binding()),
                    Some(wgpu::BindingResource::TextureView(&view)),
                ],
            );
            let count = cells(&level.uniform);
            self.pass.store.record(compute, &group, [count.div_ceil(64), self.lights.count(), 1]);
        }
        view
    }
}

/// Cells along the longest axis of each field, coarse ones first: halves down to eight.
fn sizes(most: u32) -> Vec<u32> {
    let mut sizes = vec![most.max(2)];
    while sizes[0] >= 16 {
        sizes.insert(0, sizes[0] / 2);
    }
    sizes
}

fn cells(uniform: &FieldUniform) -> u32 {
    uniform.size.element_product()
}

/// A buffer that shaders alone write.
fn scratch(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_integrate_products_of_harmonics_exactly() {
        // Of degree 0 to 3: monomials to degree 6 in each coordinate.
        let ways = directions();
        let integral = |f: &dyn Fn(Vec4) -> f64| ways.iter().map(|d| f64::from(d.w) * f(*d)).sum::<f64>();
        let whole = 4.0 * std::f64::consts::PI;
        for (power, share) in [(0, 1.0), (2, 1.0 / 3.0), (4, 1.0 / 5.0), (6, 1.0 / 7.0), (3, 0.0), (5, 0.0)] {
            for axis in 0..3 {
                let found = integral(&|d| f64::from(d[axis]).powi(power)) / whole;
                assert!((found - share).abs() < 1e-6, "axis {axis}, power {power}: {found}");
            }
        }
    }

    #[test]
    fn rounds_leave_little_of_any_disturbance_and_let_none_grow() {
        for i in 0..=100 {
            let share = LEFT[0] + (LEFT[1] - LEFT[0]) * f64::from(i) / 100.0;
            let mut left: f64 = 1.0;
            for relaxation in relaxations() {
                left *= 1.0 - f64::from(relaxation) * (1.0 - share);
                assert!(left.abs() < 1.01, "{share}: {left}");
            }
            assert!(left.abs() < 0.013, "{share}: {left}");
        }
    }

    #[test]
    fn patches_tile_the_sphere_and_lie_behind_their_directions() {
        let (ways, patches) = (directions(), patches());
        let area: f32 = patches.iter().map(|[low, high, start, end]| (high - low) * (end - start)).sum();
        assert!((area - 4.0 * std::f32::consts::PI).abs() < 1e-4);
        for (way, [low, high, start, end]) in ways.iter().zip(&patches) {
            let azimuth = 0.5 * (start + end);
            let around = (1.0 - way.y * way.y).sqrt();
            assert!(*low < -way.y && -way.y < *high);
            assert!((around * azimuth.cos() + way.x).abs() < 1e-5);
            assert!((around * azimuth.sin() + way.z).abs() < 1e-5);
            // Its weight is its solid angle.
            assert!(((high - low) * (end - start) - way.w).abs() < 1e-5);
        }
    }
}
