//! Ellipsoids and noise.
//!
//! An ellipsoid is packed as its rows (w: inverse radii) in x[0] to x[2], its centre (w: extinction)
//! in x[3], boundary, nothing, wispiness and core in x[4]; then a point, of the cloud's frame or of
//! the unit sphere's, a ray, and parameters.

use glam::{DMat3, DQuat, DVec3};

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{input, one, three, two, vector, xyz};

const MAKE: &str = "fn make(x: array<vec4f, 8>) -> Ellipsoid {
    return Ellipsoid(x[0], x[1], x[2], x[3].xyz, x[3].w, x[4].x, x[4].z, x[4].w, 3u);
}";

/// The map onto the unit sphere.
fn map(x: &Wide) -> DMat3 {
    DMat3::from_cols(xyz(x[0]), xyz(x[1]), xyz(x[2])).transpose()
}

fn pack(q: DMat3, radii: DVec3, center: DVec3, p: DVec3, ray: DVec3, parameters: [f64; 4]) -> Input {
    let row = |axis: DVec3, r: f64| vector(axis / r, 1.0 / r);
    input([
        row(q.x_axis, radii.x),
        row(q.y_axis, radii.y),
        row(q.z_axis, radii.z),
        vector(center, 0.05),
        [20.0, 0.0, 0.3, 0.6],
        vector(p, 1.0),
        vector(ray, 0.0),
        parameters,
    ])
}

const CENTER: DVec3 = DVec3::new(5.0, 90.0, -12.0);

/// Oriented, flat and tall ellipsoids with points inside, on, outside, and at the centre: as
/// points of the cloud's frame, or of the unit sphere's.
fn edges(of_sphere: bool, scales: &[f64]) -> Vec<Input> {
    let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64).normalize(), 1.1);
    let radii = [[1.0, 1.0, 1.0], [120.0, 40.0, 100.0], [3.0, 300.0, 30.0]].map(DVec3::from);
    let directions = [[0.3, -0.8, 0.52], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.577, 0.577, 0.577]];
    let mut list = Vec::new();
    for q in [DMat3::IDENTITY, DMat3::from_quat(turned)] {
        for r in radii {
            for d in directions {
                for k in scales {
                    let u = DVec3::from(d).normalize() * *k;
                    let p = if of_sphere { u } else { CENTER + q * (u * r) };
                    let ray = (q * DVec3::new(d[1], d[2] + 0.1, d[0])).normalize();
                    list.push(pack(q, r, CENTER, p, ray, [0.25, -0.7, 1.5, 0.0]));
                }
            }
        }
    }
    list
}

const ALL: &[f64] = &[0.0, 1e-3, 0.3, 0.8, 0.999, 1.0, 1.001, 1.7];
/// At the centre the normal has no direction and the depth only a limit.
const OFF_CENTER: &[f64] = &[1e-3, 0.3, 0.8, 0.999, 1.0, 1.001, 1.7];
/// Radii from 1 cm to 100 km, the longest up to 10 000 times the shortest.
fn radii(random: &mut Random) -> DVec3 {
    let longest = random.log(0.01, 1e5);
    let flattest = random.log(1.0, 1e4).min(longest / 0.01);
    let between = random.between(0.0, 1.0);
    let mut radii = [longest, longest / flattest.powf(between), longest / flattest];
    radii.rotate_left(random.index(3));
    radii.into()
}

/// An ellipsoid and a point at `distance` times its longest radius from its centre, or as much as
/// the extremes allow; a ray from there to a point of the ball of this radius around it.
fn seen_from(random: &mut Random, distance: f64, ball: f64) -> Input {
    let (q, radii) = (random.turn(), radii(random));
    let center = random.log(1.0, 1e4) * random.direction();
    let distance = (distance * radii.max_element()).clamp(1e-3, 1e6);
    let p = center + distance * random.direction();
    let target = center + q * (radii * ball * random.ball());
    pack(q, radii, center, p, (target - p).normalize(), [0.25, -0.7, 1.0, 0.0])
}

fn close_up(random: &mut Random) -> Input {
    let distance = random.log(0.01, 3.0);
    seen_from(random, distance, 1.0)
}

fn far(random: &mut Random) -> Input {
    let distance = random.log(3.0, 3e3);
    seen_from(random, distance, 1.0)
}

fn speck(random: &mut Random) -> Input {
    let distance = random.log(3e3, 1e8);
    seen_from(random, distance, 0.5)
}

/// Rays that pass within a hundredth of the surface.
fn graze(random: &mut Random) -> Input {
    let (q, radii) = (random.turn(), radii(random));
    let center = random.log(1.0, 1e4) * random.direction();
    let foot = random.direction();
    let along = random.direction_off(foot, std::f64::consts::FRAC_PI_2);
    let near = 1.0 - random.sign() * random.log(1e-6, 1e-2);
    let way = q * (radii * along);
    let distance = random.log(1.0, 1e3).min(1e6 / radii.max_element());
    let p = center + q * (radii * foot * near) - way * distance;
    pack(q, radii, center, p, way.normalize(), [0.25, -0.7, 1.0, 0.0])
}

/// Points of the unit sphere's space at a given distance from its middle.
fn at_radius(random: &mut Random, k: f64) -> Input {
    let (q, radii, noise) =
        (random.turn(), radii(random), [random.between(-1.0, 1.0), random.between(-1.0, 1.0)]);
    let mut x = pack(
        q,
        radii,
        CENTER,
        k * random.direction(),
        DVec3::X,
        [noise[0], noise[1], random.log(0.01, 1e3), 0.0],
    );
    x[4] = [random.log(0.01, 300.0) as f32, 0.0, random.between(0.0, 1.0) as f32, 0.6];
    x
}

fn within(random: &mut Random) -> Input {
    let k = random.log(1e-3, 3.0);
    at_radius(random, k)
}

fn surface(random: &mut Random) -> Input {
    let k = 1.0 - random.sign() * random.log(1e-6, 0.01);
    at_radius(random, k)
}

fn unit(x: &Wide) -> Output {
    three(map(x) * (xyz(x[5]) - xyz(x[3])))
}

/// (1 - k) / |grad k|, with grad k = M^T u / k.
fn depth(x: &Wide) -> f64 {
    let u = xyz(x[5]);
    (1.0 - u.length()) * u.length() / (map(x).transpose() * u).length()
}

/// The closest approach as the height of the parallelogram of o and v: |o x v| / |v|.
fn chord(x: &Wide) -> Output {
    let m = map(x);
    let (o, v) = (m * (xyz(x[5]) - xyz(x[3])), m * xyz(x[6]));
    let closest = o.cross(v).length() / v.length();
    let left = (x[7][2] - closest) * (x[7][2] + closest);
    // What rounding the rows and the point to f32 makes of the closest approach, 4 times: a graze
    // decides between a hit and a miss by it, and is not compared.
    let steepest = x[..3].iter().map(|row| row[3].abs()).fold(0.0, f64::max);
    let blur = 4.0 * f64::from(f32::EPSILON) * steepest * (xyz(x[5]).length() + xyz(x[3]).length());
    if left.abs() < blur * (closest + blur) {
        return [f64::NAN; 4];
    }
    if left < 0.0 {
        return two(f64::from(1e30f32), f64::from(-1e30f32));
    }
    let (middle, half) = (-o.dot(v) / v.length_squared(), left.sqrt() / v.length());
    two(middle - half, middle + half)
}

pub fn twins() -> Vec<Twin> {
    vec![
        Twin::new(
            "ellipsoid_unit",
            "ellipsoid",
            "return vec4f(ellipsoid_unit(make(x), x[5].xyz, 1.0), 0.0);",
            unit,
        )
        .declaring(MAKE)
        .edges(edges(false, ALL))
        .over("close", close_up)
        .over("far", far),
        Twin::new("ellipsoid_depth", "ellipsoid", "return vec4f(ellipsoid_depth(make(x), x[5].xyz));", |x| {
            one(depth(x))
        })
        .declaring(MAKE)
        .edges(edges(true, OFF_CENTER))
        .over("within", within)
        .over("surface", surface),
        Twin::new(
            "ellipsoid_normal",
            "ellipsoid",
            "return vec4f(ellipsoid_normal(make(x), x[5].xyz), 0.0);",
            |x| three((map(x).transpose() * xyz(x[5])).normalize()),
        )
        .declaring(MAKE)
        .edges(edges(true, OFF_CENTER))
        .over("within", within),
        Twin::new(
            "ellipsoid_chord",
            "ellipsoid",
            "return vec4f(ellipsoid_chord(make(x), x[5].xyz, x[6].xyz, x[7].z), 0.0, 0.0);",
            chord,
        )
        .declaring(MAKE)
        .edges(edges(false, ALL))
        .over("close", close_up)
        .over("far", far)
        .over("specks", speck)
        .over("grazes", graze),
        Twin::new(
            "noise_coordinate",
            "noise",
            "return vec4f(noise_coordinate(x[0], x[1], x[2], x[5].xyz), 0.0);",
            |x| three(DVec3::from([0, 1, 2].map(|i| xyz(x[i]).dot(xyz(x[5])) + x[i][3]))),
        )
        .edges(edges(false, ALL))
        .over("far", far),
        Twin::new(
            "ellipsoid_facing",
            "ellipsoid",
            "return ellipsoid_facing(make(x), x[5].xyz);",
            |x| {
                let (u, normal) = (xyz(x[5]), (map(x).transpose() * xyz(x[5])).normalize());
                let k = u.length_squared();
                vector((1.0 - k).max(0.0) * k * normal, (1.0 - k).max(0.0))
            },
        )
        .declaring(MAKE)
        .edges(edges(true, OFF_CENTER))
        .over("within", within),
        Twin::new("ellipsoid_thinnest", "ellipsoid", "return vec4f(ellipsoid_thinnest(make(x)));", |x| {
            one(x[..3].iter().map(|row| row[3].recip()).fold(f64::INFINITY, f64::min))
        })
        .declaring(MAKE)
        .over("within", within),
        Twin::new("ellipsoid_boundary", "ellipsoid", "return vec4f(ellipsoid_boundary(make(x), x[7].x));", |x| {
            // No thicker than its smallest radius, and a part of one of its edges.
            let smallest = x[..3].iter().map(|row| row[3].recip()).fold(f64::INFINITY, f64::min);
            one(x[4][0].min(smallest) / (x[4][0] * x[7][0]).max(1.0))
        })
        .declaring(MAKE)
        .over("all", |random| {
            let mut x = within(random);
            x[7][0] = random.log(1e-4, 1.0) as f32;
            x
        }),
        Twin::new(
            "light_ray_at",
            "lighting",
            "return vec4f(light_ray_at(LightRay(x[0].xyz, x[1].xyz, vec3f(0.0), Region(), Species(), x[1].w), x[0].w), 0.0);",
            |x| three(xyz(x[0]) + x[0][3] * xyz(x[1]) + x[1][3] * x[0][3] * x[0][3] * DVec3::Y),
        )
        .over("all", |random| {
            let t = random.log(1e-3, 1e6);
            let origin = random.log(1e-3, 1e5) * random.direction();
            input([vector(origin, t), vector(random.direction(), random.between(0.0, 8e-8))])
        }),
    ]
}
