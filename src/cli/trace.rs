//! `--transport path`: pictures that get better until they are good enough, are kept
//! on the way, and can be gone on with.

use std::{
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use super::picture::{Drawn, Job, Painter, PictureOptions};
use crate::{
    Error, Result,
    export::{self, Picture},
    reference::{Estimate, PathTracer, Stop},
    scene::Scene,
};

/// What there is so far is written so often: an end by force costs no more than this.
const KEEP_EVERY: Duration = Duration::from_secs(20);
/// Samples where nothing else ends a picture, and where something does.
const USUAL: u32 = 96;
const MOST: u32 = 1_000_000;

impl PictureOptions {
    /// Traces the picture, and writes it now and then where it shall be kept.
    pub(super) fn trace(
        &self,
        painter: &mut Painter,
        job: &Job<'_>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Drawn> {
        let frame = &job.frame;
        let sky =
            if self.transparent { None } else { Some(painter.renderer.sky_picture(&painter.gpu, frame)?) };
        let mut tracer = PathTracer::new(&painter.gpu, frame, 0)?;
        if job.resume && job.output.exists() {
            tracer = tracer.after(self.earlier(job)?)?;
        }
        let mut kept = Instant::now();
        let estimate = tracer.trace_until(&self.stop(), &mut |now| {
            progress(now.share);
            if let Some(estimate) = now.estimate.filter(|_| job.keep && kept.elapsed() > KEEP_EVERY) {
                let drawn = self.composed(sky.as_ref(), estimate.clone());
                self.write(painter, job, &drawn)?;
                kept = Instant::now();
            }
            Ok(true)
        })?;
        // What there is so far is worth to be finished, where it is wanted.
        let stopped = job.keep && painter.gpu.stop_token().swap(false, Ordering::Relaxed);
        Ok(Drawn { stopped, ..self.composed(sky.as_ref(), estimate) })
    }

    fn stop(&self) -> Stop {
        let ends = self.noise.is_some() || self.seconds.is_some();
        Stop {
            samples: self.spp.unwrap_or(if ends { MOST } else { USUAL }),
            noise: self.noise.unwrap_or(0.0),
            seconds: self.seconds.unwrap_or(f64::INFINITY),
        }
    }

    /// What the output holds already, of the same scene and size.
    fn earlier(&self, job: &Job<'_>) -> Result<Estimate> {
        let found = export::read_estimate(job.output)?;
        let refuse = |problem: String| {
            let problem = format!("{problem}; write to another file, or leave --resume out to replace it");
            Err(Error::Format { path: job.output.to_owned(), problem })
        };
        if found.size != [self.width, self.height] {
            let [width, height] = found.size;
            return refuse(format!("has {width}x{height} pixels, not {}x{}", self.width, self.height));
        }
        // Light knows nothing of exposure.
        let scene = job.scene;
        let Scene { exposure, auto_exposure, tone_curve, .. } = found.scene;
        let own = Scene { exposure, auto_exposure, tone_curve, ..scene.clone() };
        if found.scene != own {
            return refuse("is a picture of another scene".to_owned());
        }
        Ok(found.estimate)
    }

    /// The clouds over the sky, where there is one.
    fn composed(&self, sky: Option<&Picture>, estimate: Estimate) -> Drawn {
        let [width, height] = [self.width, self.height].map(|n| n as usize);
        let mut picture = Picture { width, height, pixels: estimate.mean.clone() };
        if let Some(sky) = sky {
            picture.put_over(sky);
        }
        Drawn { picture, estimate: Some(estimate), stopped: false }
    }
}
