//! What a value of a scene may be, and where in the JSON it stands.
//!
//! Every type of the scene checks its own fields and lists its own [`Limits`];
//! the same limits go into the JSON Schema. Checks stop at the first problem.

use std::fmt;

use glam::{DQuat, DVec3};

use crate::{Error, Result};

/// Largest magnitude of a coordinate, metres: a quarter of the Earth's circumference.
pub(super) const COORDINATE: Limits = Limits::new(-1e7, 1e7, "metres");

/// Least length of a direction or quaternion that still has a direction.
const LEAST_LENGTH: f64 = 1e-9;

/// How far from 1 the length of a unit quaternion may be: it scales lengths by its square.
const UNIT_TOLERANCE: f64 = 1e-6;

/// The values a number may have, both ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Unit in words, plural; empty for pure numbers.
    pub unit: &'static str,
}

impl Limits {
    /// Limits from `min` to `max`, both included, in `unit`.
    pub const fn new(min: f64, max: f64, unit: &'static str) -> Self {
        Self { min, max, unit }
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", Short(self.min), Short(self.max))?;
        if !self.unit.is_empty() {
            write!(f, " {}", self.unit)?;
        }
        Ok(())
    }
}

/// A number as people write it: no hundred digits for 1e99.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value != 0.0 && value.is_finite() && !(1e-6..1e12).contains(&value.abs()) {
            return write!(f, "{value:e}");
        }
        write!(f, "{value}")
    }
}

/// A place in the scene's JSON, such as `clouds[0].ellipsoids[2].radii`.
///
/// A chain of borrowed steps: nothing is allocated until a problem is told.
#[derive(Clone, Copy)]
pub(super) enum At<'a> {
    /// The scene itself.
    Root,
    /// A named field.
    Field(&'a At<'a>, &'a str),
    /// An element of a list.
    Index(&'a At<'a>, usize),
}

impl At<'_> {
    /// The field `name` of this place.
    pub fn field<'a>(&'a self, name: &'a str) -> At<'a> {
        At::Field(self, name)
    }

    /// The element `i` of this place.
    pub fn index(&self, i: usize) -> At<'_> {
        At::Index(self, i)
    }

    /// The error that says `problem` about this place.
    pub fn problem(&self, problem: impl Into<String>) -> Error {
        Error::Scene { path: self.to_string(), problem: problem.into() }
    }

    /// `value` is finite and within `limits`.
    pub fn number(&self, value: f64, limits: Limits) -> Result<()> {
        if value >= limits.min && value <= limits.max {
            return Ok(());
        }
        let found = Short(value);
        Err(self.problem(format!("{found} is out of range: expected {limits}")))
    }

    /// Every component of `values` is finite and within `limits`.
    pub fn numbers(&self, values: &[f64], limits: Limits) -> Result<()> {
        for (i, &value) in values.iter().enumerate() {
            self.index(i).number(value, limits)?;
        }
        Ok(())
    }

    /// `p` is a position that the renderer can hold.
    pub fn position(&self, p: DVec3) -> Result<()> {
        self.numbers(&p.to_array(), COORDINATE)
    }

    /// `v` points somewhere; its length does not matter.
    pub fn direction(&self, v: DVec3) -> Result<()> {
        self.position(v)?;
        if v.length() < LEAST_LENGTH {
            return Err(self.problem(format!("{v} has no direction: expected a vector that is not zero")));
        }
        Ok(())
    }

    /// `q` is a unit quaternion.
    pub fn rotation(&self, q: DQuat) -> Result<()> {
        let length = q.length();
        if (length - 1.0).abs() <= UNIT_TOLERANCE {
            return Ok(());
        }
        let found = q.to_array();
        Err(self.problem(format!(
            "{found:?} has length {length}: expected a unit quaternion [x, y, z, w], such as [0, 0, 0, 1] for no rotation"
        )))
    }
}

impl fmt::Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            At::Root => f.write_str("scene"),
            At::Field(At::Root, name) => f.write_str(name),
            At::Field(parent, name) => write!(f, "{parent}.{name}"),
            At::Index(parent, i) => write!(f, "{parent}[{i}]"),
        }
    }
}

/// `q` scaled to length 1, or as it is where it already is one, or has no direction.
///
/// Leaves unit quaternions alone to the last bit, so that files survive a round trip.
pub(super) fn unit(q: DQuat) -> DQuat {
    let length = q.length();
    if !length.is_finite() || length < LEAST_LENGTH || (length - 1.0).abs() < 1e-12 {
        return q;
    }
    q / length
}
