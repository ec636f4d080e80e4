//! What fills a slab: droplets that absorb nothing, as the Legendre moments of their
//! phase function.

use std::f64::consts::PI;

use super::angles::{Quadrature, legendre_polynomials, legendre_series};
use crate::optics::peak::Chopped;

/// Parts of the square root of the angle, and points of each, over which moments are summed:
/// tabulated phase functions bend at a thousand angles.
const PARTS: usize = 250;
const POINTS: usize = 16;

/// A conservative medium, known by its phase function.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Legendre moments: chi_l = int P P_l(cos theta) over the sphere. The first is 1, the
    /// second is the mean cosine.
    pub chi: Vec<f64>,
}

impl Medium {
    /// The medium of phase function `phase`, 1/sr at an angle in rad, up to moment `degree`.
    pub fn new(phase: impl Fn(f64) -> f64, degree: usize) -> Self {
        let [medium] = Self::of_channels(|theta| [phase(theta)], degree);
        medium
    }

    /// The media of several channels, whose phase functions `phase` gives together.
    pub fn of_channels<const N: usize>(phase: impl Fn(f64) -> [f64; N], degree: usize) -> [Self; N] {
        // Even in the square root of the angle: the forward lobe is where moments are made.
        let rule = Quadrature::composite(PARTS, POINTS);
        let mut sums = vec![[0.0; N]; degree + 1];
        for (x, weight) in rule.mu.iter().zip(&rule.weight) {
            let theta = PI * x * x;
            let around = weight * 2.0 * PI * x * 2.0 * PI * theta.sin();
            let shares = phase(theta).map(|value| around * value);
            for (moments, value) in sums.iter_mut().zip(legendre_polynomials(theta.cos())) {
                for (moment, share) in moments.iter_mut().zip(shares) {
                    *moment += share * value;
                }
            }
        }
        let whole = sums[0];
        std::array::from_fn(|i| Self { chi: sums.iter().map(|moments| moments[i] / whole[i]).collect() })
    }

    /// Droplets without their forward peak, as green light sees them.
    pub fn chopped(phase: &Chopped, degree: usize) -> Self {
        Self::new(|theta| phase.wide(1, theta), degree)
    }

    /// Henyey and Greenstein's phase function of mean cosine `g`: chi_l = g^l.
    pub fn henyey_greenstein(g: f64, degree: usize) -> Self {
        Self { chi: (0..=degree).map(|l| g.powi(l as i32)).collect() }
    }

    /// The highest moment.
    pub fn degree(&self) -> usize {
        self.chi.len() - 1
    }

    /// Its phase function, 1/sr, at the cosine of a scattering angle, as far as the moments tell.
    pub fn phase(&self, cosine: f64) -> f64 {
        let term = |(l, chi): (usize, &f64)| (2.0 * l as f64 + 1.0) / (4.0 * PI) * chi;
        let terms: Vec<f64> = self.chi.iter().enumerate().map(term).collect();
        legendre_series(&terms, cosine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::phase::{Phase, henyey_greenstein};

    #[test]
    fn moments_of_henyey_greenstein_are_powers_of_g() {
        let medium = Medium::new(|theta| henyey_greenstein(0.85, theta), 60);
        let exact = Medium::henyey_greenstein(0.85, 60);
        for (l, (found, right)) in medium.chi.iter().zip(&exact.chi).enumerate() {
            assert!((found - right).abs() < 1e-9, "l {l}: {found} for {right}");
        }
    }

    #[test]
    fn asymmetry_of_droplets_is_that_of_their_antiderivatives() {
        for radius_um in [4.0, 6.5, 20.0] {
            let chopped = Chopped::new(Phase::mie(radius_um).unwrap());
            let asymmetry = Medium::chopped(&chopped, 4).chi[1];
            // What the bends of a thousand stretches leave.
            assert!((asymmetry - chopped.asymmetry[1]).abs() < 2e-7, "{radius_um} um: {asymmetry}");
        }
    }

    #[test]
    fn channels_summed_together_are_those_summed_alone() {
        let one = |g: f64| Medium::new(|theta| henyey_greenstein(g, theta), 9);
        let both = Medium::of_channels(|theta| [0.3, 0.8].map(|g| henyey_greenstein(g, theta)), 9);
        assert_eq!(both, [one(0.3), one(0.8)]);
    }

    #[test]
    fn moments_give_the_phase_function_back() {
        let medium = Medium::henyey_greenstein(0.6, 80);
        for theta in [0.0_f64, 0.4, 1.5, 3.0] {
            let right = henyey_greenstein(0.6, theta);
            assert!((medium.phase(theta.cos()) - right).abs() < 1e-9 * right.max(1.0), "{theta}");
        }
    }
}
