//! Ellipsoids that fill a mesh.
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

use super::Inside;
use crate::{Error, Result, scene::Ellipsoid};

/// Rounds of sharing out.
const ROUNDS: usize = 40;
/// Factors on all radii, of which the one is taken that overlaps the mesh best.
const FACTORS: [f64; 9] = [0.95, 1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3, 1.35];

/// Fewer points inside say nothing of a shape.
const LEAST_POINTS: usize = 8;
/// The greatest [`Inside::openness`] that is filled: half a ball without its base has 0.5, one flat by half 0.7, and a hilly sheet nearly 1.
const MOST_OPEN: f64 = 0.75;

/// Ellipsoids in a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Filled {
    /// The ellipsoids.
    pub ellipsoids: Vec<Ellipsoid>,
    /// Volume that mesh and ellipsoids share, over that of both together (Jaccard): 1 is perfect.
    pub overlap: f64,
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
    let count = count.min(points.len() / LEAST_POINTS);
    let least = inside.step * inside.step / 12.0;
    let mut owners = nearest(&points, &seeds(&points, count, seed));
    let mut parts = Vec::new();
    for _ in 0..ROUNDS {
        parts = of_owners(&points, &owners, count, least);
        let shared = points.iter().map(|&p| likeliest(&parts, p)).collect();
        if shared == owners {
            break;
        }
        owners = shared;
    }
    let scaled = |factor: f64| {
        let ellipsoids: Vec<_> = parts.iter().map(|part| part.ellipsoid(factor)).collect();
        Filled { overlap: overlap(inside, &ellipsoids), ellipsoids }
    };
    let best = FACTORS.map(scaled).into_iter().max_by(|a, b| a.overlap.total_cmp(&b.overlap));
    best.ok_or_else(|| Error::Argument("no ellipsoid fits".to_owned()))
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
fn of_owners(points: &[DVec3], owners: &[usize], count: usize, least: f64) -> Vec<Part> {
    let mut sums = vec![(0f64, DVec3::ZERO); count];
    for (p, &owner) in points.iter().zip(owners) {
        sums[owner].0 += 1.0;
        sums[owner].1 += *p;
    }
    let means: Vec<_> = sums.iter().map(|(n, sum)| sum / n.max(1.0)).collect();
    let mut spreads = vec![DMat3::ZERO; count];
    for (p, &owner) in points.iter().zip(owners) {
        let d = *p - means[owner];
        spreads[owner] += DMat3::from_cols(d.x * d, d.y * d, d.z * d);
    }
    let part = |i: usize| {
        let n = sums[i].0;
        // A point stands for a cell of the grid, and has its width.
        let covariance = spreads[i] * (1.0 / n) + DMat3::from_diagonal(DVec3::splat(least));
        let offset = covariance.determinant().ln() - 2.0 * (n / points.len() as f64).ln();
        Part { mean: means[i], inverse: covariance.inverse(), offset, covariance }
    };
    (0..count).filter(|&i| sums[i].0 >= 4.0).map(part).collect()
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

/// Volume shared by the inside of the mesh and the ellipsoids over that of both together.
fn overlap(inside: &Inside, ellipsoids: &[Ellipsoid]) -> f64 {
    let holds = |e: &Ellipsoid, p: DVec3| {
        ((e.orientation.inverse() * (p - e.center)) / e.radii).length_squared() < 1.0
    };
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
