//! A number over time: keys, and what lies between them.
//!
//! Everything here is made of sums, products and quotients of doubles: the same keys give the
//! same bits on every machine.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Halvings that find a time on a cubic curve: more than a double has bits.
const HALVINGS: u32 = 60;

/// Nodes and weights of Gauss and Legendre on [0, 1]: exact for polynomials of degree 5, as
/// value times speed of a cubic curve is one.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// How a number gets from one key to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// It stays, and jumps at the next key.
    Step,
    /// It goes evenly.
    Linear,
    /// It follows a cubic Bezier curve, whose handles are the keys' own, or smooth ones that
    /// do not overshoot where a key has none.
    #[default]
    Cubic,
}

/// A value at a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// When, seconds since the scene's start, from 0 to the timeline's length.
    #[schemars(range(min = 0.0), extend("unit" = "seconds"))]
    pub time: f64,
    /// The number then, in the unit of what is animated.
    pub value: f64,
    /// The way to the next key: "step", "linear" or "cubic"; "cubic" where left out.
    #[serde(default, skip_serializing_if = "is_cubic")]
    pub interpolation: Interpolation,
    /// Handle of the cubic curve that comes here: seconds (0 or less) and value from the key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before: Option<[f64; 2]>,
    /// Handle of the cubic curve that leaves here: seconds (0 or more) and value from the key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<[f64; 2]>,
}

fn is_cubic(interpolation: &Interpolation) -> bool {
    *interpolation == Interpolation::Cubic
}

impl Key {
    /// A key with smooth handles of its own accord.
    pub fn new(time: f64, value: f64) -> Self {
        Self { time, value, interpolation: Interpolation::Cubic, before: None, after: None }
    }
}

/// The curve through keys, in order of time: constant before the first and after the last, or,
/// with a period, from the last on to the first of the next round.
#[derive(Debug, Clone)]
pub struct Curve {
    segments: Vec<Segment>,
    first: Key,
    last: Key,
    period: Option<f64>,
}

impl Curve {
    /// Through `keys`, which stand in order of time; none for none. In a round of `period`
    /// seconds, keys at its very end are those of its beginning and do not count.
    pub fn new(keys: &[Key], period: Option<f64>) -> Option<Self> {
        let mut keys: Vec<Key> = keys.to_vec();
        if let Some(period) = period {
            let first = *keys.first()?;
            keys.retain(|key| key.time < period || *key == first);
        }
        let (first, last) = (*keys.first()?, *keys.last()?);
        // One more key on each side, where there is one: slopes look at neighbours.
        let shifted = |key: Key, by: f64| Key { time: key.time + by, ..key };
        let before = period.map(|period| shifted(last, -period));
        let after = period.map(|period| shifted(first, period));
        let beyond = period
            .map(|period| shifted(keys[1 % keys.len()], period * if keys.len() > 1 { 1.0 } else { 2.0 }));
        let around: Vec<Option<Key>> =
            [before].into_iter().chain(keys.iter().copied().map(Some)).chain([after, beyond]).collect();
        let segment = |four: &[Option<Key>]| Segment::new(four[0], four[1]?, four[2]?, four[3]);
        Some(Self { segments: around.windows(4).filter_map(segment).collect(), first, last, period })
    }

    /// The number at `time`, s.
    pub fn at(&self, time: f64) -> f64 {
        let time = self.wrapped(time);
        match self.segments.iter().rev().find(|segment| segment.from.time <= time) {
            _ if time <= self.first.time => self.first.value,
            _ if self.period.is_none() && time >= self.last.time => self.last.value,
            Some(segment) => segment.at(time),
            None => self.last.value,
        }
    }

    /// Integral of the number from 0 to `time`, in its unit times seconds: exact, not summed up
    /// over frames.
    pub fn integral(&self, time: f64) -> f64 {
        match self.period {
            None => self.since_first(time) - self.since_first(0.0),
            Some(period) => {
                let rounds = (time / period).floor();
                let rest = time - rounds * period;
                let start = self.first.time;
                let round = self.since_first(start + period);
                let until = |time: f64| {
                    if time >= start {
                        self.since_first(time)
                    } else {
                        self.since_first(time + period) - round
                    }
                };
                rounds * round + until(rest) - until(0.0)
            }
        }
    }

    /// The least and the greatest number that the curve can take: those of keys and handles.
    pub fn reach(&self) -> (f64, f64) {
        let ends = [self.first.value, self.last.value];
        let inside = self.segments.iter().flat_map(Segment::control_values);
        ends.into_iter()
            .chain(inside)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    }

    /// Where the handles of the key number `index` end, seconds and value: before it, after it.
    pub fn handles(&self, index: usize) -> [Option<[f64; 2]>; 2] {
        let cubic = |segment: &&Segment| segment.from.interpolation == Interpolation::Cubic;
        let period = self.period.unwrap_or(0.0);
        let coming = match (index.checked_sub(1), self.period) {
            (Some(before), _) => self.segments.get(before).map(|segment| (segment, 0.0)),
            (None, Some(_)) => self.segments.last().map(|segment| (segment, period)),
            (None, None) => None,
        };
        let leaving = self.segments.get(index).filter(cubic);
        [
            coming.filter(|(segment, _)| cubic(segment)).map(|(segment, by)| {
                let [time, value] = segment.before;
                [time - by, value]
            }),
            leaving.map(|segment| segment.after),
        ]
    }

    /// Integral from the first key to `time`.
    fn since_first(&self, time: f64) -> f64 {
        if time <= self.first.time {
            return (time - self.first.time) * self.first.value;
        }
        let inside: f64 = self
            .segments
            .iter()
            .take_while(|segment| segment.from.time < time)
            .map(|segment| segment.integral(time.min(segment.to.time)))
            .sum();
        let end = self.segments.last().map_or(self.first.time, |segment| segment.to.time);
        inside + (time - end).max(0.0) * self.last.value
    }

    /// `time` within the round that begins at the first key.
    fn wrapped(&self, time: f64) -> f64 {
        match self.period {
            Some(period) if time < self.first.time || time >= self.first.time + period => {
                self.first.time + (time - self.first.time).rem_euclid(period)
            }
            _ => time,
        }
    }
}

/// The way from one key to the next.
#[derive(Debug, Clone)]
struct Segment {
    from: Key,
    to: Key,
    /// Ends of the two handles, seconds and value.
    after: [f64; 2],
    before: [f64; 2],
}

impl Segment {
    /// From `from` to `to`, between the neighbours on both sides; none where no time lies between.
    fn new(earlier: Option<Key>, from: Key, to: Key, later: Option<Key>) -> Option<Self> {
        let span = to.time - from.time;
        if span <= 0.0 {
            return None;
        }
        let after = from.after.unwrap_or_else(|| smooth(earlier, from, Some(to), span));
        let before = to.before.unwrap_or_else(|| smooth(Some(from), to, later, -span));
        let from_key = |key: Key, [time, value]: [f64; 2]| {
            // A handle that is longer than the way is shortened, so that no time comes twice.
            let share = if time.abs() > span { span / time.abs() } else { 1.0 };
            [key.time + share * time, key.value + share * value]
        };
        Some(Self { from, to, after: from_key(from, after), before: from_key(to, before) })
    }

    fn control_values(&self) -> Vec<f64> {
        match self.from.interpolation {
            Interpolation::Cubic => vec![self.from.value, self.after[1], self.before[1], self.to.value],
            _ => vec![self.from.value, self.to.value],
        }
    }

    fn at(&self, time: f64) -> f64 {
        if time >= self.to.time {
            return self.to.value;
        }
        let (from, to) = (&self.from, &self.to);
        match from.interpolation {
            Interpolation::Step => from.value,
            Interpolation::Linear => {
                from.value + (to.value - from.value) * ((time - from.time) / (to.time - from.time))
            }
            Interpolation::Cubic => self.value(self.parameter(time)),
        }
    }

    /// Integral from the first key to `time`.
    fn integral(&self, time: f64) -> f64 {
        let span = time - self.from.time;
        match self.from.interpolation {
            Interpolation::Step => span * self.from.value,
            Interpolation::Linear => span * 0.5 * (self.from.value + self.at(time)),
            Interpolation::Cubic => {
                let end = self.parameter(time);
                GAUSS.iter().map(|(x, weight)| end * weight * self.value(end * x) * self.speed(end * x)).sum()
            }
        }
    }

    /// Where on the curve `time` is: Bezier's parameter, 0 to 1. Times never fall along it.
    fn parameter(&self, time: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        if time >= self.to.time {
            return high;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.time(middle) <= time { low = middle } else { high = middle }
        }
        low
    }

    fn time(&self, s: f64) -> f64 {
        bezier([self.from.time, self.after[0], self.before[0], self.to.time], s)
    }

    fn value(&self, s: f64) -> f64 {
        bezier([self.from.value, self.after[1], self.before[1], self.to.value], s)
    }

    /// Seconds for each unit of the parameter.
    fn speed(&self, s: f64) -> f64 {
        let r = 1.0 - s;
        let [a, b, c, d] = [self.from.time, self.after[0], self.before[0], self.to.time];
        3.0 * (r * r * (b - a) + 2.0 * r * s * (c - b) + s * s * (d - c))
    }
}

/// A cubic Bezier curve; exactly constant where all four are the same.
fn bezier([a, b, c, d]: [f64; 4], s: f64) -> f64 {
    let r = 1.0 - s;
    a + 3.0 * r * r * s * (b - a) + 3.0 * r * s * s * (c - a) + s * s * s * (d - a)
}

/// A handle of `key` as long as a third of `span`, s: level at ends, peaks and hollows, elsewhere
/// along the mean slope, but no steeper than three times that of either neighbour: such a cubic is
/// monotone between its keys (Fritsch and Carlson 1980).
fn smooth(earlier: Option<Key>, key: Key, later: Option<Key>, span: f64) -> [f64; 2] {
    let slope = |a: Key, b: Key| (b.time > a.time).then(|| (b.value - a.value) / (b.time - a.time));
    let slope = match (earlier.and_then(|a| slope(a, key)), later.and_then(|b| slope(key, b))) {
        (Some(before), Some(after)) if before * after > 0.0 => {
            let steepest = 3.0 * before.abs().min(after.abs());
            (0.5 * (before + after)).clamp(-steepest, steepest)
        }
        _ => 0.0,
    };
    [span / 3.0, slope * span / 3.0]
}
