//! What is there between two steps of a volume: density is read back along its motion from both of them, and blended.
//!
//! What is at x at the share s of the way from step 0 to step 1 was at x - s d in step 0 and will be at x + (1 - s) d in
//! step 1, where d is how far it goes from one to the other: (1 - s) rho_0(x - s d) + s rho_1(x + (1 - s) d). Both are the same
//! matter where the motion is known, so that nothing is there twice. Where d differs from place to place it is that of the
//! matter which comes to x, found by going back and looking again (Robert 1981, for semi-Lagrangian advection); matter that
//! would not come to x by its own way is none of it.

use std::collections::{HashMap, HashSet};

use glam::{DAffine3, DVec3, IVec3, Vec3, Vec4};
use rayon::prelude::*;

use super::block::{BLOCK_EDGE, BLOCK_VOXELS, Block, voxel};
use super::grid::Grid;

/// How often the way of what comes to a point is looked for, at most.
const ROUNDS: usize = 6;
/// What comes to within so many voxels of a point counts there, and what misses it by more than so many does not.
const NEAR: f64 = 1.0;
const FAR: f64 = 4.0;
/// Most blocks by which velocities are carried on beyond where they are told.
const FARTHEST: usize = 64;

/// How fast matter goes, in a file's lengths a second, in blocks of 8^3 voxels.
#[derive(Debug, Clone)]
pub(crate) struct Velocity {
    /// From numbers of voxels to the file's lengths.
    pub place: DAffine3,
    pub blocks: HashMap<[i32; 3], Box<[Vec3; BLOCK_VOXELS]>>,
}

/// How far matter goes from one step to the next, in a file's lengths.
pub(super) enum Motion {
    /// All of it as far.
    Even(DVec3),
    /// As far as it tells.
    Field(Box<Field>),
}

/// Ways that are told where there is matter, and carried on from there.
pub(super) struct Field {
    voxels_from_file: DAffine3,
    /// Ways of voxels, and whether they are told: 1, or 0 where they are not.
    told: HashMap<[i32; 3], Box<[Vec4; BLOCK_VOXELS]>>,
    /// Means of blocks.
    means: HashMap<[i32; 3], DVec3>,
}

impl Motion {
    /// That of matter which goes as fast as `velocity` for so many `seconds`. What has density and no velocity stands still.
    pub fn of(velocity: &Velocity, grid: &Grid, seconds: f64) -> Self {
        let density = Sampler::new(grid);
        let file_from_voxels = velocity.place;
        let told = velocity.blocks.iter().map(|(index, speeds)| {
            let first = BLOCK_EDGE * IVec3::from(*index);
            let mut ways = Box::new([Vec4::ZERO; BLOCK_VOXELS]);
            for (i, (way, speed)) in ways.iter_mut().zip(speeds.iter()).enumerate() {
                let at = file_from_voxels.transform_point3((first + within(i)).as_dvec3());
                if *speed != Vec3::ZERO || density.at(at) > 0.0 {
                    *way = (*speed * seconds as f32).extend(1.0);
                }
            }
            (*index, ways)
        });
        let told: HashMap<_, _> = told.collect();
        let means = carried_on(&told, velocity.place.inverse());
        Self::Field(Box::new(Field { voxels_from_file: velocity.place.inverse(), told, means }))
    }

    fn at(&self, p: DVec3) -> DVec3 {
        match self {
            Self::Even(way) => *way,
            Self::Field(field) => field.at(p),
        }
    }

    /// Least and greatest ways along each axis.
    fn bounds(&self) -> (DVec3, DVec3) {
        match self {
            Self::Even(way) => (*way, *way),
            Self::Field(field) => {
                let ways =
                    field.told.values().flat_map(|ways| ways.iter()).map(|way| way.truncate().as_dvec3());
                ways.fold((DVec3::ZERO, DVec3::ZERO), |(low, high), way| (low.min(way), high.max(way)))
            }
        }
    }
}

/// Means of blocks that tell ways, carried on to their neighbours as far as those ways may lead.
fn carried_on(
    told: &HashMap<[i32; 3], Box<[Vec4; BLOCK_VOXELS]>>,
    voxels_from_file: DAffine3,
) -> HashMap<[i32; 3], DVec3> {
    let mean = |ways: &[Vec4; BLOCK_VOXELS]| {
        let sum: Vec4 = ways.iter().sum();
        (sum.w > 0.0).then(|| (sum.truncate() / sum.w).as_dvec3())
    };
    let mut means: HashMap<[i32; 3], DVec3> =
        told.iter().filter_map(|(index, ways)| Some((*index, mean(ways)?))).collect();
    let blocks = |way: &DVec3| (voxels_from_file.matrix3 * *way).abs().max_element() / f64::from(BLOCK_EDGE);
    let farthest = means.values().map(blocks).fold(0.0, f64::max).ceil() as usize + 2;
    let mut rim: Vec<[i32; 3]> = means.keys().copied().collect();
    for _ in 0..farthest.min(FARTHEST) {
        let next: HashSet<[i32; 3]> =
            rim.iter().flat_map(around).filter(|index| !means.contains_key(index)).collect();
        rim = next.iter().copied().collect();
        rim.sort_unstable();
        let found: Vec<_> = rim
            .iter()
            .map(|index| {
                let known = around(index).filter_map(|near| means.get(&near));
                let (count, sum) =
                    known.fold((0.0, DVec3::ZERO), |(count, sum), way| (count + 1.0, sum + *way));
                (*index, sum / f64::max(count, 1.0))
            })
            .collect();
        means.extend(found);
    }
    means
}

/// A block and the 26 around it.
fn around(index: &[i32; 3]) -> impl Iterator<Item = [i32; 3]> + use<> {
    let index = IVec3::from(*index);
    (0..27).map(move |i| (index + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1).to_array())
}

/// The place of number `i` of a block in it.
fn within(i: usize) -> IVec3 {
    let i = i as i32;
    IVec3::new(i / (BLOCK_EDGE * BLOCK_EDGE), i / BLOCK_EDGE % BLOCK_EDGE, i % BLOCK_EDGE)
}

impl Field {
    /// How far what is at `p` goes: between voxels, and where those tell nothing as the blocks around.
    fn at(&self, p: DVec3) -> DVec3 {
        let p = self.voxels_from_file.transform_point3(p);
        let told = values(&self.told, p)
            .fold(Vec4::ZERO, |sum, (way, weight)| sum + weight as f32 * way.copied().unwrap_or_default());
        let share = f64::from(told.w);
        let own = told.truncate().as_dvec3();
        if share > 1.0 - 1e-6 { own / share } else { own + (1.0 - share) * self.mean(p) }
    }

    /// Between the middles of blocks, at a place in voxels.
    fn mean(&self, p: DVec3) -> DVec3 {
        let p = (p + 0.5) / f64::from(BLOCK_EDGE) - 0.5;
        let (weights, ways) = corners(p).fold((0.0, DVec3::ZERO), |(weights, ways), (at, weight)| match self
            .means
            .get(&at.to_array())
        {
            Some(way) => (weights + weight, ways + weight * *way),
            None => (weights, ways),
        });
        if weights > 0.0 { ways / weights } else { DVec3::ZERO }
    }
}

/// The eight whole places around one, and what each of them weighs there.
fn corners(p: DVec3) -> impl Iterator<Item = (IVec3, f64)> {
    let first = p.floor();
    let share = p - first;
    (0..8).map(move |i| {
        let step = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
        let weight = DVec3::select(step.cmpeq(IVec3::ONE), share, 1.0 - share);
        (first.as_ivec3() + step, weight.element_product())
    })
}

/// Those of the eight voxels around a place, and what each of them weighs there.
fn values<'a, T: 'a, B: std::ops::Deref<Target = [T; BLOCK_VOXELS]>>(
    blocks: &'a HashMap<[i32; 3], B>,
    p: DVec3,
) -> impl Iterator<Item = (Option<&'a T>, f64)> {
    // They mostly are in one block.
    let mut known: Option<([i32; 3], Option<&'a B>)> = None;
    corners(p).map(move |(at, weight)| {
        let index = at.map(|i| i.div_euclid(BLOCK_EDGE)).to_array();
        let block = match known {
            Some((last, block)) if last == index => block,
            _ => blocks.get(&index),
        };
        known = Some((index, block));
        (block.map(|block| &block[voxel(at)]), weight)
    })
}

/// Values between the voxels of a grid.
struct Sampler<'a> {
    voxels_from_file: DAffine3,
    blocks: HashMap<[i32; 3], &'a [f32; BLOCK_VOXELS]>,
}

impl<'a> Sampler<'a> {
    fn new(grid: &'a Grid) -> Self {
        let blocks = grid.blocks.iter().map(|block| (block.index.to_array(), &*block.values)).collect();
        Self { voxels_from_file: grid.place.inverse(), blocks }
    }

    /// The value at a place in the file's lengths.
    fn at(&self, p: DVec3) -> f64 {
        let around = values(&self.blocks, self.voxels_from_file.transform_point3(p));
        around.map(|(value, weight)| weight * f64::from(value.copied().unwrap_or_default())).sum()
    }
}

/// A step of a volume, and how its matter goes on to the other one.
pub(super) struct End<'a> {
    pub grid: &'a Grid,
    pub motion: &'a Motion,
}

impl End<'_> {
    /// The value that comes to `p` when its matter has gone a share of its way, which is looked for from some `guesses` on;
    /// of less weight where it misses `p` by a few times `voxel`, as in turbulence finer than the steps.
    fn come(&self, density: &Sampler<'_>, p: DVec3, gone: f64, guesses: [DVec3; 2], voxel: f64) -> f64 {
        if let Motion::Even(way) = self.motion {
            return density.at(p - gone * *way);
        }
        let origins = guesses.map(|guess| {
            let way = (0..ROUNDS).fold(guess, |way, _| self.motion.at(p - gone * way));
            let from = p - gone * way;
            ((from + gone * self.motion.at(from)).distance(p) / voxel, from)
        });
        let (misses, from) = if origins[1].0 < origins[0].0 { origins[1] } else { origins[0] };
        ((FAR - misses) / (FAR - NEAR)).clamp(0.0, 1.0) * density.at(from)
    }
}

fn voxel_edge(grid: &Grid) -> f64 {
    grid.voxel().min_element()
}

/// What is there at `share` of the way from step `from` to step `to`.
///
/// # Errors
/// Where there is nothing in it, as the rest of a sentence about the file.
pub(super) fn between(from: &End<'_>, to: &End<'_>, share: f64) -> Result<Grid, String> {
    let samplers = [from, to].map(|end| Sampler::new(end.grid));
    let place = from.grid.place;
    let reached: HashSet<[i32; 3]> = [(from, share), (to, share - 1.0)]
        .into_iter()
        .flat_map(|(end, gone)| reached(end, gone, place))
        .collect();
    let edge = voxel_edge(from.grid).min(voxel_edge(to.grid));
    let value = |p: DVec3| {
        let guesses = [from, to].map(|end| end.motion.at(p));
        let come = |i: usize, end: &End<'_>, gone: f64| end.come(&samplers[i], p, gone, guesses, edge);
        (1.0 - share) * come(0, from, share) + share * come(1, to, share - 1.0)
    };
    let block = |index: [i32; 3]| {
        let index = IVec3::from(index);
        let at = |i: usize| place.transform_point3((BLOCK_EDGE * index + within(i)).as_dvec3());
        let values: [f32; BLOCK_VOXELS] = std::array::from_fn(|i| value(at(i)) as f32);
        values.iter().any(|value| *value > 0.0).then(|| Block { index, values: Box::new(values) })
    };
    let blocks = reached.into_par_iter().filter_map(block).collect();
    Grid::new(from.grid.name.clone(), from.grid.quantity.clone(), place, blocks)
}

/// Blocks of a grid at `place` that the matter of a step may be in when it has gone a share of its way.
fn reached(end: &End<'_>, share: f64, place: DAffine3) -> HashSet<[i32; 3]> {
    let voxels_from_file = place.inverse();
    let voxels = voxels_from_file * end.grid.place;
    let (low, high) = end.motion.bounds();
    let mut reached = HashSet::new();
    for block in &end.grid.blocks {
        let first = (BLOCK_EDGE * block.index).as_dvec3();
        let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for i in 0..64 {
            let pick = |i: i32| glam::BVec3::new(i & 1 == 1, i & 2 == 2, i & 4 == 4);
            let corner =
                first + DVec3::select(pick(i), DVec3::splat(f64::from(BLOCK_EDGE)), DVec3::splat(-1.0));
            let way = DVec3::select(pick(i >> 3), high, low);
            let p = voxels.transform_point3(corner) + share * (voxels_from_file.matrix3 * way);
            bounds = (bounds.0.min(p), bounds.1.max(p));
        }
        let edge = f64::from(BLOCK_EDGE);
        let [first, last] = [bounds.0, bounds.1].map(|p| (p / edge).floor().as_ivec3());
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                reached.extend((first.x..=last.x).map(|x| [x, y, z]));
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const RADIUS: f64 = 6.0;
    /// Of a voxel.
    const EDGE: f64 = 1.0;

    /// Balls of value 1 with soft rims, in voxels of [`EDGE`], where `shift` lies before the first voxel.
    fn balls(middles: &[DVec3], shift: DVec3) -> Grid {
        let place = DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(EDGE));
        let value = |at: IVec3| {
            let p = place.transform_point3(at.as_dvec3());
            middles
                .iter()
                .map(|middle| (0.5 + 0.5 * (RADIUS - p.distance(*middle))).clamp(0.0, 1.0))
                .fold(0.0, f64::max) as f32
        };
        let size = [80u32, 32, 32];
        let values = (0..size.iter().product()).map(|i: u32| {
            let [i, x, y] = [i, size[0], size[1]].map(|n| n as i32);
            value(IVec3::new(i % x, i / x % y, i / (x * y)))
        });
        Grid::dense("density".to_owned(), place, size, values).unwrap()
    }

    /// Velocities where there is density, and nowhere else.
    fn velocity(grid: &Grid, of: impl Fn(DVec3) -> DVec3) -> Velocity {
        let speeds = |block: &Block| {
            let first = BLOCK_EDGE * block.index;
            let speed = |i: usize| of(grid.place.transform_point3((first + within(i)).as_dvec3())).as_vec3();
            let at = |i: usize| if block.values[i] > 0.0 { speed(i) } else { Vec3::ZERO };
            (block.index.to_array(), Box::new(std::array::from_fn(at)))
        };
        Velocity { place: grid.place, blocks: grid.blocks.iter().map(speeds).collect() }
    }

    /// Mass, middle and mean squared distance from there.
    fn told(grid: &Grid) -> (f64, DVec3, f64) {
        let all = || {
            grid.filled().map(|(at, value)| (grid.place.transform_point3(at.as_dvec3()), f64::from(value)))
        };
        let mass: f64 = all().map(|(_, value)| value).sum();
        let middle = all().map(|(p, value)| value * p).sum::<DVec3>() / mass;
        let spread = all().map(|(p, value)| value * p.distance_squared(middle)).sum::<f64>() / mass;
        let voxel = grid.voxel().element_product();
        (mass * voxel, middle, spread)
    }

    #[test]
    fn a_ball_that_goes_farther_than_it_is_wide_stays_one_ball_of_its_mass() {
        let way = DVec3::new(31.0, 5.0, -3.0);
        let from = DVec3::new(15.0, 12.0, 18.0);
        // The grids of the steps lie elsewhere, as those that follow what they hold.
        let steps = [balls(&[from], DVec3::ZERO), balls(&[from + way], DVec3::new(1.3, 0.2, -0.4))];
        let seconds = 0.5;
        let of = |grid: &Grid| Motion::of(&velocity(grid, |_| way / seconds), grid, seconds);
        let fields = [of(&steps[0]), of(&steps[1])];
        let even = [Motion::Even(way), Motion::Even(way)];
        let (mass, _, spread) = told(&steps[0]);
        assert!((mass / (4.0 / 3.0 * PI * RADIUS.powi(3)) - 1.0).abs() < 0.03, "{mass}");
        for motions in [&fields, &even] {
            let ends = [0, 1].map(|i| End { grid: &steps[i], motion: &motions[i] });
            for share in [0.01, 0.5, 0.8] {
                let found = told(&between(&ends[0], &ends[1], share).unwrap());
                assert!((found.0 / mass - 1.0).abs() < 0.01, "{share}: {} for {mass}", found.0);
                assert!(found.1.distance(from + share * way) < 0.05, "{share}: {}", found.1);
                // Between voxels a value is spread over both: at the most by a quarter of their square along each axis.
                let wider = found.2 - spread;
                assert!((-0.05..0.75 * EDGE * EDGE).contains(&wider), "{share}: {} for {spread}", found.2);
            }
        }
    }

    #[test]
    fn balls_that_go_apart_and_one_that_stands_keep_their_ways() {
        let middles =
            [DVec3::new(32.0, 9.0, 16.0), DVec3::new(48.0, 9.0, 16.0), DVec3::new(40.0, 23.0, 16.0)];
        let ways = [DVec3::new(-16.0, 0.0, 0.0), DVec3::new(18.0, 0.0, 0.0), DVec3::ZERO];
        let later = [0, 1, 2].map(|i| middles[i] + ways[i]);
        let steps = [balls(&middles, DVec3::ZERO), balls(&later, DVec3::ZERO)];
        let of = |grid: &Grid, middles: &[DVec3; 3]| {
            let nearest = |p: DVec3| {
                (0..3).min_by(|a, b| p.distance(middles[*a]).total_cmp(&p.distance(middles[*b]))).unwrap()
            };
            Motion::of(&velocity(grid, |p| ways[nearest(p)]), grid, 1.0)
        };
        let motions = [of(&steps[0], &middles), of(&steps[1], &later)];
        let ends = [0, 1].map(|i| End { grid: &steps[i], motion: &motions[i] });
        let half = between(&ends[0], &ends[1], 0.5).unwrap();
        let mass = told(&steps[0]).0;
        let found = told(&half).0;
        assert!((found / mass - 1.0).abs() < 0.04, "{found} for {mass}");
        for i in 0..3 {
            let middle = middles[i] + 0.5 * ways[i];
            let near: f64 = half
                .filled()
                .filter(|(at, _)| half.place.transform_point3(at.as_dvec3()).distance(middle) < RADIUS + 1.0)
                .map(|(_, value)| f64::from(value) * EDGE.powi(3))
                .sum();
            assert!((near / mass * 3.0 - 1.0).abs() < 0.04, "ball {i} has {near} of {mass}");
        }
    }

    #[test]
    fn what_turns_and_widens_keeps_its_shape_to_a_few_per_cent() {
        // Two balls about a middle, a quarter of a radian and a tenth wider.
        let middle = DVec3::new(40.0, 16.0, 16.0);
        let turn =
            |share: f64, arm: DVec3| (1.0 + 0.1 * share) * (glam::DMat3::from_rotation_z(0.25 * share) * arm);
        let arms = [DVec3::new(13.0, 0.0, 0.0), DVec3::new(-13.0, 0.0, 0.0)];
        let at = |share: f64| arms.map(|arm| middle + turn(share, arm));
        let steps = [0.0, 1.0].map(|share| balls(&at(share), DVec3::ZERO));
        let of = |grid: &Grid| {
            // Of a rotation and a widening that go on evenly.
            let speed = |p: DVec3| 0.25 * DVec3::Z.cross(p - middle) + 1.1f64.ln() * (p - middle);
            Motion::of(&velocity(grid, speed), grid, 1.0)
        };
        let motions = [of(&steps[0]), of(&steps[1])];
        let ends = [0, 1].map(|i| End { grid: &steps[i], motion: &motions[i] });
        let (found, wanted) =
            (told(&between(&ends[0], &ends[1], 0.5).unwrap()), told(&balls(&at(0.5), DVec3::ZERO)));
        assert!((found.0 / wanted.0 - 1.0).abs() < 0.03, "{} for {}", found.0, wanted.0);
        assert!(
            found.1.distance(wanted.1) < 0.1 && (found.2 / wanted.2 - 1.0).abs() < 0.03,
            "{found:?} for {wanted:?}"
        );
    }

    #[test]
    fn without_motion_both_steps_are_there_by_their_shares() {
        let [from, to] = [DVec3::new(15.0, 16.0, 16.0), DVec3::new(55.0, 16.0, 16.0)];
        let steps = [balls(&[from], DVec3::ZERO), balls(&[to], DVec3::ZERO)];
        let still = Motion::Even(DVec3::ZERO);
        let ends = [0, 1].map(|i| End { grid: &steps[i], motion: &still });
        let (mass, middle, _) = told(&between(&ends[0], &ends[1], 0.25).unwrap());
        assert!((mass / told(&steps[0]).0 - 1.0).abs() < 1e-6);
        assert!(middle.distance(from + 0.25 * (to - from)) < 1e-6, "{middle}");
    }
}
