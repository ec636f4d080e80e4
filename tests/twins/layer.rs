//! Layers: heights of their heaps and sheets, and rays over a round earth.
//!
//! A layer is packed in x[0] to x[3], as `MAKE` has it; the field at a place in x[4]; a height, or a ray, in x[5].

use crate::harness::{Input, Output, Random, Twin, Wide};
use crate::pack::{input, one, three, two, xyz};

const MAKE: &str = "fn make(x: array<vec4f, 8>) -> Layer {
    return Layer(x[0].x, x[0].y, x[0].z, x[0].w, x[1].x, x[1].y, x[1].z, x[1].w, x[2].x, x[2].y, x[2].z, x[2].w,
        x[3].x, x[3].y, x[3].z, 0.0);
}
fn field(x: array<vec4f, 8>) -> LayerField {
    return LayerField(x[4].x, x[4].yz, x[4].w);
}";

/// A layer in numbers.
struct Layer {
    top: f64,
    bottom: f64,
    begin: f64,
    rise: f64,
    sheet: f64,
    flat: f64,
    round: f64,
    steepest: f64,
}

impl Layer {
    fn of(x: &Wide) -> Self {
        let [top, bottom, begin, rise] = [x[0][1], x[0][2], x[1][2], x[1][3]];
        let [sheet, flat, round, steepest] = x[2];
        Self { top, bottom, begin, rise, sheet, flat, round, steepest }
    }

    /// The most height of a part of this `share`.
    fn most(&self, share: f64, height: f64) -> f64 {
        share * if height > 0.0 { self.top } else { self.bottom }
    }

    /// Field above `begin` that a part needs at a height, and its slope.
    fn need(&self, (rise, share): (f64, f64), height: f64) -> [f64; 2] {
        let most = self.most(share, height);
        let [fill, slope] = fill(self.round, height.abs() / most, height > 0.0);
        [rise * fill, rise * slope / most * height.signum()]
    }

    fn depth(&self, part: (f64, f64), field: [f64; 4], height: f64) -> f64 {
        let [value, slope_x, slope_z, range] = field;
        let [need, rate] = self.need(part, height);
        let excess = value + range - self.begin - need;
        let local = (slope_x * slope_x + slope_z * slope_z + rate * rate).sqrt();
        let first_order = if excess < 0.0 { excess / self.steepest } else { excess / local };
        let mut depth = first_order.min(part.1 * self.top - height);
        if part.1 < 1.0 && self.bottom > 0.0 {
            depth = depth.min(height + part.1 * self.bottom);
        }
        depth
    }

    fn heaps(&self) -> (f64, f64) {
        (self.rise, 1.0)
    }

    fn sheet(&self) -> (f64, f64) {
        (self.sheet, self.flat)
    }

    fn thickness(&self, column: f64) -> f64 {
        let heaps = heights(self.round, column / self.rise);
        let sheet = heights(self.round, column / self.sheet);
        let [up, down] = [0, 1].map(|i| heaps[i].max(self.flat * sheet[i]));
        up * self.top + down * self.bottom
    }
}

fn pair([a, b]: [f64; 2]) -> Output {
    two(a, b)
}

/// Heights over their most where F is `fill`: Max's formulas.
fn heights(c: f64, fill: f64) -> [f64; 2] {
    let side = |f: f64| {
        let g = (f * f + 2.0 * c * f).sqrt();
        [g, g / (g * g + 2.0).sqrt()]
    };
    let (here, full) = (side(fill.clamp(0.0, 1.0)), side(1.0));
    [here[0] / full[0], here[1] / full[1]]
}

/// F by halving where heights are this share of the most, and its slope by differences of the fourth order.
fn fill(c: f64, share: f64, above: bool) -> [f64; 2] {
    let at = |share: f64| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let found = heights(c, middle)[usize::from(!above)];
            if found < share { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let h = 2e-3 * share.min(1.0 - share);
    let slope =
        (8.0 * (at(share + h) - at(share - h)) - (at(share + 2.0 * h) - at(share - 2.0 * h))) / (12.0 * h);
    [at(share), slope]
}

/// A layer, a field that is `above` where its cover begins, and a height of this share of the sheet's or the heaps' most.
fn sample(random: &mut Random, above: [f64; 2], of_sheet: bool) -> Input {
    let [top, bottom] = [random.log(20.0, 2000.0), random.log(20.0, 2000.0)];
    let (begin, rise) = (random.between(0.05, 0.9), random.between(0.3, 1.0));
    let (sheet, flat) = (random.between(0.01, 0.1), random.between(0.2, 0.8));
    let share = random.between(0.1, 0.9) * if of_sheet { flat } else { 1.0 };
    let height = share * if random.between(0.0, 1.0) < 0.5 { top } else { -bottom };
    let slope = random.log(1e-4, 1e-2) * random.direction();
    let value = begin + random.between(above[0], above[1]);
    input([
        [0.0, top, bottom, -1000.0],
        [1e-4, 10.0, begin, rise],
        [sheet, flat, random.between(0.02, 1.0), 0.05],
        [0.05, 60.0, 0.3, 0.0],
        [value, slope.x, slope.z, random.between(0.01, 0.1)],
        [height, 0.0, 0.0, 0.0],
    ])
}

/// Deep in heaps or in the sheet.
fn inside(random: &mut Random) -> Input {
    let of_sheet = random.between(0.0, 1.0) < 0.5;
    sample(random, [1.1, 1.5], of_sheet)
}

/// Beside them.
fn outside(random: &mut Random) -> Input {
    sample(random, [-0.5, -0.15], true)
}

pub fn twins() -> Vec<Twin> {
    [shapes(), places(), rays()].into_iter().flatten().collect()
}

fn shapes() -> Vec<Twin> {
    vec![
        Twin::new("layer_lower", "layer", "return vec4f(layer_lower(x[0].x));", |x| {
            let g = (1.0 + 2.0 * x[0][0]).sqrt();
            one(g / (g * g + 2.0).sqrt())
        })
        .over("all", |random| input([[random.between(0.0, 2.0); 4]])),
        Twin::new("layer_heights", "layer", "return vec4f(layer_heights(x[0].x, x[0].y), 0.0, 0.0);", |x| {
            pair(heights(x[0][0], x[0][1]))
        })
        .over("all", |random| input([[random.between(0.0, 2.0), random.between(-0.5, 1.5), 0.0, 0.0]])),
        Twin::new(
            "layer_thickness",
            "layer",
            "return vec4f(layer_thickness(make(x), x[4].x - x[1].z));",
            |x| one(Layer::of(x).thickness(x[4][0] - x[1][2])),
        )
        .declaring(MAKE)
        .over("all", |random| sample(random, [0.01, 1.0], true)),
        Twin::new(
            "layer_fill",
            "layer",
            "return vec4f(layer_fill(x[0].x, x[0].y, x[0].z > 0.0), 0.0, 0.0);",
            |x| pair(fill(x[0][0], x[0][1], x[0][2] > 0.0)),
        )
        .over("all", |random| {
            let above = if random.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
            input([[random.between(0.02, 2.0), random.between(0.02, 0.97), above, 0.0]])
        }),
        Twin::new(
            "layer_sheet",
            "layer",
            "let p = layer_sheet(make(x)); return vec4f(p.rise, p.share, 0.0, 0.0);",
            |x| two(x[2][0], x[2][1]),
        )
        .declaring(MAKE)
        .over("all", inside),
        Twin::new(
            "layer_heaps",
            "layer",
            "let p = layer_heaps(make(x)); return vec4f(p.rise, p.share, 0.0, 0.0);",
            |x| two(x[1][3], 1.0),
        )
        .declaring(MAKE)
        .over("all", inside),
        Twin::new(
            "layer_most",
            "layer",
            "return vec4f(layer_most(make(x), layer_sheet(make(x)), x[5].x));",
            |x| one(Layer::of(x).most(x[2][1], x[5][0])),
        )
        .declaring(MAKE)
        .over("all", inside),
        Twin::new(
            "layer_need",
            "layer",
            "return vec4f(layer_need(make(x), layer_heaps(make(x)), x[5].x), 0.0, 0.0);",
            |x| {
                let layer = Layer::of(x);
                pair(layer.need(layer.heaps(), x[5][0]))
            },
        )
        .declaring(MAKE)
        .over("all", inside),
        Twin::new(
            "layer_reaches",
            "layer",
            "return vec4f(select(0.0, 1.0, layer_reaches(make(x), layer_sheet(make(x)), x[4].x, x[5].x)));",
            |x| {
                let layer = Layer::of(x);
                let most = layer.most(layer.flat, x[5][0]);
                let within = x[5][0].abs() <= most;
                let enough = |need: [f64; 2]| x[4][0] >= layer.begin + need[0];
                one(f64::from(u8::from(within && enough(layer.need(layer.sheet(), x[5][0])))))
            },
        )
        .declaring(MAKE)
        .over("inside", |random| sample(random, [1.1, 1.5], true))
        .over("outside", outside),
    ]
}

fn places() -> Vec<Twin> {
    vec![
        Twin::new(
            "layer_field",
            "layer",
            "let f = layer_field(make(x), x[4]); return vec4f(f.value, f.slope, f.range);",
            |x| {
                let by_tile = x[1][0];
                // Values spread evenly over a range of a half-width w have a deviation of w / sqrt(3).
                [x[4][0], by_tile * x[4][1], by_tile * x[4][2], 3_f64.sqrt() * x[4][3]]
            },
        )
        .declaring(MAKE)
        .over("all", inside),
        Twin::new("layer_mip", "layer", "return vec4f(layer_mip(make(x), x[5].x));", |x| {
            one((x[5][0] / x[1][1]).max(1.0).log2())
        })
        .declaring(MAKE)
        .over("all", inside),
        Twin::new("layer_square", "layer", "return vec4f(f32(layer_square(make(x), x[5].x)));", |x| {
            // Sixteen texels, or a fiftieth of the distance.
            let wanted = (0.02 * x[5][0] / (16.0 * x[1][1])).max(1.0);
            one(wanted.log2().floor().min(6.0))
        })
        .declaring(MAKE)
        .exact()
        .over("all", |random| {
            let mut x = inside(random);
            // Not where one becomes the next.
            let size = 2_f64.powi(random.index(8) as i32) * random.between(1.05, 1.95);
            x[5][0] = (size * 16.0 * 10.0 / 0.02) as f32;
            x
        }),
        Twin::new(
            "layer_depth",
            "layer",
            "return vec4f(layer_depth(make(x), layer_sheet(make(x)), field(x), x[5].x));",
            |x| {
                let layer = Layer::of(x);
                one(layer.depth(layer.sheet(), x[4], x[5][0]))
            },
        )
        .declaring(MAKE)
        .over("inside", |random| sample(random, [1.1, 1.5], true))
        .over("outside", outside),
        Twin::new(
            "layer_edge",
            "layer",
            "let e = layer_edge(make(x), field(x), x[5].x); return vec4f(e.depth, e.extinction, e.boundary, e.wispiness);",
            |x| {
                let (layer, [value, slope_x, slope_z, range], height) = (Layer::of(x), x[4], x[5][0]);
                let depths = [layer.sheet(), layer.heaps()].map(|part| layer.depth(part, x[4], height));
                let column = value + range - layer.begin;
                let heaps = layer.need(layer.heaps(), height)[0];
                let in_sheet = height.abs() < layer.most(layer.flat, height);
                let need = if in_sheet { heaps.min(layer.need(layer.sheet(), height)[0]) } else { heaps };
                let share = ((column - need) / (2.0 * range)).clamp(0.0, 1.0);
                let aside = column.max(0.0) / slope_x.hypot(slope_z);
                let boundary = x[3][1].min(0.5 * layer.thickness(column)).min(aside);
                [depths[0].max(depths[1]), share * x[3][0], boundary, x[3][2]]
            },
        )
        .declaring(MAKE)
        .over("inside", |random| sample(random, [1.1, 1.5], true)),
        Twin::new(
            "field_held",
            "field",
            "return vec4f(vec3f(field_held(box_of(x), x[0].xyz)), 0.0);",
            |x| {
                let size = xyz(x[1]);
                let like = xyz(x[0]).rem_euclid(size);
                let nearest = xyz(x[0]).clamp(glam::DVec3::ZERO, size - 1.0);
                three(if x[1][3] > 0.0 { glam::DVec3::new(like.x, nearest.y, like.z) } else { nearest })
            },
        )
        .declaring(
            "fn box_of(x: array<vec4f, 8>) -> Field {
                var f = Field();
                f.size = vec3u(x[1].xyz);
                f.repeats = u32(x[1].w);
                return f;
            }",
        )
        .exact()
        .over("all", |random| {
            let size = [(); 3].map(|()| (2 + random.index(60)) as f64);
            let at = size.map(|n| random.between(-1.5 * n, 2.5 * n)).map(f64::floor);
            let repeats = random.index(2) as f64;
            input([[at[0], at[1], at[2], 0.0], [size[0], size[1], size[2], repeats]])
        }),
        Twin::new(
            "field_tile_place",
            "field",
            "return vec4f(field_tile_place(x[0].xyz, x[1].xyz, u32(x[1].w), u32(x[0].w)), 0.0);",
            |x| {
                let [width, height, length, count] = x[0];
                let high = height / count;
                // Between the middles of a picture's own cells.
                let y = (x[1][1] * high).clamp(0.5, high - 0.5) + x[1][3] * high;
                let around = |inside: f64, size: f64| (1.0 + inside * (size - 2.0)) / size;
                three(glam::DVec3::new(around(x[1][0], width), y / height, around(x[1][2], length)))
            },
        )
        .over("all", |random| {
            let cells = [(); 3].map(|()| 4 + random.index(60));
            let count = 3 + random.index(2);
            let texels = [cells[0] + 2, count * cells[1], cells[2] + 2, count].map(|n| n as f64);
            let inside = [(); 3].map(|()| random.between(0.01, 0.99));
            input([texels, [inside[0], inside[1], inside[2], random.index(count) as f64]])
        }),
    ]
}

/// Roots of o + d t + b t^2, the lower one first; none where it is nowhere below 0.
fn roots(o: f64, d: f64, b: f64) -> Option<[f64; 2]> {
    let square = d * d - 4.0 * b * o;
    if square <= 0.0 {
        return None;
    }
    let q = -0.5 * (d + square.sqrt().copysign(d));
    let [first, second] = [q / b, o / q];
    Some([first.min(second), first.max(second)])
}

fn rays() -> Vec<Twin> {
    vec![
        Twin::new(
            "ray_below",
            "ray_box",
            "return vec4f(ray_below(x[0].x, x[0].y, x[0].z), 0.0, 0.0);",
            |x| pair(roots(x[0][0], x[0][1], x[0][2]).unwrap_or([1e30, -1e30])),
        )
        .over("all", |random| {
            let slope = random.between(0.02, 1.0) * if random.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
            input([[random.between(-1e4, 1e3), slope, 7.86e-8, 0.0]])
        }),
        Twin::new(
            "layer_span",
            "layer",
            "return vec4f(layer_span(make(x), x[5].x, x[5].y, x[5].z, x[5].w), 0.0, 0.0);",
            |x| {
                let ([rim, top, bottom, ground], [height, slope, bend, t]) = (x[0], x[5]);
                let below = |level: f64| roots(height - level, slope, bend);
                let Some([_, leaves]) = below(rim + top) else { return two(f64::NAN, f64::NAN) };
                let end = match below(ground) {
                    Some([hits, _]) if hits > 0.0 => leaves.min(hits),
                    _ => leaves,
                };
                // From below, and up: in above the base, out above the top.
                let [_, enters] = below(rim - bottom).unwrap();
                two(enters.max(t), end)
            },
        )
        .declaring(MAKE)
        .over("from below", |random| {
            let mut x = sample(random, [0.1, 0.2], true);
            x[0] = [0.0, 200.0, 100.0, -1100.0];
            x[5] = [-1050.0, random.between(0.02, 1.0) as f32, 7.86e-8, 0.0];
            x
        }),
    ]
}
