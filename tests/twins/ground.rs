//! What a sea mirrors, and how a pixel sees a pattern of land.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, plane, scalars, three, vector, xyz};

/// Refractive index of sea water, as a float.
fn index() -> f64 {
    f64::from(1.34f32)
}

/// Fresnel's equations by the cosine of the refracted ray.
fn fresnel(cosine: f64) -> f64 {
    let refracted = (1.0 - (1.0 - cosine * cosine) / index().powi(2)).sqrt();
    let share = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    0.5 * (share(cosine, index() * refracted) + share(index() * cosine, refracted))
}

/// Facets that hide, for each that does not: Walter's fit of Smith's integral, of the cotangent over the width of slopes.
fn hidden(mu: f64, variance: f64) -> f64 {
    let a = mu / ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt() / variance.sqrt();
    let c = |x: f32| f64::from(x);
    let fit = (1.0 - c(1.259) * a + c(0.396) * a * a) / (c(3.535) * a + c(2.181) * a * a);
    if a < c(1.6) { fit.max(0.0) } else { 0.0 }
}

/// The density of slopes at that which mirrors the sun, by the Jacobian of slopes to directions.
fn glitter(x: &Wide) -> Output {
    let (eye, sun, variance) = (xyz(x[0]), xyz(x[1]), x[0][3]);
    let middle = eye + sun;
    let tangent = DVec2::new(middle.x, middle.z).length() / middle.y;
    let density = (-tangent * tangent / variance).exp() / (PI * variance);
    let seen = 1.0 / (1.0 + hidden(eye.y, variance) + hidden(sun.y, variance));
    let cosine = 0.5 * middle.length();
    one(fresnel(cosine.min(1.0)) * density * (1.0 + tangent * tangent).powi(2) * seen / (4.0 * eye.y))
}

/// A direction that rises, one in three at a grazing angle.
fn rising(random: &mut Random) -> DVec3 {
    let y = [random.between(0.05, 1.0), random.log(1e-3, 0.1)][usize::from(random.index(3) == 0)];
    let azimuth = random.between(0.0, 2.0 * PI);
    let level = (1.0 - y * y).sqrt();
    DVec3::new(level * azimuth.cos(), y, level * azimuth.sin())
}

fn two_rising(random: &mut Random) -> Input {
    let variance = random.between(0.003, 0.11);
    input([vector(rising(random), variance), vector(rising(random), 0.0)])
}

/// A facet's slopes are 0 or the root of 3 times their standard deviation off along each axis.
fn facet(x: &Wide) -> (DVec3, f64) {
    let number = x[1][0] as i32;
    let off = (3.0 * 0.5 * x[0][3]).sqrt();
    let (i, j) = (number % 3 - 1, number / 3 - 1);
    let weight = |i: i32| if i == 0 { 2.0 / 3.0 } else { 1.0 / 6.0 };
    let across = DVec3::new(-off * f64::from(i), 1.0, -off * f64::from(j));
    (across.normalize(), weight(i) * weight(j) * across.dot(xyz(x[0])).max(0.0))
}

fn numbered(random: &mut Random) -> Input {
    let [number, variance] = [random.index(9) as f64, random.between(0.003, 0.11)];
    input([vector(rising(random), variance), [number, 0.0, 0.0, 0.0]])
}

/// The longer of two ways, and the binary logarithm of what a tap along it stands for, in texels.
fn pattern(x: &Wide) -> (DVec2, f64) {
    let [a, b] = [DVec2::new(x[0][0], x[0][1]), DVec2::new(x[0][2], x[0][3])];
    let (longer, shorter) = if b.length() > a.length() { (b, a) } else { (a, b) };
    (longer, (512.0 * shorter.length().max(longer.length() / 4.0)).log2())
}

fn ways(random: &mut Random) -> Input {
    let size = random.log(1e-4, 1.0);
    let mut way = || size * random.direction();
    let (a, b) = (way(), 0.3 * way());
    input([[a.x, a.y, b.x, b.y]])
}

pub fn twins() -> Vec<Twin> {
    vec![
        Twin::new("with_cosine", "ground", "return vec4f(with_cosine(x[0].xyz, x[0].w), 0.0);", |x| {
            let azimuth = x[0][2].atan2(x[0][0]);
            let mu = x[0][3];
            let sine = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
            three(DVec3::new(sine * azimuth.cos(), mu, sine * azimuth.sin()))
        })
        .over("all", |random| {
            let d = rising(random);
            input([vector(d, random.cosine())])
        })
        .beside(1.0),
        Twin::new("water_fresnel", "water", "return vec4f(water_fresnel(x[0].x));", |x| {
            one(fresnel(x[0][0]))
        })
        .edges(line(&[0.0, 1e-6, 0.5, 1.0]))
        .over("all", |random| scalars([random.log(1e-6, 1.0)])),
        Twin::new("water_hidden", "water", "return vec4f(water_hidden(x[0].x, x[0].y));", |x| {
            one(hidden(x[0][0], x[0][1]))
        })
        .edges(plane(&[1e-4, 0.01, 0.9], &[0.003, 0.1]))
        .over("all", |random| scalars([random.log(1e-4, 0.99), random.between(0.003, 0.11)]))
        .beside(1.0),
        Twin::new(
            "water_glitter",
            "water",
            "return vec4f(water_glitter(x[0].xyz, x[1].xyz, x[0].w));",
            glitter,
        )
        .over("all", two_rising),
        Twin::new(
            "water_facet",
            "water",
            "let f = water_facet(u32(x[1].x), x[0].xyz, x[0].w); return vec4f(f.normal, f.seen);",
            |x| {
                let (normal, seen) = facet(x);
                [normal.x, normal.y, normal.z, seen]
            },
        )
        .over("all", numbered)
        .beside(1.0),
        Twin::new("water_mirrored", "water", "return vec4f(water_mirrored(x[0].xyz, x[1].xyz), 0.0);", |x| {
            // What is along the normal stays, the rest turns round.
            let (normal, eye) = (xyz(x[0]), xyz(x[1]));
            let along = eye.dot(normal) * normal;
            let d = along - (eye - along);
            three(DVec3::new(d.x, d.y.abs(), d.z))
        })
        .over("all", two_rising)
        .beside(1.0),
        Twin::new(
            "pattern_view",
            "ground",
            "let v = pattern_view(x[0].xy, x[0].zw, vec3f(512.0, 512.0, 6.0));
             return vec4f(v.along, v.layer, v.known);",
            |x| {
                let (along, level) = pattern(x);
                let layer = (level.clamp(0.0, 5.0) + 0.5) / 6.0;
                [along.x, along.y, layer, (6.0 - level).clamp(0.0, 1.0)]
            },
        )
        .edges(grid(&[1e-3, 0.5], &[0.0], &[0.0, 1e-4], &[0.25]))
        .over("all", ways)
        .beside(1.0),
    ]
}
