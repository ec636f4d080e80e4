//! Lumps upon lumps, and a grid that finds those around a point.

use glam::{DQuat, DVec3, UVec3};

use super::MOST_LUMPS;
use crate::scene::dice::Dice;

/// Cells of the grid along each axis.
const CELLS: u32 = 40;

/// No next entry of a cell.
const NONE: u32 = u32::MAX;

/// How deep a child may sit in another lump that is larger, of that one's radius.
const BURIED: f64 = 0.75;

/// How near the middle of a child may be to another of its generation, of its own radius.
const CROWDED: f64 = 0.75;

/// Least height of a lump's middle above the base, of its radius.
const LOWEST: f64 = 0.15;

/// What a lump is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// A heap of rising air.
    Heap,
    /// A sheet of ice that spreads.
    Ice,
    /// A pouch that hangs from one.
    Pouch,
    /// A shred that dissolves.
    Shred,
}

/// An ellipsoid in the cloud's own frame.
#[derive(Debug, Clone)]
pub(super) struct Lump {
    /// Metres.
    pub center: DVec3,
    /// Half axes before the turn, metres.
    pub radii: DVec3,
    pub turn: DQuat,
    /// Radius that children and neighbours go by, metres.
    pub size: f64,
    /// Number of lumps below it.
    pub generation: u32,
    pub part: Part,
    /// What its own chance falls by.
    pub key: u64,
}

impl Lump {
    /// Whether it has a point in common with `other` on the line between their middles.
    fn overlaps(&self, other: &Self) -> bool {
        let between = other.center - self.center;
        let distance = between.length();
        if distance < 1e-9 {
            return true;
        }
        let way = between / distance;
        // A little less than they are: they are rounded.
        distance < 0.99 * (self.radius_along(way) + other.radius_along(way))
    }

    /// Distance from its middle to its surface in the direction of a unit vector, metres.
    fn radius_along(&self, way: DVec3) -> f64 {
        1.0 / (self.turn.inverse() * way / self.radii).length()
    }
}

/// How a generation grows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Brood {
    /// Places tried on each lump.
    pub tries: u32,
    /// Least and greatest size of a child, of its parent's.
    pub ratio: (f64, f64),
    /// Distance of a child's middle from its parent's, of the parent's radius.
    pub seat: f64,
    /// Least rise of the way to a child: -1 straight down, 0 level.
    pub lowest: f64,
    /// Lumps smaller than this do not grow, metres.
    pub least: f64,
}

/// All lumps so far.
pub(super) struct Pile {
    lumps: Vec<Lump>,
    grid: Grid,
}

impl Pile {
    /// Nothing, in a box of half the extent `reach` around the middle of the base, metres. What is beyond is
    /// found in its outermost cells.
    pub fn new(reach: DVec3) -> Self {
        Self { lumps: Vec::new(), grid: Grid::new(reach) }
    }

    pub fn lumps(&self) -> &[Lump] {
        &self.lumps
    }

    /// All lumps but those that touch no other; one at least.
    pub fn into_lumps(mut self) -> Vec<Lump> {
        let mut touches: Vec<bool> = (0..self.lumps.len()).map(|i| self.touches_another(i)).collect();
        if !touches.contains(&true) {
            // Something grows always.
            touches.iter_mut().take(1).for_each(|first| *first = true);
        }
        let mut stays = touches.into_iter();
        self.lumps.retain(|_| stays.next().unwrap_or(false));
        self.lumps
    }

    /// Whether lump `i` overlaps one more: most likely one around its middle.
    fn touches_another(&self, i: usize) -> bool {
        let lump = &self.lumps[i];
        let meets = |j: usize| j != i && lump.overlaps(&self.lumps[j]);
        self.grid.around(lump.center).any(|j| meets(j as usize)) || (0..self.lumps.len()).any(meets)
    }

    /// Whether there is no room for one more.
    pub fn is_full(&self) -> bool {
        self.lumps.len() >= MOST_LUMPS
    }

    /// Adds a lump. What reaches below the base is cut off by the level of the cloud; the middle stays above.
    pub fn put(&mut self, mut lump: Lump) {
        if self.is_full() {
            return;
        }
        if lump.part != Part::Shred {
            lump.center.y = lump.center.y.max(LOWEST * lump.radii.y);
        }
        self.grid.add(self.lumps.len() as u32, &lump);
        self.lumps.push(lump);
    }

    /// Grows one generation on the lumps `parents`.
    pub fn grow(&mut self, parents: std::ops::Range<usize>, brood: &Brood) {
        for parent in parents {
            if self.lumps[parent].part != Part::Heap {
                continue;
            }
            for turn in 0..brood.tries {
                if self.is_full() {
                    return;
                }
                self.bud(parent, turn, brood);
            }
        }
    }

    /// One child of `parent`, where chance finds a place that is free.
    fn bud(&mut self, parent: usize, turn: u32, brood: &Brood) {
        let from = &self.lumps[parent];
        let key = mixed(from.key, u64::from(turn) + 1);
        let dice = &mut Dice::new(key);
        let way = dice.cap(brood.lowest);
        let size = from.size * dice.between(brood.ratio.0, brood.ratio.1);
        if size < brood.least {
            return;
        }
        let center = from.center + from.turn * (brood.seat * from.radii * (from.turn.inverse() * way));
        let generation = from.generation + 1;
        if center.y < 0.2 * size || self.is_taken(center, size, parent, generation) {
            return;
        }
        let shape = DVec3::new(dice.between(0.94, 1.16), dice.between(0.84, 1.0), dice.between(0.94, 1.1));
        let turn = dice.yaw();
        self.put(Lump { center, radii: size * shape, turn, size, generation, part: Part::Heap, key });
    }

    /// Whether a child of `parent` at `p` would be inside a larger lump, or crowd one of its own generation.
    fn is_taken(&self, p: DVec3, size: f64, parent: usize, generation: u32) -> bool {
        self.grid.around(p).any(|i| {
            let other = &self.lumps[i as usize];
            if other.part != Part::Heap {
                return false;
            }
            if other.generation == generation {
                return p.distance_squared(other.center) < (CROWDED * size) * (CROWDED * size);
            }
            // Measured in the other's own radii: those at the base are flat.
            let inside = (p - other.center) / (other.radii * (BURIED - 0.1 * size / other.size));
            i as usize != parent && other.size > 1.2 * size && inside.length_squared() < 1.0
        })
    }
}

/// A key of its own for the `turn`th of what comes from `key` (SplitMix64, Steele et al. 2014).
pub(super) fn mixed(key: u64, turn: u64) -> u64 {
    let mut z = key.wrapping_add(turn.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// For each cell the lumps that reach into it, as lists through one table.
struct Grid {
    reach: DVec3,
    first: Vec<u32>,
    /// Lump and next entry.
    entries: Vec<(u32, u32)>,
}

impl Grid {
    fn new(reach: DVec3) -> Self {
        Self { reach, first: vec![NONE; (CELLS * CELLS * CELLS) as usize], entries: Vec::new() }
    }

    /// The cell of `p`; y counts from the base.
    fn cell(&self, p: DVec3) -> UVec3 {
        let unit = (p / self.reach + DVec3::new(1.0, 0.0, 1.0)) * DVec3::new(0.5, 1.0, 0.5);
        (unit * f64::from(CELLS)).clamp(DVec3::ZERO, DVec3::splat(f64::from(CELLS - 1))).as_uvec3()
    }

    fn index(cell: UVec3) -> usize {
        ((cell.z * CELLS + cell.y) * CELLS + cell.x) as usize
    }

    fn add(&mut self, lump: u32, of: &Lump) {
        let wide = DVec3::splat(of.radii.max_element().min(1.2 * of.size));
        let (low, high) = (self.cell(of.center - wide), self.cell(of.center + wide));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let first = &mut self.first[Self::index(UVec3::new(x, y, z))];
                    self.entries.push((lump, *first));
                    *first = (self.entries.len() - 1) as u32;
                }
            }
        }
    }

    /// The lumps that may reach to `p`.
    fn around(&self, p: DVec3) -> impl Iterator<Item = u32> {
        let mut next = self.first[Self::index(self.cell(p))];
        std::iter::from_fn(move || {
            let (lump, after) = *self.entries.get(next as usize)?;
            next = after;
            Some(lump)
        })
    }
}
