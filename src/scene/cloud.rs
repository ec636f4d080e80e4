//! A cloud: ellipsoids that share their water.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::At;
use super::{Bounds, Droplets, Edge, Ellipsoid, Life, union};
use crate::Result;

/// A cloud: the union of its ellipsoids, filled with droplets of one kind.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Cloud {
    /// A name for people; it changes nothing in the picture.
    pub name: String,
    /// The shape. At most 65536 ellipsoids in all clouds together; none renders nothing.
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
        match &self.life {
            Some(life) => life.check(at.field("life")),
            None => Ok(()),
        }
    }
}
