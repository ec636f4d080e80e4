//! The boundary of an ellipsoid: how thick, and how sharp.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, Limits};
use crate::Result;

const BOUNDARY: Limits = Limits::new(0.0, 1e4, "metres");
const WISPINESS: Limits = Limits::new(0.0, 1.0, "");

/// How a cloud ends in the air: from hard cauliflower heads to torn wisps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Edge {
    /// Thickness of the boundary that noise shapes, metres, 0 to 10000. Inside it
    /// the cloud is uneven, behind it the density is full. 0 makes a smooth ellipsoid.
    #[schemars(range(min = BOUNDARY.min, max = BOUNDARY.max), extend("unit" = BOUNDARY.unit))]
    pub boundary: f64,
    /// 0 is a sharp cauliflower edge, 1 is a soft and wispy one. 0 to 1, no unit.
    #[schemars(range(min = WISPINESS.min, max = WISPINESS.max))]
    pub wispiness: f64,
}

impl Default for Edge {
    fn default() -> Self {
        Self { boundary: 60.0, wispiness: 0.25 }
    }
}

impl Edge {
    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("boundary").number(self.boundary, BOUNDARY)?;
        at.field("wispiness").number(self.wispiness, WISPINESS)
    }
}
