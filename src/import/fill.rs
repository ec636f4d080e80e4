//! Ellipsoids that fill a mesh, or that are where points are.
//!
//! Points inside are shared out among ellipsoids as in a mixture of normal distributions (Celeux and
//! Govaert 1992, classification EM): each point goes to the ellipsoid that most likely has it, and each
//! ellipsoid takes the mean and the second moments of its points. A solid ellipsoid has variances of a
//! fifth of its squared radii.

use glam::{DMat3, DQuat, DVec3};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{RngCore, SeedableRng},
};

use super::{Inside, points::Point};
use crate::{Error, Result, scene::Ellipsoid};

/// Rounds of sharing out.
const ROUNDS: usize = 40;
/// Factors on all radii, of which the one is taken that overlaps the mesh best.
const FACTORS: [f64; 9] = [0.95, 1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3, 1.35];

/// Fewer points inside say nothing of a shape.
const LEAST_POINTS: usize = 8;
/// Most points of a cloud of them that ellipsoids are fitted to: of more, every second one, or every third ...
const MOST_POINTS: usize = 200_000;
/// Points whose distances to all others are looked at.
const PROBES: usize = 64;
/// Share of the points that ellipsoids have to hold.
const HELD: f64 = 0.95;
/// The greatest [`Inside::openness`] that is filled: half a ball without its base has 0.5, one flat by half 0.7, and a hilly sheet nearly 1.
const MOST_OPEN: f64 = 0.75;

/// Ellipsoids in a mesh, or where points are.
#[derive(Debug, Clone, PartialEq)]
pub struct Filled {
    /// The ellipsoids.
    pub ellipsoids: Vec<Ellipsoid>,
    /// Volume that mesh and ellipsoids share, over that of both together (Jaccard), or the share of the points that lie in
    /// them: 1 is perfect.
    pub overlap: f64,
}

/// What a part of a shape weighs, where it is and how far it reaches.
#[derive(Debug, Clone, Copy)]
struct Sample {
    place: DVec3,
    weight: f64,
    /// Along each axis, m^2.
    variance: f64,
}

/// One of the mixture.
#[derive(Clone, Copy)]
struct Part {
    mean: DVec3,
    /// Inverse of the covariance, and the logarithm of its determinant less the one of the share of points.
    inverse: DMat3,
    offset: f64,
    covariance: DMat3,
}

/// At most `count` ellipsoids that fill the inside of a mesh as well as they can; the same `seed` gives
/// the same ones.
///
/// # Errors
/// [`Error::Argument`] where the mesh encloses nothing, or is more open than closed.
pub fn fill(inside: &Inside, count: usize, seed: u64) -> Result<Filled> {
    let points = inside.points();
    check_closed(inside, points.len())?;
    // A point stands for a cell of the grid, and has its width.
    let variance = inside.step * inside.step / 12.0;
    let samples: Vec<_> = points.into_iter().map(|place| Sample { place, weight: 1.0, variance }).collect();
    let parts = mixture(&samples, count.min(samples.len() / LEAST_POINTS), seed);
    let scaled = |factor: f64| {
        let ellipsoids: Vec<_> = parts.iter().map(|part| part.ellipsoid(factor)).collect();
        Filled { overlap: overlap(inside, &ellipsoids), ellipsoids }
    };
    let best = FACTORS.map(scaled).into_iter().max_by(|a, b| a.overlap.total_cmp(&b.overlap));
    best.ok_or_else(|| Error::Argument("no ellipsoid fits".to_owned()))
}

/// At most `count` ellipsoids that are where `points` are, as large as it takes to hold nearly all of them; the same `seed` gives
/// the same ones. Points with a radius are balls, and weigh as those do; others reach half way to their neighbours.
///
/// # Errors
/// [`Error::Argument`] where there are too few points, or all are in one place.
pub fn fill_points(points: &[Point], count: usize, seed: u64) -> Result<Filled> {
    if points.len() < LEAST_POINTS {
        return Err(Error::Argument(format!(
            "{} points say nothing of a shape: {LEAST_POINTS} are needed, and better hundreds",
            points.len()
        )));
    }
    let some: Vec<Point> = points.iter().step_by(points.len().div_ceil(MOST_POINTS)).copied().collect();
    let spacing = spacing(&some);
    let sample = |point: &Point| match point.radius {
        radius if radius > 0.0 => {
            Sample { place: point.place, weight: radius.powi(3), variance: radius * radius / 5.0 }
        }
        _ => Sample { place: point.place, weight: spacing.powi(3), variance: spacing * spacing / 12.0 },
    };
    let samples: Vec<Sample> = some.iter().map(sample).collect();
    if samples.iter().any(|sample| sample.variance <= 0.0) {
        return Err(Error::Argument(
            "all points are in one place: give them radii, or export others".to_owned(),
        ));
    }
    let parts = mixture(&samples, count.min(samples.len() / LEAST_POINTS), seed);
    let scaled = |factor: f64| {
        let ellipsoids: Vec<_> = parts.iter().map(|part| part.ellipsoid(factor)).collect();
        let held = some.iter().filter(|point| ellipsoids.iter().any(|e| holds(e, point.place))).count();
        Filled { overlap: held as f64 / some.len() as f64, ellipsoids }
    };
    let all = FACTORS.map(scaled);
    let most = all.iter().map(|filled| filled.overlap).fold(0.0, f64::max);
    let enough = all.into_iter().find(|filled| filled.overlap >= HELD.min(most));
    enough.ok_or_else(|| Error::Argument("no ellipsoid fits".to_owned()))
}

/// How far points are apart, m: the median of some from their nearest neighbour elsewhere.
fn spacing(points: &[Point]) -> f64 {
    let probes = points.iter().step_by(points.len().div_ceil(PROBES));
    let nearest = probes.map(|probe| {
        let distances = points.iter().map(|point| point.place.distance_squared(probe.place));
        distances.filter(|distance| *distance > 0.0).fold(f64::INFINITY, f64::min).sqrt()
    });
    let mut nearest: Vec<f64> = nearest.filter(|distance| distance.is_finite()).collect();
    nearest.sort_by(f64::total_cmp);
    nearest.get(nearest.len() / 2).copied().unwrap_or(0.0)
}

/// At most `count` normal distributions that share out the samples.
fn mixture(samples: &[Sample], count: usize, seed: u64) -> Vec<Part> {
    let points: Vec<DVec3> = samples.iter().map(|sample| sample.place).collect();
    let mut owners = nearest(&points, &seeds(&points, count, seed));
    let mut parts = Vec::new();
    for _ in 0..ROUNDS {
        parts = of_owners(samples, &owners, count);
        let shared = points.iter().map(|&p| likeliest(&parts, p)).collect();
        if shared == owners {
            break;
        }
        owners = shared;
    }
    parts
}

/// Holes may be filled over, but a sheet encloses nothing.
fn check_closed(inside: &Inside, points: usize) -> Result<()> {
    let problem = match inside.openness {
        0.0 if points < LEAST_POINTS => {
            "the mesh encloses nothing: it must be closed, and its faces must look outwards".to_owned()
        }
        open if points < LEAST_POINTS || open > MOST_OPEN => format!(
            "the mesh is open and encloses nothing that can be filled: its openings, or faces that look the other \
             way, are {:.0} % of its surface; close its holes and have all faces look outwards",
            100.0 * open
        ),
        _ => return Ok(()),
    };
    Err(Error::Argument(problem))
}

/// Points far from one another, as k-means++ (Arthur and Vassilvitskii 2007) begins.
fn seeds(points: &[DVec3], count: usize, seed: u64) -> Vec<DVec3> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || random.next_u32() as f64 / 2f64.powi(32);
    let mut seeds = vec![points[(uniform() * points.len() as f64) as usize]];
    let mut distances = vec![f64::INFINITY; points.len()];
    while seeds.len() < count {
        let last = seeds[seeds.len() - 1];
        for (distance, point) in distances.iter_mut().zip(points) {
            *distance = distance.min(point.distance_squared(last));
        }
        let mut left = uniform() * distances.iter().sum::<f64>();
        let next = distances.iter().position(|distance| {
            left -= distance;
            left < 0.0
        });
        seeds.push(points[next.unwrap_or(0)]);
    }
    seeds
}

fn nearest(points: &[DVec3], seeds: &[DVec3]) -> Vec<usize> {
    let owner = |p: &DVec3| least_of(seeds, |seed| seed.distance_squared(*p));
    points.iter().map(owner).collect()
}

fn likeliest(parts: &[Part], p: DVec3) -> usize {
    least_of(parts, |part| (p - part.mean).dot(part.inverse * (p - part.mean)) + part.offset)
}

fn least_of<T>(list: &[T], value: impl Fn(&T) -> f64) -> usize {
    let values = list.iter().map(value).enumerate();
    values.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
}

/// Those that have points.
fn of_owners(samples: &[Sample], owners: &[usize], count: usize) -> Vec<Part> {
    let mut sums = vec![(0usize, 0.0, DVec3::ZERO, 0.0); count];
    for (sample, &owner) in samples.iter().zip(owners) {
        let (number, weight, place, variance) = &mut sums[owner];
        *number += 1;
        *weight += sample.weight;
        *place += sample.weight * sample.place;
        *variance += sample.weight * sample.variance;
    }
    let means: Vec<_> =
        sums.iter().map(|(_, weight, place, _)| place / weight.max(f64::MIN_POSITIVE)).collect();
    let mut spreads = vec![DMat3::ZERO; count];
    for (sample, &owner) in samples.iter().zip(owners) {
        let d = sample.place - means[owner];
        spreads[owner] += DMat3::from_cols(d.x * d, d.y * d, d.z * d) * sample.weight;
    }
    let whole: f64 = sums.iter().map(|(_, weight, ..)| weight).sum();
    let part = |i: usize| {
        let (_, weight, _, variance) = sums[i];
        let covariance = spreads[i] * (1.0 / weight) + DMat3::from_diagonal(DVec3::splat(variance / weight));
        let offset = covariance.determinant().ln() - 2.0 * (weight / whole).ln();
        Part { mean: means[i], inverse: covariance.inverse(), offset, covariance }
    };
    (0..count).filter(|&i| sums[i].0 >= 4).map(part).collect()
}

impl Part {
    fn ellipsoid(&self, factor: f64) -> Ellipsoid {
        let (variances, axes) = principal(self.covariance);
        let radii = DVec3::from(variances.map(|variance| factor * (5.0 * variance).sqrt()));
        Ellipsoid { orientation: DQuat::from_mat3(&axes).normalize(), ..Ellipsoid::new(self.mean, radii) }
    }
}

/// Principal values and axes (a rotation) of a symmetric matrix, by Jacobi's rotations.
fn principal(mut matrix: DMat3) -> ([f64; 3], DMat3) {
    let mut axes = DMat3::IDENTITY;
    for round in 0..24 {
        let (i, j) = [(0, 1), (0, 2), (1, 2)][round % 3];
        let off = matrix.col(j)[i];
        let angle = 0.5 * (2.0 * off).atan2(matrix.col(j)[j] - matrix.col(i)[i]);
        let mut turn = DMat3::IDENTITY;
        let (sin, cos) = angle.sin_cos();
        (turn.col_mut(i)[i], turn.col_mut(j)[j]) = (cos, cos);
        (turn.col_mut(i)[j], turn.col_mut(j)[i]) = (-sin, sin);
        matrix = turn.transpose() * matrix * turn;
        axes *= turn;
    }
    ([0, 1, 2].map(|i| matrix.col(i)[i].max(0.0)), axes)
}

fn holds(e: &Ellipsoid, p: DVec3) -> bool {
    ((e.orientation.inverse() * (p - e.center)) / e.radii).length_squared() < 1.0
}

/// Volume shared by the inside of the mesh and the ellipsoids over that of both together.
fn overlap(inside: &Inside, ellipsoids: &[Ellipsoid]) -> f64 {
    let (mut both, mut any) = (0.0, 0.0);
    for (p, in_mesh) in inside.each(6) {
        let in_ellipsoids = ellipsoids.iter().any(|e| holds(e, p));
        both += f64::from(u8::from(in_mesh && in_ellipsoids));
        any += f64::from(u8::from(in_mesh || in_ellipsoids));
    }
    both / f64::max(any, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_axes_make_the_matrix_again() {
        let turned = DMat3::from_quat(DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8));
        let matrix = turned * DMat3::from_diagonal(DVec3::new(9.0, 4.0, 1.0)) * turned.transpose();
        let (values, axes) = principal(matrix);
        assert!((axes.determinant() - 1.0).abs() < 1e-12);
        let again = axes * DMat3::from_diagonal(values.into()) * axes.transpose();
        assert!(again.abs_diff_eq(matrix, 1e-9), "{values:?}");
        let mut sorted = values;
        sorted.sort_by(f64::total_cmp);
        assert!((sorted[0] - 1.0).abs() + (sorted[2] - 9.0).abs() < 1e-9);
    }
}
