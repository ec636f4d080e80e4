//! How far apart the light that passes a depth of a slab has entered: \[K 3.54\].

use super::SETS;
use super::axes::{depth_at, point};
use super::least_squares::fit;
use super::walks::{AZIMUTHS, COSINES, Entries, PLANES, Walks};

/// Photons under which a plane of a slab tells nothing about a set.
const LEAST_PHOTONS: f64 = 300.0;

/// Share of a slab's photons under which a plane doesn't count for a set.
const LEAST_SHARE: f64 = 5e-4;

/// The spread in slabs of droplets without their forward peak, of effective radius 6 um:
/// what [`Spread::fitted`] gives for the walks of `nephos tables slab`. Relative error, rms over
/// planes: 12 to 24 % for orders below 16, 7 % from there on.
pub const SPREAD: Spread = Spread {
    low: [
        [0.5691, 0.005954, 73.60],
        [0.7382, 0.009261, 131.7],
        [0.8636, 0.015145, 136.5],
        [1.2356, 0.02197, 76.46],
        [2.2691, 0.03467, 7.664],
        [3.6535, 0.04602, 3.016],
    ],
    high: [4.8646, 0.020916, 0.4364, 1.5883, 0.3342],
};

/// [`SPREAD`] at a point: standard deviation, as an optical depth without peak, of the places
/// where the light of set `set` entered that passes optical depth `depth` of a slab of
/// optical thickness `thickness`.
pub fn spread(set: usize, thickness: f64, depth: f64) -> f64 {
    SPREAD.at(set, thickness, depth)
}

/// The parameters of \[K 3.54\]; lengths are optical depths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// S_a, S_b, S_c of the sets before the last.
    pub low: [[f64; 3]; SETS - 1],
    /// O, Q, R, S, T of the last set.
    pub high: [f64; 5],
}

impl Spread {
    /// Standard deviation of the places where light entered, along one axis of the slab's
    /// face, mean of both: the light of set `set` that passes optical depth `depth` of a
    /// slab of optical thickness `thickness` in all directions, under all suns. Optical
    /// depth, never below 0.
    pub fn at(&self, set: usize, thickness: f64, depth: f64) -> f64 {
        let square = |x: f64| x.max(0.0).ln_1p().powi(2);
        match self.low.get(set) {
            Some([a, b, c]) => a + b * square(c * depth),
            None => {
                let [o, q, r, s, t] = self.high;
                (o + q * thickness * square(r * depth) + s * square(t * thickness)).max(0.0)
            }
        }
    }

    /// The parameters that fit random walks in many slabs best: least squares of the
    /// relative error, each plane of each slab weighted by the root of its share of the photons.
    pub fn fitted(walks: &[Walks]) -> Self {
        let measured = measure(walks);
        let of = |set: usize| measured.iter().filter(move |m| m.set == set).collect::<Vec<_>>();
        let low = std::array::from_fn(|set| {
            let data = of(set);
            let found = fit(vec![0.0; 3], data.len(), |p, row, slopes| {
                let m = data[row];
                let [a, b, c] = [p[0].exp(), p[1].exp(), p[2].exp()];
                let log = (c * m.depth).ln_1p();
                let scale = m.weight / m.sigma;
                slopes.extend([
                    (0, scale * a),
                    (1, scale * b * log * log),
                    (2, scale * 2.0 * b * log * c * m.depth / (1.0 + c * m.depth)),
                ]);
                scale * (a + b * log * log - m.sigma)
            });
            [found[0].exp(), found[1].exp(), found[2].exp()]
        });
        let data = of(SETS - 1);
        let found = fit(vec![-1.0, -4.0, 0.0, 0.0, -1.0], data.len(), |p, row, slopes| {
            let m = data[row];
            let e: Vec<f64> = p.iter().map(|p| p.exp()).collect();
            let (near, far) = ((e[2] * m.depth).ln_1p(), (e[4] * m.thickness).ln_1p());
            let scale = m.weight / m.sigma;
            slopes.extend([
                (0, scale * e[0]),
                (1, scale * e[1] * m.thickness * near * near),
                (2, scale * 2.0 * e[1] * m.thickness * near * e[2] * m.depth / (1.0 + e[2] * m.depth)),
                (3, scale * e[3] * far * far),
                (4, scale * 2.0 * e[3] * far * e[4] * m.thickness / (1.0 + e[4] * m.thickness)),
            ]);
            scale * (e[0] + e[1] * m.thickness * near * near + e[3] * far * far - m.sigma)
        });
        Self { low, high: std::array::from_fn(|i| found[i].exp()) }
    }
}

/// The spread of a set at a plane, of all directions and suns together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Index of the set.
    pub set: usize,
    /// Optical thickness of the slab.
    pub thickness: f64,
    /// Optical depth of the plane.
    pub depth: f64,
    /// Standard deviation of the entries about the mean of their class of directions.
    pub sigma: f64,
    /// Fourth root of the share of the slab's photons, for fits: a set counts most where it
    /// is bright, and everywhere a little.
    pub weight: f64,
}

/// The spreads that walks tell; those of slabs of one thickness count as one.
pub fn measure(walks: &[Walks]) -> Vec<Measured> {
    let mut thicknesses: Vec<f64> = walks.iter().map(|walk| walk.beam.thickness).collect();
    thicknesses.dedup();
    let mut all = Vec::new();
    for thickness in thicknesses {
        let mine: Vec<&Walks> = walks.iter().filter(|walk| walk.beam.thickness == thickness).collect();
        let of_plane = |set, plane| {
            mine.iter().fold((0.0, 0.0), |sum, walk| {
                classes(walk, set, plane).fold(sum, |(count, scatter), entries| {
                    (count + entries.count, scatter + 0.5 * entries.scatter().iter().sum::<f64>())
                })
            })
        };
        let planes = (0..SETS).flat_map(|set| (0..PLANES).map(move |plane| (set, plane)));
        let told: Vec<_> = planes.map(|(set, plane)| (set, plane, of_plane(set, plane))).collect();
        let whole: f64 = told.iter().map(|(.., (count, _))| count).sum();
        all.extend(
            told.into_iter().filter(|(.., (count, _))| *count >= LEAST_PHOTONS.max(LEAST_SHARE * whole)).map(
                |(set, plane, (count, scatter))| Measured {
                    set,
                    thickness,
                    depth: depth_at(point(plane, PLANES), thickness),
                    sigma: (scatter / count).sqrt(),
                    weight: (count / whole).sqrt().sqrt(),
                },
            ),
        );
    }
    all
}

/// The classes of direction of a set at a plane.
fn classes(walk: &Walks, set: usize, plane: usize) -> impl Iterator<Item = &Entries> {
    (0..COSINES)
        .flat_map(move |cosine| (0..AZIMUTHS).map(move |azimuth| walk.entries(set, plane, cosine, azimuth)))
}

#[cfg(test)]
mod tests {
    use super::super::Beam;
    use super::super::walks::Deflection;
    use super::*;
    use crate::optics::peak::Chopped;
    use crate::optics::phase::Phase;

    fn walks(thickness: f64) -> Vec<Walks> {
        let deflection = Deflection::chopped(&Chopped::new(Phase::mie(6.0).unwrap()));
        let suns = [0.1, 0.3, 0.6, 1.0].into_iter().enumerate();
        suns.map(|(i, mu0)| Walks::new(&deflection, Beam { thickness, mu0 }, 3000, 5, i as u64)).collect()
    }

    #[test]
    fn spread_is_that_of_other_random_walks() {
        // The fit's own error, and a tenth for the noise of few photons.
        for thickness in [4.0, 40.0] {
            for measured in measure(&walks(thickness)).iter().filter(|m| m.set >= 4) {
                let found = spread(measured.set, thickness, measured.depth);
                assert!((found / measured.sigma - 1.0).abs() < 0.3, "{found} for {measured:?}");
            }
        }
    }

    #[test]
    fn spread_rises_with_order_and_depth() {
        for (thickness, depth) in [(0.5, 0.1), (10.0, 5.0), (200.0, 190.0)] {
            for set in 1..SETS {
                assert!(spread(set, thickness, depth) > spread(set - 1, thickness, depth), "{set}");
                assert!(spread(set, thickness, depth) >= spread(set, thickness, 0.5 * depth), "{set}");
            }
        }
    }
}
