//! Heaps that grow on ellipsoids that are there already.

use super::heap::{Growth, Heap};
use crate::scene::Ellipsoid;
use crate::scene::dice::Dice;

/// How heaps grow on ellipsoids: the same on every platform and in every run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Heaps {
    /// Other seeds give other heaps of the same kind.
    pub seed: u64,
    /// Least and greatest number of children of each ellipsoid.
    pub children: (usize, usize),
    /// How often children get children of their own.
    pub generations: usize,
}

impl Default for Heaps {
    /// One generation of a few heads.
    fn default() -> Self {
        Self { seed: 1, children: (3, 4), generations: 1 }
    }
}

impl Heaps {
    /// Pulls of the presets' towers: upwards and outwards, no unit.
    const UP: f64 = 0.4;
    const OUT: f64 = 0.2;

    /// The ellipsoids that grow on `parents`, not reaching below the lowest of them; each
    /// has the density and the edge of the one that it stands on.
    pub fn on(&self, parents: &[Ellipsoid]) -> Vec<Ellipsoid> {
        let dice = &mut Dice::new(self.seed);
        let growth = Growth { children: self.children, up: Self::UP, out: Self::OUT };
        let mut heap = Heap::upon(parents);
        for _ in 0..self.generations {
            heap.grow(dice, &growth);
        }
        heap.into_lumps().split_off(parents.len())
    }
}
