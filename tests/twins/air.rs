//! The atmosphere without its tables: medium, phase functions, spheres, steps.

use std::f64::consts::PI;

use crate::definitions::mean_transmittance;
use crate::harness::{Output, Random, Twin, Wide};
use crate::pack::{each, input, line, one, plane, scalars, three, two, vector, xyz};
use glam::DVec3;

/// The Earth: its lengths are exact in f32, its coefficients are rounded as here.
pub const EARTH: &str = "const earth = Atmosphere(vec3f(5.802e-6, 13.558e-6, 33.1e-6), 8e3,
    vec3f(0.650e-6, 1.881e-6, 0.085e-6), 25e3, vec3f(0.1), 15e3, 4.316e-6, 4.44e-6, 1.2e3, 0.7, 6360e3, 100e3,
    0.004625, 0.0);";
pub const GROUND: f64 = 6360e3;
pub const THICKNESS: f64 = 100e3;

/// Square of the distance to the horizon.
pub fn horizon_square(h: f64) -> f64 {
    h * (2.0 * GROUND + h)
}

pub fn horizon_mu(h: f64) -> f64 {
    -horizon_square(h).max(0.0).sqrt() / (GROUND + h)
}

pub fn square_to_top(h: f64) -> f64 {
    (THICKNESS - h) * (2.0 * GROUND + THICKNESS + h)
}

pub fn distance_to_top(h: f64, mu: f64) -> f64 {
    let across = (GROUND + h) * mu;
    let (square, root) = (square_to_top(h), (across * across + square_to_top(h)).max(0.0).sqrt());
    if across > 0.0 { square.max(0.0) / (root + across) } else { root - across }
}

fn medium(h: f64) -> [f64; 8] {
    let (air, haze) = ((-h.max(0.0) / 8e3).exp(), (-h.max(0.0) / 1.2e3).exp());
    let tent = (1.0 - (h.max(0.0) - 25e3).abs() / 15e3).max(0.0);
    let rounded = |x: [f32; 3]| x.map(f64::from);
    let (rayleigh, ozone) =
        (rounded([5.802e-6, 13.558e-6, 33.1e-6]), rounded([0.650e-6, 1.881e-6, 0.085e-6]));
    let [scattering, extinction] = [4.316e-6f32, 4.44e-6].map(f64::from);
    let mut all = [f64::NAN; 8];
    for c in 0..3 {
        all[c] = air * rayleigh[c];
        all[4 + c] = air * rayleigh[c] + haze * extinction + tent * ozone[c];
    }
    all[3] = haze * scattering;
    all
}

/// Cornette and Shanks, 1/sr.
fn haze_phase(x: &Wide) -> Output {
    let [g, nu, ..] = x[0];
    let square = (1.0 - g).powi(2) + 2.0 * g * (1.0 - nu);
    one(3.0 / (8.0 * PI) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + nu * nu) / square.powf(1.5))
}

fn air_ray_at(x: &Wide) -> Output {
    let [h, mu, mu_sun, nu] = x[0];
    let (r, t) = (GROUND + h, x[1][0]);
    let square = horizon_square(h) + t * (2.0 * r * mu + t);
    let radius = (GROUND * GROUND + square).sqrt();
    let altitude = square / (GROUND + radius);
    [
        altitude,
        ((r * mu + t) / radius).clamp(-1.0, 1.0),
        ((r * mu_sun + t * nu) / radius).clamp(-1.0, 1.0),
        nu,
    ]
}

fn step_distance(x: &Wide) -> Output {
    let [x, lowest, length, _] = x[0];
    let (before, after) = (lowest.sqrt(), (length - lowest).max(0.0).sqrt());
    let share = before / (before + after);
    // Quadratic about the lowest point: the distance to it goes as the square of the way in x.
    one(if x < share {
        lowest - lowest * ((share - x) / share).powi(2)
    } else {
        lowest + (length - lowest) * ((x - share) / (1.0 - share)).powi(2)
    })
}

/// Altitudes up to the top of the atmosphere, and a cosine; one in three is near the horizon.
pub fn inside(random: &mut Random) -> (f64, f64) {
    let h = random.log(0.1, THICKNESS);
    let mu = match random.index(3) {
        0 => horizon_mu(h) + random.sign() * random.log(1e-6, 0.1),
        _ => random.cosine(),
    };
    (h, mu)
}

const ALTITUDES: &[f32] = &[0.0, 0.1, 1.7, 100.0, 2e3, 1e4, 3e4, 9e4, 1e5];
const COSINES: &[f32] = &[-1.0, -0.5, -1e-3, 0.0, 1e-3, 0.3, 1.0];

pub fn twins() -> Vec<Twin> {
    let mut all = media();
    all.extend(spheres());
    all.extend(steps());
    all.extend(discs());
    all.into_iter().map(|twin| twin.declaring(EARTH)).collect()
}

fn media() -> Vec<Twin> {
    vec![
        Twin::new(
            "atmosphere_medium",
            "air",
            "let m = atmosphere_medium(earth, x[0].x); if x[0].y > 0.5 { return vec4f(m.extinction, 0.0); }
             return vec4f(m.rayleigh, m.mie);",
            |x| {
                let [r0, r1, r2, mie, e0, e1, e2, _] = medium(x[0][0]);
                if x[0][1] > 0.5 { [e0, e1, e2, f64::NAN] } else { [r0, r1, r2, mie] }
            },
        )
        .edges(plane(ALTITUDES, &[0.0, 1.0]))
        .over("all", |random| scalars([random.log(0.1, 1e5), random.index(2) as f64])),
        Twin::new("rayleigh_phase", "air", "return vec4f(rayleigh_phase(x[0].x));", |x| {
            one(3.0 / (16.0 * PI) * (1.0 + x[0][0].powi(2)))
        })
        .edges(line(COSINES))
        .over("all", |random| scalars([random.cosine()])),
        Twin::new("haze_phase", "air", "return vec4f(haze_phase(x[0].x, x[0].y));", haze_phase)
            .edges(plane(&[0.0, 0.5, 0.8], COSINES))
            .over("all", |random| scalars([random.between(0.0, 0.99), random.cosine()]))
            .over("peaks", |random| scalars([random.between(0.9, 0.99), 1.0 - random.log(1e-6, 0.01)])),
    ]
}

fn spheres() -> Vec<Twin> {
    vec![
        Twin::new("horizon_square", "air", "return vec4f(horizon_square(earth, x[0].x));", |x| {
            one(horizon_square(x[0][0]))
        })
        .edges(line(ALTITUDES))
        .over("all", |random| scalars([random.log(0.1, 1e7)])),
        Twin::new("square_to_top", "air", "return vec4f(square_to_top(earth, x[0].x));", |x| {
            one(square_to_top(x[0][0]))
        })
        .edges(line(ALTITUDES))
        .over("all", |random| scalars([random.log(0.1, 1e7)])),
        Twin::new("horizon_mu", "air", "return vec4f(horizon_mu(earth, x[0].x));", |x| {
            one(horizon_mu(x[0][0]))
        })
        .edges(line(ALTITUDES))
        .over("all", |random| scalars([random.log(0.1, 1e7)])),
        Twin::new("distance_to_top", "air", "return vec4f(distance_to_top(earth, x[0].x, x[0].y));", |x| {
            one(distance_to_top(x[0][0], x[0][1]))
        })
        .edges(plane(ALTITUDES, COSINES))
        .over("all", |random| {
            let (h, mu) = inside(random);
            scalars([h, mu])
        }),
        Twin::new(
            "distance_to_ground",
            "air",
            "return vec4f(distance_to_ground(earth, x[0].x, x[0].y));",
            |x| {
                let (across, square) = ((GROUND + x[0][0]) * x[0][1], horizon_square(x[0][0]));
                let root = across * across - square;
                one(if root > 0.0 { square / (root.sqrt() - across) } else { -across })
            },
        )
        .over("all", |random| {
            let h = random.log(0.1, 1e7);
            scalars([h, (horizon_mu(h) - random.log(1e-6, 1.0)).max(-1.0)])
        }),
        Twin::new("ground_ahead", "air", "return vec4f(ground_ahead(earth, x[0].x, x[0].y));", |x| {
            let h = x[0][0].max(0.0);
            let (across, square) = ((GROUND + h) * x[0][1], horizon_square(h));
            let hidden = x[0][1] < horizon_mu(h);
            one(if hidden { square / ((across * across - square).max(0.0).sqrt() - across) } else { 1e29 })
        })
        .over("all", |random| {
            // Below the ground, on both sides of the horizon; at the horizon itself all digits are lost.
            let h = if random.between(0.0, 1.0) < 0.2 { -random.log(0.1, 1e4) } else { random.log(0.1, 1e7) };
            let from_horizon = random.log(1e-4, 1.0);
            let above = random.between(0.0, 1.0) < 0.3;
            let mu = horizon_mu(h.max(0.0)) + if above { from_horizon } else { -from_horizon };
            scalars([h, mu.clamp(-1.0, 1.0)])
        }),
        Twin::new(
            "air_ray_at",
            "air",
            "let r = air_ray_at(earth, AirRay(x[0].x, x[0].y, x[0].z, x[0].w), x[1].x);
             return vec4f(r.altitude, r.mu, r.mu_sun, r.nu);",
            air_ray_at,
        )
        .over("all", |random| {
            let ((h, mu), mu_sun) = (inside(random), random.cosine());
            let nu =
                mu * mu_sun + ((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun)).sqrt() * random.between(-1.0, 1.0);
            input([[h, mu, mu_sun, nu], [random.log(1.0, 1e6), 0.0, 0.0, 0.0]])
        }),
        Twin::new(
            "air_ray",
            "air",
            "let r = air_ray(x[0].w, x[0].xyz, x[1].xyz); return vec4f(r.altitude, r.mu, r.mu_sun, r.nu);",
            |x| [x[0][3], x[0][1], x[1][1], xyz(x[0]).dot(xyz(x[1]))],
        )
        .over("all", |random| {
            let (direction, to_sun) = (random.direction(), random.direction());
            input([vector(direction, random.log(1.0, 1e5)), vector(to_sun, 0.0)])
        }),
        Twin::new(
            "distance_to_entry",
            "air",
            "return vec4f(distance_to_entry(earth, x[0].x, x[0].y));",
            |x| {
                let (across, square) = ((GROUND + x[0][0]) * x[0][1], square_to_top(x[0][0]));
                let root = across * across + square;
                // A graze decides between a hit and a miss by rounding.
                let near = root.abs() < 1e-6 * across * across;
                one(match square >= 0.0 {
                    true => 0.0,
                    false if near => f64::NAN,
                    false if across >= 0.0 || root < 0.0 => -1.0,
                    false => -square / (root.sqrt() - across),
                })
            },
        )
        .over("space", |random| scalars([THICKNESS + random.log(1.0, 1e6), random.cosine()])),
    ]
}

fn steps() -> Vec<Twin> {
    vec![
        Twin::new(
            "step_distance",
            "air",
            "return vec4f(step_distance(x[0].x, x[0].y, x[0].z));",
            step_distance,
        )
        .over("all", |random| {
            let length = random.log(1.0, 1e6);
            let lowest = length * [0.0, 1.0, random.between(0.0, 1.0)][random.index(3)];
            scalars([random.between(0.01, 1.0), lowest, length])
        }),
        Twin::new(
            "lowest_distance",
            "air",
            "return vec4f(lowest_distance(earth, x[0].x, x[0].y, x[0].z));",
            |x| one((-(GROUND + x[0][0]) * x[0][1]).clamp(0.0, x[0][2])),
        )
        .over("all", |random| {
            let (h, mu) = inside(random);
            scalars([h, mu, random.log(1.0, 1e6)])
        }),
        Twin::new(
            "attenuated_length",
            "air",
            "return vec4f(attenuated_length(x[0].xyz, x[0].w), 0.0);",
            |x| each(x[0], |extinction| x[0][3] * mean_transmittance(0.0, extinction * x[0][3])),
        )
        .over("all", |random| {
            let length = random.log(1e-3, 1e6);
            let [a, b, c] = [(); 3].map(|()| random.log(1e-6, 1e6) / length);
            scalars([a, b, c, length])
        }),
        Twin::new(
            "scattering_step",
            "air",
            "let s = scattering_step(Scattering(x[0].xyz, x[1].xyz), x[2].xyz, x[3].xyz, x[0].w);
             if x[1].w > 0.5 { return vec4f(s.transmittance, 0.0); } return vec4f(s.radiance, 0.0);",
            |x| {
                let [radiance, through, source, extinction] =
                    [0, 1, 2, 3].map(|i| DVec3::new(x[i][0], x[i][1], x[i][2]));
                let length = x[0][3];
                let gained = extinction.map(|e| length * mean_transmittance(0.0, e * length));
                three(if x[1][3] > 0.5 {
                    through * extinction.map(|e| (-e * length).exp())
                } else {
                    radiance + through * source * gained
                })
            },
        )
        .over("all", |random| {
            let length = random.log(1.0, 1e6);
            let mut three = |low, high, w| {
                let [a, b, c] = [(); 3].map(|()| random.log(low, high));
                [a, b, c, w]
            };
            let [radiance, source] = [three(1e-6, 1.0, length), three(1e-6, 1.0, 0.0)];
            let extinction = three(1e-9, 1e-3, 0.0);
            let part = f64::from(u8::from(random.sign() > 0.0));
            let [a, b, c] = [(); 3].map(|()| random.between(0.0, 1.0));
            input([radiance, [a, b, c, part], source, extinction])
        }),
        Twin::new(
            "aerial_distance",
            "atmosphere",
            "return vec4f(aerial_distance(x[0].x, x[0].y, x[0].z));",
            |x| one(((x[0][0] + 1.0) / x[0][1]).powi(2) * x[0][2]),
        )
        .over("all", |random| scalars([random.index(32) as f64, 32.0, random.log(1.0, 1e6)])),
        Twin::new(
            "sky_view_ray",
            "atmosphere",
            "return vec4f(sky_view_ray(0.0, x[0].x, x[0].y, x[0].z).nu);",
            |x| {
                let [mu, sine, mu_sun, _] = x[0];
                let level = ((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun)).sqrt();
                two((mu * mu_sun + level * (1.0 - 2.0 * sine * sine)).clamp(-1.0, 1.0), f64::NAN)
            },
        )
        .over("all", |random| scalars([random.cosine(), random.between(0.0, 1.0), random.cosine()])),
    ]
}

/// Where a pixel and the sun's disc overlap, a pixel on its rim being cut in two, and its light: without
/// the darkening of the limb, even over a disc whose rim falls off over a pixel.
fn disc(x: &Wide, channel: usize) -> f64 {
    let [radius, pixel, off, irradiance] = x[0];
    let sharp = 1.0 - pixel / (2.0 * radius);
    let rim = (off / radius).min(sharp);
    let exponent = [0.397f32, 0.503, 0.652].map(f64::from)[channel] * sharp / 2.0;
    // The cosine of the angle to the surface, to twice the exponent.
    let limb = (1.0 + exponent) * (1.0 - rim * rim).max(1e-6).powf(exponent);
    // The integral of a rim that falls off evenly from radius - pixel / 2 to radius + pixel / 2.
    let (inner, outer) = (radius - pixel / 2.0, radius + pixel / 2.0);
    let solid_angle = PI / 3.0 * (inner * inner + inner * outer + outer * outer);
    irradiance * limb / solid_angle
}

/// Radius of a disc of no less than half a pixel, the pixel, and a distance from the middle.
fn on_disc(random: &mut Random) -> [f64; 4] {
    let radius = random.log(1e-3, 0.1);
    let pixel = radius * random.log(1e-3, 2.0);
    [radius, pixel, random.between(0.0, 1.5) * radius, random.log(1e-3, 1e3)]
}

fn discs() -> Vec<Twin> {
    vec![
        Twin::new(
            "share_above",
            "sun_disc",
            "return vec4f(share_above(earth, x[0].x, x[0].y, x[0].z));",
            |x| {
                // The zenith angle, over the sine of the horizon's.
                let [h, mu, pixel, _] = x[0];
                let angle = (mu - horizon_mu(h)) * (1.0 + h / GROUND);
                one((0.5 + angle / pixel).clamp(0.0, 1.0))
            },
        )
        .over("all", |random| {
            let (h, mu) = inside(random);
            scalars([h, mu, random.log(1e-4, 0.1)])
        }),
        Twin::new("disc_radius", "sun_disc", "return vec4f(disc_radius(x[0].x, x[0].y));", |x| {
            // The chord of the radius.
            let [radius, pixel, ..] = x[0];
            one((2.0 - 2.0 * (1.0 - 2.0 * (radius / 2.0).sin().powi(2))).sqrt().max(pixel / 2.0))
        })
        .edges(plane(&[0.0, 0.004625, 0.1], &[0.0, 1e-3, 0.1]))
        .over("all", |random| scalars([random.log(1e-4, 0.1), random.log(1e-4, 0.1)]))
        // GPUs have sines within an amount, not within a share.
        .beside(1e-2),
        Twin::new("disc_share", "sun_disc", "return vec4f(disc_share(x[0].x, x[0].y, x[0].z));", |x| {
            let [radius, pixel, off, _] = x[0];
            one((0.5 + (radius - off) / pixel).clamp(0.0, 1.0))
        })
        .over("all", |random| input([on_disc(random)])),
        Twin::new(
            "disc_radiance",
            "sun_disc",
            "return vec4f(disc_radiance(x[0].www, x[0].x, x[0].y, x[0].z), 0.0);",
            |x| three(DVec3::from([0, 1, 2].map(|channel| disc(x, channel)))),
        )
        .over("all", |random| input([on_disc(random)])),
    ]
}
