//! The refractive index of liquid water in visible light.

use std::f64::consts::PI;

use super::WAVELENGTHS_UM;

/// A complex refractive index n + i k, relative to vacuum; k > 0 absorbs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefractiveIndex {
    /// Real part: how much slower light travels.
    pub n: f64,
    /// Imaginary part: how fast it fades.
    pub k: f64,
}

/// Absorption coefficients of pure water at 650, 550 and 450 nm in 1/m:
/// Pope and Fry, Applied Optics 36 (1997), table 3.
const ABSORPTION: [f64; 3] = [0.340, 0.0565, 0.009_22];

/// Amplitudes and squared resonance wavelengths (um^2) of distilled water at
/// 20.0 degrees Celsius: Daimon and Masumura, Applied Optics 46 (2007), table 7.
const SELLMEIER: [(f64, f64); 4] = [
    (5.684_027_565e-1, 5.101_829_712e-3),
    (1.726_177_391e-1, 1.821_153_936e-2),
    (2.086_189_578e-2, 2.620_722_293e-2),
    (1.130_748_688e-1, 1.069_792_721e1),
];

/// Refractive index of water at 20 degrees Celsius for a channel (0 red, 1
/// green, 2 blue), at its wavelength in [`WAVELENGTHS_UM`].
///
/// # Panics
/// If `channel` is not 0, 1 or 2.
pub fn refractive_index(channel: usize) -> RefractiveIndex {
    let wavelength_um = WAVELENGTHS_UM[channel];
    RefractiveIndex {
        n: real_part(wavelength_um),
        k: ABSORPTION[channel] * wavelength_um * 1e-6 / (4.0 * PI),
    }
}

/// Real part of the refractive index at a wavelength between 0.182 and 1.129
/// um, by the dispersion formula of Daimon and Masumura (2007).
pub(super) fn real_part(wavelength_um: f64) -> f64 {
    let squared = wavelength_um * wavelength_um;
    let sum: f64 =
        SELLMEIER.iter().map(|(amplitude, resonance)| amplitude * squared / (squared - resonance)).sum();
    (1.0 + sum).sqrt()
}
