//! The map of the sun's light: where a point lies in it, and what is between its planes.

use std::f64::consts::PI;

use glam::DVec3;

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{input, line, one, scalars, three, two, vector, xyz};

/// A map with axes x[1..4], a square at x[4] and one of a fifth of its edge in the same corner.
const MAP: &str = "
    fn map(x: array<vec4f, 8>) -> SunMap {
        let finer = vec4f(x[4].xy, 5.0 * x[4].z, x[4].w);
        return SunMap(x[1].xyz, 2u, x[2].xyz, 0.0, x[3].xyz, 0.0, array(x[4], finer, finer), array<vec4f, 12>(), x[0].w);
    }";

/// A point, three axes at right angles, and a square of up to 100 km in which it lies.
fn placed(random: &mut Random) -> Input {
    let axes = random.turn();
    let edge = random.log(100.0, 1e5);
    let [u, v] = [(); 2].map(|()| random.between(-0.2, 1.2));
    let corner = [(); 2].map(|()| random.between(-1e5, 1e5));
    let along = random.between(-1e4, 1e4);
    let p = axes * DVec3::new(corner[0] + u * edge, corner[1] + v * edge, along);
    input([
        vector(p, 0.0),
        vector(axes.x_axis, 0.0),
        vector(axes.y_axis, 0.0),
        vector(axes.z_axis, 0.0),
        [corner[0], corner[1], 1.0 / edge, 0.0],
    ])
}

fn coordinate(x: &Wide) -> [f64; 3] {
    let [u, v] = [1, 2].map(|i| xyz(x[0]).dot(xyz(x[i])));
    [(u - x[4][0]) * x[4][2], (v - x[4][1]) * x[4][2], -x[0][1]]
}

fn square(x: &Wide) -> Output {
    let [u, v, _] = coordinate(x);
    let holds = |scale: f64| [u, v].iter().all(|at| (0.01..0.99).contains(&(at * scale)));
    // Where rounding decides, no number is right.
    let near =
        |scale: f64| [u, v].iter().any(|at| [0.01, 0.99].iter().any(|rim| (at * scale - rim).abs() < 1e-3));
    if near(1.0) || near(5.0) {
        return one(f64::NAN);
    }
    one(if holds(5.0) {
        1.0
    } else if holds(1.0) {
        0.0
    } else {
        2.0
    })
}

/// Where a point is: in a square, or beyond all, where the coarsest repeats itself.
fn placed_in(x: &Wide) -> Output {
    let ([u, v, _], [found, ..]) = (coordinate(x), square(x));
    let wraps = [u, v].iter().any(|at| (at - at.round()).abs() < 1e-3);
    if found.is_nan() || (found == 2.0 && wraps) {
        return [f64::NAN; 4];
    }
    match found {
        1.0 => [5.0 * u, 5.0 * v, 1.0, 1.0],
        0.0 => [u, v, 0.0, 1.0],
        _ => [u.rem_euclid(1.0), v.rem_euclid(1.0), 0.0, x[0][3]],
    }
}

fn passed(x: &Wide) -> Output {
    let (to, [begin, s, ..]) = (x[0], x[1]);
    let from = [begin, to[0], to[1], to[2]];
    std::array::from_fn(|i| ((s - from[i]) / (to[i] - from[i]).max(f64::from(1e-3f32))).clamp(0.0, 1.0))
}

/// Four planes that rise from where the first interval begins, and a place among them.
fn planes(random: &mut Random) -> Input {
    let begin = random.between(-1e4, 1e4);
    let step = random.log(1.0, 1e4);
    let mut at = begin;
    let planes = [(); 4].map(|()| {
        at += step * random.between(0.1, 1.0);
        at
    });
    input([planes, [begin, random.between(begin - step, at + step), 0.0, 0.0]])
}

pub fn twins() -> Vec<Twin> {
    vec![
        Twin::new(
            "sun_map_coordinate",
            "sun_map",
            "return vec4f(sun_map_coordinate(map(x), x[4], x[0].xyz), 0.0);",
            |x| three(coordinate(x).into()),
        )
        .declaring(MAP)
        .over("all", placed)
        // Sums of three products, some of which cancel.
        .beside(2e5),
        Twin::new(
            "sun_map_square",
            "sun_map",
            "return vec4f(f32(sun_map_square(map(x), x[0].xyz)));",
            square,
        )
        .declaring(MAP)
        .exact()
        .over("all", placed),
        Twin::new(
            "sun_map_place",
            "sun_map",
            "let here = sun_map_place(map(x), x[0].xyz);
            return vec4f(here.at.xy, f32(here.square), select(0.0, 1.0, here.known));",
            placed_in,
        )
        .declaring(MAP)
        .over("all", |random| {
            let mut x = placed(random);
            x[0][3] = if random.between(0.0, 1.0) < 0.5 { 0.0 } else { 1.0 };
            x
        })
        .beside(2e5),
        Twin::new("sun_map_passed", "sun_map", "return sun_map_passed(x[1].x, x[0], x[1].y);", passed)
            .over("all", planes),
        Twin::new("sun_map_planes", "sun_map", "return sun_map_planes(x[0], u32(x[1].x));", |x| {
            let [a, b, c, d] = x[0];
            [a, b, c, if x[1][0] > 2.5 { c } else { d }]
        })
        .exact()
        .edges(vec![
            input([[1.0, 2.0, 3.0, 4.0], [2.0, 0.0, 0.0, 0.0]]),
            input([[1.0, 2.0, 3.0, 4.0], [3.0, 0.0, 0.0, 0.0]]),
        ]),
        // Two streams: what comes out below is what went in, less what goes up again.
        Twin::new("sun_map_whole", "sun_map", "return vec4f(sun_map_whole(x[0].x, x[0].y, x[0].z));", |x| {
            let [depth, mu, turning, _] = x[0];
            let upright = mu * depth;
            one(((2.0 / 3.0 + mu) + (2.0 / 3.0 - mu) * (-upright / mu).exp())
                / (4.0 / 3.0 + turning * upright))
        })
        .over("all", |random| {
            scalars([random.log(1e-3, 1e3), random.between(0.05, 1.0), random.between(0.1, 1.9)])
        }),
        // The mean square of a disc's radius is half that of its rim.
        Twin::new("sun_map_diffused", "sun_map", "return vec4f(sun_map_diffused(x[0].x, x[0].y));", |x| {
            let [thickness, below, ..] = x[0];
            let mean_square = 2.0 / 3.0 * (thickness.powi(2) - (thickness - below).powi(2));
            one((2.0 * mean_square).sqrt())
        })
        .over("all", |random| {
            let thickness = random.log(1.0, 1e4);
            scalars([thickness, thickness * random.between(0.01, 1.0)])
        }),
        Twin::new("sun_map_through", "sun_map", "return vec4f(sun_map_through(x[0].x));", |x| {
            one((-x[0][0]).exp())
        })
        .edges(line(&[0.0, 1e-6, 1.0, 80.0, 30_000.0]))
        .over("all", |random| scalars([random.log(1e-4, 80.0)])),
        Twin::new("sun_map_depth", "sun_map", "return vec4f(sun_map_depth(x[0].x));", |x| {
            one(if x[0][0] >= 1.0 { 0.0 } else { -x[0][0].max(1e-6).ln() })
        })
        .edges(line(&[0.0, 1e-9, 0.25, 1.0, 1.001]))
        .over("all", |random| scalars([random.log(1e-5, 0.99)])),
        Twin::new("disc_tap", "sun_map", "return vec4f(disc_tap(u32(x[0].x)), 0.0, 0.0);", |x| {
            let golden = PI * (3.0 - 5f64.sqrt());
            let (radius, angle) = (((x[0][0].floor() + 0.5) / 8.0).sqrt(), golden * x[0][0].floor());
            two(radius * angle.cos(), radius * angle.sin())
        })
        .edges(line(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]))
        .beside(17.0),
    ]
}
