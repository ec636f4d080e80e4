//! The field on which light is solved for: cells, short characteristics, moments of degree 0 to 3.

use glam::DVec3;

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, scalars, three, vector, xyz};
use crate::picture::harmonic;

pub fn twins() -> Vec<Twin> {
    let mut all = cells();
    all.extend(flashes());
    all.extend(characteristics());
    all.extend(moments());
    all
}

/// A field of 5 by 7 by 4 cells: corner, cell (w: truncated share), beam.
const FIELD: &str = "
    fn made(x: array<vec4f, 8>) -> Field {
        return Field(x[1].xyz, 48u, x[2].xyz, 1u, vec3u(5u, 7u, 4u), x[2].w, vec4f(0.0), vec4f(x[3].xyz, 1.0), vec4f(0.0), 0u, 0u, 0u, 0u);
    }
    fn other() -> Field {
        return Field(vec3f(0.0), 48u, vec3f(1.0), 1u, vec3u(3u, 4u, 2u), 0.0, vec4f(0.0), vec4f(0.0), vec4f(0.0), 0u, 0u, 0u, 0u);
    }";

fn field(random: &mut Random, first: [f64; 4]) -> Input {
    let cell = DVec3::from([(); 3].map(|()| random.log(1.0, 1e3)));
    let low = random.log(1.0, 1e4) * random.direction();
    let axis = random.sign() * [DVec3::X, DVec3::Y, DVec3::Z][random.index(3)];
    let beam = [axis, random.direction()][random.index(4).min(1)];
    input([first, vector(low, 0.0), vector(cell, random.between(0.0, 0.9)), vector(beam, 0.0)])
}

fn place(index: f64) -> DVec3 {
    DVec3::new(index % 5.0, (index / 5.0).floor() % 7.0, (index / 35.0).floor())
}

/// Volume over the face that a beam sees.
fn length(x: &Wide) -> f64 {
    let (cell, d) = (xyz(x[2]), xyz(x[3]).abs());
    let face = d.x * cell.y * cell.z + d.y * cell.z * cell.x + d.z * cell.x * cell.y;
    cell.x * cell.y * cell.z / face
}

fn cell(x: &Wide) -> Output {
    let ([extinction, lit, open, _], truncated) = (x[0], x[2][3]);
    let edges = xyz(x[2]);
    let mean = ((1.0 - truncated) * extinction / 8.0).min(3.0 / (edges.x * edges.y * edges.z).cbrt());
    let depth = length(x) * mean;
    let beam = if extinction > 0.0 {
        // No more than comes in: (1 - e^-depth) / depth.
        (lit / extinction).min(-(-depth).exp_m1() / depth)
    } else {
        open / 8.0
    };
    [mean, beam, f64::NAN, f64::NAN]
}

fn cells() -> Vec<Twin> {
    vec![
        Twin::new("field_inside", "field", "return vec4f(field_inside(x[1].xyz, x[2].xyz, x[0].xyz), 0.0);", |x| {
            three(xyz(x[2]) * xyz(x[0]) - xyz(x[2]) * xyz(x[1]))
        })
        .over("all", |random| {
            let low = random.log(1.0, 1e5) * random.direction();
            let size = DVec3::from([(); 3].map(|()| random.log(1.0, 1e5)));
            let inside = DVec3::from([(); 3].map(|()| random.between(0.0, 1.0)));
            input([vector(low + inside * size, 0.0), vector(low, 0.0), vector(size.recip(), 0.0)])
        }),
        Twin::new("field_within", "field", "return vec4f(field_within(made(x), other(), u32(x[0].x)), 0.0);", |x| {
            // The middles of both lie in one box.
            let share = (place(x[0][0]) + 0.5) / DVec3::new(5.0, 7.0, 4.0);
            three(share * DVec3::new(3.0, 4.0, 2.0) - 0.5)
        })
        .declaring(FIELD)
        .edges(grid(&[0.0, 4.0, 5.0, 34.0, 35.0, 71.0, 139.0], &[0.0], &[0.0], &[0.0]))
        // Parts of a cell.
        .beside(1.0),
        Twin::new(
            "field_sample",
            "field",
            "return vec4f(field_sample(made(x), u32(x[0].x), u32(x[0].y)), 0.0);",
            |x| {
                let bit = |n: u32| f64::from(x[0][1] as u32 >> n & 1);
                let part = DVec3::new(bit(0), bit(1), bit(2)) / 2.0 + 0.25;
                three(xyz(x[1]) + (place(x[0][0]) + part) * xyz(x[2]))
            },
        )
        .declaring(FIELD)
        .over("all", |random| {
            let first = [random.index(140) as f64, random.index(8) as f64, 0.0, 0.0];
            field(random, first)
        }),
        Twin::new(
            "field_view",
            "field_view",
            "let v = field_view(made(x), x[4], u32(x[0].x)); return vec4f(v.direction, v.far);",
            |x| {
                let eye = xyz(x[4]);
                if x[4][3] == 0.0 {
                    return [eye.x, eye.y, eye.z, 1.0];
                }
                let away = eye - xyz(x[1]) - (place(x[0][0]) + 0.5) * xyz(x[2]);
                let t = ((away.length() / xyz(x[2]).max_element() - 1.0) / 2.0).clamp(0.0, 1.0);
                let d = away.normalize();
                [d.x, d.y, d.z, t * t * (3.0 - 2.0 * t)]
            },
        )
        .declaring(FIELD)
        .over("all", |random| {
            let cell = random.index(140) as f64;
            let mut x = field(random, [cell, 0.0, 0.0, 0.0]);
            x[1] = [0.0; 4];
            let far = f64::from(x[2][0].max(x[2][1]).max(x[2][2])) * random.between(12.0, 100.0);
            let eye = [random.direction(), far * random.direction()];
            let which = random.index(2);
            x[4] = eye[which].as_vec3().extend(which as f32).to_array();
            x
        })
        .beside(1.0),
        Twin::new("field_beam", "field", "return vec4f(field_beam(made(x), x[0].x));", |x| {
            one((x[2][3] * x[0][0]).exp() / x[0][0].exp())
        })
        .declaring(FIELD)
        .over("all", |random| {
            let first = [random.log(1e-6, 100.0), 0.0, 0.0, 0.0];
            field(random, first)
        }),
        Twin::new("field_beyond", "field", "return vec4f(field_beyond(x[0].x, x[0].y, x[0].z));", |x| {
            let [here, before, share, _] = x[0];
            let most = 0.5 * here;
            one(if share * (here - before).abs() <= most { share } else { most / (here - before).abs() })
        })
        .over("all", |random| {
            let here = random.log(1e-3, 10.0);
            let before = here * random.log(0.1, 100.0);
            input([vector(DVec3::new(here, before, random.between(0.0, 1.0)), 0.0)])
        }),
        Twin::new("field_length", "field", "return vec4f(field_length(made(x)));", |x| one(length(x)))
            .declaring(FIELD)
            .over("all", |random| field(random, [0.0; 4])),
        Twin::new(
            "field_cell",
            "field",
            "let c = field_cell(made(x), x[0].x, x[0].y, x[0].z); return vec4f(c.extinction, c.beam, 0.0, 0.0);",
            cell,
        )
        .declaring(FIELD)
        .over("all", |random| {
            let extinction = [0.0, random.log(1e-6, 10.0)][random.index(4).min(1)];
            let first = [extinction, extinction * random.between(0.0, 1.0), random.between(0.0, 8.0), 0.0];
            field(random, first)
        }),
    ]
}

/// Share of a Gaussian below x: its integral from 0 by Simpson's rule.
fn below(x: f64) -> f64 {
    let x = x.clamp(-12.0, 12.0);
    let density = |t: f64| (-0.5 * t * t).exp() / std::f64::consts::TAU.sqrt();
    let n = 2000;
    let step = x / f64::from(n);
    let weight = |i: i32| if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    0.5 + (0..=n).map(|i| weight(i) * density(f64::from(i) * step)).sum::<f64>() * step / 3.0
}

fn share(x: &Wide) -> f64 {
    let deviation = x[0][3] / 2.0;
    let along = |axis: usize| {
        let at = |corner: usize| below((x[corner][axis] - x[0][axis]) / deviation);
        at(2) - at(1)
    };
    along(0) * along(1) * along(2)
}

/// A ball around the middle and a box about as large, near to it.
fn ball_and_box(random: &mut Random) -> Input {
    let radius = random.log(1.0, 1e3);
    let low = radius * random.between(0.0, 2.0) * random.direction();
    let size = radius * DVec3::from([(); 3].map(|()| random.log(0.05, 4.0)));
    input([vector(DVec3::ZERO, radius), vector(low, 0.0), vector(low + size, 0.0)])
}

/// A ball around the middle, a place near to it, and the way from there to one of its points.
fn ball_and_point(random: &mut Random) -> Input {
    let radius = random.log(1.0, 1e3);
    let p = radius * random.log(0.05, 4.0) * random.direction();
    let point = 0.5 * radius * random.between(0.0, 2.0) * random.direction() - p;
    input([vector(DVec3::ZERO, radius), vector(p, 0.0), vector(point.normalize(), point.length())])
}

fn flashes() -> Vec<Twin> {
    vec![
        Twin::new("normal_below", "flash", "return vec4f(normal_below(x[0].x));", |x| one(below(x[0][0])))
            .edges(line(&[-40.0, -3.0, 0.0, 1.0, 6.0, 1e4]))
            .beside(1.0)
            .over("all", |random| scalars([random.between(-6.0, 6.0)]))
            // The form has an error of 1.5e-7 / 2 by itself.
            .beside(1.0),
        Twin::new("flash_share", "flash", "return vec4f(flash_share(x[0], x[1].xyz, x[2].xyz));", |x| {
            one(share(x))
        })
        .over("all", ball_and_box)
        .beside(1.0),
        Twin::new("flash_emission", "flash", "return vec4f(flash_emission(x[0].x, x[0].y, x[0].z));", |x| {
            // Of the power 4 pi r^2 all directions have the same.
            let sphere = 4.0 * std::f64::consts::PI;
            one(sphere * x[0][0].powi(2) * x[0][1] / sphere / x[0][2])
        })
        .over("all", |random| {
            scalars([random.log(1.0, 1e3), random.between(0.0, 1.0), random.log(1.0, 1e9)])
        }),
        Twin::new("flash_along", "flash", "return vec4f(flash_along(x[0], x[1].xyz, x[2].xyz));", |x| {
            let (radius, d) = (x[0][3], xyz(x[2]));
            let past = 2.0 * (xyz(x[0]) - xyz(x[1])).cross(d).length() / radius;
            one(2.0 * (-0.5 * past * past).exp() / std::f64::consts::PI)
        })
        .over("all", ball_and_point),
        Twin::new("flash_forward", "flash", "return vec4f(flash_forward(x[0].x, x[0].y));", |x| {
            // By optical depths: that which counts, and all of it.
            let counts = -x[0][0].ln();
            one((-counts).exp() * -(counts - counts / x[0][1]).exp_m1())
        })
        .over("all", |random| scalars([random.between(1e-6, 1.0), random.between(0.1, 1.0)]))
        .beside(1.0),
        Twin::new(
            "flash_weight",
            "flash",
            "return vec4f(flash_weight(x[0], x[1].xyz, x[2].xyz, x[2].w));",
            |x| {
                let (radius, away) = (x[0][3], x[2][3]);
                let (deviation, d) = (radius / 2.0, xyz(x[2]));
                let to = xyz(x[0]) - xyz(x[1]);
                // Densities of the points of both ways, over volume.
                let along = |t: f64| {
                    (-0.5 * ((t - to.dot(d)) / deviation).powi(2)).exp()
                        / (std::f64::consts::TAU.sqrt() * deviation)
                };
                let past = to.cross(d).length() / deviation;
                let across = (-0.5 * past * past).exp() / (std::f64::consts::TAU * deviation * deviation);
                let (ball, line) =
                    (along(away) * across, 2.0 * along(away) / (4.0 * std::f64::consts::PI * away * away));
                let power = 4.0 * std::f64::consts::PI * radius * radius;
                one(power * ball / (4.0 * std::f64::consts::PI * away * away) / (0.5 * ball + 0.5 * line))
            },
        )
        .over("all", ball_and_point),
    ]
}

/// The light of a source that goes evenly from `before` to `after` through an optical depth, and of what
/// comes in: by parts, the source at the end less what it was before, dimmed, less the mean of its slope.
pub fn characteristic(incoming: f64, before: f64, after: f64, depth: f64) -> f64 {
    if depth < 1e-4 {
        // To the third order.
        let d = depth;
        let own = |s: f64, a: f64, b: f64, c: f64| s * d * (a - d * (b - d * c));
        return incoming * (-d).exp()
            + own(after, 0.5, 1.0 / 6.0, 1.0 / 24.0)
            + own(before, 0.5, 1.0 / 3.0, 1.0 / 8.0);
    }
    let through = (-depth).exp();
    (incoming - before) * through + after - (after - before) * -(-depth).exp_m1() / depth
}

fn characteristics() -> Vec<Twin> {
    vec![
        Twin::new("sweep_axis", "characteristic", "return vec4f(f32(sweep_axis(x[0].xyz)));", |x| {
            let rates = xyz(x[0]).abs();
            one((1..3).fold(0, |a, i| if rates[i] > rates[a] { i } else { a }) as f64)
        })
        .exact()
        .edges(grid(&[-2.0, 0.0, 1.0], &[-1.0, 2.0, 0.0], &[1.0, -2.0, 3.0], &[0.0]))
        .over("all", |random| input([vector(random.direction(), 0.0)])),
        Twin::new(
            "bilinear_weight",
            "characteristic",
            "return vec4f(bilinear_weight(x[0].xy, u32(x[0].z)));",
            |x| {
                let side = |i: usize| if x[0][2] as u32 >> i & 1 == 1 { x[0][i] } else { 1.0 - x[0][i] };
                one(side(0) * side(1))
            },
        )
        .edges(grid(&[0.0, 0.3, 1.0], &[0.0, 0.8], &[0.0, 1.0, 2.0, 3.0], &[0.0]))
        .over("all", |random| {
            scalars([random.between(0.0, 1.0), random.between(0.0, 1.0), random.index(4) as f64])
        }),
        Twin::new(
            "trilinear_weight",
            "characteristic",
            "return vec4f(trilinear_weight(x[0].xyz, u32(x[0].w)));",
            |x| {
                let side = |i: usize| if x[0][3] as u32 >> i & 1 == 1 { x[0][i] } else { 1.0 - x[0][i] };
                one(side(0) * side(1) * side(2))
            },
        )
        .edges(grid(&[0.0, 0.3], &[0.0, 0.8], &[0.1, 1.0], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]))
        .over("all", |random| {
            let part = [(); 3].map(|()| random.between(0.0, 1.0));
            scalars([part[0], part[1], part[2], random.index(8) as f64])
        }),
        Twin::new(
            "short_characteristic",
            "characteristic",
            "return vec4f(short_characteristic(Upwind(x[0].x, x[0].y, x[0].z), x[1].x, x[1].y, x[1].z));",
            |x| {
                let ([incoming, up, before, _], [here, after, length, _]) = (x[0], x[1]);
                one(characteristic(incoming, before, after, length * (up + here) / 2.0))
            },
        )
        .edges(vec![
            // What comes in, through nothing; a dark cell; one as bright as what comes in.
            input([[0.7, 0.0, 0.2, 0.0], [0.0, 0.9, 10.0, 0.0]]),
            input([[0.7, 0.1, 0.0, 0.0], [0.1, 0.0, 10.0, 0.0]]),
            input([[0.7, 0.3, 0.7, 0.0], [0.1, 0.7, 10.0, 0.0]]),
            input([[0.7, 9.0, 0.2, 0.0], [9.0, 0.9, 100.0, 0.0]]),
        ])
        .over("all", |random| {
            let light = [(); 3].map(|()| random.between(0.0, 1.0));
            let extinctions = [(); 2].map(|()| [0.0, random.log(1e-6, 10.0)][random.index(4).min(1)]);
            input([
                [light[0], extinctions[0], light[1], 0.0],
                [extinctions[1], light[2], random.log(0.1, 1e3), 0.0],
            ])
        })
        // Light is added to light, up to 1.
        .beside(1.0),
    ]
}

/// Degree and order of the moments, in their order.
const MOMENTS: [(usize, i32); 16] = [
    (0, 0),
    (1, 1),
    (1, -1),
    (1, 0),
    (2, -2),
    (2, -1),
    (2, 1),
    (2, 0),
    (2, 2),
    (3, -3),
    (3, -2),
    (3, -1),
    (3, 0),
    (3, 1),
    (3, 2),
    (3, 3),
];

/// Sixteen moments, a direction and a number, and which four of the result are told.
fn sixteen(random: &mut Random) -> Input {
    let row = |random: &mut Random| [(); 4].map(|()| random.between(-1.0, 1.0));
    let four = [(); 4].map(|()| row(random));
    let d = random.direction();
    let light = random.log(1e-3, 1e2);
    let share = [(); 4].map(|()| random.between(0.0, 1.0));
    input([
        four[0],
        four[1],
        four[2],
        four[3],
        vector(d, light),
        [random.index(4) as f64, 0.0, 0.0, 0.0],
        share,
    ])
}

const FOUR: &str =
    "fn four(x: array<vec4f, 8>) -> array<vec4f, 4> { return array<vec4f, 4>(x[0], x[1], x[2], x[3]); }";

/// The four that are told.
fn told(x: &Wide, value: impl Fn(usize, f64) -> f64) -> Output {
    let row = x[5][0] as usize;
    [0, 1, 2, 3].map(|i| value(4 * row + i, x[row][i]))
}

/// With a number from 0 to 1 beside the row that is told.
fn with_distance(random: &mut Random) -> Input {
    let mut x = sixteen(random);
    x[5][1] = [0.0, 1.0, random.between(0.0, 1.0) as f32][random.index(3)];
    x
}

/// With a vector across the direction in place of the shares.
fn with_tangent(mut x: Input, random: &mut Random) -> Input {
    let d = DVec3::new(x[4][0].into(), x[4][1].into(), x[4][2].into());
    let tangent = d.cross(random.direction());
    x[6] = tangent.as_vec3().extend(0.0).to_array();
    x
}

/// Change of the light of all moments along a vector across the direction.
fn slope(x: &Wide, tangent: DVec3) -> f64 {
    let (d, step) = (xyz(x[4]), 1e-4);
    let at = |t: f64| {
        let d = (d + t * tangent).normalize();
        (0..16).map(|i| x[i / 4][i % 4] * harmonic(MOMENTS[i].0, MOMENTS[i].1, d)).sum::<f64>()
    };
    // Of the fourth order.
    (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step)
}

fn sum(x: &Wide, count: usize) -> f64 {
    let term = |i: usize| x[i / 4][i % 4] * harmonic(MOMENTS[i].0, MOMENTS[i].1, xyz(x[4]));
    (0..count).map(term).sum()
}

fn moments() -> Vec<Twin> {
    vec![
        Twin::new(
            "harmonics_with",
            "harmonics",
            "var m = harmonics_with(four(x), x[4].w, x[4].xyz); return m[u32(x[5].x)];",
            |x| told(x, |i, before| before + x[4][3] * harmonic(MOMENTS[i].0, MOMENTS[i].1, xyz(x[4]))),
        )
        .declaring(FOUR)
        .over("all", sixteen),
        Twin::new(
            "harmonics_scattered",
            "harmonics",
            "var m = harmonics_scattered(four(x), x[6]); return m[u32(x[5].x)];",
            |x| told(x, |i, before| x[6][MOMENTS[i].0] * before),
        )
        .declaring(FOUR)
        .over("all", sixteen),
        Twin::new("harmonics_sum", "harmonics", "return vec4f(harmonics_sum(four(x), x[4].xyz));", |x| {
            one(sum(x, 16))
        })
        .declaring(FOUR)
        .over("all", sixteen),
        Twin::new(
            "harmonics_gradient",
            "harmonics",
            // Along a tangent: of a polynomial off the sphere there are many.
            "return vec4f(dot(harmonics_gradient(four(x), x[4].xyz), x[6].xyz));",
            |x| one(slope(x, xyz(x[6]))),
        )
        .declaring(FOUR)
        .over("all", |random| with_tangent(sixteen(random), random)),
        Twin::new(
            "view_light",
            "field_view",
            "return vec4f(view_light(four(x), CellView(x[4].xyz, x[5].y)));",
            |x| {
                let mean = x[0][0] * harmonic(0, 0, xyz(x[4]));
                one(mean + x[5][1] * (sum(x, 16) - mean))
            },
        )
        .declaring(FOUR)
        .over("all", with_distance),
        Twin::new(
            "view_expansion",
            "field_view",
            "let e = view_expansion(four(x), CellView(x[4].xyz, x[5].y)); let d = vec3f(x[4].xyz + x[6].xyz);
             return vec4f(e.x + dot(e.yzw, d));",
            |x| {
                let tangent = xyz(x[6]);
                let far = sum(x, 16) + slope(x, tangent);
                let near = (0..4).map(|i| {
                    let (l, m) = MOMENTS[i];
                    let at = |d: DVec3| {
                        if l == 0 { harmonic(0, 0, d) } else { d.length() * harmonic(l, m, d.normalize()) }
                    };
                    x[0][i] * at(xyz(x[4]) + tangent)
                });
                let near: f64 = near.sum();
                one(near + x[5][1] * (far - near))
            },
        )
        .declaring(FOUR)
        .over("all", |random| with_tangent(with_distance(random), random)),
        Twin::new("expanded", "field_view", "return vec4f(expanded(x[0], x[1].xyz));", |x| {
            one((x[0][0] + DVec3::new(x[0][1], x[0][2], x[0][3]).dot(xyz(x[1]))).max(0.0))
        })
        .over("all", |random| {
            let four = [(); 4].map(|()| random.between(-1.0, 1.0));
            input([four, vector(random.direction(), 0.0)])
        }),
    ]
}

#[test]
fn a_short_characteristic_is_the_integral_of_its_source() {
    for depth in [1e-6, 9e-5, 1.1e-4, 0.3, 5.0] {
        for (incoming, before, after) in [(0.0, 1.0, 0.2), (0.7, 0.0, 1.0), (0.4, 0.4, 0.4)] {
            let n = 20_000;
            let part = |i: i32| {
                let t = depth * (f64::from(i) + 0.5) / f64::from(n);
                (before + (after - before) * t / depth) * (t - depth).exp() * depth / f64::from(n)
            };
            let wanted = incoming * (-depth).exp() + (0..n).map(part).sum::<f64>();
            let got = characteristic(incoming, before, after, depth);
            assert!((got - wanted).abs() < 1e-8 * wanted + 1e-13, "{depth}: {got} for {wanted}");
        }
    }
}
