//! C of \[K 3.25\] as a direct table, divided by what is known of it.
//!
//! C = mu0 (1 - e^-path) P_n(Theta) K e^(a0 + a1 cos phi + a2 cos 2 phi + a3 cos 3 phi). The path
//! ends at the slab's face behind the point; P_n is the phase function convolved with itself
//! as often as the set's first order n says; K = e^(-k d) (t / (t + c))^(n-1) is how the set
//! dies with depth and with thinness. What is left, a0 to a3 by thickness, sun, depth and
//! view, is smooth.

use super::axes::{depth_coordinate, point, sun_at, sun_coordinate, thickness_at, thickness_coordinate};
use super::samples::{
    AZIMUTHS, COSINES, DEPTHS, FLOOR, NUMBERS, SUNS, THICKNESSES, View, azimuth, beam, view, view_at,
    view_coordinate,
};
use super::{FIRST_ORDERS, Medium, SETS};
use crate::tables::{Axis, Grid, Grids};

/// Fourier modes of the azimuth that are kept.
pub const MODES: usize = 4;

/// Angles of the table of P_n, even in the sine of their half.
pub const ANGLES: usize = 128;

/// Decay with optical depth of each set, k.
pub const DECAY: [f64; SETS] = [1.0, 1.0, 1.0, 1.0, 0.9, 0.75, 0.0];

/// Optical thickness about which each set is born, c.
pub const BIRTH: [f64; SETS] = [1.0, 1.0, 0.7, 0.3, 0.2, 0.2, 0.7];

/// ln K of a set.
pub fn ln_known(set: usize, thickness: f64, depth: f64) -> f64 {
    let born = (thickness / (thickness + BIRTH[set])).ln();
    (FIRST_ORDERS[set] - 1) as f64 * born - DECAY[set] * depth
}

/// The direct table.
#[derive(Debug, Clone, PartialEq)]
pub struct Direct {
    /// a0 to a3 by thickness, sun, depth, set and view.
    pub modes: Grid,
    /// P_n, 1/sr, by set and scattering angle.
    pub phase: Grid,
}

impl Direct {
    /// Of the samples of all slabs, for light scattered in `medium`.
    pub fn new(medium: &Medium, samples: &[Vec<f32>]) -> Self {
        let index = |length: usize| (0..length).map(|i| i as f64);
        let phase = Grid::new(
            "phase",
            vec![
                Axis::new("set", index(SETS)),
                Axis::new("sin(Theta / 2)", (0..ANGLES).map(|i| point(i, ANGLES))),
            ],
            1,
            (0..SETS).flat_map(|set| (0..ANGLES).map(move |i| convolved(medium, set, point(i, ANGLES)))),
        );
        let values: Vec<f64> =
            samples.iter().enumerate().flat_map(|(slab, sample)| modes_of(slab, sample, &phase)).collect();
        let axes = vec![
            Axis::new("optical thickness", (0..THICKNESSES).map(|i| thickness_at(point(i, THICKNESSES)))),
            Axis::new("sun cosine", (0..SUNS).map(|i| sun_at(point(i, SUNS)))),
            Axis::new("depth coordinate", (0..DEPTHS).map(|i| point(i, DEPTHS))),
            Axis::new("set", index(SETS)),
            Axis::new("view cosine", (0..COSINES).map(|i| view_at(point(i, COSINES)))),
        ];
        Self { modes: Grid::new("direct", axes, MODES, values), phase }
    }

    /// The tables of a file, if they are there and have the right axes.
    pub fn of(grids: &Grids) -> Option<Self> {
        let (modes, phase) = (grids.named("direct")?, grids.named("phase")?);
        let fits = |grid: &Grid, lengths: &[usize], channels| {
            grid.channels == channels
                && grid.axes.iter().map(|axis| axis.values.len()).eq(lengths.iter().copied())
        };
        let good = fits(modes, &[THICKNESSES, SUNS, DEPTHS, SETS, COSINES], MODES)
            && fits(phase, &[SETS, ANGLES], 1);
        good.then(|| Self { modes: modes.clone(), phase: phase.clone() })
    }

    /// C of a set, 1/sr.
    pub fn radiance(&self, set: usize, view: View) -> f64 {
        let view = view.sunward();
        let along = |coordinate: f64, points: usize| coordinate * (points - 1) as f64;
        let position = [
            along(thickness_coordinate(view.thickness), THICKNESSES),
            along(sun_coordinate(view.mu0), SUNS),
            along(depth_coordinate(view.depth, view.thickness), DEPTHS),
            set as f64,
            along(view_coordinate(view.mu), COSINES),
        ];
        let exponent: f64 =
            (0..MODES).map(|m| self.modes.linear(&position, m) * (m as f64 * view.phi).cos()).sum();
        view.mu0
            * view.beam().opacity(view.depth, view.mu)
            * phase_at(&self.phase, set, view.half_sine())
            * (exponent + ln_known(set, view.thickness, view.depth)).exp()
    }
}

/// a0 to a3 of slab number `slab`, by depth, set and view, from its samples.
pub fn modes_of(slab: usize, sample: &[f32], phase: &Grid) -> Vec<f64> {
    let rests = rests(slab, sample, phase);
    let mut values = Vec::with_capacity(DEPTHS * SETS * COSINES * MODES);
    for (depth, set) in (0..DEPTHS).flat_map(|depth| (0..SETS).map(move |set| (depth, set))) {
        for cosine in 0..COSINES {
            let first = ((set * DEPTHS + depth) * COSINES + cosine) * AZIMUTHS;
            values.extend((0..MODES).map(|m| mode(&rests[first..][..AZIMUTHS], m)));
        }
    }
    values
}

/// What the samples of a slab leave when the known is taken off, logarithms; it stays where
/// it is below the depth at which they tell nothing more.
fn rests(slab: usize, sample: &[f32], phase: &Grid) -> Vec<f64> {
    let beam = beam(slab);
    let mut rests = vec![0.0; NUMBERS];
    let column = COSINES * AZIMUTHS;
    for (set, place) in (0..SETS).flat_map(|set| (0..column).map(move |i| (set, set * DEPTHS * column + i))) {
        let depths = (0..DEPTHS).map(|depth| place + depth * column);
        let most = depths.clone().map(|i| sample[i]).fold(f32::MIN, f32::max);
        let least = f64::from(most) + FLOOR.ln() + 0.5;
        let mut rest = 0.0;
        for i in depths {
            if f64::from(sample[i]) > least {
                let view = view(beam, i);
                let shape = phase_at(phase, set, view.half_sine());
                rest = f64::from(sample[i]) - shape.ln() - ln_known(set, view.thickness, view.depth);
            }
            rests[i] = rest;
        }
    }
    rests
}

/// P_n at the sine of half the scattering angle.
fn phase_at(phase: &Grid, set: usize, half_sine: f64) -> f64 {
    phase.linear(&[set as f64, half_sine * (ANGLES - 1) as f64], 0)
}

/// The phase function convolved with itself until light of a set's first order has its shape,
/// 1/sr, at the sine of half the scattering angle.
fn convolved(medium: &Medium, set: usize, half_sine: f64) -> f64 {
    let chi = medium.chi.iter().map(|chi| chi.powi(FIRST_ORDERS[set] as i32)).collect();
    Medium { chi }.phase(1.0 - 2.0 * half_sine * half_sine)
}

/// Fourier mode `m` of a function at the azimuths of the samples.
fn mode(values: &[f64], m: usize) -> f64 {
    let twice = if m == 0 { 1.0 } else { 2.0 };
    let sum: f64 = values.iter().enumerate().map(|(i, value)| value * (m as f64 * azimuth(i)).cos()).sum();
    twice * sum / AZIMUTHS as f64
}
