//! Fits of many parameters by Levenberg and Marquardt's method, where each residual
//! depends on few of them.

/// Rounds of a fit at most.
const ROUNDS: usize = 80;

/// Relative gain of a round under which a fit counts as done.
const SETTLED: f64 = 1e-6;

/// Parameters that a residual depends on, each with the residual's derivative by it.
pub(super) type Slopes = Vec<(usize, f64)>;

/// The parameters near `start` that minimise the sum of the squares of `rows` residuals.
///
/// `residual(parameters, row, slopes)` gives a residual and puts its derivatives into
/// `slopes`, which comes empty.
pub(super) fn fit(
    start: Vec<f64>,
    rows: usize,
    residual: impl Fn(&[f64], usize, &mut Slopes) -> f64,
) -> Vec<f64> {
    let cost = |parameters: &[f64]| -> f64 {
        let mut slopes = Slopes::new();
        (0..rows)
            .map(|row| {
                slopes.clear();
                residual(parameters, row, &mut slopes).powi(2)
            })
            .sum()
    };
    let mut best = start;
    let mut least = cost(&best);
    let mut damping = 1e-3;
    for _ in 0..ROUNDS {
        let (matrix, gradient) = normal_equations(&best, rows, &residual);
        let before = least;
        while damping < 1e8 {
            let trial: Vec<f64> =
                best.iter().zip(damped_step(&matrix, &gradient, damping)).map(|(p, step)| p - step).collect();
            let found = cost(&trial);
            if found < least {
                (best, least) = (trial, found);
                damping *= 0.2;
                break;
            }
            damping *= 4.0;
        }
        if before - least <= SETTLED * before {
            break;
        }
    }
    best
}

/// J^T J, of which the lower triangle is filled, and J^T r.
fn normal_equations(
    parameters: &[f64],
    rows: usize,
    residual: &impl Fn(&[f64], usize, &mut Slopes) -> f64,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let n = parameters.len();
    let (mut matrix, mut gradient) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    let mut slopes = Slopes::new();
    for row in 0..rows {
        slopes.clear();
        let value = residual(parameters, row, &mut slopes);
        for &(i, by_i) in &slopes {
            gradient[i] += by_i * value;
            for &(j, by_j) in slopes.iter().filter(|(j, _)| *j <= i) {
                matrix[i][j] += by_i * by_j;
            }
        }
    }
    (matrix, gradient)
}

/// Solves (A + damping diag A) x = b by Cholesky's factors; parameters that nothing
/// depends on stay.
fn damped_step(matrix: &[Vec<f64>], gradient: &[f64], damping: f64) -> Vec<f64> {
    let n = gradient.len();
    let mut lower = matrix.to_vec();
    for i in 0..n {
        let scale = matrix[i][i] * (1.0 + damping);
        lower[i][i] = if scale > 0.0 { scale } else { 1.0 };
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            lower[i][j] = if i == j {
                (lower[i][i] - sum).max(1e-12 * scale.max(f64::MIN_POSITIVE)).sqrt()
            } else {
                (lower[i][j] - sum) / lower[j][j]
            };
        }
    }
    let mut x = gradient.to_vec();
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| lower[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / lower[i][i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| lower[k][i] * x[k]).sum();
        x[i] = (x[i] - sum) / lower[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_gives_its_parameters_back() {
        let right = [2.0, -0.7, 0.3];
        let model = |p: &[f64], x: f64| p[0] * (p[1] * x).exp() + p[2];
        let found = fit(vec![1.0, -0.1, 0.0], 30, |p, row, slopes| {
            let x = 0.2 * row as f64;
            let lobe = (p[1] * x).exp();
            slopes.extend([(0, lobe), (1, p[0] * x * lobe), (2, 1.0)]);
            model(p, x) - model(&right, x)
        });
        for (found, right) in found.iter().zip(right) {
            assert!((found - right).abs() < 1e-6, "{found} for {right}");
        }
    }

    #[test]
    fn what_nothing_depends_on_stays() {
        let found = fit(vec![1.0, 5.0], 1, |p, _, slopes| {
            slopes.push((0, 1.0));
            p[0] - 3.0
        });
        assert!((found[0] - 3.0).abs() < 1e-6 && found[1] == 5.0, "{found:?}");
    }
}
