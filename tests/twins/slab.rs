//! Coordinates of the tables of slabs, and what all models of slabs know.
//!
//! A view is packed as thickness, depth, mu, mu0 in x[0], cosine and sine of the azimuth and the
//! set of orders in x[1].

use nephos::optics::slab::{SETS, axes, direct, spread};

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, scalars, two, vector, xyz};

const FIT: &str = "fn fit(x: array<vec4f, 8>) -> SlabFit {
    let box = LightBox(x[0].xyz, 1.0, vec3f(0.0), x[6].w, vec3f(0.0), 0.0, vec3f(0.0), 0.0, x[6].xyz, 0.0,
        x[7].xyz, 0.0, x[5].xyz, 0.0);
    return slab_fit_of(box, x[2].xy, x[1], x[3].xyz, x[4].xyz, 1u);
}";

const VIEW: &str = "fn view(x: array<vec4f, 8>) -> SlabView {
    return SlabView(x[0].x, x[0].y, x[0].z, x[0].w, x[1].x, x[1].y);
}";

fn view(random: &mut Random) -> Input {
    let thickness = random.log(1e-4, 1e6);
    let depth = thickness * [0.0, 1.0, random.between(0.0, 1.0), random.log(1e-6, 1.0)][random.index(4)];
    let (sine, cosine) = random.between(0.0, std::f64::consts::TAU).sin_cos();
    let set = random.index(SETS) as f64;
    input([[thickness, depth, random.cosine(), random.cosine()], [cosine, sine, set, 0.0]])
}

/// Light that goes nearly straight on.
fn forward(random: &mut Random) -> Input {
    let mu0 = random.between(-1.0, 1.0);
    let mu = (mu0 + random.sign() * random.log(1e-6, 0.01)).clamp(-1.0, 1.0);
    let (sine, cosine) = random.log(1e-6, 0.01).sin_cos();
    input([[1.0, 0.5, mu, mu0], [cosine, sine, 0.0, 0.0]])
}

/// Within an optical depth of 0.1 from the face behind the point.
fn thin(random: &mut Random) -> Input {
    let mut x = view(random);
    let (behind, mu) = (random.log(1e-6, 0.1), random.cosine());
    let thickness = behind * random.between(1.0, 10.0);
    let depth = if mu > 0.0 { behind } else { thickness - behind };
    x[0] = [thickness as f32, depth as f32, mu as f32, x[0][3]];
    x
}

fn opacity(x: &Wide) -> f64 {
    let [thickness, depth, mu, _] = x[0];
    let behind = if mu > 0.0 { depth } else { thickness - depth };
    // Directions along the slab are held off it.
    -(-behind.max(0.0) / mu.abs().max(1e-6)).exp_m1()
}

/// The angle between directions given by cosines and azimuth, without their product's cancellation.
fn half_sine(x: &Wide) -> f64 {
    let ([_, _, mu, mu0], cosine) = (x[0], x[1][0]);
    let across = ((1.0 - mu) * (1.0 + mu) * (1.0 - mu0) * (1.0 + mu0)).max(0.0).sqrt();
    (0.5 - 0.5 * (mu * mu0 + across * cosine)).clamp(0.0, 1.0).sqrt()
}

fn sunward(x: &Wide) -> Output {
    let [thickness, depth, mu, mu0] = x[0];
    if mu0 >= 0.0 { x[0] } else { [thickness, thickness - depth, -mu, -mu0] }
}

/// Normal, eye and sun: cosines, and the azimuth between the parts across the normal.
fn slab_view(x: &Wide) -> Output {
    let [normal, eye, sun] = [0, 1, 2].map(|i| xyz(x[i]));
    let sine = normal.cross(sun).dot(eye);
    let cosine = normal.cross(sun).dot(normal.cross(eye));
    let across = sine.hypot(cosine);
    // Light flies away from the sun and towards the eye.
    [-normal.dot(eye), normal.dot(sun), -cosine / across, sine / across]
}

/// Maps, lit normal, turn, and where the light flies; one lump in two nearly faces the sun.
fn maps(random: &mut Random) -> Input {
    let along = random.direction();
    let coverage = random.log(1e-3, 1.0);
    let angle = [random.between(0.0, 3.1), random.log(1e-4, 0.1)][random.index(2)];
    let lit = coverage * random.direction_off(-along, angle);
    let turn = random.log(1e-4, 1.0) * random.direction_off(-along, angle);
    let depths = [random.between(0.0, 1.0), 1.0, random.log(1e-3, 1e3)].map(|x| coverage * x);
    input([
        [0.0; 4],
        [depths[0], depths[1], depths[2], coverage],
        [0.5, 0.5, 0.0, 0.0],
        vector(lit, 0.0),
        vector(turn, 0.0),
        vector(along, 0.0),
        [1e3, 0.0, 0.0, 1e3],
        [0.0, 1e3, 0.0, 0.0],
    ])
}

/// The mean normal, tilted towards the sun where it faces farther from it than a cosine of 0.2.
fn fitted(x: &Wide) -> Output {
    let to_sun = -xyz(x[5]);
    let mean = (xyz(x[3]) / x[1][3] + xyz(x[4]) + f64::from(1e-3f32) * to_sun).normalize();
    let across = (mean - mean.dot(to_sun) * to_sun).normalize();
    let least = f64::from(0.2f32);
    let tilted = mean.dot(to_sun) < least;
    let normal = if tilted { least * to_sun + (1.0 - least * least).sqrt() * across } else { mean };
    vector(normal, normal.dot(to_sun))
}

/// A point some way below or above a lit face, and the slab as thick as the cloud is long along the light.
fn below_face(random: &mut Random) -> Input {
    let (normal, mu0) = (random.direction(), random.between(0.2, 1.0));
    let sun = random.direction_off(normal, mu0.acos());
    let middle = random.log(1.0, 1e4) * random.direction();
    let length = random.log(1.0, 1e4);
    let across = random.direction_off(normal, std::f64::consts::FRAC_PI_2);
    let p = middle - length * (random.between(-0.5, 2.0) * normal + random.between(0.0, 1.0) * across);
    input([
        vector(normal, mu0),
        vector(middle, length),
        vector(p, random.log(1.0, 100.0)),
        vector(random.direction(), 0.0),
        vector(sun, 0.0),
    ])
}

/// Depths in mean free paths: no less than a tenth of the thickness from either face.
fn fit_view(x: &Wide) -> Output {
    let [normal, middle, p, eye, sun] = [0, 1, 2, 3, 4].map(|i| xyz(x[i]));
    let free = x[2][3];
    let depth = (middle - p).dot(normal) / free;
    let thickness = (x[0][3] * x[1][3] / free).max(depth * 10.0 / 9.0);
    [thickness, depth.max(thickness / 10.0), -normal.dot(eye), normal.dot(sun)]
}

pub fn twins() -> Vec<Twin> {
    let mut all = views();
    all.extend(coordinates());
    all
}

fn views() -> Vec<Twin> {
    vec![
        Twin::new(
            "slab_view",
            "slab_view",
            "let v = slab_view(5.0, 2.0, x[0].xyz, x[1].xyz, x[2].xyz); return vec4f(v.mu, v.mu0, v.cos_phi, v.sin_phi);",
            slab_view,
        )
        .over("all", |random| {
            let normal = random.direction();
            let [a, b] = [(); 2].map(|()| random.cosine().acos());
            let (eye, sun) = (random.direction_off(normal, a), random.direction_off(normal, b));
            input([vector(normal, 0.0), vector(eye, 0.0), vector(sun, 0.0)])
        }),
        Twin::new(
            "slab_sunward",
            "slab_view",
            "let v = slab_sunward(view(x)); return vec4f(v.thickness, v.depth, v.mu, v.mu0);",
            sunward,
        )
        .declaring(VIEW)
        .over("all", view),
        Twin::new("slab_half_sine", "slab_view", "return vec4f(slab_half_sine(view(x)));", |x| one(half_sine(x)))
            .declaring(VIEW)
            .over("all", view)
            .over("forward", forward),
        Twin::new("slab_opacity", "slab_view", "return vec4f(slab_opacity(view(x)));", |x| one(opacity(x)))
            .declaring(VIEW)
            .over("all", view)
            .over("thin", thin),
        Twin::new("slab_view_coordinate", "slab_view", "return vec4f(slab_view_coordinate(x[0].x));", |x| {
            one(0.5 + 0.5 * x[0][0].signum() * x[0][0].abs().min(1.0).powf(2.0 / 3.0))
        })
        .edges(line(&[-1.0, -0.5, 0.5, 1.0]))
        .over("all", |random| scalars([random.cosine()])),
    ]
}

fn coordinates() -> Vec<Twin> {
    vec![
        Twin::new("slab_fit_of", "slab_fit", "let f = fit(x); return vec4f(f.normal, f.mu0);", fitted)
            .declaring(FIT)
            .over("all", maps),
        Twin::new(
            "slab_fit_view",
            "slab_fit",
            "let fit = SlabFit(x[0].xyz, x[0].w, 7.0, x[1].xyz, x[1].w, 1.0, 2u);
             let v = slab_fit_view(fit, x[2].xyz, x[3].xyz, x[4].xyz, x[2].w);
             return vec4f(v.thickness, v.depth, v.mu, v.mu0);",
            fit_view,
        )
        .over("all", below_face),
        Twin::new(
            "slab_thickness_coordinate",
            "slab",
            "return vec4f(slab_thickness_coordinate(x[0].x));",
            |x| one(axes::thickness_coordinate(x[0][0]).clamp(0.0, 1.0)),
        )
        .over("all", |random| scalars([random.log(0.01, 1e6)])),
        Twin::new(
            "slab_depth_coordinate",
            "slab",
            "return vec4f(slab_depth_coordinate(x[0].y, x[0].x));",
            |x| one(axes::depth_coordinate(x[0][1], x[0][0])),
        )
        .over("all", view),
        Twin::new("slab_sun_coordinate", "slab", "return vec4f(slab_sun_coordinate(x[0].x));", |x| {
            one(axes::sun_coordinate(x[0][0]))
        })
        .over("all", |random| scalars([random.cosine().abs()])),
        Twin::new("slab_path_coordinate", "slab", "return vec4f(slab_path_coordinate(x[0].x));", |x| {
            one(axes::path_coordinate(x[0][0]))
        })
        .edges(line(&[0.0, 1e-3, 4.0, 300.0]))
        .over("all", |random| scalars([random.log(1e-6, 1e6)])),
        Twin::new("slab_spread", "slab", "return vec4f(slab_spread(u32(x[1].z), x[0].x, x[0].y));", |x| {
            one(spread::spread(x[1][2] as usize, x[0][0], x[0][1]))
        })
        .over("all", view),
        Twin::new(
            "slab_ln_known",
            "slab_direct",
            "return vec4f(slab_ln_known(u32(x[1].z), x[0].x, x[0].y));",
            |x| two(direct::ln_known(x[1][2] as usize, x[0][0], x[0][1]), f64::NAN),
        )
        .over("all", view),
        Twin::new("slab_ln_1p", "slab", "return vec4f(slab_ln_1p(x[0].x));", |x| one(x[0][0].ln_1p()))
            .edges(grid(&[0.0, 1e-6, 1e-3, 1.0], &[0.0], &[0.0], &[0.0]))
            .over("all", |random| scalars([random.log(1e-6, 1e6)])),
    ]
}
