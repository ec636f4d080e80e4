//! Cumulus: updraughts of different height and strength over a flat base, and heaps upon them.

use glam::DVec3;

use super::pile::{Brood, Lump, Part, Pile, mixed};
use super::{Growth, storm};
use crate::scene::dice::Dice;

/// What is usual for a kind. Lengths are shares of half the width, heights of the height.
pub(super) struct Habit {
    /// Depth of the base against its width.
    depth: f64,
    /// Least and greatest number of turrets that stand out.
    cores: (usize, usize),
    /// Height of the second turret and of the last, of the first one's.
    lesser: (f64, f64),
    /// Radius of a turret at its foot.
    foot: f64,
    /// Least and greatest number of lower turrets around each.
    flanks: (usize, usize),
    /// How much narrower turrets are at their heads.
    waist: f64,
    /// Lower plumes around them, where all of the base rises.
    plumes: usize,
    /// Height of the air between turrets.
    shelf: f64,
    broods: [Brood; 3],
}

const fn brood(tries: u32, lowest: f64, least: f64) -> Brood {
    Brood { tries, ratio: (0.34, 0.6), seat: 0.92, lowest, least }
}

pub(super) const HUMILIS: Habit = Habit {
    depth: 0.7,
    cores: (2, 4),
    lesser: (0.9, 0.6),
    foot: 0.3,
    flanks: (1, 3),
    waist: 0.34,
    plumes: 24,
    shelf: 0.36,
    broods: [brood(11, -0.2, 0.04), brood(8, -0.2, 0.04), brood(5, -0.1, 0.045)],
};

pub(super) const MEDIOCRIS: Habit = Habit {
    depth: 0.75,
    cores: (2, 4),
    lesser: (0.8, 0.45),
    foot: 0.36,
    flanks: (2, 4),
    waist: 0.34,
    plumes: 18,
    shelf: 0.2,
    broods: [brood(13, -0.35, 0.04), brood(9, -0.35, 0.04), brood(5, -0.3, 0.045)],
};

pub(super) const CONGESTUS: Habit = Habit {
    depth: 0.8,
    cores: (3, 5),
    lesser: (0.8, 0.35),
    foot: 0.36,
    flanks: (3, 5),
    waist: 0.34,
    plumes: 18,
    shelf: 0.14,
    broods: [brood(14, -0.4, 0.035), brood(9, -0.4, 0.035), brood(4, -0.35, 0.04)],
};

/// Generations of lumps on the turrets of a storm.
const STORM: [Brood; 3] = [brood(15, -0.45, 0.025), brood(8, -0.45, 0.03), brood(2, -0.3, 0.04)];

/// A column of rising air.
pub(super) struct Plume {
    /// Its foot on the base, metres.
    pub foot: DVec3,
    /// Height of its head, metres.
    pub height: f64,
    /// Radius at the foot, metres.
    pub radius: f64,
    /// How much narrower it is at its head.
    pub waist: f64,
    pub key: u64,
}

/// Grows a cumulus.
pub(super) fn grow(growth: &Growth, habit: &Habit, pile: &mut Pile) {
    heap(growth, &plan(growth, habit), &habit.broods, pile);
}

/// Grows the tower of a thunderstorm.
pub(super) fn grow_storm(growth: &Growth, pile: &mut Pile) {
    heap(growth, &storm::plan(growth), &STORM, pile);
}

/// Raises plumes, and grows generations of lumps upon them.
fn heap(growth: &Growth, plumes: &[Plume], broods: &[Brood], pile: &mut Pile) {
    for plume in plumes {
        raise(growth, plume, pile);
    }
    let half = 0.5 * growth.width;
    let mut parents = 0..pile.lumps().len();
    for brood in broods {
        let brood = Brood { least: growth.least(brood.least * half), ..*brood };
        let next = pile.lumps().len();
        pile.grow(parents, &brood);
        parents = next..pile.lumps().len();
    }
}

/// Where air rises, and how high: a few turrets, the lower air around them, gaps.
fn plan(growth: &Growth, habit: &Habit) -> Vec<Plume> {
    let key = mixed(u64::from(growth.seed), 1 + growth.kind as u64);
    let dice = &mut Dice::new(key);
    let half = 0.5 * growth.width;
    let base = DVec3::new(1.0, 1.0, habit.depth);
    let sunken = growth.height * (1.0 - 0.3 * growth.age);
    let count = dice.count(habit.cores.0, habit.cores.1);
    let mut plumes: Vec<Plume> = Vec::new();
    for i in 0..count {
        let rank = i as f64 / (count - 1).max(1) as f64;
        let share = if i == 0 { 1.0 } else { habit.lesser.0 + (habit.lesser.1 - habit.lesser.0) * rank };
        let share = if i == 0 { share } else { share * dice.between(0.85, 1.12) };
        let spread = if i == 0 { 0.4 } else { 0.72 };
        let foot = apart(dice, &plumes, half, base, spread);
        let radius = half * habit.foot * (0.65 + 0.35 * share) * dice.between(0.9, 1.15);
        plumes.push(Plume {
            foot,
            height: sunken * share,
            radius,
            waist: habit.waist,
            key: mixed(key, 100 + i as u64),
        });
    }
    let cores = plumes.len();
    for i in 0..cores {
        flank(&mut plumes, i, habit, growth);
    }
    for i in 0..(habit.plumes as f64 * growth.coverage / 0.7).round() as usize {
        let dice = &mut Dice::new(mixed(key, 1000 + i as u64));
        // Around one of the turrets, as far as the rim of the base.
        let near = &plumes[dice.count(0, cores - 1)];
        let foot = near.foot + dice.disc() * base * half * 0.62;
        let out = (foot / base).length() / half;
        if out > 0.92 {
            continue;
        }
        let shelf = sunken * habit.shelf * dice.between(0.5, 1.4) * (1.2 - 0.7 * out);
        let radius = half * habit.foot * dice.between(0.5, 0.85) * (1.0 - 0.3 * out);
        plumes.push(Plume {
            foot,
            height: shelf,
            radius,
            waist: habit.waist,
            key: mixed(key, 2000 + i as u64),
        });
    }
    plumes
}

/// Lower turrets close around turret `core`: it stands on shoulders, more of them the higher it is.
fn flank(plumes: &mut Vec<Plume>, core: usize, habit: &Habit, growth: &Growth) {
    let (foot, height, radius, key) = {
        let core = &plumes[core];
        (core.foot, core.height, core.radius, core.key)
    };
    let dice = &mut Dice::new(mixed(key, 77));
    let count = dice.count(habit.flanks.0, habit.flanks.1);
    for i in 0..count {
        let dice = &mut Dice::new(mixed(key, 300 + i as u64));
        let away = dice.between(0.55, 1.5);
        let way = dice.cap(0.0).with_y(0.0).normalize_or(DVec3::X);
        let foot = foot + way * DVec3::new(1.0, 0.0, habit.depth) * away * radius;
        // Steps down from the turret, by chance.
        let height = height * (1.06 - 0.36 * away) * dice.between(0.62, 1.0);
        let radius = radius * dice.between(0.55, 0.85);
        if (foot / DVec3::new(1.0, 1.0, habit.depth)).length() < 0.5 * growth.width {
            plumes.push(Plume { foot, height, radius, waist: habit.waist, key: mixed(key, 400 + i as u64) });
        }
    }
}

/// A foot within `spread` of the middle, the one of some that is farthest from those that are there.
fn apart(dice: &mut Dice, plumes: &[Plume], half: f64, base: DVec3, spread: f64) -> DVec3 {
    let mut best = (-1.0, DVec3::ZERO);
    for _ in 0..4 {
        let foot = dice.disc() * base * half * spread;
        let free = plumes.iter().map(|p| p.foot.distance(foot)).fold(f64::INFINITY, f64::min);
        if free > best.0 {
            best = (free, foot);
        }
    }
    best.1
}

/// The chain of lumps of a plume: wide at the foot, narrower above, with a head; it wanders, and leans with the shear.
fn raise(growth: &Growth, plume: &Plume, pile: &mut Pile) {
    let dice = &mut Dice::new(plume.key);
    let slender = (growth.height / growth.width - 1.0).clamp(0.0, 1.0);
    let bends = Bends::of(plume, slender);
    let mut radius = plume.radius.min(0.62 * plume.height).max(0.2 * plume.radius);
    let mut at = plume.foot + DVec3::Y * 0.45 * radius;
    let mut step = 0;
    loop {
        let rest = plume.height - at.y;
        let last = rest < 1.25 * radius;
        if last {
            // The head ends at the height of the plume.
            at.y = at.y.max(plume.height - radius);
        }
        put(pile, dice, at, radius, mixed(plume.key, step));
        if last || step > 40 {
            break;
        }
        let rise = radius * dice.between(0.5, 0.8);
        let share = at.y / growth.height;
        let along = (at.y / plume.height).min(1.0);
        at += DVec3::new(growth.lean * rise * (0.5 + share), rise, 0.0) + 0.32 * radius * dice.disc();
        at += rise * bends.slope(along);
        let waist = (1.0 - (1.0 - 0.7 * slender) * plume.waist * along) * bends.bulge(along);
        let flare = 1.0 + growth.age * 0.5 * (at.y / plume.height).min(1.0);
        radius = plume.radius.min(0.62 * plume.height) * waist * flare * dice.between(0.85, 1.15);
        step += 1;
    }
}

/// How a slender column departs from a straight cone.
struct Bends {
    /// Horizontal way from its foot up, metres by metre; it turns back above.
    way: DVec3,
    /// Share of the height where it turns.
    turn: f64,
    /// Places, shares of the height, and strengths of its bulges and waists.
    bulges: [(f64, f64); 3],
}

impl Bends {
    fn of(plume: &Plume, slender: f64) -> Self {
        let dice = &mut Dice::new(mixed(plume.key, 9000));
        let way = 0.45 * slender * dice.disc();
        let turn = dice.between(0.35, 0.65);
        let bulges = [(0.2, 0.3), (0.55, -0.3), (0.82, 0.45)];
        let bulge =
            |(at, by): (f64, f64)| (at + dice.between(-0.12, 0.12), by * slender * dice.between(0.6, 1.4));
        Self { way, turn, bulges: bulges.map(bulge) }
    }

    fn slope(&self, along: f64) -> DVec3 {
        self.way * (1.0 - along / self.turn)
    }

    fn bulge(&self, along: f64) -> f64 {
        let near = |at: f64| (1.0 - ((along - at) / 0.22) * ((along - at) / 0.22)).max(0.0);
        1.0 + self.bulges.iter().map(|(at, by)| by * near(*at)).sum::<f64>()
    }
}

fn put(pile: &mut Pile, dice: &mut Dice, center: DVec3, size: f64, key: u64) {
    let shape = DVec3::new(dice.between(0.95, 1.18), dice.between(0.86, 1.0), dice.between(0.92, 1.12));
    let turn = dice.yaw();
    pile.put(Lump { center, radii: size * shape, turn, size, generation: 0, part: Part::Heap, key });
}
