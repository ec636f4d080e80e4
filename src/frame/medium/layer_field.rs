//! The numbers of a layer's field before they are ranked: a mixture of cells and of a Gaussian field, from a seed.

use std::f64::consts::TAU;

use glam::{DVec2, dvec2};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{RngCore, SeedableRng},
};
use rayon::prelude::*;

use super::layer_tile::{Key, TEXELS};
use crate::scene::Layer;

/// Amplitudes go as wave numbers to the power of minus this, that of surfaces of dimension 2.35.
const FALL: f64 = 1.65;
/// Power of the wave number that waves of stretched fields are stretched by on top.
const FIBROUS: f64 = 0.5;
/// How far places are moved, in scales, so that nothing is straight.
const WARP: f64 = 0.22;
/// What the Gaussian field has still got of the mixture where all is cells.
const TORN: f64 = 0.3;

/// Numbers from a seed.
struct Random(ChaCha8Rng);

impl Random {
    fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 2_f64.powi(32)
    }

    /// A pair of independent normal numbers (Box and Muller 1958).
    fn normal(&mut self) -> DVec2 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        let angle = TAU * self.unit();
        radius * dvec2(angle.cos(), angle.sin())
    }
}

/// How long a way is where what is stretched along a heading is as long as wide.
#[derive(Clone, Copy)]
struct Metric {
    along: DVec2,
    stretch: f64,
}

impl Metric {
    fn new(key: &Key) -> Self {
        let angle = key.heading_deg.to_radians();
        Self { along: dvec2(angle.sin(), -angle.cos()), stretch: key.stretch }
    }

    /// Of a way, squared.
    fn way(self, d: DVec2) -> f64 {
        let along = d.dot(self.along) / self.stretch;
        along * along + self.along.perp_dot(d).powi(2)
    }

    /// Of a wave, squared: those along the heading are longer, and fine ones more so, as fibres are.
    fn wave(self, k: DVec2) -> f64 {
        let across = self.along.perp_dot(k);
        let finer = across.abs().max(1.0).powf(FIBROUS * (1.0 - 1.0 / self.stretch));
        let along = k.dot(self.along) * self.stretch * finer;
        along * along + across * across
    }
}

/// The mixture of cells and a Gaussian field, row by row.
pub(super) fn mixture(key: &Key) -> Vec<f64> {
    let metric = Metric::new(key);
    let mut random = Random(ChaCha8Rng::seed_from_u64(u64::from(key.seed)));
    // Waves shorter than the scale fall off, longer ones are rare.
    let torn = |square: f64| square.powf(if square < 1.0 { 0.1 } else { -0.5 * FALL });
    let slow = |square: f64| (-2.0 * square).exp();
    let torn = gaussian(&mut random, metric, torn);
    let warps = [(); 2].map(|()| gaussian(&mut random, metric, slow));
    let points = points(&mut random, metric);
    let reach = 1.0 / Layer::PERIOD;
    let cell = |i: usize| {
        let place = dvec2((i % TEXELS) as f64 + 0.5, (i / TEXELS) as f64 + 0.5) / TEXELS as f64;
        let moved = dvec2(warps[0][i], warps[1][i]) * WARP * reach;
        from_walls(&points, metric, place + moved)
    };
    if key.cells <= 0.0 {
        return torn;
    }
    let cells: Vec<f64> = (0..TEXELS * TEXELS).into_par_iter().map(cell).collect();
    let (cells, share) = (normalised(cells), key.cells);
    cells.iter().zip(torn).map(|(cell, torn)| share * cell + (1.0 - (1.0 - TORN) * share) * torn).collect()
}

/// Points with room around each, by a metric: one for each cell of a period (Mitchell 1991).
fn points(random: &mut Random, metric: Metric) -> Vec<DVec2> {
    const CANDIDATES: usize = 8;
    let count = (Layer::PERIOD * Layer::PERIOD / metric.stretch).round().max(4.0) as usize;
    let mut points: Vec<DVec2> = Vec::with_capacity(count);
    for placed in 0..count {
        let mut best = (DVec2::ZERO, -1.0);
        for _ in 0..CANDIDATES * placed.max(1) / 4 + 1 {
            let place = dvec2(random.unit(), random.unit());
            let near = points.iter().map(|p| nearest(*p - place, metric)).fold(f64::INFINITY, f64::min);
            if near > best.1 {
                best = (place, near);
            }
        }
        points.push(best.0);
    }
    points
}

/// The shortest of the ways between two points of a square that repeats, squared.
fn nearest(d: DVec2, metric: Metric) -> f64 {
    let d = d - d.round();
    if metric.stretch < 1.5 {
        return metric.way(d);
    }
    // What is near along the heading may be farther off.
    let around = (-1..=1).flat_map(|x| (-1..=1).map(move |z| dvec2(f64::from(x), f64::from(z))));
    around.map(|shift| metric.way(d + shift)).fold(f64::INFINITY, f64::min)
}

/// How far from the walls of its cell a place is, over how far from its point: 0 at the walls, 1 at the point.
fn from_walls(points: &[DVec2], metric: Metric, place: DVec2) -> f64 {
    let (mut first, mut second) = (f64::INFINITY, f64::INFINITY);
    for point in points {
        let way = nearest(*point - place, metric);
        if way < first {
            (first, second) = (way, first);
        } else if way < second {
            second = way;
        }
    }
    1.0 - (first / second.max(1e-12)).sqrt()
}

/// A Gaussian field whose amplitude at a wave is `amplitude` of the square of its number by scale.
fn gaussian(random: &mut Random, metric: Metric, amplitude: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut waves = vec![DVec2::ZERO; TEXELS * TEXELS];
    let number = |i: usize| if i < TEXELS / 2 { i as f64 } else { i as f64 - TEXELS as f64 };
    for (i, wave) in waves.iter_mut().enumerate().skip(1) {
        let k = dvec2(number(i % TEXELS), number(i / TEXELS)) / Layer::PERIOD;
        *wave = random.normal() * amplitude(metric.wave(k));
    }
    waves.par_chunks_mut(TEXELS).for_each(transform);
    let mut turned = transposed(&waves);
    turned.par_chunks_mut(TEXELS).for_each(transform);
    normalised(transposed(&turned).into_iter().map(|value| value.x).collect())
}

fn transposed(values: &[DVec2]) -> Vec<DVec2> {
    (0..values.len()).map(|i| values[(i % TEXELS) * TEXELS + i / TEXELS]).collect()
}

/// The discrete Fourier transform of complex numbers, in place (Cooley and Tukey 1965).
fn transform(values: &mut [DVec2]) {
    let bits = values.len().ilog2();
    for i in 0..values.len() {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            values.swap(i, j);
        }
    }
    let mut half = 1;
    while half < values.len() {
        let turn = DVec2::from_angle(-std::f64::consts::PI / half as f64);
        for block in values.chunks_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            let mut phase = DVec2::X;
            for (a, b) in low.iter_mut().zip(high) {
                let turned = phase.rotate(*b);
                (*a, *b) = (*a + turned, *a - turned);
                phase = phase.rotate(turn);
            }
        }
        half *= 2;
    }
}

/// Mean 0, variance 1.
fn normalised(values: Vec<f64>) -> Vec<f64> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    let scale = 1.0 / variance.sqrt().max(1e-12);
    values.into_iter().map(|x| (x - mean) * scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_of_one_wave_is_one_number() {
        let mut wave: Vec<DVec2> =
            (0..8).map(|i| DVec2::from_angle(TAU * 3.0 * f64::from(i) / 8.0)).collect();
        transform(&mut wave);
        for (i, value) in wave.iter().enumerate() {
            let expected = if i == 3 { 8.0 } else { 0.0 };
            assert!((value.x - expected).abs() < 1e-12 && value.y.abs() < 1e-12, "{i}: {value}");
        }
    }
}
