//! Directions of a slab's light: quadrature over a hemisphere, and Legendre functions.

use std::f64::consts::PI;

/// Gauss and Legendre's quadrature over the interval from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// Abscissas, falling from 1 to 0.
    pub mu: Vec<f64>,
    /// Weights; they sum to 1.
    pub weight: Vec<f64>,
}

impl Quadrature {
    /// The rule of `n` points, exact for polynomials of degree 2n - 1.
    pub fn new(n: usize) -> Self {
        let (mu, weight) = (0..n).map(|i| point(n, i)).unzip();
        Self { mu, weight }
    }

    /// The rule of `n` points on each of `parts` equal parts of the interval: for what bends
    /// sharply here and there, where one rule of as many points is no better and takes their
    /// square to make.
    pub fn composite(parts: usize, n: usize) -> Self {
        let rule = Self::new(n);
        let width = 1.0 / parts as f64;
        let starts = || (0..parts).rev().map(|part| part as f64);
        Self {
            mu: starts().flat_map(|start| rule.mu.iter().map(move |x| width * (start + x))).collect(),
            weight: starts().flat_map(|_| rule.weight.iter().map(|weight| width * weight)).collect(),
        }
    }
}

/// Newton's steps after which a point has all its digits: from Tricomi's estimate each doubles
/// them, and the last ones of large rules don't come to rest.
const MOST_STEPS: usize = 8;

/// Abscissa `i` of `n` on the interval from 0 to 1, and its weight, by Newton's method
/// from Tricomi's estimate.
fn point(n: usize, i: usize) -> (f64, f64) {
    let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
    let mut slope = 1.0;
    for _ in 0..MOST_STEPS {
        let (value, derivative) = legendre(n, x);
        slope = derivative;
        let step = value / derivative;
        x -= step;
        if step.abs() <= f64::EPSILON {
            break;
        }
    }
    (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
}

/// Legendre polynomial P_n and its derivative at `x` strictly between -1 and 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for l in 1..n {
        let l = l as f64;
        (before, value) = (value, ((2.0 * l + 1.0) * x * value - l * before) / (l + 1.0));
    }
    (value, n as f64 * (before - x * value) / (1.0 - x * x))
}

/// The Legendre polynomials P_0, P_1, ... at `x` from -1 to 1, without end.
pub fn legendre_polynomials(x: f64) -> impl Iterator<Item = f64> {
    let (mut before, mut value) = (0.0, 1.0);
    (0_u32..).map(move |l| {
        let (now, l) = (value, f64::from(l));
        (before, value) = (now, ((2.0 * l + 1.0) * x * now - l * before) / (l + 1.0));
        now
    })
}

/// Sum over l of `terms[l] P_l(x)`, `x` from -1 to 1.
pub fn legendre_series(terms: &[f64], x: f64) -> f64 {
    terms.iter().zip(legendre_polynomials(x)).map(|(term, value)| term * value).sum()
}

/// Normalised Legendre functions sqrt((l-m)!/(l+m)!) P_l^m(mu) for l from `m` to `degree`,
/// without the sign (-1)^m: the functions in which the addition theorem reads
/// P_l(cos Theta) = sum_m (2 - delta_m0) L_l^m(mu) L_l^m(mu') cos m(phi - phi').
pub fn legendre_functions(m: usize, degree: usize, mu: f64) -> Vec<f64> {
    let sine = (1.0 - mu * mu).max(0.0).sqrt();
    let mut first = 1.0;
    for k in 1..=m {
        let k = k as f64;
        first *= sine * ((2.0 * k - 1.0) / (2.0 * k)).sqrt();
    }
    let mut values = vec![first];
    let mut before = 0.0;
    for l in m + 1..=degree {
        let (l, m) = (l as f64, m as f64);
        let last = values[values.len() - 1];
        let norm = |l: f64| ((l - m) * (l + m)).sqrt();
        let next = ((2.0 * l - 1.0) * mu * last - norm(l - 1.0) * before) / norm(l);
        before = last;
        values.push(next);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_integrates_polynomials_of_its_degree() {
        let rule = Quadrature::new(7);
        for degree in 0..14 {
            let sum: f64 = rule.mu.iter().zip(&rule.weight).map(|(x, w)| w * x.powi(degree)).sum();
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 1e-14, "degree {degree}: {sum}");
        }
    }

    #[test]
    fn composite_rule_integrates_polynomials_of_its_degree_and_what_bends() {
        let rule = Quadrature::composite(5, 4);
        let sum = |f: &dyn Fn(f64) -> f64| -> f64 {
            rule.mu.iter().zip(&rule.weight).map(|(x, weight)| weight * f(*x)).sum()
        };
        for degree in 0..8 {
            let found = sum(&|x| x.powi(degree));
            assert!((found - 1.0 / f64::from(degree + 1)).abs() < 1e-14, "degree {degree}: {found}");
        }
        assert!((sum(&|x| (x - 0.4).abs()) - 0.26).abs() < 1e-14, "a bend where two parts meet");
        assert!(rule.mu.is_sorted_by(|a, b| a > b), "{:?}", rule.mu);
    }

    #[test]
    fn legendre_functions_satisfy_the_addition_theorem() {
        let (mu, other, azimuth) = (0.3_f64, -0.7_f64, 1.1_f64);
        let cosine = mu * other + ((1.0 - mu * mu) * (1.0 - other * other)).sqrt() * azimuth.cos();
        for l in [2usize, 5, 40] {
            let sum: f64 = (0..=l)
                .map(|m| {
                    let twice = if m == 0 { 1.0 } else { 2.0 };
                    let at = |mu: f64| legendre_functions(m, l, mu)[l - m];
                    twice * at(mu) * at(other) * (m as f64 * azimuth).cos()
                })
                .sum();
            assert!((sum - legendre(l, cosine).0).abs() < 1e-12, "l {l}: {sum}");
        }
    }
}
