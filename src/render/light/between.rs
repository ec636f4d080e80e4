//! What layers above and below a cloud do to the light that comes to it: they take of the sky's and send it back, and scatter
//! down, or up, what they take of the sun's.
//!
//! How it works. On the scale of a cloud's surroundings a layer is a slab. Radiance goes along the six levels of the
//! directions that light is solved for ([`super::field`]), its mean over the azimuth; a column of a layer is a slab found by
//! doubling a thin one, a layer the mean of its columns, for the rank of its field tells how many there are of each
//! thickness, and what is above a cloud, or below it, is found by adding layers, with all that goes to and fro between them
//! (van de Hulst, "Multiple Light Scattering", 1980, chapter 4; Grant and Hunt 1969). A cloud that a layer goes around has the
//! part of it above its middle above itself. So the light that enters a cloud is a matrix times that of sky and ground, and a
//! vector times the sun's: the grid of the cloud has it at its faces.
//!
//! Why not the two-stream formulas that shadows on the ground take: thin layers shine most at their horizon, and half of what
//! comes to a ball comes from there.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::field::levels;
use crate::{
    frame::{
        CloudFrame,
        medium::{LayerShape, Medium, Species, smooth_rise},
    },
    optics::slab::angles::{Quadrature, legendre_polynomials},
};

/// Levels of a hemisphere, and of both.
const HALF: usize = 3;
pub(super) const LEVELS: usize = 2 * HALF;
/// Optical depth of the slab that is doubled.
const THIN: f64 = 1e-3;
/// Columns of a layer, and heights in each.
const COLUMNS: usize = 16;
const HEIGHTS: usize = 24;
/// Least cosine of the sun to the vertical: the light of one that grazes is no longer that of a plane.
const LEAST_COSINE: f64 = 0.02;
/// Mean of the noise that moves boundaries.
pub(super) const MEAN_NOISE: f64 = 0.5;
/// Layers thinner than this, in optical depth, are none.
const NOTHING: f64 = 1e-6;

/// What layers make of the light that comes to a cloud, by level of the directions that light is solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    /// What of the mean over the azimuth of each level is scattered to each: rows by the level that it goes to.
    pub rows: [[f32; LEVELS]; LEVELS],
    /// What of sky and ground comes straight through.
    pub through: [f32; LEVELS],
    /// Of the sun's light what is scattered to each, for each unit of its irradiance, 1/sr, and what comes straight through.
    pub sun: [f32; LEVELS],
    pub beam: f32,
}

impl Between {
    /// No layers.
    pub const NONE: Self =
        Self { rows: [[0.0; LEVELS]; LEVELS], through: [1.0; LEVELS], sun: [0.0; LEVELS], beam: 1.0 };

    /// The same for light of the sky, to which the sun is nothing.
    pub fn of_sky(self) -> Self {
        Self { sun: [0.0; LEVELS], beam: 0.0, ..self }
    }
}

/// What a slab makes of light that comes to one side of it: shares.
pub(super) struct Returned {
    /// Of a beam at a cosine of `mu` to the vertical: what comes out on its own side, and scattered on the other.
    pub back: f64,
    pub through: f64,
    /// Of diffuse light that is scattered at all: what comes out anywhere.
    pub diffuse: f64,
}

impl Returned {
    /// By a slab of `depth`, transported and upright, of a species.
    pub fn of(species: &Species, depth: f64, mu: f64) -> Self {
        let [cosines, weights] = hemisphere();
        let flux =
            |light: DVec3| -> f64 { (0..HALF).map(|i| TAU * weights[i] * cosines[i] * light[i]).sum() };
        let slab = Scattering::of(species, mu).slab(depth);
        let straight = flux(slab.through) / flux(DVec3::ONE);
        let out = flux((slab.onward[0] + slab.back[0]) * DVec3::ONE) / flux(DVec3::ONE);
        Self {
            back: flux(slab.up) / mu,
            through: flux(slab.down) / mu,
            diffuse: ((out - straight) / (1.0 - straight).max(NOTHING)).clamp(0.0, 1.0),
        }
    }
}

/// A part of a layer that lies above or below a cloud.
struct Part<'a> {
    cloud: &'a CloudFrame,
    shape: &'a LayerShape,
    /// Between these heights in its frame, m.
    heights: [f64; 2],
}

/// A layer among the clouds of a frame.
struct Stratum<'a> {
    number: usize,
    cloud: &'a CloudFrame,
    shape: &'a LayerShape,
    /// All of it.
    slab: Slab,
}

/// Layers among the clouds of a frame, from the top, in the light of a sun at the sine `elevation`.
pub(super) struct Strata<'a> {
    elevation: f64,
    strata: Vec<Stratum<'a>>,
}

impl<'a> Strata<'a> {
    /// Those of `clouds`; none where no other cloud is there for them.
    pub fn of(clouds: &'a [CloudFrame], elevation: f64) -> Self {
        let mu0 = elevation.abs().max(LEAST_COSINE);
        let stratum = |(number, cloud): (usize, &'a CloudFrame)| {
            let shape = cloud.medium.layer.as_ref()?;
            let slab = Part::whole(cloud, shape).slab(mu0);
            Some(Stratum { number, cloud, shape, slab })
        };
        let several = clouds.len() > 1;
        let mut strata: Vec<_> = clouds.iter().enumerate().filter(|_| several).filter_map(stratum).collect();
        strata.sort_by(|a, b| b.cloud.origin.y.total_cmp(&a.cloud.origin.y));
        Self { elevation, strata }
    }

    /// What they do to the light that comes to cloud `number`; none where there are no others.
    pub fn around(&self, number: usize, cloud: &CloudFrame) -> Option<Between> {
        let [mut above, mut below] = [true, false].map(|above| self.slabs(number, cloud, above));
        if above.is_empty() && below.is_empty() {
            return None;
        }
        // Down is the way that the sun's light goes.
        let is_turned = self.elevation < 0.0;
        if is_turned {
            std::mem::swap(&mut above, &mut below);
            above.reverse();
            below.reverse();
        }
        let stack = |slabs: Vec<Slab>| slabs.into_iter().fold(Slab::NONE, |above, slab| above.over(&slab));
        let (mut above, below) = (stack(above), stack(below));
        let Some(own) = self.strata.iter().find(|stratum| stratum.number == number) else {
            return Some(Meeting::of(&above, &below).told(&above, &below, is_turned));
        };
        // What stands before a layer is in a map, with what it scatters on.
        (above.beam, above.down) = (1.0, DVec3::ZERO);
        let over = Meeting::of(&above, &own.slab.over(&below));
        let meeting = Meeting { up: Meeting::of(&above.over(&own.slab), &below).up, ..over };
        Some(meeting.told(&above, &below, is_turned))
    }

    /// Other layers as far as they are above the middle of a cloud, or below it, from the top. Layers do not part each other.
    fn slabs(&self, number: usize, cloud: &CloudFrame, above: bool) -> Vec<Slab> {
        let mu0 = self.elevation.abs().max(LEAST_COSINE);
        let slab = |layer: &Stratum<'_>| {
            let half = layer.cloud.half.y;
            let middle = cloud.origin.y - layer.cloud.origin.y;
            let cut =
                if cloud.medium.layer.is_some() { half.copysign(middle) } else { middle.clamp(-half, half) };
            let heights = if above { [cut, half] } else { [-half, cut] };
            if heights[0] >= heights[1] {
                None
            } else if heights == [-half, half] {
                Some(layer.slab.clone())
            } else {
                Some(Part { cloud: layer.cloud, shape: layer.shape, heights }.slab(mu0))
            }
        };
        self.strata.iter().filter(|layer| layer.number != number).filter_map(slab).collect()
    }
}

impl<'a> Part<'a> {
    fn whole(cloud: &'a CloudFrame, shape: &'a LayerShape) -> Self {
        Self { cloud, shape, heights: [-cloud.half.y, cloud.half.y] }
    }

    /// The mean of its columns.
    fn slab(&self, mu0: f64) -> Slab {
        let coverage = self.shape.covered();
        let species = &self.cloud.medium.species;
        let medium = Scattering::of(species, mu0);
        let transported = f64::from((1.0 - species.truncated) * (1.0 - species.albedo * species.ahead));
        let columns = Quadrature::new(COLUMNS);
        let mut mean = Slab::NONE.times(1.0 - coverage);
        for (place, weight) in columns.mu.iter().zip(&columns.weight) {
            let length = column(self.shape, &self.cloud.medium, self.shape.excess(*place), self.heights);
            let depth = transported * f64::from(self.shape.uniform.extinction) * length;
            mean = mean.plus(&medium.slab(depth).times(coverage * weight));
        }
        mean
    }
}

/// Length of a column of full extinction that has as much of it as a layer has between two heights in its frame, m, where its
/// field is `excess` above where it begins.
fn column(shape: &LayerShape, medium: &Medium, excess: f64, [low, high]: [f64; 2]) -> f64 {
    let u = &shape.uniform;
    let [boundary, wispiness] = [u.boundary, u.wispiness].map(f64::from);
    let [above, below] = shape.heights(excess);
    let rim = f64::from(u.rim);
    let boundary = boundary.min(0.5 * (above + below));
    let rise = (boundary * (0.06 + 0.34 * wispiness)).max(1e-3);
    let moved = 0.5 * (boundary - rise).max(0.0) * (1.0 - MEAN_NOISE);
    let (low, high) = (low.max(rim - below), high.min(rim + above));
    let step = (high - low).max(0.0) / HEIGHTS as f64;
    let share = |i: usize| {
        let y = low + (i as f64 + 0.5) * step;
        let depth = (rim + above - y).min(y - rim + below) - moved;
        medium.body.kept(y, depth, boundary) * smooth_rise(depth / rise)
    };
    step * (0..HEIGHTS).map(share).sum::<f64>()
}

/// Cosines of the levels of a hemisphere to the vertical, and their weights, which add up to 1.
fn hemisphere() -> [[f64; HALF]; 2] {
    let all = levels();
    [std::array::from_fn(|i| all[i].0.abs()), std::array::from_fn(|i| all[i].1)]
}

/// What a medium scatters from level to level, for each unit of its optical depth.
struct Scattering {
    /// Into the same hemisphere, and into the other.
    onward: DMat3,
    back: DMat3,
    /// Of the beam of irradiance 1, 1/sr.
    beam: [DVec3; 2],
    mu0: f64,
}

impl Scattering {
    fn of(species: &Species, mu0: f64) -> Self {
        Self::new(species.beyond_ahead().map(|share| f64::from(share * species.albedo)), mu0)
    }

    /// By what share of the light of each degree is scattered.
    fn new(shares: [f64; 4], mu0: f64) -> Self {
        let [mu, weight] = hemisphere();
        let degrees = |x: f64| legendre_polynomials(x).take(shares.len()).collect::<Vec<_>>();
        let phase = |to: f64, from: f64| -> f64 {
            let pairs = degrees(to).into_iter().zip(degrees(from)).zip(shares).enumerate();
            pairs.map(|(l, ((a, b), share))| (2 * l + 1) as f64 * share * a * b).sum()
        };
        let matrix = |sign: f64| {
            DMat3::from_cols_array_2d(&std::array::from_fn(|from| {
                std::array::from_fn(|to| 0.5 * weight[from] * phase(sign * mu[to], mu[from]) / mu[to])
            }))
        };
        let beam = |sign: f64| {
            DVec3::from_array(mu.map(|to| phase(sign * to, mu0) / (4.0 * std::f64::consts::PI * to)))
        };
        Self { onward: matrix(1.0), back: matrix(-1.0), beam: [beam(1.0), beam(-1.0)], mu0 }
    }

    /// A slab of it, by doubling.
    fn slab(&self, depth: f64) -> Slab {
        if depth < NOTHING {
            return Slab::NONE;
        }
        let doublings = (depth / THIN).log2().ceil().max(0.0) as i32;
        let thin = depth / 2f64.powi(doublings);
        let lost = DMat3::from_diagonal(DVec3::from_array(hemisphere()[0]).recip());
        let through = DMat3::IDENTITY + thin * (self.onward - lost);
        let back = thin * self.back;
        let mut slab = Slab {
            onward: [through; 2],
            back: [back; 2],
            down: thin * self.beam[0],
            up: thin * self.beam[1],
            through: DVec3::ONE - thin * DVec3::from_array(hemisphere()[0]).recip(),
            beam: (-thin / self.mu0).exp(),
        };
        for _ in 0..doublings {
            slab = slab.over(&slab);
        }
        slab
    }
}

/// What a slab does to light, by level of a hemisphere.
#[derive(Debug, Clone, PartialEq)]
struct Slab {
    /// Of light that goes down, and up: what comes out on the other side, and what on the same.
    onward: [DMat3; 2],
    back: [DMat3; 2],
    /// Of the sun's, which goes down, for each unit of its irradiance: what comes out below and above.
    down: DVec3,
    up: DVec3,
    /// What is not scattered.
    through: DVec3,
    beam: f64,
}

impl Slab {
    const NONE: Self = Self {
        onward: [DMat3::IDENTITY; 2],
        back: [DMat3::ZERO; 2],
        down: DVec3::ZERO,
        up: DVec3::ZERO,
        through: DVec3::ONE,
        beam: 1.0,
    };

    fn times(&self, share: f64) -> Self {
        Self {
            onward: self.onward.map(|m| share * m),
            back: self.back.map(|m| share * m),
            down: share * self.down,
            up: share * self.up,
            through: share * self.through,
            beam: share * self.beam,
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            onward: [0, 1].map(|i| self.onward[i] + other.onward[i]),
            back: [0, 1].map(|i| self.back[i] + other.back[i]),
            down: self.down + other.down,
            up: self.up + other.up,
            through: self.through + other.through,
            beam: self.beam + other.beam,
        }
    }

    /// It on top of another.
    fn over(&self, other: &Self) -> Self {
        let Meeting { down, up } = Meeting::of(self, other);
        Self {
            onward: [other.onward[0] * down.above, self.onward[1] * up.below],
            back: [self.back[0] + self.onward[1] * up.above, other.back[1] + other.onward[0] * down.below],
            down: other.onward[0] * down.sun + self.beam * other.down,
            up: self.up + self.onward[1] * up.sun,
            through: self.through * other.through,
            beam: self.beam * other.beam,
        }
    }
}

/// Light at a place, as it comes from what enters from above all and from below all, and of the sun's.
struct Ways {
    above: DMat3,
    below: DMat3,
    sun: DVec3,
}

/// Light between two slabs.
struct Meeting {
    down: Ways,
    up: Ways,
}

impl Meeting {
    fn of(above: &Slab, below: &Slab) -> Self {
        let [up_to_down, down_to_up] = [above.back[1], below.back[0]];
        // What has gone to and fro.
        let all = (DMat3::IDENTITY - up_to_down * down_to_up).inverse();
        let sun_up = above.beam * below.up;
        let down = Ways {
            above: all * above.onward[0],
            below: all * up_to_down * below.onward[1],
            sun: all * (above.down + up_to_down * sun_up),
        };
        let up = Ways {
            above: down_to_up * down.above,
            below: down_to_up * down.below + below.onward[1],
            sun: down_to_up * down.sun + sun_up,
        };
        Self { down, up }
    }

    /// The same by level; `above` and `below` are what is between the place and the outside, and down is up where all `is_turned`.
    fn told(&self, above: &Slab, below: &Slab, is_turned: bool) -> Between {
        let all = levels();
        let mut told = Between { beam: above.beam as f32, ..Between::NONE };
        // Whether a level's light goes down, and its number in its hemisphere.
        let place = |level: usize| ((all[level].0 < 0.0) != is_turned, level.min(LEVELS - 1 - level));
        for to in 0..LEVELS {
            let (goes_down, row) = place(to);
            let (ways, through) = if goes_down { (&self.down, above) } else { (&self.up, below) };
            for from in 0..LEVELS {
                let (came_down, column) = place(from);
                let matrix = if came_down { ways.above } else { ways.below };
                let straight = if from == to { through.through[row] } else { 0.0 };
                told.rows[to][from] = (matrix.col(column)[row] - straight) as f32;
            }
            told.through[to] = through.through[row] as f32;
            told.sun[to] = ways.sun[row] as f32;
        }
        told
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ISOTROPIC: [f64; 4] = [1.0, 0.0, 0.0, 0.0];
    const FORWARD: [f64; 4] = [1.0, 0.6, 0.35, 0.15];

    /// Flux through a level plane of light by level.
    fn flux(light: DVec3) -> f64 {
        let [mu, weight] = hemisphere();
        (0..HALF).map(|i| TAU * weight[i] * mu[i] * light[i]).sum()
    }

    #[test]
    fn slabs_that_absorb_nothing_lose_no_light() {
        for shares in [ISOTROPIC, FORWARD] {
            for (depth, mu0) in [(0.1, 0.3), (1.0, 0.8), (30.0, 1.0), (4.0, 0.05)] {
                let slab = Scattering::new(shares, mu0).slab(depth);
                for from in [DVec3::ONE, DVec3::X, DVec3::Z] {
                    let out = flux(slab.onward[0] * from) + flux(slab.back[0] * from);
                    assert!((out / flux(from) - 1.0).abs() < 1e-9, "{shares:?} {depth}: {out}");
                }
                let out = flux(slab.down) + flux(slab.up) + mu0 * slab.beam;
                // The quadrature tells little of the beam's own angle, and thin slabs are first order.
                assert!(
                    (out / mu0 - 1.0).abs() < 0.01 / mu0.sqrt().min(1.0),
                    "{shares:?} {depth} {mu0}: {out}"
                );
            }
        }
    }

    #[test]
    fn as_much_diffuse_light_comes_through_as_heat_between_black_plates() {
        // Radiative equilibrium is scattering without absorption: Heaslet and Warming, "Radiative transport and wall
        // temperature slip in an absorbing planar medium", 1965, table 1. Six levels tell the light at the face no better.
        for (depth, wanted) in [(0.1, 0.9157), (0.5, 0.7042), (1.0, 0.5532), (2.0, 0.3900), (3.0, 0.3016)] {
            let slab = Scattering::new(ISOTROPIC, 1.0).slab(depth);
            let through = flux(slab.onward[0] * DVec3::ONE) / flux(DVec3::ONE);
            assert!((through - wanted).abs() < 0.012, "{depth}: {through} for {wanted}");
        }
    }

    #[test]
    fn parts_of_a_slab_add_up_to_it() {
        let medium = Scattering::new(FORWARD, 0.6);
        let (whole, parts) = (medium.slab(3.0), medium.slab(1.0).over(&medium.slab(2.0)));
        assert!((whole.down - parts.down).abs().max_element() < 2e-4);
        assert!((whole.up - parts.up).abs().max_element() < 2e-4);
        assert!((whole.onward[0] - parts.onward[0]).to_cols_array().iter().all(|x| x.abs() < 2e-3));
        assert!((whole.beam - parts.beam).abs() < 1e-9);
    }

    #[test]
    fn an_even_glow_stays_as_it_is_between_slabs() {
        let medium = Scattering::new(FORWARD, 0.6);
        let Meeting { down, up } = Meeting::of(&medium.slab(2.0), &medium.slab(0.7));
        for ways in [down, up] {
            let light = ways.above * DVec3::ONE + ways.below * DVec3::ONE;
            assert!((light - DVec3::ONE).abs().max_element() < 1e-6, "{light}");
        }
    }
}
