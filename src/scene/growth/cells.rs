//! Stratocumulus in cells: patches with narrow gaps, or rings around clear air.

use glam::{DQuat, DVec3};

use super::Growth;
use super::pile::{Brood, Lump, Part, Pile, mixed};
use crate::scene::dice::Dice;

/// How cells are filled.
pub(super) struct Fill {
    /// Distance of cells, metres by metre of height: convection cells are wide and flat.
    spacing: f64,
    /// Whether cloud is where cells meet, rather than in them.
    open: bool,
    /// Radius of a lump on the base, of the distance of cells.
    lump: f64,
}

pub(super) const CLOSED: Fill = Fill { spacing: 4.2, open: false, lump: 0.2 };
pub(super) const OPEN: Fill = Fill { spacing: 5.0, open: true, lump: 0.12 };

/// Places tried for lumps on the base.
const TRIES: u64 = 6000;
/// Lumps on the base, at most: the rest is for what grows on them.
const MOST_ON_BASE: usize = 800;

/// Grows a field of cells.
pub(super) fn fill(growth: &Growth, fill: &Fill, pile: &mut Pile) {
    let key = mixed(u64::from(growth.seed), 13);
    // Not more cells than there are lumps for.
    let spacing = (fill.spacing * growth.height).max(growth.width / 9.0);
    let middles = Middles { key, spacing };
    let mut placed: Vec<(DVec3, f64)> = Vec::new();
    for i in 0..TRIES {
        if placed.len() >= MOST_ON_BASE {
            break;
        }
        let dice = &mut Dice::new(mixed(key, 10_000 + i));
        let p = dice.disc() * 0.5 * growth.width;
        let thick = middles.thickness(p, fill.open, growth.coverage);
        let size = spacing * fill.lump * dice.between(0.7, 1.2) * (0.55 + 0.45 * thick);
        if thick <= 0.0 || placed.iter().any(|(q, r)| q.distance_squared(p) < 0.42 * (size + r) * size) {
            continue;
        }
        placed.push((p, size));
        let half = 0.5 * growth.height * (0.3 + 0.6 * thick) * dice.between(0.75, 1.0);
        let half = half.min(0.9 * size);
        // A flat base cuts its lower third off.
        let cut = if fill.open { 0.5 * half } else { 0.0 };
        let radii = DVec3::new(size * dice.between(0.95, 1.3), half + cut, size * dice.between(0.85, 1.1));
        let lump = Lump {
            center: p + DVec3::Y * (half - cut),
            radii,
            turn: dice.yaw(),
            size,
            generation: 0,
            part: Part::Heap,
            key: mixed(key, 20_000 + i),
        };
        pile.put(lump);
    }
    if pile.lumps().is_empty() {
        // Too small a piece of sky for a cell: one patch.
        let radii = DVec3::new(0.4 * growth.width, 0.4 * growth.height, 0.4 * growth.width);
        let (center, turn, size) = (DVec3::Y * radii.y, DQuat::IDENTITY, radii.x);
        pile.put(Lump { center, radii, turn, size, generation: 0, part: Part::Heap, key });
    }
    heads(growth.least(0.035 * spacing), pile);
}

/// Low heads on the upper side.
fn heads(least: f64, pile: &mut Pile) {
    let brood = Brood { tries: 3, ratio: (0.3, 0.5), seat: 0.82, lowest: 0.1, least };
    let first = 0..pile.lumps().len();
    let next = first.end;
    pile.grow(first, &brood);
    let second = next..pile.lumps().len();
    pile.grow(second, &Brood { tries: 1, ..brood });
}

/// Middles of cells: a lattice of triangles, disturbed.
struct Middles {
    key: u64,
    spacing: f64,
}

impl Middles {
    fn of(&self, column: i64, row: i64) -> DVec3 {
        let dice = &mut Dice::new(mixed(self.key, ((column + 500) * 1000 + row + 500) as u64));
        let shift = if row.rem_euclid(2) == 1 { 0.5 } else { 0.0 };
        let lattice = DVec3::new(column as f64 + shift, 0.0, 0.866 * row as f64);
        self.spacing * (lattice + 0.36 * dice.disc())
    }

    /// How thick the cloud is at `p`: 0 none, 1 the thickest.
    fn thickness(&self, p: DVec3, open: bool, coverage: f64) -> f64 {
        let (column, row) = (p.x / self.spacing, p.z / (0.866 * self.spacing));
        let mut nearest = [f64::INFINITY; 3];
        for r in -2..=2 {
            for c in -2..=2 {
                let d = p.distance(self.of(column.floor() as i64 + c, row.floor() as i64 + r));
                let mut d = d / self.spacing;
                for n in &mut nearest {
                    if d < *n {
                        std::mem::swap(n, &mut d);
                    }
                }
            }
        }
        // 0 on the line where two cells meet.
        let inside = nearest[1] - nearest[0];
        let corner = nearest[2] - nearest[0];
        match open {
            // Thickest where three cells meet.
            true => {
                let wall = 0.75 * coverage;
                (1.0 - inside / wall).min(1.0) * (1.25 - corner).clamp(0.45, 1.0)
            }
            false => ((inside - 0.45 * (1.0 - coverage)) * 2.2).min(1.0),
        }
    }
}
