//! A species: a kind of particles as the shaders take it, a few numbers and a table of the phase
//! function split into its forward peak and the rest.

use std::{
    f64::consts::PI,
    sync::{Mutex, PoisonError},
};

use half::f16;
use rayon::prelude::*;

use crate::{
    Result,
    frame::Shared,
    gpu,
    optics::{
        peak::Chopped,
        phase::{Phase, angle_at},
        slab::{Medium, angles::legendre_polynomials, axes::path_at, moments},
        widening::Widening,
    },
    scene::{self, Droplets},
};

/// Texels of the phase table along the scattering angle; `phase_coordinate` of
/// `shaders/lib/phase.wgsl` tells which angle each one holds.
const ANGLES: usize = 1024;

/// `Species` of `shaders/lib/species.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SpeciesUniform {
    pub(crate) truncated: f32,
    pub(crate) asymmetry: f32,
    pub(crate) albedo: f32,
    pub(crate) similarity: f32,
    pub(crate) degrees: [f32; 4],
    pub(crate) ahead: f32,
    padding: [f32; 3],
}

/// The optics of particles. Absorption and the forward peak are taken out of the medium
/// together: of the extinction k, the peak takes albedo * f * k, and what is left scatters
/// less than it removes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Species {
    /// What it is the optics of, however many of them there are.
    pub droplets: Droplets,
    /// Share of extinction in the forward peak that transport leaves out.
    pub truncated: f32,
    /// Asymmetry of the phase function without its peak, green.
    pub asymmetry: f32,
    /// Single-scattering albedo of the medium without the peak.
    pub albedo: f32,
    /// Rows of RGB and one unused, per steradian: albedo times phase function of the medium without peak, and the peak
    /// itself, normalised, as it is by how often light is scattered in it ([`PEAKS`]).
    pub table: Vec<[f16; 4]>,
    /// Optical depth in the medium of the slab table that is like one of this: what scatters
    /// more sharply forward counts for less.
    pub similarity: f32,
    /// Legendre moments of the phase function over those of the slab table's, degree 0 to 3.
    pub degrees: [f32; 4],
    /// The remainder of small angles, [`moments::remainder`]: RGB and one unused, per steradian,
    /// by rows of optical depth.
    pub remainder: Vec<[f16; 4]>,
    /// Legendre moments of the phase function without its peak, degree 0 to 3, green, and
    /// the next one, which light that is solved for on a grid takes as going straight on.
    pub chi: [f32; 4],
    pub ahead: f32,
    /// The same as `remainder` beyond such a grid: what went straight on there, too.
    pub beyond: Vec<[f16; 4]>,
}

/// Rows of the peak by its optical depth, `peak_coordinate` of `shaders/lib/phase.wgsl`: `PEAKS` there.
pub(crate) const PEAKS: usize = 6;
/// The optical depth of the last one, which stands for any greater: almost no light goes through it in the peak alone.
const DEEPEST_PEAK: f64 = 24.0;

/// Texels of the remainder along the scattering angle and along the optical depth.
const REMAINDER: [usize; 2] = [256, 48];

/// How many moments of a phase function the remainder is made of: droplets without their peak
/// have none to speak of after 64, bows and halos some, and Henyey-Greenstein's are powers of g.
fn degree(phase: &Phase, droplets: &Droplets) -> usize {
    match phase {
        Phase::Tabulated(_) if droplets.species != scene::Species::Water => 200,
        Phase::HenyeyGreenstein { g } => (1e-3_f64.ln() / g.abs().max(0.1).ln()).clamp(8.0, 400.0) as usize,
        Phase::Isotropic => 8,
        Phase::Tabulated(_) => 64,
    }
}

/// Legendre moments, degree 1 to 3, of the medium that the slab table is made of: green light
/// in droplets of 6 um without their peak.
const TABLE_MOMENTS: [f64; 3] = [0.733_771, 0.605_432, 0.383_264];

/// Optics of clouds seen lately: making them takes some milliseconds, and a frame is made
/// for each picture.
static KNOWN: Mutex<Vec<(Droplets, Shared<Species>)>> = Mutex::new(Vec::new());
const MOST_KNOWN: usize = 32;

impl Species {
    /// The optics of `droplets`, the same every time, however many of them there are.
    pub fn of(droplets: &Droplets) -> Result<Shared<Self>> {
        let droplets = &Droplets { concentration_per_cm3: 0.0, mass_g_per_m3: None, ..droplets.clone() };
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, optics)) = known.iter().find(|(other, _)| other == droplets) {
            return Ok(optics.clone());
        }
        let optics = Shared::new(Self::new(droplets)?);
        known.truncate(MOST_KNOWN - 1);
        known.insert(0, (droplets.clone(), optics.clone()));
        Ok(optics)
    }

    fn new(droplets: &Droplets) -> Result<Self> {
        let chopped = Chopped::new(Phase::of(droplets)?);
        let truncated = droplets.albedo * chopped.f;
        let wide = |channel, theta| droplets.albedo * chopped.wide(channel, theta) / (1.0 - truncated);
        let is_sharp = droplets.species != scene::Species::Water;
        let row = |value: &dyn Fn(usize, f64) -> f64| -> Vec<[f16; 4]> {
            let texel = |theta| {
                rgb([0, 1, 2].map(|channel| {
                    if is_sharp {
                        over_disc(|theta| value(channel, theta), theta)
                    } else {
                        value(channel, theta)
                    }
                }))
            };
            angles(ANGLES).map(texel).collect()
        };
        let peaks = peaks(&chopped, is_sharp, &row);
        let degree = degree(chopped.phase(), droplets);
        let media =
            Medium::of_channels(|theta| [0, 1, 2].map(|channel| chopped.wide(channel, theta)), degree);
        let tables = Remainders::new(degree);
        let albedo = droplets.albedo * (1.0 - chopped.f) / (1.0 - truncated);
        let g = chopped.asymmetry[1];
        let over_table = |l: usize| (media[1].chi[l] / TABLE_MOMENTS[l - 1]) as f32;
        Ok(Self {
            droplets: droplets.clone(),
            similarity: ((1.0 - g) / (1.0 - TABLE_MOMENTS[0])) as f32,
            degrees: [1.0, over_table(1), over_table(2), over_table(3)],
            remainder: tables.table(&media, moments::remainder_moments),
            chi: [0, 1, 2, 3].map(|l| media[1].chi[l] as f32),
            ahead: ahead(&media[1]) as f32,
            beyond: tables.table(&media, |medium, path| {
                moments::moments_beyond(medium, albedo, ahead(&media[1]), path)
            }),
            truncated: truncated as f32,
            asymmetry: chopped.asymmetry[1] as f32,
            albedo: albedo as f32,
            table: [row(&wide), peaks].concat(),
        })
    }

    /// What of each degree 0 to 3 is scattered, but for absorption, per unit of the extinction that does not
    /// go straight on: (chi_l - chi_4) / (1 - albedo chi_4).
    pub fn beyond_ahead(&self) -> [f32; 4] {
        self.chi.map(|chi| (chi - self.ahead) / (1.0 - self.albedo * self.ahead))
    }

    /// What shaders take of it beside tables.
    pub fn uniform(&self) -> SpeciesUniform {
        SpeciesUniform {
            truncated: self.truncated,
            asymmetry: self.asymmetry,
            albedo: self.albedo,
            similarity: self.similarity,
            degrees: self.degrees,
            ahead: self.albedo * self.ahead,
            padding: [0.0; 3],
        }
    }

    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> SpeciesTextures {
        let upload = |label, width: usize, texels: &[[f16; 4]]| {
            let size = [width as u32, (texels.len() / width) as u32, 0];
            gpu::half_texture(device, queue, label, size, texels).create_view(&Default::default())
        };
        SpeciesTextures {
            phase: upload("phase table", ANGLES, &self.table),
            #[cfg(feature = "slabs")]
            remainder: upload("slab remainder", REMAINDER[0], &self.remainder),
            beyond: upload("remainder beyond the grid", REMAINDER[0], &self.beyond),
        }
    }
}

/// The tables of a cloud's optics on a device.
pub(crate) struct SpeciesTextures {
    pub phase: wgpu::TextureView,
    #[cfg(feature = "slabs")]
    pub remainder: wgpu::TextureView,
    pub beyond: wgpu::TextureView,
}

/// Rows of the peak. Those of what is larger than droplets are narrower than the sun's disc, and stay as they are.
fn peaks(
    chopped: &Chopped,
    is_sharp: bool,
    row: &(impl Fn(&dyn Fn(usize, f64) -> f64) -> Vec<[f16; 4]> + Sync),
) -> Vec<[f16; 4]> {
    let peak = |channel: usize, theta: f64| chopped.peak(channel, theta).max(0.0) / chopped.f.max(1e-9);
    if is_sharp || chopped.f == 0.0 {
        return row(&peak).repeat(PEAKS);
    }
    let channels: [_; 3] = std::array::from_fn(|channel| {
        Widening::new(move |theta| peak(channel, theta), chopped.cut_deg[channel].to_radians())
    });
    let after = |number: usize| {
        let share = number as f64 / (PEAKS - 1) as f64;
        let depth = (2.0 * share / (1.0 - share)).min(DEEPEST_PEAK);
        let widened = channels.each_ref().map(|channel| channel.after(depth));
        row(&|channel, theta| widened[channel].at(theta))
    };
    (0..PEAKS).into_par_iter().flat_map_iter(after).collect()
}

/// What of the extinction goes straight on when degrees 0 to 3 tell the phase function: the
/// next moment (delta-M, Wiscombe 1977), but no more than leaves all of them between -1 and 1.
fn ahead(medium: &Medium) -> f64 {
    let most = medium.chi[..4].iter().map(|chi| 0.5 * (1.0 + chi)).fold(1.0, f64::min);
    medium.chi[4].clamp(0.0, most)
}

/// Makes tables of small-angle remainders.
struct Remainders {
    /// Legendre polynomials by degree, for the scattering angle of each column.
    polynomials: Vec<Vec<f64>>,
}

impl Remainders {
    /// For terms up to `degree`.
    fn new(degree: usize) -> Self {
        let column = |theta: f64| legendre_polynomials(theta.cos()).take(degree + 1).collect();
        Self { polynomials: angles(REMAINDER[0]).map(column).collect() }
    }

    /// The remainder of red, green and blue by rows of optical depth, whose places
    /// `slab_path_coordinate` of `shaders/lib/slab.wgsl` tells, from its terms by degree.
    fn table(&self, media: &[Medium; 3], terms: impl Fn(&Medium, f64) -> Vec<f64> + Sync) -> Vec<[f16; 4]> {
        let height = REMAINDER[1];
        let row = |row: usize| {
            let coordinate = (row as f64 + 0.5) / height as f64;
            let path = path_at(coordinate);
            let terms = media.each_ref().map(|medium| terms(medium, path));
            self.polynomials.iter().map(move |values| rgb(series(&terms, values)))
        };
        (0..height).into_par_iter().flat_map_iter(row).collect()
    }
}

/// Sums over the degrees of the terms of each channel times the polynomials' values.
fn series(terms: &[Vec<f64>; 3], polynomials: &[f64]) -> [f64; 3] {
    let [red, green, blue] = terms;
    let mut sums = [0.0; 3];
    for (((value, red), green), blue) in polynomials.iter().zip(red).zip(green).zip(blue) {
        sums[0] += red * value;
        sums[1] += green * value;
        sums[2] += blue * value;
    }
    sums
}

/// Angular radius of the sun's disc as it is seen from the earth, rad.
const SUN: f64 = 0.004_65;

/// The mean of a function of the scattering angle over the sun's disc, whose middle is seen at `theta`, rad: what large
/// particles scatter changes over angles that are finer than the disc, around the sun, at bows and halos. The path tracer
/// does the same with points of the disc by chance.
///
/// Of each ring of scattering angles counts the arc that is in the disc; rings are densest at the least angle, where
/// diffraction may be narrower than a minute of arc.
fn over_disc(value: impl Fn(f64) -> f64, theta: f64) -> f64 {
    let count = if theta < 4.0 * SUN { 192 } else { 48 };
    let (low, high) = ((theta - SUN).max(0.0), (theta + SUN).min(PI));
    let (mut sum, mut whole) = (0.0, 0.0);
    for i in 0..count {
        let share = (f64::from(i) + 0.5) / f64::from(count);
        let angle = low + (high - low) * share * share;
        let arc = (SUN.cos() - theta.cos() * angle.cos()) / (theta.sin() * angle.sin()).max(1e-30);
        let weight = share * angle.sin() * arc.clamp(-1.0, 1.0).acos();
        sum += weight * value(angle);
        whole += weight;
    }
    sum / whole
}

/// Scattering angles, rad, of the columns of a table that is `columns` wide.
fn angles(columns: usize) -> impl Iterator<Item = f64> {
    (0..columns).map(move |i| angle_at((i as f64 + 0.5) / columns as f64))
}

/// A texel of three channels; green stands in the fourth, too.
fn rgb([red, green, blue]: [f64; 3]) -> [f16; 4] {
    [red, green, blue, green].map(f16::from_f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_over_the_tables_are_those_of_its_own_medium() {
        let optics = Species::new(&Droplets::default()).unwrap();
        assert!(optics.degrees.iter().all(|ratio| (ratio - 1.0).abs() < 1e-5), "{:?}", optics.degrees);
        assert!((optics.similarity - 1.0).abs() < 1e-4, "{}", optics.similarity);
    }

    #[test]
    fn the_suns_disc_keeps_all_light_and_what_goes_evenly() {
        for theta in [0.0, 0.001, 0.0046, 0.02, 0.4, 2.4, PI - 0.003, PI] {
            assert!((over_disc(|_| 3.0, theta) - 3.0).abs() < 1e-12, "{theta}");
        }
        assert!((over_disc(f64::cos, 1.0) / 1.0_f64.cos() - 1.0).abs() < 2e-5);
        // A peak far narrower than the disc fills it evenly: with all its light, and none outside.
        let narrow = 1e-4;
        let peak = |theta: f64| (-0.5 * (theta / narrow).powi(2)).exp() / (2.0 * PI * narrow * narrow);
        let disc = 1.0 / (PI * SUN * SUN);
        for theta in [0.0, 0.002, 0.004] {
            assert!(
                (over_disc(peak, theta) / disc - 1.0).abs() < 0.02,
                "{theta}: {}",
                over_disc(peak, theta) / disc
            );
        }
        assert!(over_disc(peak, 0.006) < 1e-6 * disc);
    }

    #[test]
    fn clouds_of_more_and_fewer_droplets_share_their_optics() {
        let of = |concentration_per_cm3, albedo| {
            let phase = scene::Phase::Isotropic;
            Species::of(&Droplets { concentration_per_cm3, albedo, phase, ..Droplets::default() }).unwrap()
        };
        assert!(of(1.0, 1.0).is(&of(400.0, 1.0)));
        assert!(!of(1.0, 1.0).is(&of(1.0, 0.9)));
    }
}
