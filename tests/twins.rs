//! Every function of `shaders/lib` against a double-precision reference written from
//! its definition, not transcribed: a grid with edge cases, a tolerance with its reason.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3};
use nephos::gpu::LIBRARY;

/// A shader function, its inputs and what it should give.
struct Twin {
    name: &'static str,
    uses: &'static str,
    /// WGSL body of `evaluate(x: array<vec4f, 7>) -> vec4f`.
    body: &'static str,
    inputs: Vec<[[f32; 4]; 7]>,
    /// The same in f64; NaN in a place means "not compared".
    reference: fn(&[[f64; 4]; 7]) -> [f64; 4],
    relative: f64,
    absolute: f64,
}

/// Covered elsewhere, with the reason.
const ELSEWHERE: &[(&str, &str)] = &[
    ("noise_at", "reads a texture: tests/noise.rs compares it with the baked volume"),
    ("slab_source", "reads the table: tests/slab_render.rs compares it with the reference"),
    ("slab_fit_of", "reads sun maps, as the next: tests/slab_render.rs holds pictures against slabs"),
    ("slab_fit", "the same"),
    ("slab_fit_kol", "the same"),
    ("slab_fit_gaussian", "the same"),
    ("slab_fit_view", "the same"),
    ("slab_fit_bouthors", "the same"),
];

fn unit(e: &[[f64; 4]; 7], p: DVec3, w: f64) -> DVec3 {
    let (q, r, c) = ellipsoid(e);
    DMat3::from_quat(q).transpose() * (p - w * c) / r
}

/// Orientation, radii and centre that `ellipsoids()` packed into the first two inputs.
fn ellipsoid(x: &[[f64; 4]; 7]) -> (DQuat, DVec3, DVec3) {
    let orientation = DQuat::from_xyzw(x[0][0], x[0][1], x[0][2], x[0][3]).normalize();
    (orientation, DVec3::new(x[1][0], x[1][1], x[1][2]), xyz(x[2]))
}

fn xyz(v: [f64; 4]) -> DVec3 {
    DVec3::new(v[0], v[1], v[2])
}

fn out(v: DVec3) -> [f64; 4] {
    [v.x, v.y, v.z, f64::NAN]
}

fn one(v: f64) -> [f64; 4] {
    [v, f64::NAN, f64::NAN, f64::NAN]
}

/// WGSL that unpacks an ellipsoid: orientation, radii (w: core), centre (w: extinction),
/// displacement, rise, wispiness.
const MAKE: &str = "
    fn row(q: vec4f, axis: vec3f, r: f32) -> vec4f {
        let t = 2.0 * cross(q.xyz, axis);
        return vec4f((axis + q.w * t + cross(q.xyz, t)) / r, 1.0 / r);
    }
    fn make(x: array<vec4f, 7>) -> Ellipsoid {
        return Ellipsoid(row(x[0], vec3f(1, 0, 0), x[1].x), row(x[0], vec3f(0, 1, 0), x[1].y),
            row(x[0], vec3f(0, 0, 1), x[1].z), x[2].xyz, x[2].w, x[3].x, x[3].y, x[3].z, x[1].w);
    }";

/// PCG RXS-M-XS with 32 bits (O'Neill 2014): output and next state.
fn pcg(state: u32) -> (u32, u32) {
    let next = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((next >> ((next >> 28) + 4)) ^ next).wrapping_mul(277_803_737);
    ((word >> 22) ^ word, next)
}

fn seeds() -> Vec<[[f32; 4]; 7]> {
    grid(&[0.0, 1.0, 77.0, 16_777_215.0], &[0.0, 5.0, 1e6], &[0.0, 3.0], &[0.0])
}

/// Edges of a light box whose columns lean, m.
fn leaning() -> DMat3 {
    let along = DVec3::new(0.3, 0.8, -0.6) / DVec3::new(0.3, 0.8, -0.6).length();
    DMat3::from_cols(20.0 * DVec3::Z, 30.0 * DVec3::X, 40.0 * along)
}

/// The same in WGSL: rows of the inverse are cross products of the edges over their volume.
const LEANING: &str = "
    fn leaning(corner: vec3f) -> LightBox {
        let u = vec3f(0.0, 0.0, 20.0);
        let v = vec3f(30.0, 0.0, 0.0);
        let along = normalize(vec3f(0.3, 0.8, -0.6));
        let w = 40.0 * along;
        let volume = dot(u, cross(v, w));
        return LightBox(corner, 1.0, cross(v, w) / volume, 0.0, cross(w, u) / volume, 1u, cross(u, v) / volume, 1u,
            u, 0.0, v, 0.0, along, 40.0);
    }";

/// Oriented, flat and tall ellipsoids with points inside, on, outside, and at the centre.
fn ellipsoids() -> Vec<[[f32; 4]; 7]> {
    let orientations = [DQuat::IDENTITY, DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 1.1)];
    let radii = [[1.0, 1.0, 1.0], [120.0, 40.0, 100.0], [3.0, 300.0, 30.0]];
    let directions = [[0.3, -0.8, 0.52], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.577, 0.577, 0.577]];
    let mut list = Vec::new();
    for q in orientations {
        for r in radii {
            for d in directions {
                for k in [0.0, 1e-3, 0.3, 0.8, 0.999, 1.0, 1.001, 1.7] {
                    let center = DVec3::new(5.0, 90.0, -12.0);
                    let p = center + q * (DVec3::from(d).normalize() * k * DVec3::from(r));
                    let ray = (q * DVec3::new(d[1], d[2] + 0.1, d[0])).normalize();
                    list.push([
                        q.as_quat().to_array(),
                        [r[0] as f32, r[1] as f32, r[2] as f32, 0.6],
                        [5.0, 90.0, -12.0, 0.05],
                        [20.0, 4.0, 0.3, 0.0],
                        p.as_vec3().extend(1.0).to_array(),
                        ray.as_vec3().extend(0.0).to_array(),
                        [0.25, -0.7, 1.5, 0.0],
                    ]);
                }
            }
        }
    }
    list
}

fn scalars(values: impl IntoIterator<Item = [f32; 4]>) -> Vec<[[f32; 4]; 7]> {
    values.into_iter().map(|v| [v, [0.0; 4], [0.0; 4], [0.0; 4], [0.0; 4], [0.0; 4], [0.0; 4]]).collect()
}

fn grid(a: &[f32], b: &[f32], c: &[f32], d: &[f32]) -> Vec<[[f32; 4]; 7]> {
    let mut list = Vec::new();
    for &a in a {
        for &b in b {
            for &c in c {
                list.extend(d.iter().map(|&d| [a, b, c, d]));
            }
        }
    }
    scalars(list)
}

fn depth(x: &[[f64; 4]; 7]) -> f64 {
    let (_, r, _) = ellipsoid(x);
    let u = unit(x, xyz(x[4]), 1.0);
    let k = u.length();
    // |grad k| = |u / r| / k, and the smallest radius where it has no direction.
    if k < 1e-5 { r.min_element() } else { (1.0 - k) / ((u / r).length() / k) }
}

/// s(x) of [K 3.2] by its definition: s(0) = 0, s(1) = 1, s' proportional to x^2 (1-x)^2.
fn rise(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    let n = 2000;
    let h = x / f64::from(n);
    30.0 * (0..n).map(|i| (f64::from(i) + 0.5) * h).map(|y| (y * (1.0 - y)).powi(2) * h).sum::<f64>()
}

fn displaced(x: &[[f64; 4]; 7], noise: [f64; 2]) -> f64 {
    let n = noise[0] * (1.0 - x[3][2]) + noise[1] * x[3][2];
    depth(x) - x[3][0] * (1.0 - n) / 2.0
}

fn chord(x: &[[f64; 4]; 7]) -> [f64; 4] {
    let (o, v) = (unit(x, xyz(x[4]), 1.0), unit(x, xyz(x[5]), 0.0));
    let (b, c, d) = (o.dot(v), o.dot(o) - x[6][2].powi(2), v.dot(v));
    let discriminant = b * b - d * c;
    // A graze decides between a hit and a miss by rounding: not compared.
    if discriminant.abs() < 1e-4 * d {
        return [f64::NAN; 4];
    }
    if discriminant < 0.0 {
        return [1e30, -1e30, f64::NAN, f64::NAN];
    }
    let half = discriminant.sqrt() / d;
    [-b / d - half, -b / d + half, f64::NAN, f64::NAN]
}

/// Real spherical harmonic of degree l and order m (negative: sine) in a direction: Re or Im
/// (x + iy)^|m| times the |m|-th derivative of the Legendre polynomial.
fn harmonic(l: usize, m: i32, d: DVec3) -> f64 {
    let mut polynomial =
        [vec![1.0], vec![0.0, 1.0], vec![-0.5, 0.0, 1.5], vec![0.0, -1.5, 0.0, 2.5]][l].clone();
    let order = m.unsigned_abs() as usize;
    let (mut re, mut im) = (1.0, 0.0);
    for _ in 0..order {
        polynomial = polynomial.iter().enumerate().skip(1).map(|(n, c)| n as f64 * c).collect();
        (re, im) = (re * d.x - im * d.y, re * d.y + im * d.x);
    }
    let value: f64 = polynomial.iter().enumerate().map(|(n, c)| c * d.z.powi(n as i32)).sum();
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let twice = if m == 0 { 1.0 } else { 2.0 };
    let norm = (2 * l + 1) as f64 / (4.0 * PI) * twice * factorial(l - order) / factorial(l + order);
    norm.sqrt() * value * if m < 0 { im } else { re }
}

fn harmonics(x: &[[f64; 4]; 7], list: [(usize, i32); 4]) -> [f64; 4] {
    list.map(|(l, m)| harmonic(l, m, xyz(x[0])))
}

/// Unit vectors all around, the axes among them.
fn all_around() -> Vec<[[f32; 4]; 7]> {
    let spiral = (0..40).map(|i| {
        let z = 1.0 - (f64::from(i) + 0.5) / 20.0;
        let (sine, cosine) = (2.4 * f64::from(i)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cosine, across * sine, z)
    });
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    scalars(spiral.chain(axes).map(|d| d.as_vec3().extend(0.0).to_array()))
}

/// A field of 5 by 7 by 4 cells in WGSL.
const FIELD: &str = "
    fn field() -> Field {
        return Field(vec3f(0.0), 48u, vec3f(1.0), 1u, vec3u(5u, 7u, 4u), 0.0, vec4f(0.0), vec4f(0.0));
    }";

/// The Eddington equations of a conservative slab under a beam, by shooting: integrated
/// from the lit face with RK4 for two guesses of the flux there, then combined so that no
/// diffuse light comes in through the far face.
fn eddington(x: &[[f64; 4]; 7]) -> f64 {
    let [g, mu0, depth, thickness] = x[0];
    let nu = x[1][0];
    let f = g.max(0.0).powi(2);
    let g1 = (g - f) / (1.0 - f);
    let (t, total) = ((1.0 - f) * depth, (1.0 - f) * thickness);
    let c = 3.0 / (4.0 * PI);
    let slope = |t: f64, [_, i1]: [f64; 2]| {
        let beam = (-t / mu0).exp();
        // Energy: the diffuse flux gains what the beam loses. Momentum: what scattering turns.
        [-(1.0 - g1) * i1 + c * g1 * mu0 * beam, c * beam]
    };
    let integrate = |i1: f64, end: f64| {
        let n = 4000;
        let h = end / f64::from(n);
        let mut state = [-2.0 / 3.0 * i1, i1];
        for i in 0..n {
            let t = f64::from(i) * h;
            let add = |s: [f64; 2], k: [f64; 2], h: f64| [s[0] + h * k[0], s[1] + h * k[1]];
            let k1 = slope(t, state);
            let k2 = slope(t + h / 2.0, add(state, k1, h / 2.0));
            let k3 = slope(t + h / 2.0, add(state, k2, h / 2.0));
            let k4 = slope(t + h, add(state, k3, h));
            for j in 0..2 {
                state[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
            }
        }
        state
    };
    let leak = |i1: f64| {
        let [i0, i1] = integrate(i1, total);
        i0 - 2.0 / 3.0 * i1
    };
    let (a, b) = (leak(0.0), leak(1.0));
    let [i0, i1] = integrate(-a / (b - a), t);
    // Scattering of I0 + nu I1 by a phase function of asymmetry g.
    (i0 + g * nu * i1).max(0.0)
}

/// Mean of a function over [0, 1].
fn mean(f: impl Fn(f64) -> f64) -> f64 {
    let n = 4000;
    (0..n).map(|i| f((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
}

/// Mean of the sun's e^{-depth} along a piece of a ray, weighted by what gets through the piece
/// from there.
fn sunlight_share(depth: f64, before: f64, after: f64) -> f64 {
    let through = |share: f64| (-share * depth).exp();
    mean(|share| through(share) * (-before - share * (after - before)).exp()) / mean(through)
}

/// The Henyey-Greenstein phase function by its definition: the sum of its Legendre series
/// (2 l + 1) / (4 pi) g^l P_l.
fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    let (mut before, mut here, mut sum) = (0.0, 1.0, 0.0);
    for l in 0..200 {
        let n = f64::from(l);
        sum += (2.0 * n + 1.0) / (4.0 * PI) * g.powi(l) * here;
        (before, here) = (here, ((2.0 * n + 1.0) * cosine * here - n * before) / (n + 1.0));
    }
    sum
}

/// Everything of the library but the sky, whose twins are in tests/sky.rs.
fn twins() -> Vec<Twin> {
    let e = ellipsoids();
    let twin = |name, uses, body, inputs: Vec<_>, reference, relative, absolute| Twin {
        name,
        uses,
        body,
        inputs,
        reference,
        relative,
        absolute,
    };
    vec![
        // Positions of some 100 m over radii of 3 m: 1e-5 of rounding in the difference.
        twin(
            "ellipsoid_unit",
            "ellipsoid",
            "return vec4f(ellipsoid_unit(make(x), x[4].xyz, 1.0), 0.0);",
            e.clone(),
            |x| out(unit(x, xyz(x[4]), 1.0)),
            1e-5,
            2e-5,
        ),
        twin(
            "ellipsoid_depth",
            "ellipsoid",
            "let e = make(x); return vec4f(ellipsoid_depth(e, ellipsoid_unit(e, x[4].xyz, 1.0)));",
            off_center(&e),
            |x| one(depth(x)),
            1e-4,
            2e-3,
        ),
        twin(
            "ellipsoid_normal",
            "ellipsoid",
            "let e = make(x); return vec4f(ellipsoid_normal(e, ellipsoid_unit(e, x[4].xyz, 1.0)), 0.0);",
            off_center(&e),
            |x| {
                let (q, r, _) = ellipsoid(x);
                out((q * (unit(x, xyz(x[4]), 1.0) / r)).normalize())
            },
            1e-3,
            1e-3,
        ),
        twin(
            "ellipsoid_chord",
            "ellipsoid",
            "return vec4f(ellipsoid_chord(make(x), x[4].xyz, x[5].xyz, x[6].z), 0.0, 0.0);",
            e.clone(),
            chord,
            1e-4,
            2e-2,
        ),
        twin(
            "noise_coordinate",
            "noise",
            "return vec4f(noise_coordinate(x[0], x[1], x[2], x[3].xyz), 0.0);",
            e.clone(),
            |x| out(DVec3::from([0, 1, 2].map(|i| xyz(x[i]).dot(xyz(x[3])) + x[i][3]))),
            1e-6,
            1e-3,
        ),
        twin(
            "noise_sum",
            "noise",
            "return vec4f(noise_sum(x[0].xy, x[0].zw, x[1].x), 0.0, 0.0);",
            with_second(grid(&[-1.0, 0.3], &[0.5, 1.0], &[-1.0, 0.1], &[0.7]), 0.5),
            |x| {
                let w = x[1][0];
                [(x[0][0] + w * x[0][2]) / (1.0 + w), (x[0][1] + w * x[0][3]) / (1.0 + w), f64::NAN, f64::NAN]
            },
            1e-6,
            1e-6,
        ),
        twin(
            "smooth_rise",
            "density",
            "return vec4f(smooth_rise(x[0].x));",
            grid(&[-1.0, 0.0, 1e-3, 0.2, 0.5, 0.9, 1.0, 3.0], &[0.0], &[0.0], &[0.0]),
            |x| one(rise(x[0][0])),
            1e-5,
            1e-6,
        ),
        twin(
            "displaced_depth",
            "density",
            "return vec4f(displaced_depth(make(x), x[4].w * 10.0, x[6].xy));",
            e.clone(),
            |x| one(10.0 - depth(x) + displaced(x, [x[6][0], x[6][1]])),
            1e-5,
            1e-4,
        ),
        twin(
            "matter_with",
            "density",
            "let e = make(x); let m = matter_with(Matter(0.01, -3.0, 7.0), e, ellipsoid_unit(e, x[4].xyz, 1.0), x[6].xy, x[6].z); return vec4f(m.extinction, m.depth, m.steady, 0.0);",
            off_boundary(&e),
            |x| {
                if unit(x, xyz(x[4]), 1.0).length() >= 1.0 {
                    return [0.01, -3.0, 7.0, f64::NAN];
                }
                // Half of what the edge is wider goes outwards.
                let width = f64::max(x[3][1], x[6][2]);
                let d = displaced(x, [x[6][0], x[6][1]]) + 0.5 * (width - x[3][1]);
                let extinction = x[2][3] * rise(d / width);
                // Steady only where the deepest ellipsoid is also the densest.
                let steady = match d > -3.0 {
                    true if extinction >= 0.01 => f64::max(-d, d - width),
                    false if extinction <= 0.01 => 7.0,
                    _ => 0.0,
                };
                [f64::max(0.01, extinction), d.max(-3.0), steady, f64::NAN]
            },
            1e-3,
            2e-3,
        ),
        twin(
            "phase_coordinate",
            "phase",
            "let t = x[0].x; return vec4f(phase_coordinate(vec3f(0.0, 0.6, 0.8), cos(t) * vec3f(0.0, 0.6, 0.8) + sin(t) * vec3f(1.0, 0.0, 0.0)));",
            grid(&[0.0, 1e-3, 0.01, 0.1, 0.5, 1.0, 1.55, 1.6, 2.5, 3.1, 3.135], &[0.0], &[0.0], &[0.0]),
            |x| {
                let t = x[0][0];
                one(if t < PI / 2.0 { (0.5 * t / PI).sqrt() } else { 1.0 - (0.5 * (PI - t) / PI).sqrt() })
            },
            1e-3,
            1e-4,
        ), // sin and cos of the driver: a few 1e-5 rad near the ends.
        twin(
            "asin_small",
            "phase",
            "return vec4f(asin_small(x[0].x));",
            grid(&[0.0, 1e-4, 0.1, 0.3, 0.6, 0.707], &[0.0], &[0.0], &[0.0]),
            |x| one(x[0][0].asin()),
            1e-6,
            4e-5,
        ),
        twin(
            "mean_transmittance",
            "phase",
            "return vec4f(mean_transmittance(x[0].x, x[0].y));",
            grid(&[0.0, 0.3, 9.0], &[0.0, 0.05, 0.3, 0.39, 9.11, 30.0], &[0.0], &[0.0]),
            |x| one(mean(|share| (-(1.0 - share) * x[0][0] - share * x[0][1]).exp())),
            1e-4,
            0.0,
        ),
        twin(
            "sunlight_share",
            "phase",
            "return vec4f(sunlight_share(x[0].x, x[0].y, x[0].z));",
            grid(&[0.0, 1e-3, 0.3, 5.0], &[0.0, 0.3, 9.0], &[0.0, 0.31, 4.0, 9.0], &[0.0]),
            |x| one(sunlight_share(x[0][0], x[0][1], x[0][2])),
            1e-4,
            0.0,
        ),
        twin(
            "recovered_peak",
            "phase",
            "return vec4f(recovered_peak(x[0].x, x[0].y));",
            grid(&[0.0, 1e-3, 0.5, 3.0, 40.0, 1e4], &[0.0, 0.45, 0.9], &[0.0], &[0.0]),
            |x| {
                let [tau, chop, ..] = x[0];
                // Light that the peak scattered at depth s and nothing else touched, added up over orders:
                // e^{-(1-f) tau} (1 - e^{-f tau}).
                one((-(1.0 - chop) * tau).exp() * -(-chop * tau).exp_m1())
            },
            1e-4,
            2e-7,
        ),
        twin(
            "octave_phase",
            "octaves",
            "return vec4f(octave_phase(x[0].x, x[0].y));",
            grid(&[-0.5, 0.0, 0.3, 0.73], &[-1.0, -0.2, 0.0, 0.9, 1.0], &[0.0], &[0.0]),
            |x| one(henyey_greenstein(x[0][0], x[0][1])),
            1e-5,
            0.0,
        ),
        twin(
            "octave_phases",
            "octaves",
            "return vec4f(octave_phases(x[0].x, x[0].y), 0.0, 0.0);",
            grid(&[-0.5, 0.0, 0.73], &[-1.0, 0.0, 0.9, 1.0], &[0.0], &[0.0]),
            |x| {
                let octave = |n: f64| n * henyey_greenstein(n * x[0][0], x[0][1]);
                [octave(0.5), octave(0.25), f64::NAN, f64::NAN]
            },
            1e-5,
            0.0,
        ),
        twin(
            "octave_transmittances",
            "octaves",
            "return vec4f(octave_transmittances(x[0].x, x[0].y, x[0].z), 0.0, 0.0);",
            grid(&[0.0, 0.1, 3.0], &[0.0, 0.3, 9.0], &[0.0, 0.31, 7.0], &[0.0]),
            |x| {
                let [depth, before, after, _] = x[0];
                let octave = |n: f64| sunlight_share(depth, n * before, n * after);
                [octave(0.5), octave(0.25), f64::NAN, f64::NAN]
            },
            1e-4,
            0.0,
        ),
        twin(
            "eddington_beam",
            "eddington",
            "return vec4f(eddington_beam(x[0].x, x[0].y, x[0].z, x[0].w, x[1].x));",
            with_second(slabs(), 0.6),
            |x| one(eddington(x)),
            1e-3,
            2e-5,
        ),
        twin(
            "diffuse_conductance",
            "eddington",
            "return vec4f(diffuse_conductance(x[0].x, x[0].y));",
            grid(&[0.0, 0.73], &[0.0, 1.0, 50.0], &[0.0], &[0.0]),
            |x| one(3.0 / (2.0 + 3.0 * (1.0 - x[0][0]) * x[0][1])),
            1e-5,
            0.0,
        ),
        twin(
            "side_loss",
            "eddington",
            "return vec4f(side_loss(x[0].x, x[0].y));",
            grid(&[0.1, 1.0, 3.0], &[-0.5, 0.0, 0.2, 6.0], &[0.0], &[0.0]),
            // Two faces alone are a slab.
            |x| one(1.0 / (1.0 + 0.3 * x[0][1].max(0.0) / x[0][0])),
            1e-6,
            0.0,
        ),
        twin(
            "diffuse_depth",
            "eddington",
            "return vec4f(diffuse_depth(x[0].x, diffuse_conductance(x[0].x, x[0].y)));",
            grid(&[0.0, 0.73, 0.9], &[0.0, 0.5, 30.0], &[0.0], &[0.0]),
            |x| one(x[0][1]),
            1e-5,
            // The difference of two resistances, of which one is 2/3.
            3e-6,
        ),
        twin(
            "slab_path_coordinate",
            "slab",
            "return vec4f(slab_path_coordinate(x[0].x));",
            grid(&[0.0, 1e-3, 4.0, 300.0], &[0.0], &[0.0], &[0.0]),
            // The texture's rows lie at paths 4 c / (1 - c).
            |x| one(x[0][0] / (x[0][0] + 4.0)),
            1e-6,
            0.0,
        ),
        twin(
            "absorbed",
            "eddington",
            "return vec4f(absorbed(x[0].x, x[0].y, x[0].z));",
            grid(&[1.0, 0.99, 0.5, 0.0], &[0.0, 0.73], &[0.0, 1.0, 20.0], &[0.0]),
            |x| {
                let [albedo, g, tau, _] = x[0];
                one((-(3.0 * (1.0 - albedo) * (1.0 - albedo * g)).sqrt() * tau).exp())
            },
            1e-4,
            1e-7,
        ),
        twin(
            "light_box_coordinate",
            "light_box",
            "return vec4f(light_box_coordinate(leaning(x[0].xyz), x[1].xyz), 0.0);",
            e.clone(),
            |x| out(leaning().inverse() * (xyz(x[1]) - xyz(x[0]))),
            1e-5,
            2e-5,
        ),
        twin(
            "light_box_point",
            "light_box",
            "return vec4f(light_box_point(leaning(x[0].xyz), x[1].xyz), 0.0);",
            e.clone(),
            |x| out(xyz(x[0]) + leaning() * xyz(x[1])),
            1e-5,
            1e-3,
        ),
        twin(
            "light_box_bricks",
            "light_box",
            "return vec4f(vec3f(light_box_bricks(vec3u(x[0].xyz))), 0.0);",
            grid(&[1.0, 8.0, 9.0, 128.0], &[7.0, 16.0], &[8.0, 65.0], &[0.0]),
            |x| out((xyz(x[0]) / 8.0).ceil()),
            0.0,
            0.0,
        ),
        twin(
            "light_box_brick",
            "light_box",
            "return vec4f(f32(light_box_brick(vec3u(20u, 8u, 33u), x[0].xyz)), 0.0, 0.0, 0.0);",
            grid(&[-0.3, 0.0, 0.39, 0.41, 1.0], &[0.0, 0.99, 2.0], &[-0.1, 0.24, 0.26, 0.98, 1.0], &[0.0]),
            |x| {
                // 3, 1 and 5 bricks.
                let size = DVec3::new(20.0, 8.0, 33.0);
                let voxel = (xyz(x[0]) * size).floor().clamp(DVec3::ZERO, size - 1.0);
                let brick = (voxel / 8.0).floor();
                one(brick.x + 3.0 * (brick.y + brick.z))
            },
            0.0,
            0.0,
        ),
        twin(
            "light_box_normal",
            "light_box",
            "return vec4f(light_box_normal(leaning(vec3f(0.0)), x[0].x, x[0].y), 0.0);",
            grid(&[-3.0, 0.0, 0.4], &[-0.2, 0.0, 5.0], &[0.0], &[0.0]),
            |x| {
                // A point of the surface moves with either way across by the way itself and
                // the slope along the light; the normal has no part in either.
                let columns = leaning();
                let along = columns.z_axis.normalize();
                let u = columns.x_axis.normalize() + x[0][0] * along;
                let v = columns.y_axis.normalize() + x[0][1] * along;
                let n = v.cross(u).normalize();
                out(if n.dot(along) > 0.0 { -n } else { n })
            },
            1e-5,
            1e-5,
        ),
        twin(
            "next_random",
            "path_random",
            "var s = u32(x[0].x); let r = next_random(&s); return vec4f(f32(r >> 8u), f32(s >> 8u), 0.0, 0.0);",
            seeds(),
            |x| {
                let (word, state) = pcg(x[0][0] as u32);
                [f64::from(word >> 8), f64::from(state >> 8), f64::NAN, f64::NAN]
            },
            0.0,
            0.0,
        ),
        twin(
            "uniform_random",
            "path_random",
            "var s = u32(x[0].x); return vec4f(uniform_random(&s));",
            seeds(),
            |x| one(f64::from(pcg(x[0][0] as u32).0 >> 8) / 16_777_216.0),
            0.0,
            0.0,
        ),
        twin(
            "hash_random",
            "path_random",
            "return vec4f(f32(hash_random(u32(x[0].x), u32(x[0].y), u32(x[0].z)) >> 8u));",
            seeds(),
            |x| {
                let [pixel, sample, seed] = [0, 1, 2].map(|i| x[0][i] as u32);
                let first = pcg(pixel.wrapping_mul(1_597_334_677).wrapping_add(seed)).0;
                one(f64::from(pcg(first ^ sample.wrapping_mul(3_812_015_801)).0 >> 8))
            },
            0.0,
            0.0,
        ),
        twin(
            "interleaved_gradient",
            "random",
            "return vec4f(interleaved_gradient(x[0].xy));",
            grid(&[0.5, 1.5, 7.5], &[0.5, 2.5], &[0.0], &[0.0]),
            |x| {
                let inner = (0.06711056 * x[0][0] + 0.00583715 * x[0][1]).fract();
                one((52.9829189 * inner).fract())
            },
            0.0,
            1e-4,
        ), // 53 times the rounding of a fraction
        twin(
            "filmic",
            "tonemap",
            "return vec4f(filmic(x[0].xyz), 0.0);",
            grid(&[-1.0, 0.0, 0.01], &[0.18, 1.0], &[8.0, 1e4], &[0.0]),
            |x| {
                out(xyz(x[0])
                    .max(DVec3::ZERO)
                    .to_array()
                    .map(|x| ((2.51 * x * x + 0.03 * x) / (2.43 * x * x + 0.59 * x + 0.14)).min(1.0))
                    .into())
            },
            1e-4,
            1e-6,
        ),
        twin(
            "soft",
            "tonemap",
            "return vec4f(soft(x[0].xyz), 0.0);",
            grid(&[-1.0, 0.0, 0.01], &[0.18, 1.0], &[8.0, 1e4], &[0.0]),
            // Reinhard et al. (2002), eq. 4, of 1.9 times the light, white at 8.
            |x| {
                let curve = |x: f64| {
                    let (l, white) = (1.9 * x.max(0.0), 1.9 * 8.0);
                    (l * (1.0 + l / (white * white)) / (1.0 + l)).min(1.0)
                };
                out(xyz(x[0]).to_array().map(curve).into())
            },
            1e-4,
            1e-6,
        ),
        twin(
            "tone_curve",
            "tonemap",
            "return vec4f(tone_curve(0u, x[0].xxx).x, tone_curve(1u, x[0].xxx).x, tone_curve(2u, x[0].xxx).x, 0.0);",
            grid(&[0.0, 0.18, 2.0], &[0.0], &[0.0], &[0.0]),
            |x| {
                let x = x[0][0];
                let filmic = (2.51 * x * x + 0.03 * x) / (2.43 * x * x + 0.59 * x + 0.14);
                let soft = 1.9 * x * (1.0 + 1.9 * x / 231.04) / (1.0 + 1.9 * x);
                [filmic.min(1.0), soft, x.min(1.0), f64::NAN]
            },
            1e-4,
            1e-6,
        ),
        twin(
            "srgb_encode",
            "tonemap",
            "return vec4f(srgb_encode(x[0].xyz), 0.0);",
            grid(&[0.0, 0.001, 0.0031308], &[0.18, 0.5], &[0.9, 1.0], &[0.0]),
            |x| {
                out(xyz(x[0])
                    .to_array()
                    .map(|x| if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 })
                    .into())
            },
            1e-3,
            1e-5,
        ),
        twin(
            "camera_ray",
            "camera",
            "let c = Camera(vec3f(1.6, 0.0, 0.0), u32(x[0].z), vec3f(0.0, 0.9, 0.0), 2.0, vec3f(0.0, 0.0, -1.0), 0.001, vec2f(1.0), 0.0, 0.0); let r = camera_ray(c, x[0].xy); return vec4f(r.direction, r.origin.x);",
            grid(&[-1.0, 0.0, 0.4], &[-0.7, 0.0, 1.0], &[0.0, 1.0, 2.0], &[0.0]),
            |x| {
                let [a, b, kind, _] = x[0];
                let d = match kind as u32 {
                    0 => DVec3::new(1.6 * a, 0.9 * b, -1.0).normalize(),
                    1 => DVec3::NEG_Z,
                    // Axes of 1.6 and 0.9 stretch the panorama of this test.
                    _ => DVec3::new(
                        (PI * a).sin() * (PI / 2.0 * b).cos() * 1.6,
                        (PI / 2.0 * b).sin() * 0.9,
                        -(PI * a).cos() * (PI / 2.0 * b).cos(),
                    ),
                };
                [d.x, d.y, d.z, if kind == 1.0 { 1.6 * a } else { 0.0 }]
            },
            1e-5,
            1e-5,
        ),
        twin(
            "pixel_ndc",
            "camera",
            "var c: Camera; c.size = vec2f(40.0, 20.0); return vec4f(pixel_ndc(c, x[0].xy), 0.0, 0.0);",
            grid(&[0.0, 0.5, 40.0], &[0.0, 19.5], &[0.0], &[0.0]),
            |x| [x[0][0] / 20.0 - 1.0, 1.0 - x[0][1] / 10.0, f64::NAN, f64::NAN],
            1e-6,
            1e-6,
        ),
        twin(
            "harmonics_low",
            "harmonics",
            "return harmonics_low(x[0].xyz);",
            all_around(),
            |x| harmonics(x, [(0, 0), (1, 1), (1, -1), (1, 0)]),
            1e-5,
            1e-6,
        ),
        twin(
            "harmonics_square",
            "harmonics",
            "return harmonics_square(x[0].xyz);",
            all_around(),
            |x| harmonics(x, [(2, -2), (2, -1), (2, 1), (2, 0)]),
            1e-5,
            1e-6,
        ),
        twin(
            "harmonics_mixed",
            "harmonics",
            "return harmonics_mixed(x[0].xyz);",
            all_around(),
            |x| harmonics(x, [(2, 2), (3, -3), (3, -2), (3, -1)]),
            1e-5,
            1e-6,
        ),
        twin(
            "harmonics_cubic",
            "harmonics",
            "return harmonics_cubic(x[0].xyz);",
            all_around(),
            |x| harmonics(x, [(3, 0), (3, 1), (3, 2), (3, 3)]),
            1e-5,
            1e-6,
        ),
        twin(
            "field_cells",
            "field",
            "return vec4f(f32(field_cells(field())));",
            grid(&[0.0], &[0.0], &[0.0], &[0.0]),
            |_| one(140.0),
            0.0,
            0.0,
        ),
        twin(
            "field_index",
            "field",
            "return vec4f(f32(field_index(field(), vec3u(x[0].xyz))));",
            grid(&[0.0, 4.0], &[0.0, 3.0, 6.0], &[0.0, 3.0], &[0.0]),
            |x| one(x[0][0] + 5.0 * (x[0][1] + 7.0 * x[0][2])),
            0.0,
            0.0,
        ),
        twin(
            "field_place",
            "field",
            "return vec4f(vec3f(field_place(field(), u32(x[0].x))), 0.0);",
            grid(&[0.0, 4.0, 5.0, 34.0, 35.0, 139.0], &[0.0], &[0.0], &[0.0]),
            |x| out(DVec3::new(x[0][0] % 5.0, (x[0][0] / 5.0).floor() % 7.0, (x[0][0] / 35.0).floor())),
            0.0,
            0.0,
        ),
        // Three fields of four layers: half a texel is left to the neighbours.
        twin(
            "field_coordinate",
            "field",
            "return vec4f(field_coordinate(vec3f(0.2, 0.7, x[0].x), 12.0, u32(x[0].y), 3u), 0.0);",
            grid(&[0.0, 0.1, 0.5, 0.8, 1.0], &[0.0, 1.0, 2.0], &[0.0], &[0.0]),
            |x| out(DVec3::new(0.2, 0.7, (x[0][1] + x[0][0].clamp(0.125, 0.875)) / 3.0)),
            1e-6,
            1e-6,
        ),
        twin(
            "pixel_footprint",
            "camera",
            "var c: Camera; c.pixel = 0.25; c.projection = u32(x[0].y); return vec4f(pixel_footprint(c, x[0].x));",
            grid(&[0.0, 8.0], &[0.0, 1.0, 2.0], &[0.0], &[0.0]),
            |x| one(if x[0][1] == 1.0 { 0.25 } else { 0.25 * x[0][0] }),
            1e-6,
            0.0,
        ),
    ]
}

/// The centre has no normal and only a limit for its depth: rounding would choose.
fn off_center(e: &[[[f32; 4]; 7]]) -> Vec<[[f32; 4]; 7]> {
    e.iter()
        .copied()
        .filter(|x| {
            (glam::Vec3::new(x[4][0], x[4][1], x[4][2]) - glam::Vec3::new(5.0, 90.0, -12.0)).length() > 0.02
        })
        .collect()
}

/// On the surface itself rounding decides between inside and outside.
fn off_boundary(e: &[[[f32; 4]; 7]]) -> Vec<[[f32; 4]; 7]> {
    off_center(e)
        .into_iter()
        .filter(|x| {
            (unit(&x.map(|v| v.map(f64::from)), xyz(x[4].map(f64::from)), 1.0).length() - 1.0).abs() > 1e-4
        })
        .collect()
}

fn with_second(mut inputs: Vec<[[f32; 4]; 7]>, value: f32) -> Vec<[[f32; 4]; 7]> {
    inputs.iter_mut().for_each(|x| x[1][0] = value);
    inputs
}

/// Asymmetry, sun cosine, depth and thickness of slabs; depths up to the far face.
fn slabs() -> Vec<[[f32; 4]; 7]> {
    let all = grid(&[-0.6, 0.0, 0.73, 0.9], &[0.2, 0.7, 1.0], &[0.0, 0.5, 5.0, 30.0], &[0.5, 5.0, 30.0]);
    all.into_iter().filter(|x| x[0][2] <= x[0][3]).collect()
}

#[test]
fn shader_functions_agree_with_their_references() {
    let mut failures = Vec::new();
    for twin in twins() {
        let declarations = match twin.body {
            body if body.contains("make(") => MAKE,
            body if body.contains("leaning(") => LEANING,
            body if body.contains("field()") => FIELD,
            _ => "",
        };
        let got = common::evaluate_with(twin.uses, declarations, twin.body, &twin.inputs);
        for (input, got) in twin.inputs.iter().zip(got) {
            let wanted = (twin.reference)(&input.map(|v| v.map(f64::from)));
            for (got, wanted) in got.into_iter().zip(wanted) {
                let error = (f64::from(got) - wanted).abs();
                // NaN in the reference is not compared; NaN in the shader fails.
                let allowed = twin.absolute + twin.relative * wanted.abs();
                if !wanted.is_nan() && (error.is_nan() || error > allowed) {
                    failures.push(format!("{}: {got} for {wanted} at {input:?}", twin.name));
                }
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{} differences, first:\n{}",
        failures.len(),
        failures[..failures.len().min(12)].join("\n")
    );
}

#[test]
fn every_shader_function_has_a_twin() {
    let twins: Vec<_> = twins().iter().map(|twin| twin.name).collect();
    let sky = concat!(include_str!("atmosphere.rs"), include_str!("sky.rs"));
    let slab = include_str!("slab_shader.rs");
    for (module, source) in LIBRARY {
        for line in source.lines().filter_map(|line| line.strip_prefix("fn ")) {
            let name = line.split('(').next().unwrap_or_default();
            let elsewhere = ELSEWHERE.iter().any(|(known, _)| *known == name)
                || (["air", "atmosphere"].contains(module) && sky.contains(name))
                || (module.starts_with("slab") && slab.contains(name));
            assert!(twins.contains(&name) || elsewhere, "`{name}` of shaders/lib/{module}.wgsl has no twin");
        }
    }
}
