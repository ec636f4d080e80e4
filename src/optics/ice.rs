//! Ice, snow and graupel: what rays through crystals do ([`super::crystal`]), kept in `tables/ice.bin`, and
//! diffraction around them ([`super::diffraction`]).

use std::{io::Write, path::Path};

use rayon::prelude::*;

use super::{
    WAVELENGTHS_UM, band,
    crystal::{Crystal, Scattered, Shape},
    diffraction,
    droplets::GammaDistribution,
    phase::Tabulated,
    rings::Rings,
};
use crate::{
    Error, Result,
    files::write_whole,
    tables::{Axis, Grid, Grids},
};

/// Real part of the refractive index of ice at -7 degrees Celsius from 0.38 um on, every 0.02 um: Warren and Brandt,
/// Journal of Geophysical Research 113 (2008), D14220; at 0.38 um between their 0.35 and 0.39.
const INDEX: [f64; 20] = [
    1.3214, 1.3194, 1.3177, 1.3163, 1.3151, 1.3140, 1.3130, 1.3121, 1.3114, 1.3106, 1.3100, 1.3094, 1.3088,
    1.3083, 1.3078, 1.3073, 1.3069, 1.3065, 1.3060, 1.3057,
];
const INDEX_FIRST_UM: f64 = 0.38;
const INDEX_STEP_UM: f64 = 0.02;

/// Refractive index of ice at a wavelength in micrometres between 0.38 and 0.76. What it absorbs there is nothing: 1 mm
/// takes 0.03 % of red.
pub fn refractive_index(wavelength_um: f64) -> f64 {
    let place = ((wavelength_um - INDEX_FIRST_UM) / INDEX_STEP_UM).clamp(0.0, (INDEX.len() - 1) as f64);
    let i = (place as usize).min(INDEX.len() - 2);
    INDEX[i] + (place - i as f64) * (INDEX[i + 1] - INDEX[i])
}

/// What particles of ice there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Hexagonal columns, twice as long as wide.
    Columns,
    /// Hexagonal plates, 0.4 times as thick as wide.
    Plates,
    /// Snow: aggregates, whose light is that of their parts (Yang and Liou 1998), columns as long as wide, and rough.
    Snow,
    /// Graupel: lumps of rime, taken as balls of ice with a very rough surface.
    Graupel,
}

impl Kind {
    const ALL: [Self; 4] = [Self::Columns, Self::Plates, Self::Snow, Self::Graupel];

    /// Name of its table.
    fn name(self) -> &'static str {
        match self {
            Self::Columns => "columns",
            Self::Plates => "plates",
            Self::Snow => "snow",
            Self::Graupel => "graupel",
        }
    }

    /// The shape that rays go through.
    pub fn shape(self) -> Shape {
        match self {
            Self::Columns => Shape::Prism { aspect: 2.0 },
            Self::Plates => Shape::Prism { aspect: 0.4 },
            Self::Snow => Shape::Prism { aspect: 1.0 },
            Self::Graupel => Shape::Sphere,
        }
    }

    /// Roughnesses of its table.
    fn roughnesses(self) -> &'static [f64] {
        match self {
            Self::Columns | Self::Plates => &[0.0, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.5],
            Self::Snow => &[0.3],
            Self::Graupel => &[0.6],
        }
    }
}

/// Effective variance of the sizes of particles of ice: as wide as they are in cirrus.
pub const EFFECTIVE_VARIANCE: f64 = 0.25;

/// Rays that each table is made of.
pub const RAYS: u64 = 4_000_000;

/// Name of the file.
const NAME: &str = "ice.bin";

/// Rings as fine as halos.
fn rings() -> Rings {
    Rings::new(0.02, |theta| match theta {
        t if t < 20.0 => 0.25,
        t if t < 26.0 => 0.1,
        t if t < 44.0 => 0.4,
        t if t < 50.0 => 0.2,
        _ => 1.0,
    })
}

/// Follows `rays` rays for each channel.
pub fn trace(crystal: Crystal, rays: u64) -> [Scattered; 3] {
    const PART: u64 = 1 << 14;
    let rings = rings();
    let parts: Vec<[Scattered; 3]> = (0..rays.div_ceil(PART))
        .into_par_iter()
        .map(|part| {
            let mut sums = [0, 1, 2].map(|_| Scattered::none(&rings));
            for number in part * PART..rays.min((part + 1) * PART) {
                let (start, share) = crystal.start(number);
                for (channel, sums) in sums.iter_mut().enumerate() {
                    let n = refractive_index(band::wavelength_um(channel, share));
                    crystal.follow(&start, n, &rings, sums);
                }
            }
            sums
        })
        .collect();
    let mut all = [0, 1, 2].map(|_| Scattered::none(&rings));
    for part in &parts {
        all.iter_mut().zip(part).for_each(|(sum, part)| sum.add(part));
    }
    all
}

/// Makes the tables of ice and writes them to `path`, in one piece or not at all: some minutes on all cores.
/// `progress` is told the share done so far, 0 to 1.
///
/// # Errors
/// Where the file can't be written.
pub fn write_table(path: &Path, progress: impl Fn(f64)) -> Result<()> {
    let total: usize = Kind::ALL.iter().map(|kind| kind.roughnesses().len()).sum();
    let mut done = 0;
    let mut grids = Vec::new();
    for kind in Kind::ALL {
        let traced = kind.roughnesses().iter().map(|roughness| {
            let scattered = trace(Crystal { shape: kind.shape(), roughness: *roughness }, RAYS);
            done += 1;
            progress(done as f64 / total as f64);
            scattered
        });
        grids.extend(tables(kind, &traced.collect::<Vec<_>>()));
    }
    write_whole(path, |file| file.write_all(&Grids(grids).encode()))
}

/// The tables of a kind: what its rays scatter, 1/sr, and what goes straight through, both of light 1.
fn tables(kind: Kind, traced: &[[Scattered; 3]]) -> [Grid; 2] {
    let rings = rings();
    let solid = rings.solid_angles();
    let roughness = || Axis::new("roughness", kind.roughnesses().iter().copied());
    let angles = Axis::new("scattering angle, degrees", rings.middles().into_iter().map(f64::to_degrees));
    let values = traced.iter().flat_map(|channels| {
        let solid = &solid;
        (0..rings.count()).flat_map(move |ring| {
            channels.each_ref().map(|sums| sums.light[ring] / (solid[ring] * sums.whole()))
        })
    });
    let straight =
        traced.iter().flat_map(|channels| channels.each_ref().map(|sums| sums.straight / sums.whole()));
    [
        Grid::new(kind.name(), vec![roughness(), angles], 3, values),
        Grid::new(&straight_name(kind), vec![roughness()], 3, straight),
    ]
}

fn straight_name(kind: Kind) -> String {
    format!("{} straight on", kind.name())
}

/// Phase functions for red, green and blue, 1/sr, of particles of an effective radius in micrometres, 10 and more,
/// whose surface has this roughness, 0 to 0.5 (snow and graupel have their own).
///
/// Half of the light is diffraction, the other half rays. Those that go straight through a particle bend as much as
/// those around it; others leave through a face, about half as wide as the particle, and are blurred as a window of that
/// width blurs (Gauss's curve in place of its rings): halos of small crystals are blunt.
///
/// # Errors
/// Where the embedded table is damaged.
pub fn phase(kind: Kind, effective_radius_um: f64, roughness: f64) -> Result<[Tabulated; 3]> {
    let grids = Grids::decode(NAME, include_bytes!("../../tables/ice.bin"))?;
    let damaged = || Error::Table { name: NAME, problem: format!("has no `{}`: make it anew", kind.name()) };
    let scattered = grids.named(kind.name()).ok_or_else(damaged)?;
    let straight = grids.named(&straight_name(kind)).ok_or_else(damaged)?;
    let known = rings();
    if scattered.axes.len() != 2 || scattered.axes[1].values.len() != known.count() {
        return Err(damaged());
    }
    let place = place(&scattered.axes[0].values, roughness);
    let of = |channel: usize| {
        let light = rays(scattered, place, channel, &known);
        let window_um = WAVELENGTHS_UM[channel] / effective_radius_um;
        let light = known.blurred(&light, BLUR * window_um);
        let straight = straight.linear(&[place], channel);
        with_diffraction(&known, &light, straight, channel, effective_radius_um)
    };
    let [red, green, blue] = [of(0), of(1), of(2)];
    Ok([red?, green?, blue?])
}

/// Deviation of Gauss's curve that is like the diffraction of a round window, times the wavelength over the diameter
/// (0.42 of it; Zhang and others 2007), where that is half of the particle's.
const BLUR: f64 = 0.42;

/// Where among rising values a value lies, in steps.
fn place(values: &[f32], value: f64) -> f64 {
    let above = values.partition_point(|known| f64::from(*known) <= value);
    match (above.checked_sub(1), values.get(above)) {
        (None, _) => 0.0,
        (Some(below), None) => below as f64,
        (Some(below), Some(high)) => {
            let low = f64::from(values[below]);
            below as f64 + (value - low) / (f64::from(*high) - low)
        }
    }
}

/// Light of rays by ring at a place among the roughnesses: between two of them ln P goes evenly.
fn rays(table: &Grid, place: f64, channel: usize, rings: &Rings) -> Vec<f64> {
    let last = table.axes[0].values.len() - 1;
    let below = (place as usize).min(last);
    let at = |row: usize, ring: usize| {
        table.values[table.place(&[row.min(last), ring]) + channel].to_f64().max(1e-5).ln()
    };
    let share = place - below as f64;
    let value = |ring: usize| (at(below, ring) + share * (at(below + 1, ring) - at(below, ring))).exp();
    rings.solid_angles().into_iter().enumerate().map(|(ring, solid)| solid * value(ring)).collect()
}

/// Rays and diffraction together.
fn with_diffraction(
    known: &Rings,
    light: &[f64],
    straight: f64,
    channel: usize,
    effective_radius_um: f64,
) -> Result<Tabulated> {
    let density = light.iter().zip(known.solid_angles()).map(|(light, solid)| light / solid);
    let rays = known.phase(&density.collect::<Vec<f64>>())?;
    let rings = Rings::new(0.001, |theta| known_width(known, theta));
    let sizes = GammaDistribution { effective_radius_um, effective_variance: EFFECTIVE_VARIANCE };
    let middles = rings.middles();
    let around = diffraction::phase(&sizes, WAVELENGTHS_UM[channel], &middles);
    let value = |(theta, around): (&f64, f64)| {
        0.5 * ((1.0 + straight) * around + (1.0 - straight) * rays.value(*theta))
    };
    rings.phase(&middles.iter().zip(around).map(value).collect::<Vec<f64>>())
}

/// Width of the known ring at an angle, degrees.
fn known_width(known: &Rings, theta_deg: f64) -> f64 {
    let ring = known.ring(theta_deg.to_radians());
    (known.edges[ring + 1] - known.edges[ring]).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Degrees within two angles where a phase function is greatest.
    fn brightest(phase: &Tabulated, from: f64, to: f64) -> f64 {
        let at = |i: u32| from + (to - from) * f64::from(i) / 2000.0;
        let value = |angle: f64| phase.value(angle.to_radians());
        (0..=2000).map(at).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap()
    }

    /// Where a phase function rises the fastest between two angles, degrees.
    fn edge(phase: &Tabulated, from: f64, to: f64) -> f64 {
        let step = 0.2;
        let at = |i: u32| from + (to - from) * f64::from(i) / 500.0;
        let rise = |angle: f64| {
            let value = |angle: f64| phase.value(angle.to_radians());
            value(angle + 0.5 * step) - value(angle - 0.5 * step)
        };
        (0..=500).map(at).max_by(|a, b| rise(*a).total_cmp(&rise(*b))).unwrap()
    }

    /// Least turn, degrees, through a prism of this angle, degrees.
    fn least_turn(n: f64, prism_deg: f64) -> f64 {
        2.0 * (n * (0.5 * prism_deg).to_radians().sin()).asin().to_degrees() - prism_deg
    }

    #[test]
    fn refractive_index_is_that_of_the_table_between_its_points() {
        for (um, right) in [(0.40, 1.3194), (0.45, 1.3157), (0.55, 1.3110), (0.65, 1.3080), (0.70, 1.3069)] {
            assert!((refractive_index(um) - right).abs() < 1.1e-4, "{um}: {}", refractive_index(um));
        }
    }

    #[test]
    fn halos_begin_at_the_least_turn_of_prisms() {
        // 60 degrees between every other side, 90 between side and end: 21.8 and 45.7 for n 1.31.
        assert!(
            (least_turn(1.31, 60.0) - 21.84).abs() < 0.01 && (least_turn(1.31, 90.0) - 45.73).abs() < 0.01
        );
        for kind in [Kind::Columns, Kind::Plates] {
            let channels = phase(kind, 400.0, 0.0).unwrap();
            for (channel, phase) in channels.iter().enumerate() {
                let n = refractive_index(WAVELENGTHS_UM[channel]);
                let found = edge(phase, 20.0, 24.0);
                let right = least_turn(n, 60.0);
                assert!((found - right).abs() < 0.3, "{kind:?}, channel {channel}: {found} for {right}");
                let found = edge(phase, 44.0, 49.0);
                let right = least_turn(n, 90.0);
                assert!((found - right).abs() < 0.5, "{kind:?}, channel {channel}: {found} for {right}");
            }
            let [red, _, blue] = &channels;
            assert!(edge(red, 20.0, 24.0) + 0.3 < edge(blue, 20.0, 24.0), "red inside");
            let (inside, on) = (red.value(20.0_f64.to_radians()), red.value(22.4_f64.to_radians()));
            assert!(on > 5.0 * inside, "{kind:?}: {on} to {inside}");
        }
    }

    #[test]
    fn small_and_rough_crystals_have_blunt_halos() {
        let height = |radius_um: f64, roughness: f64| {
            let [_, green, _] = phase(Kind::Columns, radius_um, roughness).unwrap();
            let at = |angle: f64| green.value(angle.to_radians());
            at(brightest(&green, 21.0, 25.0)) / at(19.0)
        };
        let sharp = height(100.0, 0.0);
        assert!(sharp > 8.0, "{sharp}");
        assert!(height(15.0, 0.0) < 0.6 * sharp && height(100.0, 0.02) < 0.9 * sharp);
        assert!(height(100.0, 0.3) < 1.1, "no halo is left");
        // Snow has nothing there: its light falls with the angle.
        let [_, snow, _] = phase(Kind::Snow, 250.0, 0.0).unwrap();
        let at = |angle: i32| snow.value(f64::from(angle).to_radians());
        assert!((2..30).all(|i| at(2 * i) > at(2 * i + 4)));
    }

    #[test]
    fn asymmetry_is_in_the_published_range() {
        // Crystals whose width and length are not far from each other: 0.74 to 0.82, smooth or rough (Fu 2007, Journal
        // of the Atmospheric Sciences 64; van Diedenhoven and others 2012). Aggregates that are severely roughened: 0.75
        // (Platnick and others 2017, for MODIS).
        let of = |kind, roughness| {
            let [_, green, _] = phase(kind, 60.0, roughness).unwrap();
            green.asymmetry()
        };
        for roughness in [0.0, 0.02, 0.1, 0.3, 0.5] {
            for kind in [Kind::Columns, Kind::Plates] {
                assert!((0.74..0.82).contains(&of(kind, roughness)), "{kind:?}: {}", of(kind, roughness));
            }
        }
        assert!((of(Kind::Snow, 0.0) - 0.75).abs() < 0.01, "{}", of(Kind::Snow, 0.0));
        assert!((0.74..0.82).contains(&of(Kind::Graupel, 0.0)), "{}", of(Kind::Graupel, 0.0));
        assert_eq!(of(Kind::Snow, 0.0), of(Kind::Snow, 0.4));
    }

    #[test]
    fn rays_keep_their_light_and_the_table_is_what_they_do() {
        for (kind, roughness) in [(Kind::Columns, 0.0), (Kind::Plates, 0.15), (Kind::Graupel, 0.6)] {
            let rays = 20_000;
            let [_, green, _] = trace(Crystal { shape: kind.shape(), roughness }, rays);
            // Roulette of faint rays; none is held for good.
            assert!((green.whole() / rays as f64 - 1.0).abs() < 1e-3, "{kind:?}: {}", green.whole());
            assert!(green.lost / (rays as f64) < 1e-4);
            let [_, phase, _] = phase(kind, 500.0, roughness).unwrap();
            assert!((phase.within(std::f64::consts::PI) - 1.0).abs() < 1e-9);
            let traced = 0.5 * (1.0 + green.forward / green.whole());
            assert!(
                (phase.asymmetry() - traced).abs() < 5e-3,
                "{kind:?}: {} for {traced}",
                phase.asymmetry()
            );
        }
    }

    #[test]
    fn a_window_lets_through_what_fresnel_says() {
        // A plate without sides, nearly: light that goes through it twice at the same angle goes straight on.
        let [_, flat, _] = trace(Crystal { shape: Shape::Prism { aspect: 0.002 }, roughness: 0.0 }, 20_000);
        let mut wanted = 0.0;
        let n: f64 = refractive_index(0.55);
        for i in 0..2000 {
            // Light from all sides, by its cosine; with 2 R / (1 + R) back and (1 - R) / (1 + R) through.
            let cosine = ((f64::from(i) + 0.5) / 2000.0).sqrt();
            let inside = (1.0 - (1.0 - cosine * cosine) / (n * n)).sqrt();
            let across = ((cosine - n * inside) / (cosine + n * inside)).powi(2);
            let along = ((n * cosine - inside) / (n * cosine + inside)).powi(2);
            // Each crossing takes the mean of both polarizations.
            let reflected = 0.5 * (across + along);
            wanted += (1.0 - reflected) / (1.0 + reflected) / 2000.0;
        }
        let found = flat.straight / flat.whole();
        assert!((found / wanted - 1.0).abs() < 0.02, "{found} for {wanted}");
    }
}
