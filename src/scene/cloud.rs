//! A cloud: ellipsoids that share their water.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::At;
use super::{Bounds, Droplets, Edge, Ellipsoid, Growth, Life, union};
use crate::Result;

/// A cloud: the union of its ellipsoids, filled with droplets of one kind.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Cloud {
    /// A name for people; it changes nothing in the picture.
    pub name: String,
    /// How it grows, in place of `ellipsoids`; left out where those were made by hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<Growth>,
    /// The shape. At most 65536 ellipsoids in all clouds together; none renders nothing. Left out
    /// where `growth` says how they grow.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ellipsoids: Vec<Ellipsoid>,
    /// The water of the cloud.
    pub droplets: Droplets,
    /// The edge of every ellipsoid that has none of its own.
    pub edge: Edge,
    /// When it forms and dissolves; left out where it is there all the time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub life: Option<Life>,
    /// Whether it is left out of pictures, the path traced ones too.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub hidden: bool,
    /// Whether editors leave it alone until it is unlocked; it changes nothing in the picture.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
}

impl Cloud {
    /// A cloud that grows, with its ellipsoids, and with the water and the edges of its kind.
    pub fn grown(name: &str, growth: Growth) -> Self {
        let mut cloud = Self { name: name.to_owned(), growth: Some(growth), ..Self::default() };
        cloud.grow();
        cloud
    }

    /// Puts the ellipsoids there that grow, in place of those that are there. Nothing where it has no growth.
    pub fn grow(&mut self) {
        if let Some(growth) = &self.growth {
            self.ellipsoids = growth.ellipsoids();
        }
    }

    /// Whether its ellipsoids are those that grow: a hand that changes one makes others of them.
    pub fn is_as_grown(&self) -> bool {
        self.growth.as_ref().is_some_and(|growth| growth.ellipsoids() == self.ellipsoids)
    }

    /// Moves all of it by `offset`, metres; it grows there.
    pub fn shift(&mut self, offset: DVec3) {
        match &mut self.growth {
            Some(growth) => {
                growth.place += offset;
                self.grow();
            }
            None => self.ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.center += offset),
        }
    }

    /// Exact axis-aligned bounds of all ellipsoids, metres; `None` without ellipsoids.
    pub fn bounds(&self) -> Option<Bounds> {
        self.ellipsoids.iter().map(Ellipsoid::bounds).reduce(union)
    }

    /// The ellipsoids that pictures show.
    pub fn visible(&self) -> impl Iterator<Item = &Ellipsoid> {
        self.ellipsoids.iter().filter(|ellipsoid| !self.hidden && !ellipsoid.hidden)
    }

    /// The edge of `ellipsoid`: its own, or else the cloud's.
    pub fn edge_of<'a>(&'a self, ellipsoid: &'a Ellipsoid) -> &'a Edge {
        ellipsoid.edge.as_ref().unwrap_or(&self.edge)
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        let list = at.field("ellipsoids");
        for (i, ellipsoid) in self.ellipsoids.iter().enumerate() {
            ellipsoid.check(list.index(i))?;
        }
        self.check_own(at)
    }

    /// Checks what is no ellipsoid.
    pub(super) fn check_own(&self, at: At) -> Result<()> {
        self.droplets.check(at.field("droplets"))?;
        self.edge.check(at.field("edge"))?;
        if let Some(growth) = &self.growth {
            growth.check(at.field("growth"))?;
        }
        match &self.life {
            Some(life) => life.check(at.field("life")),
            None => Ok(()),
        }
    }
}
