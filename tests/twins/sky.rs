//! Coordinates of the sky's tables.

use std::f64::consts::PI;

use glam::DVec3;

use crate::air::{EARTH, GROUND, THICKNESS, distance_to_top, horizon_mu, horizon_square, inside};
use crate::harness::{Output, Random, Twin, Wide};
use crate::pack::{input, one, plane, scalars, three, two, vector, xyz};

/// Texel centres at both ends of 256 by 64 texels.
fn texel(x: f64, size: f64) -> f64 {
    (0.5 + x * (size - 1.0)) / size
}

fn unit(u: f64, size: f64) -> f64 {
    ((u * size - 0.5) / (size - 1.0)).clamp(0.0, 1.0)
}

fn transmittance_uv(x: &Wide) -> Output {
    let [h, mu, ..] = x[0];
    let (rho, whole) = (horizon_square(h).sqrt(), horizon_square(THICKNESS).sqrt());
    let (near, far) = (THICKNESS - h, rho + whole);
    two(
        texel(((distance_to_top(h, mu) - near) / (far - near)).clamp(0.0, 1.0), 256.0),
        texel(rho / whole, 64.0),
    )
}

fn transmittance_point(x: &Wide) -> Output {
    let whole = horizon_square(THICKNESS).sqrt();
    let rho = whole * unit(x[0][1], 64.0);
    let r = (GROUND * GROUND + rho * rho).sqrt();
    let near = THICKNESS - rho * rho / (GROUND + r);
    let d = near + unit(x[0][0], 256.0) * (rho + whole - near);
    two(rho * rho / (GROUND + r), ((whole * whole - rho * rho - d * d) / (2.0 * r * d)).clamp(-1.0, 1.0))
}

fn bend(mu: f64) -> f64 {
    0.5 + 0.6 * mu / (mu.abs() + f64::from(0.2f32))
}

fn unbend(x: f64) -> f64 {
    let y = (2.0 * x - 1.0) / 1.2;
    (f64::from(0.2f32) * y / (1.0 - y.abs())).clamp(-1.0, 1.0)
}

/// Half angles from the zenith, of the horizon and of the ray.
fn sky_view_uv(x: &Wide) -> Output {
    let [h, mu, sine, ground] = x[0];
    let horizon = horizon_mu(h);
    let y = if ground > 0.5 { (horizon - mu) / (1.0 + horizon) } else { (mu - horizon) / (1.0 - horizon) };
    // A ray turned beyond straight up or down comes back, and its angle goes by the root of what is missing.
    let y = 1.0 - (1.0 - y.max(0.0)).abs();
    let x = texel((y / (1.0 + (1.0 - y).sqrt())).sqrt(), 64.0);
    two(texel(sine, 192.0), if ground > 0.5 { 0.5 + 0.5 * x } else { 0.5 - 0.5 * x })
}

fn sky_view_point(x: &Wide) -> Output {
    let [h, u, v, _] = x[0];
    let horizon = horizon_mu(h);
    let (ground, x) = (v > 0.5, unit((2.0 * v - 1.0).abs(), 64.0));
    let y = x * x * (2.0 - x * x);
    let mu = horizon + y * if ground { -1.0 - horizon } else { 1.0 - horizon };
    [mu, unit(u, 192.0), f64::from(u8::from(ground)), f64::NAN]
}

fn half_azimuth_sine(x: &Wide) -> f64 {
    let [a, b] = [xyz(x[0]), xyz(x[1])];
    let angle = (a.x * b.z - a.z * b.x).abs().atan2(a.x * b.x + a.z * b.z);
    (0.5 * angle).sin()
}

/// Between the centres of the first and last of 32 by 16 texels and more.
fn uv(random: &mut Random) -> [f64; 2] {
    [random.between(0.016, 0.984), random.between(0.032, 0.968)]
}

pub fn twins() -> Vec<Twin> {
    let mut all = tables();
    all.extend(views());
    all.into_iter().map(|twin| twin.declaring(EARTH)).chain(spheres()).collect()
}

fn tables() -> Vec<Twin> {
    vec![
        Twin::new("texel_from_unit", "atmosphere", "return vec4f(texel_from_unit(x[0].x, x[0].y));", |x| {
            one(texel(x[0][0], x[0][1]))
        })
        .over("all", |random| scalars([random.between(0.0, 1.0), random.log(2.0, 1024.0).ceil()])),
        Twin::new("unit_from_texel", "atmosphere", "return vec4f(unit_from_texel(x[0].x, x[0].y));", |x| {
            one((x[0][0] * x[0][1] - 0.5) / (x[0][1] - 1.0))
        })
        .over("all", |random| scalars([random.between(0.0, 1.0), random.log(2.0, 1024.0).ceil()])),
        Twin::new(
            "transmittance_uv",
            "atmosphere",
            "return vec4f(transmittance_uv(earth, vec2f(256.0, 64.0), x[0].x, x[0].y), 0.0, 0.0);",
            transmittance_uv,
        )
        .over("all", |random| {
            let (h, mu) = inside(random);
            scalars([h, mu.max(horizon_mu(h))])
        }),
        Twin::new(
            "transmittance_point",
            "atmosphere",
            "return vec4f(transmittance_point(earth, vec2f(256.0, 64.0), x[0].xy), 0.0, 0.0);",
            transmittance_point,
        )
        .over("all", |random| scalars(uv(random))),
        Twin::new(
            "sun_visibility",
            "atmosphere",
            "return vec4f(sun_visibility(earth, x[0].x, x[0].y));",
            |x| {
                let [h, mu, ..] = x[0];
                let width = f64::from(0.004625f32) * GROUND / (GROUND + h);
                let y = ((mu - horizon_mu(h)) / width).clamp(-1.0, 1.0) * 0.5 + 0.5;
                one(y * y * (3.0 - 2.0 * y))
            },
        )
        .over("all", |random| {
            let h = random.log(0.1, 1e5);
            scalars([h, horizon_mu(h) + random.between(-0.006, 0.006)])
        }),
        Twin::new("unit_from_mu_sun", "atmosphere", "return vec4f(unit_from_mu_sun(x[0].x));", |x| {
            one(bend(x[0][0]))
        })
        .over("all", |random| scalars([random.cosine()])),
        Twin::new("mu_sun_from_unit", "atmosphere", "return vec4f(mu_sun_from_unit(x[0].x));", |x| {
            one(unbend(x[0][0]))
        })
        .over("all", |random| scalars([random.between(0.0, 1.0)])),
        Twin::new(
            "multiple_uv",
            "atmosphere",
            "return vec4f(multiple_uv(earth, vec2f(32.0, 16.0), x[0].x, x[0].y), 0.0, 0.0);",
            |x| two(texel(bend(x[0][1]), 32.0), texel((x[0][0] / THICKNESS).min(1.0).sqrt(), 16.0)),
        )
        .over("all", |random| scalars([random.log(0.1, 1e5), random.cosine()])),
        Twin::new(
            "multiple_point",
            "atmosphere",
            "return vec4f(multiple_point(earth, vec2f(32.0, 16.0), x[0].xy), 0.0, 0.0);",
            |x| two(unit(x[0][1], 16.0).powi(2) * THICKNESS, unbend(unit(x[0][0], 32.0))),
        )
        .over("all", |random| scalars(uv(random))),
    ]
}

fn views() -> Vec<Twin> {
    vec![
        Twin::new(
            "sky_view_uv",
            "atmosphere",
            "return vec4f(sky_view_uv(earth, vec2f(192.0, 128.0), x[0].x, x[0].y, x[0].z, x[0].w > 0.5), 0.0, 0.0);",
            sky_view_uv,
        )
        .over("all", |random| {
            let h = random.log(0.1, 1e7);
            let off = random.sign() * random.log(1e-6, 1.0);
            let mu = (horizon_mu(h) + off).clamp(-1.0, 1.0);
            scalars([h, mu, random.between(0.0, 1.0), f64::from(u8::from(off < 0.0))])
        }),
        Twin::new(
            "sky_view_point",
            "atmosphere",
            "return vec4f(sky_view_point(earth, vec2f(192.0, 128.0), x[0].x, x[0].yz), 0.0);",
            sky_view_point,
        )
        .over("all", |random| {
            let [u, v] = uv(random);
            scalars([random.log(0.1, 1e7), u, v])
        }),
        Twin::new("half_azimuth_sine", "atmosphere", "return vec4f(half_azimuth_sine(x[0].xyz, x[1].xyz));", |x| {
            one(half_azimuth_sine(x))
        })
        .over("all", |random| {
            let (a, b) = (random.direction(), random.direction());
            input([vector(a, 0.0), vector(b, 0.0)])
        }),
        Twin::new(
            "light_texel",
            "atmosphere",
            "let t = light_texel(x[0].xyz); return vec4f(t.rgb * t.a, 0.0);",
            |x| three(DVec3::new(x[0][0], x[0][1], x[0][2])),
        )
        .over("all", |random| scalars([(); 3].map(|()| random.log(1e-8, 1e6)))),
    ]
}

fn spheres() -> Vec<Twin> {
    vec![
        Twin::new("middle_of", "sphere_grid", "return vec4f(middle_of(u32(x[0].x), u32(x[0].y)));", |x| {
            one((2.0 * x[0][0] + 1.0) / (2.0 * x[0][1]))
        })
        .edges(plane(&[0.0, 1.0, 5.0, 7.0], &[8.0, 16.0])),
        Twin::new(
            "half_circle_sine",
            "sphere_grid",
            "return vec4f(half_circle_sine(u32(x[0].x), u32(x[0].y)));",
            |x| {
                // Half of an azimuth from 0 to pi.
                let azimuth = PI * (x[0][0] + 0.5) / x[0][1];
                one(((1.0 - azimuth.cos()) / 2.0).sqrt())
            },
        )
        .edges(plane(&[0.0, 1.0, 3.0, 5.0], &[6.0, 8.0, 16.0]))
        // GPUs have sines within an amount, not within a share.
        .beside(1.0),
        Twin::new("weighted_cosine", "sphere_grid", "return vec4f(weighted_cosine(x[0].x));", |x| {
            // Below it is this share of the weights: their integral is its square.
            one(x[0][0].powf(0.5))
        })
        .edges(plane(&[0.0, 0.03, 0.5, 1.0], &[0.0]))
        .over("all", |random| scalars([random.log(1e-6, 1.0)])),
        Twin::new(
            "hemisphere_irradiance",
            "sphere_grid",
            "return vec4f(hemisphere_irradiance(x[0].xyz, u32(x[0].w)), 0.0);",
            |x| three(xyz(x[0]) / x[0][3] * PI),
        )
        .over("all", |random| {
            let sum = DVec3::from([(); 3].map(|()| random.log(1e-6, 1e3)));
            input([vector(sum, 64.0)])
        }),
        Twin::new(
            "matt_radiance",
            "sphere_grid",
            "return vec4f(matt_radiance(x[0].xyz, x[1].xyz), 0.0);",
            |x| three(xyz(x[0]) * xyz(x[1]) / PI),
        )
        .over("all", |random| {
            let albedo = DVec3::from([(); 3].map(|()| random.between(0.0, 1.0)));
            let light = DVec3::from([(); 3].map(|()| random.log(1e-6, 1e3)));
            input([vector(albedo, 0.0), vector(light, 0.0)])
        }),
        Twin::new("even_source", "sphere_grid", "return vec4f(even_source(x[0].xyz, x[1].xyz), 0.0);", |x| {
            three(xyz(x[0]) * xyz(x[1]) / (4.0 * PI))
        })
        .over("all", |random| {
            let [light, scattering] = [1e3, 1e-3].map(|most| [(); 3].map(|()| random.log(1e-6 * most, most)));
            input([vector(light.into(), 0.0), vector(scattering.into(), 0.0)])
        }),
        Twin::new("direction_at", "sphere_grid", "return vec4f(direction_at(x[0].x, x[0].y), 0.0);", |x| {
            let (elevation, azimuth) = (x[0][0].asin(), x[0][1]);
            let level = elevation.cos();
            three(DVec3::new(level * azimuth.cos(), x[0][0], level * azimuth.sin()))
        })
        .edges(plane(&[-1.0, 0.0, 1.0], &[0.0, 1.0, 3.0, 6.0]))
        .beside(1.0)
        .over("all", |random| scalars([random.between(-1.0, 1.0), random.between(0.0, 2.0 * PI)]))
        // Parts of a unit vector.
        .beside(1.0),
    ]
}
