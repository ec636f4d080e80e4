//! How a scene changes over time: numbers that follow curves.

mod curve;
mod object;
mod path;

use std::collections::HashSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use curve::{Curve, Interpolation, Key};
pub use object::Owner;
pub(super) use object::write;
pub use path::{Place, owner_path};

use object::Object;
use path::Paths;

use super::Scene;
use super::validate::{At, Limits};
use crate::{Error, Result};

const LENGTH: Limits = Limits::new(0.01, 1e6, "seconds");
const FPS: Limits = Limits::new(0.1, 1000.0, "frames per second");

/// Frames of a loop may miss a whole number by this much.
const WHOLE: f64 = 1e-6;

/// How a scene changes over time. What has no track stays as the scene has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Timeline {
    /// How long it is, seconds, 0.01 to 1000000.
    #[schemars(range(min = LENGTH.min, max = LENGTH.max), extend("unit" = LENGTH.unit))]
    pub length: f64,
    /// Frames per second, 0.1 to 1000.
    #[schemars(range(min = FPS.min, max = FPS.max), extend("unit" = FPS.unit))]
    pub fps: f64,
    /// Whether its end leads into its beginning: curves go on from the last key to the first, and
    /// clouds that the wind carries off are there again.
    #[serde(rename = "loop", skip_serializing_if = "std::ops::Not::not")]
    pub looped: bool,
    /// The numbers that change, each with its keys.
    pub tracks: Vec<Track>,
}

/// A number of the scene that changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// Which number, as the scene's file has it: `sun.position.angles.azimuth_deg`,
    /// `clouds[0].ellipsoids[2].center[1]`, or by name `clouds['anvil'].droplets.albedo`.
    pub path: String,
    /// Its values, in order of time; at least one.
    #[schemars(length(min = 1))]
    pub keys: Vec<Key>,
}

impl Default for Timeline {
    /// Ten seconds at 24 frames a second.
    fn default() -> Self {
        Self { length: 10.0, fps: 24.0, looped: false, tracks: Vec::new() }
    }
}

impl Timeline {
    /// Frames from beginning to end; at least one.
    pub fn frames(&self) -> u32 {
        (self.length * self.fps).round().max(1.0) as u32
    }

    /// The length of a round, s, where it is a loop.
    pub fn period(&self) -> Option<f64> {
        self.looped.then_some(self.length)
    }

    /// `time` (s) within the timeline: the same moment of the first round of a loop, which is the
    /// same number for the same moment; elsewhere as it is.
    pub fn wrapped(&self, time: f64) -> f64 {
        match self.period() {
            // The remainder of a tiny negative time is rounded up to the whole period.
            Some(period) => Some(time.rem_euclid(period)).filter(|time| *time < period).unwrap_or(0.0),
            None => time,
        }
    }

    /// When frame `index` is, s; frame 0 is at 0. In a loop the frame after the last is frame 0,
    /// to the last bit.
    pub fn time_of(&self, index: i64) -> f64 {
        match self.looped {
            true => {
                let frames = i64::from(self.frames());
                self.length * index.rem_euclid(frames) as f64 / frames as f64
            }
            false => index as f64 / self.fps,
        }
    }

    /// The track of `path`, as it is written there.
    pub fn track(&self, path: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.path == path)
    }

    /// The curve of `path`, where it has a track with keys.
    pub fn curve(&self, path: &str) -> Option<Curve> {
        Curve::new(&self.track(path)?.keys, self.period())
    }

    /// Checks everything: also that each track leads to a number of `scene`, and into its range.
    pub(super) fn check(&self, scene: &Scene, at: At) -> Result<()> {
        self.check_shape(at)?;
        self.check_reaches(scene, at, |_| true)
    }

    /// Checks what a moment is made of, however far off other moments may be. The whole past of wind and of
    /// noises' rates counts.
    pub(super) fn check_for_moment(&self, scene: &Scene, at: At) -> Result<()> {
        self.check_shape(at)?;
        self.check_reaches(scene, at, |track| {
            track.path.starts_with("wind") || track.path.ends_with("noise.rate")
        })
    }

    /// Checks all that needs no scene.
    fn check_shape(&self, at: At) -> Result<()> {
        at.field("length").number(self.length, LENGTH)?;
        at.field("fps").number(self.fps, FPS)?;
        let frames = self.length * self.fps;
        if self.looped && (frames - frames.round()).abs() > WHOLE * frames.max(1.0) {
            let fitting = frames.round().max(1.0) / self.fps;
            return Err(at.field("length").problem(format!(
                "a loop of {} seconds at {} frames per second has {frames:.3} frames, no whole number: \
                 make it {fitting} seconds long",
                self.length, self.fps
            )));
        }
        let (tracks, mut known) = (at.field("tracks"), HashSet::new());
        for (i, track) in self.tracks.iter().enumerate() {
            let at = tracks.index(i);
            if !known.insert(track.path.as_str()) {
                return Err(at.field("path").problem(format!("`{}` has two tracks: join them", track.path)));
            }
            track.check_path(at)?;
            track.check_keys(self.length, at)?;
        }
        Ok(())
    }

    /// Checks that those tracks that `count` lead to numbers of `scene`, and into their ranges.
    fn check_reaches(&self, scene: &Scene, at: At, count: impl Fn(&Track) -> bool) -> Result<()> {
        let (tracks, mut paths) = (at.field("tracks"), Paths::new(scene));
        let mut counting = self.tracks.iter().enumerate().filter(|(_, track)| count(track));
        counting.try_for_each(|(i, track)| track.check_reach(self.period(), &mut paths, tracks.index(i)))
    }

    /// The numbers of all tracks with keys at `time`, s, and where in `scene` they belong; what is
    /// wrong, in a sentence, with a path that leads nowhere.
    pub(super) fn numbers(
        &self,
        scene: &Scene,
        time: f64,
    ) -> impl Iterator<Item = std::result::Result<(Place, f64), String>> {
        let (period, mut paths) = (self.period(), Paths::new(scene));
        self.tracks.iter().filter_map(move |track| {
            let value = Curve::new(&track.keys, period)?.at(time);
            Some(paths.find(&track.path).map(|place| (place, value)))
        })
    }
}

impl Track {
    fn check_keys(&self, length: f64, at: At) -> Result<()> {
        let list = at.field("keys");
        if self.keys.is_empty() {
            return Err(list.problem("a track needs at least one key"));
        }
        for (i, key) in self.keys.iter().enumerate() {
            let at = list.index(i);
            at.field("time").number(key.time, Limits::new(0.0, length, "seconds, the timeline's length"))?;
            if i > 0 && key.time <= self.keys[i - 1].time {
                return Err(at.field("time").problem(format!(
                    "{} comes after {}: keys stand in order of time, one at a time",
                    key.time,
                    self.keys[i - 1].time
                )));
            }
            let any = Limits::new(f64::MIN, f64::MAX, "");
            at.field("value").number(key.value, any)?;
            for (name, handle, side) in [("before", key.before, -1.0), ("after", key.after, 1.0)] {
                let at = at.field(name);
                at.numbers(&handle.unwrap_or_default(), any)?;
                if handle.is_some_and(|[time, _]| time * side < 0.0) {
                    let word = if side < 0.0 { "at or below" } else { "at or above" };
                    return Err(at.problem(format!("a handle `{name}` its key has seconds {word} 0")));
                }
            }
        }
        Ok(())
    }

    /// Some numbers follow no curve.
    fn check_path(&self, at: At) -> Result<()> {
        if self.path == "format" || self.path == "time" || self.path.starts_with("timeline") {
            return Err(self.leads_nowhere(at, "this one can't be animated"));
        }
        Ok(())
    }

    fn leads_nowhere(&self, at: At, problem: &str) -> Error {
        at.field("path").problem(format!("`{}`: {problem}", self.path))
    }

    /// What the curve reaches is in the range of what it moves.
    fn check_reach(&self, period: Option<f64>, paths: &mut Paths<'_>, at: At) -> Result<()> {
        let leads_nowhere = |problem: String| self.leads_nowhere(at, &problem);
        let place = paths.find(&self.path).map_err(leads_nowhere)?;
        if let Some(cloud) = place.grown_with(paths.scene()) {
            let path = owner_path(Owner::Cloud(cloud), paths.scene());
            return Err(leads_nowhere(format!(
                "the cloud grows, and its ellipsoids with it: animate a number of its growth, such as \
                 {path}.growth.height, or give it `ellipsoids` in place of `growth`"
            )));
        }
        let object = Object::of(place.owner, paths.scene());
        object.number(&place.steps).map_err(leads_nowhere)?;
        let (low, high) = Curve::new(&self.keys, period).map_or((0.0, 0.0), |curve| curve.reach());
        for value in [low, high] {
            let moved = object.with([(place.steps.as_slice(), value)]).map_err(leads_nowhere)?;
            moved.check().map_err(|error| {
                at.field("keys").problem(format!("keys and handles reach {value}: {error}"))
            })?;
        }
        Ok(())
    }
}
