//! The building block of clouds.

use glam::{DMat3, DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, COORDINATE, Limits};
use super::{Bounds, Edge};
use crate::Result;

const RADIUS: Limits = Limits::new(0.01, 1e5, "metres");
const DENSITY: Limits = Limits::new(0.0, 100.0, "");

/// One ellipsoid of a cloud. A cloud is the union of its ellipsoids: where they
/// overlap the density does not add up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// A name for people; it changes nothing in the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Centre [x, y, z], metres: x east, y up, z south.
    #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    pub center: DVec3,
    /// Half the length of each axis [x, y, z] before the rotation, metres, 0.01 to 100000.
    #[schemars(with = "[f64; 3]", inner(range(min = RADIUS.min, max = RADIUS.max)), extend("unit" = RADIUS.unit))]
    pub radii: DVec3,
    /// Rotation about the centre, a quaternion [x, y, z, w] as in glTF; made unit
    /// length on loading. [0, 0, 0, 1], no rotation, where left out.
    #[serde(default)]
    #[schemars(with = "[f64; 4]")]
    pub orientation: DQuat,
    /// Multiplies the cloud's droplet concentration, 0 to 100, no unit; 1 where left out.
    #[serde(default = "full_density")]
    #[schemars(range(min = DENSITY.min, max = DENSITY.max))]
    pub density: f64,
    /// The edge of this ellipsoid; the cloud's edge where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge: Option<Edge>,
    /// Whether it is left out of pictures, the path traced ones too.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hidden: bool,
    /// Whether editors leave it alone until it is unlocked; it changes nothing in the picture.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
}

fn full_density() -> f64 {
    1.0
}

impl Default for Ellipsoid {
    /// A sphere of 100 m radius around the origin.
    fn default() -> Self {
        Self::new(DVec3::ZERO, DVec3::splat(100.0))
    }
}

impl Ellipsoid {
    /// An unrotated ellipsoid of full density around `center` with half axes
    /// `radii`, both in metres, and the edge of its cloud.
    pub fn new(center: DVec3, radii: DVec3) -> Self {
        Self {
            name: None,
            center,
            radii,
            orientation: DQuat::IDENTITY,
            density: full_density(),
            edge: None,
            hidden: false,
            locked: false,
        }
    }

    /// Exact axis-aligned bounds, metres.
    ///
    /// The support of an ellipsoid along axis i is `sqrt(sum_j (R_ij r_j)^2)`, R
    /// being its rotation matrix. Noise only removes density: it never reaches beyond.
    pub fn bounds(&self) -> Bounds {
        let axes = DMat3::from_quat(self.orientation) * DMat3::from_diagonal(self.radii);
        let half = DVec3::new(axes.row(0).length(), axes.row(1).length(), axes.row(2).length());
        (self.center - half, self.center + half)
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("center").position(self.center)?;
        at.field("radii").numbers(&self.radii.to_array(), RADIUS)?;
        at.field("orientation").rotation(self.orientation)?;
        at.field("density").number(self.density, DENSITY)?;
        match &self.edge {
            Some(edge) => edge.check(at.field("edge")),
            None => Ok(()),
        }
    }
}
