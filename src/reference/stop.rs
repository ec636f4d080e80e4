//! When a path tracer has done enough.

use std::time::Instant;

use super::{Estimate, PathTracer};
use crate::{Error, Result};

/// Ends a picture at whichever of these comes first; the default never ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Samples of each pixel.
    pub samples: u32,
    /// Relative noise, [`Estimate::noise`]; 0 for never.
    pub noise: f64,
    /// Time, s; it is kept to within the least that can be added to all pixels.
    pub seconds: f64,
}

impl Default for Stop {
    fn default() -> Self {
        Self { samples: u32::MAX, noise: 0.0, seconds: f64::INFINITY }
    }
}

/// How far a picture is.
#[derive(Debug)]
pub struct Progress<'a> {
    /// Share of the work that is done, 0 to 1.
    pub share: f64,
    /// What has been found, each time that all pixels have equally many samples.
    pub estimate: Option<&'a Estimate>,
}

/// Noise means little before each pixel has so many samples.
const LEAST_FOR_NOISE: u32 = 24;

impl PathTracer {
    /// Adds samples until `stop`, and gives what has been found. `progress` is told after each
    /// piece of work; false from it ends the picture with the last whole one, as does
    /// [`crate::gpu::Gpu::stop_token`] where there is one.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the device fails, [`Error::Stopped`], or what `progress` fails with.
    pub fn trace_until(
        &mut self,
        stop: &Stop,
        progress: &mut dyn FnMut(&Progress<'_>) -> Result<bool>,
    ) -> Result<Estimate> {
        let mut run = Run::new(self.estimate()?, self.unit());
        match self.improve(&mut run, stop, progress) {
            Err(Error::Stopped { .. }) if run.estimate.samples > 0 => Ok(run.estimate),
            result => result.map(|()| run.estimate),
        }
    }

    fn improve(
        &mut self,
        run: &mut Run,
        stop: &Stop,
        progress: &mut dyn FnMut(&Progress<'_>) -> Result<bool>,
    ) -> Result<()> {
        while let Some(samples) = run.next(stop) {
            let mut share = 0.0;
            while share < 1.0 {
                share = self.advance(samples)?;
                let told = Progress { share: run.share(stop, samples, share), estimate: None };
                if !progress(&told)? {
                    return Ok(());
                }
            }
            run.estimate = self.estimate()?;
            let told = Progress { share: run.share(stop, samples, 0.0), estimate: Some(&run.estimate) };
            if !progress(&told)? {
                break;
            }
        }
        Ok(())
    }
}

/// A picture under way.
struct Run {
    started: Instant,
    /// Samples that there were at first.
    first: u32,
    /// The least that is added at once: what gives each thread and each channel as much.
    unit: u32,
    estimate: Estimate,
}

impl Run {
    fn new(estimate: Estimate, unit: u32) -> Self {
        Self { started: Instant::now(), first: estimate.samples, unit, estimate }
    }

    /// How many samples each pixel shall have next; none where it is enough.
    fn next(&self, stop: &Stop) -> Option<u32> {
        let samples = self.estimate.samples;
        let calm = stop.noise > 0.0 && samples >= LEAST_FOR_NOISE && self.estimate.noise() <= stop.noise;
        let more = self.step(stop).min(stop.samples.saturating_sub(samples));
        (more > 0 && !calm).then_some(samples + more)
    }

    /// Samples to add at once: few at first, a quarter of what there is later, not more than the
    /// time allows, at most a twentieth of the whole so that there is progress to tell.
    fn step(&self, stop: &Stop) -> u32 {
        let whole = |samples: u32| samples / self.unit * self.unit;
        let grown = (self.estimate.samples / 4).min(stop.samples / 20).min(1 << 16);
        let step = whole(grown).max(self.unit);
        match self.affordable(stop.seconds) {
            Some(most) => step.min(whole(most)),
            None => step,
        }
    }

    /// Samples that the time left is enough for, by the pace so far; unknown at first.
    fn affordable(&self, seconds: f64) -> Option<u32> {
        let added = self.estimate.samples - self.first;
        let elapsed = self.started.elapsed().as_secs_f64();
        (added > 0 && seconds.is_finite()).then(|| (f64::from(added) * (seconds / elapsed - 1.0)) as u32)
    }

    /// Share of the whole work, `part` of the way from the estimate to `samples`.
    fn share(&self, stop: &Stop, samples: u32, part: f64) -> f64 {
        let now = f64::from(self.estimate.samples);
        let then = now + part * (f64::from(samples) - now).max(0.0);
        let by_samples = then / f64::from(stop.samples);
        let by_time = self.started.elapsed().as_secs_f64() / stop.seconds;
        let by_noise = if now > 0.0 { (stop.noise / self.estimate.noise()).powi(2) } else { 0.0 };
        by_samples.max(by_time).max(by_noise).min(1.0)
    }
}
