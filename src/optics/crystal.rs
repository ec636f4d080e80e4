//! Rays through particles of ice that are turned every way: Macke, Mueller and Raschke, Journal of the Atmospheric
//! Sciences 53 (1996). Unpolarised: each crossing shares the light by the mean of both polarizations.
//!
//! A particle is convex. Its surface may be rough: at each crossing its normal is tilted by chance, with slopes as
//! Cox and Munk (1954) found them on the sea, and Yang and Liou (Contributions to Atmospheric Physics 71, 1998) took for
//! ice.

use std::f64::consts::{PI, TAU};

use super::rings::Rings;

/// Where rays are given up: after so many crossings, which crystals that hold light by total reflection reach.
const MOST_CROSSINGS: u32 = 400;

/// Light below which a ray goes on by chance, and the chance.
const FAINT: f64 = 1e-3;
const GOES_ON: f64 = 0.1;

/// How often a tilted normal that would turn a ray the wrong way is drawn anew, before the surface counts as even.
const TRIES: u32 = 16;

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a + s b.
fn along(a: Vector, s: f64, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + s * b[i])
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// Two directions across a unit vector, after Duff and others (2017).
fn across([x, y, z]: Vector) -> [Vector; 2] {
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

/// A convex shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A hexagonal prism whose length is so many times the width from corner to corner.
    Prism {
        /// Length over width.
        aspect: f64,
    },
    /// A sphere.
    Sphere,
}

/// Half the width of a prism from side to side, where that from corner to corner is 1.
const APOTHEM: f64 = 0.866_025_403_784_438_6;

impl Shape {
    /// The normal of side `i` of a prism; the last two are its ends.
    fn side(i: usize) -> Vector {
        if i >= 6 {
            return [0.0, 0.0, if i == 6 { 1.0 } else { -1.0 }];
        }
        let (sine, cosine) = (PI / 3.0 * i as f64).sin_cos();
        [cosine, sine, 0.0]
    }

    /// A point of the surface, evenly over it by three numbers from 0 to 1, and the normal there.
    fn point(self, [pick, u, v]: Vector) -> (Vector, Vector) {
        let Self::Prism { aspect } = self else {
            let (z, turn) = (1.0 - 2.0 * u, TAU * v);
            let level = (1.0 - z * z).max(0.0).sqrt();
            let p = [level * turn.cos(), level * turn.sin(), z];
            return (p, p);
        };
        // Corners are 1 from the axis: sides are 1 wide, and `aspect` long on both sides of the middle.
        let (side, end) = (2.0 * aspect, 1.5 * 3_f64.sqrt());
        let place = pick * (6.0 * side + 2.0 * end);
        if place < 6.0 * side {
            let i = ((place / side) as usize).min(5);
            let normal = Self::side(i);
            let flat = [APOTHEM * normal[0], APOTHEM * normal[1], aspect * (2.0 * v - 1.0)];
            return (along(flat, u - 0.5, [-normal[1], normal[0], 0.0]), normal);
        }
        // An end is six triangles about the axis.
        let normal = Self::side(if place < 6.0 * side + end { 6 } else { 7 });
        let (triangle, part) = ((6.0 * u).floor(), (6.0 * u).fract());
        let out = v.sqrt();
        let corner = |k: f64| [(PI / 3.0 * k + PI / 6.0).cos(), (PI / 3.0 * k + PI / 6.0).sin(), 0.0];
        let rim = along(corner(triangle).map(|x| (1.0 - part) * x), part, corner(triangle + 1.0));
        (along(rim.map(|x| out * x), aspect, normal), normal)
    }

    /// How far it is to the surface along a direction from a point inside, and the normal there.
    fn exit(self, p: Vector, d: Vector) -> (f64, Vector) {
        let Self::Prism { aspect } = self else {
            let b = dot(p, d);
            let way = (-2.0 * b).max(0.0);
            return (way, unit(along(p, way, d)));
        };
        let mut nearest = (f64::INFINITY, [0.0; 3]);
        for i in 0..8 {
            let normal = Self::side_of(i);
            let steep = dot(d, normal);
            if steep > 1e-12 {
                let reach = if i < 6 { APOTHEM } else { aspect };
                let way = ((reach - dot(p, normal)) / steep).max(0.0);
                if way < nearest.0 {
                    nearest = (way, normal);
                }
            }
        }
        nearest
    }

    /// [`Shape::side`] without sines.
    fn side_of(i: usize) -> Vector {
        const SIDES: [Vector; 8] = [
            [1.0, 0.0, 0.0],
            [0.5, APOTHEM, 0.0],
            [-0.5, APOTHEM, 0.0],
            [-1.0, 0.0, 0.0],
            [-0.5, -APOTHEM, 0.0],
            [0.5, -APOTHEM, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        SIDES[i]
    }
}

/// Random numbers of one ray, the same for all channels.
#[derive(Debug, Clone, Copy)]
struct Chance(u64);

impl Chance {
    /// From 0 to below 1 (Steele and others 2014, SplitMix64).
    fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ x >> 31) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }
}

/// Where the light of some rays went.
#[derive(Debug, Clone, PartialEq)]
pub struct Scattered {
    /// By ring.
    pub light: Vec<f64>,
    /// What went straight through, as through a window.
    pub straight: f64,
    /// What was given up.
    pub lost: f64,
    /// Sum of light times the cosine of its angle.
    pub forward: f64,
}

impl Scattered {
    /// Nothing yet.
    pub fn none(rings: &Rings) -> Self {
        Self { light: vec![0.0; rings.count()], straight: 0.0, lost: 0.0, forward: 0.0 }
    }

    /// Adds another one.
    pub fn add(&mut self, other: &Self) {
        self.light.iter_mut().zip(&other.light).for_each(|(sum, light)| *sum += light);
        self.straight += other.straight;
        self.lost += other.lost;
        self.forward += other.forward;
    }

    /// All light but what was given up.
    pub fn whole(&self) -> f64 {
        self.light.iter().sum::<f64>() + self.straight
    }

    fn leave(&mut self, rings: &Rings, before: Vector, after: Vector, light: f64) {
        let cosine = dot(before, after).clamp(-1.0, 1.0);
        self.forward += light * cosine;
        if cosine > 1.0 - 1e-12 {
            self.straight += light;
        } else {
            self.light[rings.ring(cosine.acos())] += light;
        }
    }
}

/// Ways of rays through a shape.
#[derive(Debug, Clone, Copy)]
pub struct Crystal {
    /// What it is.
    pub shape: Shape,
    /// Root mean square slope of its surface, no unit: 0 is even.
    pub roughness: f64,
}

/// Where a ray meets a particle, by six numbers from 0 to 1 that are even over them together: a point of the surface,
/// and a direction inwards that is as likely as its cosine, which is how light from all sides meets a convex body.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    place: Vector,
    normal: Vector,
    direction: Vector,
    chance: Chance,
}

impl Crystal {
    /// The start of ray `number` of a sequence (Roberts 2018: as many irrational steps as there are numbers), and the
    /// sixth number.
    pub fn start(&self, number: u64) -> (Start, f64) {
        // 1 / phi^k, where phi^7 = phi + 1.
        const PHI: f64 = 1.112_775_684_278_705_5;
        let mut step = 1.0;
        let even: [f64; 6] = std::array::from_fn(|_| {
            step /= PHI;
            (0.5 + step * number as f64).fract()
        });
        let (place, normal) = self.shape.point([even[0], even[1], even[2]]);
        let (cosine, turn) = (even[3].max(1e-12).sqrt(), TAU * even[4]);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let [a, b] = across(normal);
        let inward = along(along(a.map(|x| sine * turn.cos() * x), sine * turn.sin(), b), -cosine, normal);
        let chance = Chance(number.wrapping_mul(0x2545_f491_4f6c_dd1d));
        (Start { place, normal, direction: unit(inward), chance }, even[5])
    }

    /// Follows a ray of light 1 through ice of refractive index `n`.
    pub fn follow(&self, start: &Start, n: f64, rings: &Rings, sums: &mut Scattered) {
        let (came, mut chance) = (start.direction, start.chance);
        let meets = self.crossing(came, start.normal, 1.0 / n, &mut chance);
        sums.leave(rings, came, meets.back, meets.reflected);
        let (Some(mut d), mut place) = (meets.through, start.place) else { return };
        let mut light = 1.0 - meets.reflected;
        for _ in 0..MOST_CROSSINGS {
            let (way, normal) = self.shape.exit(place, d);
            place = along(place, way, d);
            let outward = normal.map(|x| -x);
            let leaves = self.crossing(d, outward, n, &mut chance);
            if let Some(out) = leaves.through {
                sums.leave(rings, came, out, light * (1.0 - leaves.reflected));
            }
            light *= leaves.reflected;
            d = leaves.back;
            if light < FAINT {
                if chance.draw() >= GOES_ON {
                    return;
                }
                light /= GOES_ON;
            }
        }
        sums.lost += light;
    }

    /// What a ray `d` does at a surface whose normal, toward where it comes from, is `normal`; `ratio` is the
    /// refractive index on its side over that on the other.
    fn crossing(&self, d: Vector, normal: Vector, ratio: f64, chance: &mut Chance) -> Crossing {
        for _ in 0..TRIES {
            if self.roughness <= 0.0 {
                break;
            }
            let (crossing, is_good) = cross(d, self.tilted(normal, chance), normal, ratio);
            if is_good {
                return crossing;
            }
        }
        cross(d, normal, normal, ratio).0
    }

    fn tilted(&self, normal: Vector, chance: &mut Chance) -> Vector {
        let slope = self.roughness * (-(1.0 - chance.draw()).ln()).sqrt();
        let (sine, cosine) = (TAU * chance.draw()).sin_cos();
        let [a, b] = across(normal);
        unit(along(along(normal, slope * cosine, a), slope * sine, b))
    }
}

/// What becomes of a ray at a surface.
struct Crossing {
    reflected: f64,
    back: Vector,
    /// Where the rest goes; nowhere where all is reflected.
    through: Option<Vector>,
}

/// By a normal `tilted` against the surface's own; whether both ways stay on their sides of that.
fn cross(d: Vector, tilted: Vector, normal: Vector, ratio: f64) -> (Crossing, bool) {
    let cosine = -dot(d, tilted);
    let back = along(d, 2.0 * cosine, tilted);
    let bent = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    let is_back = cosine > 0.0 && dot(back, normal) > 0.0;
    if bent <= 0.0 {
        return (Crossing { reflected: 1.0, back: unit(back), through: None }, is_back);
    }
    let beyond = bent.sqrt();
    let through = along(d.map(|x| ratio * x), ratio * cosine - beyond, tilted);
    let across = ((ratio * cosine - beyond) / (ratio * cosine + beyond)).powi(2);
    let along_it = ((ratio * beyond - cosine) / (ratio * beyond + cosine)).powi(2);
    let reflected = 0.5 * (across + along_it);
    let crossing = Crossing { reflected, back: unit(back), through: Some(unit(through)) };
    (crossing, is_back && dot(through, normal) < 0.0)
}
