//! Models of light: what a ray gathers of it, diffuse light, and slabs that are fitted to a cloud.

use std::f64::consts::PI;

use glam::DVec3;
use nephos::optics::slab::{SETS, spread};

use crate::definitions::{eddington, henyey_greenstein, mean_transmittance, sunlight_share};
use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{grid, input, one, plane, scalars, three, two, vector, xyz};

pub fn twins() -> Vec<Twin> {
    let mut all = outside();
    all.extend(sunlight());
    all.extend(forward());
    all.extend(diffuse());
    all.extend(slabs());
    all
}

/// Light of three channels from night to the sun, and a number beside it.
fn light(random: &mut Random, beside: f64) -> [f64; 4] {
    vector(DVec3::from([(); 3].map(|()| random.log(1e-6, 1e3))), beside)
}

/// Sun, sky, ground and horizon, with truncated share, albedo and opacity beside them.
const LIGHTS: &str = "
    fn lights(x: array<vec4f, 8>) -> Lights { return Lights(x[0].xyz, x[1].xyz, x[3].xyz, x[2].xyz); }
    fn kind(x: array<vec4f, 8>) -> Species { return Species(x[0].w, 0.7, x[1].w, 1.0, vec4f(1.0), 0.0, 0.0, vec2f(0.0)); }";

fn lit(random: &mut Random) -> Input {
    let share = [(); 3].map(|()| random.between(0.0, 0.99));
    input([light(random, share[0]), light(random, share[1]), light(random, share[2]), light(random, 0.0)])
}

fn outside() -> Vec<Twin> {
    vec![
        Twin::new("emitted", "lighting", "return vec4f(emitted(kind(x), x[2].w, x[3].xyz), 0.0);", |x| {
            let albedo = 1.0 - (1.0 - x[0][3]) * (1.0 - x[1][3]);
            three(albedo * x[2][3] * xyz(x[3]))
        })
        .declaring(LIGHTS)
        .over("all", lit),
        // Over 4 pi: the beam, and two hemispheres.
        Twin::new("mean_of_sun", "lighting", "return vec4f(mean_of_sun(lights(x)), 0.0);", |x| {
            three(xyz(x[0]) / (4.0 * PI))
        })
        .declaring(LIGHTS)
        .over("all", lit),
        Twin::new("mean_of_sky", "lighting", "return vec4f(mean_of_sky(lights(x)), 0.0);", |x| {
            three((2.0 * PI * xyz(x[1]) + 2.0 * PI * xyz(x[2])) / (4.0 * PI))
        })
        .declaring(LIGHTS)
        .over("all", lit),
        Twin::new(
            "weighted_lights",
            "lighting",
            "return vec4f(weighted_lights(x[4].xyz, lights(x)), 0.0);",
            |x| three(x[4][0] * xyz(x[1]) + x[4][1] * xyz(x[3]) + x[4][2] * xyz(x[2])),
        )
        .declaring(LIGHTS)
        .over("all", |random| {
            let mut x = lit(random);
            x[4] = [0.0; 4].map(|_: f32| random.between(0.0, 1.0) as f32);
            x
        }),
        Twin::new(
            "scattered_again",
            "lighting",
            "return vec4f(scattered_again(kind(x), x[0].xyz, x[1].xyz), 0.0);",
            |x| three(x[1][3] * xyz(x[0]) * xyz(x[1])),
        )
        .declaring(LIGHTS)
        .over("all", lit),
        Twin::new(
            "octave_light",
            "octave",
            "return vec4f(octave_light(Species(0.4, x[0].x, x[0].y, 1.0, vec4f(1.0), 0.0, 0.0, vec2f(0.0)), x[1].xy, x[0].z));",
            |x| {
                let [g, albedo, cosine, _] = x[0];
                let octave = |n: f64| n * henyey_greenstein(n * g, cosine);
                one(albedo * (x[1][0] * octave(0.5) + x[1][1] * octave(0.25)))
            },
        )
        .over("all", |random| {
            let [a, b] = [(); 2].map(|()| random.log(1e-6, 1.0));
            input([[random.asymmetry(), random.between(0.0, 1.0), random.cosine(), 0.0], [a, b, 0.0, 0.0]])
        }),
        Twin::new(
            "powder_light",
            "powder",
            "return vec4f(powder_light(Species(0.4, 0.7, x[0].x, 1.0, vec4f(1.0), 0.0, 0.0, vec2f(0.0)), x[0].y, x[0].z));",
            |x| {
                let [albedo, gathered, cosine, _] = x[0];
                one(albedo * gathered * henyey_greenstein(0.2, cosine))
            },
        )
        .over("all", |random| {
            scalars([random.between(0.0, 1.0), random.log(1e-6, 1.0), random.cosine()])
        }),
    ]
}

/// A piece: optical depth, what is seen, sums so far; optical depths to the sun and in shadow.
const PIECE: &str = "
    fn piece(x: array<vec4f, 8>) -> LitPiece { return LitPiece(9.0, x[1].xy, x[1].zw, x[0].x, x[0].y, 0.3); }
    fn seen(x: array<vec4f, 8>) -> RaySeen { return RaySeen(x[2].x, x[2].y, x[2].z, 1.0, 0.0); }
    fn phases(x: array<vec4f, 8>) -> SunPhase { return SunPhase(x[3].xyz, x[4].xyz); }";

fn piece(random: &mut Random) -> Input {
    let sums = [(); 2].map(|()| random.between(0.0, 1.0));
    let [before, after] = [(); 2].map(|()| random.log(1e-6, 1e3));
    let depths = [before, before * random.between(0.0, 1.0), after, after * random.between(0.0, 1.0)];
    let truncated = random.between(0.0, 0.95);
    let opacity = random.log(1e-3, 1.0);
    input([
        [random.log(1e-6, 1e2), random.between(0.0, 1.0), sums[0], sums[1] * opacity],
        depths,
        [opacity, random.log(1e-6, 1e4), random.between(1.0, 1.1), truncated],
        light(random, 0.0),
        light(random, 0.0),
    ])
}

fn sunlight() -> Vec<Twin> {
    vec![
        Twin::new(
            "sun_piece",
            "sun_sum",
            "let s = sun_piece(SunSum(x[0].z, x[0].w), piece(x)); return vec4f(s.single, s.lit, 0.0, 0.0);",
            |x| {
                let ([depth, seen, single, lit], [before, shade, after, shade_after]) = (x[0], x[1]);
                two(
                    single + seen * sunlight_share(depth, before, after),
                    lit + seen * mean_transmittance(shade, shade_after),
                )
            },
        )
        .declaring(PIECE)
        .over("all", piece),
        Twin::new(
            "sun_scattered",
            "sun_sum",
            "return vec4f(sun_scattered(SunSum(x[0].z, x[0].w), phases(x), seen(x)), 0.0);",
            |x| three(x[0][2] * x[2][2] * xyz(x[3])),
        )
        .declaring(PIECE)
        .over("all", piece),
        Twin::new(
            "sun_recovered",
            "sun_sum",
            "return vec4f(sun_recovered(SunSum(x[0].z, x[0].w), phases(x), x[2].w, seen(x)), 0.0);",
            |x| {
                // What is lit straight, of what is seen, gives what the peak alone has scattered.
                let ([opacity, depth, share, f], lit) = (x[2], x[0][3]);
                let straight = (lit * share / opacity).clamp(0.0, 1.0).powf(1.0 / (1.0 - f));
                three(straight * (-(1.0 - f) * depth).exp() * -(-f * depth).exp_m1() * xyz(x[4]))
            },
        )
        .declaring(PIECE)
        .over("all", piece),
    ]
}

/// A cone of 20 degrees in eight rings of equal solid angle.
fn ring() -> f64 {
    (1.0 - f64::from(0.349_065_85_f32).cos()) / 8.0
}

fn forward() -> Vec<Twin> {
    vec![
        Twin::new("forward_ring", "forward_cone", "return vec4f(forward_ring());", |_| one(2.0 * PI * ring()))
            .edges(grid(&[0.0], &[0.0], &[0.0], &[0.0])),
        Twin::new("forward_direction", "forward_cone", "return vec4f(forward_direction(u32(x[0].x)), 0.0);", |x| {
            let less = (x[0][0] + 0.5) * ring();
            [1.0 - less, (less * (2.0 - less)).sqrt(), 0.0, f64::NAN]
        })
        .edges(plane(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], &[0.0]))
        // Parts of a unit vector.
        .beside(1.0),
        Twin::new(
            "forward_piece",
            "forward_cone",
            "let p = forward_piece(piece(x), x[2].w); return vec4f(p.before, p.after + 0.0 * x[2].w);",
            |x| {
                let [before, shade, after, shade_after] = x[1];
                let on = x[2][3];
                [before - on * before, shade, after - on * after, shade_after]
            },
        )
        .declaring("fn piece(x: array<vec4f, 8>) -> LitPiece { return LitPiece(9.0, x[1].xy, x[1].zw, 1.0, 0.5, 0.3); }")
        .over("all", piece),
    ]
}

fn conductance(g: f64, depth: f64) -> f64 {
    3.0 / (2.0 + 3.0 * (1.0 - g) * depth)
}

/// Conductances up, aside and down, and an asymmetry.
fn conductances(random: &mut Random) -> Input {
    let g = random.asymmetry();
    let ways = [1.0, 4.0, 1.0].map(|n| n * conductance(g, random.log(1e-3, 1e3)));
    input([vector(ways.into(), g), [1.0 - random.log(1e-6, 1.0), 0.0, 0.0, 0.0]])
}

fn diffuse() -> Vec<Twin> {
    vec![
        Twin::new(
            "diffuse_conductances",
            "eddington",
            "return vec4f(diffuse_conductances(x[0].w, x[0].xyz), 0.0);",
            |x| {
                // Up, down and one of four sides.
                let [up, down, side, g] = x[0];
                three(DVec3::new(conductance(g, up), 4.0 * conductance(g, side), conductance(g, down)))
            },
        )
        .edges(grid(&[0.0, 5.0], &[0.0, 1.0], &[0.0, 30.0], &[-0.5, 0.73]))
        .over("all", |random| {
            let depths = [(); 3].map(|()| random.log(1e-6, 1e6));
            scalars([depths[0], depths[1], depths[2], random.asymmetry()])
        }),
        Twin::new("diffuse_shares", "eddington", "return vec4f(diffuse_shares(x[0].xyz), 0.0);", |x| {
            let c = xyz(x[0]);
            // Of three conductors into one point.
            three(DVec3::from([0, 1, 2].map(|i| 1.0 / (1.0 + (c[(i + 1) % 3] + c[(i + 2) % 3]) / c[i]))))
        })
        .over("all", conductances),
        Twin::new(
            "diffuse_absorbed",
            "eddington",
            "return vec4f(diffuse_absorbed(x[1].x, x[0].w, x[0].xyz));",
            |x| {
                let ([up, _, down, g], albedo) = (x[0], x[1][0]);
                let depth = (1.0 / up.max(down) - 2.0 / 3.0).max(0.0) / (1.0 - g);
                one((-(3.0 * (1.0 - albedo) * (1.0 - albedo * g)).sqrt() * depth).exp())
            },
        )
        .over("all", conductances),
        Twin::new("transport_length", "eddington", "return vec4f(transport_length(x[0].x, x[0].y));", |x| {
            one(x[0][1] / (1.0 - x[0][0]))
        })
        .edges(plane(&[-0.5, 0.0, 0.73], &[0.0, 11.0]))
        .over("all", |random| scalars([random.asymmetry(), random.log(1e-3, 1e4)])),
    ]
}

/// A slab by its normal and the cosine of the sun to it, thickness, and a depth in it; then conductances
/// and an asymmetry; a ray; the sun.
const FIT: &str = "fn fit(x: array<vec4f, 8>) -> SlabFit {
    return SlabFit(x[0].xyz, x[0].w, x[1].x, vec3f(1.0, 2.0, 3.0), 40.0, 0.9, 2u);
}";

fn fitted(random: &mut Random) -> Input {
    let thickness = random.log(1e-3, 1e3);
    let mut x = conductances(random);
    x[2] = x[0];
    let (normal, mu0) = (random.direction(), random.between(0.2, 1.0));
    let sun = random.direction_off(normal, mu0.acos());
    let depth = thickness * random.between(0.0, 1.0);
    let rest =
        input([vector(normal, mu0), [thickness, depth, random.between(0.1, 3.0), random.index(SETS) as f64]]);
    (x[0], x[1]) = (rest[0], rest[1]);
    let rays = input([vector(random.direction(), 0.0), vector(sun, 0.0)]);
    (x[3], x[4]) = (rays[0], rays[1]);
    x
}

/// Of six ways out of a cloud, those along the normal are the slab's faces.
fn non_leakage(x: &Wide) -> f64 {
    let ([thickness, depth, ..], mu0, g) = (x[1], x[0][3], x[2][3]);
    let faces = conductance(g, mu0 * depth) + conductance(g, mu0 * (thickness - depth));
    let [up, around, down, _] = x[2];
    // Each of four sides has a quarter of what is around: two of them lie along a level normal.
    let upright = x[0][1] * x[0][1];
    let sides = upright * around + (1.0 - upright) * (up + down + 0.5 * around);
    1.0 / (1.0 + 0.3 * sides / faces)
}

/// Towards the sun as it was; away from it turned across, and the less the farther away.
fn sunward(x: &Wide) -> Output {
    let (around, sun) = (xyz(x[0]), xyz(x[1]));
    let along = around.dot(sun);
    three(if along < 0.0 { (1.0 + along) * (around - along * sun) } else { around })
}

fn slabs() -> Vec<Twin> {
    vec![
        Twin::new(
            "facing_sunward",
            "slab_light",
            "return vec4f(facing_sunward(x[0].xyz, x[1].xyz), 0.0);",
            sunward,
        )
        .over("all", |random| {
            let sun = random.direction();
            let angle = random.cosine().acos();
            let around = random.log(1e-3, 1.0) * random.direction_off(sun, angle);
            input([vector(around, 0.0), vector(sun, 0.0)])
        })
        // Parts of unit vectors.
        .beside(1.0),
        Twin::new(
            "slab_fit_holding",
            "slab_light",
            "let f = slab_fit_holding(fit(x), x[1].y * x[1].z);
             return vec4f(f.thickness, f.mu0, f.middle.y, f.length);",
            |x| [x[1][0].max(x[1][1] * x[1][2]), x[0][3], 2.0, 40.0],
        )
        .declaring(FIT)
        .over("all", fitted),
        Twin::new(
            "non_leakage",
            "slab_light",
            "return vec4f(non_leakage(x[2].w, fit(x), x[1].y, x[2].xyz));",
            |x| one(non_leakage(x)),
        )
        .declaring(FIT)
        .over("all", fitted),
        Twin::new(
            "shadowed_source",
            "slab_light",
            "return vec4f(shadowed_source(Species(0.4, x[0].x, 1.0, 1.0, vec4f(1.0), 0.0, 0.0, vec2f(0.0)), x[0].y, x[0].z));",
            |x| {
                // Of a forward phase function g^2 goes straight on.
                let [g, source, shadow, _] = x[0];
                let on = if g > 0.0 { g.powi(2) } else { 0.0 };
                one(source * (-(1.0 - on) * shadow).exp())
            },
        )
        .edges(grid(&[-0.5, 0.0, 0.73], &[0.0, 2.0], &[0.0, 1.0, 80.0], &[0.0]))
        .over("all", |random| scalars([random.asymmetry(), random.log(1e-6, 10.0), random.log(1e-6, 1e3)])),
        Twin::new(
            "slab_set_spread",
            "slab_light",
            "return vec4f(slab_set_spread(u32(x[1].w), x[1].z, x[1].x, x[1].y));",
            |x| {
                let [thickness, depth, similarity, set] = x[1];
                one(spread::spread(set as usize, similarity * thickness, similarity * depth) / similarity)
            },
        )
        .over("all", fitted),
        Twin::new(
            "slab_wandered",
            "slab_light",
            "return vec4f(slab_wandered(x[0].x, x[0].y, x[0].z));",
            |x| {
                // No deeper than the middle, and no less deep than it is.
                let [depth, spread, thickness, _] = x[0];
                one((depth + spread / 2.0).clamp(depth, f64::max(depth, thickness / 2.0)))
            },
        )
        .edges(grid(&[0.0, 1.0, 9.0], &[0.0, 0.5, 40.0], &[1.0, 10.0], &[0.0]))
        .over("all", |random| scalars([(); 3].map(|()| random.log(1e-3, 1e3)))),
        Twin::new(
            "slab_products",
            "slab_light",
            "return vec4f(slab_products(fit(x), x[3].xyz, x[4].xyz), 0.0, 0.0);",
            |x| {
                let [normal, direction, sun] = [0, 3, 4].map(|i| xyz(x[i]));
                let mu = normal.dot(direction);
                two(mu, direction.dot(sun) - mu * x[0][3])
            },
        )
        .declaring(FIT)
        .over("all", fitted),
        Twin::new(
            "slab_eddington",
            "slab_light",
            "return vec4f(slab_eddington(x[2].w, fit(x), x[1].y, x[3].xyz));",
            |x| {
                let ([thickness, depth, ..], mu0) = (x[1], x[0][3]);
                one(eddington(x[2][3], mu0, mu0 * depth, mu0 * thickness, xyz(x[0]).dot(xyz(x[3]))))
            },
        )
        .declaring(FIT)
        .over("all", fitted)
        // What is scattered once is 1 / (4 pi) in the mean.
        .beside(0.25 / PI),
        Twin::new(
            "slab_surface_light",
            "slab_light",
            "return vec4f(slab_surface_light(x[0].x, x[0].y, x[0].z));",
            |x| one(x[0][0] * x[0][2] / x[0][1].exp()),
        )
        .edges(grid(&[0.0, 0.9], &[0.0, 1.0, 80.0], &[0.0, 0.3], &[0.0]))
        .over("all", |random| {
            scalars([random.between(0.0, 1.0), random.log(1e-6, 1e2), random.log(1e-6, 10.0)])
        }),
    ]
}
