//! A scene at one moment. The same time gives the same scene, to the last bit, in whatever
//! order moments are asked for: nothing is carried from one to the next.
//!
//! # Loops
//!
//! The noise stands still in the world and clouds drift through it, so a cloud's billows would
//! repeat only where the drift of a period is one of the noise's own periods. There is none: its
//! fine octaves repeat on a lattice that is turned against the coarse ones' by an angle that makes
//! no rational rotation, so that no shift but zero brings both back. A loop is closed by clouds
//! that end instead. One with a life is gone before it has to be where it began. One without
//! hands over to itself: while the wind carries it off, another of it comes to where it was, and is
//! whole before the first begins to dissolve. They are one cloud: what they share counts once.

use glam::DVec3;

use super::life::{self, smooth};
use super::{Camera, Cloud, Ellipsoid, Scene, timeline};
use crate::Result;

impl Scene {
    /// The scene as it is at `time`, s since its start: a still one, whose own time is 0. Curves,
    /// lives and wind are applied; the camera is there, and is not that of the moved clouds where
    /// the scene has none.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) where the scene is not valid, or the curves together
    /// make something of it that is not: a camera that runs into its target.
    pub fn at(&self, time: f64) -> Result<Self> {
        self.validate()?;
        let mut moment = self.posed(time);
        moment.check_moment().map_err(|error| error.at_time(time))?;
        moment.camera = Some(self.camera.as_ref().map_or_else(|| self.camera(), |_| moment.camera()));
        moment.let_live_and_drift();
        (moment.time, moment.timeline) = (0.0, None);
        Ok(moment)
    }

    /// The scene with the numbers that curves give them at `time`, s; everything else is as it
    /// was, and its time is that one. What an editor shows as values.
    pub fn posed(&self, time: f64) -> Self {
        let mut posed = Self { time, ..self.clone() };
        if let Some(timeline) = &self.timeline {
            let time = timeline.wrapped(time);
            posed.time = time;
            timeline::pose(&mut posed, timeline, time);
        }
        posed
    }

    /// The same scene seen by another camera, which no curve moves.
    pub fn seen_by(&self, camera: Camera) -> Self {
        let mut scene = Self { camera: Some(camera), ..self.clone() };
        if let Some(timeline) = &mut scene.timeline {
            timeline.tracks.retain(|track| !track.path.starts_with("camera"));
        }
        scene
    }

    /// How far the wind has carried a cloud without a life at the scene's own time, m. In a loop
    /// that is no more than what the wind brings back within a period.
    pub fn drift(&self) -> DVec3 {
        match self.period() {
            Some(period) if self.drift_since_start(period) != DVec3::ZERO => DVec3::ZERO,
            _ => self.drift_since_start(self.time),
        }
    }

    pub(super) fn period(&self) -> Option<f64> {
        self.timeline.as_ref().and_then(super::Timeline::period)
    }

    /// Integral of the wind from 0 to `time`, m.
    fn drift_since_start(&self, time: f64) -> DVec3 {
        let along = |axis: usize| {
            let curve = self.timeline.as_ref().and_then(|t| t.curve(&format!("wind.velocity[{axis}]")));
            curve.map_or(self.wind.velocity[axis] * time, |curve| curve.integral(time))
        };
        DVec3::new(along(0), along(1), along(2))
    }

    /// Clouds as they have become and where the wind has brought them at the scene's own time.
    fn let_live_and_drift(&mut self) {
        let (time, period) = (self.time, self.period());
        let since_start = |time: f64| self.drift_since_start(time);
        let mut clouds = self.clouds.clone();
        for cloud in &mut clouds {
            match (&cloud.life.take(), period) {
                (Some(life), _) => {
                    let (age, span) = (life.age(time, period), life.span(period));
                    let drift = since_start(life.birth + age) - since_start(life.birth + 0.5 * span);
                    life::grown(cloud, life.fullness(age, span));
                    blow(&mut cloud.ellipsoids, drift);
                }
                (None, Some(period)) if since_start(period) != DVec3::ZERO => {
                    let (gone, round) = (since_start(time), since_start(period));
                    let coming = part(cloud, 2.0 * time / period, gone - round);
                    let leaving = part(cloud, 2.0 * (1.0 - time / period), gone);
                    cloud.ellipsoids = [leaving, coming].concat();
                }
                (None, _) => blow(&mut cloud.ellipsoids, since_start(time)),
            }
        }
        self.clouds = clouds;
    }
}

/// The ellipsoids of a cloud of which as much is there as a smooth ramp to 1 has come to,
/// carried by `drift`, m.
fn part(cloud: &Cloud, ramp: f64, drift: DVec3) -> Vec<Ellipsoid> {
    let there = smooth(ramp.clamp(0.0, 1.0));
    let mut ellipsoids = if there > 0.0 { cloud.ellipsoids.clone() } else { Vec::new() };
    ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.density *= there);
    blow(&mut ellipsoids, drift);
    ellipsoids
}

fn blow(ellipsoids: &mut [Ellipsoid], drift: DVec3) {
    ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.center += drift);
}
