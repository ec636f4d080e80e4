//! Light scattered by rain: spheres of water so large that rays tell what they do, but for two things that waves do.
//!
//! Half of the light that a drop takes away bends around it ([`super::diffraction`]), the other half are rays: reflected
//! at the surface (p = 0), or let in and out again after p - 1 reflections inside. Rays of p = 2 turn by 138 degrees at
//! the least, those of p = 3 by 231: there their light piles up into the bows, without a bound. Airy's waves
//! ([`super::airy`]) take the place of that bound: the bow is as wide as the 2/3 power of wavelength over radius.
//!
//! Drops are round here; those of more than a millimetre flatten as they fall, which dims the foot of their bow less
//! than its top. Nothing is absorbed: a drop of 1 mm takes 0.05 % of red.

use std::f64::consts::PI;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::{airy, band, diffraction, droplets::GammaDistribution, phase::Tabulated, rings::Rings, water};
use crate::Result;

/// Effective variance of drops' radii: that of an exponential distribution, as Marshall and Palmer (Journal of
/// Meteorology 5, 1948) found rain to have.
pub const EFFECTIVE_VARIANCE: f64 = 1.0 / 3.0;

/// Wavelengths of a channel, radii of drops, and tubes of rays from the middle of a drop to its rim.
const WAVELENGTHS: usize = 24;
const RADII: usize = 40;
const TUBES: usize = 2000;

/// Most legs inside that rays are followed over: what is left is below 1e-4 of the light.
const MOST_INSIDE: u32 = 12;

/// Phase functions of rain for red, green and blue, of drops of an effective radius in micrometres, 50 to 3000.
///
/// # Errors
/// Where the radius is none.
pub fn phase(effective_radius_um: f64) -> Result<[Tabulated; 3]> {
    // What rays do is the same for drops of all sizes.
    static RAYS: OnceLock<[Vec<f64>; 3]> = OnceLock::new();
    let bands = [0, 1, 2].map(|channel| -> Vec<f64> { band::wavelengths_um(channel, WAVELENGTHS).collect() });
    let rays = RAYS.get_or_init(|| bands.each_ref().map(|band| mean_rays(band)));
    let [red, green, blue] =
        [0, 1, 2].map(|channel| of_rays(&rays[channel], effective_radius_um, &bands[channel]));
    Ok([red?, green?, blue?])
}

/// The same for light of some wavelengths in micrometres, as much of each.
///
/// # Errors
/// Where the radius is none.
pub fn of_wavelengths(effective_radius_um: f64, wavelengths_um: &[f64]) -> Result<Tabulated> {
    of_rays(&mean_rays(wavelengths_um), effective_radius_um, wavelengths_um)
}

fn of_rays(rays: &[f64], effective_radius_um: f64, wavelengths_um: &[f64]) -> Result<Tabulated> {
    let drops = GammaDistribution { effective_radius_um, effective_variance: EFFECTIVE_VARIANCE };
    let rings = rings();
    let waves: Vec<Vec<f64>> =
        wavelengths_um.par_iter().map(|wavelength_um| waves(&rings, *wavelength_um, &drops)).collect();
    let share = 1.0 / wavelengths_um.len() as f64;
    let middle_um = wavelengths_um.iter().sum::<f64>() * share;
    let around = diffraction::phase(&drops, middle_um, &rings.middles());
    let values = rings.solid_angles().into_iter().zip(around).enumerate().map(|(ring, (solid, around))| {
        // Next to a bow the ripples of waves may take more than there is.
        let light = rays[ring] + share * waves.iter().map(|waves| waves[ring]).sum::<f64>();
        0.5 * (light.max(1e-6 * solid) / solid + around)
    });
    rings.phase(&values.collect::<Vec<f64>>())
}

/// Rings as fine as diffraction and bows.
fn rings() -> Rings {
    Rings::new(0.001, |theta| if (126.0..143.0).contains(&theta) { 0.05 } else { 0.4 })
}

/// Light of rays in each ring, on average over wavelengths in micrometres.
fn mean_rays(wavelengths_um: &[f64]) -> Vec<f64> {
    let rings = rings();
    let all: Vec<Vec<f64>> = wavelengths_um
        .par_iter()
        .map(|wavelength_um| rays(&rings, water::real_part(*wavelength_um)))
        .collect();
    let mean = |ring: usize| all.iter().map(|light| light[ring]).sum::<f64>() / all.len() as f64;
    (0..rings.count()).map(mean).collect()
}

/// Light of rays in each ring, as shares of what meets a drop of refractive index `n`.
fn rays(rings: &Rings, n: f64) -> Vec<f64> {
    let mut sums = vec![0.0; rings.count()];
    // Impacts by their squares: as much light in each tube, which lies between two of them.
    let impact = |i: usize| (i as f64 / TUBES as f64).sqrt();
    let tube = 1.0 / TUBES as f64;
    for i in 0..TUBES {
        let middle = Ray::new((0.5 * (impact(i).powi(2) + impact(i + 1).powi(2))).sqrt(), n);
        let [from, to] = [Ray::new(impact(i), n), Ray::new(impact(i + 1), n)];
        for p in 0..=MOST_INSIDE {
            rings.spread(&mut sums, folded(from.turn(p)), folded(to.turn(p)), tube * middle.share(p));
        }
    }
    sums
}

/// What Airy's light has more than that of rays about the two bows, by ring.
fn waves(rings: &Rings, wavelength_um: f64, drops: &GammaDistribution) -> Vec<f64> {
    let mut sums = vec![0.0; rings.count()];
    let all: Vec<(f64, f64)> = diffraction::radii(drops, RADII).collect();
    let whole: f64 = all.iter().map(|(_, area)| area).sum();
    for p in [2, 3] {
        let bow = Bow::new(p, water::real_part(wavelength_um));
        // Where angles lie on the bright side of the bow, rad.
        let bright = |theta: &f64| (if p == 2 { *theta } else { 2.0 * PI - theta }) - bow.turn;
        let edges: Vec<f64> = rings.edges.iter().map(bright).collect();
        for &(radius_um, area) in &all {
            let width = bow.width(2.0 * PI * radius_um / wavelength_um);
            let share = area / whole * bow.light;
            let more: Vec<f64> = edges.iter().map(|bright| difference(*bright, width)).collect();
            for (sum, more) in sums.iter_mut().zip(more.windows(2)) {
                *sum += share * if p == 2 { more[1] - more[0] } else { more[0] - more[1] };
            }
        }
    }
    sums
}

/// What waves have more than rays up to an angle `bright` on the bright side of a bow of `width`, rad, where rays
/// have 1 / sqrt(bright).
fn difference(bright: f64, width: f64) -> f64 {
    if bright > airy::LAST * width {
        return 0.0;
    }
    2.0 * PI * width.sqrt() * airy::light_within(bright / width) - 2.0 * bright.max(0.0).sqrt()
}

/// An angle from 0 to pi that is as far from straight on as a turn.
fn folded(turn: f64) -> f64 {
    let turn = turn.rem_euclid(2.0 * PI);
    turn.min(2.0 * PI - turn)
}

/// A ray that meets a sphere of radius 1.
#[derive(Debug, Clone, Copy)]
struct Ray {
    /// Angles to the surface's normal outside and inside, rad.
    outside: f64,
    inside: f64,
    /// Share that is reflected, of both polarizations.
    reflected: [f64; 2],
}

impl Ray {
    /// At a distance `impact` from the middle.
    fn new(impact: f64, n: f64) -> Self {
        let (outside, inside) = (impact.min(1.0).asin(), (impact / n).asin());
        let (i, r) = (outside.cos(), inside.cos());
        let across = ((i - n * r) / (i + n * r)).powi(2);
        let along = ((n * i - r) / (n * i + r)).powi(2);
        Self { outside, inside, reflected: [across, along] }
    }

    /// By what it is turned with p legs inside, rad.
    fn turn(self, p: u32) -> f64 {
        2.0 * self.outside - PI + f64::from(p) * (PI - 2.0 * self.inside)
    }

    /// Share of its light that leaves with p legs inside.
    fn share(self, p: u32) -> f64 {
        let one = |reflected: f64| match p {
            0 => reflected,
            _ => (1.0 - reflected).powi(2) * reflected.powi(p as i32 - 1),
        };
        0.5 * self.reflected.map(one).iter().sum::<f64>()
    }
}

/// Where rays with p legs inside turn the least.
#[derive(Debug, Clone, Copy)]
pub struct Bow {
    /// By what they turn there, rad, not folded.
    pub turn: f64,
    /// Light on the bright side times the square root of the distance from there, shares of what meets the drop
    /// each square root of a radian.
    light: f64,
    /// Van de Hulst's h (13.24), which tells how its wave front bends.
    bend: f64,
}

impl Bow {
    /// That of p legs (2 the primary bow, 3 the secondary) for a refractive index `n`.
    pub fn new(p: u32, n: f64) -> Self {
        let order = f64::from(p);
        let cosine = ((n * n - 1.0) / (order * order - 1.0)).sqrt();
        let impact = (1.0 - cosine * cosine).sqrt();
        let ray = Ray::new(impact, n);
        let inside = ray.inside.cos();
        // How fast the angle inside changes with that outside, once and twice.
        let slope = cosine / (n * inside);
        let curve = (cosine * ray.inside.sin() * slope - impact * inside) / (n * inside * inside);
        let curvature = 2.0 * order * curve.abs() / (cosine * cosine);
        Self {
            turn: ray.turn(p),
            light: 4.0 * impact * ray.share(p) / (2.0 * curvature).sqrt(),
            bend: (order * order - 1.0).powi(2) / (order * order)
                * ((order * order - n * n) / (n * n - 1.0).powi(3)).sqrt(),
        }
    }

    /// Its width by waves, rad, in drops of a size parameter: (h / x^2)^(1/3).
    pub fn width(self, size: f64) -> f64 {
        (self.bend / (size * size)).cbrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::mie::Sphere;

    #[test]
    fn rays_keep_their_light() {
        for n in [1.31, 1.333, 1.345] {
            let sum: f64 = rays(&rings(), n).iter().sum();
            assert!((sum - 1.0).abs() < 1e-4, "{n}: {sum}");
        }
    }

    #[test]
    fn bows_bend_as_van_de_hulst_says() {
        // His table 25, m = 4/3: h = 4.89 and 27.86.
        for (p, right) in [(2, 4.89), (3, 27.86)] {
            let bow = Bow::new(p, 4.0 / 3.0);
            assert!((bow.bend - right).abs() < 0.01, "{p}: {}", bow.bend);
        }
    }

    #[test]
    fn light_next_to_a_bow_is_that_of_the_rays_that_are_followed() {
        let (rings, n) = (rings(), 1.333);
        let light = rays(&rings, n);
        let bow = Bow::new(2, n);
        // On the bright side, less what other rays bring, which the dark side has.
        let (from, to) = (bow.turn + 0.002, bow.turn + 0.02);
        let wanted = bow.light * 2.0 * (0.02_f64.sqrt() - 0.002_f64.sqrt());
        let found: f64 = (rings.ring(from)..rings.ring(to)).map(|ring| light[ring]).sum();
        let dark: f64 = (rings.ring(from - 0.03)..rings.ring(to - 0.03)).map(|ring| light[ring]).sum();
        assert!(((found - dark) / wanted - 1.0).abs() < 0.1, "{found} - {dark} for {wanted}");
    }

    /// Mean over a window of degrees of Mie's phase function of the same drops.
    fn mie(effective_radius_um: f64, windows: &[[f64; 2]]) -> Vec<f64> {
        const INSIDE: usize = 8;
        let drops = GammaDistribution { effective_radius_um, effective_variance: EFFECTIVE_VARIANCE };
        let at = |window: &[f64; 2]| {
            let [low, high] = *window;
            (0..INSIDE)
                .map(move |i| (low + (high - low) * (i as f64 + 0.5) / INSIDE as f64).to_radians().cos())
        };
        let cosines: Vec<f64> = windows.iter().flat_map(at).collect();
        let index = water::RefractiveIndex { n: water::real_part(0.55), k: 0.0 };
        let (mut sums, mut whole) = (vec![0.0; cosines.len()], 0.0);
        let count = 600;
        let [low, high] = [0.15 * effective_radius_um, 4.0 * effective_radius_um];
        for i in 0..count {
            let radius_um = low * (high / low).powf((f64::from(i) + 0.5) / f64::from(count));
            let sphere = Sphere::new(2.0 * PI * radius_um / 0.55, index);
            let weight = drops.density(radius_um) * radius_um.powi(3) * sphere.q_sca();
            sums.iter_mut().zip(sphere.phase(&cosines)).for_each(|(sum, value)| *sum += weight * value);
            whole += weight;
        }
        sums.chunks(INSIDE).map(|part| part.iter().sum::<f64>() / (INSIDE as f64 * whole)).collect()
    }

    #[test]
    fn rain_scatters_as_mie_tells_where_drops_are_small_enough_for_that() {
        // Forward, the primary bow with its dark band, and inside it. Where it is darkest, and in the glory, which
        // rays have not, drops of 60 um are 15 to 30 % off; that goes with their size.
        let windows = [10.0, 25.0, 50.0, 126.0, 139.0, 142.0, 147.0].map(|at| [at - 1.0, at + 1.0]);
        let rain = of_wavelengths(60.0, &[0.55]).unwrap();
        for (window, right) in windows.iter().zip(mie(60.0, &windows)) {
            let at = |i: u32| (window[0] + (f64::from(i) + 0.5) * 0.1).to_radians();
            let found = (0..20).map(|i| rain.value(at(i))).sum::<f64>() / 20.0;
            assert!((found / right - 1.0).abs() < 0.05, "{window:?}: {found} for {right}");
        }
    }

    /// The angle from the antisolar point, degrees, where a channel is brightest between two of these.
    fn brightest(phase: &Tabulated, from: f64, to: f64) -> f64 {
        let at = |i: u32| from + (to - from) * f64::from(i) / 2000.0;
        let value = |angle: f64| phase.value((180.0 - angle).to_radians());
        (0..=2000).map(at).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap()
    }

    #[test]
    fn bows_are_where_they_are_seen() {
        // From the antisolar point: 42.4 degrees for the red of 700 nm, 40.5 for the violet of 400; the secondary bow
        // at 50.9.
        for (wavelength_um, known) in [(0.7, [42.4, 50.3]), (0.6, [42.1, 50.9]), (0.4, [40.5, 53.6])] {
            let rain = of_wavelengths(3000.0, &[wavelength_um]).unwrap();
            for (p, known) in [2, 3].into_iter().zip(known) {
                let turn = Bow::new(p, water::real_part(wavelength_um)).turn.to_degrees();
                let bow = if p == 2 { 180.0 - turn } else { turn - 180.0 };
                assert!((bow - known).abs() < 0.15, "{wavelength_um} um: {bow} for {known}");
                // Waves draw the brightest place to the bright side, the more the smaller the drops.
                let found = brightest(&rain, known - 3.0, known + 3.0);
                assert!((found - bow).abs() < 0.3, "{wavelength_um} um: {found} for {bow}");
            }
        }
    }

    #[test]
    fn colours_of_the_bows_are_in_order_and_a_dark_band_is_between() {
        let [red, green, blue] = phase(500.0).unwrap();
        let primary = [&red, &green, &blue].map(|channel| brightest(channel, 37.0, 45.0));
        assert!(primary[0] > primary[1] && primary[1] > primary[2], "red outside: {primary:?}");
        let secondary = [&red, &green, &blue].map(|channel| brightest(channel, 48.0, 58.0));
        assert!(secondary[0] < secondary[1] && secondary[1] < secondary[2], "red inside: {secondary:?}");
        let at = |angle: f64| green.value((180.0 - angle).to_radians());
        // Darker between the bows than outside of both, brighter inside the primary.
        assert!(at(46.5) < 0.6 * at(60.0) && at(46.5) < 0.2 * at(35.0));
        assert!(at(primary[1]) > 2.0 * at(35.0), "the bow stands out");
    }

    #[test]
    fn smaller_drops_have_wider_and_fainter_bows() {
        let height = |radius_um: f64| {
            let [_, green, _] = phase(radius_um).unwrap();
            green.value((180.0 - brightest(&green, 35.0, 45.0)).to_radians())
        };
        assert!(height(1500.0) > 1.03 * height(300.0) && height(300.0) > 1.3 * height(60.0));
    }

    #[test]
    fn what_is_summed_is_a_phase_function_before_it_is_made_one() {
        // Rays and waves keep their light; diffraction what its obliquity leaves.
        let rings = rings();
        let drops = GammaDistribution { effective_radius_um: 500.0, effective_variance: EFFECTIVE_VARIANCE };
        let more: f64 = waves(&rings, 0.55, &drops).iter().sum();
        assert!(more.abs() < 2e-3, "{more}");
        let around = diffraction::phase(&drops, 0.55, &rings.middles());
        let sum: f64 = around.iter().zip(rings.solid_angles()).map(|(value, solid)| value * solid).sum();
        assert!((sum - 1.0).abs() < 2e-3, "{sum}");
        let green = &phase(500.0).unwrap()[1];
        assert!((green.within(PI) - 1.0).abs() < 1e-12);
        // Half around the drop, within a degree; the other half as van de Hulst has it, g 0.77.
        assert!((0.86..0.90).contains(&green.asymmetry()), "{}", green.asymmetry());
    }
}
