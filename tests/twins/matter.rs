//! How lumps join, what is behind the edge that they make, and the noise that displaces it.
//!
//! An edge is packed as its depth, extinction, boundary and wispiness in x[0]; a body as its base, the
//! inverse of its height, stratification and dilution in x[1]; whether it is uneven, the height of the
//! point, billows and wisps in x[2]; the width of a pixel and the level of the base in x[3].

use crate::common::constants::{constant, constants};
use crate::definitions::rise;
use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, plane, scalars, three, two, xyz};
use glam::DVec3;

const BODY: &str = "fn body(x: array<vec4f, 8>) -> Body {
    var body: Body;
    body.base = x[1].x; body.inverse_height = x[1].y; body.stratification = x[1].z; body.dilution = x[1].w;
    body.uneven = x[2].x; body.level = x[3].y;
    return body;
}
fn edge(x: array<vec4f, 8>) -> Edge { return Edge(x[0].x, x[0].y, x[0].z, x[0].w); }
fn lump(x: vec4f) -> Ellipsoid { return Ellipsoid(vec4f(), vec4f(), vec4f(), vec3f(), x.x, x.y, x.z, 0.0, 0u); }";

fn density(name: &str) -> f64 {
    constant("density", name)
}

/// The 2/3 power of the height above the base, of which there is a share.
fn profile(height: f64, share: f64) -> f64 {
    let height = height.clamp(f64::from(1e-4f32), 1.0);
    1.0 - share + share * height.cbrt().powi(2)
}

/// What a lump weighs: its depth in units of the reach, to a power.
fn weight(depth: f64, power: f64, reach: f64) -> f64 {
    if depth > 0.0 { (power * (depth / reach).max(f64::from(1e-4f32)).ln()).exp() } else { 0.0 }
}

fn rise_of(boundary: f64, wispiness: f64) -> f64 {
    let [billows, wisps] = constants("density", "RISE")[..] else { panic!("of billows and of wisps") };
    let [billows, wisps] = [billows, wisps].map(|share| f64::from(share as f32));
    ((billows * (1.0 - wispiness) + wisps * wispiness) * boundary).max(density("LEAST_RISE"))
}

/// How far noise moves an edge inwards, m: by all that is not its rise where it is lowest.
fn moved(boundary: f64, wispiness: f64, noise: [f64; 2]) -> f64 {
    let n = noise[0] * (1.0 - wispiness) + noise[1] * wispiness;
    (boundary - rise_of(boundary, wispiness)).max(0.0) * (1.0 - n) / 2.0
}

fn kept(dilution: f64, depth: f64, boundary: f64) -> f64 {
    let rim = (density("DILUTED") - 1.0) * boundary.max(density("LEAST_RISE"));
    1.0 - dilution + dilution * rise(depth / rim)
}

fn below(x: &Wide) -> Output {
    let ([depth, extinction, boundary, wispiness], [base, inverse_height, share, dilution]) = (x[0], x[1]);
    let [uneven, y, billows, wisps] = x[2];
    let rise_m = rise_of(boundary, wispiness);
    // Each metre above the level is worth several.
    let steep = density("LEVELLING");
    let low = steep * (y - x[3][1]);
    let (depth, steep) = if low < depth { (low, steep) } else { (depth, 1.0) };
    // An edge wider than it is grows to both sides.
    let width = rise_m.max(steep * x[3][0]);
    let d = depth - moved(boundary, wispiness, [billows, wisps]) + (width - rise_m) / 2.0;
    let height = y - base;
    let there = extinction * profile(height * inverse_height, share) * kept(dilution, d, boundary);
    // Changes end where the rise does, or the diluted rim; what changes with height or density does so
    // over a share of the height or depth.
    let rim = if dilution > 0.0 { (density("DILUTED") - 1.0) * boundary } else { 0.0 };
    let mut inside = d - width.max(rim);
    if uneven > 0.0 {
        inside = inside.min(density("EVEN") * depth.min(height.max(0.0)));
    }
    [there * rise(d / width), d, inside.max(-d) / steep, 2.0]
}

/// What is deep in a cloud: matter in x[0], body and height as everywhere.
fn at_height(x: &Wide) -> Output {
    let ([extinction, depth, steady, clear], height) = (x[0], x[2][1] - x[1][0]);
    let even = if x[2][0] > 0.0 { steady.min(density("EVEN") * height.max(0.0)) } else { steady };
    [extinction * profile(height * x[1][1], x[1][2]), depth, even, clear]
}

/// Two clouds in x[0] and x[1] (extinction, depth, steady, body).
fn both(x: &Wide) -> Output {
    let (a, b) = (x[0], x[1]);
    let there = [a, b].map(|matter| matter[0] > 0.0);
    let of = match there {
        [true, true] | [false, true] if b[0] > a[0] => b,
        [false, false] if b[1] > a[1] => b,
        _ => a,
    };
    // Where there are two, either may change.
    let steady = if there == [true, true] { 0.0 } else { of[2] };
    [a[0].max(b[0]), a[1].max(b[1]), steady, of[3]]
}

/// Each finer octave rides on the sum of the coarser ones.
fn noise(x: &Wide) -> Output {
    let (coarse, fine, [a, b, c, scale]) = (x[0], x[1], x[2]);
    let octaves = [(a, coarse[1]), (b, fine[0]), (c, fine[1])];
    let billows =
        octaves.into_iter().fold(coarse[0], |sum, (amplitude, octave)| sum + amplitude * octave * ride(sum));
    let wisps = coarse[2] + b * fine[2];
    two((scale * billows).clamp(-1.0, 1.0), (scale * wisps).clamp(-1.0, 1.0))
}

fn ride(billows: f64) -> f64 {
    (1.0 + constant("noise", "RIDE") * billows).max(f64::from(0.1f32))
}

/// Any edge of any body.
fn any(random: &mut Random) -> Input {
    let share = |random: &mut Random| [0.0, random.between(0.0, 1.0), 1.0][random.index(3)];
    let boundary = [0.0, random.log(0.1, 300.0)][random.index(2)];
    let height = random.log(10.0, 1e4);
    let base = random.between(-1.0, 1.0) * height;
    let (stratification, dilution) = (share(random), share(random));
    let level = [-1e30, base + height * random.between(-0.2, 0.5)][random.index(2)];
    input([
        [
            random.between(-0.2, 4.0) * boundary.max(1.0),
            random.log(1e-4, 1.0),
            boundary,
            random.between(0.0, 1.0),
        ],
        [base, 1.0 / height, stratification, dilution],
        [
            random.index(2) as f64,
            base + height * random.between(-0.1, 1.1),
            random.between(-1.0, 1.0),
            random.between(-1.0, 1.0),
        ],
        [[0.0, random.log(0.01, 300.0)][random.index(2)], level, 0.0, 0.0],
    ])
}

pub fn twins() -> Vec<Twin> {
    let mut all = lumps();
    all.extend(edges());
    all.extend(octaves());
    all.extend(flows());
    all
}

fn lumps() -> Vec<Twin> {
    vec![
        Twin::new("lump_weight", "density", "return vec4f(lump_weight(x[0].x, x[0].y, x[0].z));", |x| {
            one(weight(x[0][0], x[0][1], x[0][2]))
        })
        .edges(grid(&[-3.0, 0.0, 1e-3, 20.0, 80.0], &[2.0, 5.0, 8.0], &[1.0, 80.0], &[0.0]))
        .over("all", |random| {
            let reach = random.log(0.01, 1e4);
            scalars([reach * random.log(1e-4, 1.5), random.between(2.0, 8.0), reach])
        }),
        Twin::new(
            "lumps_with",
            "density",
            "let l = lumps_with(Lumps(0.3, 0.01, 6.0, 0.1, 9.0), lump(x[1]), x[0].x, x[0].y, x[0].z);
             return vec4f(l.weight, l.extinction, l.boundary, l.wispiness + l.deepest);",
            |x| {
                let w = weight(x[0][0], x[0][1], x[0][2]);
                let [a, b, c] = [0.3f32, 0.01, 0.1].map(f64::from);
                [a + w, b + w * x[1][0], 6.0 + w * x[1][1], c + w * x[1][2] + x[0][0].max(9.0)]
            },
        )
        .declaring(BODY)
        .over("all", |random| {
            let reach = random.log(0.1, 1e3);
            let depth = random.sign() * reach * random.log(1e-3, 1.0);
            let edge = [random.log(1e-4, 1.0), random.log(0.1, 300.0), random.between(0.0, 1.0), 0.0];
            input([[depth, random.between(2.0, 8.0), reach, 0.0], edge])
        }),
        Twin::new(
            "lumps_edge",
            "density",
            "let e = lumps_edge(Lumps(x[0].x, x[0].y, x[0].z, x[0].w, x[1].x), x[1].y, x[1].z);
             return vec4f(e.depth, e.extinction, e.boundary, e.wispiness);",
            |x| {
                let ([sum, extinction, boundary, wispiness], [deepest, power, reach, _]) = (x[0], x[1]);
                if sum <= 0.0 {
                    return [deepest, 0.0, 0.0, 0.0];
                }
                [reach * (sum.ln() / power).exp(), extinction / sum, boundary / sum, wispiness / sum]
            },
        )
        .over("all", |random| {
            let sum = [0.0, random.log(1e-8, 30.0)][random.index(2)];
            let means = [random.log(1e-4, 1.0), random.log(0.1, 300.0), random.between(0.0, 1.0)];
            let [extinction, boundary, wispiness] = means.map(|mean| sum * mean);
            let joined = [random.between(-300.0, 300.0), random.between(2.0, 8.0), random.log(0.1, 1e3), 0.0];
            input([[sum, extinction, boundary, wispiness], joined])
        }),
        Twin::new("height_profile", "body", "return vec4f(height_profile(x[0].x, x[0].y));", |x| {
            one(profile(x[0][0], x[0][1]))
        })
        .edges(plane(&[-1.0, 0.0, 1e-4, 0.1, 0.5, 1.0, 2.0], &[0.0, 0.3, 1.0]))
        .over("all", |random| scalars([random.log(1e-5, 1.2), random.between(0.0, 1.0)])),
    ]
}

fn edges() -> Vec<Twin> {
    vec![
        Twin::new("smooth_rise", "density", "return vec4f(smooth_rise(x[0].x));", |x| one(rise(x[0][0])))
            .edges(line(&[-1.0, 0.0, 1e-3, 0.2, 0.5, 0.9, 1.0, 3.0]))
            .over("all", |random| input([[random.log(1e-6, 2.0), 0.0, 0.0, 0.0]])),
        Twin::new("edge_rise", "density", "return vec4f(edge_rise(edge(x)));", |x| {
            one(rise_of(x[0][2], x[0][3]))
        })
        .declaring(BODY)
        .edges(grid(&[9.0], &[0.1], &[0.0, 1e-3, 30.0, 400.0], &[0.0, 0.3, 1.0]))
        .over("all", any),
        Twin::new(
            "displaced_depth",
            "density",
            "return vec4f(displaced_depth(edge(x), edge_rise(edge(x)), x[2].zw));",
            |x| one(x[0][0] - moved(x[0][2], x[0][3], [x[2][2], x[2][3]])),
        )
        .declaring(BODY)
        .over("all", any),
        Twin::new("level_depth", "density", "return vec4f(level_depth(body(x), x[2].y));", |x| {
            one(density("LEVELLING") * (x[2][1] - x[3][1]))
        })
        .declaring(BODY)
        .over("all", any),
        Twin::new("undiluted", "density", "return vec4f(undiluted(x[0].x, x[0].y, x[0].z));", |x| {
            one(kept(x[0][0], x[0][1], x[0][2]))
        })
        .edges(grid(&[0.0, 0.4, 1.0], &[-5.0, 0.0, 10.0, 60.0, 900.0], &[0.0, 30.0], &[0.0]))
        .over("all", |random| {
            let boundary = random.log(0.01, 300.0);
            scalars([random.between(0.0, 1.0), boundary * random.between(-0.5, 3.0), boundary])
        }),
        Twin::new(
            "matter_below",
            "density",
            "let m = matter_below(body(x), 2u, edge(x), x[2].y, x[2].zw, x[3].x);
             return vec4f(m.extinction, m.depth, m.steady, f32(m.body) + m.clear);",
            below,
        )
        .declaring(BODY)
        .over("all", any),
        Twin::new(
            "matter_at_height",
            "density",
            "let m = matter_at_height(body(x), Matter(x[0].x, x[0].y, x[0].z, x[0].w, 0u), x[2].y);
             return vec4f(m.extinction, m.depth, m.steady, m.clear);",
            at_height,
        )
        .declaring(BODY)
        .over("all", |random| {
            let mut x = any(random);
            let matter = [random.log(1e-4, 1.0), random.log(1.0, 1e4), random.log(1.0, 1e3), 0.0];
            x[0] = input([matter])[0];
            x
        }),
        Twin::new(
            "matter_union",
            "density",
            "let m = matter_union(Matter(x[0].x, x[0].y, x[0].z, 0.0, u32(x[0].w)),
                Matter(x[1].x, x[1].y, x[1].z, 0.0, u32(x[1].w)));
             return vec4f(m.extinction, m.depth, m.steady, f32(m.body));",
            both,
        )
        .over("all", |random| {
            let mut matter = |body| {
                let extinction = [0.0, random.log(1e-4, 1.0)][random.index(2)];
                [extinction, random.between(-100.0, 100.0), random.between(-10.0, 100.0), body]
            };
            input([matter(1.0), matter(2.0)])
        }),
    ]
}

fn octaves() -> Vec<Twin> {
    vec![
        Twin::new("noise_ride", "noise", "return vec4f(noise_ride(x[0].x));", |x| one(ride(x[0][0])))
            .edges(line(&[-3.0, -1.0, -0.5, 0.0, 0.7, 1.5]))
            .over("all", |random| scalars([random.between(-2.0, 2.0)])),
        Twin::new(
            "noise_sum",
            "noise",
            "return vec4f(noise_sum(x[0], x[1], x[2].xyz, x[2].w), 0.0, 0.0);",
            noise,
        )
        .over("all", |random| {
            let mut octaves = || [(); 4].map(|()| random.between(-1.0, 1.0));
            let (coarse, fine) = (octaves(), octaves());
            let weights = [random.between(0.0, 1.0), random.between(0.0, 1.0), random.between(0.0, 1.0)];
            input([coarse, fine, [weights[0], weights[1], weights[2], random.between(0.3, 1.0)]])
        }),
    ]
}

/// A sum of shears along each axis, by cosines and sines that go round once a period (Dombre et al. 1986, eq. 1.1).
fn eddies(q: DVec3) -> DVec3 {
    let turn = std::f64::consts::TAU * q;
    let shear = |a: f64, b: f64| a.sin() + b.cos();
    DVec3::new(shear(turn.z, turn.y), shear(turn.x, turn.z), shear(turn.y, turn.x)) / 3f64.sqrt()
}

/// A volume that is turned about x by a right angle, of a period of 1 / x[0].x, carried over x[0].y.
fn carried(x: &Wide) -> Output {
    let (frequency, way, p) = (x[0][0], x[0][1], xyz(x[2]));
    let q = frequency * DVec3::new(p.x, p.z, -p.y) + xyz(x[1]);
    let v = eddies(q);
    let world = DVec3::new(v.x, -v.z, v.y);
    three(p - way * (constant("noise", "LIFT") * DVec3::Y + constant("noise", "ROLL") * world))
}

fn place(random: &mut Random, size: f64) -> [f64; 3] {
    [(); 3].map(|()| size * random.between(-1.0, 1.0))
}

fn flows() -> Vec<Twin> {
    const FRAME: &str = "fn frame(x: array<vec4f, 8>) -> NoiseFrame {
        var frame: NoiseFrame;
        frame.coarse_x = vec4f(x[0].x, 0.0, 0.0, x[1].x);
        frame.coarse_y = vec4f(0.0, 0.0, x[0].x, x[1].y);
        frame.coarse_z = vec4f(0.0, -x[0].x, 0.0, x[1].z);
        frame.flow = x[3];
        return frame;
    }";
    vec![
        Twin::new("noise_eddies", "noise", "return vec4f(noise_eddies(x[0].xyz), 0.0);", |x| {
            three(eddies(xyz(x[0])))
        })
        .over("all", |random| {
            let [a, b, c] = place(random, 1.0);
            input([[a, b, c, 0.0]])
        }),
        Twin::new(
            "noise_carried",
            "noise",
            "return vec4f(noise_carried(frame(x), x[2].xyz, x[0].y), 0.0);",
            carried,
        )
        .declaring(FRAME)
        .over("all", |random| {
            let period = random.log(1.0, 1e4);
            let ([a, b, c], [x, y, z]) = (place(random, 1.0), place(random, period));
            let way = 0.25 * period * random.between(-0.5, 0.5);
            input([[1.0 / period, way, 0.0, 0.0], [a, b, c, 0.0], [x, y, z, 0.0]])
        }),
        Twin::new("noise_is_still", "noise", "return vec4f(f32(noise_is_still(frame(x))));", |x| {
            one(f64::from(u8::from(x[3] == [0.0; 4])))
        })
        .declaring(FRAME)
        .over("all", any_flow),
        Twin::new("noise_reads", "noise", "return vec4f(f32(noise_reads(frame(x))));", |x| {
            one(if x[3] == [0.0; 4] { 2.0 } else { 4.0 })
        })
        .declaring(FRAME)
        .over("all", any_flow),
        Twin::new(
            "noise_mixed",
            "noise",
            "return vec4f(noise_mixed(x[0].xy, x[0].zw, x[1].xy), 0.0, 0.0);",
            |x| {
                let sum = |i: usize| (x[1][0] * x[0][i] + x[1][1] * x[0][2 + i]).clamp(-1.0, 1.0);
                two(sum(0), sum(1))
            },
        )
        .over("all", |random| {
            let mut noise = || random.between(-1.0, 1.0);
            let values = [noise(), noise(), noise(), noise()];
            let turn = noise() * std::f64::consts::PI;
            input([values, [turn.sin().abs(), turn.cos().abs(), 0.0, 0.0]])
        }),
    ]
}

/// Often one that stands still.
fn any_flow(random: &mut Random) -> Input {
    let moving = random.index(2) as f64;
    let flow = [(); 4].map(|()| moving * random.between(-1.0, 1.0));
    input([[0.0; 4], [0.0; 4], [0.0; 4], flow])
}

/// Depths of lumps, weighted by their places in the list so that what is theirs is known again; the depth,
/// extinction, boundary and wispiness of what they make together.
fn joined(inputs: &[Input]) -> Vec<[f32; 4]> {
    // Depths in x[0], how many in x[1].x, power and reach behind.
    let body = "var l = NO_LUMPS;
        for (var i = 0u; i < u32(x[1].x); i++) {
            let mark = f32(i + 1u);
            l = lumps_with(l, lump(vec4f(0.01 * x[2][i], 10.0 * x[2][i], 0.1 * x[2][i], 0.0)), x[0][i], x[1].y, x[1].z);
        }
        let e = lumps_edge(l, x[1].y, x[1].z);
        return vec4f(e.depth, e.extinction, e.boundary, e.wispiness);";
    crate::common::evaluate_with("density", BODY, body, inputs)
}

/// Lumps of such depths with marks 1, 2, ... joined by a power, told in a reach.
fn join<const N: usize>(depths: [f64; N], marks: [f64; N], power: f64, reach: f64) -> Input {
    let (mut first, mut third) = ([0.0; 4], [0.0; 4]);
    first[..N].copy_from_slice(&depths);
    third[..N].copy_from_slice(&marks);
    input([first, [N as f64, power, reach, 0.0], third])
}

const POWERS: [f64; 4] = [2.0, 3.5, 5.0, 8.0];
const REACH: f64 = 80.0;
/// What two powers and a root of a depth lose in f32 on a device whose logarithms are good to 1.4e-5.
const POWER_ERROR: f64 = 1e-4;

#[test]
fn one_lump_is_as_deep_as_it_is_and_has_its_own_edge() {
    let cases: Vec<(f64, f64)> =
        POWERS.into_iter().flat_map(|power| [0.1, 3.0, 40.0, 80.0].map(|depth| (power, depth))).collect();
    let inputs: Vec<_> = cases.iter().map(|&(power, depth)| join([depth], [3.0], power, REACH)).collect();
    for ((power, depth), got) in cases.into_iter().zip(joined(&inputs)) {
        let wanted = [depth, 0.03, 30.0, 0.3];
        for (got, wanted) in got.into_iter().zip(wanted) {
            assert!((f64::from(got) / wanted - 1.0).abs() < POWER_ERROR, "{power}: {got} for {wanted}");
        }
    }
}

#[test]
fn two_lumps_are_deeper_than_each_by_a_root_of_two_at_most() {
    let mut cases = Vec::new();
    for power in POWERS {
        for (a, b) in [(0.5, 0.5), (10.0, 10.0), (10.0, 9.0), (40.0, 3.0), (80.0, 79.0), (0.2, 70.0)] {
            cases.push((power, a, b));
        }
    }
    let of = |order: bool| {
        let input = |&(power, a, b): &(f64, f64, f64)| {
            let (depths, marks) = if order { ([a, b], [1.0, 2.0]) } else { ([b, a], [2.0, 1.0]) };
            join(depths, marks, power, REACH)
        };
        joined(&cases.iter().map(input).collect::<Vec<_>>())
    };
    for ((&(power, a, b), one), other) in cases.iter().zip(of(true)).zip(of(false)) {
        let (depth, larger) = (f64::from(one[0]), a.max(b));
        let most = larger * 2_f64.powf(1.0 / power);
        assert!(
            depth > larger * (1.0 - POWER_ERROR) && depth < most * (1.0 + POWER_ERROR),
            "{depth} {larger}"
        );
        if a == b {
            assert!((depth / most - 1.0).abs() < POWER_ERROR, "{power}: {depth} for {most}");
        }
        // The mean is nearer to the deeper one's own.
        let share = (f64::from(one[1]) - 0.01) / 0.01;
        assert!(a == b || (share > 0.5) == (b > a), "{share} of the second");
        for (one, other) in one.into_iter().zip(other) {
            assert!((one / other - 1.0).abs() < 1e-6, "whichever comes first: {one} {other}");
        }
    }
}

#[test]
fn on_the_hull_depth_is_nothing_and_outside_it_is_that_of_the_nearest() {
    for power in POWERS {
        let of = |depths: [f64; 2]| joined(&[join(depths, [1.0, 2.0], power, REACH)])[0];
        let on = of([1e-3, -5.0]);
        // Told in the reach, depths end at a ten thousandth.
        assert!(f64::from(on[0]) <= 1.01e-4 * REACH, "{on:?}");
        assert_eq!(of([0.0, -5.0]), [0.0, 0.0, 0.0, 0.0]);
        assert_eq!(of([-7.0, -5.0]), [-5.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn where_a_lump_ends_nothing_jumps_nor_kinks() {
    // One lump stays 30 m deep, while another begins.
    let step = 0.5;
    for power in POWERS {
        let begins: Vec<f64> = (-8..=8).map(|i| step * f64::from(i)).collect();
        let inputs: Vec<_> = begins.iter().map(|&d| join([30.0, d], [1.0, 4.0], power, REACH)).collect();
        let found = joined(&inputs);
        for channel in 0..4 {
            let values: Vec<f64> = found.iter().map(|got| f64::from(got[channel])).collect();
            let whole = values[0].abs();
            for three in values.windows(3) {
                let (jump, kink) = (three[2] - three[1], three[2] - 2.0 * three[1] + three[0]);
                // A lump of 4 m weighs (4/30)^p beside one of 30 m: 0.018 at the softest, three times as
                // much of what is its own, and its step of 0.5 m a quarter of that.
                let weight = |d: f64| (d.max(0.0) / 30.0_f64).powf(power);
                let most = 3.0 * (weight(4.0) - weight(4.0 - step)) + 2.0 * POWER_ERROR;
                assert!(jump.abs() < most * whole, "{power}, {channel}: {values:?}");
                let curved = 3.0 * (weight(4.0) - 2.0 * weight(4.0 - step) + weight(4.0 - 2.0 * step));
                assert!(
                    kink.abs() < (curved.max(3.0 * weight(step)) + 4.0 * POWER_ERROR) * whole,
                    "{values:?}"
                );
            }
        }
    }
}
