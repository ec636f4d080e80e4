//! Where the light of a view entered its slab, on average: Bouthors' functions
//! \[K 3.38-3.53\], fitted to random walks.
//!
//! Places are on the lit face, as seen from the point straight above them: z toward the sun,
//! x to the side. With s = ln^2(1 + E* d):
//!
//! c_x = sin phi (F* sin(G* theta_L) s + H* sin theta_L),
//! c_z = (I* + J* (cos phi sin(K* theta_L) + L* theta_L)) s + M* + N* cos phi.
//!
//! E* to M* depend on set and view, N* on the sun too. The azimuth phi counts from straight
//! on; x is the side that positive azimuths point to. The fit is least squares of the error
//! over the spread of the class of directions, weighted by the root of the class's share of
//! a slab's photons.

use rayon::prelude::*;

use super::SETS;
use super::axes::{depth_at, point, sun_at, sun_coordinate};
use super::least_squares::{Slopes, fit};
use super::samples::View;
use super::walks::{AZIMUTHS, COSINES, PLANES, SUNS, Walks, azimuth_of, cosine_of};
use crate::tables::{Axis, Grid, Grids};

/// Photons under which a class of directions tells nothing.
const LEAST_PHOTONS: f64 = 100.0;

/// E* to L*, in this order; E* is kept as its logarithm.
const SHARED: usize = 8;
const M: usize = SHARED;
const N_FROM: usize = SHARED + 1;
const PARAMETERS: usize = N_FROM + SUNS;

/// Bounds of ln E*.
const BOUNDS: [f64; 2] = [-5.0, 5.0];

/// How much parameters keep to where they start, against residuals.
const INERTIA: f64 = 0.01;

/// The functions' tables.
#[derive(Debug, Clone, PartialEq)]
pub struct Collector {
    /// ln E*, F*, G*, H*, I*, J*, K*, L* by set and view.
    pub shared: Grid,
    /// N* and M* by set, sun and view.
    pub offset: Grid,
}

/// A mean place that random walks told.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Index of the set.
    pub set: usize,
    /// Index of the view's cosine.
    pub cosine: usize,
    /// Index of the sun.
    pub sun: usize,
    /// The middle of its class of directions.
    pub view: View,
    /// Mean c_x and c_z.
    pub mean: [f64; 2],
    /// Standard deviation of one photon's place.
    pub sigma: f64,
    /// Fourth root of the share of the slab's photons.
    pub weight: f64,
}

impl Collector {
    /// Fitted to random walks.
    pub fn new(walks: &[Walks]) -> Self {
        let places = places(walks);
        let fits: Vec<Vec<f64>> = (0..SETS * COSINES)
            .into_par_iter()
            .map(|i| {
                let mine: Vec<&Place> =
                    places.iter().filter(|p| p.set == i / COSINES && p.cosine == i % COSINES).collect();
                fit_one(&mine)
            })
            .collect();
        let sets = || Axis::new("set", (0..SETS).map(|i| i as f64));
        let views = || Axis::new("view cosine", (0..COSINES).map(cosine_of));
        let suns = Axis::new("sun cosine", (0..SUNS).map(|i| sun_at(point(i, SUNS))));
        let shared = fits.iter().flat_map(|fit| fit[..SHARED].iter().copied());
        let offset = (0..SETS).flat_map(|set| {
            let fits = &fits[set * COSINES..][..COSINES];
            (0..SUNS).flat_map(move |sun| fits.iter().flat_map(move |fit| [fit[N_FROM + sun], fit[M]]))
        });
        Self {
            shared: Grid::new("collector", vec![sets(), views()], SHARED, shared),
            offset: Grid::new("collector offset", vec![sets(), suns, views()], 2, offset.collect::<Vec<_>>()),
        }
    }

    /// The tables of a file, if they are there and have the right axes.
    pub fn of(grids: &Grids) -> Option<Self> {
        let get = |name: &str, lengths: &[usize], channels: usize| {
            let grid = grids.named(name)?;
            let found = grid.axes.iter().map(|axis| axis.values.len());
            (grid.channels == channels && found.eq(lengths.iter().copied())).then(|| grid.clone())
        };
        Some(Self {
            shared: get("collector", &[SETS, COSINES], SHARED)?,
            offset: get("collector offset", &[SETS, SUNS, COSINES], 2)?,
        })
    }

    /// c_x and c_z of a set's light, optical depths.
    pub fn center(&self, set: usize, view: View) -> [f64; 2] {
        let view = view.sunward();
        let along = 0.5 * (view.mu + 1.0) * COSINES as f64 - 0.5;
        let sun = sun_coordinate(view.mu0) * (SUNS - 1) as f64;
        let mut parameters = [0.0; SHARED + 2];
        for (i, parameter) in parameters[..SHARED].iter_mut().enumerate() {
            *parameter = self.shared.linear(&[set as f64, along], i);
        }
        parameters[SHARED] = self.offset.linear(&[set as f64, sun, along], 1);
        parameters[SHARED + 1] = self.offset.linear(&[set as f64, sun, along], 0);
        center(&parameters, view).0
    }
}

/// The mean places of all classes with photons enough.
pub fn places(walks: &[Walks]) -> Vec<Place> {
    let mut all = Vec::new();
    for (job, walk) in walks.iter().enumerate() {
        let whole = walk.photons_counted();
        for i in 0..SETS * PLANES * COSINES * AZIMUTHS {
            let (set, plane) = (i / (AZIMUTHS * COSINES * PLANES), i / (AZIMUTHS * COSINES) % PLANES);
            let (cosine, azimuth) = (i / AZIMUTHS % COSINES, i % AZIMUTHS);
            let entries = walk.entries(set, plane, cosine, azimuth);
            let Some([z, x]) = entries.mean().filter(|_| entries.count >= LEAST_PHOTONS) else { continue };
            let view = View {
                thickness: walk.beam.thickness,
                depth: depth_at(point(plane, PLANES), walk.beam.thickness),
                mu: cosine_of(cosine),
                phi: azimuth_of(azimuth),
                mu0: walk.beam.mu0,
            };
            let scatter: f64 = entries.scatter().iter().sum();
            all.push(Place {
                set,
                cosine,
                sun: job % SUNS,
                view,
                mean: [x, z],
                sigma: (0.5 * scatter / entries.count).sqrt(),
                weight: (entries.count / whole).sqrt().sqrt(),
            });
        }
    }
    all
}

/// The parameters of a set and view.
fn fit_one(places: &[&Place]) -> Vec<f64> {
    let mut start = vec![0.0; PARAMETERS];
    start[..SHARED].copy_from_slice(&[0.0, -0.3, 1.0, -0.3, 0.0, 0.3, 1.0, 0.3]);
    let near = start.clone();
    fit(start, 2 * places.len() + PARAMETERS, |parameters, row, slopes| {
        let Some(place) = places.get(row / 2) else {
            let i = row - 2 * places.len();
            slopes.push((i, INERTIA));
            return INERTIA * (parameters[i] - near[i]);
        };
        residual(parameters, place, row % 2, slopes)
    })
}

/// The error of one coordinate over the spread, weighted.
fn residual(parameters: &[f64], place: &Place, axis: usize, slopes: &mut Slopes) -> f64 {
    let mut here = [0.0; SHARED + 2];
    here[..=SHARED].copy_from_slice(&parameters[..=SHARED]);
    here[SHARED + 1] = parameters[N_FROM + place.sun];
    let scale = place.weight / place.sigma.max(1e-3);
    let (center, by) = center(&here, place.view);
    let index = |i: usize| if i <= SHARED { i } else { N_FROM + place.sun };
    slopes.extend(
        by[axis].iter().enumerate().filter(|(_, by)| **by != 0.0).map(|(i, by)| (index(i), scale * by)),
    );
    scale * (center[axis] - place.mean[axis])
}

type Gradient = [f64; SHARED + 2];

/// c_x and c_z, and their derivatives by ln E*, F* to L*, M*, N*.
fn center(parameters: &Gradient, view: View) -> ([f64; 2], [Gradient; 2]) {
    let [ln_e, f, g, h, i, j, k, l, m, n] = *parameters;
    let theta = view.mu0.clamp(0.0, 1.0).acos();
    let (sine, cosine) = view.phi.sin_cos();
    let e = ln_e.clamp(BOUNDS[0], BOUNDS[1]).exp();
    let log = (e * view.depth).ln_1p();
    let s = log * log;
    let by_e = 2.0 * log * e * view.depth / (1.0 + e * view.depth);
    let (sin_g, cos_g) = (g * theta).sin_cos();
    let (sin_k, cos_k) = (k * theta).sin_cos();
    let along = cosine * sin_k + l * theta;
    let x = sine * (f * sin_g * s + h * theta.sin());
    let z = (i + j * along) * s + m + n * cosine;
    let by_x = [
        sine * f * sin_g * by_e,
        sine * sin_g * s,
        sine * f * theta * cos_g * s,
        sine * theta.sin(),
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ];
    let by_z = [
        (i + j * along) * by_e,
        0.0,
        0.0,
        0.0,
        s,
        along * s,
        j * cosine * theta * cos_k * s,
        j * theta * s,
        1.0,
        cosine,
    ];
    ([x, z], [by_x, by_z])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_functions() {
        let at = [0.2, -0.4, 1.1, -0.2, 0.1, 0.5, 0.9, 0.3, 0.2, -0.1];
        let view = View { thickness: 9.0, depth: 2.0, mu: 0.3, phi: 0.8, mu0: 0.6 };
        let (_, by) = center(&at, view);
        for i in 0..at.len() {
            let moved = |step: f64| {
                let mut p = at;
                p[i] += step;
                center(&p, view).0
            };
            let (low, high) = (moved(-1e-5), moved(1e-5));
            for axis in 0..2 {
                let slope = (high[axis] - low[axis]) / 2e-5;
                assert!((slope - by[axis][i]).abs() < 1e-8, "{axis} {i}: {slope} for {}", by[axis][i]);
            }
        }
    }
}
