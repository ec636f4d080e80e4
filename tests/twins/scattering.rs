//! Phase functions, transmittances, octaves and the Eddington solution.

use std::f64::consts::PI;

use crate::definitions::{eddington, henyey_greenstein, mean_transmittance, sunlight_share};
use crate::harness::{Input, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, plane, scalars, two, vector, xyz};

/// Two directions at angles from 0 to 180 degrees, near both ends, too.
fn directions(random: &mut Random, angle: f64) -> Input {
    let before = random.direction();
    let after = random.direction_off(before, angle);
    input([vector(before, 0.0), vector(after, 0.0)])
}

fn turned(angles: &[f64]) -> Vec<Input> {
    let mut random = Random::new("turned");
    angles.iter().map(|angle| directions(&mut random, *angle)).collect()
}

/// The texels are even in the root of the angle, mirrored in the middle.
fn phase_coordinate(x: &Wide) -> f64 {
    let (a, b) = (xyz(x[0]), xyz(x[1]));
    let angle = a.cross(b).length().atan2(a.dot(b));
    let back = a.cross(b).length().atan2(-a.dot(b));
    if angle < back { (0.5 * angle / PI).sqrt() } else { 1.0 - (0.5 * back / PI).sqrt() }
}

fn octave_transmittances(x: &Wide) -> [f64; 4] {
    let octave = |n: f64| sunlight_share(x[0][0], n * x[0][1], n * x[0][2]);
    two(octave(0.5), octave(0.25))
}

/// Twice Beer's law times 1 - e^{-2 t}: light that would fall off three times as fast is taken off.
fn powder_share(x: &Wide) -> f64 {
    let [depth, before, after, _] = x[0];
    2.0 * (sunlight_share(depth, before, after) - sunlight_share(depth, 3.0 * before, 3.0 * after))
}

/// Optical depth of a stretch, that to the sun before it, and behind it.
fn stretch(random: &mut Random) -> Input {
    let depth = random.log(1e-6, 1e6);
    let before = random.log(1e-6, 1e6);
    let after = random.log(1e-6, 1e6);
    scalars([depth, before, after])
}

/// Where the sun's light falls off over the stretch about as much as it dims.
fn alike(random: &mut Random) -> Input {
    let depth = random.log(1e-6, 3.0);
    let after = random.log(1e-3, 30.0);
    let before = (depth + after) * (1.0 + random.sign() * random.log(1e-6, 1.0));
    scalars([depth, before, after])
}

fn slab(random: &mut Random, thickness: f64) -> Input {
    let sun = random.between(0.2, 1.0);
    let share = [0.0, 1.0, random.between(0.0, 1.0)][random.index(3)];
    input([[random.asymmetry(), sun, share * thickness, thickness], [random.cosine(), 0.0, 0.0, 0.0]])
}

/// Asymmetry, sun cosine, depth and thickness of slabs; depths up to the far face.
fn slabs() -> Vec<Input> {
    let mut all = grid(&[-0.6, 0.0, 0.73, 0.9], &[0.2, 0.7, 1.0], &[0.0, 0.5, 5.0, 30.0], &[0.5, 5.0, 30.0]);
    all.retain(|x| x[0][2] <= x[0][3]);
    all.iter_mut().for_each(|x| x[1][0] = 0.6);
    all
}

pub fn twins() -> Vec<Twin> {
    let mut all = phases();
    all.extend(species());
    all.extend(transmittances());
    all.extend(diffusion());
    all
}

/// A species whose truncated share and albedo are told, as 1 less what is told where that is small.
const SPECIES: &str = "fn make(x: array<vec4f, 8>) -> Species {
    return Species(x[0].x, 0.7, x[0].y, 1.0, vec4f(1.0), 0.0, 0.0, vec2f(0.0));
}";

fn species() -> Vec<Twin> {
    vec![
        Twin::new("transported", "species", "return vec4f(transported(make(x)));", |x| one(1.0 - x[0][0]))
            .declaring(SPECIES)
            .over("all", |random| scalars([random.between(0.0, 0.99), 1.0])),
        Twin::new("whole_albedo", "species", "return vec4f(whole_albedo(make(x)));", |x| {
            one(1.0 - (1.0 - x[0][0]) * (1.0 - x[0][1]))
        })
        .declaring(SPECIES)
        .over("all", |random| scalars([random.between(0.0, 0.99), random.between(0.0, 1.0)])),
    ]
}

fn phases() -> Vec<Twin> {
    vec![
        Twin::new("phase_coordinate", "phase", "return vec4f(phase_coordinate(x[0].xyz, x[1].xyz));", |x| {
            one(phase_coordinate(x))
        })
        .edges(turned(&[0.0, 1e-3, 0.01, 0.1, 0.5, 1.0, 1.55, 1.6, 2.5, 3.1, 3.135, PI]))
        .over("all", |random| {
            let angle = random.between(0.0, PI);
            directions(random, angle)
        })
        .over("forward", |random| {
            let angle = random.log(1e-6, 0.1);
            directions(random, angle)
        })
        .over("backward", |random| {
            let angle = PI - random.log(1e-6, 0.1);
            directions(random, angle)
        }),
        Twin::new("asin_small", "phase", "return vec4f(asin_small(x[0].x));", |x| one(x[0][0].asin()))
            .edges(line(&[0.0, 1e-4, 0.1, 0.3, 0.6, 0.707]))
            .over("all", |random| scalars([random.log(1e-6, 0.707)])),
        Twin::new("octave_phase", "octave", "return vec4f(octave_phase(x[0].x, x[0].y));", |x| {
            one(henyey_greenstein(x[0][0], x[0][1]))
        })
        .edges(plane(&[-0.5, 0.0, 0.3, 0.73], &[-1.0, -0.2, 0.0, 0.9, 1.0]))
        .over("all", |random| scalars([random.asymmetry(), random.cosine()]))
        .over("peaks", |random| {
            let (side, g) = (random.sign(), random.between(0.9, 0.99));
            scalars([side * g, side * (1.0 - random.log(1e-6, 0.01))])
        }),
        Twin::new("octave_phases", "octave", "return vec4f(octave_phases(x[0].x, x[0].y), 0.0, 0.0);", |x| {
            let octave = |n: f64| n * henyey_greenstein(n * x[0][0], x[0][1]);
            two(octave(0.5), octave(0.25))
        })
        .edges(plane(&[-0.5, 0.0, 0.73], &[-1.0, 0.0, 0.9, 1.0]))
        .over("all", |random| scalars([random.asymmetry(), random.cosine()])),
    ]
}

fn transmittances() -> Vec<Twin> {
    vec![
        Twin::new("mean_through", "attenuation", "return vec4f(mean_through(x[0].x));", |x| {
            one(mean_transmittance(0.0, x[0][0]))
        })
        .edges(line(&[0.0, 1e-6, 0.69, 0.7, 0.71, 1e9]))
        .over("all", |random| scalars([random.log(1e-6, 1e6)])),
        Twin::new(
            "mean_transmittance",
            "attenuation",
            "return vec4f(mean_transmittance(x[0].x, x[0].y));",
            |x| one(mean_transmittance(x[0][0], x[0][1])),
        )
        .edges(plane(&[0.0, 0.3, 9.0], &[0.0, 0.05, 0.3, 0.39, 9.11, 30.0]))
        .over("all", |random| scalars([random.log(1e-6, 1e6), random.log(1e-6, 1e6)]))
        .over("alike", |random| {
            let a = random.log(1e-3, 30.0);
            scalars([a, a * (1.0 + random.sign() * random.log(1e-6, 0.9))])
        }),
        Twin::new("sunlight_share", "phase", "return vec4f(sunlight_share(x[0].x, x[0].y, x[0].z));", |x| {
            one(sunlight_share(x[0][0], x[0][1], x[0][2]))
        })
        .edges(grid(&[0.0, 1e-3, 0.3, 5.0], &[0.0, 0.3, 9.0], &[0.0, 0.31, 4.0, 9.0], &[0.0]))
        .over("all", stretch)
        .over("alike", alike),
        Twin::new(
            "octave_transmittances",
            "octave",
            "return vec4f(octave_transmittances(x[0].x, x[0].y, x[0].z), 0.0, 0.0);",
            octave_transmittances,
        )
        .edges(grid(&[0.0, 0.1, 3.0], &[0.0, 0.3, 9.0], &[0.0, 0.31, 7.0], &[0.0]))
        .over("all", stretch)
        .over("alike", alike),
        // Beside what Beer's law alone lets through, of which little is left near the surface.
        Twin::new("powder_share", "powder", "return vec4f(powder_share(x[0].x, x[0].y, x[0].z));", |x| {
            one(powder_share(x))
        })
        .edges(grid(&[0.0, 0.1, 3.0], &[0.0, 0.3, 9.0], &[0.0, 0.31, 7.0], &[0.0]))
        .beside(1.0)
        .over("all", stretch)
        .beside(1.0)
        .over("alike", alike)
        .beside(1.0),
        Twin::new("phase_row", "phase", "return vec4f(phase_row() + 0.0 * x[0].x);", |_| one(0.5 / 7.0))
            .edges(plane(&[0.0], &[0.0])),
        Twin::new("peak_row", "phase", "return vec4f(peak_row(x[0].x));", |x| {
            // The middles of six rows after the first of seven, at 0 to 1 by fifths of m / (m + 2).
            let share = 1.0 - 2.0 / (x[0][0] + 2.0);
            one((1.0 + 0.5 + 5.0 * share) / 7.0)
        })
        .edges(plane(&[0.0, 0.5, 2.0, 8.0, 1e4], &[0.0]))
        .over("all", |random| scalars([random.log(1e-6, 1e5)])),
        Twin::new("recovered_peak", "phase", "return vec4f(recovered_peak(x[0].x, x[0].y));", |x| {
            let [tau, chop, ..] = x[0];
            // Light that the peak scattered at depth s and nothing else touched, added up over orders:
            // e^{-(1-f) tau} (1 - e^{-f tau}).
            one((-(1.0 - chop) * tau).exp() * -(-chop * tau).exp_m1())
        })
        .edges(plane(&[0.0, 1e-3, 0.5, 3.0, 40.0, 1e4], &[0.0, 0.45, 0.9]))
        .over("thin", |random| scalars([random.log(1e-6, 0.1), random.between(0.0, 0.95)]))
        .over("thick", |random| scalars([random.log(0.1, 1e6), random.between(0.0, 0.95)])),
    ]
}

fn diffusion() -> Vec<Twin> {
    vec![
        Twin::new(
            "eddington_beam",
            "eddington",
            "return vec4f(eddington_beam(x[0].x, x[0].y, x[0].z, x[0].w, x[1].x));",
            |x| one(eddington(x[0][0], x[0][1], x[0][2], x[0][3], x[1][0])),
        )
        .edges(slabs())
        .over("thin", |random| {
            let thickness = random.log(1e-6, 0.1);
            slab(random, thickness)
        })
        // What is scattered once is 1 / (4 pi) in the mean.
        .beside(0.25 / PI)
        .over("thick", |random| {
            let thickness = random.log(0.1, 1e3);
            slab(random, thickness)
        })
        .beside(0.25 / PI)
        .over("thickest", |random| {
            let thickness = random.log(1e3, 1e6);
            slab(random, thickness)
        }),
        Twin::new(
            "diffuse_conductance",
            "eddington",
            "return vec4f(diffuse_conductance(x[0].x, x[0].y));",
            |x| one(3.0 / (2.0 + 3.0 * (1.0 - x[0][0]) * x[0][1])),
        )
        .edges(plane(&[0.0, 0.73], &[0.0, 1.0, 50.0]))
        .over("all", |random| scalars([random.asymmetry(), random.log(1e-6, 1e6)])),
        Twin::new("side_loss", "eddington", "return vec4f(side_loss(x[0].x, x[0].y));", |x| {
            // Two faces alone are a slab.
            one(1.0 / (1.0 + 0.3 * x[0][1].max(0.0) / x[0][0]))
        })
        .edges(plane(&[0.1, 1.0, 3.0], &[-0.5, 0.0, 0.2, 6.0]))
        .over("all", |random| scalars([random.log(1e-6, 3.0), random.log(1e-6, 6.0)])),
        Twin::new("diffuse_depth", "eddington", "return vec4f(diffuse_depth(x[0].x, x[0].y));", |x| {
            one((1.0 / x[0][1] - 2.0 / 3.0).max(0.0) / (1.0 - x[0][0]))
        })
        .edges(plane(&[0.0, 0.73, 0.9], &[1.5, 0.9, 0.1]))
        .over("all", |random| scalars([random.asymmetry(), random.log(1e-6, 1.5)])),
        Twin::new("absorbed", "eddington", "return vec4f(absorbed(x[0].x, x[0].y, x[0].z));", |x| {
            let [albedo, g, tau, _] = x[0];
            one((-(3.0 * (1.0 - albedo) * (1.0 - albedo * g)).sqrt() * tau).exp())
        })
        .edges(grid(&[1.0, 0.99, 0.5, 0.0], &[0.0, 0.73], &[0.0, 1.0, 20.0], &[0.0]))
        .over("all", |random| {
            scalars([1.0 - random.log(1e-6, 1.0), random.asymmetry(), random.log(1e-6, 1e6)])
        }),
    ]
}
