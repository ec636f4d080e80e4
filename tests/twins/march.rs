//! The march: steps, what is seen of a ray, columns along a light, rays through boxes.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{grid, input, one, plane, scalars, two, vector, xyz};

pub fn twins() -> Vec<Twin> {
    let mut all = steps();
    all.extend(seen());
    all.extend(nodes());
    all.extend(columns());
    all.extend(boxes());
    all
}

/// A step that is under way: its length, what is wanted, what is left of the stretch, the share of the
/// extinction that counts; then matter.
fn step(random: &mut Random) -> Input {
    let wanted = random.log(0.01, 1e3);
    let length = wanted * random.between(0.05, 1.0);
    let left = length * [1.0, random.log(1.0, 1e3)][random.index(2)];
    let clear = [0.0, random.log(0.1, 1e3)][random.index(2)];
    let steady = random.between(-10.0, 500.0);
    input([
        [length, wanted, left, random.between(0.01, 1.0)],
        [[0.0, random.log(1e-6, 10.0)][random.index(2)], 3.0, steady, clear],
    ])
}

/// As far as it was to go, as it is clear, or as 0.6 of the way to a change, but through no more than an
/// optical depth of 1 nor four times the step; and within the stretch.
fn stretched(x: &Wide) -> f64 {
    let ([length, wanted, left, kept], [extinction, _, steady, clear]) = (x[0], x[1]);
    let through = 1.0 / (kept * extinction).max(1e-6);
    let steady = (length / 2.0 + 0.6 * steady).min(through).min(4.0 * wanted);
    [steady, length / 2.0 + clear].into_iter().fold(length, f64::max).min(left)
}

fn steps() -> Vec<Twin> {
    vec![
        Twin::new(
            "step_of_boundary",
            "ray_step",
            "return vec4f(step_of_boundary(x[0].x, x[0].y, x[0].z));",
            |x| one((x[0][0] * x[0][1]).max(x[0][2] / 2.0)),
        )
        .edges(grid(&[0.0, 0.1, 1.0], &[0.0, 30.0], &[0.0, 0.5, 60.0], &[0.0]))
        .over("all", |random| {
            scalars([random.between(0.01, 1.0), random.log(0.01, 1e3), random.log(1e-3, 1e3)])
        }),
        Twin::new(
            "step_spaced",
            "ray_step",
            "return vec4f(step_spaced(x[0].x, x[0].y, x[0].z, x[0].w));",
            |x| {
                let [step, least, most, core] = x[0];
                one(if core > 0.0 { f64::max(step, 0.15 / core) } else { step.max(least).min(most) })
            },
        )
        .edges(grid(&[0.0, 1.0, 9.0], &[0.5, 2.0], &[2.0, 4.0], &[0.0, 0.01, 1.0]))
        .over("all", |random| {
            let least = random.log(0.01, 1e2);
            let core = [0.0, random.log(1e-4, 10.0)][random.index(2)];
            scalars([random.log(1e-3, 1e3), least, least * random.log(1.0, 10.0), core])
        }),
        // Eight steps at the least are told to be left.
        Twin::new(
            "step_scarce",
            "ray_step",
            "return vec4f(step_scarce(x[0].x, u32(x[0].y), u32(x[0].z)));",
            |x| {
                let [left, taken, most, _] = x[0];
                one(if 2.0 * taken > most { left / (most - taken).max(8.0) } else { 0.0 })
            },
        )
        .edges(grid(&[0.0, 40.0], &[0.0, 256.0, 257.0, 503.0, 504.0, 505.0, 512.0, 700.0], &[512.0], &[0.0]))
        .over("all", |random| {
            let most = random.between(1.0, 1e4).floor();
            scalars([random.log(1e-3, 1e5), (random.between(0.0, 1.5) * most).floor(), most])
        }),
        Twin::new(
            "step_stretched",
            "ray_step",
            "let m = Matter(x[1].x, x[1].y, x[1].z, x[1].w, 0u);
             return vec4f(step_stretched(x[0].x, x[0].y, x[0].z, m, x[0].w));",
            |x| one(stretched(x)),
        )
        .over("all", step),
    ]
}

/// What is seen of a ray, as a shader gets it.
const SEEN: &str = "fn seen(x: vec4f) -> RaySeen { return RaySeen(x.x, x.y, x.z, 1.0, 0.0); }
    fn past(x: vec4f, visible: f32) -> RaySeen { return RaySeen(x.x, x.y, x.z, visible, 0.0); }";

/// A ray's transmittance, optical depth, and where it ends.
fn ended(random: &mut Random) -> Input {
    let transmittance =
        [random.between(0.0, 1.0), random.log(1e-6, 0.1), 1.0 - random.log(1e-6, 0.1)][random.index(3)];
    scalars([transmittance, random.log(1e-6, 1e6), random.log(1e-6, 0.1)])
}

/// Opacity, optical depth and share.
fn seen_ray(random: &mut Random) -> [f64; 4] {
    [random.log(1e-6, 1.0), random.log(1e-6, 1e4), random.between(1.0, 1.1), 0.0]
}

fn seen() -> Vec<Twin> {
    vec![
        Twin::new("step_through", "ray_seen", "return vec4f(step_through(x[0].x, x[0].y));", |x| {
            one((x[0][0] * x[0][1]).exp().recip())
        })
        .edges(plane(&[0.0, 0.55, 1.0], &[0.0, 1e-6, 1.0, 100.0, 1e9]))
        .over("all", |random| scalars([random.between(0.01, 1.0), random.log(1e-6, 1e6)])),
        Twin::new("opaque_before", "ray_seen", "return vec4f(opaque_before(x[0].x, x[0].y));", |x| {
            one(x[0][0] / (1.0 + 10.0 * x[0][1]))
        })
        .edges(plane(&[0.0, 0.01], &[0.0, 1.0, 3e3]))
        .over("all", |random| scalars([random.log(1e-6, 0.1), random.log(1e-6, 1e5)])),
        Twin::new(
            "ray_seen",
            "ray_seen",
            "let s = ray_seen(x[0].x, x[0].y, x[0].z, 0.3); return vec4f(s.opacity, s.optical_depth, s.share, s.visible);",
            |x| {
                // What was gathered of a ray that ended is taken for all of it.
                let [transmittance, depth, opaque, _] = x[0];
                match transmittance < opaque {
                    true => [1.0, 1e4, (1.0 - transmittance).recip(), 0.3],
                    false => [1.0 - transmittance, depth, 1.0, 0.3],
                }
            },
        )
        .edges(grid(&[0.0, 0.009, 0.01, 0.5, 1.0], &[0.3, 7.0], &[0.01, 0.0], &[0.0]))
        .over("all", ended),
        Twin::new("opaque_ahead", "ray_seen", "return vec4f(opaque_ahead(x[0].x, x[0].y));", |x| {
            one(((1.0 - x[0][1]) * x[0][0].ln()).exp())
        })
        .over("all", |random| scalars([random.log(1e-6, 0.1), random.between(0.0, 0.9)])),
        Twin::new(
            "opacity_ratio",
            "ray_seen",
            "return vec4f(opacity_ratio(seen(x[0]), x[0].w));",
            |x| one(-(-x[0][3] * x[0][1]).exp_m1() / x[0][0]),
        )
        .declaring(SEEN)
        .over("all", |random| {
            let mut x = seen_ray(random);
            x[0] = random.between(0.3, 1.0);
            x[1] = random.log(0.3, 1e4);
            x[3] = random.between(0.3, 1.0);
            input([x])
        })
        .beside(1.0),
        Twin::new("ray_alpha", "ray_seen", "return vec4f(ray_alpha(seen(x[0]), x[0].w, x[1].x > 0.5));", |x| {
            let share = if x[1][0] > 0.5 { 1.0 } else { x[0][3] };
            one(-(-share * x[0][1]).exp_m1())
        })
        .declaring(SEEN)
        .edges(grid(&[0.2, 1.0], &[0.0, 0.3, 1e4], &[1.0], &[0.0, 0.6, 1.0]))
        .beside(1.0)
        .over("all", |random| {
            let mut x = seen_ray(random);
            x[3] = random.between(0.3, 1.0);
            input([x, [random.index(2) as f64, 0.0, 0.0, 0.0]])
        })
        // It is what 1 is less by.
        .beside(1.0),
        Twin::new(
            "sees_disc",
            "ray_seen",
            "return vec4f(select(0.0, 1.0, sees_disc(x[0].xyz, x[1].xyz, x[0].w, x[1].w)));",
            |x| {
                // A pixel around the disc, which is no smaller than one.
                let (chord, radius, pixel) = ((xyz(x[0]) - xyz(x[1])).length(), x[0][3], x[1][3]);
                let reach = radius.max(pixel) + pixel;
                let near = (chord - reach).abs() < 1e-6 * (1.0 + reach);
                one(if near { f64::NAN } else { f64::from(radius > 0.0 && chord < reach) })
            },
        )
        .over("all", |random| {
            let to_sun = random.direction();
            let angle = random.log(1e-4, 0.1);
            let radius = [0.0, 0.004625, random.log(1e-3, 0.1)][random.index(3)];
            input([
                vector(random.direction_off(to_sun, angle), radius),
                vector(to_sun, random.log(1e-4, 0.03)),
            ])
        }),
        Twin::new("ray_mean", "ray_seen", "return vec4f(ray_mean(x[1].x, past(x[0], x[1].y)));", |x| {
            // Where others hide some of it the weights are as much less.
            one(x[1][0] / (x[1][1] * x[0][0] / x[0][2]))
        })
        .declaring(SEEN)
        .over("all", |random| {
            input([seen_ray(random), [random.log(1e-3, 1e6), random.between(1e-3, 1.0), 0.0, 0.0]])
        }),
        Twin::new("ray_height", "ray_seen", "return vec4f(ray_height(x[1].x, x[1].y, seen(x[0])));", |x| {
            // A cloud less than a metre high is a metre high.
            let mean = x[1][0] / (x[0][0] / x[0][2]);
            one((0.5 + mean / x[1][1].max(1.0)).clamp(0.0, 1.0))
        })
        .declaring(SEEN)
        .over("all", |random| {
            let (seen, extent) = (seen_ray(random), random.log(0.1, 1e4));
            let sum = seen[0] * extent * random.between(-1.0, 1.0);
            input([seen, [sum, extent, 0.0, 0.0]])
        }),
    ]
}

fn nodes() -> Vec<Twin> {
    vec![
        Twin::new("node_of", "ray_seen", "return vec4f(f32(node_of(x[0].x, x[0].y, u32(x[0].z))));", |x| {
            let [gathered, seen, count, _] = x[0];
            let place = (gathered + seen / 2.0) * count;
            // Between two nodes rounding decides.
            let between = place > 0.5 && (place - place.round()).abs() < 1e-5;
            one(if between { f64::NAN } else { place.floor().min(count - 1.0) })
        })
        .exact()
        .edges(grid(&[0.0, 0.3, 0.9], &[0.0, 0.05, 0.3], &[1.0, 6.0, 8.0], &[0.0]))
        .over("all", |random| {
            let gathered = random.between(0.0, 1.0);
            scalars([gathered, random.between(0.0, 1.0 - gathered), 1.0 + random.index(8) as f64])
        }),
        Twin::new(
            "node_begins",
            "ray_seen",
            "return vec4f(select(0.0, 1.0, node_begins(x[0].x, u32(x[0].y), u32(x[0].z))));",
            |x| {
                let [gathered, node, count, _] = x[0];
                let middle = (node + 0.5) / count;
                one(if (gathered - middle).abs() < 1e-6 { f64::NAN } else { f64::from(gathered < middle) })
            },
        )
        .exact()
        .edges(grid(&[0.0, 0.08, 0.09, 0.5, 0.95], &[0.0, 3.0, 5.0], &[6.0], &[0.0]))
        .over("all", |random| {
            let count = 1 + random.index(8);
            scalars([random.between(0.0, 1.0), random.index(count) as f64, count as f64])
        }),
        Twin::new(
            "piece_with",
            "ray_seen",
            "let p = piece_with(Piece(3.0, 7.0, x[1].xy, x[0].x, x[0].y, x[0].z), x[2].x, x[2].y, x[2].z, x[2].w);
             if x[1].w > 0.5 { return vec4f(p.sun, p.sun); }
             return vec4f(p.end, p.optical_depth, p.seen, p.distance);",
            |x| {
                let [t, length, depth, seen] = x[2];
                match x[1][3] > 0.5 {
                    true => [x[1][0], x[1][1], x[1][0], x[1][1]],
                    false => {
                        // The step's light comes from its middle.
                        let middle = t + length / 2.0;
                        [t + length, x[0][0] + depth, x[0][1] + seen, x[0][2] + seen * middle]
                    }
                }
            },
        )
        .over("all", |random| {
            let (seen, more) = (random.between(0.0, 0.5), random.between(0.0, 0.5));
            let t = random.log(1.0, 1e5);
            input([
                [random.log(1e-3, 1e2), seen, seen * t, 0.0],
                [random.log(1e-3, 1e3), random.log(1e-3, 1e2), 0.0, random.index(2) as f64],
                [t, random.log(1e-2, 1e3), random.log(1e-3, 10.0), more],
            ])
        }),
    ]
}

fn columns() -> Vec<Twin> {
    vec![
        Twin::new("chord_step", "column", "return vec4f(chord_step(x[0].xy, x[0].z, u32(x[0].w)));", |x| {
            one((x[0][1].min(x[0][2]) - x[0][0]) / x[0][3])
        })
        .edges(grid(&[-40.0, -3.0], &[-1.0, 5.0], &[0.0, 2.0], &[1.0, 12.0]))
        .over("all", |random| {
            let begin = -random.log(0.1, 1e5);
            scalars([begin, begin + random.log(0.1, 1e5), 0.0, 12.0])
        }),
        Twin::new(
            "chord_middle",
            "column",
            "return vec4f(chord_middle(x[0].xy, x[0].z, u32(x[0].w)));",
            |x| one(x[0][0] + x[0][2] * (2.0 * x[0][3] + 1.0) / 2.0),
        )
        .over("all", |random| {
            scalars([-random.log(0.1, 1e5), 0.0, random.log(0.01, 1e3), random.index(12) as f64])
        }),
        Twin::new("column_seen", "column", "return vec4f(column_seen(x[0].x, x[0].y));", |x| {
            // The beam before the sample less the beam behind it.
            one((-x[0][0]).exp() * -(-x[0][1]).exp_m1())
        })
        .edges(plane(&[0.0, 1.0, 50.0], &[0.0, 1e-3, 2.0, 1e4]))
        .beside(1.0)
        .over("all", |random| scalars([random.log(1e-6, 1e4), random.log(1e-6, 1e4)]))
        // Samples add up to the coverage, up to 1.
        .beside(1.0),
        Twin::new("column_map", "column", "return column_map(x[0].x, x[0].y, x[0].z, x[0].w);", |x| {
            let [front, back, depth, most] = x[0];
            let coverage = -(-depth).exp_m1();
            [front, coverage * back, coverage * depth.min(most), coverage]
        })
        .edges(grid(&[0.0, 0.5], &[0.9], &[0.0, 1e-3, 1.0, 4e4], &[3e4]))
        .beside(1.0)
        .over("all", |random| {
            let front = random.between(0.0, 1.0);
            scalars([front, random.between(front, 1.0), random.log(1e-6, 1e5), 3e4])
        })
        // What is covered is a share of the texel.
        .beside(1.0),
        Twin::new(
            "square_step",
            "column",
            "return vec4f(square_step(u32(x[0].x), u32(x[0].y)), 0.0, 0.0);",
            |x| two((x[0][0] / x[0][1]).powi(2), ((x[0][0] + 1.0) / x[0][1]).powi(2)),
        )
        .edges(plane(&[0.0, 1.0, 2.0, 3.0], &[4.0, 7.0])),
        Twin::new(
            "level_direction",
            "column",
            "return vec4f(level_direction(u32(x[0].x), u32(x[0].y)), 0.0);",
            |x| {
                let (sine, cosine) = (TAU * x[0][0] / x[0][1]).sin_cos();
                [cosine, 0.0, sine, f64::NAN]
            },
        )
        .edges(plane(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0], &[6.0, 8.0]))
        // Parts of a unit vector.
        .beside(1.0),
    ]
}

/// A box of 1 m to 100 km, and a ray towards a point around it, along an axis one time in four.
fn box_ray(random: &mut Random) -> Input {
    let low = random.log(0.1, 1e4) * random.direction();
    let size = DVec3::from([(); 3].map(|()| random.log(1.0, 1e5)));
    let origin = low + random.log(0.1, 1e5) * random.direction();
    let target = low + size * DVec3::from([(); 3].map(|()| random.between(-0.2, 1.2)));
    let axis = random.sign() * [DVec3::X, DVec3::Y, DVec3::Z][random.index(3)];
    let direction = [axis, (target - origin).normalize()][random.index(4).min(1)];
    input([vector(low, 0.0), vector(low + size, 0.0), vector(origin, 0.0), vector(direction, 0.0)])
}

fn steady(d: DVec3) -> DVec3 {
    let least = f64::from(1e-12f32);
    DVec3::from(d.to_array().map(|x| if x.abs() < least { least } else { x }))
}

/// Behind the last of the planes that bound it from before, and before the first of those from behind.
fn box_span(x: &Wide) -> Output {
    let [low, high, origin, direction] = [0, 1, 2, 3].map(|i| xyz(x[i]));
    let d = steady(direction);
    let (mut enters, mut leaves) = (0.0, f64::INFINITY);
    for i in 0..3 {
        let (first, last) = if d[i] > 0.0 { (low[i], high[i]) } else { (high[i], low[i]) };
        enters = f64::max(enters, (first - origin[i]) / d[i]);
        leaves = f64::min(leaves, (last - origin[i]) / d[i]);
    }
    two(enters, leaves)
}

fn cell_exit(x: &Wide) -> f64 {
    let (place, direction, edge) = (xyz(x[0]), xyz(x[1]), x[0][3]);
    let d = steady(direction);
    let way = |i: usize| {
        let inside = place[i] - place[i].floor();
        edge * (x[1][3] + if direction[i] > 0.0 { 1.0 - inside } else { inside }) / d[i].abs()
    };
    (0..3).map(way).fold(f64::INFINITY, f64::min) + 1e-4 * edge
}

fn boxes() -> Vec<Twin> {
    vec![
        Twin::new("steady_direction", "ray_box", "return vec4f(steady_direction(x[0].xyz), 0.0);", |x| {
            let d = steady(xyz(x[0]));
            [d.x, d.y, d.z, f64::NAN]
        })
        .edges(grid(&[-1.0, 0.0, 1e-13], &[-1e-13, 0.5], &[1e-11, -0.0], &[0.0])),
        Twin::new(
            "box_span",
            "ray_box",
            "return vec4f(box_span(x[0].xyz, x[1].xyz, x[2].xyz, x[3].xyz), 0.0, 0.0);",
            box_span,
        )
        .over("all", box_ray),
        Twin::new(
            "cell_exit",
            "ray_box",
            "return vec4f(cell_exit(x[0].xyz, x[0].w, x[1].w, x[1].xyz));",
            |x| one(cell_exit(x)),
        )
        .over("all", |random| {
            let place = DVec3::from([(); 3].map(|()| random.between(-1.0, 64.0)));
            let axis = random.sign() * [DVec3::X, DVec3::Y, DVec3::Z][random.index(3)];
            let direction = [axis, random.direction()][random.index(4).min(1)];
            let around = [0, random.index(64)][random.index(2)];
            input([vector(place, random.log(0.1, 1e3)), vector(direction, around as f64)])
        }),
    ]
}
