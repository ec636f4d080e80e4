//! Boxes of voxels, fields of cells, and random numbers.

use glam::{DMat3, DVec3};

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{grid, input, line, one, plane, scalars, three, two, vector, xyz};

/// PCG RXS-M-XS with 32 bits (O'Neill 2014): output and next state.
fn pcg(state: u32) -> (u32, u32) {
    let next = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((next >> ((next >> 28) + 4)) ^ next).wrapping_mul(277_803_737);
    ((word >> 22) ^ word, next)
}

fn seeds() -> Vec<Input> {
    grid(&[0.0, 1.0, 77.0, 16_777_215.0], &[0.0, 5.0, 1e6], &[0.0, 3.0], &[0.0])
}

fn seed(random: &mut Random) -> Input {
    scalars([(); 3].map(|()| random.between(0.0, 16_777_216.0).floor()))
}

/// Unpacks a box whose columns lean.
const LEANING: &str = "
    fn leaning(x: array<vec4f, 8>) -> LightBox {
        return LightBox(x[0].xyz, 1.0, x[3].xyz, x[6].w, x[4].xyz, 0.0, x[5].xyz, 0.0, x[6].xyz, 0.0, x[7].xyz, 0.0,
            vec3f(x[3].w, x[4].w, x[5].w), 0.0);
    }";

/// Packs a box: its corner, a point and coordinates in it, rows of its map (w: the direction of
/// the columns), edges across (w: the length of the columns).
fn leaning(corner: DVec3, across: DMat3, size: DVec3, along: DVec3, uvw: DVec3) -> Input {
    let edges = DMat3::from_cols(size.x * across.x_axis, size.y * across.y_axis, size.z * along);
    let rows = edges.inverse().transpose();
    input([
        vector(corner, 0.0),
        vector(corner + edges * uvw, 0.0),
        vector(uvw, 0.0),
        vector(rows.x_axis, along.x),
        vector(rows.y_axis, along.y),
        vector(rows.z_axis, along.z),
        vector(edges.x_axis, size.z),
        vector(edges.y_axis, 0.0),
    ])
}

/// Boxes of 1 m to 100 km, up to 100 km away, whose columns lean up to 80 degrees.
fn boxed(random: &mut Random) -> Input {
    let across = random.turn();
    let lean = random.between(0.0, 1.4);
    let along = random.direction_off(across.z_axis, lean);
    let size = DVec3::from([(); 3].map(|()| random.log(1.0, 1e5)));
    let uvw = DVec3::from([(); 3].map(|()| random.between(0.0, 1.0)));
    let corner = random.log(0.1, 1e5) * random.direction();
    leaning(corner, across, size, along, uvw)
}

fn corners() -> Vec<Input> {
    let mut list = Vec::new();
    for corner in [DVec3::ZERO, DVec3::new(5.0, 90.0, -12.0)] {
        for uvw in grid(&[0.0, 0.3, 1.0], &[-0.1, 1.0], &[0.0, 0.7], &[0.0]) {
            let across = DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y);
            let uvw = DVec3::from([0, 1, 2].map(|i| f64::from(uvw[0][i])));
            let along = DVec3::new(0.3, 0.8, -0.6).normalize();
            list.push(leaning(corner, across, DVec3::new(20.0, 30.0, 40.0), along, uvw));
        }
    }
    list
}

/// Slopes of a surface in the place of coordinates.
fn sloping(random: &mut Random) -> Input {
    let mut x = boxed(random);
    for slope in &mut x[2][..2] {
        *slope = (random.sign() * random.log(1e-3, 1e3)) as f32;
    }
    x
}

fn rows(x: &Wide) -> DMat3 {
    DMat3::from_cols(xyz(x[3]), xyz(x[4]), xyz(x[5])).transpose()
}

fn along(x: &Wide) -> DVec3 {
    DVec3::new(x[3][3], x[4][3], x[5][3])
}

/// A point of the surface moves with either way across by the way itself and the slope along the
/// light; the normal has no part in either.
fn normal(x: &Wide) -> DVec3 {
    let along = along(x);
    let u = xyz(x[6]).normalize() + x[2][0] * along;
    let v = xyz(x[7]).normalize() + x[2][1] * along;
    let n = v.cross(u).normalize();
    if n.dot(along) > 0.0 { -n } else { n }
}

/// A field of 5 by 7 by 4 cells in WGSL.
const FIELD: &str = "
    fn field() -> Field {
        return Field(vec3f(0.0), 48u, vec3f(1.0), 1u, vec3u(5u, 7u, 4u), 0.0, vec4f(0.0), vec4f(0.0), vec4f(0.0), 0u, 0u, 0u, 0u);
    }";

pub fn twins() -> Vec<Twin> {
    let mut all = boxes();
    all.extend(fields());
    all.extend(numbers());
    all.extend(depths());
    all
}

/// A volume of 3 by 2 slots whose bricks are 40 m.
const DEPTHS: &str = "fn volume() -> DepthVolume {
    return DepthVolume(vec3f(-10.0, 20.0, 5.0), 40.0, vec3u(5u, 4u, 3u), 0.05, vec3f(0.01, 0.02, 0.04), 30.0,
        vec2u(3u, 2u), 5.0, 60.0);
}";

/// Where the slot of a brick begins, texels.
fn slot(brick: f64) -> DVec3 {
    9.0 * DVec3::new(brick % 3.0, (brick / 3.0).floor() % 2.0, (brick / 6.0).floor())
}

/// A place in a brick of which others are some bricks away, and a direction.
fn clear_place(random: &mut Random) -> Input {
    let brick = DVec3::from([0; 3].map(|_| random.index(9) as f64));
    let inside = DVec3::from([0; 3].map(|_| random.between(0.01, 0.99)));
    input([
        vector(brick + inside, 1.0 + random.index(4) as f64),
        vector(random.direction(), 0.0),
        vector(brick, 0.0),
    ])
}

/// The way to the nearest wall of the cube of empty bricks around the place's own.
fn clear_way(x: &Wide) -> f64 {
    clear_within(x, x[0][3])
}

/// The same of a cube of so many bricks each way.
fn clear_within(x: &Wide, far: f64) -> f64 {
    let (place, direction, brick) = (xyz(x[0]), xyz(x[1]), xyz(x[2]));
    let ways = (0..3).map(|i| {
        let wall = if direction[i] > 0.0 { brick[i] + far } else { brick[i] + 1.0 - far };
        (wall - place[i]) / direction[i]
    });
    40.0 * ways.fold(f64::INFINITY, f64::min)
}

/// Tells extinction, depth, steady and clear way of a place, a direction, a brick and a texel.
const CERTAIN: &str = "let at = DepthPlace(x[0].xyz, x[2].xyz, u32(x[4].x) << 30u | u32(x[0].w));
    let m = depth_certain(volume(), at, x[3], x[1].xyz); return vec4f(m.extinction, m.depth, m.steady, m.clear);";

/// Clear air as far as the index tells, or as the depth does; the core; or not certain.
fn certain(x: &Wide) -> Output {
    match (x[4][0] as u32, x[3][0]) {
        (0, _) => [0.0, -40.0, 0.0, clear_way(x)],
        // Steady up to the wall of its own brick.
        (1, _) => [f64::from(0.05f32), 1e4, clear_within(x, 1.0), 0.0],
        (_, depth) if depth > 0.0 => [-1.0, depth, 0.0, 0.0],
        (_, depth) => [0.0, depth, 0.0, -depth],
    }
}

fn depths() -> Vec<Twin> {
    vec![
        Twin::new("depth_kind", "depth_volume", "return vec4f(f32(depth_kind(u32(x[0].x) << 30u | u32(x[0].y))));", |x| {
            one(x[0][0])
        })
        .exact()
        .edges(plane(&[0.0, 1.0, 2.0], &[0.0, 7.0, 2047.0])),
        Twin::new(
            "depth_number",
            "depth_volume",
            "return vec4f(f32(depth_number(u32(x[0].x) << 30u | u32(x[0].y))));",
            |x| one(x[0][1]),
        )
        .exact()
        .edges(plane(&[0.0, 1.0, 2.0], &[0.0, 7.0, 2047.0])),
        Twin::new("depth_slot", "depth_volume", "return vec4f(vec3f(depth_slot(volume(), u32(x[0].x))), 0.0);", |x| {
            three(slot(x[0][0]))
        })
        .declaring(DEPTHS)
        .exact()
        .edges(line(&[0.0, 1.0, 2.0, 3.0, 5.0, 6.0, 11.0, 17.0])),
        Twin::new(
            "depth_coordinate",
            "depth_volume",
            "return vec4f(depth_coordinate(volume(), u32(x[0].w), x[0].xyz), 0.0);",
            |x| three((slot(x[0][3]) + 0.5 + 8.0 * xyz(x[0])) * DVec3::new(0.01, 0.02, 0.04)),
        )
        .declaring(DEPTHS)
        .edges(grid(&[0.0, 0.3, 1.0], &[0.0, 0.5, 1.0], &[0.2, 1.0], &[0.0, 4.0, 11.0])),
        Twin::new(
            "depth_edge",
            "depth_volume",
            "let e = depth_edge(volume(), x[0]); return vec4f(e.depth, e.extinction, e.boundary, e.wispiness);",
            |x| {
                let [depth, share, boundary, wispiness] = x[0];
                [depth, f64::from(0.05f32) * share, boundary, wispiness]
            },
        )
        .declaring(DEPTHS)
        .edges(grid(&[5.0], &[0.03, 1.0], &[0.0, 20.0, 300.0], &[0.0, 0.4, 1.0])),
        Twin::new(
            "depth_clear",
            "depth_volume",
            "return vec4f(depth_clear(volume(), x[0].xyz, x[2].xyz, u32(x[0].w), x[1].xyz));",
            |x| one(clear_way(x)),
        )
        .declaring(DEPTHS)
        .over("all", clear_place),
        Twin::new(
            "depth_boundary",
            "depth_volume",
            "var v = volume(); v.boundary = x[0].x; return vec4f(depth_boundary(v, x[0].y));",
            |x| {
                // No thicker than the noise's largest features.
                let [boundary, frequency, ..] = x[0];
                one(if boundary * frequency > 1.0 { 1.0 / frequency } else { boundary })
            },
        )
        .declaring(DEPTHS)
        .edges(plane(&[0.0, 30.0, 300.0], &[0.0, 0.01, 0.1]))
        .over("all", |random| scalars([random.log(0.01, 1e3), random.log(1e-4, 1.0)])),
        Twin::new("depth_certain", "depth_volume", CERTAIN, certain)
            .declaring(DEPTHS)
            .over("all", |random| {
                let mut x = clear_place(random);
                let texel = vector(DVec3::new(random.between(-40.0, 40.0), 0.05, 20.0), 0.4);
                (x[3], x[4]) = (input([texel])[0], scalars([random.index(3) as f64])[0]);
                x
            }),
        Twin::new(
            "depth_facing",
            "depth_volume",
            "return vec4f(depth_facing(volume(), x[0].xyz, x[0].w), 0.0);",
            |x| {
                // Four bricks of 40 m below the boundary there is no facing left.
                let deep = (1.0 - x[0][3].max(0.0) / 160.0).max(0.0);
                three(-deep * xyz(x[0]).normalize())
            },
        )
        .declaring(DEPTHS)
        .over("all", |random| {
            let slope = random.log(1e-3, 1e2) * random.direction();
            input([vector(slope, random.between(-40.0, 200.0))])
        }),
    ]
}

fn boxes() -> Vec<Twin> {
    vec![
        Twin::new(
            "light_box_coordinate",
            "light_box",
            "return vec4f(light_box_coordinate(leaning(x), x[1].xyz), 0.0);",
            |x| three(rows(x) * (xyz(x[1]) - xyz(x[0]))),
        )
        .declaring(LEANING)
        .edges(corners())
        .over("all", boxed),
        Twin::new(
            "light_box_coordinate",
            "light_box",
            "var box = leaning(x); box.repeat = 0.75; return vec4f(light_box_coordinate(box, x[1].xyz), 0.0);",
            |x| {
                let inside = rows(x) * (xyz(x[1]) - xyz(x[0]));
                // An eighth of the box stands on each side of what repeats itself.
                let around = |u: f64| 0.125 + (u - 0.125).rem_euclid(0.75);
                three(DVec3::new(around(inside.x), around(inside.y), inside.z))
            },
        )
        .declaring(LEANING)
        .over("repeating", |random| {
            let mut x = boxed(random);
            let at = [(); 3].map(|()| random.between(0.15, 0.85));
            let of = x.map(|row| row.map(f64::from));
            let p = xyz(of[0]) + at[0] * xyz(of[6]) + at[1] * xyz(of[7]) + at[2] * of[6][3] * along(&of);
            x[1] = [p.x as f32, p.y as f32, p.z as f32, x[1][3]];
            x
        }),
        Twin::new(
            "light_box_entered",
            "light_box",
            "return vec4f(light_box_entered(x[0].xyz, 8u));",
            |x| {
                let [u, v, w, _] = x[0];
                let beside = [u, v].iter().any(|at| !(0.0..=1.0).contains(at));
                // The middle of the first of eight slices is at a sixteenth.
                one(if beside { 0.0 } else { (16.0 * w).clamp(0.0, 1.0) })
            },
        )
        .edges(grid(&[-0.01, 0.0, 0.5, 1.0], &[0.25, 1.01], &[-1.0, 0.0, 0.03, 0.0625, 1.0, 9.0], &[0.0])),
        Twin::new(
            "light_box_point",
            "light_box",
            "return vec4f(light_box_point(leaning(x), x[2].xyz), 0.0);",
            |x| three(xyz(x[0]) + x[2][0] * xyz(x[6]) + x[2][1] * xyz(x[7]) + x[2][2] * x[6][3] * along(x)),
        )
        .declaring(LEANING)
        .edges(corners())
        .over("all", boxed),
        Twin::new(
            "light_box_bricks",
            "light_box",
            "return vec4f(vec3f(light_box_bricks(vec3u(x[0].xyz))), 0.0);",
            |x| three((xyz(x[0]).floor() / 8.0).ceil()),
        )
        .exact()
        .edges(grid(&[1.0, 8.0, 9.0, 128.0], &[7.0, 16.0], &[8.0, 65.0], &[0.0])),
        Twin::new(
            "light_box_brick",
            "light_box",
            "return vec4f(f32(light_box_brick(vec3u(20u, 8u, 33u), x[0].xyz)), 0.0, 0.0, 0.0);",
            |x| {
                // 3, 1 and 5 bricks.
                let size = DVec3::new(20.0, 8.0, 33.0);
                let voxel = (xyz(x[0]) * size).floor().clamp(DVec3::ZERO, size - 1.0);
                let brick = (voxel / 8.0).floor();
                one(brick.x + 3.0 * (brick.y + brick.z))
            },
        )
        .exact()
        .edges(grid(
            &[-0.3, 0.0, 0.39, 0.41, 1.0],
            &[0.0, 0.99, 2.0],
            &[-0.1, 0.24, 0.26, 0.98, 1.0],
            &[0.0],
        )),
        Twin::new(
            "covered_slope",
            "light_box",
            "return vec4f(covered_slope(Surface(x[0].x, x[1].x), Surface(x[0].y, x[1].y),
                Surface(x[0].z, x[1].z), x[0].w));",
            |x| {
                // Both rises, each by what is covered on both of its sides.
                let ([a, b, c, texel], cover) = (x[0], x[1]);
                let (before, after) = (cover[0].min(cover[1]), cover[1].min(cover[2]));
                let rise = before * (b - a) / texel + after * (c - b) / texel;
                one((rise / (before + after).max(f64::from(1e-4f32))).clamp(-1.5, 1.5))
            },
        )
        .edges(grid(&[10.0], &[10.0, 12.0], &[9.0, 400.0], &[0.5, 30.0]))
        .over("all", |random| {
            let depth = random.log(1.0, 1e4);
            let texel = random.log(0.1, 100.0);
            let around = [(); 2].map(|()| depth + texel * random.between(-3.0, 3.0));
            let cover = [(); 3].map(|()| [0.0, 1.0, random.between(0.0, 1.0)][random.index(3)]);
            input([[around[0], depth, around[1], texel], [cover[0], cover[1], cover[2], 0.0]])
        }),
        Twin::new(
            "light_box_normal",
            "light_box",
            "return vec4f(light_box_normal(leaning(x), x[2].x, x[2].y), 0.0);",
            |x| three(normal(x)),
        )
        .declaring(LEANING)
        .edges(corners())
        .over("all", sloping),
    ]
}

fn fields() -> Vec<Twin> {
    vec![
        Twin::new("field_cells", "field", "return vec4f(f32(field_cells(field())));", |_| one(140.0))
            .declaring(FIELD)
            .exact()
            .edges(line(&[0.0])),
        Twin::new("field_index", "field", "return vec4f(f32(field_index(field(), vec3u(x[0].xyz))));", |x| {
            let at = xyz(x[0]).floor();
            one(at.x + 5.0 * (at.y + 7.0 * at.z))
        })
        .declaring(FIELD)
        .exact()
        .edges(grid(&[0.0, 4.0], &[0.0, 3.0, 6.0], &[0.0, 3.0], &[0.0])),
        Twin::new(
            "field_place",
            "field",
            "return vec4f(vec3f(field_place(field(), u32(x[0].x))), 0.0);",
            |x| {
                let index = x[0][0].floor();
                three(DVec3::new(index % 5.0, (index / 5.0).floor() % 7.0, (index / 35.0).floor()))
            },
        )
        .declaring(FIELD)
        .exact()
        .edges(line(&[0.0, 4.0, 5.0, 34.0, 35.0, 139.0])),
        // Three fields of four layers: half a texel is left to the neighbours.
        Twin::new(
            "field_coordinate",
            "field",
            "return vec4f(field_coordinate(vec3f(0.2, 0.7, x[0].x), 12.0, u32(x[0].y), 3u), 0.0);",
            |x| {
                let [unit, block, ..] = x[0];
                let [u, v] = [0.2f32, 0.7].map(f64::from);
                three(DVec3::new(u, v, (block.floor() + unit.clamp(0.125, 0.875)) / 3.0))
            },
        )
        .edges(plane(&[0.0, 0.1, 0.5, 0.8, 1.0], &[0.0, 1.0, 2.0]))
        .over("all", |random| scalars([random.between(0.0, 1.0), random.index(3) as f64])),
    ]
}

fn numbers() -> Vec<Twin> {
    vec![
        Twin::new(
            "next_random",
            "path_random",
            "var s = u32(x[0].x); let r = next_random(&s); return vec4f(f32(r >> 8u), f32(s >> 8u), 0.0, 0.0);",
            |x| {
                let (word, state) = pcg(x[0][0] as u32);
                two(f64::from(word >> 8), f64::from(state >> 8))
            },
        )
        .exact()
        .edges(seeds())
        .over("all", seed),
        Twin::new("uniform_random", "path_random", "var s = u32(x[0].x); return vec4f(uniform_random(&s));", |x| {
            one(f64::from(pcg(x[0][0] as u32).0 >> 8) / 16_777_216.0)
        })
        .exact()
        .edges(seeds())
        .over("all", seed),
        Twin::new(
            "hash_random",
            "path_random",
            "return vec4f(f32(hash_random(u32(x[0].x), u32(x[0].y), u32(x[0].z)) >> 8u));",
            |x| {
                let [pixel, sample, seed] = [0, 1, 2].map(|i| x[0][i] as u32);
                let first = pcg(pixel.wrapping_mul(1_597_334_677).wrapping_add(seed)).0;
                one(f64::from(pcg(first ^ sample.wrapping_mul(3_812_015_801)).0 >> 8))
            },
        )
        .exact()
        .edges(seeds())
        .over("all", seed),
        Twin::new("interleaved_gradient", "random", "return vec4f(interleaved_gradient(x[0].xy));", |x| {
            let [a, b, c] = [0.06711056f32, 0.00583715, 52.982_918].map(f64::from);
            let inner = a * x[0][0] + b * x[0][1];
            let outer = c * inner.fract();
            // Where rounding decides between 0 and 1, no number is right.
            let near = (inner - inner.round()).abs() < 1e-3
                || (outer - outer.round()).abs() < 0.05;
            one(if near { f64::NAN } else { outer.fract() })
        })
        .edges(plane(&[0.5, 1.5, 7.5], &[0.5, 2.5]))
        .over("pixels", |random| scalars([(); 2].map(|()| random.between(0.0, 16_384.0).floor() + 0.5)))
        // The fraction of numbers up to 52.98 by 0.067 by 16 384.
        .beside(6e4),
    ]
}
