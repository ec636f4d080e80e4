//! The source of multiple scattering in a slab, as a few numbers for each set of orders:
//! moments of the light that is scattered, times those of the phase function.
//!
//! The source of a set is a sum of eight spherical harmonics of the direction
//! ([`harmonics`]): all to degree 2, and those of degree 3 that vary slowest around the
//! normal. What finer structure there is comes from light that has kept its direction but
//! for small angles. In that limit the light of order n has Legendre moments
//! e^-s (chi_l s)^n / n! about the sun's direction, at optical depth s along it, and all
//! orders together leave the [`remainder`], which depends on s and the scattering angle
//! alone. The numbers of degree 3 are therefore kept as what they are beyond that limit.

use std::f64::consts::PI;

use super::angles::{legendre_functions, legendre_series};
use super::{Beam, FIRST_ORDERS, Field, Medium, SETS, axes};
use crate::tables::{Axis, Grid, Grids};

/// Numbers of a set at a point.
pub const COEFFICIENTS: usize = 8;

/// First degree of which the table tells only what the small-angle limit does not.
pub const REMAINDER_DEGREE: usize = 3;

/// The functions that the numbers of a set multiply: `mu` and `mu0` are the cosines of the
/// direction and of the sun's to the inward normal, `x` the product of the parts of both
/// across the normal. Those that vary with the azimuth fade out by themselves where the sun
/// stands in the zenith and has none.
pub fn harmonics(mu: f64, x: f64, mu0: f64) -> [f64; COEFFICIENTS] {
    [
        1.0,
        mu,
        x,
        1.5 * mu * mu - 0.5,
        mu * x,
        2.0 * x * x - (1.0 - mu * mu) * (1.0 - mu0 * mu0),
        mu * (2.5 * mu * mu - 1.5),
        x * (5.0 * mu * mu - 1.0),
    ]
}

/// Degree l, azimuthal order m and norm of each of [`harmonics`]: it is the norm times
/// (1 - mu0^2)^{m/2} L_l^m cos m phi.
const HARMONICS: [(usize, usize, f64); COEFFICIENTS] = [
    (0, 0, 1.0),
    (1, 0, 1.0),
    (1, 1, std::f64::consts::SQRT_2),
    (2, 0, 1.0),
    (2, 1, 0.816_496_580_927_726),
    (2, 2, 1.632_993_161_855_452),
    (3, 0, 1.0),
    (3, 1, 2.309_401_076_758_503),
];

/// The numbers of a set at a level of a solved slab, 1/sr. The sun must stand off the zenith.
pub fn coefficients(field: &Field, set: usize, level: usize) -> [f64; COEFFICIENTS] {
    let beam = field.beam();
    let path = field.depths()[level] / beam.mu0;
    HARMONICS.map(|(l, m, norm)| {
        let chi = field.medium().chi[l];
        let mut moment = field.moment(set, level, l, m);
        if l >= REMAINDER_DEGREE {
            let toward_sun = legendre_functions(m, l, beam.mu0)[l - m];
            moment -= toward_sun / (2.0 * PI) * small_angle(chi, path, set);
        }
        let twice = if m == 0 { 1.0 } else { 2.0 };
        let across = (1.0 - beam.mu0 * beam.mu0).powf(0.5 * m as f64);
        0.5 * (2.0 * l as f64 + 1.0) * chi * twice * moment / (norm * across)
    })
}

/// Legendre moment of the light that a set is scattered from where it keeps its direction,
/// about the sun's direction, from that of the phase function, at optical depth `path` along it.
fn small_angle(chi: f64, path: f64, set: usize) -> f64 {
    let mut term = (-path).exp();
    let mut low = 0.0;
    let mut sums = [0.0; SETS];
    // `term` is the share of light of order n - 1, which order n is scattered from.
    for n in 2..FIRST_ORDERS[SETS - 1] {
        term *= chi * path / (n - 1) as f64;
        sums[super::set_of(n)] += term;
        low += term;
    }
    // e^-s (e^{chi s} - 1), less the orders told.
    sums[SETS - 1] = (-path * (1.0 - chi)).exp() - (-path).exp() - low;
    sums[set]
}

/// Source of multiple scattering of all orders beyond the moments of a table, in the limit
/// of small angles, 1/sr: at optical depth `path` along the sun's direction, towards the
/// scattering angle of cosine `cosine`.
pub fn remainder(medium: &Medium, path: f64, cosine: f64) -> f64 {
    legendre_series(&remainder_moments(medium, path), cosine)
}

/// The terms of [`remainder`] by degree: to be summed by [`legendre_series`].
pub fn remainder_moments(medium: &Medium, path: f64) -> Vec<f64> {
    let term = |(l, chi): (usize, &f64)| {
        let kept = (-path * (1.0 - chi)).exp() * -(-path * chi).exp_m1();
        if l < REMAINDER_DEGREE { 0.0 } else { (2.0 * l as f64 + 1.0) / (4.0 * PI) * chi * kept }
    };
    medium.chi.iter().enumerate().map(term).collect()
}

/// The same beyond a grid that holds degrees 0 to 3 of the light scattered at least once, where the share
/// `ahead` of what is scattered is taken as going straight on (delta-M, Wiscombe 1977), per unit of the
/// extinction that is left there, for droplets of single-scattering `albedo`: with f = `ahead`,
/// (2l + 1) / (4 pi) (chi_l - f) / (1 - albedo f) (e^(-path (1 - albedo c_l)) - e^-path), where c_l is f up
/// to degree 3, of which the grid has the rest, and chi_l beyond. The light scattered once, with the whole
/// phase function over (1 - albedo f), comes on top. It is what the sun's light in the limit of small
/// angles scatters, but for what the grid and the light scattered once hold of it.
pub fn moments_beyond(medium: &Medium, albedo: f64, ahead: f64, path: f64) -> Vec<f64> {
    let term = |(l, &chi): (usize, &f64)| {
        let kept = albedo * if l <= 3 { ahead } else { chi };
        let light = (-path * (1.0 - kept)).exp() * -(-path * kept).exp_m1();
        (2.0 * l as f64 + 1.0) / (4.0 * PI) * (chi - ahead) / (1.0 - albedo * ahead) * light
    };
    medium.chi.iter().enumerate().map(term).collect()
}

/// The slab and the sun of a column of the table.
pub fn beam(column: usize) -> Beam {
    let [thickness, sun] = [column / axes::SUNS, column % axes::SUNS];
    Beam {
        thickness: axes::thickness_at(axes::point(thickness, axes::THICKNESSES)),
        // The limit at the zenith is as good as reached there.
        mu0: axes::sun_at(axes::point(sun, axes::SUNS)).min(0.99999),
    }
}

/// The table's numbers of one thickness and one sun, by set and depth: those of the solved
/// slab over the cosine of the sun, which they fall with.
pub fn column(field: &Field) -> Vec<[f64; COEFFICIENTS]> {
    let thickness = field.beam().thickness;
    let mut numbers = Vec::with_capacity(SETS * axes::DEPTHS);
    for set in 0..SETS {
        for i in 0..axes::DEPTHS {
            let depth = axes::depth_at(axes::point(i, axes::DEPTHS), thickness);
            let (level, share) = field.place(depth);
            let [low, high] = [level, level + 1].map(|level| coefficients(field, set, level));
            numbers.push(std::array::from_fn(|c| (low[c] + share * (high[c] - low[c])) / field.beam().mu0));
        }
    }
    numbers
}

/// The table from its columns, by thickness and sun: axes set, half of the numbers,
/// thickness, depth, sun, in the order in which a texture takes them.
pub fn table(columns: &[Vec<[f64; COEFFICIENTS]>]) -> Grid {
    let coordinates = |n: usize| (0..n).map(move |i| axes::point(i, n));
    let axes = vec![
        Axis::new("first order", FIRST_ORDERS.map(|n| n as f64)),
        Axis::new("half", [0.0, 1.0]),
        Axis::new("optical thickness", coordinates(axes::THICKNESSES).map(axes::thickness_at)),
        Axis::new("depth coordinate", coordinates(axes::DEPTHS)),
        Axis::new("cosine of the sun", coordinates(axes::SUNS).map(axes::sun_at)),
    ];
    let mut values = Vec::new();
    for set in 0..SETS {
        for half in 0..2 {
            for thickness in 0..axes::THICKNESSES {
                for depth in 0..axes::DEPTHS {
                    for sun in 0..axes::SUNS {
                        let numbers = columns[thickness * axes::SUNS + sun][set * axes::DEPTHS + depth];
                        values.extend_from_slice(&numbers[4 * half..4 * half + 4]);
                    }
                }
            }
        }
    }
    Grid::new(NAME, axes, 4, values)
}

/// Name of the table.
const NAME: &str = "source moments";

/// The table among those of a file; `None` where it is missing or has other axes than those here.
pub fn of(grids: &Grids) -> Option<Grid> {
    let lengths = [SETS, 2, axes::THICKNESSES, axes::DEPTHS, axes::SUNS];
    let fits =
        |grid: &&Grid| grid.channels == 4 && grid.axes.iter().map(|axis| axis.values.len()).eq(lengths);
    grids.named(NAME).filter(fits).cloned()
}

/// Source of a set from the table, 1/sr, without the [`remainder`]: in a slab of optical
/// thickness `thickness`, at `depth`, under a sun of cosine `mu0`, towards `mu` and `x` of
/// [`harmonics`].
pub fn source(table: &Grid, set: usize, [thickness, depth, mu0]: [f64; 3], [mu, x]: [f64; 2]) -> f64 {
    let at = |half: f64| {
        [
            set as f64,
            half,
            axes::thickness_coordinate(thickness) * (axes::THICKNESSES - 1) as f64,
            axes::depth_coordinate(depth, thickness) * (axes::DEPTHS - 1) as f64,
            axes::sun_coordinate(mu0) * (axes::SUNS - 1) as f64,
        ]
    };
    let [low, high] = [at(0.0), at(1.0)];
    let functions = harmonics(mu, x, mu0);
    let sum: f64 = (0..4)
        .map(|c| functions[c] * table.linear(&low, c) + functions[4 + c] * table.linear(&high, c))
        .sum();
    mu0 * sum
}
