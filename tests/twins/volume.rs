//! Volumes that other programs made: places among their bricks, levels, and steps.

use glam::DVec3;

use crate::harness::{Input, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, plane, scalars, three, vector, xyz};

/// A volume of two levels whose bricks lie askew, with an atlas of 3 by 2 slots.
const MAKE: &str = "fn make(x: array<vec4f, 8>) -> Volume {
    var levels = array<vec4u, 8>();
    levels[0] = vec4u(5u, 4u, 3u, 0u);
    levels[1] = vec4u(3u, 2u, 2u, 60u);
    levels[2] = vec4u(2u, 1u, 1u, 72u);
    return Volume(x[0], x[1], x[2], vec3f(0.01, 0.02, 0.04), 0.05, vec2u(3u, 2u), 20.0, 3u, 60.0, 1u, 0.0, 0.0, levels);
}";

/// Rows of the map to bricks, and a point or a direction.
fn placed(random: &mut Random) -> Input {
    let turn = random.turn();
    let size = random.log(1e-4, 1.0);
    let rows = [turn.x_axis, turn.y_axis, turn.z_axis].map(|row| size * row);
    let shift = 10.0 * random.ball();
    let p = random.log(1.0, 1e4) * random.direction();
    input([vector(rows[0], shift.x), vector(rows[1], shift.y), vector(rows[2], shift.z), vector(p, 0.0)])
}

/// What rows make of the vector in x[3], and of 1.
fn mapped(x: &Wide, one: f64) -> DVec3 {
    DVec3::from([0, 1, 2].map(|i| xyz(x[i]).dot(xyz(x[3])) + one * x[i][3]))
}

/// A place among bricks, and a way in bricks each metre.
fn going(random: &mut Random) -> Input {
    let brick = DVec3::from([0; 3].map(|_| random.index(9) as f64));
    let inside = DVec3::from([0; 3].map(|_| random.between(0.01, 0.99)));
    let way = random.log(1e-4, 1.0) * random.direction();
    input([vector(brick + inside, 0.0), vector(way, 0.0)])
}

/// The brick that a ray goes on in: behind walls that are as near as a ten thousandth of a brick.
fn ahead(x: &Wide) -> DVec3 {
    let (place, way) = (xyz(x[0]), xyz(x[1]));
    let nudge = f64::from(1e-4f32);
    DVec3::from([0, 1, 2].map(|i| (place[i] + if way[i] > 0.0 { nudge } else { -nudge }).floor()))
}

fn exit(x: &Wide) -> f64 {
    let (place, brick, way) = (xyz(x[0]), xyz(x[2]), xyz(x[1]));
    let wall = |i: usize| brick[i] + if way[i] > 0.0 { 1.0 } else { 0.0 };
    (0..3).map(|i| (wall(i) - place[i]) / way[i]).fold(f64::INFINITY, f64::min)
}

pub fn twins() -> Vec<Twin> {
    [places(), bricks(), steps(), fields()].into_iter().flatten().collect()
}

fn places() -> Vec<Twin> {
    vec![
        Twin::new("volume_place", "volume", "return vec4f(volume_place(make(x), x[3].xyz), 0.0);", |x| {
            three(mapped(x, 1.0))
        })
        .declaring(MAKE)
        .over("all", placed),
        Twin::new("volume_way", "volume", "return vec4f(volume_way(make(x), x[3].xyz), 0.0);", |x| {
            three(mapped(x, 0.0))
        })
        .declaring(MAKE)
        .over("all", placed),
        Twin::new("volume_ahead", "volume", "return vec4f(volume_ahead(x[0].xyz, x[1].xyz), 0.0);", |x| {
            three(ahead(x))
        })
        .exact()
        .over("all", going)
        .edges(vec![
            // On a wall, and as good as on one, going either way or along it.
            input([vector(DVec3::new(2.0, 3.0, 5.0), 0.0), vector(DVec3::new(1.0, -1.0, 0.0), 0.0)]),
            input([
                vector(DVec3::new(1.99995, 3.00005, 5.5), 0.0),
                vector(DVec3::new(1e-9, -1e-9, 1.0), 0.0),
            ]),
        ]),
        Twin::new("volume_exit", "volume", "return vec4f(volume_exit(x[0].xyz, x[2].xyz, x[1].xyz));", |x| {
            one(exit(x))
        })
        .over("all", |random| {
            let mut x = going(random);
            let brick = ahead(&x.map(|row| row.map(f64::from)));
            x[2] = input([vector(brick, 0.0)])[0];
            x
        }),
        Twin::new("volume_level", "volume", "return vec4f(f32(volume_level(make(x), x[0].x)));", |x| {
            // Voxels that are up to 60 m long, 120 and 240.
            one([120.0, 240.0].iter().filter(|voxel| x[0][0] >= **voxel).count() as f64)
        })
        .declaring(MAKE)
        .exact()
        .edges(line(&[0.0, 1.0, 20.0, 60.0, 119.9, 120.1, 239.9, 240.1, 481.0, 1e9])),
        Twin::new("volume_scale", "volume", "return vec4f(volume_scale(u32(x[0].x)));", |x| {
            one(0.5_f64.powi(x[0][0] as i32))
        })
        .exact()
        .edges(line(&[0.0, 1.0, 2.0, 7.0])),
    ]
}

fn bricks() -> Vec<Twin> {
    vec![
        Twin::new(
            "volume_holds",
            "volume",
            "return vec4f(f32(volume_holds(make(x), u32(x[0].w), x[0].xyz)));",
            |x| {
                let size = [DVec3::new(5.0, 4.0, 3.0), DVec3::new(3.0, 2.0, 2.0)][x[0][3] as usize];
                let inside = xyz(x[0]).cmpge(DVec3::ZERO).all() && xyz(x[0]).cmplt(size).all();
                one(f64::from(u8::from(inside)))
            },
        )
        .declaring(MAKE)
        .exact()
        .edges(grid(&[-1.0, 0.0, 2.0, 4.0, 5.0], &[-1.0, 1.0, 3.0], &[0.0, 2.0, 3.0], &[0.0, 1.0])),
        Twin::new(
            "volume_entry",
            "volume",
            "return vec4f(f32(volume_entry(make(x), u32(x[0].w), x[0].xyz)));",
            |x| {
                let (first, size) = [(0.0, [5.0, 4.0]), (60.0, [3.0, 2.0])][x[0][3] as usize];
                one(first + x[0][0] + size[0] * (x[0][1] + size[1] * x[0][2]))
            },
        )
        .declaring(MAKE)
        .exact()
        .edges(grid(&[0.0, 2.0], &[0.0, 1.0], &[0.0, 1.0], &[0.0, 1.0])),
        Twin::new(
            "volume_number",
            "volume",
            "return vec4f(f32(volume_number(u32(x[0].x) << 24u | u32(x[0].y))));",
            |x| one(x[0][1]),
        )
        .exact()
        .edges(plane(&[1.0, 255.0], &[0.0, 7.0, 16777215.0])),
        Twin::new(
            "volume_most",
            "volume",
            "return vec4f(volume_most(make(x), u32(x[0].x) << 24u | u32(x[0].y)));",
            |x| one(f64::from(0.05f32) * x[0][0] / 255.0),
        )
        .declaring(MAKE)
        .edges(plane(&[1.0, 100.0, 255.0], &[0.0, 7.0, 16777215.0])),
        Twin::new(
            "volume_coordinate",
            "volume",
            "return vec4f(volume_coordinate(make(x), u32(x[0].w), x[0].xyz), 0.0);",
            |x| {
                let n = x[0][3];
                let slot = 9.0 * DVec3::new(n % 3.0, (n / 3.0).floor() % 2.0, (n / 6.0).floor());
                three((slot + 0.5 + 8.0 * xyz(x[0])) * DVec3::new(0.01, 0.02, 0.04))
            },
        )
        .declaring(MAKE)
        .edges(grid(&[0.0, 0.3, 1.0], &[0.0, 0.5, 1.0], &[0.2, 1.0], &[0.0, 4.0, 11.0])),
    ]
}

fn steps() -> Vec<Twin> {
    vec![
        Twin::new(
            "volume_boundary",
            "volume",
            "return vec4f(volume_boundary(make(x), u32(x[0].x), x[0].y));",
            |x| {
                let voxel = 20.0 * 2_f64.powi(x[0][0] as i32);
                // Six voxels where one is clear, three from an optical depth of 0.05 on.
                let thick = (x[0][1] * voxel / f64::from(0.05f32)).min(1.0);
                one(voxel * (6.0 - 3.0 * thick))
            },
        )
        .declaring(MAKE)
        .edges(plane(&[0.0, 1.0, 2.0], &[0.0, 1e-4, 1e-3, 0.1]))
        .over("all", |random| scalars([random.index(3) as f64, random.log(1e-6, 1.0)])),
        Twin::new(
            "volume_matter",
            "volume",
            "let m = volume_matter(make(x), x[0].x, 3u); return vec4f(m.extinction, m.depth, m.steady, f32(m.body));",
            |x| [x[0][0], if x[0][0] > 0.0 { 20.0 } else { -20.0 }, 0.0, 3.0],
        )
        .declaring(MAKE)
        .edges(line(&[0.0, 1e-6, 0.05, 1e3])),
        Twin::new("volume_facing", "volume", "return vec4f(volume_facing(make(x), x[0].xyz), 0.0);", |x| {
            // Of length 1 but where hardly anything changes: a thousandth of the greatest extinction.
            let slope = xyz(x[0]);
            three(-slope / slope.length().max(f64::from(1e-3f32) * f64::from(0.05f32)))
        })
        .declaring(MAKE)
        .over("all", |random| input([vector(random.log(1e-6, 1e-1) * random.direction(), 0.0)])),
    ]
}

fn fields() -> Vec<Twin> {
    vec![
        Twin::new("volume_fields", "volume", "return volume_fields(make(x), x[3]);", |x| {
            x[3].map(|share| f64::from(0.05f32) * share)
        })
        .declaring(MAKE)
        .over("all", |random| {
            let mut x = input([]);
            x[3] = [0; 4].map(|_| random.between(0.0, 1.0) as f32);
            x
        }),
        Twin::new("volume_field", "volume", "return vec4f(f32(volume_field(x[0], x[1].x)));", |x| {
            let whole: f64 = x[0].iter().sum();
            let mut below = 0.0;
            let passed = |share: &&f64| {
                below += **share;
                x[1][0] * whole >= below
            };
            one(if whole > 0.0 { x[0][..3].iter().filter(passed).count() as f64 } else { 0.0 })
        })
        .exact()
        .edges(vec![
            input([vector(DVec3::ZERO, 0.0), vector(DVec3::ZERO, 0.0)]),
            input([vector(DVec3::X, 0.0), vector(DVec3::new(0.9999999, 0.0, 0.0), 0.0)]),
            input([vector(DVec3::Y, 0.0), vector(DVec3::ZERO, 0.0)]),
            input([vector(DVec3::ZERO, 1.0), vector(DVec3::new(0.5, 0.0, 0.0), 0.0)]),
            input([vector(DVec3::new(1.0, 2.0, 1.0), 4.0), vector(DVec3::new(0.25, 0.0, 0.0), 0.0)]),
        ])
        .over("all", |random| {
            let fields = DVec3::from([0; 3].map(|_| random.between(0.1, 1.0)));
            // Off the borders, which rounding may move.
            let whole = fields.element_sum() + 0.5;
            let borders = [fields.x, fields.x + fields.y, fields.element_sum()].map(|border| border / whole);
            let mut chance = random.between(0.0, 0.99);
            while borders.iter().any(|border| (chance - border).abs() < 1e-5) {
                chance = random.between(0.0, 0.99);
            }
            input([vector(fields, 0.5), vector(DVec3::new(chance, 0.0, 0.0), 0.0)])
        }),
        Twin::new("volume_chance", "volume", "return vec4f(volume_chance(x[0].xyz));", |x| {
            let bits = [0, 1, 2].map(|i| (x[0][i] as f32).to_bits());
            let factors = [747_796_405_u32, 2_891_336_453, 277_803_737];
            let mut hash =
                bits.iter().zip(factors).fold(0_u32, |sum, (bits, f)| sum.wrapping_add(bits.wrapping_mul(f)));
            hash = (hash ^ hash >> 16).wrapping_mul(2_146_121_005);
            hash = (hash ^ hash >> 15).wrapping_mul(2_221_713_035);
            one(f64::from((hash ^ hash >> 16) >> 8) / f64::from(1 << 24))
        })
        .exact()
        .over("all", |random| input([vector(random.log(1e-3, 1e5) * random.direction(), 0.0)])),
    ]
}
