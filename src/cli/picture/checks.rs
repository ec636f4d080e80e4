//! Which options go together, and what follows from them.

use super::{Format, PictureOptions, word};
use crate::{
    Error, Result,
    render::{Blur, Film},
    scene::Scene,
};

/// Pictures that a blurred one is the mean of, where nobody says how many.
const SAMPLES: u32 = 16;

impl PictureOptions {
    /// Whether such a picture can be drawn into a file of this format.
    ///
    /// # Errors
    /// Where words do not go together.
    pub fn check(&self, format: Format) -> Result<()> {
        if self.layers.is_some() && format != Format::Exr {
            return Err(Error::Argument("--layers needs an output that ends in .exr".to_owned()));
        }
        match format {
            Format::Exr => self.tone.refuse_for("EXR")?,
            Format::Png => self.color.refuse_for("PNG")?,
        }
        self.check_transport()?;
        self.check_blur()?;
        self.check_rays()
    }

    /// No word may be without effect where light is found in this way.
    fn check_transport(&self) -> Result<()> {
        let refuse = |problem: String| Err(Error::Argument(problem));
        let of_paths = [
            self.spp.map(|spp| format!("--spp {spp}")),
            self.noise.map(|noise| format!("--noise {noise}")),
            self.seconds.map(|seconds| format!("--seconds {seconds}")),
        ];
        let of_others = [
            self.layers.is_some().then(|| "--layers".to_owned()),
            self.quality.map(|quality| format!("--quality {}", word(quality))),
            self.supersample.map(|rays| format!("--supersample {rays}")),
            self.exact.then(|| "--exact".to_owned()),
        ];
        let first = |words: &[Option<String>]| words.iter().flatten().next().cloned();
        match (first(&of_paths), first(&of_others).or_else(|| first(&self.blur_words()))) {
            (Some(given), _) if !self.traces_paths() => {
                refuse(format!("{given} is for --transport path: add that or leave it out"))
            }
            (_, Some(given)) if self.traces_paths() => refuse(format!(
                "{given} and --transport path don't go together: leave one out; how well paths are traced is \
                 told by --spp, --noise or --seconds"
            )),
            _ => Ok(()),
        }
    }

    /// The words about blur that were given.
    fn blur_words(&self) -> [Option<String>; 2] {
        [
            self.shutter.map(|share| format!("--shutter {share}")),
            self.samples.map(|samples| format!("--samples {samples}")),
        ]
    }

    /// Layers are of one moment.
    fn check_blur(&self) -> Result<()> {
        match self.blur_words().into_iter().flatten().next() {
            Some(word) if self.layers.is_some() => Err(Error::Argument(format!(
                "{word} and --layers don't go together, for depths and names have no mean: leave one out; with \
                 --layers=light,motion a compositor blurs"
            ))),
            _ => Ok(()),
        }
    }

    /// How a picture of `scene`, at `fps` frames a second, is blurred; not at all where it is of a pinhole and a moment.
    ///
    /// # Errors
    /// Where samples are asked for and there is nothing to blur.
    pub(super) fn blur(&self, scene: &Scene, fps: f64) -> Result<Option<Blur>> {
        let has_aperture = scene.camera.as_ref().is_some_and(|camera| camera.aperture.is_some());
        let samples = self.samples.unwrap_or(SAMPLES);
        match (self.shutter, has_aperture && !self.traces_paths() && self.layers.is_none()) {
            (None, false) if self.samples.is_some_and(|samples| samples > 1) => {
                Err(Error::Argument(format!(
                    "--samples {samples} average nothing: add --shutter 0.5 for motion blur, or give the camera an `aperture`"
                )))
            }
            (None, false) => Ok(None),
            _ if samples == 1 => Ok(None),
            (share, _) => Ok(Some(Blur { samples, open: share.unwrap_or(0.0) / fps })),
        }
    }

    /// The moments that a picture of `scene` shows beside its own, s.
    ///
    /// # Errors
    /// As [`PictureOptions::blur`].
    pub fn moments(&self, scene: &Scene, fps: f64) -> Result<Vec<f64>> {
        let blur = self.blur(scene, fps)?.filter(|blur| blur.open > 0.0);
        Ok(blur.map(|blur| blur.moments(scene).collect()).unwrap_or_default())
    }

    /// As many rays as were asked for must go into one texture.
    fn check_rays(&self) -> Result<()> {
        let size = [self.width, self.height];
        match self.supersample {
            Some(rays) if rays > Film::most_rays(size) => Err(Error::Argument(format!(
                "--supersample {rays} of {}x{} pixels makes {} rays across, and {} is the most: give \
                 --supersample {}, or a picture of at most {} pixels across",
                self.width,
                self.height,
                rays * self.width.max(self.height),
                Film::WIDEST,
                Film::most_rays(size),
                Film::WIDEST / rays
            ))),
            _ => Ok(()),
        }
    }
}
