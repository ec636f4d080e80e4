//! A mesh as the shaders see it: a volume of depths below its surface, as large heaps of ellipsoids have it
//! (`depth_volume`), but that these are the distances from its triangles.
//!
//! Bricks that the surface or the edge behind it reaches into are stored; those outside are empty, those deeper than the
//! edge homogeneous. They are as small as an atlas has room for.

use std::{
    hash::Hasher,
    sync::{Arc, Mutex, OnceLock, PoisonError, Weak},
};

use glam::{DMat3, DVec3, IVec3, UVec3, Vec3};
use half::f16;
use rayon::prelude::*;

use super::{
    DILUTED, EllipsoidUniform,
    atlas::{fill_atlas, slots, texel_of},
    depth_volume::{
        CELLS, CORE, DepthVolume, DepthVolumeUniform, LONGEST, MOST_STORED, STORED, cells, number, place,
        tell_distances,
    },
};
use crate::{
    Result,
    frame::Shared,
    gpu,
    scene::{Cloud, Ellipsoid, Mesh, Surface},
};

/// Parts along the longest edge of a mesh that proxies stand for.
const PARTS: u32 = 12;
/// Bakes of one surface that are kept.
const KEPT: usize = 4;
/// From one edge of bricks to the next finer one that is worth a try.
const FINER: f64 = 0.96;
/// So many bricks below the surface depths hardly bend within a brick.
const DEEP: f64 = 2.0;
/// Places are told to this, m, so that what drifts with the wind stays the same.
const ROUND: f64 = 1e-6;
/// Half floats end beyond, m.
const DEEPEST: f64 = 6e4;

/// A mesh that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeshShape {
    pub depths: Shared<Depths>,
    pub uniform: DepthVolumeUniform,
    /// Extinction behind its edge, 1/m.
    pub extinction: f32,
    /// Thickness of its edge, m, and wispiness.
    edge: [f32; 2],
    /// The box around it, m.
    bounds: (Vec3, Vec3),
}

/// What depths are baked of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Baked {
    /// From vectors in its file's lengths to those of the scene, m.
    turned: DMat3,
    /// Depth behind which extinction changes with nothing but height, m.
    steady: f64,
    /// Height of its level over its place, m, if it has one.
    level: Option<f64>,
}

/// The volume of depths of a surface.
#[derive(Debug)]
pub(crate) struct Depths {
    surface: Weak<Surface>,
    /// That of the surface.
    fingerprint: u64,
    baked: Baked,
    /// Least and greatest corner of the surface, m from its place.
    bounds: (DVec3, DVec3),
    /// Least corner of the first brick, m from its place.
    low: DVec3,
    /// Edge of a brick, m.
    brick: f64,
    /// Bricks along each axis.
    size: UVec3,
    /// By brick, x fastest, as the shader takes it.
    pub(super) index: Vec<u32>,
    /// Depths at the corners of the cells of each stored brick, m, x fastest.
    pub(super) stored: Vec<Vec<f16>>,
}

impl PartialEq for Depths {
    fn eq(&self, other: &Self) -> bool {
        self.fingerprint == other.fingerprint && self.baked == other.baked
    }
}

/// What a brick is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Empty,
    Core,
    Stored,
}

impl MeshShape {
    /// The mesh of a cloud, in a frame whose origin is at `origin`.
    ///
    /// # Errors
    /// Where it was not read.
    pub fn new(cloud: &Cloud, mesh: &Mesh, origin: DVec3) -> Result<Self> {
        let surface = mesh.read_surface()?;
        let boundary = cloud.edge.boundary;
        let baked = Baked {
            turned: mesh.scene_from_file(),
            steady: if cloud.dilution > 0.0 { DILUTED * boundary } else { boundary },
            level: cloud.level.map(|level| ((level - mesh.place.y) / ROUND).round() * ROUND),
        };
        let depths = Depths::of(surface, baked);
        let shift = ((mesh.place - origin) / ROUND).round() * ROUND;
        let uniform = DepthVolumeUniform {
            low: (depths.low + shift).as_vec3(),
            brick: depths.brick as f32,
            size: depths.size,
            core: 0.0,
            texel: texel_of(slots(depths.stored.len())),
            // Depths are told no finer than a cell.
            boundary: boundary.max(depths.brick / f64::from(CELLS)) as f32,
            slots: [slots(depths.stored.len()).x, slots(depths.stored.len()).y],
            power: 1.0,
            reach: 1.0,
        };
        let (low, high) = depths.bounds;
        let bounds = ((low + shift).as_vec3(), (high + shift).as_vec3());
        let edge = [boundary.min(DEEPEST), cloud.edge.wispiness].map(|x| x as f32);
        let extinction = (cloud.droplets.extinction() * mesh.density) as f32;
        Ok(Self { depths, uniform, extinction, edge, bounds })
    }

    /// The box around it, in its frame, m.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// Ellipsoids that hold all of it, in a frame whose origin is at `origin`: who asks which parts of a picture or a box
    /// it is in, asks them.
    pub fn proxies(&self, cloud: &Cloud, mesh: &Mesh, origin: DVec3) -> Vec<EllipsoidUniform> {
        let Depths { size, brick, index, .. } = &*self.depths;
        let edge = size.max_element().div_ceil(PARTS);
        let parts = size.map(|n| n.div_ceil(edge));
        let mut reach = vec![None; parts.element_product() as usize];
        for (i, _) in index.iter().enumerate().filter(|(_, entry)| **entry >= CORE) {
            let at = place(*size, i);
            let known = reach[number(parts, at / edge)].get_or_insert((at, at));
            *known = (known.0.min(at), known.1.max(at));
        }
        let ball = |(first, last): (UVec3, UVec3)| {
            let corner = |at: UVec3| self.uniform.low.as_dvec3() + *brick * at.as_dvec3();
            // Bricks go beyond the surface that is in them.
            let low = corner(first).max(self.bounds.0.as_dvec3());
            let high = corner(last + 1).min(self.bounds.1.as_dvec3());
            let radius = 0.5 * low.distance(high).max(1e-3);
            let ball = Ellipsoid {
                density: mesh.density,
                ..Ellipsoid::new(0.5 * (low + high) + origin, DVec3::splat(radius))
            };
            EllipsoidUniform::new(cloud, &ball, origin, f64::INFINITY)
        };
        reach.into_iter().flatten().map(ball).collect()
    }

    /// Adds what its texels and uniform are made of.
    pub fn hash_into(&self, hasher: &mut impl Hasher) {
        let Baked { turned, steady, level } = self.depths.baked;
        hasher.write_u64(self.depths.fingerprint);
        hasher.write(bytemuck::bytes_of(&turned));
        [steady, level.unwrap_or(f64::NEG_INFINITY)].iter().for_each(|x| hasher.write_u64(x.to_bits()));
        hasher.write(bytemuck::bytes_of(&self.uniform));
        hasher.write(bytemuck::bytes_of(&self.edge));
    }

    /// The greatest extinction that it may have in a ball but for its height, 1/m: never too small.
    pub fn most_within(&self, center: Vec3, radius: f32) -> f32 {
        if self.reaches(center, radius) { self.extinction } else { 0.0 }
    }

    /// Whether anything of it may be in a ball: never wrongly no.
    fn reaches(&self, center: Vec3, radius: f32) -> bool {
        let size = self.depths.size;
        let number_of = |p: Vec3| ((p - self.uniform.low) / self.uniform.brick).floor().as_ivec3();
        let (first, last) = (number_of(center - radius - 1e-3), number_of(center + radius + 1e-3));
        let most = size.as_ivec3() - 1;
        if first.cmpgt(most).any() || last.cmplt(IVec3::ZERO).any() {
            return false;
        }
        let (first, last) = (first.max(IVec3::ZERO).as_uvec3(), last.min(most).as_uvec3());
        cells(first, last).any(|at| self.depths.index[number(size, at)] >= CORE)
    }

    /// Texels of a stored brick: depth, share of the densest extinction, boundary and wispiness.
    pub(super) fn texels(&self, brick: usize) -> Vec<f16> {
        let [boundary, wispiness] = self.edge.map(f16::from_f32);
        let texel = |depth: &f16| [*depth, f16::ONE, boundary, wispiness];
        self.depths.stored[brick].iter().flat_map(texel).collect()
    }

    /// The volume on a device.
    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> DepthVolume {
        let format = wgpu::TextureFormat::Rgba16Float;
        let count = self.depths.stored.len();
        DepthVolume {
            uniform: self.uniform,
            index: gpu::storage_buffer(device, "depth index", &self.depths.index),
            atlas: fill_atlas(device, queue, format, count, |brick| self.texels(brick)),
        }
    }
}

impl Depths {
    /// Those of a surface; the same for all meshes that have it, lie alike and have the same edge.
    fn of(surface: &Arc<Surface>, baked: Baked) -> Shared<Self> {
        static KNOWN: OnceLock<Mutex<Vec<Shared<Depths>>>> = OnceLock::new();
        let known = KNOWN.get_or_init(Default::default);
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        // Of surfaces that nobody has any more nothing is kept.
        known.retain(|depths| depths.surface.strong_count() > 0);
        let is_own = |depths: &Shared<Self>| depths.fingerprint == surface.fingerprint();
        if let Some(place) = known.iter().position(|depths| is_own(depths) && depths.baked == baked) {
            let found = known.remove(place);
            known.push(found.clone());
            return found;
        }
        let mut others = known.iter().filter(|depths| is_own(depths)).count();
        known.retain(|depths| {
            let goes = is_own(depths) && others >= KEPT;
            others -= usize::from(goes);
            !goes
        });
        let depths = Shared::new(Self::new(surface, baked));
        known.push(depths.clone());
        depths
    }

    fn new(surface: &Arc<Surface>, baked: Baked) -> Self {
        let (mut low, high) = surface.bounds_turned(&baked.turned);
        let bounds = (low, high);
        low.y = baked.level.map_or(low.y, |level| low.y.max(level.min(high.y)));
        let extent = (high - low).max(DVec3::splat(1e-3));
        let mut depths = Self {
            surface: Arc::downgrade(surface),
            fingerprint: surface.fingerprint(),
            baked,
            bounds,
            low,
            // Of these there is room for all.
            brick: extent.max_element() / (MOST_STORED as f64).cbrt().floor(),
            size: UVec3::ONE,
            index: Vec::new(),
            stored: Vec::new(),
        };
        let depth = DepthOf { surface, baked };
        let (mut places, least) = (depths.sort(&depth, extent), extent.max_element() / f64::from(LONGEST));
        loop {
            // No shape has more than eight times as many of half the edge.
            let share = (places.len().max(1) as f64 / MOST_STORED as f64).cbrt();
            let finer = (share * depths.brick).max(least);
            if finer > FINER * depths.brick {
                break;
            }
            depths.brick = finer;
            places = depths.sort(&depth, extent);
        }
        // Where that did not fit for once.
        while places.len() > MOST_STORED {
            depths.brick /= FINER;
            places = depths.sort(&depth, extent);
        }
        depths.stored = places.par_iter().map(|at| depths.corners(&depth, *at)).collect();
        tell_distances(&mut depths.index, depths.size);
        depths
    }

    /// Cuts a box of this extent into bricks and fills the index; tells the places of those that are to be stored.
    fn sort(&mut self, depth: &DepthOf, extent: DVec3) -> Vec<UVec3> {
        self.size = (extent / self.brick).ceil().as_uvec3().clamp(UVec3::ONE, UVec3::splat(LONGEST));
        let edge = LONGEST.next_power_of_two().min(self.size.max_element().next_power_of_two());
        let mut kinds = Vec::new();
        self.divide(depth, UVec3::ZERO, edge, &mut kinds);
        self.index = vec![0; self.size.element_product() as usize];
        let mut places = Vec::new();
        for (at, edge, kind) in kinds {
            let last = (at + edge).min(self.size) - 1;
            for at in cells(at, last) {
                self.index[number(self.size, at)] = match kind {
                    Kind::Empty => 0,
                    Kind::Core => CORE,
                    Kind::Stored => {
                        places.push(at);
                        STORED | (places.len() as u32 - 1)
                    }
                };
            }
        }
        places
    }

    /// Adds what a cube of bricks is, `edge` along each axis from `at` on, or its eighths.
    fn divide(&self, depth: &DepthOf, at: UVec3, edge: u32, kinds: &mut Vec<(UVec3, u32, Kind)>) {
        if at.cmpge(self.size).any() {
            return;
        }
        let half = 0.5 * f64::from(edge) * self.brick;
        let middle = self.low + self.brick * at.as_dvec3() + half;
        let (radius, here) = (1.001 * 3f64.sqrt() * half, depth.at(middle));
        let level = self.baked.level.unwrap_or(f64::NEG_INFINITY);
        // Where the base is displaced, all is stored.
        let above = middle.y - half >= level + self.baked.steady;
        let kind = if here < -radius || middle.y + half < level {
            Kind::Empty
        } else if here > radius + self.baked.steady && above {
            Kind::Core
        } else if edge == 1 {
            Kind::Stored
        } else {
            let half = edge / 2;
            let parts = |i: u32| at + half * UVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let each = (0..8u32).into_par_iter().map(|i| {
                let mut own = Vec::new();
                self.divide(depth, parts(i), half, &mut own);
                own
            });
            kinds.extend(each.collect::<Vec<_>>().into_iter().flatten());
            return;
        };
        kinds.push((at, edge, kind));
    }

    /// Depths at the corners of the cells of a brick: of a deep one, where they hardly bend, at some of them, and what is
    /// between those.
    fn corners(&self, depth: &DepthOf, at: UVec3) -> Vec<f16> {
        let low = self.low + self.brick * at.as_dvec3();
        let is_deep = depth.at(low + 0.5 * self.brick) > DEEP * self.brick;
        let step = if is_deep { CELLS / 2 } else { 1 };
        let count = CELLS / step + 1;
        let way = self.brick / f64::from(count - 1);
        let mut known = vec![0.0; count.pow(3) as usize];
        let (mut before, mut nearest) = (None, 0);
        for at in cells(UVec3::ZERO, UVec3::splat(count - 1)) {
            // Back and forth, so that the next corner is near.
            let x = if (at.y + at.z) % 2 == 0 { at.x } else { count - 1 - at.x };
            let at = UVec3::new(x, at.y, at.z);
            let p = low + way * at.as_dvec3();
            let here = depth.near(p, before, &mut nearest);
            before = Some((p, here));
            known[number(UVec3::splat(count), at)] = here;
        }
        let between = |at: UVec3| -> f64 {
            let first = (at / step).min(UVec3::splat(count - 2));
            let part = at.as_dvec3() / f64::from(step) - first.as_dvec3();
            let corner = |i: u32| {
                let pick = UVec3::new(i & 1, i >> 1 & 1, i >> 2);
                let weight = DVec3::ONE - (part - pick.as_dvec3()).abs();
                weight.element_product() * known[number(UVec3::splat(count), first + pick)]
            };
            (0..8).map(corner).sum()
        };
        let all = cells(UVec3::ZERO, UVec3::splat(CELLS));
        all.map(|at| f16::from_f64(between(at).clamp(-DEEPEST, DEEPEST))).collect()
    }
}

/// Depths below a surface that is turned.
struct DepthOf<'a> {
    surface: &'a Surface,
    baked: Baked,
}

impl DepthOf<'_> {
    /// Depth at a point, m from its place.
    fn at(&self, p: DVec3) -> f64 {
        let (scale, q) = self.of_file(p);
        scale * self.surface.depth(q)
    }

    /// The same, where it is known at another point, to which `nearest` is the triangle: closed surfaces are not crossed
    /// within their distance.
    fn near(&self, p: DVec3, before: Option<(DVec3, f64)>, nearest: &mut u32) -> f64 {
        let (scale, q) = self.of_file(p);
        let tree = self.surface.tree();
        let distance = scale * tree.distance(q, nearest);
        let known = before.filter(|(other, depth)| 0.999 * depth.abs().max(distance) > p.distance(*other));
        let inside = known.map_or_else(|| tree.holds(q), |(_, depth)| depth > 0.0);
        if inside { distance } else { -distance }
    }

    /// Metres of its file's unit of length, and a point in those.
    fn of_file(&self, p: DVec3) -> (f64, DVec3) {
        let scale = self.baked.turned.x_axis.length();
        (scale, self.baked.turned.transpose() * p / (scale * scale))
    }
}
