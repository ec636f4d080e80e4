//! Light that bends around large particles: Fraunhofer's diffraction by discs of their shadows' areas.

use std::f64::consts::PI;

use super::droplets::GammaDistribution;

/// Radii of a distribution that are looked at.
const RADII: usize = 64;

/// Arguments from which on the rings of a disc are taken as their mean.
const FAR: f64 = 60.0;

/// Phase function of diffraction, 1/sr, at scattering angles `theta` in rad, by particles whose discs have radii of
/// the distribution, for a wavelength in micrometres.
///
/// A disc of size parameter x diffracts x^2 / (4 pi) (2 J1(x sin theta) / (x sin theta))^2 times the obliquity
/// (1 + cos theta)^2 / 4 (Kirchhoff's; van de Hulst 1957, section 8.31): it integrates to 1 for large x.
pub fn phase(distribution: &GammaDistribution, wavelength_um: f64, theta: &[f64]) -> Vec<f64> {
    let discs: Vec<(f64, f64)> = radii(distribution, RADII)
        .map(|(radius_um, area)| (2.0 * PI * radius_um / wavelength_um, area))
        .collect();
    let whole: f64 = discs.iter().map(|(_, area)| area).sum();
    let at = |theta: &f64| {
        let oblique = (0.5 * (1.0 + theta.cos())).powi(2);
        let disc = |(x, area): &(f64, f64)| area * x * x / (4.0 * PI) * disc(x * theta.sin());
        oblique * discs.iter().map(disc).sum::<f64>() / whole
    };
    theta.iter().map(at).collect()
}

/// `count` radii of a distribution, micrometres, even in the logarithm, and the share of all shadows that each stands for.
pub(super) fn radii(distribution: &GammaDistribution, count: usize) -> impl Iterator<Item = (f64, f64)> {
    let [low, high] = distribution.support_um();
    let step = (high / low).ln() / count as f64;
    let distribution = *distribution;
    (0..count).map(move |i| {
        let radius_um = low * ((i as f64 + 0.5) * step).exp();
        (radius_um, distribution.density(radius_um) * radius_um.powi(3))
    })
}

/// (2 J1(z) / z)^2 of z from 0 on; beyond [`FAR`] on average over its rings, 4 / (pi z^3).
fn disc(z: f64) -> f64 {
    if z > FAR {
        return 4.0 / (PI * z.powi(3));
    }
    if z < 1e-4 {
        return 1.0;
    }
    (2.0 * bessel_j1(z) / z).powi(2)
}

/// Bessel's J1 of z from 0 on, within 1e-7: Abramowitz and Stegun (1964), 9.4.4 and 9.4.6.
fn bessel_j1(z: f64) -> f64 {
    let series = |terms: &[f64], y: f64| terms.iter().rev().fold(0.0, |sum, term| sum * y + term);
    if z < 3.0 {
        let y = (z / 3.0).powi(2);
        let terms =
            [0.5, -0.562_499_85, 0.210_935_73, -0.039_542_89, 0.004_433_19, -0.000_317_61, 0.000_011_09];
        return z * series(&terms, y);
    }
    let y = 3.0 / z;
    let size =
        [0.797_884_56, 0.000_001_56, 0.016_596_67, 0.000_171_05, -0.002_495_11, 0.001_136_53, -0.000_200_33];
    let turn =
        [-2.356_194_49, 0.124_996_12, 0.000_056_50, -0.006_378_79, 0.000_743_48, 0.000_798_24, -0.000_291_66];
    series(&size, y) * (z + series(&turn, y)).cos() / z.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_function_is_that_of_tables() {
        // Zeros and values, Abramowitz and Stegun, tables 9.1 and 9.5.
        for (z, right) in
            [(1.0, 0.440_050_585_7), (3.0, 0.339_058_958_5), (3.831_705_97, 0.0), (10.0, 0.043_472_746_2)]
        {
            assert!((bessel_j1(z) - right).abs() < 1e-7, "{z}: {}", bessel_j1(z));
        }
    }

    #[test]
    fn diffraction_sums_to_one_and_its_first_ring_is_where_a_disc_has_it() {
        let distribution = GammaDistribution { effective_radius_um: 40.0, effective_variance: 0.1 };
        let theta: Vec<f64> =
            (0..200_000).map(|i| 0.5 * PI * ((f64::from(i) + 0.5) / 200_000.0).powi(2)).collect();
        let values = phase(&distribution, 0.55, &theta);
        let pairs = theta.windows(2).zip(values.windows(2));
        let sum: f64 = pairs.map(|(t, v)| PI * (v[0] * t[0].sin() + v[1] * t[1].sin()) * (t[1] - t[0])).sum();
        // Beyond a quarter turn, and by the obliquity, a disc of size parameter 460 loses less.
        assert!((sum - 1.0).abs() < 5e-3, "{sum}");
        assert!((disc(3.831_705_97)).abs() < 1e-12);
    }
}
