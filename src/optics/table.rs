//! Makes `tables/mie.bin`, which [`crate::tables`] reads.

use std::io::Write;
use std::path::Path;

use super::droplets::{self, Bulk, EFFECTIVE_VARIANCE, GammaDistribution, RADII};
use super::{WAVELENGTHS_UM, water};
use crate::tables::{MieEntry, MieTables};
use crate::{Result, files::write_whole};

/// The angles of the table: the end of a stretch and the step to it, in degrees.
///
/// The steps follow the curvature of the phase functions: the diffraction peak
/// (finest for 20 um and blue), the shoulder behind it, the bow of fog around
/// 140 degrees, the rings of the glory. Interpolation of P as well as of ln P is
/// within 0.5 % at every angle, radius and channel.
const ANGLES_DEG: [(f64, f64); 21] = [
    (0.3, 0.03),
    (1.0, 0.02),
    (1.6, 0.03),
    (2.0, 0.04),
    (3.0, 0.05),
    (4.0, 0.1),
    (6.0, 0.125),
    (8.0, 0.2),
    (12.0, 0.4),
    (20.0, 1.0),
    (30.0, 1.25),
    (60.0, 1.0),
    (90.0, 0.75),
    (110.0, 0.625),
    (130.0, 0.4),
    (135.0, 0.25),
    (150.0, 0.2),
    (170.0, 0.5),
    (176.0, 0.25),
    (178.0, 0.125),
    (180.0, 0.025),
];

/// Computes the Mie table and writes it to `path`, in one piece or not at all.
///
/// Takes some minutes on all cores. `progress` is called from any thread with
/// the share done so far, 0 to 1.
pub fn write_mie_table(path: &Path, progress: impl Fn(f64) + Sync) -> Result<()> {
    write_whole(path, |file| file.write_all(&mie_tables(&effective_radii_um(), RADII, progress).encode()))
}

/// Effective radii of the table in micrometres.
fn effective_radii_um() -> Vec<f64> {
    (4..=20).map(f64::from).collect()
}

/// Computes Mie tables of the effective radii in micrometres on the angles of
/// the file, each from at least `radii` sizes of sphere.
///
/// `progress` is called from any thread with the share done so far, 0 to 1.
pub fn mie_tables(effective_radii_um: &[f64], radii: usize, progress: impl Fn(f64) + Sync) -> MieTables {
    let theta_deg = angles_deg();
    let theta: Vec<f64> = theta_deg.iter().map(|angle| f64::from(*angle).to_radians()).collect();
    let distributions: Vec<GammaDistribution> = effective_radii_um
        .iter()
        .map(|&effective_radius_um| GammaDistribution {
            effective_radius_um,
            effective_variance: EFFECTIVE_VARIANCE,
        })
        .collect();
    let channel = |i: usize| {
        let index = water::refractive_index(i);
        droplets::average(&distributions, WAVELENGTHS_UM[i], index, &theta, radii, |share| {
            progress((i as f64 + share) / 3.0);
        })
    };
    let [red, green, blue] = [channel(0), channel(1), channel(2)];
    let rows = red.into_iter().zip(green).zip(blue);
    MieTables {
        theta_deg,
        effective_variance: EFFECTIVE_VARIANCE as f32,
        wavelengths_um: WAVELENGTHS_UM.map(|wavelength| wavelength as f32),
        entries: effective_radii_um
            .iter()
            .zip(rows)
            .map(|(&radius_um, ((red, green), blue))| entry(radius_um, [red, green, blue]))
            .collect(),
    }
}

/// One effective radius of the table.
fn entry(effective_radius_um: f64, channels: [Bulk; 3]) -> MieEntry {
    MieEntry {
        effective_radius_um: effective_radius_um as f32,
        q_ext: std::array::from_fn(|i| channels[i].q_ext as f32),
        asymmetry: std::array::from_fn(|i| channels[i].asymmetry as f32),
        absorption: std::array::from_fn(|i| channels[i].absorption as f32),
        phase: channels.map(|bulk| bulk.phase.into_iter().map(half::f16::from_f64).collect()),
    }
}

/// The angles of the table in degrees, from 0 to 180.
fn angles_deg() -> Vec<f32> {
    let mut angles = vec![0.0];
    let mut start = 0.0;
    for (end, step) in ANGLES_DEG {
        let steps = f64::round((end - start) / step) as u32;
        angles.extend((1..=steps).map(|i| (start + (end - start) * f64::from(i) / f64::from(steps)) as f32));
        start = end;
    }
    angles
}
