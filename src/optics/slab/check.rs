//! Whether the embedded tables of slabs are what the study gives.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;

use super::axes;
use super::collector::{Collector, places};
use super::direct::{Direct, modes_of};
use super::samples::{SLABS, beam, sample};
use super::study::{DEGREE, MOMENT_MODES, droplets};
use super::walks::{self, Deflection, Walks};
use super::{Beam, Medium, SETS, Solver, compare, functions::Functions, moments};
use super::{slab_functions, slab_moments, slab_radiance};
use crate::{Error, Result, tables::Grid};

/// Half of a half float's last digit, relative, and a little for another platform's rounding.
const HALF: f64 = 6e-4;

/// Least magnitude that [`HALF`] is taken of: the tables' own, 1.
const UNIT: f64 = 1.0;

/// Relative error of Bouthors' functions, rms over views and sets, that they may have.
const FUNCTIONS_RMS: f64 = 1.5;

/// Error of the mean places where light entered, rms over classes of directions, in spreads,
/// that they may have with the noise of few photons.
const COLLECTOR_RMS: f64 = 0.6;

/// Photons of a check in each slab.
const PHOTONS: usize = 20_000;

/// The tables that [`run`] checks against a study made anew in places.
#[derive(Debug, Clone, Copy)]
pub struct Tables<'a> {
    /// Source moments.
    pub moments: &'a Grid,
    /// Direct table.
    pub radiance: &'a Direct,
    /// Functions of C.
    pub functions: &'a Functions,
    /// Functions of where light entered.
    pub collector: &'a Collector,
}

impl Tables<'static> {
    /// Those of this program.
    ///
    /// # Errors
    /// [`Error::Table`] where one is damaged.
    pub fn embedded() -> Result<Self> {
        let (functions, collector) = slab_functions()?;
        Ok(Self { moments: slab_moments()?, radiance: slab_radiance()?, functions, collector })
    }
}

/// Makes `samples` random slabs of each table anew, by `seed`, and compares; says what.
///
/// # Errors
/// [`Error::Table`] with the first number that differs.
pub fn run(tables: Tables<'_>, samples: usize, seed: u64) -> Result<Vec<String>> {
    let droplets = droplets()?;
    let solver = Solver::new(Medium::chopped(&droplets, DEGREE));
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let mut pick = |from: usize| -> Vec<usize> {
        (0..samples).map(|_| (chance.next_u64() % from as u64) as usize).collect()
    };
    let (columns, slabs) = (pick(axes::THICKNESSES * axes::SUNS), pick(SLABS));
    let jobs = pick(walks::THICKNESSES * walks::SUNS);
    let moments = columns.par_iter().map(|column| check_moments(tables.moments, &solver, *column));
    let moments: usize = moments.collect::<Result<Vec<_>>>()?.iter().sum();
    let radiance = slabs.par_iter().map(|slab| check_radiance(tables.radiance, &solver, *slab));
    let radiance: usize = radiance.collect::<Result<Vec<_>>>()?.iter().sum();
    let functions = check_functions(tables.functions, &solver, samples, seed)?;
    let collector = check_collector(tables.collector, &Deflection::chopped(&droplets), &jobs, seed)?;
    Ok(vec![
        format!("slab_moments.bin: {moments} numbers of {samples} slabs agree to half floats"),
        format!("slab_radiance.bin: {radiance} numbers of {samples} slabs agree to half floats"),
        format!("slab_functions.bin: C of {samples} random slabs within {functions:.2} rms of the solver's"),
        format!(
            "slab_functions.bin: places of entry in {samples} slabs within {collector:.2} spreads rms of random walks"
        ),
    ])
}

fn check_moments(table: &Grid, solver: &Solver, column: usize) -> Result<usize> {
    let beam = moments::beam(column);
    let numbers = moments::column(&solver.solve(beam, MOMENT_MODES));
    let (thickness, sun) = (column / axes::SUNS, column % axes::SUNS);
    let stored = (0..SETS * axes::DEPTHS).flat_map(|i| {
        let (set, depth) = (i / axes::DEPTHS, i % axes::DEPTHS);
        [0, 1].map(|half| table.place(&[set, half, thickness, depth, sun]))
    });
    let stored = stored.flat_map(|place| table.values[place..place + 4].iter().map(|value| value.to_f64()));
    let largest = numbers.iter().flatten().fold(0.0_f64, |most, number| most.max(number.abs()));
    compare_numbers("slab_moments.bin", beam, stored, numbers.iter().flatten().copied(), largest)
}

fn check_radiance(table: &Direct, solver: &Solver, slab: usize) -> Result<usize> {
    let beam = beam(slab);
    let numbers = modes_of(slab, &sample(&solver.solve(beam, DEGREE)), &table.phase);
    let stored = table.modes.values.chunks_exact(numbers.len()).nth(slab);
    let stored = stored.into_iter().flatten().map(|value| value.to_f64());
    compare_numbers("slab_radiance.bin", beam, stored, numbers.iter().copied(), UNIT)
}

/// Numbers as stored and as made anew; `unit` is the least magnitude that rounding is taken of.
fn compare_numbers(
    name: &'static str,
    beam: Beam,
    stored: impl Iterator<Item = f64>,
    made: impl Iterator<Item = f64>,
    unit: f64,
) -> Result<usize> {
    let mut count = 0;
    for (stored, made) in stored.zip(made) {
        let error = (stored - made).abs();
        if error.is_nan() || error > HALF * made.abs().max(unit) {
            let Beam { thickness, mu0 } = beam;
            return Err(Error::Table {
                name,
                problem: format!(
                    "has {stored} for {made} in the slab of thickness {thickness} under a sun of cosine \
                     {mu0}: make it anew with `nephos tables slab`"
                ),
            });
        }
        count += 1;
    }
    Ok(count)
}

fn check_functions(table: &Functions, solver: &Solver, samples: usize, seed: u64) -> Result<f64> {
    let probes = compare::probes(solver, samples, 100, seed);
    let errors = compare::errors(&probes, |set, i| table.radiance(set, probes[i].view));
    let rms = errors[SETS].rms;
    within(rms, FUNCTIONS_RMS, "is wrong by more than its fit: relative error of C")
}

fn check_collector(table: &Collector, deflection: &Deflection, jobs: &[usize], seed: u64) -> Result<f64> {
    let walks: Vec<Walks> = jobs
        .iter()
        .map(|job| Walks::new(deflection, walks::beam(*job), PHOTONS, seed, *job as u64))
        .collect();
    let (mut sum, mut whole) = (0.0, 0.0);
    for place in places(&walks) {
        let found = table.center(place.set, place.view);
        let weight = place.weight.powi(4);
        for (found, mean) in found.iter().zip(place.mean) {
            sum += weight * ((found - mean) / place.sigma.max(1e-3)).powi(2);
        }
        whole += weight;
    }
    within(
        (sum / whole.max(f64::MIN_POSITIVE)).sqrt(),
        COLLECTOR_RMS,
        "is wrong by more than its fit: places of entry",
    )
}

fn within(found: f64, allowed: f64, what: &str) -> Result<f64> {
    if found <= allowed {
        return Ok(found);
    }
    let problem = format!("{what} {found:.2} rms where {allowed} is allowed");
    Err(Error::Table { name: "slab_functions.bin", problem })
}
