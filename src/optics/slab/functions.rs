//! Bouthors' phenomenological functions of C \[K 3.32-3.37\], fitted anew.
//!
//! C = (1 - e^-path) P* A1* A2* cos theta_L ln^2(d + D*) / ln^2(B* + D*) e^(-(d - B*)^2 / 2 C*^2),
//! with B* = B1* - B2*. The first factor is ours, path being the optical path to the face behind
//! the point: without it the functions cannot vanish where light had no room to scatter. For each set and thickness P* depends on Theta, A1*, B1*, C* and D* on
//! theta_V, A2* and B2* on theta_L. What is kept is even between thicknesses: ln P*, ln A1*,
//! ln A2*, B1* / t, B2* / t, ln(C* / t) and ln(D* - 1). D* is above 1, which keeps the
//! logarithms from changing sign. P* is 1 for the last set, as Kol has it.
//!
//! The fit of a set in the slabs of one thickness is least squares of the relative error,
//! weighted by the root of the radiance (of its most there): neither do the few bright
//! directions count alone, nor the many dark ones. Views with less than 1e-4 of the most
//! don't count.

use rayon::prelude::*;

use super::axes::{point, sun_at, sun_coordinate, thickness_at, thickness_coordinate};
use super::least_squares::{Slopes, fit};
use super::samples::{
    AZIMUTHS, COSINES, NUMBERS, SUNS, THICKNESSES, View, beam, view, view_at, view_coordinate,
};
use super::{FIRST_ORDERS, Medium, SETS};
use crate::tables::{Axis, Grid, Grids};

/// Angles of P*, even in the sine of their half.
pub const ANGLES: usize = 32;

/// Radiance of a view that counts in a fit, of the most.
const LEAST: f64 = 1e-4;

/// How much parameters keep to those of the next thinner slab, against residuals.
const INERTIA: f64 = 0.3;

/// Bounds of ln(D* - 1) and of ln(C* / t).
const BOUNDS: [f64; 2] = [-6.0, 6.0];

/// Where parameters of a fit begin: ln P*, then ln A1*, B1*, ln C*, ln(D* - 1), then ln A2*, B2*.
const VIEW_FROM: usize = ANGLES;
const SUN_FROM: usize = VIEW_FROM + 4 * COSINES;
const PARAMETERS: usize = SUN_FROM + 2 * SUNS;

/// The functions' tables.
#[derive(Debug, Clone, PartialEq)]
pub struct Functions {
    /// ln P* by set, thickness and scattering angle.
    pub angle: Grid,
    /// ln A1*, B1* / t, ln(C* / t), ln(D* - 1) by set, thickness and view.
    pub view: Grid,
    /// ln A2* and B2* / t by set, thickness and sun.
    pub sun: Grid,
}

/// The numbers of the functions at one view and sun.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Parameters {
    ln_p: f64,
    ln_a: f64,
    b: f64,
    ln_c: f64,
    ln_d: f64,
}

impl Parameters {
    /// ln C, and its derivatives by the five.
    fn ln_radiance(self, thickness: f64, depth: f64, mu0: f64) -> (f64, [f64; 5]) {
        let b = thickness * self.b.max(0.0);
        let c = thickness * self.ln_c.clamp(BOUNDS[0], BOUNDS[1]).exp();
        let beyond = self.ln_d.clamp(BOUNDS[0], BOUNDS[1]).exp();
        let (here, there) = (depth + beyond, b + beyond);
        let (log_here, log_there) = (here.ln_1p(), there.ln_1p());
        let distance = (depth - b) / c;
        let value =
            self.ln_p + self.ln_a + mu0.ln() + 2.0 * (log_here / log_there).ln() - 0.5 * distance * distance;
        let by_there = -2.0 / (log_there * (1.0 + there));
        let by_b = if self.b > 0.0 { thickness * (by_there + distance / c) } else { 0.0 };
        let by_d = beyond * (2.0 / (log_here * (1.0 + here)) + by_there);
        (value, [1.0, 1.0, by_b, distance * distance, by_d])
    }
}

impl Functions {
    /// Fitted to the samples of all slabs, P* starting from the phase function of `medium`.
    /// `progress` is called from any thread after each of the fits, one a set and thickness.
    pub fn new(medium: &Medium, samples: &[Vec<f32>], progress: impl Fn() + Sync) -> Self {
        let fits: Vec<Vec<Vec<f64>>> = (0..SETS)
            .into_par_iter()
            .map(|set| {
                let mut last = start(medium, set);
                (0..THICKNESSES)
                    .map(|thickness| {
                        last = fit_one(set, &samples[thickness * SUNS..][..SUNS], thickness * SUNS, &last);
                        progress();
                        last.clone()
                    })
                    .collect()
            })
            .collect();
        let fits: Vec<&Vec<f64>> = fits.iter().flatten().collect();
        let grid = |name: &str, last: Axis, channels: usize, from: usize| {
            let axes = vec![
                Axis::new("set", (0..SETS).map(|i| i as f64)),
                Axis::new("optical thickness", (0..THICKNESSES).map(|i| thickness_at(point(i, THICKNESSES)))),
                last,
            ];
            let count = axes[2].values.len() * channels;
            let values: Vec<f64> =
                fits.iter().flat_map(|fit| fit[from..from + count].iter().copied()).collect();
            Grid::new(name, axes, channels, values)
        };
        let views = (0..COSINES).map(|i| view_at(point(i, COSINES)));
        let suns = (0..SUNS).map(|i| sun_at(point(i, SUNS)));
        let angles = (0..ANGLES).map(|i| point(i, ANGLES));
        Self {
            angle: grid("angle", Axis::new("sin(Theta / 2)", angles), 1, 0),
            view: grid("view", Axis::new("view cosine", views), 4, VIEW_FROM),
            sun: grid("sun", Axis::new("sun cosine", suns), 2, SUN_FROM),
        }
    }

    /// The tables of a file, if they are there and have the right axes.
    pub fn of(grids: &Grids) -> Option<Self> {
        let get = |name: &str, length: usize, channels: usize| {
            let grid = grids.named(name)?;
            let lengths = grid.axes.iter().map(|axis| axis.values.len());
            (grid.channels == channels && lengths.eq([SETS, THICKNESSES, length])).then(|| grid.clone())
        };
        Some(Self {
            angle: get("angle", ANGLES, 1)?,
            view: get("view", COSINES, 4)?,
            sun: get("sun", SUNS, 2)?,
        })
    }

    /// C of a set, 1/sr.
    pub fn radiance(&self, set: usize, view: View) -> f64 {
        let view = view.sunward();
        let row = thickness_coordinate(view.thickness) * (THICKNESSES - 1) as f64;
        let at = |grid: &Grid, coordinate: f64, channel: usize| {
            let along = coordinate * (grid.axes[2].values.len() - 1) as f64;
            grid.linear(&[set as f64, row, along], channel)
        };
        let seen = |channel| at(&self.view, view_coordinate(view.mu), channel);
        let lit = |channel| at(&self.sun, sun_coordinate(view.mu0), channel);
        let parameters = Parameters {
            ln_p: at(&self.angle, view.half_sine(), 0),
            ln_a: seen(0) + lit(0),
            b: seen(1) - lit(1),
            ln_c: seen(2),
            ln_d: seen(3),
        };
        view.beam().opacity(view.depth, view.mu)
            * parameters.ln_radiance(view.thickness, view.depth, view.mu0).0.exp()
    }
}

/// Where the fit of a set in the thinnest slab starts.
fn start(medium: &Medium, set: usize) -> Vec<f64> {
    let chi = medium.chi.iter().map(|chi| chi.powi(FIRST_ORDERS[set] as i32)).collect();
    let shape = Medium { chi };
    let last = set == SETS - 1;
    let ln_p = |i: usize| {
        let half = point(i, ANGLES);
        if last { 0.0 } else { shape.phase(1.0 - 2.0 * half * half).max(1e-3).ln() }
    };
    let mut all: Vec<f64> = (0..ANGLES).map(ln_p).collect();
    all.extend((0..COSINES).flat_map(|_| [0.0, 0.3, 0.0, 0.0]));
    all.resize(PARAMETERS, 0.0);
    all
}

/// The parameters of a set in slabs of one thickness under all suns, near those of the next
/// thinner.
fn fit_one(set: usize, samples: &[Vec<f32>], first_slab: usize, near: &[f64]) -> Vec<f64> {
    let rows = rows(set, samples, first_slab);
    let mut begin = near.to_vec();
    // Sets grow fast with thickness: level first.
    let level = |parameters: &[f64]| -> f64 {
        let (sum, whole) = rows.iter().fold((0.0, 0.0), |(sum, whole), row| {
            let weight = row.weight * row.weight;
            (sum + weight * (row.ln_radiance - row.model(set, parameters, &mut Vec::new())), whole + weight)
        });
        sum / whole
    };
    let missing = level(&begin);
    begin[VIEW_FROM..SUN_FROM].iter_mut().step_by(4).for_each(|ln_a| *ln_a += missing);
    let near = begin.clone();
    fit(begin, rows.len() + PARAMETERS, |parameters, i, slopes| match rows.get(i) {
        Some(row) => {
            let model = row.model(set, parameters, slopes);
            slopes.iter_mut().for_each(|(_, slope)| *slope *= row.weight);
            row.weight * (model - row.ln_radiance)
        }
        None => {
            let i = i - rows.len();
            slopes.push((i, INERTIA));
            INERTIA * (parameters[i] - near[i])
        }
    })
}

/// A sample as the fit sees it.
struct Row {
    view: View,
    cosine: usize,
    sun: usize,
    /// ln of C over the opacity.
    ln_radiance: f64,
    weight: f64,
}

impl Row {
    fn model(&self, set: usize, parameters: &[f64], slopes: &mut Slopes) -> f64 {
        let along = self.view.half_sine() * (ANGLES - 1) as f64;
        let angle = (along as usize).min(ANGLES - 2);
        let part = along - angle as f64;
        let seen = VIEW_FROM + 4 * self.cosine;
        let lit = SUN_FROM + 2 * self.sun;
        let (value, by) = Parameters {
            ln_p: parameters[angle] * (1.0 - part) + parameters[angle + 1] * part,
            ln_a: parameters[seen] + parameters[lit],
            b: parameters[seen + 1] - parameters[lit + 1],
            ln_c: parameters[seen + 2],
            ln_d: parameters[seen + 3],
        }
        .ln_radiance(self.view.thickness, self.view.depth, self.view.mu0);
        if set < SETS - 1 {
            slopes.extend([(angle, by[0] * (1.0 - part)), (angle + 1, by[0] * part)]);
        }
        slopes.extend([
            (seen, by[1]),
            (lit, by[1]),
            (seen + 1, by[2]),
            (lit + 1, -by[2]),
            (seen + 2, by[3]),
            (seen + 3, by[4]),
        ]);
        value
    }
}

/// The samples of a set that count.
fn rows(set: usize, samples: &[Vec<f32>], first_slab: usize) -> Vec<Row> {
    let set_size = NUMBERS / SETS;
    let mut rows = Vec::new();
    for (sun, sample) in samples.iter().enumerate() {
        let beam = beam(first_slab + sun);
        // Every second azimuth tells enough.
        rows.extend((set * set_size..(set + 1) * set_size).step_by(2).filter_map(|i| {
            let view = view(beam, i);
            let opacity = beam.opacity(view.depth, view.mu);
            // The opacity waits in the weight.
            (opacity > 0.0).then(|| Row {
                view,
                cosine: i / AZIMUTHS % COSINES,
                sun,
                ln_radiance: f64::from(sample[i]) + beam.mu0.ln(),
                weight: opacity.ln(),
            })
        }));
    }
    let most = rows.iter().map(|row| row.ln_radiance + row.weight).fold(f64::MIN, f64::max);
    rows.retain(|row| row.ln_radiance + row.weight > most + LEAST.ln());
    rows.iter_mut().for_each(|row| row.weight = (0.25 * (row.ln_radiance + row.weight - most)).exp());
    rows
}
