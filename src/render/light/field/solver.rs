//! Solves for the light on one grid after another.
//!
//! With T for one round (all light goes along its directions and scatters) the moments m of the light
//! scattered at least once obey m = T m + b, where b is what the sun's beam or the sky brings. On the
//! coarsest grid rounds are stretched until little is left ([`rounds`]). A finer grid begins with that, and
//! each of its few rounds finds the change r = T m + b - m. What comes after it, T r + T T r + ..., is
//! followed on the coarser grids: there e = T (e + r) is solved for likewise and added (a two-grid scheme for
//! the transport equation; Adams and Larsen 2002 review its kind). Rounds on the finest grid are what costs;
//! far fewer of them are needed than scatterings. What cells smooth on the last two grids tells what they smooth of the
//! solution ([`BEYOND`](super::BEYOND)).

use glam::Vec4;
use wgpu::TextureView;

use super::{
    FieldBox, FieldPass, FieldUniform, Lights, SolvedLight,
    levels::{Level, cells, sizes},
    quadrature::{DIRECTIONS, patches},
    rounds::{one_round, relaxations, repeats},
    view::Kept,
};
use crate::{
    frame::medium::Species,
    gpu::{self, ComputeProgram},
    render::light::inputs::Inputs,
};

/// Droplets that throw more light back than this, as none do, turn over more in a round than rounds
/// allow for: repeated, they let it grow (at g = -0.9 a white furnace was off by 2.8).
const LEAST_ASYMMETRY: f32 = -0.65;

/// Rounds on each grid (on the coarsest, all that it takes, in thick clouds the first time repeated), each followed by what comes after it
/// on the coarser ones: of 64 cells, they end within 0.03 to 0.05 of the solution in congestus, within 0.01 in
/// mediocris.
const CYCLES: usize = 2;
/// Cells along the longest axis of grids on which what comes after is followed twice, for it costs little;
/// on finer ones it is where clouds are thick.
const CHEAP: u32 = 16;

/// How far a correction from coarser grids goes in thick clouds: cells of more than an optical depth let too much light
/// through, so that what they answer is too little. In the dark inside of a congestus light is 1.11 of truth's after eight
/// cycles of whole ones; after two it was 1.21, and 1.14 of those stretched by 1.4.
pub(super) const STRETCH: f64 = 1.5;

/// Of one solution.
pub(super) struct Solver<'a> {
    pub pass: &'a FieldPass,
    pub inputs: &'a Inputs<'a>,
    pub field_box: FieldBox,
    /// A ball that shines in place of the sun: its centre and radius, m; a radius of 0 for none.
    pub flash: Vec4,
    /// Radiance and source.
    pub scratch: [wgpu::Buffer; 2],
    pub lights: Lights,
    pub species: &'a Species,
    /// Extinction of the densest ellipsoid, 1/m.
    pub densest: f32,
    /// The program and the group of the medium.
    pub medium: (&'a ComputeProgram, &'a wgpu::BindGroup),
    pub sun_box: wgpu::Buffer,
    pub lists: wgpu::Buffer,
    pub candidates: wgpu::Buffer,
    pub sun_volume: &'a TextureView,
    pub clamped: wgpu::Sampler,
    pub directions: wgpu::Buffer,
    /// Whether what of the sky comes in is yet to be found.
    pub enters: bool,
    /// What surroundings make of that, and the buffer that it goes to.
    pub around: Option<(wgpu::Buffer, wgpu::Buffer)>,
    /// Radiance that comes in, and none.
    pub entering: wgpu::Buffer,
    pub none: wgpu::Buffer,
}

/// What a level's dispatches bind.
struct Stage {
    level: Level,
    /// Of light that comes in, and of none.
    sweep: [wgpu::BindGroup; 2],
    /// By relaxation.
    scatter: Vec<wgpu::BindGroup>,
    /// From the level before (of one dark cell, where this is the first), whole and stretched, and back to it.
    prolong: [wgpu::BindGroup; 2],
    restrict: Option<wgpu::BindGroup>,
}

type Pass<'a> = wgpu::ComputePass<'a>;

impl Solver<'_> {
    pub fn run(&self, pass: &mut Pass<'_>, most: u32) -> SolvedLight {
        if self.enters {
            self.enter(pass);
        }
        self.go_around(pass);
        let repeats = self.repeats();
        let mut stages: Vec<Stage> = Vec::new();
        for size in sizes(most, if repeats > 1 { 4 } else { 8 }) {
            let level = Level::new(self.inputs.device, self.uniform(size));
            self.fill(pass, &level);
            let stage = self.stage(level, stages.last());
            stages.push(stage);
        }
        let top = stages.len() - 1;
        for number in 0..top {
            self.climb(pass, &stages[..=number], repeats);
        }
        let coarse = top.checked_sub(1).map(|before| self.keep(pass, &stages[before].level, None));
        self.climb(pass, &stages, repeats);
        let level = &stages[top].level;
        SolvedLight::new(self.inputs.device, level, self.lights, self.keep(pass, level, coarse))
    }

    /// Begins on the last of `stages` with what the one before it ended with, and comes near to its solution.
    fn climb(&self, pass: &mut Pass<'_>, stages: &[Stage], repeats: usize) {
        self.prolong(pass, &stages[stages.len() - 1], false);
        for _ in 0..CYCLES {
            self.cycle(pass, stages, true, repeats);
        }
    }

    /// One round on the last of `stages`, and what comes after it on those before.
    fn cycle(&self, pass: &mut Pass<'_>, stages: &[Stage], entering: bool, repeats: usize) {
        let [before @ .., stage] = stages else { return };
        // What is left of a correction the next one follows.
        let rests = if entering { repeats } else { 1 };
        let Some(coarse) = before.last() else { return self.rest(pass, stage, entering, rests) };
        self.round(pass, stage, entering, 0);
        self.restrict(pass, stage, coarse);
        let is_cheap = coarse.level.uniform.size.max_element() <= CHEAP;
        let visits = if before.len() > 1 && (is_cheap || repeats > 1) { 2 } else { 1 };
        for _ in 0..visits {
            self.cycle(pass, before, false, repeats);
        }
        self.prolong(pass, stage, repeats > 1);
    }

    /// All rounds that the coarsest stage takes.
    fn rest(&self, pass: &mut Pass<'_>, stage: &Stage, entering: bool, repeats: usize) {
        for _ in 0..repeats {
            for relaxation in 0..stage.scatter.len() {
                self.round(pass, stage, entering, relaxation);
            }
        }
    }

    /// Light goes along its directions and scatters.
    fn round(&self, pass: &mut Pass<'_>, stage: &Stage, entering: bool, relaxation: usize) {
        let sweep = &stage.sweep[usize::from(!entering)];
        self.sweep_program().record(pass, &[sweep], [DIRECTIONS as u32, self.lights.count(), 1]);
        self.over_cells(pass, &self.pass.scatter, &stage.level, &stage.scatter[relaxation]);
    }

    fn sweep_program(&self) -> &ComputeProgram {
        &self.pass.sweep[usize::from(self.flash.w > 0.0)]
    }

    /// What was found on the stage before comes on top, whole or stretched.
    fn prolong(&self, pass: &mut Pass<'_>, stage: &Stage, stretched: bool) {
        let kind = usize::from(stretched);
        self.over_cells(pass, &self.pass.prolong[kind], &stage.level, &stage.prolong[kind]);
    }

    /// What the last round changed is given to the stage before.
    fn restrict(&self, pass: &mut Pass<'_>, stage: &Stage, coarse: &Stage) {
        if let Some(group) = &stage.restrict {
            self.over_cells(pass, &self.pass.restrict, &coarse.level, group);
        }
    }

    fn over_cells(
        &self,
        pass: &mut Pass<'_>,
        program: &ComputeProgram,
        level: &Level,
        group: &wgpu::BindGroup,
    ) {
        program.record_over(pass, &[group], [cells(&level.uniform), self.lights.count(), 1]);
    }

    fn stage(&self, level: Level, before: Option<&Stage>) -> Stage {
        let device = self.inputs.device;
        let [radiance, source] = &self.scratch;
        let bind = |program: &ComputeProgram, buffers: &[&wgpu::Buffer]| {
            let resources: Vec<_> = buffers.iter().map(|buffer| Some(buffer.as_entire_binding())).collect();
            program.bind(device, &resources)
        };
        let entering = self.around.as_ref().map_or(&self.entering, |(_, entering)| entering);
        let sweep = [entering, &self.none].map(|entering| {
            let buffers = [&level.buffer, &level.cells, &self.directions, entering, source, radiance];
            bind(self.sweep_program(), &buffers)
        });
        let lowest = f64::from(level.uniform.scattering.min_element());
        let relaxations =
            if before.is_some() { vec![one_round(lowest)] } else { relaxations(lowest).to_vec() };
        let scatter = relaxations.into_iter().map(|relaxation: f32| {
            let relaxation = gpu::uniform_buffer(device, "relaxation", &relaxation);
            let Level { buffer, given, moments, change, .. } = &level;
            let buffers = [buffer, given, &self.directions, radiance, moments, source, change, &relaxation];
            bind(&self.pass.scatter, &buffers)
        });
        let scatter = scatter.collect();
        let nothing;
        let coarse = match before {
            Some(stage) => &stage.level,
            None => {
                nothing = Level::new(device, self.uniform(1));
                &nothing
            }
        };
        let prolong = {
            let Level { buffer, given, moments, .. } = &level;
            let coarse = [&coarse.buffer, &coarse.moments];
            let buffers = [buffer, given, &self.directions, moments, source, coarse[0], coarse[1]];
            self.pass.prolong.each_ref().map(|program| bind(program, &buffers))
        };
        let restrict = before.map(|Stage { level: coarse, .. }| {
            let Level { buffer, given, moments, .. } = coarse;
            let fine = [&level.buffer, &level.change, &level.cells];
            let buffers = [buffer, given, &self.directions, moments, source, fine[0], fine[1], fine[2]];
            bind(&self.pass.restrict, &buffers)
        });
        Stage { level, sweep, scatter, prolong, restrict }
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
    fn enter(&self, pass: &mut Pass<'_>) {
        let sky = self.inputs.sky;
        let program = &self.pass.entering[usize::from(sky.has_atmosphere())];
        let patches = gpu::storage_buffer(self.inputs.device, "patches of the sky", &patches());
        let mut resources = sky.sources().map(Some).to_vec();
        resources.extend([&patches, &self.entering].map(|buffer| Some(buffer.as_entire_binding())));
        let group = program.bind(self.inputs.device, &resources);
        program.record(pass, &[&group], [DIRECTIONS as u32, 1, 1]);
    }

    /// Finds what of it comes to a cloud among others.
    fn go_around(&self, pass: &mut Pass<'_>) {
        let (Some(program), Some((around, result))) = (&self.pass.around, &self.around) else { return };
        let buffers = [around, &self.entering, result].map(|buffer| Some(buffer.as_entire_binding()));
        let group = program.bind(self.inputs.device, &buffers);
        program.record_over(pass, &[&group], [DIRECTIONS as u32, self.lights.count(), 1]);
    }

    fn uniform(&self, most: u32) -> FieldUniform {
        let size = self.field_box.size(most);
        let species = self.species;
        let beam = -self.inputs.to_sun.as_vec3();
        let is_sun = f32::from(u8::from(self.lights == Lights::Sun && self.flash.w == 0.0));
        FieldUniform {
            low: self.field_box.low,
            directions: DIRECTIONS as u32,
            cell: self.field_box.extent / size.as_vec3(),
            lights: self.lights.count(),
            size,
            truncated: species.albedo * species.ahead,
            scattering: Vec4::from(species.beyond_ahead()) * species.albedo,
            beam: beam.extend(is_sun),
            flash: self.flash,
            repeats: u32::from(self.field_box.repeats),
            padding: [0; 3],
        }
    }

    /// Fills the cells of a level.
    fn fill(&self, pass: &mut Pass<'_>, level: &Level) {
        let (program, medium) = self.medium;
        let group = program.bind(
            self.inputs.device,
            &[
                Some(level.buffer.as_entire_binding()),
                Some(self.sun_box.as_entire_binding()),
                Some(wgpu::BindingResource::Sampler(&self.clamped)),
                Some(wgpu::BindingResource::TextureView(self.sun_volume)),
                Some(level.cells.as_entire_binding()),
                Some(self.lists.as_entire_binding()),
                Some(self.candidates.as_entire_binding()),
                Some(level.given.as_entire_binding()),
            ],
        );
        program.record_over(pass, &[&group, medium], [cells(&level.uniform), 1, 1]);
    }

    /// Keeps the solution; `coarse` is what was kept on the grid of twice the cells' width.
    fn keep(&self, pass: &mut Pass<'_>, level: &Level, coarse: Option<Kept>) -> Kept {
        let device = self.inputs.device;
        let kept = Kept::new(device, level, self.lights);
        let degrees = gpu::uniform_buffer(device, "degrees", &self.species.beyond_ahead());
        let program = &self.pass.keep[usize::from(coarse.is_some())];
        let coarse =
            coarse.unwrap_or_else(|| Kept::new(device, &Level::new(device, self.uniform(1)), self.lights));
        let buffers = [&kept.field, &level.moments, &degrees, &kept.moments, &coarse.field, &coarse.moments];
        let group = program.bind(device, &buffers.map(|buffer| Some(buffer.as_entire_binding())));
        self.over_cells(pass, program, level, &group);
        kept
    }
}
