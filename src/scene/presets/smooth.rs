//! Heaps of a few smooth lumps: the shapes of the corpus, on which its figures stand. They change with no preset.

use glam::DVec3;

use super::heap::{Edges, Growth, Heap};
use crate::scene::dice::Dice;
use crate::scene::{Cloud, Noise, Scene};

/// A shape of the corpus.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Smooth {
    Humilis,
    Mediocris,
    Congestus,
    Cumulonimbus,
    Fractus,
    Stratocumulus,
}

impl Smooth {
    /// The scene of a seed: the same on every platform and in every run.
    pub(crate) fn scene(self, seed: u32) -> Scene {
        let dice = &mut Dice::new(u64::from(seed));
        let clouds = match self {
            Self::Humilis => vec![HUMILIS.grow(dice)],
            Self::Mediocris => vec![MEDIOCRIS.grow(dice)],
            Self::Congestus => vec![CONGESTUS.grow(dice)],
            Self::Cumulonimbus => vec![cumulonimbus(dice)],
            Self::Fractus => vec![fractus(dice)],
            Self::Stratocumulus => super::layer::rolls(dice),
        };
        Scene {
            clouds,
            noise: Noise { seed, scale: Some(self.billows()), ..Noise::default() },
            ..Scene::default()
        }
    }

    /// Size of the largest billows, metres: about one and a half times the boundary.
    fn billows(self) -> f64 {
        match self {
            Self::Humilis | Self::Fractus => 60.0,
            Self::Stratocumulus => 110.0,
            Self::Mediocris => 140.0,
            Self::Congestus => 280.0,
            Self::Cumulonimbus => 700.0,
        }
    }
}

/// How a cumulus grows: a flat layer, a trunk on it, heaps upon both. Lengths in metres.
struct Recipe {
    name: &'static str,
    /// Altitude of the base.
    base: f64,
    layer: Layer,
    /// Lumps one above the other: height of the centre above the base, radius.
    trunk: &'static [(f64, f64)],
    generations: &'static [Growth],
    edges: Edges,
}

/// Flat lumps side by side on the base.
struct Layer {
    count: usize,
    /// Radius of the largest.
    radius: f64,
    /// Distance of the outermost from the axis.
    spread: f64,
    /// Height over width.
    flatness: f64,
}

/// Fair weather: 200 to 500 m wide, wider than tall.
#[rustfmt::skip]
const HUMILIS: Recipe = Recipe {
    name: "humilis",
    base: 1000.0,
    layer: Layer { count: 6, radius: 80.0, spread: 105.0, flatness: 0.6 },
    trunk: &[(70.0, 72.0)],
    generations: &[
        Growth { children: (2, 4), up: 0.5, out: 0.1 },
    ],
    edges: Edges { boundary: 42.0, base: 0.35, top: 0.1 },
};

/// About as tall as wide, 800 m.
#[rustfmt::skip]
const MEDIOCRIS: Recipe = Recipe {
    name: "mediocris",
    base: 1000.0,
    layer: Layer { count: 6, radius: 190.0, spread: 230.0, flatness: 0.7 },
    trunk: &[(240.0, 220.0), (420.0, 190.0), (560.0, 140.0)],
    generations: &[
        Growth { children: (3, 4), up: 0.4, out: 0.2 },
        Growth { children: (0, 1), up: 0.6, out: 0.3 },
    ],
    edges: Edges { boundary: 105.0, base: 0.35, top: 0.05 },
};

/// A tower of 2 to 3 km, taller than wide, with cauliflower turrets.
#[rustfmt::skip]
const CONGESTUS: Recipe = Recipe {
    name: "congestus",
    base: 1000.0,
    layer: Layer { count: 5, radius: 400.0, spread: 480.0, flatness: 0.6 },
    trunk: &[(550.0, 500.0), (950.0, 450.0), (1350.0, 420.0), (1700.0, 360.0), (2000.0, 280.0)],
    generations: &[
        Growth { children: (3, 4), up: 0.3, out: 0.4 },
        Growth { children: (0, 1), up: 0.5, out: 0.4 },
    ],
    edges: Edges { boundary: 220.0, base: 0.3, top: 0.0 },
};

/// A thunderstorm: the tower that carries the anvil, 6 to 9 km in all.
#[rustfmt::skip]
const CUMULONIMBUS: Recipe = Recipe {
    name: "cumulonimbus",
    base: 1000.0,
    layer: Layer { count: 7, radius: 1700.0, spread: 3000.0, flatness: 0.45 },
    trunk: &[
        (1500.0, 2300.0), (2600.0, 2100.0), (3600.0, 1900.0),
        (4500.0, 1700.0), (5300.0, 1600.0), (6000.0, 1500.0),
    ],
    generations: &[
        Growth { children: (3, 4), up: 0.2, out: 0.3 },
    ],
    edges: Edges { boundary: 560.0, base: 0.3, top: 0.0 },
};

impl Recipe {
    /// The cloud that grows by this recipe.
    pub fn grow(&self, dice: &mut Dice) -> Cloud {
        let mut heap = Heap::on(self.base);
        self.layer.lay(dice, &mut heap);
        self.raise_trunk(dice, &mut heap);
        for generation in self.generations {
            heap.grow(dice, generation);
        }
        heap.into_cloud(self.name, &self.edges)
    }

    /// Lumps one above the other, the axis wandering a little.
    fn raise_trunk(&self, dice: &mut Dice, heap: &mut Heap) {
        let mut axis = DVec3::ZERO;
        for &(height, radius) in self.trunk {
            axis += 0.35 * radius * dice.disc();
            let radius = radius * dice.between(0.9, 1.1);
            let shape = DVec3::new(dice.between(0.9, 1.1), 0.85, dice.between(0.9, 1.1));
            heap.put(dice, axis + DVec3::Y * (self.base + height), radius * shape);
        }
    }
}

impl Layer {
    fn lay(&self, dice: &mut Dice, heap: &mut Heap) {
        for i in 0..self.count {
            let across = 2.0 * (i as f64 + 0.5) / self.count as f64 - 1.0;
            let jitter = dice.disc();
            let p = self.spread * DVec3::new(1.2 * across + 0.2 * jitter.x, 0.0, 0.7 * jitter.z);
            // The middle is the largest.
            let size = self.radius * dice.between(0.8, 1.0) * (1.0 - 0.25 * across * across);
            let shape = DVec3::new(dice.between(0.95, 1.15), self.flatness, dice.between(0.85, 1.05));
            heap.lay(dice, p, size * shape);
        }
    }
}

/// A thunderstorm with its anvil.
fn cumulonimbus(dice: &mut Dice) -> Cloud {
    let mut cloud = CUMULONIMBUS.grow(dice);
    cloud.ellipsoids.extend(anvil(dice).ellipsoids);
    cloud
}

/// Thin wispy sheets of ice around the top of the tower, drawn out downwind (east).
fn anvil(dice: &mut Dice) -> Cloud {
    const SHEETS: usize = 18;
    let mut heap = Heap::on(6300.0);
    for i in 0..SHEETS {
        let along = i as f64 / (SHEETS - 1) as f64;
        let jitter = dice.disc();
        let p = DVec3::new(
            -2600.0 + 8400.0 * along + 300.0 * jitter.x,
            7150.0 + 250.0 * along + dice.between(-80.0, 80.0),
            (2300.0 - 900.0 * along) * jitter.z,
        );
        let size = dice.between(0.8, 1.1) * (1.0 - 0.25 * along);
        heap.put(dice, p, size * DVec3::new(2100.0, 520.0 - 200.0 * along, 1800.0));
    }
    let mut cloud = heap.into_cloud("anvil", &ICE);
    for sheet in &mut cloud.ellipsoids {
        sheet.density = 0.25;
    }
    cloud
}

/// Edges of an anvil: wispy all over.
const ICE: Edges = Edges { boundary: 450.0, base: 0.85, top: 0.85 };

/// Edges of a torn cloud.
const SHREDS: Edges = Edges { boundary: 75.0, base: 0.95, top: 0.85 };

/// Small torn shreds under a shower or in the morning.
fn fractus(dice: &mut Dice) -> Cloud {
    let mut heap = Heap::on(600.0);
    for _ in 0..dice.count(10, 14) {
        let p = dice.disc() * DVec3::new(200.0, 0.0, 120.0);
        let size = dice.between(0.6, 1.0);
        let radii = size * DVec3::new(110.0, 46.0, 70.0);
        let lift = dice.between(0.0, 60.0);
        heap.put(dice, p + DVec3::Y * (600.0 + radii.y + lift), radii);
    }
    let mut cloud = heap.into_cloud("fractus", &SHREDS);
    for shred in &mut cloud.ellipsoids {
        shred.density = 0.4;
    }
    cloud
}
