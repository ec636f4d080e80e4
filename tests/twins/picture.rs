//! Cameras, tone curves, spherical harmonics.

use std::f64::consts::PI;

use glam::DVec3;

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{each, grid, input, line, one, plane, scalars, three, two, vector, xyz};

/// Real spherical harmonic of degree l and order m (negative: sine) in a direction: Re or Im
/// (x + iy)^|m| times the |m|-th derivative of the Legendre polynomial.
pub fn harmonic(l: usize, m: i32, d: DVec3) -> f64 {
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

fn harmonics(x: &Wide, list: [(usize, i32); 4]) -> Output {
    list.map(|(l, m)| harmonic(l, m, xyz(x[0])))
}

/// Unit vectors all around, the axes among them.
fn all_around() -> Vec<Input> {
    let spiral = (0..40).map(|i| {
        let z = 1.0 - (f64::from(i) + 0.5) / 20.0;
        let (sine, cosine) = (2.4 * f64::from(i)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cosine, across * sine, z)
    });
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    spiral.chain(axes).map(|d| input([vector(d, 0.0)])).collect()
}

fn direction(random: &mut Random) -> Input {
    input([vector(random.direction(), 0.0)])
}

/// Light of three channels, from night to the sun.
fn light(random: &mut Random) -> Input {
    scalars([(); 3].map(|()| random.log(1e-6, 1e6)))
}

fn lights() -> Vec<Input> {
    grid(&[-1.0, 0.0, 0.01], &[0.18, 1.0], &[8.0, 1e4], &[0.0])
}

fn filmic(x: f64) -> f64 {
    let x = x.max(0.0);
    ((2.51 * x * x + 0.03 * x) / (2.43 * x * x + 0.59 * x + 0.14)).min(1.0)
}

/// Reinhard et al. (2002), eq. 4, of 1.9 times the light, white at 8.
fn soft(x: f64) -> f64 {
    let (l, white) = (1.9 * x.max(0.0), 1.9 * 8.0);
    (l * (1.0 + l / (white * white)) / (1.0 + l)).min(1.0)
}

/// Straight up to 0.6, then an exponential that goes on as steep and ends at 1.
fn natural_level(x: f64) -> f64 {
    if x <= 0.6 { x } else { 1.0 - 0.4 * (-(x - 0.6) / 0.4).exp() }
}

/// Harmonic sum, by fourth powers, of all of a colour and of what fits between grey and white.
fn natural_colour(brightest: f64, level: f64) -> f64 {
    let fitting = (1.0 - level).max(1e-6) / (brightest - level);
    (1.0 + fitting.max(1e-4).powi(-4)).powf(-0.25)
}

fn natural_brightness(light: DVec3) -> f64 {
    let luminance = light.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    0.5 * (luminance + light.max_element())
}

/// Brightness to the power of 1.22, where 0.78 stays; straight far below 0.3.
fn photo(light: DVec3) -> DVec3 {
    let light = light.max(DVec3::ZERO);
    natural(light * (natural_brightness(light).hypot(0.3) / 0.78_f64.hypot(0.3)).powf(0.22))
}

fn natural(light: DVec3) -> DVec3 {
    let light = light.max(DVec3::ZERO);
    let brightness = natural_brightness(light);
    if brightness == 0.0 {
        return DVec3::ZERO;
    }
    let level = natural_level(brightness);
    let color = light * (level / brightness);
    let kept = if color.max_element() > level { natural_colour(color.max_element(), level) } else { 1.0 };
    DVec3::splat(level).lerp(color, kept).min(DVec3::ONE)
}

fn srgb(x: f64) -> f64 {
    if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// A camera with axes of 1.6 and 0.9, which stretch its panorama.
const CAMERA: &str = "const view = Camera(vec3f(1.6, 0.0, 0.0), 0u, vec3f(0.0, 0.9, 0.0), 2.0,
    vec3f(0.0, 0.0, -1.0), 0.001, vec3f(0.0, 0.0, -1.0), 0.0, vec2f(1.0), vec2f(0.0));";

fn camera_ray(x: &Wide) -> Output {
    let [a, b, kind, _] = x[0];
    let [right, up] = [1.6f32, 0.9].map(f64::from);
    let d = match kind as u32 {
        0 => DVec3::new(right * a, up * b, -1.0).normalize(),
        1 => DVec3::NEG_Z,
        _ => DVec3::new(
            (PI * a).sin() * (PI / 2.0 * b).cos() * right,
            (PI / 2.0 * b).sin() * up,
            -(PI * a).cos() * (PI / 2.0 * b).cos(),
        ),
    };
    vector(d, if kind as u32 == 1 { right * a } else { 0.0 })
}

pub fn twins() -> Vec<Twin> {
    let mut all = camera();
    all.extend(curves());
    all.extend(spherical());
    all
}

fn camera() -> Vec<Twin> {
    vec![
        Twin::new(
            "camera_ray",
            "camera",
            "var c = view; c.projection = u32(x[0].z); let r = camera_ray(c, x[0].xy);
             return vec4f(r.direction, r.origin.x);",
            camera_ray,
        )
        .declaring(CAMERA)
        .edges(grid(&[-1.0, 0.0, 0.4], &[-0.7, 0.0, 1.0], &[0.0, 1.0, 2.0], &[0.0]))
        // Parts of a unit vector: pi is rounded.
        .beside(1.0)
        .over("perspective", |random| scalars([random.between(-1.0, 1.0), random.between(-1.0, 1.0), 0.0]))
        .over("panorama", |random| scalars([random.between(-1.0, 1.0), random.between(-1.0, 1.0), 2.0]))
        // GPUs have sines within an amount, not within a share: 2e-6 rad is less than any pixel.
        .beside(1.0),
        Twin::new(
            "pixel_ndc",
            "camera",
            "var c: Camera; c.size = x[0].zw; return vec4f(pixel_ndc(c, x[0].xy), 0.0, 0.0);",
            |x| {
                let [x, y, width, height] = x[0];
                two(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height)
            },
        )
        .edges(grid(&[0.0, 0.5, 40.0], &[0.0, 19.5], &[40.0], &[20.0]))
        .over("all", |random| {
            let size = [(); 2].map(|()| random.log(1.0, 16_384.0).ceil());
            let pixel = size.map(|size| random.between(0.0, size).floor() + 0.5);
            scalars([pixel[0], pixel[1], size[0], size[1]])
        }),
        Twin::new(
            "pixel_footprint",
            "camera",
            "var c: Camera; c.pixel = 0.25; c.projection = u32(x[0].y); return vec4f(pixel_footprint(c, x[0].x));",
            |x| one(if x[0][1] as u32 == 1 { 0.25 } else { 0.25 * x[0][0] }),
        )
        .edges(plane(&[0.0, 8.0], &[0.0, 1.0, 2.0])),
        // Along the view axis, over the cosine of the ray to it.
        Twin::new(
            "depth_distance",
            "camera",
            "var c: Camera; c.projection = u32(x[1].w); c.axis = normalize(x[2].xyz);
             return vec4f(depth_distance(c, x[0], x[2].w, x[1].xyz));",
            |x| {
                let ([a, b, c, _], depth, orthographic) = (x[0], x[2][3], x[1][3] > 0.5);
                let axial = if orthographic { a + b * depth } else { a / (b + c * depth) };
                one(axial * xyz(x[2]).length() / xyz(x[1]).dot(xyz(x[2])))
            },
        )
        .over("all", |random| {
            let forward = random.direction();
            let angle = random.between(0.0, 1.3);
            let direction = random.direction_off(forward, angle);
            let (near, depth) = (random.log(0.01, 10.0), random.log(1e-4, 1.0));
            // Depth from 1 at the near plane to 0, far away.
            let kind = random.index(2);
            let scale = [[near, 0.0, 1.0, 0.0], [1e4, near - 1e4, 0.0, 0.0]][kind];
            let length = random.log(0.1, 10.0);
            input([scale, vector(direction, kind as f64), vector(length * forward, depth)])
        }),
    ]
}

fn curves() -> Vec<Twin> {
    vec![
        Twin::new("filmic", "tonemap", "return vec4f(filmic(x[0].xyz), 0.0);", |x| each(x[0], filmic))
            .edges(lights())
            .over("all", light),
        Twin::new("soft", "tonemap", "return vec4f(soft(x[0].xyz), 0.0);", |x| each(x[0], soft))
            .edges(lights())
            .over("all", light),
        Twin::new("natural_level", "tonemap", "return vec4f(natural_level(x[0].x));", |x| {
            one(natural_level(x[0][0]))
        })
        .edges(line(&[0.0, 0.18, 0.59, 0.61, 1.0, 2.0, 8.0, 1e4]))
        .over("all", |random| scalars([random.log(1e-6, 1e6)])),
        Twin::new("natural_colour", "tonemap", "return vec4f(natural_colour(x[0].x, x[0].y));", |x| {
            one(natural_colour(x[0][0], x[0][1]))
        })
        .edges(plane(&[0.9, 1.0, 1.3], &[0.0, 0.5, 0.875]))
        .over("all", |random| {
            let level = random.between(0.0, 0.9);
            scalars([level * random.between(1.01, 2.0), level])
        })
        // A share of the colour.
        .beside(1.0),
        Twin::new("natural", "tonemap", "return vec4f(natural(x[0].xyz), 0.0);", |x| {
            three(natural(xyz(x[0])))
        })
        .edges(lights())
        .over("all", light)
        // Channels that are added to grey: of a screen's white.
        .beside(1.0),
        Twin::new("natural_brightness", "tonemap", "return vec4f(natural_brightness(x[0].xyz));", |x| {
            one(natural_brightness(xyz(x[0])))
        })
        .edges(lights())
        .over("all", light),
        Twin::new("photo", "tonemap", "return vec4f(photo(x[0].xyz), 0.0);", |x| three(photo(xyz(x[0]))))
            .edges(lights())
            .over("all", light)
            .beside(1.0),
        Twin::new(
            "tone_curve",
            "tonemap",
            "return vec4f(tone_curve(0u, x[0].xxx).x, tone_curve(1u, x[0].xxx).x, tone_curve(3u, x[0].xxx).x,
                tone_curve(4u, x[0].xxx).x) + 10.0 * tone_curve(2u, x[0].xxx).x;",
            |x| {
                let shown =
                    [filmic(x[0][0]), soft(x[0][0]), natural_level(x[0][0]), photo(DVec3::splat(x[0][0])).x];
                shown.map(|shown| shown + 10.0 * x[0][0].min(1.0))
            },
        )
        .edges(line(&[0.0, 0.18, 2.0])),
        Twin::new("heat_share", "tonemap", "return vec4f(heat_share(x[0].x, x[0].y));", |x| {
            one((x[0][0].max(0.0).ln_1p() / x[0][1].ln_1p()).min(1.0))
        })
        .edges(plane(&[-1.0, 0.0, 1.0, 200.0], &[1.0, 100.0]))
        .over("all", |random| scalars([random.log(1e-3, 1e6), random.log(1.0, 1e6)]))
        // A share of the way.
        .beside(1.0),
        Twin::new("srgb_encode", "tonemap", "return vec4f(srgb_encode(x[0].xyz), 0.0);", |x| {
            each(x[0], srgb)
        })
        .edges(grid(&[0.0, 0.001, 0.0031308], &[0.18, 0.5], &[0.9, 1.0], &[0.0]))
        .over("all", |random| scalars([(); 3].map(|()| random.log(1e-6, 1.0)))),
    ]
}

fn spherical() -> Vec<Twin> {
    vec![
        Twin::new("harmonics_low", "harmonics", "return harmonics_low(x[0].xyz);", |x| {
            harmonics(x, [(0, 0), (1, 1), (1, -1), (1, 0)])
        })
        .edges(all_around())
        .over("all", direction),
        Twin::new("harmonics_square", "harmonics", "return harmonics_square(x[0].xyz);", |x| {
            harmonics(x, [(2, -2), (2, -1), (2, 1), (2, 0)])
        })
        .edges(all_around())
        .over("all", direction),
        Twin::new("harmonics_mixed", "harmonics", "return harmonics_mixed(x[0].xyz);", |x| {
            harmonics(x, [(2, 2), (3, -3), (3, -2), (3, -1)])
        })
        .edges(all_around())
        .over("all", direction),
        Twin::new("harmonics_cubic", "harmonics", "return harmonics_cubic(x[0].xyz);", |x| {
            harmonics(x, [(3, 0), (3, 1), (3, 2), (3, 3)])
        })
        .edges(all_around())
        .over("all", direction),
    ]
}
