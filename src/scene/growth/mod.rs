//! How a cloud grows: a few numbers instead of a thousand ellipsoids.
//!
//! A growing cloud has a frame of its own: x where the wind of the height blows to, y up from its base, z across,
//! metres. Chance falls lump by lump, each by its own key: a number that changes a little changes the cloud
//! a little, and no lump far off.

mod anvil;
mod cells;
mod heading;
mod pile;
mod plumes;
mod shreds;
mod storm;
mod surface;

use std::{borrow::Cow, collections::BTreeMap};

use glam::DVec3;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use super::Ellipsoid;
use super::validate::{At, COORDINATE, Limits};
use super::whole::whole;
use crate::Result;
use pile::{Lump, Part, Pile};

const WIDTH: Limits = Limits::new(1.0, 1e5, "metres");
const HEIGHT: Limits = Limits::new(1.0, 3e4, "metres");
const HEADING: Limits = Limits::new(-360.0, 360.0, "degrees");
const LEAN: Limits = Limits::new(-2.0, 2.0, "");
const COVERAGE: Limits = Limits::new(0.05, 1.0, "");
const DETAIL: Limits = Limits::new(0.0, 1.0, "");
const AGE: Limits = Limits::new(0.0, 1.0, "");

/// Share of the height below which lumps of its turrets are of the base.
const BASE: f64 = 0.25;

/// Most ellipsoids that one cloud grows.
pub(super) const MOST_LUMPS: usize = 2400;

/// A kind of cloud that grows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GrowthKind {
    /// Fair-weather cumulus: low heads over a flat base, wider than tall.
    #[default]
    Humilis,
    /// Cumulus of middling height, about as tall as wide, with a few turrets.
    Mediocris,
    /// Towering cumulus: turrets of different heights, cauliflower all over.
    Congestus,
    /// A thunderstorm: tower, overshooting top, anvil with fibres downwind, mammatus under it.
    Cumulonimbus,
    /// Torn shreds in the wind.
    Fractus,
    /// Stratocumulus in closed cells: flat patches with narrow gaps.
    ClosedCells,
    /// Stratocumulus in open cells: rings of cloud around clear air.
    OpenCells,
}

impl GrowthKind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Humilis,
        Self::Mediocris,
        Self::Congestus,
        Self::Cumulonimbus,
        Self::Fractus,
        Self::ClosedCells,
        Self::OpenCells,
    ];
}

/// How a cloud grows. It stands in a file in place of the ellipsoids, and is what they were grown from; what
/// is left out is as usual for the kind. The same numbers give the same cloud on every platform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Sparse")]
pub struct Growth {
    /// What grows.
    pub kind: GrowthKind,
    /// Other seeds give other clouds of the same kind.
    pub seed: u32,
    /// Middle of the base, metres.
    pub place: DVec3,
    /// Width of the base, metres.
    pub width: f64,
    /// Height of the highest turret above the base, metres.
    pub height: f64,
    /// Compass direction to which it leans, degrees.
    pub heading_deg: f64,
    /// Metres to the side by metre of height.
    pub lean: f64,
    /// Share of the base over which air rises.
    pub coverage: f64,
    /// 0 is young, 1 is old.
    pub age: f64,
    /// How small its lumps become: 0 the largest alone, 1 all.
    pub detail: f64,
}

/// How a cloud grows. It stands in place of the ellipsoids, which are grown from it; what is left out is as usual
/// for the kind. The same numbers give the same cloud on every platform.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "Growth")]
#[schemars(rename = "Growth")]
struct Sparse {
    /// What grows.
    kind: GrowthKind,
    /// Any whole number, 0 to 4294967295: other seeds give other clouds of the same kind.
    #[serde(default, deserialize_with = "whole")]
    #[schemars(with = "u32", range(min = 0, max = u32::MAX))]
    seed: u32,
    /// Middle of the base [x, y, z], metres; y is the height at which vapour condenses. [0, 1000, 0] where left out.
    #[serde(default = "usual_place")]
    #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    place: DVec3,
    /// Width of the base, metres, 1 to 100000. Where left out: 450 for humilis, 900 for mediocris, 2600 for
    /// congestus, 8000 for cumulonimbus, 500 for fractus, 7000 for cells.
    #[schemars(range(min = WIDTH.min, max = WIDTH.max), extend("unit" = WIDTH.unit))]
    width: Option<f64>,
    /// Height of the highest turret above the base, metres, 1 to 30000. Where left out, the usual share of
    /// the width.
    #[schemars(range(min = HEIGHT.min, max = HEIGHT.max), extend("unit" = HEIGHT.unit))]
    height: Option<f64>,
    /// Compass direction to which it leans and the anvil spreads, degrees, -360 to 360; 90, east, where left out.
    #[serde(default = "usual_heading")]
    #[schemars(range(min = HEADING.min, max = HEADING.max), extend("unit" = HEADING.unit))]
    heading_deg: f64,
    /// How far the shear of the wind leans its turrets, metres to the side by metre of height, -2 to 2, no unit.
    /// 0.1 to 0.3 where left out, by kind.
    #[schemars(range(min = LEAN.min, max = LEAN.max))]
    lean: Option<f64>,
    /// Share of the base over which air rises, 0.05 (a few turrets with gaps) to 1 (a closed heap), no unit. Of cells,
    /// the share of the sky that they cover. 0.6 to 0.8 where left out, by kind.
    #[schemars(range(min = COVERAGE.min, max = COVERAGE.max))]
    coverage: Option<f64>,
    /// 0 is young, with crisp turrets; 1 is old: sunken, spread and torn. 0 to 1, no unit; 0.2 where left out.
    #[schemars(range(min = AGE.min, max = AGE.max))]
    age: Option<f64>,
    /// How small its lumps become, 0 (the largest alone) to 1 (all), no unit; 1 where left out. Clouds far off
    /// need few.
    #[serde(default = "all")]
    #[schemars(range(min = DETAIL.min, max = DETAIL.max))]
    detail: f64,
}

impl JsonSchema for Growth {
    fn schema_name() -> Cow<'static, str> {
        Sparse::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Sparse::json_schema(generator)
    }
}

fn usual_place() -> DVec3 {
    DVec3::new(0.0, 1000.0, 0.0)
}

fn usual_heading() -> f64 {
    90.0
}

fn all() -> f64 {
    1.0
}

impl From<Sparse> for Growth {
    fn from(sparse: Sparse) -> Self {
        let usual = Self::new(sparse.kind, sparse.seed);
        let width = sparse.width.unwrap_or(usual.width);
        Self {
            place: sparse.place,
            width,
            height: sparse.height.unwrap_or(usual.height * width / usual.width),
            heading_deg: sparse.heading_deg,
            lean: sparse.lean.unwrap_or(usual.lean),
            coverage: sparse.coverage.unwrap_or(usual.coverage),
            age: sparse.age.unwrap_or(usual.age),
            detail: sparse.detail,
            ..usual
        }
    }
}

impl Growth {
    /// A cloud of this kind as it is usual.
    pub fn new(kind: GrowthKind, seed: u32) -> Self {
        let (width, height, lean, coverage, age) = match kind {
            GrowthKind::Humilis => (450.0, 140.0, 0.25, 0.7, 0.2),
            GrowthKind::Mediocris => (900.0, 620.0, 0.2, 0.65, 0.2),
            GrowthKind::Congestus => (2600.0, 2200.0, 0.12, 0.65, 0.1),
            GrowthKind::Cumulonimbus => (8000.0, 10_000.0, 0.1, 0.7, 0.2),
            GrowthKind::Fractus => (500.0, 160.0, 0.6, 0.6, 0.6),
            GrowthKind::ClosedCells => (7000.0, 260.0, 0.2, 0.8, 0.2),
            GrowthKind::OpenCells => (9000.0, 420.0, 0.2, 0.35, 0.2),
        };
        let (place, heading_deg) = (usual_place(), usual_heading());
        Self { kind, seed, place, width, height, heading_deg, lean, coverage, age, detail: all() }
    }

    /// The ellipsoids that grow: at least one, at most 2400, each of which touches another. Their base is flat and at
    /// the height of [`Growth::place`].
    ///
    /// Only sums, products, quotients and square roots, which IEEE 754 rounds the same everywhere.
    pub fn ellipsoids(&self) -> Vec<Ellipsoid> {
        let mut pile = Pile::new(self.reach());
        match self.kind {
            GrowthKind::Humilis => plumes::grow(self, &plumes::HUMILIS, &mut pile),
            GrowthKind::Mediocris => plumes::grow(self, &plumes::MEDIOCRIS, &mut pile),
            GrowthKind::Congestus => plumes::grow(self, &plumes::CONGESTUS, &mut pile),
            GrowthKind::Cumulonimbus => {
                plumes::grow_storm(self, &mut pile);
                anvil::spread(self, &mut pile);
            }
            GrowthKind::Fractus => shreds::tear(self, &mut pile),
            GrowthKind::ClosedCells => cells::fill(self, &cells::CLOSED, &mut pile),
            GrowthKind::OpenCells => cells::fill(self, &cells::OPEN, &mut pile),
        }
        let turn = heading::from_downwind(self.heading_deg);
        let mut counts = BTreeMap::<&str, u32>::new();
        let named = |lump: &Lump| {
            let what = self.part_of(lump);
            let count = counts.entry(what).or_default();
            *count += 1;
            Ellipsoid { name: Some(format!("{what} {count}")), ..self.placed(lump, turn) }
        };
        pile.into_lumps().iter().map(named).collect()
    }

    /// What people call a lump by.
    fn part_of(&self, lump: &Lump) -> &'static str {
        let cells = matches!(self.kind, GrowthKind::ClosedCells | GrowthKind::OpenCells);
        match (lump.part, lump.generation) {
            (Part::Ice, _) => "anvil",
            (Part::Pouch, _) => "pouch",
            (Part::Shred, _) => "shred",
            (Part::Heap, 0) if cells => "patch",
            (Part::Heap, 0) if lump.center.y < BASE * self.height => "base",
            (Part::Heap, 0) => "turret",
            (Part::Heap, 1) => "head",
            (Part::Heap, _) => "knob",
        }
    }

    /// Altitude of its flat base, metres; none where it is torn, or rolls hang down from it.
    pub(super) fn level(&self) -> Option<f64> {
        let uneven = matches!(self.kind, GrowthKind::Fractus | GrowthKind::ClosedCells);
        (!uneven).then_some(self.place.y)
    }

    /// Height by width.
    fn slope(&self) -> f64 {
        self.height / self.width
    }

    /// Radius of the least lump of `usual` metres when all are there.
    fn least(&self, usual: f64) -> f64 {
        usual + 0.08 * self.width * (1.0 - self.detail)
    }

    /// Half the extent of the box around the middle of the base in which lumps are looked up, metres.
    fn reach(&self) -> DVec3 {
        let across = 0.75 * self.width;
        DVec3::new(across + self.lean.abs() * self.height, 1.15 * self.height, across)
    }

    /// A lump where the cloud stands in the world.
    fn placed(&self, lump: &Lump, turn: glam::DQuat) -> Ellipsoid {
        let (density, edge) = surface::of(self, lump);
        Ellipsoid {
            center: self.place + tenths(turn * lump.center),
            radii: tenths(lump.radii).max(DVec3::splat(0.1)),
            orientation: if lump.turn == glam::DQuat::IDENTITY { turn } else { turn * lump.turn },
            density,
            edge,
            ..Ellipsoid::default()
        }
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("place").position(self.place)?;
        at.field("width").number(self.width, WIDTH)?;
        at.field("height").number(self.height, HEIGHT)?;
        at.field("heading_deg").number(self.heading_deg, HEADING)?;
        at.field("lean").number(self.lean, LEAN)?;
        at.field("coverage").number(self.coverage, COVERAGE)?;
        at.field("age").number(self.age, AGE)?;
        at.field("detail").number(self.detail, DETAIL)
    }
}

/// Every component rounded to decimetres, so that numbers stay short.
fn tenths(v: DVec3) -> DVec3 {
    (v * 10.0).round() / 10.0
}
