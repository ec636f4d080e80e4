//! `nephos render --transport path`: pictures that get better until they are good enough, are kept
//! on the way, and can be gone on with.

use std::time::{Duration, Instant};

use super::render::{Format, Render};
use crate::{
    Error, Result,
    export::{self, Picture},
    gpu::Gpu,
    reference::{Estimate, PathTracer, Stop},
    render::{Frame, Renderer},
    scene::Scene,
};

/// What there is so far is written so often: an end by force costs no more than this.
const KEEP_EVERY: Duration = Duration::from_secs(20);
/// Samples where nothing else ends a picture, and where something does.
const USUAL: u32 = 96;
const MOST: u32 = 1_000_000;

impl Render {
    /// Traces the picture and writes it, now and then and at the end.
    pub(super) fn trace(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        frame: &Frame,
        scene: &Scene,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Estimate> {
        let sky = if self.transparent { None } else { Some(sky(gpu, renderer, frame)?) };
        let mut tracer = PathTracer::new(gpu, frame, 0)?;
        if self.resume && self.output.exists() {
            tracer = tracer.after(self.earlier(scene)?)?;
        }
        let mut kept = Instant::now();
        let estimate = tracer.trace_until(&self.stop(), &mut |now| {
            progress(now.share);
            if let Some(estimate) = now.estimate.filter(|_| kept.elapsed() > KEEP_EVERY) {
                self.keep(gpu, renderer, scene, sky.as_ref(), estimate)?;
                kept = Instant::now();
            }
            Ok(true)
        })?;
        self.keep(gpu, renderer, scene, sky.as_ref(), &estimate)?;
        Ok(estimate)
    }

    /// Complains of words that belong to path tracing alone, or to EXR files.
    pub(super) fn check_tracing(&self, format: Format) -> Result<()> {
        let words = [
            ("--noise", self.noise.is_some()),
            ("--seconds", self.seconds.is_some()),
            ("--resume", self.resume),
        ];
        match words.into_iter().find(|(_, given)| *given) {
            Some((word, _)) if !self.traces_paths() => {
                Err(Error::Argument(format!("{word} is for --transport path: add that or leave it out")))
            }
            _ if self.resume && format != Format::Exr => Err(Error::Argument(format!(
                "--resume goes on with a picture that ends in .exr, and `{}` does not: only EXR files hold \
                 what was found so far",
                self.output.display()
            ))),
            _ => Ok(()),
        }
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
    fn earlier(&self, scene: &Scene) -> Result<Estimate> {
        let found = export::read_estimate(&self.output)?;
        let refuse = |problem: String| {
            let problem = format!("{problem}; write to another file, or leave --resume out to replace it");
            Err(Error::Format { path: self.output.clone(), problem })
        };
        if found.size != [self.width, self.height] {
            let [width, height] = found.size;
            return refuse(format!("has {width}x{height} pixels, not {}x{}", self.width, self.height));
        }
        // Light knows nothing of exposure.
        let own =
            Scene { exposure: found.scene.exposure, tone_curve: found.scene.tone_curve, ..scene.clone() };
        if found.scene != own {
            return refuse("is a picture of another scene".to_owned());
        }
        Ok(found.estimate)
    }

    /// Writes a picture whole, over the sky where there is one.
    fn keep(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        scene: &Scene,
        sky: Option<&Picture>,
        estimate: &Estimate,
    ) -> Result<()> {
        let size = [self.width, self.height];
        let [width, height] = size.map(|n| n as usize);
        let mut picture = Picture { width, height, pixels: estimate.mean.clone() };
        if let Some(sky) = sky {
            picture.put_over(sky);
        }
        match Format::of(&self.output)? {
            Format::Exr => export::write_estimate(&self.output, &picture, estimate, scene),
            Format::Png => {
                let bytes = picture.finished(gpu, renderer, scene.tone())?;
                export::write_png(&self.output, size, &bytes, self.transparent)
            }
        }
    }
}

/// What is behind the clouds.
fn sky(gpu: &Gpu, renderer: &mut Renderer, frame: &Frame) -> Result<Picture> {
    let sky = renderer.picture("sky", frame.size(), wgpu::TextureFormat::Rgba16Float);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.render_sky(&mut encoder, frame, &sky.create_view(&Default::default()));
    gpu.queue.submit([encoder.finish()]);
    Picture::read(gpu, &sky)
}
