//! Which step of a sequence of volumes is there at a time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TIME;
use super::validate::{At, Limits};
use crate::Result;

const FPS: Limits = Limits::new(1e-6, 1000.0, "frames per second");
const INCREMENT: Limits = Limits::new(1.0, 1e6, "");

/// How a volume goes through the steps of its files, or through the times of its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sequence {
    /// Steps per second, 0.000001 to 1000; left out, the frames per second of the timeline, or 24.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = FPS.min, max = FPS.max), extend("unit" = FPS.unit))]
    pub fps: Option<f64>,
    /// When its first step is there, seconds since the scene's start, -10000000 to 10000000.
    #[schemars(range(min = TIME.min, max = TIME.max), extend("unit" = TIME.unit))]
    pub start: f64,
    /// Number of its first step; left out, the least one that there is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first: Option<i32>,
    /// Number of its last step; left out, the greatest one that there is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last: Option<i32>,
    /// By how much the number grows from one step to the next, 1 to 1000000.
    #[serde(skip_serializing_if = "is_one")]
    #[schemars(range(min = INCREMENT.min, max = INCREMENT.max))]
    pub increment: u32,
    /// What is there before the first step: "hold", "loop" or "nothing".
    pub before: Beyond,
    /// What is there after the last step: "hold", "loop" or "nothing".
    pub after: Beyond,
}

/// What is there of a sequence where it has no steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Beyond {
    /// The step that is nearest in time.
    #[default]
    Hold,
    /// All steps again, one round after the other.
    Loop,
    /// Nothing.
    Nothing,
}

impl Default for Sequence {
    fn default() -> Self {
        Self {
            fps: None,
            start: 0.0,
            first: None,
            last: None,
            increment: 1,
            before: Beyond::Hold,
            after: Beyond::Hold,
        }
    }
}

fn is_one(increment: &u32) -> bool {
    *increment == 1
}

impl Sequence {
    pub(super) fn check(&self, at: At) -> Result<()> {
        if let Some(fps) = self.fps {
            at.field("fps").number(fps, FPS)?;
        }
        at.field("start").number(self.start, TIME)?;
        at.field("increment").number(self.increment.into(), INCREMENT)?;
        match (self.first, self.last) {
            (Some(first), Some(last)) if first > last => Err(at
                .field("last")
                .problem(format!("{last} comes before the first step, {first}: expected {first} or more"))),
            _ => Ok(()),
        }
    }

    /// Its first step and how many there are, where those from `least` to `greatest` are there.
    pub(super) fn range(&self, least: i32, greatest: i32) -> (i32, u32) {
        let first = self.first.unwrap_or(least);
        let last = self.last.unwrap_or(greatest).max(first);
        (first, last.abs_diff(first) / self.increment.max(1) + 1)
    }

    /// The number of the step that is nearest to `time`, s, where those from `least` to `greatest` are there; `None` where there
    /// is nothing. A sequence that tells no rate has `fps` steps a second.
    pub(super) fn step_at(&self, time: f64, fps: f64, [least, greatest]: [i32; 2]) -> Option<i32> {
        let (first, count) = self.range(least, greatest);
        let place = self.place((time - self.start) * self.fps.unwrap_or(fps), count.into())?;
        let step = (place + 0.5).floor() as i64 % i64::from(count);
        i32::try_from(i64::from(first) + step * i64::from(self.increment)).ok()
    }

    /// A place among `count` steps, the first of which is at 0, for any place on the endless line through them.
    fn place(&self, place: f64, count: f64) -> Option<f64> {
        let last = count - 1.0;
        let (beyond, nearest) = match place {
            place if place < 0.0 => (self.before, 0.0),
            place if place > last => (self.after, last),
            place => return Some(place),
        };
        match beyond {
            Beyond::Hold => Some(nearest),
            Beyond::Loop => Some(place.rem_euclid(count)),
            // A step is there for half its time before and after its own moment.
            Beyond::Nothing => ((-0.5..last + 0.5).contains(&place)).then_some(nearest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(sequence: &Sequence, times: &[f64]) -> Vec<Option<i32>> {
        times.iter().map(|time| sequence.step_at(*time, 24.0, [10, 13])).collect()
    }

    #[test]
    fn steps_are_those_nearest_in_time() {
        let sequence = Sequence { fps: Some(2.0), start: 5.0, ..Sequence::default() };
        let times = [5.0, 5.2, 5.25, 5.5, 6.0, 6.5, 6.74];
        assert_eq!(steps(&sequence, &times), [10, 10, 11, 11, 12, 13, 13].map(Some));
        // Every tenth number, at the timeline's rate.
        let sequence = Sequence { first: Some(-20), last: Some(5), increment: 10, ..Sequence::default() };
        assert_eq!(steps(&sequence, &[0.0, 1.0 / 24.0, 2.0 / 24.0, 9.0]), [-20, -10, 0, 0].map(Some));
        assert_eq!(sequence.range(0, 0), (-20, 3));
    }

    #[test]
    fn beyond_its_ends_it_holds_goes_round_or_is_not_there() {
        let of = |before, after| Sequence { fps: Some(1.0), before, after, ..Sequence::default() };
        let times = [-5.0, -1.0, -0.6, -0.4, 3.4, 3.6, 4.0, 6.0];
        let hold = of(Beyond::Hold, Beyond::Hold);
        assert_eq!(steps(&hold, &times), [10, 10, 10, 10, 13, 13, 13, 13].map(Some));
        let round = of(Beyond::Loop, Beyond::Loop);
        assert_eq!(steps(&round, &times), [13, 13, 13, 10, 13, 10, 10, 12].map(Some));
        let nothing = steps(&of(Beyond::Nothing, Beyond::Nothing), &times);
        assert_eq!(nothing, [None, None, None, Some(10), Some(13), None, None, None]);
        assert_eq!(steps(&of(Beyond::Nothing, Beyond::Loop), &[-2.0, 5.0]), [None, Some(11)]);
    }
}
