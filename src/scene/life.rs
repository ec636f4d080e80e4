//! The life of a cloud: it forms, stands, and dissolves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, Limits};
use super::{Bounds, Cloud};
use crate::Result;

const MOMENT: Limits = Limits::new(-1e7, 1e7, "seconds");
const SPAN: Limits = Limits::new(0.0, 1e6, "seconds");

/// Size of a cloud at the beginning and at the end of its life, of what it grows to.
const SMALLEST: f64 = 0.5;

/// When a cloud forms and dissolves. It begins as small wisps over the middle of its base, grows,
/// and ends as it began. The scene has it as it is half way through its life, and where it is then:
/// the wind brings it there and carries it on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Life {
    /// When its first wisps are seen, seconds since the scene's start.
    #[schemars(range(min = MOMENT.min, max = MOMENT.max), extend("unit" = MOMENT.unit))]
    pub birth: f64,
    /// When its last wisps are gone, seconds since the scene's start. In a loop it may be
    /// before the birth: the life then goes on over the end of the loop.
    #[schemars(range(min = MOMENT.min, max = MOMENT.max), extend("unit" = MOMENT.unit))]
    pub death: f64,
    /// How long it forms, seconds, 0 to 1000000.
    #[schemars(range(min = SPAN.min, max = SPAN.max), extend("unit" = SPAN.unit))]
    pub forming: f64,
    /// How long it dissolves, seconds, 0 to 1000000.
    #[schemars(range(min = SPAN.min, max = SPAN.max), extend("unit" = SPAN.unit))]
    pub dissolving: f64,
}

impl Life {
    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("birth").number(self.birth, MOMENT)?;
        at.field("death").number(self.death, MOMENT)?;
        at.field("forming").number(self.forming, SPAN)?;
        at.field("dissolving").number(self.dissolving, SPAN)
    }

    /// Checks that it has room: a cloud that dissolves before it has formed is hardly seen.
    pub(super) fn check_span(&self, period: Option<f64>, at: At) -> Result<()> {
        let span = self.span(period);
        if span <= 0.0 {
            return Err(at.problem(format!(
                "death at {} seconds is not after birth at {}: only in a loop a life goes on over its end",
                self.death, self.birth
            )));
        }
        let outside = |moment: f64| period.is_some_and(|period| !(0.0..=period).contains(&moment));
        if let (Some(period), true) = (period, outside(self.birth) || outside(self.death)) {
            return Err(at.problem(format!(
                "birth at {} and death at {} seconds must lie in the loop, from 0 to {period} seconds",
                self.birth, self.death
            )));
        }
        if self.forming + self.dissolving > span * (1.0 + 1e-9) {
            return Err(at.problem(format!(
                "forming and dissolving take {} seconds of a life of {span}: shorten them, or let it live longer",
                self.forming + self.dissolving
            )));
        }
        Ok(())
    }

    /// How long it is, s, in loops of `period` seconds: the whole loop where it ends as it begins.
    pub fn span(&self, period: Option<f64>) -> f64 {
        match period {
            Some(period) => {
                Some((self.death - self.birth).rem_euclid(period)).filter(|s| *s > 0.0).unwrap_or(period)
            }
            None => self.death - self.birth,
        }
    }

    /// Age at `time`, s: negative before the birth, more than [`Life::span`] after the death.
    pub fn age(&self, time: f64, period: Option<f64>) -> f64 {
        period.map_or(time - self.birth, |period| (time - self.birth).rem_euclid(period))
    }

    /// How much of the cloud there is at `age` (s) of a life of `span` seconds, 0 to 1, without a jump
    /// in value or slope.
    pub fn fullness(&self, age: f64, span: f64) -> f64 {
        if age <= 0.0 || age >= span {
            return 0.0;
        }
        let ramp = |since: f64, over: f64| if over > 0.0 { smooth((since / over).min(1.0)) } else { 1.0 };
        ramp(age, self.forming) * ramp(span - age, self.dissolving)
    }
}

/// From 0 to 1 with level ends.
pub(super) fn smooth(x: f64) -> f64 {
    x * x * (3.0 - 2.0 * x)
}

/// `cloud` as it is when `fullness` of it is there: small, thin and torn at first.
pub(super) fn grown(cloud: &mut Cloud, fullness: f64) {
    if fullness <= 0.0 {
        cloud.ellipsoids.clear();
    }
    let Some((low, high)): Option<Bounds> = cloud.bounds().filter(|_| fullness < 1.0) else { return };
    let base = (0.5 * (low + high)).with_y(low.y);
    let size = SMALLEST + (1.0 - SMALLEST) * fullness;
    for ellipsoid in &mut cloud.ellipsoids {
        ellipsoid.center = base + size * (ellipsoid.center - base);
        ellipsoid.radii *= size;
        ellipsoid.density *= fullness;
    }
    if let Some(noise) = &mut cloud.noise {
        noise.scale = noise.scale.map(|scale| size * scale);
        noise.offset = base + size * (noise.offset - base);
    }
    let own = cloud.ellipsoids.iter_mut().filter_map(|ellipsoid| ellipsoid.edge.as_mut());
    for edge in own.chain([&mut cloud.edge]) {
        edge.boundary *= size;
        edge.wispiness += (1.0 - edge.wispiness) * (1.0 - fullness);
    }
}
