//! What slabs do to light along the levels of the directions that light is solved for, its mean over the azimuth: found by
//! doubling a thin one, and put together by adding (van de Hulst, "Multiple Light Scattering", 1980, chapter 4; Grant and
//! Hunt 1969).

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::super::field::levels;
use crate::{frame::medium::Species, optics::slab::angles::legendre_polynomials};

/// Levels of a hemisphere, and of both.
const HALF: usize = 3;
pub(super) const LEVELS: usize = 2 * HALF;
/// Optical depth of the slab that is doubled.
const THIN: f64 = 1e-3;
/// Layers thinner than this, in optical depth, are none.
const NOTHING: f64 = 1e-6;

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

/// Cosines of the levels of a hemisphere to the vertical, and their weights, which add up to 1.
fn hemisphere() -> [[f64; HALF]; 2] {
    let all = levels();
    [std::array::from_fn(|i| all[i].0.abs()), std::array::from_fn(|i| all[i].1)]
}

/// What a medium scatters from level to level, for each unit of its optical depth.
pub(super) struct Scattering {
    /// Into the same hemisphere, and into the other.
    onward: DMat3,
    back: DMat3,
    /// Of the beam of irradiance 1, 1/sr.
    beam: [DVec3; 2],
    mu0: f64,
}

impl Scattering {
    pub fn of(species: &Species, mu0: f64) -> Self {
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
    pub fn slab(&self, depth: f64) -> Slab {
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
pub(super) struct Slab {
    /// Of light that goes down, and up: what comes out on the other side, and what on the same.
    pub onward: [DMat3; 2],
    pub back: [DMat3; 2],
    /// Of the sun's, which goes down, for each unit of its irradiance: what comes out below and above.
    pub down: DVec3,
    pub up: DVec3,
    /// What is not scattered.
    pub through: DVec3,
    pub beam: f64,
}

impl Slab {
    pub const NONE: Self = Self {
        onward: [DMat3::IDENTITY; 2],
        back: [DMat3::ZERO; 2],
        down: DVec3::ZERO,
        up: DVec3::ZERO,
        through: DVec3::ONE,
        beam: 1.0,
    };

    pub fn times(&self, share: f64) -> Self {
        Self {
            onward: self.onward.map(|m| share * m),
            back: self.back.map(|m| share * m),
            down: share * self.down,
            up: share * self.up,
            through: share * self.through,
            beam: share * self.beam,
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
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
    pub fn over(&self, other: &Self) -> Self {
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
pub(super) struct Ways {
    pub above: DMat3,
    pub below: DMat3,
    pub sun: DVec3,
}

/// Light between two slabs.
pub(super) struct Meeting {
    pub down: Ways,
    pub up: Ways,
}

impl Meeting {
    pub fn of(above: &Slab, below: &Slab) -> Self {
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
