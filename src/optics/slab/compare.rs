//! How far representations of C are from the solver, at random views.

use std::f64::consts::PI;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;

use super::axes::{sun_at, thickness_at};
use super::samples::View;
use super::{Beam, SETS, Solver};

/// Least share of a slab's brightest view, and of all sets, that counts.
const LEAST: f64 = 0.02;

/// A view and its light, 1/sr.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// The view.
    pub view: View,
    /// C of each set.
    pub truth: [f64; SETS],
    /// The brightest sum over the sets among the probes of the same slab.
    pub brightest: f64,
}

/// Relative errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Root of the mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub worst: f64,
    /// Number of views.
    pub count: usize,
}

/// `views` random views in each of `slabs` random slabs: thickness even in the logarithm,
/// suns and depths as dense as tables are, directions even over the sphere.
pub fn probes(solver: &Solver, slabs: usize, views: usize, seed: u64) -> Vec<Probe> {
    let of_slab = |slab: usize| {
        let mut chance = ChaCha8Rng::seed_from_u64(seed);
        chance.set_stream(slab as u64);
        let mut uniform = || (chance.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64);
        let beam = Beam { thickness: thickness_at(uniform()), mu0: sun_at(uniform()) };
        let field = solver.solve(beam, solver.degree());
        let mut probes: Vec<Probe> = (0..views)
            .map(|_| {
                let level = (uniform() * field.depths().len() as f64) as usize;
                let (mu, phi) = (2.0 * uniform() - 1.0, PI * uniform());
                let view =
                    View { thickness: beam.thickness, depth: field.depths()[level], mu, phi, mu0: beam.mu0 };
                let truth = std::array::from_fn(|set| field.radiance(set, mu, &[phi])[0][level]);
                Probe { view, truth, brightest: 0.0 }
            })
            .collect();
        let brightest = probes.iter().map(|probe| probe.truth.iter().sum()).fold(0.0, f64::max);
        probes.iter_mut().for_each(|probe| probe.brightest = brightest);
        probes
    };
    (0..slabs).into_par_iter().flat_map_iter(of_slab).collect()
}

/// Errors of a representation for each set, and of the sum of the sets. Views count that
/// have 2 % of the slab's brightest or more, and a set where it is 2 % of the view's light.
/// The model takes the set and the index of a probe.
pub fn errors(probes: &[Probe], model: impl Fn(usize, usize) -> f64) -> [Errors; SETS + 1] {
    let mut squares = [0.0; SETS + 1];
    let mut all = [Errors { rms: 0.0, worst: 0.0, count: 0 }; SETS + 1];
    for (i, probe) in probes.iter().enumerate() {
        let whole: f64 = probe.truth.iter().sum();
        if whole < LEAST * probe.brightest {
            continue;
        }
        let found: [f64; SETS] = std::array::from_fn(|set| model(set, i));
        let sets = (0..SETS).filter(|set| probe.truth[*set] >= LEAST * whole);
        let of_sets = sets.map(|set| (set, found[set] / probe.truth[set] - 1.0));
        for (set, error) in of_sets.chain([(SETS, found.iter().sum::<f64>() / whole - 1.0)]) {
            squares[set] += error * error;
            all[set].worst = all[set].worst.max(error.abs());
            all[set].count += 1;
        }
    }
    for (errors, square) in all.iter_mut().zip(squares) {
        errors.rms = (square / errors.count.max(1) as f64).sqrt();
    }
    all
}
