//! The light that is scattered in a cloud, solved for on a grid: the sun's, per unit of it, and red, green
//! and blue of sky and ground. Solved for only when sun, sky, shape, noise or droplets changed.
//!
//! How it works. The medium without its forward peak is told by degrees 0 to 3 of its phase
//! function; what is left of the peak then, chi_4, is taken as going straight on (delta-M,
//! Wiscombe 1977). Light goes along 48 directions through the cells (`moments_sweep`), and
//! its moments are the source of the next round of scattering (`moments_scatter`). Rounds on coarse
//! grids carry light far and cost little: each finer grid begins with the solution of the one before,
//! and what a round changes there is followed on the coarser ones ([`solver`]). From the moments each cell
//! has the light that it scatters towards the eye (`moments_view`): one cheap pass when the camera
//! moved, one read in the picture. What went straight on or was scattered by small angles follows
//! from the optical depth to the sun alone and comes on top at each point, finer than any grid.
//!
//! Why not by path tracing, as the truth is: its noise would flicker while the sun moves,
//! and a round of scattering costs every cell the same few reads on any device.

mod levels;
mod quadrature;
mod rounds;
mod solver;
mod view;

use std::collections::HashMap;

use glam::Vec4;
use wgpu::TextureView;

use super::{
    around::{Around, Told},
    bricks::Bricks,
    inputs::Inputs,
    sun::BoxKey,
};
use crate::{
    frame::{
        Shared, SkySettings,
        medium::{Medium, MediumKind},
    },
    gpu::{self, ComputeProgram},
};
pub(super) use levels::FieldBox;
pub use levels::FieldUniform;
use levels::scratch;
pub(super) use quadrature::{DIRECTIONS, directions, levels, patches};
use solver::Solver;
pub(super) use view::{Eyes, SolvedLight, eye_of};

/// Share of the difference between a field and that of twice its cells' width that comes on top of the finer one: what
/// errors of second order ask for (Richardson 1911).
const BEYOND: f64 = 1.0 / 3.0;

/// What light is solved for in, and on how many cells along the longest axis.
#[derive(Clone, PartialEq)]
pub(super) struct FieldKey {
    pub medium: Shared<Medium>,
    pub cells: u32,
    /// The ball that shines in it, in place of the sun: its centre and radius, m; a radius of 0 for none.
    pub flash: Vec4,
    /// What stands around it.
    pub around: Around,
}

/// The light of a cloud, on grids in one box.
pub(super) struct Field {
    pub field_box: FieldBox,
    /// Of the sun, per unit of it.
    pub sun: SolvedLight,
    /// Of red, green and blue of sky and ground, where they give light.
    pub sky: Option<SolvedLight>,
}

/// The programs.
pub(super) struct FieldPass {
    entering: [ComputeProgram; 2],
    /// Light among other clouds; compiled when first needed.
    around: Option<ComputeProgram>,
    /// By medium.
    media: HashMap<MediumKind, ComputeProgram>,
    /// Of light from outside, and from a ball within.
    sweep: [ComputeProgram; 2],
    scatter: ComputeProgram,
    /// Of whole corrections and of stretched ones.
    prolong: [ComputeProgram; 2],
    restrict: ComputeProgram,
    /// Of the coarsest field, and of one that stands on a coarser.
    keep: [ComputeProgram; 2],
    /// Of red, green and blue, and of the sun.
    view: [ComputeProgram; 2],
    /// The same of layers.
    tile: [ComputeProgram; 2],
    /// What of sky and ground comes in along each direction: the same for all clouds under this sky.
    sky: Option<(SkySettings, wgpu::Buffer)>,
    /// Radiance and source: one solution after another uses them, however many clouds there are.
    scratch: Option<[wgpu::Buffer; 2]>,
}

/// What is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lights {
    Sun,
    Sky,
}

impl Lights {
    fn count(self) -> u32 {
        match self {
            Self::Sun => 1,
            Self::Sky => 3,
        }
    }
}

impl FieldPass {
    pub fn new(device: &wgpu::Device) -> Self {
        let program = |name, overrides: &[_]| ComputeProgram::new(device, name, overrides);
        let flag = |on: bool| f64::from(u8::from(on));
        Self {
            entering: [false, true].map(|air| program("moments_entering", &[("ATMOSPHERE", flag(air))])),
            around: None,
            media: HashMap::new(),
            sweep: [false, true].map(|flash| program("moments_sweep", &[("FLASH", flag(flash))])),
            scatter: program("moments_scatter", &[]),
            prolong: [1.0, solver::STRETCH].map(|share| program("moments_prolong", &[("SHARE", share)])),
            restrict: program("moments_restrict", &[]),
            keep: [0.0, BEYOND].map(|beyond| program("moments_keep", &[("BEYOND", beyond)])),
            view: [false, true].map(|sun| program("moments_view", &[("SUN", flag(sun))])),
            tile: [false, true].map(|sun| program("moments_tile", &[("SUN", flag(sun))])),
            sky: None,
            scratch: None,
        }
    }

    /// The light of sky and ground that comes in, where it was found already.
    fn entered(&self, inputs: &Inputs<'_>) -> Option<wgpu::Buffer> {
        let (_, found) = self.sky.as_ref().filter(|(of, _)| inputs.sky.settings() == Some(*of))?;
        Some(found.clone())
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
        key: &FieldKey,
        sky: Option<&FieldKey>,
        sun: (&BoxKey, &TextureView),
        (known_sun, known_sky): (Option<SolvedLight>, Option<SolvedLight>),
        count: &mut dyn FnMut(),
    ) -> Field {
        // Told at most once, for both lights.
        let mut told: Option<Told> = None;
        let mut solve = |lights, cells| {
            count();
            if told.is_none() && !key.around.is_nothing() {
                told = Some(key.around.told(inputs.to_sun));
            }
            self.solve(encoder, inputs, key, (told.as_ref(), cells), sun, lights)
        };
        let sun = known_sun.unwrap_or_else(|| solve(Lights::Sun, key.cells));
        let sky = sky.map(|key| known_sky.unwrap_or_else(|| solve(Lights::Sky, key.cells)));
        Field { field_box: FieldBox::new(&key.medium), sun, sky }
    }

    /// Solves for `lights` in a medium, `most` cells along its longest axis, among what is `told` of its surroundings.
    fn solve(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        FieldKey { medium, flash, .. }: &FieldKey,
        (told, most): (Option<&Told>, u32),
        (sun, sun_volume): (&BoxKey, &TextureView),
        lights: Lights,
    ) -> SolvedLight {
        let device = inputs.device;
        let field_box = FieldBox::new(medium);
        let numbers = u64::from(field_box.size(most).element_product() * lights.count()) * DIRECTIONS as u64;
        let scratch = self.scratch(device, numbers * size_of::<f32>() as u64);
        let bricks = Bricks::of(&sun.light_box, medium, sun.voxels);
        let kind = inputs.media.kind(medium);
        self.media
            .entry(kind)
            .or_insert_with(|| ComputeProgram::with_roles(device, "moments_medium", &[kind.role()], &[]));
        let none = vec![0.0f32; 3 * DIRECTIONS];
        let entered = if lights == Lights::Sky { self.entered(inputs) } else { None };
        let enters = lights == Lights::Sky && entered.is_none();
        let entering = entered.unwrap_or_else(|| {
            // Of a ball within all of its light counts, and none comes from outside.
            let all = if flash.w > 0.0 { 1.0 } else { 0.0 };
            let scattered = told.filter(|_| lights == Lights::Sun).map(Told::sunlight);
            gpu::storage_buffer(device, "entering light", &scattered.unwrap_or(vec![all; 6 * DIRECTIONS]))
        });
        if enters {
            self.sky = inputs.sky.settings().map(|settings| (settings, entering.clone()));
        }
        let around = told.filter(|_| lights == Lights::Sky).map(|told| {
            self.around.get_or_insert_with(|| ComputeProgram::new(device, "moments_around", &[]));
            let dark = vec![0.0f32; 3 * DIRECTIONS];
            (
                gpu::uniform_buffer(device, "surroundings", &told.uniform()),
                gpu::storage_buffer(device, "entering light among others", &dark),
            )
        });
        let solver = Solver {
            pass: self,
            inputs,
            field_box,
            flash: *flash,
            scratch,
            lights,
            species: &medium.species,
            densest: medium.densest(),
            medium: (&self.media[&kind], inputs.media.group(medium)),
            sun_box: gpu::uniform_buffer(device, "sun box", &sun.light_box),
            lists: gpu::storage_buffer(device, "bricks", &bricks.lists),
            candidates: gpu::storage_buffer(device, "ellipsoids of bricks", &bricks.candidates),
            sun_volume,
            clamped: gpu::linear_clamp(device),
            directions: gpu::storage_buffer(device, "directions", &directions()),
            enters,
            around,
            entering,
            none: gpu::storage_buffer(device, "no entering light", &none),
        };
        let stamps = inputs.timing.and_then(|timing| timing.compute("moments"));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("moments"),
            timestamp_writes: stamps,
        });
        solver.run(&mut pass, most)
    }
}
