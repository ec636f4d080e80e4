//! Which step of a sequence of volumes is there at a time.

use glam::{DMat3, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TIME;
use super::validate::{At, Limits};
use crate::Result;

const FPS: Limits = Limits::new(1e-6, 1000.0, "frames per second");
const INCREMENT: Limits = Limits::new(1.0, 1e6, "");
const VELOCITY: Limits = Limits::new(-1000.0, 1000.0, "metres per second");
const INTERVAL: Limits = Limits::new(1e-6, 1e7, "seconds");
/// Places that are no farther from a step, in steps, are there.
const SAME: f64 = 1e-6;

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
    /// What is there between two steps: "auto", "nearest", "blend" or "flow".
    #[serde(skip_serializing_if = "is_auto")]
    pub between: Between,
    /// How fast what is in the grid goes through it, [x, y, z] in the scene, metres per second, -1000 to 1000; left out, as
    /// fast as a grid `vel`, `v` or `velocity` in its files tells.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<[f64; 3]>", inner(inner(range(min = VELOCITY.min, max = VELOCITY.max))), extend("unit" = VELOCITY.unit))]
    pub velocity: Option<DVec3>,
    /// How much of its own time, in which velocities count, is from one step to the next, seconds, 0.000001 to 10000000; left
    /// out, as much as it is played in.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = INTERVAL.min, max = INTERVAL.max), extend("unit" = INTERVAL.unit))]
    pub interval: Option<f64>,
}

/// What is there between two steps of a sequence.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Between {
    /// Flow where its motion is told, by a velocity or by its files; else the nearest step.
    #[default]
    Auto,
    /// The step that is nearest in time.
    Nearest,
    /// Both steps, the one fading out while the other fades in: what moves is there twice.
    Blend,
    /// Both steps, each moved along its velocities to where it is then: what moves is there once.
    Flow,
}

/// What of a sequence is there at a time: a step, or what is between it and another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shown {
    pub number: i32,
    pub mix: Option<Mix>,
}

/// What is between two steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mix {
    /// The later one, and the share of the way to it.
    pub next: i32,
    pub share: f64,
    pub way: Way,
}

/// How far matter goes from one step to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// All of it as far, in the file's lengths.
    Even(DVec3),
    /// As far as it goes in so many seconds with the velocities that its files tell.
    Told(f64),
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
            between: Between::Auto,
            velocity: None,
            interval: None,
        }
    }
}

fn is_one(increment: &u32) -> bool {
    *increment == 1
}

fn is_auto(between: &Between) -> bool {
    *between == Between::Auto
}

impl Sequence {
    pub(super) fn check(&self, at: At) -> Result<()> {
        if let Some(fps) = self.fps {
            at.field("fps").number(fps, FPS)?;
        }
        at.field("start").number(self.start, TIME)?;
        at.field("increment").number(self.increment.into(), INCREMENT)?;
        if let Some(velocity) = self.velocity {
            at.field("velocity").numbers(&velocity.to_array(), VELOCITY)?;
        }
        if let Some(interval) = self.interval {
            at.field("interval").number(interval, INTERVAL)?;
        }
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

    /// How far matter goes from one step to the next, for what is between them; `None` where that is the nearest step. A
    /// sequence that tells no rate has `fps` steps a second; `to_file` brings vectors of the scene into the file, which may
    /// have velocities of its own.
    ///
    /// # Errors
    /// Where motion is wanted and nothing tells it, as the rest of a sentence.
    pub(super) fn way(
        &self,
        fps: f64,
        to_file: DMat3,
        has_velocities: impl Fn() -> bool,
    ) -> std::result::Result<Option<Way>, String> {
        let seconds = self.interval.unwrap_or_else(|| 1.0 / self.fps.unwrap_or(fps));
        Ok(match (self.between, self.velocity) {
            (Between::Nearest, _) => None,
            (Between::Blend, _) => Some(Way::Even(DVec3::ZERO)),
            (_, Some(velocity)) => Some(Way::Even(to_file * velocity * seconds)),
            _ if has_velocities() => Some(Way::Told(seconds)),
            (Between::Auto, None) => None,
            (Between::Flow, None) => {
                return Err("has no grid of velocities `vel`, `v` or `velocity`: export one with it, give `velocity`, or \
                            choose \"blend\" or \"nearest\" in `between`"
                    .to_owned());
            }
        })
    }

    /// What is there at `time`, s, where the steps from `least` to `greatest` are there; `None` where there is nothing. A
    /// sequence that tells no rate has `fps` steps a second. Between steps it is the nearest one where there is no `way`.
    pub(super) fn shown(
        &self,
        time: f64,
        fps: f64,
        [least, greatest]: [i32; 2],
        way: Option<Way>,
    ) -> Option<Shown> {
        let (first, count) = self.range(least, greatest);
        let place = self.place((time - self.start) * self.fps.unwrap_or(fps), count.into())?;
        let number = |step: f64| {
            let step = step as i64 % i64::from(count);
            i32::try_from(i64::from(first) + step * i64::from(self.increment)).ok()
        };
        let nearest = (place + 0.5).floor();
        let Some(way) = way.filter(|_| (place - nearest).abs() > SAME) else {
            return Some(Shown { number: number(nearest)?, mix: None });
        };
        let (before, after) = (place.floor(), place.floor() + 1.0);
        let mix = Mix { next: number(after)?, share: place - before, way };
        Some(Shown { number: number(before)?, mix: Some(mix) })
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
        times.iter().map(|time| Some(sequence.shown(*time, 24.0, [10, 13], None)?.number)).collect()
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

    #[test]
    fn between_steps_there_is_a_share_of_both_and_at_their_times_one() {
        let sequence = Sequence { fps: Some(2.0), after: Beyond::Loop, ..Sequence::default() };
        let shown = |time: f64| {
            let shown = sequence.shown(time, 24.0, [10, 13], Some(Way::Told(0.5))).unwrap();
            (shown.number, shown.mix.map(|mix| (mix.next, mix.share)))
        };
        assert_eq!([0.0, 0.5, 1.5, -3.0].map(shown), [(10, None), (11, None), (13, None), (10, None)]);
        assert_eq!(
            [0.125, 0.75, 1.875].map(shown),
            [(10, Some((11, 0.25))), (11, Some((12, 0.5))), (13, Some((10, 0.75)))]
        );
        // Times are no decimal fractions: frames of 24 a second are at those of their steps.
        let film = Sequence { fps: Some(24.0), ..Sequence::default() };
        assert!((0..200).all(|i| {
            film.shown(f64::from(i) / 24.0, 24.0, [0, 300], Some(Way::Told(1.0))).unwrap().mix.is_none()
        }));
    }

    #[test]
    fn motion_is_what_is_told_and_nothing_where_nothing_is() {
        let way = |between, velocity, told: bool| {
            let sequence = Sequence { fps: Some(4.0), between, velocity, ..Sequence::default() };
            sequence.way(24.0, DMat3::from_diagonal(DVec3::splat(0.5)), || told)
        };
        let wind = Some(DVec3::new(8.0, 0.0, 4.0));
        assert_eq!(way(Between::Auto, None, false), Ok(None));
        assert_eq!(way(Between::Auto, None, true), Ok(Some(Way::Told(0.25))));
        assert_eq!(way(Between::Auto, wind, true), Ok(Some(Way::Even(DVec3::new(1.0, 0.0, 0.5)))));
        assert_eq!(way(Between::Nearest, wind, true), Ok(None));
        assert_eq!(way(Between::Blend, wind, true), Ok(Some(Way::Even(DVec3::ZERO))));
        assert!(way(Between::Flow, None, false).unwrap_err().contains("give `velocity`"));
    }
}
