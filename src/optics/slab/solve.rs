//! The light in a slab, set of orders by set of orders, by successive orders of
//! scattering in discrete ordinates.
//!
//! The radiance of order n is the integral along each direction of what the radiance of
//! order n - 1 scatters there. Azimuths are Fourier modes, which do not mix; directions
//! within a mode are two Gauss rules, one a hemisphere; between levels the source is
//! linear. Orders below 16 come one from the other; all later ones together solve
//! (1 - K) x = K i, K being one scattering and one flight: for the mode without azimuth by
//! BiCGSTAB (van der Vorst 1992), for the others, which die out, by summing.

use std::f64::consts::PI;

use super::angles::{Quadrature, legendre_functions};
use super::depths::{Curvature, Layer, levels};
use super::{FIRST_ORDERS, Medium, SETS, set_of};

/// Directions in each hemisphere.
pub const STREAMS: usize = 48;

/// What is left of a sum of orders when it counts as whole, relative.
const CONVERGED: f64 = 1e-8;

/// A slab in the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Optical thickness along the normal, above 0.
    pub thickness: f64,
    /// Cosine of the sun's direction to the inward normal, above 0 to 1.
    pub mu0: f64,
}

impl Beam {
    /// 1 - e^-path, path being the optical path from `depth` against the direction of cosine
    /// `mu` to the face of the slab; 1 along the slab.
    pub fn opacity(&self, depth: f64, mu: f64) -> f64 {
        let path = if mu > 0.0 { depth } else { self.thickness - depth }.max(0.0);
        if mu.abs() < 1e-6 { 1.0 } else { -(-path / mu.abs()).exp_m1() }
    }
}

/// Solves slabs filled with one medium.
#[derive(Debug, Clone)]
pub struct Solver {
    medium: Medium,
    rule: Quadrature,
}

/// The light in one slab.
#[derive(Debug, Clone)]
pub struct Field {
    medium: Medium,
    beam: Beam,
    depths: Vec<f64>,
    modes: Vec<ModeField>,
}

/// Moments of the radiance that a set's orders are scattered from, of one Fourier mode:
/// for each set, for each level, for l from m up, int L_l^m I dmu.
#[derive(Debug, Clone)]
struct ModeField {
    moments: [Vec<f64>; SETS],
}

impl Solver {
    /// A solver for `medium`.
    pub fn new(medium: Medium) -> Self {
        Self { medium, rule: Quadrature::new(STREAMS) }
    }

    /// The highest moment of its medium, with which radiance is exact.
    pub fn degree(&self) -> usize {
        self.medium.degree()
    }

    /// The light of all sets in a slab, in Fourier modes 0 to `modes` of the azimuth. All
    /// moments up to degree `modes` are exact then; radiance needs those up to the medium's degree.
    pub fn solve(&self, beam: Beam, modes: usize) -> Field {
        let depths = levels(beam.thickness);
        let sweep = Sweep::new(&depths, &self.rule);
        let modes = (0..=modes.min(self.medium.degree()))
            .map(|m| Mode::new(m, &self.medium, &self.rule, &sweep).solve(beam, &depths))
            .collect();
        Field { medium: self.medium.clone(), beam, depths, modes }
    }
}

/// Flights through all layers, along all directions of a hemisphere.
struct Sweep {
    streams: usize,
    /// For each layer, for each direction.
    layers: Vec<Layer>,
    curvatures: Vec<Curvature>,
}

impl Sweep {
    fn new(depths: &[f64], rule: &Quadrature) -> Self {
        let layers = depths
            .windows(2)
            .flat_map(|pair| rule.mu.iter().map(move |mu| Layer::new(pair[1] - pair[0], *mu)))
            .collect();
        let curvatures = (0..depths.len() - 1).map(|k| Curvature::new(depths, k)).collect();
        Self { streams: rule.mu.len(), layers, curvatures }
    }

    /// Radiance from a source function, both by level and direction, light flying from the
    /// first level to the last.
    fn down(&self, source: &[f64]) -> Vec<f64> {
        let mut radiance = vec![0.0; source.len()];
        for k in 0..self.curvatures.len() {
            self.cross(source, &mut radiance, k, k, k + 1);
        }
        radiance
    }

    /// The same from the last level to the first.
    fn up(&self, source: &[f64]) -> Vec<f64> {
        let mut radiance = vec![0.0; source.len()];
        for k in (0..self.curvatures.len()).rev() {
            self.cross(source, &mut radiance, k, k + 1, k);
        }
        radiance
    }

    /// Light crosses layer `k` from level `from` to level `to`.
    fn cross(&self, source: &[f64], radiance: &mut [f64], k: usize, from: usize, to: usize) {
        let n = self.streams;
        let Curvature { first, weights } = self.curvatures[k];
        for (j, layer) in self.layers[k * n..(k + 1) * n].iter().enumerate() {
            let bend: f64 = (0..4).map(|i| weights[i] * source[(first + i) * n + j]).sum();
            radiance[to * n + j] = layer.through * radiance[from * n + j]
                + layer.near * source[from * n + j]
                + layer.far * source[to * n + j]
                + layer.bend * bend;
        }
    }
}

/// One Fourier mode of the azimuth.
struct Mode<'a> {
    m: usize,
    chi: &'a [f64],
    rule: &'a Quadrature,
    sweep: &'a Sweep,
    /// L_l^m at the downward directions, for l from m up.
    functions: Vec<Vec<f64>>,
}

impl<'a> Mode<'a> {
    fn new(m: usize, medium: &'a Medium, rule: &'a Quadrature, sweep: &'a Sweep) -> Self {
        let at: Vec<_> = rule.mu.iter().map(|mu| legendre_functions(m, medium.degree(), *mu)).collect();
        let functions = (0..=medium.degree() - m).map(|l| at.iter().map(|f| f[l]).collect()).collect();
        Self { m, chi: &medium.chi, rule, sweep, functions }
    }

    /// Number of moments: l from m to the degree.
    fn degrees(&self) -> usize {
        self.functions.len()
    }

    fn solve(&self, beam: Beam, depths: &[f64]) -> ModeField {
        let mut moments: [Vec<f64>; SETS] = Default::default();
        let mut order = self.scattered_once(beam, depths);
        let last = FIRST_ORDERS[SETS - 1];
        // `order` is the light of order n - 1, which order n is scattered from.
        for n in 2..last {
            add(&mut moments[set_of(n)], &order);
            order = self.scatter(&order);
        }
        moments[SETS - 1] = if self.m == 0 { self.all_later(order) } else { self.sum_later(order) };
        ModeField { moments }
    }

    /// Moments of the light scattered once, in closed form at each level.
    fn scattered_once(&self, beam: Beam, depths: &[f64]) -> Vec<f64> {
        let toward_sun = legendre_functions(self.m, self.m + self.degrees() - 1, beam.mu0);
        let strength: Vec<f64> = (0..self.degrees())
            .map(|l| {
                let degree = (self.m + l) as f64;
                (2.0 * degree + 1.0) / (4.0 * PI) * self.chi[self.m + l] * toward_sun[l]
            })
            .collect();
        let n = self.rule.mu.len();
        let mut down = vec![0.0; depths.len() * n];
        let mut up = down.clone();
        for j in 0..n {
            let (mut even, mut odd) = (0.0, 0.0);
            for (l, (strength, function)) in strength.iter().zip(&self.functions).enumerate() {
                let part = strength * function[j];
                if l % 2 == 0 { even += part } else { odd += part }
            }
            for (k, depth) in depths.iter().enumerate() {
                let (below, above) = single_scattering(beam, *depth, self.rule.mu[j]);
                down[k * n + j] = (even + odd) * below;
                up[k * n + j] = (even - odd) * above;
            }
        }
        self.moments(&down, &up)
    }

    /// Moments of the light that light of these moments becomes by one scattering and one flight.
    fn scatter(&self, moments: &[f64]) -> Vec<f64> {
        let (n, degrees) = (self.rule.mu.len(), self.degrees());
        let mut down = vec![0.0; moments.len() / degrees * n];
        let mut up = down.clone();
        let (mut even, mut odd) = (vec![0.0; n], vec![0.0; n]);
        for (k, level) in moments.chunks_exact(degrees).enumerate() {
            even.fill(0.0);
            odd.fill(0.0);
            for (l, moment) in level.iter().enumerate() {
                let degree = (self.m + l) as f64;
                let strength = 0.5 * (2.0 * degree + 1.0) * self.chi[self.m + l] * moment;
                let part = if l % 2 == 0 { &mut even } else { &mut odd };
                for (sum, function) in part.iter_mut().zip(&self.functions[l]) {
                    *sum += strength * function;
                }
            }
            for j in 0..n {
                down[k * n + j] = even[j] + odd[j];
                up[k * n + j] = even[j] - odd[j];
            }
        }
        self.moments(&self.sweep.down(&down), &self.sweep.up(&up))
    }

    /// int L_l^m I dmu at each level, for l from m up.
    fn moments(&self, down: &[f64], up: &[f64]) -> Vec<f64> {
        let n = self.rule.mu.len();
        let mut moments = Vec::with_capacity(down.len() / n * self.degrees());
        let (mut even, mut odd) = (vec![0.0; n], vec![0.0; n]);
        for (down, up) in down.chunks_exact(n).zip(up.chunks_exact(n)) {
            for j in 0..n {
                even[j] = self.rule.weight[j] * (down[j] + up[j]);
                odd[j] = self.rule.weight[j] * (down[j] - up[j]);
            }
            moments.extend(
                self.functions
                    .iter()
                    .enumerate()
                    .map(|(l, functions)| dot(functions, if l % 2 == 0 { &even } else { &odd })),
            );
        }
        moments
    }

    /// The sum of `order` and all later ones, term by term.
    fn sum_later(&self, mut order: Vec<f64>) -> Vec<f64> {
        let mut sum = order.clone();
        let start = norm(&order);
        while norm(&order) > CONVERGED * start {
            order = self.scatter(&order);
            add(&mut sum, &order);
        }
        sum
    }

    /// The sum of `order` and all later ones: x with x - K x = order.
    fn all_later(&self, order: Vec<f64>) -> Vec<f64> {
        let apply = |x: &[f64]| -> Vec<f64> {
            x.iter().zip(self.scatter(x)).map(|(x, scattered)| x - scattered).collect()
        };
        bicgstab(apply, order)
    }
}

/// Weights of the source of single scattering in the radiance at `depth`: downward at cosine
/// `mu`, and upward.
fn single_scattering(beam: Beam, depth: f64, mu: f64) -> (f64, f64) {
    let Beam { thickness, mu0 } = beam;
    // mu0 (e^{-depth/mu0} - e^{-depth/mu}) / (mu0 - mu), well behaved where they meet and
    // where either is beyond numbers.
    let (to_sun, back) = (depth / mu0, depth / mu);
    let difference = (to_sun - back).abs();
    let relative =
        if difference < 1e-6 { 1.0 - 0.5 * difference } else { -(-difference).exp_m1() / difference };
    let down = (-to_sun.min(back)).exp() * back * relative;
    let left = thickness - depth;
    let up = mu0 / (mu0 + mu) * (-depth / mu0).exp() * -(-left * (1.0 / mu0 + 1.0 / mu)).exp_m1();
    (down, up)
}

impl Field {
    /// The levels at which it is known.
    pub fn depths(&self) -> &[f64] {
        &self.depths
    }

    /// The slab and its sun.
    pub fn beam(&self) -> Beam {
        self.beam
    }

    /// What fills the slab.
    pub fn medium(&self) -> &Medium {
        &self.medium
    }

    /// The level at or before an optical depth, and the share of the way to the next.
    pub fn place(&self, depth: f64) -> (usize, f64) {
        let level = self.depths.partition_point(|level| *level <= depth).clamp(1, self.depths.len() - 1) - 1;
        let [low, high] = [self.depths[level], self.depths[level + 1]];
        (level, ((depth - low) / (high - low)).clamp(0.0, 1.0))
    }

    /// Moment (l, m) of the radiance that set `set` is scattered from, at level `level`:
    /// int L_l^m I^m dmu, where I = sum_m (2 - delta_m0) I^m cos m phi.
    pub fn moment(&self, set: usize, level: usize, l: usize, m: usize) -> f64 {
        let degrees = self.medium.degree() - m + 1;
        self.modes[m].moments[set][level * degrees + l - m]
    }

    /// Radiance of each set towards cosine `mu` and the azimuths `phi`, rad, at each level:
    /// C of \[K 3.25\], 1/sr, by azimuth and level.
    pub fn radiance(&self, set: usize, mu: f64, phi: &[f64]) -> Vec<Vec<f64>> {
        let mut sums = vec![vec![0.0; self.depths.len()]; phi.len()];
        for m in 0..self.modes.len() {
            let source = self.source(set, m, mu);
            let light = self.along(&source, mu);
            for (sum, phi) in sums.iter_mut().zip(phi) {
                let share = if m == 0 { 1.0 } else { 2.0 * (m as f64 * phi).cos() };
                sum.iter_mut().zip(&light).for_each(|(sum, light)| *sum += share * light);
            }
        }
        sums
    }

    /// Mean source function of each set that an eye sees which looks against `mu` and the
    /// azimuths `phi`, rad, by azimuth and level: radiance / (1 - e^-path), path being the
    /// optical path up to the face behind; the source function itself where that is 0. It is
    /// even where radiance is not, at the faces and for light along the slab.
    pub fn mean_source(&self, set: usize, mu: f64, phi: &[f64]) -> Vec<Vec<f64>> {
        let opacity: Vec<f64> = self.depths.iter().map(|depth| self.beam.opacity(*depth, mu)).collect();
        let mut sums = vec![vec![0.0; self.depths.len()]; phi.len()];
        for m in 0..self.modes.len() {
            let source = self.source(set, m, mu);
            let light = self.along(&source, mu);
            let mean = |i: usize| if opacity[i] > 0.0 { light[i] / opacity[i] } else { source[i] };
            let means: Vec<f64> = (0..opacity.len()).map(mean).collect();
            for (sum, phi) in sums.iter_mut().zip(phi) {
                let share = if m == 0 { 1.0 } else { 2.0 * (m as f64 * phi).cos() };
                sum.iter_mut().zip(&means).for_each(|(sum, mean)| *sum += share * mean);
            }
        }
        sums
    }

    /// Source function of a set in Fourier mode `m` towards cosine `mu`, at each level.
    fn source(&self, set: usize, m: usize, mu: f64) -> Vec<f64> {
        let degrees = self.medium.degree() - m + 1;
        let strength: Vec<f64> = legendre_functions(m, self.medium.degree(), mu)
            .into_iter()
            .enumerate()
            .map(|(l, function)| 0.5 * (2.0 * (m + l) as f64 + 1.0) * self.medium.chi[m + l] * function)
            .collect();
        self.modes[m].moments[set].chunks_exact(degrees).map(|level| dot(level, &strength)).collect()
    }

    /// Radiance at each level of a source function along the direction of cosine `mu`.
    fn along(&self, source: &[f64], mu: f64) -> Vec<f64> {
        if mu.abs() < 1e-6 {
            return source.to_vec();
        }
        let rule = Quadrature { mu: vec![mu.abs()], weight: vec![1.0] };
        let sweep = Sweep::new(&self.depths, &rule);
        if mu > 0.0 { sweep.down(source) } else { sweep.up(source) }
    }

    /// Flux of a set that leaves by the lit face and by the other, as a share of the sun's
    /// flux into the slab.
    pub fn fluxes(&self, set: usize) -> [f64; 2] {
        let rule = Quadrature::new(STREAMS);
        let mut fluxes = [0.0; 2];
        for (mu, weight) in rule.mu.iter().zip(&rule.weight) {
            let share = 2.0 * PI * mu * weight / self.beam.mu0;
            fluxes[0] += share * self.along(&self.source(set, 0, -mu), -mu)[0];
            fluxes[1] += share * self.along(&self.source(set, 0, *mu), *mu)[self.depths.len() - 1];
        }
        fluxes
    }

    /// The same of single scattering.
    pub fn single_fluxes(&self) -> [f64; 2] {
        let rule = Quadrature::new(STREAMS);
        let toward_sun = legendre_functions(0, self.medium.degree(), self.beam.mu0);
        let mut fluxes = [0.0; 2];
        for (mu, weight) in rule.mu.iter().zip(&rule.weight) {
            let share = 2.0 * PI * mu * weight / self.beam.mu0;
            let phase = |sign: f64| -> f64 {
                legendre_functions(0, self.medium.degree(), sign * mu)
                    .iter()
                    .zip(&toward_sun)
                    .zip(&self.medium.chi)
                    .enumerate()
                    .map(|(l, ((view, sun), chi))| (2.0 * l as f64 + 1.0) / (4.0 * PI) * chi * view * sun)
                    .sum()
            };
            let (_, up) = single_scattering(self.beam, 0.0, *mu);
            let (down, _) = single_scattering(self.beam, self.beam.thickness, *mu);
            fluxes[0] += share * phase(-1.0) * up;
            fluxes[1] += share * phase(1.0) * down;
        }
        fluxes
    }
}

fn add(sum: &mut Vec<f64>, part: &[f64]) {
    sum.resize(part.len(), 0.0);
    sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Solves A x = b by the stabilised biconjugate gradients of van der Vorst (1992), from x = b.
fn bicgstab(apply: impl Fn(&[f64]) -> Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    let combine =
        |a: &[f64], s: f64, b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + s * b).collect() };
    let mut x = b.clone();
    let mut residual = combine(&b, -1.0, &apply(&x));
    let shadow = residual.clone();
    let mut direction = residual.clone();
    let mut rho = dot(&shadow, &residual);
    let goal = CONVERGED * norm(&b);
    // Thick slabs take some hundreds of rounds.
    for _ in 0..5000 {
        if norm(&residual) <= goal || rho == 0.0 {
            break;
        }
        let image = apply(&direction);
        let alpha = rho / dot(&shadow, &image);
        let half = combine(&residual, -alpha, &image);
        let turned = apply(&half);
        let omega = dot(&turned, &half) / dot(&turned, &turned).max(f64::MIN_POSITIVE);
        x = combine(&combine(&x, alpha, &direction), omega, &half);
        residual = combine(&half, -omega, &turned);
        let next = dot(&shadow, &residual);
        let beta = next / rho * (alpha / omega);
        direction = combine(&residual, beta, &combine(&direction, -omega, &image));
        rho = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_scattering_is_finite_under_low_suns() {
        for mu0 in [0.017, 0.3, 1.0] {
            for depth in [0.0, 1e-9, 0.5, 400.0] {
                for mu in [1e-3, 0.3, 0.300_000_1, 1.0] {
                    let (down, up) = single_scattering(Beam { thickness: 400.0, mu0 }, depth, mu);
                    assert!((0.0..=1.0).contains(&down) && (0.0..=1.0).contains(&up), "{mu0} {depth} {mu}");
                }
            }
        }
    }
}
