//! Where light enters that passes a depth in a slab: seeded random walks of photons.

use std::f64::consts::{PI, TAU};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;

use super::axes::{depth_at, point, sun_at, thickness_at};
use super::{Beam, SETS, set_of};
use crate::optics::peak::Chopped;

/// Depths at which photons are told, from face to face.
pub const PLANES: usize = 13;

/// Classes of the cosine of a photon's direction, even, from upward to downward.
pub const COSINES: usize = 12;

/// Classes of the azimuth of a photon's direction from the sun's, even from 0 to pi: the
/// slab is the same left and right.
pub const AZIMUTHS: usize = 8;

/// Thicknesses of the slabs that walks for tables go through, even in the logarithm.
pub const THICKNESSES: usize = 14;

/// Suns on these, as dense as those of tables.
pub const SUNS: usize = 8;

/// Photons in each of these slabs.
pub const PHOTONS: usize = 100_000;

/// Photons that share a stream of random numbers: the result doesn't depend on threads.
const STREAM: usize = 4096;

/// Steps in the table of scattering angles.
const ANGLES: usize = 8192;

/// Draws cosines of scattering angles by the inverse of their distribution.
#[derive(Debug, Clone)]
pub struct Deflection {
    /// Cosines below which 0, 1/n, 2/n... of the light is scattered.
    cosines: Vec<f64>,
}

impl Deflection {
    /// Of the droplets without their forward peak, in green.
    pub fn chopped(phase: &Chopped) -> Self {
        // Shares within rings that are even in the angle.
        let rings = 40_000;
        let step = PI / f64::from(rings);
        let mut within = vec![0.0];
        for ring in 0..rings {
            let theta = step * (f64::from(ring) + 0.5);
            within.push(within[within.len() - 1] + phase.wide(1, theta) * theta.sin());
        }
        let whole = within[within.len() - 1];
        let mut ring = 0;
        let cosines = (0..=ANGLES)
            .map(|i| {
                let share = point(i, ANGLES + 1) * whole;
                while ring + 2 < within.len() && within[ring + 1] < share {
                    ring += 1;
                }
                let part = (share - within[ring]) / (within[ring + 1] - within[ring]);
                (step * (ring as f64 + part.min(1.0))).cos()
            })
            .collect();
        Self { cosines }
    }

    fn cosine(&self, uniform: f64) -> f64 {
        let at = uniform * ANGLES as f64;
        let i = (at as usize).min(ANGLES - 1);
        let part = at - i as f64;
        self.cosines[i] * (1.0 - part) + self.cosines[i + 1] * part
    }
}

/// Photons of a class that passed a plane, and where they had entered as seen from there:
/// toward the sun along the slab, and to the side that their direction points to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Entries {
    /// How many.
    pub count: f64,
    /// Sum of their places toward the sun and to the side.
    pub sum: [f64; 2],
    /// Sum of the squares of these.
    pub square: [f64; 2],
}

impl Entries {
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        for i in 0..2 {
            self.sum[i] += other.sum[i];
            self.square[i] += other.square[i];
        }
    }

    /// Mean place, if there was any photon.
    pub fn mean(&self) -> Option<[f64; 2]> {
        (self.count > 0.0).then(|| self.sum.map(|sum| sum / self.count))
    }

    /// Sum over the photons of the squared distance from their mean, along each axis.
    pub fn scatter(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.square[i] - self.sum[i] * self.sum[i] / self.count.max(1.0)).max(0.0))
    }
}

/// The slab of walks for tables, number `job`: suns vary fastest.
pub fn beam(job: usize) -> Beam {
    Beam { thickness: thickness_at(point(job / SUNS, THICKNESSES)), mu0: sun_at(point(job % SUNS, SUNS)) }
}

/// What random walks in one slab told.
#[derive(Debug, Clone, PartialEq)]
pub struct Walks {
    /// The slab.
    pub beam: Beam,
    /// By set, plane, cosine, azimuth.
    entries: Vec<Entries>,
}

impl Walks {
    /// Lets `photons` photons walk through a slab, numbered by `seed` and `job`.
    pub fn new(deflection: &Deflection, beam: Beam, photons: usize, seed: u64, job: u64) -> Self {
        let planes: Vec<f64> = (0..PLANES).map(|i| depth_at(point(i, PLANES), beam.thickness)).collect();
        let streams: Vec<Vec<Entries>> = (0..photons.div_ceil(STREAM))
            .into_par_iter()
            .map(|stream| {
                let mut chance = ChaCha8Rng::seed_from_u64(seed);
                chance.set_stream(job << 32 | stream as u64);
                let mut walk = Walk { deflection, beam, planes: &planes, chance, entries: none() };
                (0..STREAM.min(photons - stream * STREAM)).for_each(|_| walk.photon());
                walk.entries
            })
            .collect();
        let mut entries = none();
        for stream in &streams {
            entries.iter_mut().zip(stream).for_each(|(sum, part)| sum.add(part));
        }
        Self { beam, entries }
    }

    /// The walks for tables, number `job`.
    pub fn for_tables(deflection: &Deflection, job: usize, seed: u64) -> Self {
        Self::new(deflection, beam(job), PHOTONS, seed, job as u64)
    }

    /// Its numbers, as bytes of a file.
    pub fn encode(&self) -> Vec<u8> {
        let beam = [self.beam.thickness, self.beam.mu0];
        let entries =
            self.entries.iter().flat_map(|e| [e.count, e.sum[0], e.sum[1], e.square[0], e.square[1]]);
        beam.into_iter().chain(entries).flat_map(f64::to_le_bytes).collect()
    }

    /// The inverse of [`Walks::encode`]; `None` where the length is wrong.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let (numbers, rest) = bytes.as_chunks();
        let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let ([thickness, mu0], entries) = numbers.split_first_chunk()?;
        let (entries, left) = entries.as_chunks();
        let entries: Vec<Entries> = entries
            .iter()
            .map(|[count, a, b, c, d]| Entries { count: *count, sum: [*a, *b], square: [*c, *d] })
            .collect();
        let whole = rest.is_empty() && left.is_empty() && entries.len() == none().len();
        whole.then_some(Self { beam: Beam { thickness: *thickness, mu0: *mu0 }, entries })
    }

    /// Photons counted at all planes together.
    pub fn photons_counted(&self) -> f64 {
        self.entries.iter().map(|entries| entries.count).sum()
    }

    /// Photons of a set that passed a plane in a class of directions.
    pub fn entries(&self, set: usize, plane: usize, cosine: usize, azimuth: usize) -> &Entries {
        &self.entries[place(set, plane, cosine, azimuth)]
    }
}

fn none() -> Vec<Entries> {
    vec![Entries::default(); SETS * PLANES * COSINES * AZIMUTHS]
}

fn place(set: usize, plane: usize, cosine: usize, azimuth: usize) -> usize {
    ((set * PLANES + plane) * COSINES + cosine) * AZIMUTHS + azimuth
}

/// Cosine in the middle of class `class`.
pub fn cosine_of(class: usize) -> f64 {
    2.0 * (class as f64 + 0.5) / COSINES as f64 - 1.0
}

/// Azimuth in the middle of class `class`, rad.
pub fn azimuth_of(class: usize) -> f64 {
    PI * (class as f64 + 0.5) / AZIMUTHS as f64
}

struct Walk<'a> {
    deflection: &'a Deflection,
    beam: Beam,
    planes: &'a [f64],
    chance: ChaCha8Rng,
    entries: Vec<Entries>,
}

impl Walk<'_> {
    /// Follows a photon until it leaves. Places and directions: along the sun's horizontal
    /// direction, across it, down.
    fn photon(&mut self) {
        let mu0 = self.beam.mu0;
        let mut direction = [(1.0 - mu0 * mu0).sqrt(), 0.0, mu0];
        let mut place = [0.0; 3];
        for order in 0.. {
            let flight = -(1.0 - self.uniform()).ln();
            let end: [f64; 3] = std::array::from_fn(|i| place[i] + flight * direction[i]);
            if order >= 2 {
                self.tell(set_of(order), place, end, direction);
            }
            if end[2] < 0.0 || end[2] > self.beam.thickness {
                return;
            }
            place = end;
            direction = self.turn(direction);
        }
    }

    /// Counts the planes between two places.
    fn tell(&mut self, set: usize, from: [f64; 3], to: [f64; 3], direction: [f64; 3]) {
        let cosine = (((direction[2] + 1.0) * 0.5 * COSINES as f64) as usize).min(COSINES - 1);
        let turned = direction[1].abs().atan2(direction[0]);
        let azimuth = ((turned / PI * AZIMUTHS as f64) as usize).min(AZIMUTHS - 1);
        let side = direction[1].signum();
        let (low, high) = (from[2].min(to[2]), from[2].max(to[2]));
        let first = self.planes.partition_point(|depth| *depth < low);
        for (plane, depth) in
            self.planes.iter().enumerate().skip(first).take_while(|(_, depth)| **depth <= high)
        {
            let part = (depth - from[2]) / direction[2];
            let toward_sun = from[0] + part * direction[0];
            let aside = -(from[1] + part * direction[1]) * side;
            self.entries[place(set, plane, cosine, azimuth)].add(&Entries {
                count: 1.0,
                sum: [toward_sun, aside],
                square: [toward_sun * toward_sun, aside * aside],
            });
        }
    }

    /// A direction after scattering.
    fn turn(&mut self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let uniform = self.uniform();
        let cosine = self.deflection.cosine(uniform);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (across, up) = (TAU * self.uniform()).sin_cos();
        let (across, up) = (sine * across, sine * up);
        // Two axes across the direction, after Duff and others (2017).
        let sign = 1.0_f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        [
            cosine * x + across * (1.0 + sign * x * x * a) + up * b,
            cosine * y + across * sign * b + up * (sign + y * y * a),
            cosine * z - across * sign * x - up * y,
        ]
    }

    /// From 0 to below 1.
    fn uniform(&mut self) -> f64 {
        (self.chance.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::phase::Phase;

    fn deflection() -> Deflection {
        Deflection::chopped(&Chopped::new(Phase::mie(6.0).unwrap()))
    }

    #[test]
    fn deflections_have_the_asymmetry_of_the_phase_function() {
        let (deflection, n) = (deflection(), 100_000);
        let mean = (0..n).map(|i| deflection.cosine((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>()
            / f64::from(n);
        let right = Chopped::new(Phase::mie(6.0).unwrap()).asymmetry[1];
        // Steps of the table.
        assert!((mean - right).abs() < 1e-4, "{mean} for {right}");
    }

    #[test]
    fn walks_are_the_same_for_any_number_of_threads() {
        let beam = Beam { thickness: 3.0, mu0: 0.5 };
        let walk = || Walks::new(&deflection(), beam, 10_000, 3, 1);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(walk);
        assert_eq!(alone, walk());
        assert_ne!(alone, Walks::new(&deflection(), beam, 10_000, 4, 1));
    }

    #[test]
    fn light_straight_from_above_enters_around_the_point() {
        let walks = Walks::new(&deflection(), Beam { thickness: 5.0, mu0: 1.0 }, 40_000, 1, 0);
        let mut all = Entries::default();
        for azimuth in 0..AZIMUTHS {
            for cosine in 0..COSINES {
                all.add(walks.entries(6, 6, cosine, azimuth));
            }
        }
        let [toward_sun, _] = all.mean().unwrap();
        let error = (all.scatter()[0] / all.count).sqrt() / 40_000_f64.sqrt();
        // Crossings of one photon hang together: ten of them count as one.
        assert!(toward_sun.abs() < 10.0 * error, "{toward_sun} +- {error}");
    }
}
