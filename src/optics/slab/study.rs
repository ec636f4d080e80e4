//! The study of slabs: all slabs once, and the tables that are made from them.
//!
//! What is done is kept in a file beside the tables, from which a run that was
//! interrupted goes on, and which goes when the tables are there.

use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::axes;
use super::collector::Collector;
use super::direct::Direct;
use super::functions::Functions;
use super::moments::{self, COEFFICIENTS};
use super::partial::Partial;
use super::samples::{self, NUMBERS, SLABS, sample};
use super::walks::{self, Deflection, Walks};
use super::{Medium, SETS, Solver};
use crate::Result;
use crate::files::write_whole;
use crate::optics::peak::Chopped;
use crate::optics::phase::Phase;
use crate::tables::Grids;

/// Effective radius of the droplets, um: Kol's and Bouthors'.
pub const EFFECTIVE_RADIUS_UM: f64 = 6.0;

/// Highest moment of the phase function.
pub const DEGREE: usize = 64;

/// The seed of the tables in the repository.
pub const SEED: u64 = 1;

/// Slabs in which random walks are made.
const WALKS: usize = walks::THICKNESSES * walks::SUNS;

/// Slabs of the table of moments.
const COLUMNS: usize = axes::THICKNESSES * axes::SUNS;

/// Azimuthal modes that the table of moments needs.
pub const MOMENT_MODES: usize = 2;

/// Jobs of a study: walks, samples, moments.
const JOBS: usize = WALKS + SLABS + COLUMNS;

/// Jobs and fits, for the progress.
const STEPS: usize = JOBS + SETS * samples::THICKNESSES;

/// The light of all slabs.
#[derive(Debug, Clone)]
pub struct Study {
    medium: Medium,
    /// Light at the samples of each slab.
    pub samples: Vec<Vec<f32>>,
    /// Random walks in their slabs.
    pub walks: Vec<Walks>,
    /// Columns of the table of moments.
    pub columns: Vec<Vec<[f64; COEFFICIENTS]>>,
}

/// The droplets of all tables of slabs.
///
/// # Errors
/// Where the Mie table is damaged.
pub fn droplets() -> Result<Chopped> {
    Ok(Chopped::new(Phase::mie(EFFECTIVE_RADIUS_UM)?))
}

/// The medium of all tables of slabs.
///
/// # Errors
/// Where the Mie table is damaged.
pub fn medium() -> Result<Medium> {
    Ok(Medium::chopped(&droplets()?, DEGREE))
}

/// Makes the study's tables in `folder`, each in one piece or not at all, going on from what
/// an earlier run with the same seed left there. `progress` is called from any thread with
/// the share done so far, 0 to 1.
///
/// # Errors
/// [`Error::File`](crate::Error::File) where a file cannot be written.
pub fn write_tables(folder: &Path, seed: u64, progress: impl Fn(f64) + Sync) -> Result<()> {
    let done = AtomicUsize::new(0);
    let step = || progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / STEPS as f64);
    let partial = Partial::open(&folder.join("slab.partial"), seed)?;
    let study = Study::run(&partial, seed, step)?;
    let tables = [
        ("slab_moments.bin", study.moments()),
        ("slab_radiance.bin", study.radiance()),
        ("slab_functions.bin", study.functions(step)),
    ];
    for (name, grids) in tables {
        write_whole(&folder.join(name), |file| file.write_all(&grids.encode()))?;
    }
    partial.remove()
}

impl Study {
    /// Does the jobs that `partial` lacks, and keeps them there. `step` is called after each.
    fn run(partial: &Partial, seed: u64, step: impl Fn() + Sync) -> Result<Self> {
        let droplets = droplets()?;
        let deflection = Deflection::chopped(&droplets);
        let solver = Solver::new(Medium::chopped(&droplets, DEGREE));
        let broken = Mutex::new(None);
        let records: Vec<Vec<u8>> = (0..JOBS)
            .into_par_iter()
            .map(|job| {
                let record = partial.record(job).unwrap_or_else(|| {
                    let record = if job < WALKS {
                        Walks::for_tables(&deflection, job, seed).encode()
                    } else if let Some(column) = job.checked_sub(WALKS + SLABS) {
                        encode_column(&moments::column(&solver.solve(moments::beam(column), MOMENT_MODES)))
                    } else {
                        encode(&sample(&solver.solve(samples::beam(job - WALKS), DEGREE)))
                    };
                    if let Err(error) = partial.keep(job, &record) {
                        broken.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                    }
                    record
                });
                step();
                record
            })
            .collect();
        if let Some(error) = broken.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        let (walked, solved) = records.split_at(WALKS);
        let (solved, columns) = solved.split_at(SLABS);
        Ok(Self {
            medium: Medium::chopped(&droplets, DEGREE),
            samples: solved.iter().map(|record| decode(record)).collect(),
            walks: walked.iter().filter_map(|record| Walks::decode(record)).collect(),
            columns: columns.iter().map(|record| decode_column(record)).collect(),
        })
    }

    /// The source moments.
    pub fn moments(&self) -> Grids {
        Grids(vec![moments::table(&self.columns)])
    }

    /// The direct table.
    pub fn radiance(&self) -> Grids {
        let direct = Direct::new(&self.medium, &self.samples);
        Grids(vec![direct.modes, direct.phase])
    }

    /// Bouthors' functions. `step` is called from any thread after each fit.
    pub fn functions(&self, step: impl Fn() + Sync) -> Grids {
        let Functions { angle, view, sun } = Functions::new(&self.medium, &self.samples, step);
        let Collector { shared, offset } = Collector::new(&self.walks);
        Grids(vec![angle, view, sun, shared, offset])
    }
}

fn encode(numbers: &[f32]) -> Vec<u8> {
    debug_assert_eq!(numbers.len(), NUMBERS);
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn decode(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks().0.iter().map(|number| f32::from_le_bytes(*number)).collect()
}

fn encode_column(column: &[[f64; COEFFICIENTS]]) -> Vec<u8> {
    column.iter().flatten().flat_map(|number| number.to_le_bytes()).collect()
}

fn decode_column(bytes: &[u8]) -> Vec<[f64; COEFFICIENTS]> {
    let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|number| f64::from_le_bytes(*number)).collect();
    numbers.as_chunks().0.to_vec()
}
