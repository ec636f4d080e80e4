//! Where the map of the sun's light lies: squares across the beam, around all that casts shadows and, finer, around
//! the camera; level planes where there are clouds.

use glam::{DVec3, Vec3, Vec4};

use super::casters::Caster;

pub(super) const SQUARES: usize = SunMapUniform::SQUARES;
pub(super) const LAYERS: usize = SunMapUniform::LAYERS;
/// The last place holds no plane.
const PLANES: usize = 4 * LAYERS - 1;

/// The finest texel that is wanted, m: the sun's penumbra a kilometre below a cloud is 9 m wide.
const FINEST: f64 = 8.0;
/// Most that the next square is finer by.
const FINER: f64 = 8.0;
/// How far around the camera a layer, which has no end, casts its shadow, m across the beam.
pub(super) const ENDLESS: f64 = 32e3;
/// Squares around the camera move in steps of this share of their edge.
const STEP: f64 = 1.0 / 16.0;

/// `SunMap` of `shaders/lib/sun_map.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SunMapUniform {
    pub(crate) across: Vec3,
    pub(crate) squares: u32,
    pub(crate) aside: Vec3,
    pub(crate) sun_radius: f32,
    pub(crate) along: Vec3,
    pub(crate) reach: f32,
    pub(crate) place: [Vec4; SQUARES],
    pub(crate) planes: [Vec4; SQUARES * LAYERS],
    pub(crate) endless: f32,
    padding: [f32; 3],
}

impl SunMapUniform {
    /// Most squares.
    pub const SQUARES: usize = 3;
    /// Layers of a square, of four planes each.
    pub const LAYERS: usize = 4;
}

/// No shadows.
pub(super) const NONE: SunMapUniform = SunMapUniform {
    across: Vec3::X,
    squares: 0,
    aside: Vec3::Z,
    sun_radius: 0.0,
    along: Vec3::NEG_Y,
    reach: 0.0,
    place: [Vec4::ZERO; SQUARES],
    planes: [Vec4::ZERO; SQUARES * LAYERS],
    endless: 0.0,
    padding: [0.0; 3],
};

/// A square across the beam, m in the world.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Square {
    corner: [f64; 2],
    edge: f64,
    /// Depths below 0 at which the first interval begins, and each ends.
    cuts: [f64; PLANES + 1],
}

/// Where the map lies, in the world.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// Two axes across the beam, and the one along it.
    axes: [DVec3; 3],
    pub squares: Vec<Square>,
    pub texels: u32,
}

/// What a caster takes of the map: extents across, aside and down.
type Extents = [[f64; 2]; 3];

impl Layout {
    /// For what `casters` there are, with `texels` along the edge of a square, seen from `eye`; none without casters.
    pub fn new(casters: &[Caster], to_sun: DVec3, eye: DVec3, texels: u32) -> Option<Self> {
        let along = -to_sun;
        let (across, aside) = along.any_orthonormal_pair();
        let axes = [across, aside, along];
        let extents: Vec<_> = casters.iter().map(|caster| extents(caster, axes, eye)).collect();
        let all = extents.iter().copied().reduce(|a, b| {
            std::array::from_fn(|axis| [a[axis][0].min(b[axis][0]), a[axis][1].max(b[axis][1])])
        })?;
        let wanted = 1.02 * (all[0][1] - all[0][0]).max(all[1][1] - all[1][0]).max(1.0);
        // Edges come in steps, and corners lie on texels, so that shadows of clouds that drift do not crawl.
        let edge = (0.25 * (4.0 * wanted.log2()).ceil()).exp2();
        let middle = [0, 1].map(|axis| 0.5 * (all[axis][0] + all[axis][1]));
        let here = [across, aside].map(|axis| eye.dot(axis));
        let texel = edge / f64::from(texels);
        let finer = (texel / FINEST).max(1.0);
        let more = (finer.log(FINER).ceil() as usize).min(SQUARES - 1);
        let ratio = finer.powf(1.0 / more.max(1) as f64).min(FINER);
        let mut squares = vec![Square::new(middle, edge, texel, &extents)];
        for i in 1..=more {
            let edge = edge / ratio.powi(i as i32);
            squares.push(Square::new(here, edge, STEP * edge, &extents));
        }
        Some(Self { axes, squares, texels })
    }

    /// The same as the shader takes it, seen from `eye`; `endless` where something that casts a shadow has no end.
    pub fn uniform(&self, eye: DVec3, sun_radius: f32, reach: f64, endless: bool) -> SunMapUniform {
        let [across, aside, along] = self.axes;
        let [u, v] = [across, aside].map(|axis| eye.dot(axis));
        let s = -eye.y;
        let mut uniform = SunMapUniform {
            across: across.as_vec3(),
            squares: self.squares.len() as u32,
            aside: aside.as_vec3(),
            sun_radius,
            along: along.as_vec3(),
            reach: reach as f32,
            endless: f32::from(u8::from(endless)),
            ..NONE
        };
        for (i, square) in self.squares.iter().enumerate() {
            let [x, y] = square.corner;
            uniform.place[i] =
                glam::DVec4::new(x - u, y - v, 1.0 / square.edge, square.cuts[0] - s).as_vec4();
            for layer in 0..LAYERS {
                let plane = |k: usize| (square.cuts[(4 * layer + k + 1).min(PLANES)] - s) as f32;
                uniform.planes[LAYERS * i + layer] = Vec4::from_array([0, 1, 2, 3].map(plane));
            }
        }
        uniform
    }
}

impl Square {
    /// A square of this `edge` around `middle`, whose corner is a multiple of `step`.
    fn new(middle: [f64; 2], edge: f64, step: f64, extents: &[Extents]) -> Self {
        let corner = middle.map(|x| step * ((x - 0.5 * edge) / step).round());
        let meets = |e: &&Extents| (0..2).all(|i| e[i][0] < corner[i] + edge && e[i][1] > corner[i]);
        let cuts = cuts(extents.iter().filter(meets).map(|e| e[2]).collect());
        Self { corner, edge, cuts }
    }
}

fn extents(caster: &Caster, [across, aside, _]: [DVec3; 3], eye: DVec3) -> Extents {
    let entries = caster.entries();
    let of = |axis: DVec3| {
        let places = entries.map(|entry| entry.dot(axis));
        [
            places.into_iter().fold(f64::INFINITY, f64::min),
            places.into_iter().fold(f64::NEG_INFINITY, f64::max),
        ]
    };
    let [u, v, down] = [across, aside, DVec3::NEG_Y].map(of);
    let thickness = f64::from(-caster.light_box.along.y * caster.light_box.length);
    let around = |axis: DVec3| [eye.dot(axis) - ENDLESS, eye.dot(axis) + ENDLESS];
    let [u, v] = if caster.is_endless() { [across, aside].map(around) } else { [u, v] };
    [u, v, [down[0], down[1] + thickness]]
}

/// Cuts that part what `intervals` cover, gaps left out, into equal lengths.
fn cuts(mut intervals: Vec<[f64; 2]>) -> [f64; PLANES + 1] {
    intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut covered: Vec<[f64; 2]> = Vec::new();
    for [low, high] in intervals {
        match covered.last_mut() {
            Some(last) if low <= last[1] => last[1] = last[1].max(high),
            _ => covered.push([low, high]),
        }
    }
    let length: f64 = covered.iter().map(|[low, high]| high - low).sum();
    std::array::from_fn(|i| {
        let mut left = length * i as f64 / PLANES as f64;
        for [low, high] in &covered {
            if left <= high - low {
                return low + left;
            }
            left -= high - low;
        }
        covered.last().map_or(i as f64, |last| last[1])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_lie_where_clouds_are() {
        let cuts = cuts(vec![[100.0, 300.0], [5000.0, 5100.0], [200.0, 400.0]]);
        assert_eq!((cuts[0], cuts[PLANES]), (100.0, 5100.0));
        assert!(cuts.is_sorted());
        // Of 400 m that are covered 300 lie in the first interval.
        assert_eq!(cuts[3], 180.0);
        assert!(cuts[11] < 400.0 && cuts[12] > 5000.0);
    }
}
