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

mod levels;
mod quadrature;
mod rounds;

use std::collections::HashMap;

use glam::{UVec3, Vec4};
use wgpu::TextureView;

use super::{
    bricks::Bricks,
    inputs::Inputs,
    sun::{BoxKey, volume},
};
use crate::{
    frame::{
        Shared,
        medium::{Medium, Species},
    },
    gpu::{self, ComputeProgram},
    render::medium::Media,
};
pub(super) use levels::FieldBox;
pub use levels::FieldUniform;
use levels::{Level, cells, scratch, sizes};
use quadrature::{DIRECTIONS, directions, patches};
use rounds::{relaxations, repeats};

/// What light is solved for in, and on how many cells along the longest axis.
#[derive(Clone, PartialEq)]
pub(super) struct FieldKey {
    pub medium: Shared<Medium>,
    pub cells: u32,
}

/// The moments of a cloud's light, on grids in one box.
pub(super) struct Field {
    pub field_box: FieldBox,
    /// Of the sun, per unit of it.
    pub sun: TextureView,
    /// Of red, green and blue of sky and ground, where they give light.
    pub sky: Option<TextureView>,
}

/// Droplets that throw more light back than this, as none do, turn over more in a round than rounds
/// allow for: repeated, they let it grow (at g = -0.9 a white furnace was off by 2.8).
const LEAST_ASYMMETRY: f32 = -0.65;

/// The programs.
pub(super) struct FieldPass {
    entering: [ComputeProgram; 2],
    /// By medium.
    media: HashMap<&'static str, ComputeProgram>,
    sweep: ComputeProgram,
    start: ComputeProgram,
    scatter: ComputeProgram,
    store: ComputeProgram,
    /// Radiance and source: one solution after another uses them, however many clouds there are.
    scratch: Option<[wgpu::Buffer; 2]>,
}

/// What is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lights {
    Sun,
    Sky,
}

/// Of one solution.
struct Solver<'a> {
    pass: &'a FieldPass,
    inputs: &'a Inputs<'a>,
    field_box: FieldBox,
    /// Radiance and source.
    scratch: [wgpu::Buffer; 2],
    lights: Lights,
    species: &'a Species,
    /// Extinction of the densest ellipsoid, 1/m.
    densest: f32,
    /// The program and the group of the medium.
    medium: (&'a ComputeProgram, &'a wgpu::BindGroup),
    sun_box: wgpu::Buffer,
    lists: wgpu::Buffer,
    candidates: wgpu::Buffer,
    sun_volume: &'a TextureView,
    clamped: wgpu::Sampler,
    directions: wgpu::Buffer,
    entering: wgpu::Buffer,
    /// A field of one dark cell, from which the coarsest one begins.
    nothing: Level,
}

impl FieldPass {
    pub fn new(device: &wgpu::Device) -> Self {
        let program = |name, overrides: &[_]| ComputeProgram::new(device, name, overrides);
        let flag = |on: bool| f64::from(u8::from(on));
        Self {
            entering: [false, true].map(|air| program("moments_entering", &[("ATMOSPHERE", flag(air))])),
            media: HashMap::new(),
            sweep: program("moments_sweep", &[]),
            start: program("moments_scatter", &[("FIRST", 1.0)]),
            scatter: program("moments_scatter", &[]),
            store: program("moments_store", &[]),
            scratch: None,
        }
    }

    /// Two buffers of at least `size` bytes, the same as before where those are large enough.
    fn scratch(&mut self, device: &wgpu::Device, size: u64) -> [wgpu::Buffer; 2] {
        let kept = self.scratch.take().filter(|buffers| buffers[0].size() >= size);
        let make = || ["radiance", "source"].map(|label| scratch(device, label, size));
        self.scratch.insert(kept.unwrap_or_else(make)).clone()
    }

    /// The light in a medium, but for what is known of it: of sun and of sky. `sun` is the box and the
    /// volume of optical depth to the sun. Tells `count` of each solution.
    #[allow(clippy::too_many_arguments, reason = "two lights, each wanted or known")]
    pub fn make(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        media: &Media,
        key: &FieldKey,
        sky: Option<&FieldKey>,
        sun: (&BoxKey, &TextureView),
        (known_sun, known_sky): (Option<TextureView>, Option<TextureView>),
        count: &mut dyn FnMut(),
    ) -> Field {
        let mut solve = |lights, cells| {
            count();
            self.solve(encoder, inputs, media, (&key.medium, cells), sun, lights)
        };
        let sun = known_sun.unwrap_or_else(|| solve(Lights::Sun, key.cells));
        let sky = sky.map(|key| known_sky.unwrap_or_else(|| solve(Lights::Sky, key.cells)));
        Field { field_box: FieldBox::new(&key.medium.ellipsoids), sun, sky }
    }

    /// Solves for the moments of `lights` in a medium, `most` cells along its longest axis.
    fn solve(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        media: &Media,
        (medium, most): (&Shared<Medium>, u32),
        (sun, sun_volume): (&BoxKey, &TextureView),
        lights: Lights,
    ) -> TextureView {
        let device = inputs.device;
        let field_box = FieldBox::new(&medium.ellipsoids);
        let numbers = u64::from(field_box.size(most).element_product() * lights.count()) * DIRECTIONS as u64;
        let scratch = self.scratch(device, numbers * size_of::<f32>() as u64);
        let bricks = Bricks::new(&sun.light_box, &medium.ellipsoids, sun.voxels);
        let role = media.role(medium);
        self.media
            .entry(role.1)
            .or_insert_with(|| ComputeProgram::with_roles(device, "moments_medium", &[role], &[]));
        let solver = Solver {
            pass: self,
            inputs,
            field_box,
            scratch,
            lights,
            species: &medium.species,
            densest: medium.densest(),
            medium: (&self.media[role.1], media.group(medium)),
            sun_box: gpu::uniform_buffer(device, "sun box", &sun.light_box),
            lists: gpu::storage_buffer(device, "bricks", &bricks.lists),
            candidates: gpu::storage_buffer(device, "ellipsoids of bricks", &bricks.candidates),
            sun_volume,
            clamped: gpu::linear_clamp(device),
            directions: gpu::storage_buffer(device, "directions", &directions()),
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

impl Lights {
    fn count(self) -> u32 {
        match self {
            Self::Sun => 1,
            Self::Sky => 3,
        }
    }
}

impl Solver<'_> {
    fn run(&self, compute: &mut wgpu::ComputePass<'_>, most: u32) -> TextureView {
        let device = self.inputs.device;
        if self.lights == Lights::Sky {
            self.enter(compute);
        }
        let repeats = self.repeats();
        let sizes = sizes(most, if repeats > 1 { 4 } else { 8 });
        let [radiance, source] = &self.scratch;
        let lowest = self.uniform(most).scattering.min_element();
        let relaxations = relaxations(f64::from(lowest))
            .map(|relaxation| gpu::uniform_buffer(device, "relaxation", &relaxation));
        let mut before: Option<Level> = None;
        for &size in &sizes {
            let level = Level::new(device, self.uniform(size));
            let medium = self.medium(compute, &level);
            let buffers = [&medium, radiance, source];
            let repeats = if before.is_none() { repeats } else { 1 };
            let start = self.round(&self.pass.start, &level, before.as_ref(), buffers, &relaxations[0]);
            self.scatter(compute, &self.pass.start, &level, &start);
            let sweep = self.sweep(&level, buffers);
            let rounds =
                relaxations.each_ref().map(|r| self.round(&self.pass.scatter, &level, None, buffers, r));
            for round in (0..repeats).flat_map(|_| &rounds) {
                self.pass.sweep.record(compute, &[&sweep], [DIRECTIONS as u32, self.lights.count(), 1]);
                self.scatter(compute, &self.pass.scatter, &level, round);
            }
            before = Some(level);
        }
        self.store(compute, before.as_ref())
    }

    /// How often the rounds are repeated on the coarsest field: by the shortest way through the field's
    /// box, as if all of it were as dense as the densest ellipsoid.
    fn repeats(&self) -> usize {
        let uniform = self.uniform(1);
        let (albedo, flux) = (uniform.scattering.x, uniform.scattering.y);
        let asymmetry = flux / albedo.max(1e-6);
        if asymmetry < LEAST_ASYMMETRY {
            return 1;
        }
        let kept = (1.0 - self.species.truncated) * (1.0 - uniform.truncated) * (1.0 - asymmetry);
        repeats((kept * self.densest * self.field_box.extent.min_element()).into(), albedo.into())
    }

    /// Finds the light of sky and ground that comes in.
    fn enter(&self, compute: &mut wgpu::ComputePass<'_>) {
        let sky = self.inputs.sky;
        let program = &self.pass.entering[usize::from(sky.has_atmosphere())];
        let patches = gpu::storage_buffer(self.inputs.device, "patches of the sky", &patches());
        let mut resources = sky.sources().map(Some).to_vec();
        resources.extend([&patches, &self.entering].map(|buffer| Some(buffer.as_entire_binding())));
        let group = program.bind(self.inputs.device, &resources);
        program.record(compute, &[&group], [DIRECTIONS as u32, 1, 1]);
    }

    fn uniform(&self, most: u32) -> FieldUniform {
        let size = self.field_box.size(most);
        let species = self.species;
        let beam = -self.inputs.to_sun.as_vec3();
        let is_sun = f32::from(u8::from(self.lights == Lights::Sun));
        FieldUniform {
            low: self.field_box.low,
            directions: DIRECTIONS as u32,
            cell: self.field_box.extent / size.as_vec3(),
            lights: self.lights.count(),
            size,
            truncated: species.albedo * species.ahead,
            scattering: Vec4::from(
                species.chi.map(|chi| {
                    species.albedo * (chi - species.ahead) / (1.0 - species.albedo * species.ahead)
                }),
            ),
            beam: beam.extend(is_sun),
        }
    }

    /// What fills the cells of a level.
    fn medium(&self, compute: &mut wgpu::ComputePass<'_>, level: &Level) -> wgpu::Buffer {
        let device = self.inputs.device;
        let count = cells(&level.uniform);
        let filled = scratch(device, "field cells", u64::from(count) * 8);
        let (program, medium) = self.medium;
        let group = program.bind(
            device,
            &[
                Some(level.buffer.as_entire_binding()),
                Some(self.sun_box.as_entire_binding()),
                Some(wgpu::BindingResource::Sampler(&self.clamped)),
                Some(wgpu::BindingResource::TextureView(self.sun_volume)),
                Some(filled.as_entire_binding()),
                Some(self.lists.as_entire_binding()),
                Some(self.candidates.as_entire_binding()),
            ],
        );
        program.record_over(compute, &[&group, medium], [count, 1, 1]);
        filled
    }

    /// What a sweep binds.
    fn sweep(&self, level: &Level, [medium, radiance, source]: [&wgpu::Buffer; 3]) -> wgpu::BindGroup {
        let resources = [&level.buffer, medium, &self.directions, &self.entering, source, radiance];
        let resources = resources.map(|buffer| Some(buffer.as_entire_binding()));
        self.pass.sweep.bind(self.inputs.device, &resources)
    }

    /// What a round of scattering binds; the first takes the moments of the level `before`, or none.
    fn round(
        &self,
        program: &ComputeProgram,
        level: &Level,
        before: Option<&Level>,
        buffers: [&wgpu::Buffer; 3],
        relaxation: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
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
        program.bind(self.inputs.device, &resources.map(|buffer| Some(buffer.as_entire_binding())))
    }

    fn scatter(
        &self,
        compute: &mut wgpu::ComputePass<'_>,
        program: &ComputeProgram,
        level: &Level,
        group: &wgpu::BindGroup,
    ) {
        program.record_over(compute, &[group], [cells(&level.uniform), self.lights.count(), 1]);
    }

    fn store(&self, compute: &mut wgpu::ComputePass<'_>, level: Option<&Level>) -> TextureView {
        let device = self.inputs.device;
        let size = level.map_or(UVec3::ONE, |level| level.uniform.size);
        let texture = volume(device, "moments", [size.x, size.y, size.z * self.lights.count()]);
        let view = gpu::view(&texture);
        if let Some(level) = level {
            let degrees = gpu::uniform_buffer(device, "degrees", &self.species.chi);
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
            self.pass.store.record_over(compute, &[&group], [count, self.lights.count(), 1]);
        }
        view
    }
}
