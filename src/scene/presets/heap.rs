//! Cumulus as heaps upon heaps over a flat base.
//!
//! A first layer of lumps lies on the base; on the upper side of each sit smaller
//! ones, on those smaller ones again. Nothing reaches below the base, where the
//! water begins to condense.

use std::ops::RangeInclusive;

use glam::DVec3;

use crate::scene::dice::Dice;
use crate::scene::{Cloud, Edge, Ellipsoid};

/// Size of a child against its parent.
const RATIO: RangeInclusive<f64> = 0.52..=0.7;

/// Places tried for a child, of which it takes the freest.
const TRIES: usize = 8;

/// How deep a child sits in its parent: 1 is with its centre on the surface.
const SEAT: RangeInclusive<f64> = 0.62..=0.85;

/// Radius of the least lump, metres: below it there is nothing to round to.
const LEAST_RADIUS: f64 = 0.1;

/// A cloud that grows.
pub(super) struct Heap {
    /// Altitude of the base, metres.
    base: f64,
    /// All lumps so far.
    lumps: Vec<Ellipsoid>,
    /// Index of the first lump of the youngest generation.
    youngest: usize,
}

/// How the next generation grows.
pub(super) struct Growth {
    /// Least and greatest number of children of a lump.
    pub children: (usize, usize),
    /// Pull upwards against pure chance, no unit.
    pub up: f64,
    /// Pull away from the cloud's axis, no unit.
    pub out: f64,
}

/// Edges of a cloud, from the base to the top.
pub(super) struct Edges {
    /// Thickness of the boundary, metres; less on lumps that are too small for it.
    pub boundary: f64,
    /// Wispiness at the base.
    pub base: f64,
    /// Wispiness at the top.
    pub top: f64,
}

impl Heap {
    pub fn on(base: f64) -> Self {
        Self { base, lumps: Vec::new(), youngest: 0 }
    }

    /// A heap of `lumps` that are there already, on a base that goes through the lowest point of them.
    pub fn upon(lumps: &[Ellipsoid]) -> Self {
        let base = lumps.iter().map(|lump| lump.bounds().0.y).fold(f64::INFINITY, f64::min);
        Self { base, lumps: lumps.to_vec(), youngest: 0 }
    }

    /// All lumps, in the order of their growth.
    pub fn into_lumps(self) -> Vec<Ellipsoid> {
        self.lumps
    }

    /// Puts a lump around `center` (metres), turned by chance and lifted where it
    /// would reach below the base.
    pub fn put(&mut self, dice: &mut Dice, center: DVec3, radii: DVec3) {
        let radii = tenths(radii).max(DVec3::splat(LEAST_RADIUS));
        let mut center = tenths(center);
        center.y = center.y.max(tenth(self.base + radii.y));
        self.lumps.push(Ellipsoid { orientation: dice.yaw(), ..Ellipsoid::new(center, radii) });
    }

    /// Puts a flat lump right on the base, around the horizontal place `p` (metres).
    pub fn lay(&mut self, dice: &mut Dice, p: DVec3, radii: DVec3) {
        let center = DVec3::new(p.x, self.base + radii.y, p.z);
        self.put(dice, center, radii);
    }

    /// Grows one generation on the lumps that came since the last one.
    pub fn grow(&mut self, dice: &mut Dice, growth: &Growth) {
        let parents = self.youngest..self.lumps.len();
        self.youngest = self.lumps.len();
        for i in parents {
            for _ in 0..dice.count(growth.children.0, growth.children.1) {
                self.bud(dice, i, growth);
            }
        }
    }

    /// Puts one child on the upper side of lump `i`, where there is most room.
    fn bud(&mut self, dice: &mut Dice, i: usize, growth: &Growth) {
        let mut freest = (0.0, DVec3::ZERO);
        for _ in 0..TRIES {
            let center = self.seat(dice, i, growth);
            let room = self.room(center, i);
            if room > freest.0 {
                freest = (room, center);
            }
        }
        let mean = self.lumps[i].radii.element_sum() / 3.0;
        let radius = mean * dice.between(*RATIO.start(), *RATIO.end());
        let shape = DVec3::new(dice.between(0.9, 1.15), dice.between(0.8, 0.95), dice.between(0.9, 1.1));
        self.put(dice, freest.1, radius * shape);
        self.inherit(i);
    }

    /// Gives the last lump the density and the edge of lump `i`, thinner where it is too small.
    fn inherit(&mut self, i: usize) {
        let (density, mut edge) = (self.lumps[i].density, self.lumps[i].edge.clone());
        let Some(child) = self.lumps.last_mut() else { return };
        if let Some(edge) = &mut edge {
            edge.boundary = edge.boundary.min(thickest(child, edge.wispiness)).round();
        }
        (child.density, child.edge) = (density, edge);
    }

    /// A place near the upper surface of lump `i`.
    fn seat(&self, dice: &mut Dice, i: usize, growth: &Growth) -> DVec3 {
        let parent = &self.lumps[i];
        let away = (parent.center - self.axis()).with_y(0.0).normalize_or_zero();
        let mut to_child = dice.sphere();
        to_child.y = to_child.y.abs();
        let to_child = (to_child + growth.up * DVec3::Y + growth.out * away).normalize();
        let depth = dice.between(*SEAT.start(), *SEAT.end());
        let on_unit_sphere = (parent.orientation.inverse() * to_child).normalize();
        parent.center + parent.orientation * (depth * parent.radii * on_unit_sphere)
    }

    /// Distance from `p` to the nearest lump but `parent`, in radii of that lump;
    /// more than 0.
    fn room(&self, p: DVec3, parent: usize) -> f64 {
        let others = self.lumps.iter().enumerate().filter(|(i, _)| *i != parent);
        let distances = others.map(|(_, lump)| p.distance(lump.center) / lump.radii.max_element());
        distances.fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE)
    }

    /// Middle of all lumps.
    fn axis(&self) -> DVec3 {
        self.lumps.iter().map(|lump| lump.center).sum::<DVec3>() / self.lumps.len() as f64
    }

    /// The cloud, its edges ranging from base to top.
    pub fn into_cloud(mut self, name: &str, edges: &Edges) -> Cloud {
        let height = |lump: &Ellipsoid| lump.center.y - self.base;
        let top = self.lumps.iter().map(height).fold(1.0, f64::max);
        for lump in &mut self.lumps {
            let share = (lump.center.y - self.base) / top;
            let wispiness = hundredth(edges.base + (edges.top - edges.base) * share);
            let boundary = edges.boundary.min(thickest(lump, wispiness)).round();
            lump.edge = Some(Edge { boundary, wispiness });
        }
        Cloud {
            name: name.to_owned(),
            ellipsoids: self.lumps,
            edge: Edge { boundary: edges.boundary, wispiness: edges.top },
            ..Cloud::default()
        }
    }
}

/// The thickest boundary that suits a lump, metres: wispy ones have no core at all.
fn thickest(lump: &Ellipsoid, wispiness: f64) -> f64 {
    (0.75 + wispiness) * lump.radii.min_element()
}

/// Rounded to decimetres, so that files stay short.
pub(super) fn tenth(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

/// Every component rounded to decimetres.
pub(super) fn tenths(v: DVec3) -> DVec3 {
    DVec3::new(tenth(v.x), tenth(v.y), tenth(v.z))
}

fn hundredth(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
