//! Where a cloud dissolves in dry air: crisp on one side, a veil on the other.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::life::smooth;
use super::validate::{At, Limits};
use super::{Cloud, Edge};
use crate::Result;

const SHARE: Limits = Limits::new(0.0, 1.0, "");
/// Height up to which a base evaporates, as a share of the cloud's.
const BASE: f64 = 0.35;
/// How much thicker the boundary is where all of it is a veil.
const THICKER: f64 = 0.4;

/// How much of a cloud's edge has turned to wisps, side by side with its crisp ones.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Evaporation {
    /// On the side where the wind goes, 0 to 1, no unit: the farther downwind, the more.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub lee: f64,
    /// Under its base, 0 to 1, no unit: the lower, the more.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub base: f64,
}

impl Evaporation {
    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("lee").number(self.lee, SHARE)?;
        at.field("base").number(self.base, SHARE)
    }

    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl Cloud {
    /// Gives its ellipsoids the edges that its evaporation makes of theirs, in wind that goes along `wind`.
    pub(super) fn evaporate(&mut self, wind: DVec3) {
        if self.evaporation.is_none() {
            return;
        }
        let Some((low, high)) = self.bounds() else { return };
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let along = wind.with_y(0.0).normalize_or_zero();
        let reach = half.dot(along.abs()).max(1e-6);
        let Evaporation { lee, base } = self.evaporation;
        for i in 0..self.ellipsoids.len() {
            let center = self.ellipsoids[i].center;
            let downwind = smooth(((center - middle).dot(along) / reach).clamp(0.0, 1.0));
            let height = (center.y - low.y) / (high.y - low.y).max(1e-6);
            let veil = (lee * downwind).max(base * smooth((1.0 - height / BASE).clamp(0.0, 1.0)));
            let edge = self.edge_of(&self.ellipsoids[i]);
            let wispiness = edge.wispiness + (1.0 - edge.wispiness) * veil;
            let boundary = edge.boundary * (1.0 + THICKER * veil);
            self.ellipsoids[i].edge = Some(Edge { boundary, wispiness });
        }
    }
}
