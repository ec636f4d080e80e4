//! What a path of the path tracer chooses by chance, and what its choices weigh.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::harness::{Output, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, plane, scalars, three, vector, xyz};

/// One of 2^24 numbers from 0 to less than 1.
fn chance(random: &mut Random) -> f64 {
    let few = [16_777_216.0, 4096.0][random.index(2)];
    random.between(0.0, few).floor() / 16_777_216.0
}

fn three_of(random: &mut Random) -> DVec3 {
    DVec3::from([(); 3].map(|()| random.log(1e-4, 1e4)))
}

/// Turned about an axis across, then about itself.
fn turned(x: &Wide) -> Output {
    let (d, angle, azimuth) = (xyz(x[0]), x[1][0], x[1][1]);
    let helper = if d.x.abs() > f64::from(0.7f32) { DVec3::Y } else { DVec3::X };
    let d = d.normalize();
    let across = d.cross(helper).normalize();
    let off = DQuat::from_axis_angle(d.cross(across), angle) * d;
    three(DQuat::from_axis_angle(d, azimuth) * off)
}

/// Sixteen samples that came before: mean, alpha, squares, and one more.
fn sums(x: &Wide) -> Output {
    let ([light, hit, n, which], mean, alpha, squares) = (x[0], xyz(x[1]), x[1][3], xyz(x[2]));
    let difference = DVec3::splat(light) - mean;
    if which > 0.5 {
        // The squares grow by those of the differences to the mean before, (n - 1) / n of them.
        return three(squares + difference * difference * (n - 1.0) / n);
    }
    let mean = ((n - 1.0) * mean + DVec3::splat(light)) / n;
    vector(mean, ((n - 1.0) * alpha + hit) / n)
}

pub fn twins() -> Vec<Twin> {
    let mut all = choices();
    all.extend(weights());
    all
}

fn choices() -> Vec<Twin> {
    vec![
        Twin::new("share_coordinate", "path_choice", "return vec4f(share_coordinate(x[0].x));", |x| {
            let share = x[0][0];
            one(if share < 0.5 { (share / 2.0).sqrt() } else { 1.0 - ((1.0 - share) / 2.0).sqrt() })
        })
        .edges(line(&[0.0, 1e-6, 0.49, 0.5, 0.51, 1.0]))
        .over("all", |random| scalars([chance(random)])),
        Twin::new("turned", "path_choice", "return vec4f(turned(x[0].xyz, x[1].x, x[1].y), 0.0);", turned)
            .over("all", |random| {
                let angle =
                    [random.between(0.0, std::f64::consts::PI), random.log(1e-6, 0.1)][random.index(2)];
                input([vector(random.direction(), 0.0), [angle, random.between(0.0, TAU), 0.0, 0.0]])
            })
            // Parts of a unit vector.
            .beside(1.0),
        Twin::new("any_direction", "path_choice", "return vec4f(any_direction(x[0].x, x[0].y), 0.0);", |x| {
            // By the angle from the pole, whose cosine is even.
            let polar = (1.0 - 2.0 * x[0][0]).acos();
            three(DVec3::new(polar.sin() * x[0][1].cos(), polar.cos(), polar.sin() * x[0][1].sin()))
        })
        .edges(line(&[0.0, 0.25, 0.5, 1.0]))
        .over("all", |random| scalars([chance(random), random.between(0.0, TAU)]))
        // Parts of a unit vector.
        .beside(1.0),
        Twin::new("normal_number", "path_choice", "return vec4f(normal_number(x[0].x, x[0].y));", |x| {
            one((-2.0 * (-x[0][0]).ln_1p()).sqrt() * x[0][1].cos())
        })
        .over("all", |random| scalars([random.between(0.01, 1.0), random.between(0.0, TAU)]))
        .beside(1.0),
        Twin::new("disc_angle", "path_choice", "return vec4f(disc_angle(x[0].x, x[0].y));", |x| {
            // Within that angle is this share of the disc.
            one((x[0][0] * x[0][0] * x[0][1]).sqrt())
        })
        .edges(plane(&[0.0, 0.004625], &[0.0, 0.25, 1.0]))
        .over("all", |random| scalars([random.log(1e-4, 0.1), chance(random)])),
        Twin::new("free_flight", "path_choice", "return vec4f(free_flight(x[0].x));", |x| {
            one(-(-x[0][0]).ln_1p())
        })
        .edges(line(&[0.0, 0.5, 0.999_999_94]))
        .beside(1.0)
        .over("all", |random| scalars([chance(random)]))
        // Its mean is 1.
        .beside(1.0),
        Twin::new("real_share", "path_choice", "return vec4f(real_share(x[0].x, x[0].y));", |x| {
            one(x[0][0] / x[0][1].max(f64::from(1e-20f32)))
        })
        .edges(plane(&[0.0], &[0.0, 1e-30, 0.1]))
        .over("all", |random| {
            let majorant = random.log(1e-6, 10.0);
            scalars([majorant * random.between(0.0, 1.0), majorant])
        }),
        Twin::new(
            "share_around_sun",
            "path_choice",
            "return vec4f(share_around_sun(x[0].x, x[0].y, x[0].z, u32(x[0].w)));",
            |x| {
                // The least falls off to eight collisions' worth over the number of collisions.
                let [least, most, toward, collisions] = x[0];
                let held = least / (1.0 + (collisions - 1.0) / 8.0);
                one(if least > 0.0 { held.max(most / (1.0 + 1.0 / toward)) } else { 0.0 })
            },
        )
        .edges(grid(&[0.0, 0.03], &[0.3], &[1e-6, 1.0, 3e3], &[1.0, 2.0, 400.0]))
        .over("all", |random| scalars([0.03, 0.3, random.log(1e-6, 1e4), 1.0 + random.index(1000) as f64])),
        Twin::new(
            "roulette_survival",
            "path_choice",
            "return vec4f(roulette_survival(x[0].xyz, 0.05, x[0].w > 0.5));",
            |x| {
                let faint = xyz(x[0]).max_element() < f64::from(0.05f32);
                one(if faint && x[0][3] < 0.5 { 0.25 } else { 1.0 })
            },
        )
        .exact()
        .edges(grid(&[0.0, 0.06], &[0.04, 0.05], &[0.01, 0.2], &[0.0, 1.0])),
        Twin::new("walk_chance", "path_choice", "return vec4f(walk_chance(x[0].x, x[0].y));", |x| {
            let [light, dim, ..] = x[0];
            let chance = if light > dim { 1.0 } else { light / dim };
            one(if chance < 0.1 { f64::from(0.1f32) } else { chance })
        })
        .edges(plane(&[0.0, 1e-4, 0.02, 0.04, 1.0, 1e4], &[0.03]))
        .over("all", |random| scalars([random.log(1e-6, 10.0), random.log(1e-3, 1.0)])),
        Twin::new(
            "neighbour_count",
            "path_choice",
            "let n = neighbour_count(u32(x[0].x), x[0].y > 0.5, x[0].z, x[0].w);
             return vec4f(n, 0.0, 0.0);",
            neighbour_count,
        )
        .edges(grid(&[0.0, 3.0], &[0.0, 1.0], &[0.25, 0.75], &[0.0, 0.3, 0.6, 0.9, 0.999]))
        .over("all", |random| {
            // Off the powers of 1/4, where a rounding makes another number.
            let far = 1.0 - random.between(0.26, 0.99) * 0.25_f64.powi(random.index(7) as i32);
            scalars([random.index(40) as f64, random.index(2) as f64, random.between(0.0, 1.0), far])
        }),
    ]
}

/// Each number four times as likely as the next one away; those apart begin one step off, and 0 has
/// neighbours on one side only.
fn neighbour_count(x: &Wide) -> Output {
    let [count, apart, side, far] = x[0];
    let (mut steps, mut beyond) = (0, 0.25);
    let mut share = 0.75;
    while far >= 1.0 - beyond {
        beyond *= 0.25;
        share *= 0.25;
        steps += 1;
    }
    let steps = f64::from(steps + i32::from(apart > 0.5));
    let one_sided = steps == 0.0 || count == 0.0;
    let number = if count > 0.0 && side < 0.5 { count - steps } else { count + steps };
    [number, if one_sided { share } else { 0.5 * share }, f64::NAN, f64::NAN]
}

fn weights() -> Vec<Twin> {
    vec![
        Twin::new("balanced", "path_choice", "return vec4f(balanced(x[0].xyz), 0.0);", |x| {
            let densities = xyz(x[0]);
            three(densities / (densities.element_sum() / 3.0))
        })
        .over("all", |random| input([vector(three_of(random), 0.0)])),
        Twin::new("missed_share", "path_choice", "return vec4f(missed_share(x[0].x, x[0].y));", |x| {
            // Of all that are none of the events, those that are not real.
            one((1.0 - x[0][0]) / (1.0 - x[0][1]).max(f64::from(1e-6f32)))
        })
        .edges(plane(&[0.0, 0.5, 1.0], &[0.0, 0.25]))
        .over("all", |random| {
            let share = random.between(0.0, 1.0);
            scalars([share, share * random.between(0.0, 0.9)])
        }),
        Twin::new(
            "mixed_density",
            "path_choice",
            "return vec4f(mixed_density(x[0].w, x[0].xyz, x[1].xyz), 0.0);",
            |x| three(xyz(x[0]) - x[0][3] * xyz(x[0]) + x[0][3] * xyz(x[1])),
        )
        .over("all", |random| {
            let share = random.between(0.0, 0.5);
            input([vector(three_of(random), share), vector(three_of(random), 0.0)])
        }),
        Twin::new(
            "spectral_weight",
            "path_choice",
            "return vec4f(spectral_weight(x[0].xyz, x[1].xyz), 0.0);",
            |x| {
                // Over the mean density of the three channels.
                three(xyz(x[0]) / (xyz(x[1]).element_sum() / 3.0))
            },
        )
        .over("all", |random| input([vector(three_of(random), 0.0), vector(three_of(random), 0.0)])),
        Twin::new(
            "sum_with",
            "path_choice",
            "let s = sum_with(Sum(x[1].xyz, x[1].w, x[2].xyz, 0.0), x[0].xxx, x[0].y, u32(x[0].z));
             if x[0].w > 0.5 { return vec4f(s.squares, 0.0); }
             return vec4f(s.mean, s.alpha);",
            sums,
        )
        .over("all", |random| {
            let n = [1.0, 1.0 + random.index(10_000) as f64][random.index(4).min(1)];
            let kept = if n > 1.0 { 1.0 } else { 0.0 };
            let which = random.index(2) as f64;
            input([
                [random.log(1e-4, 1e4), random.index(2) as f64, n, which],
                vector(kept * three_of(random), kept * random.between(0.0, 1.0)),
                vector(kept * three_of(random), 0.0),
            ])
        }),
    ]
}
