//! Short forms for inputs and results.

use glam::DVec3;

use crate::harness::{Input, Output};

pub fn xyz(v: [f64; 4]) -> DVec3 {
    DVec3::new(v[0], v[1], v[2])
}

pub fn three(v: DVec3) -> Output {
    [v.x, v.y, v.z, f64::NAN]
}

pub fn two(a: f64, b: f64) -> Output {
    [a, b, f64::NAN, f64::NAN]
}

pub fn one(v: f64) -> Output {
    [v, f64::NAN, f64::NAN, f64::NAN]
}

/// The first places of an input, the rest 0.
pub fn input<const N: usize>(first: [[f64; 4]; N]) -> Input {
    let mut whole = [[0.0; 4]; 8];
    for (to, from) in whole.iter_mut().zip(first) {
        *to = from.map(|x| x as f32);
    }
    whole
}

/// Up to four numbers.
pub fn scalars<const N: usize>(values: [f64; N]) -> Input {
    let mut first = [0.0; 4];
    first[..N].copy_from_slice(&values);
    input([first])
}

pub fn vector(v: DVec3, w: f64) -> [f64; 4] {
    [v.x, v.y, v.z, w]
}

/// All combinations.
pub fn grid(a: &[f32], b: &[f32], c: &[f32], d: &[f32]) -> Vec<Input> {
    let mut list = Vec::new();
    for &a in a {
        for &b in b {
            for &c in c {
                list.extend(d.iter().map(|&d| scalars([a, b, c, d].map(f64::from))));
            }
        }
    }
    list
}

pub fn line(a: &[f32]) -> Vec<Input> {
    grid(a, &[0.0], &[0.0], &[0.0])
}

pub fn plane(a: &[f32], b: &[f32]) -> Vec<Input> {
    grid(a, b, &[0.0], &[0.0])
}

/// A reference channel by channel.
pub fn each(v: [f64; 4], f: impl Fn(f64) -> f64) -> Output {
    [f(v[0]), f(v[1]), f(v[2]), f64::NAN]
}
