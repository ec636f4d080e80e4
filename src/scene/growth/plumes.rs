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
    /// Least and greatest height of the turrets beside the first, of its own.
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

impl Habit {
    /// Extent of the base along each axis, of half the width.
    fn base(&self) -> DVec3 {
        DVec3::new(1.0, 1.0, self.depth)
    }
}

const fn brood(tries: u32, lowest: f64, least: f64) -> Brood {
    Brood { tries, ratio: (0.34, 0.6), seat: 0.88, lowest, least }
}

pub(super) const HUMILIS: Habit = Habit {
    depth: 0.7,
    cores: (2, 4),
    lesser: (0.55, 0.9),
    foot: 0.3,
    flanks: (1, 3),
    waist: 0.34,
    plumes: 36,
    shelf: 0.63,
    broods: [brood(16, -0.25, 0.056), brood(12, -0.25, 0.056), brood(6, -0.2, 0.056)],
};

pub(super) const MEDIOCRIS: Habit = Habit {
    depth: 0.75,
    cores: (2, 4),
    lesser: (0.4, 0.85),
    foot: 0.36,
    flanks: (2, 4),
    waist: 0.34,
    plumes: 18,
    shelf: 0.3,
    broods: [brood(20, -0.35, 0.049), brood(16, -0.35, 0.049), brood(8, -0.3, 0.049)],
};

pub(super) const CONGESTUS: Habit = Habit {
    depth: 0.8,
    cores: (3, 5),
    lesser: (0.35, 0.85),
    foot: 0.38,
    flanks: (3, 5),
    waist: 0.3,
    plumes: 26,
    shelf: 0.3,
    broods: [brood(22, -0.4, 0.049), brood(16, -0.4, 0.049), brood(8, -0.35, 0.049)],
};

/// Generations of lumps on the turrets of a storm.
const STORM: [Brood; 3] = [brood(14, -0.45, 0.045), brood(9, -0.45, 0.045), brood(3, -0.3, 0.045)];

/// Where columns of rising air begin: their lowest lump is cut in a third of its radius.
pub(super) const RISE: f64 = 0.3;

/// A column of rising air.
pub(super) struct Plume {
    /// Its foot on the base, metres.
    pub foot: DVec3,
    /// Height of its head, metres.
    pub height: f64,
    /// Radius at the foot, metres.
    pub radius: f64,
    /// Height of its lowest lump's middle above the base, of its radius: the less of it, the more is cut off level.
    pub rise: f64,
    /// How much narrower it is at its head.
    pub waist: f64,
    /// Horizontal way, metres by metre of height.
    pub lean: DVec3,
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
    let crowd = Crowd::of(growth);
    let mut plumes = turrets(growth, habit, &crowd, key);
    let cores = plumes.len();
    for i in 0..cores {
        flank(&mut plumes, i, habit, growth);
    }
    let count = (habit.plumes as f64 * crowd.many * growth.coverage / 0.7).round() as u64;
    let low: Vec<_> = (0..count)
        .filter_map(|i| low_air(growth, habit, &crowd, &plumes[..cores], mixed(key, 1000 + i)))
        .collect();
    plumes.extend(low);
    plumes
}

/// How turrets share a base: the flatter a cloud is beside what is usual, the more of them there are, and the smaller they are.
struct Crowd {
    /// How much flatter than usual it is, 0 to 1.
    flatness: f64,
    /// How many times as many turrets as usual there are.
    many: f64,
    /// Radius of the first of them and of the others, of the usual.
    first: f64,
    others: f64,
}

impl Crowd {
    fn of(growth: &Growth) -> Self {
        let usual = Growth::new(growth.kind, 0);
        // Eight times as many at most.
        let flat = (growth.slope() / usual.slope()).clamp(0.25, 1.0);
        let few = flat * flat.sqrt();
        let first = flat.sqrt().sqrt();
        Self { flatness: 1.0 - flat, many: 1.0 / few, first, others: few.sqrt() }
    }
}

/// Turrets that stand out.
fn turrets(growth: &Growth, habit: &Habit, crowd: &Crowd, key: u64) -> Vec<Plume> {
    let dice = &mut Dice::new(key);
    let (half, base) = (0.5 * growth.width, habit.base());
    // Where it is taller than wide, one turret stands out.
    let slender = (growth.slope() - 1.0).clamp(0.0, 1.0);
    let count = (dice.count(habit.cores.0, habit.cores.1) as f64 * crowd.many).round() as u64;
    let mut plumes: Vec<Plume> = Vec::new();
    for i in 0..count {
        let lesser = dice.between(habit.lesser.0, habit.lesser.1) * (1.0 - 0.4 * slender);
        // Heads of flat clouds are more of one height.
        let lesser = lesser + 0.5 * crowd.flatness * (1.0 - lesser);
        let (spread, small) = if i == 0 { (0.4, crowd.first) } else { (0.8, crowd.others) };
        let foot = apart(dice, &plumes, half, base, spread);
        let out = (foot / base).length() / half;
        // Flat clouds are lowest at their rims.
        let share = if i == 0 { 1.0 } else { lesser * (1.0 - crowd.flatness * out * out) };
        let strength = (0.65 + 0.35 * share) * (1.0 + 0.7 * slender);
        let radius = half * habit.foot * small * strength * dice.between(0.85, 1.15);
        let lean = 0.22 * dice.disc();
        let key = mixed(key, 100 + i);
        plumes.push(Plume {
            foot,
            height: sunken(growth) * share,
            radius,
            rise: RISE,
            waist: habit.waist,
            lean,
            key,
        });
    }
    plumes
}

/// A lower plume around one of the turrets `cores`, as far as the rim of the base; none beyond.
fn low_air(growth: &Growth, habit: &Habit, crowd: &Crowd, cores: &[Plume], key: u64) -> Option<Plume> {
    let dice = &mut Dice::new(key);
    let (half, base) = (0.5 * growth.width, habit.base());
    // One more turret takes some plumes, and leaves the others where they are.
    let near = cores.iter().max_by_key(|core| mixed(key, core.key))?;
    let away = dice.disc();
    let foot = near.foot + away * base * half * 0.62;
    let out = (foot / base).length() / half;
    if out > 0.92 {
        return None;
    }
    // Low air is all over, and some is taken along by its turret.
    let low = sunken(growth) * habit.shelf * dice.between(0.5, 1.4) * (1.2 - 0.7 * out);
    let taken = 0.8 * near.height * dice.between(0.5, 1.1) * (1.0 - away.length());
    let radius = half * habit.foot * crowd.others * dice.between(0.5, 0.85) * (1.0 - 0.3 * out);
    // That of flat clouds is about as tall as wide, and ends round at the rim: no plate sticks out.
    let shoulders = (3.0 * crowd.flatness).min(1.0);
    let least = (1.6 * shoulders * radius).min(0.6 * sunken(growth));
    let (height, key) = (low.max(taken).max(least), mixed(key, 1));
    let rise = RISE + 0.6 * shoulders * out * out;
    Some(Plume { foot, height, radius, rise, waist: habit.waist, lean: DVec3::ZERO, key })
}

/// Height of the highest turret, metres: an old cloud has sunken.
fn sunken(growth: &Growth) -> f64 {
    growth.height * (0.93 - 0.3 * growth.age)
}

/// Lower turrets close around turret `core`, of any height below its own, which lean away from it.
fn flank(plumes: &mut Vec<Plume>, core: usize, habit: &Habit, growth: &Growth) {
    let (foot, height, radius, key) = {
        let core = &plumes[core];
        (core.foot, core.height, core.radius, core.key)
    };
    let dice = &mut Dice::new(mixed(key, 77));
    let count = dice.count(habit.flanks.0, habit.flanks.1);
    for i in 0..count {
        let dice = &mut Dice::new(mixed(key, 300 + i as u64));
        let away = dice.between(0.7, 1.5);
        let way = dice.cap(0.0).with_y(0.0).normalize_or(DVec3::X);
        let foot = foot + way * DVec3::new(1.0, 0.0, habit.depth) * away * radius;
        let height = height * dice.between(0.3, 0.85);
        let radius = radius * dice.between(0.55, 0.85);
        let lean = dice.between(0.0, 0.3) * way;
        if (foot / DVec3::new(1.0, 1.0, habit.depth)).length() < 0.5 * growth.width {
            let key = mixed(key, 400 + i as u64);
            plumes.push(Plume { foot, height, radius, rise: RISE, waist: habit.waist, lean, key });
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

/// The chain of lumps of a plume: wide at the foot, narrower above, with a head that bulges; it wanders, leans its
/// own way and with the shear.
fn raise(growth: &Growth, plume: &Plume, pile: &mut Pile) {
    let dice = &mut Dice::new(plume.key);
    // Low air is flat: no lump is taller than it.
    let foot = plume.radius.min(0.62 * plume.height).max(0.2 * plume.radius);
    let shape = Shape::of(plume, foot);
    let mut at = plume.foot + DVec3::Y * plume.rise * foot;
    let mut radius = foot;
    for step in 0..=40 {
        let rest = plume.height - at.y;
        let last = rest < 1.25 * radius || step == 40;
        if last {
            // The head ends at the height of the plume.
            at.y = at.y.max(plume.height - 0.9 * radius);
        }
        put(pile, dice, at, radius, mixed(plume.key, step));
        if last {
            crown(pile, at, radius, shape.slender, plume.key);
            break;
        }
        let rise = radius * dice.between(0.45, 0.75);
        let along = (at.y / plume.height).min(1.0);
        at += DVec3::new(growth.lean * rise * (0.5 + at.y / growth.height), rise, 0.0);
        at += rise * shape.way(along) + 0.25 * radius * dice.disc();
        let flare = 1.0 + growth.age * 0.5 * along;
        radius = foot * shape.width((at.y / plume.height).min(1.0)) * flare * dice.between(0.88, 1.12);
    }
}

/// Lumps around the head of a turret, as many as it is slender: it is wider than its neck.
fn crown(pile: &mut Pile, at: DVec3, radius: f64, slender: f64, key: u64) {
    for i in 0..(4.0 * slender).round() as u64 {
        let key = mixed(key, 5000 + i);
        let dice = &mut Dice::new(key);
        let way = dice.cap(0.0).with_y(0.0).normalize_or(DVec3::X);
        let size = radius * dice.between(0.5, 0.75);
        let at = at + dice.between(0.7, 1.0) * radius * way - DVec3::Y * radius * dice.between(-0.1, 0.6);
        put(pile, dice, at, size, key);
    }
}

/// How the column of a plume departs from a straight one.
struct Shape {
    /// How much of a turret it is, not low air: 0 to 1.
    slender: f64,
    /// Horizontal way from its foot up, metres by metre; it turns back above.
    bend: DVec3,
    /// Share of the height where it turns.
    turn: f64,
    /// Its own lean, metres by metre.
    lean: DVec3,
    /// How much narrower its neck is, and wider its head.
    neck: f64,
    head: f64,
    /// Share of the height where it is narrowest.
    narrow: f64,
}

impl Shape {
    fn of(plume: &Plume, foot: f64) -> Self {
        let dice = &mut Dice::new(mixed(plume.key, 9000));
        let slender = (plume.height / (4.0 * foot) - 0.5).clamp(0.0, 1.0);
        let bend = 0.35 * slender * dice.disc();
        let turn = dice.between(0.35, 0.65);
        let neck = plume.waist * dice.between(0.7, 1.2);
        let head = slender * dice.between(0.0, 0.35);
        Self { slender, bend, turn, lean: slender * plume.lean, neck, head, narrow: dice.between(0.45, 0.7) }
    }

    /// Horizontal way at a share of the height, metres by metre.
    fn way(&self, along: f64) -> DVec3 {
        self.lean + self.bend * (1.0 - along / self.turn)
    }

    /// Radius at a share of the height, of the foot's.
    fn width(&self, along: f64) -> f64 {
        if along < self.narrow {
            let down = 1.0 - along / self.narrow;
            return 1.0 - self.neck * (1.0 - down * down);
        }
        let up = (along - self.narrow) / (1.0 - self.narrow);
        1.0 - self.neck + self.head * up * (2.0 - up)
    }
}

fn put(pile: &mut Pile, dice: &mut Dice, center: DVec3, size: f64, key: u64) {
    let shape = DVec3::new(dice.between(0.95, 1.18), dice.between(0.86, 1.0), dice.between(0.92, 1.12));
    let turn = dice.yaw();
    pile.put(Lump { center, radii: size * shape, turn, size, generation: 0, part: Part::Heap, key });
}
