//! How fast frames are that follow one another, as in a game: standing still and flying.

use std::{fmt, time::Instant};

use glam::{DQuat, DVec3};

use super::cost::{medians, middle};
use crate::{
    Result,
    export::Picture,
    gpu::{AdapterSummary, Gpu, Made, PassTime, Timing},
    render::{Counts, Frame, Quality, Renderer, Target},
    scene::{Camera, Scene},
};

/// What Kol (2013) draws on his graphics card: thousands of pixels a second for each GFLOPS that it can do.
pub const KOL: f64 = 94.0;

/// How the camera goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// Nothing changes from frame to frame.
    Standing,
    /// Forward by 100 m/s, turning by 6 degrees a second, in sixtieths of a second.
    Flying,
}

impl Motion {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Standing, Self::Flying];

    /// The camera some sixtieths of a second later.
    fn camera(self, camera: &Camera, frames: u32) -> Camera {
        let seconds = match self {
            Self::Standing => 0.0,
            Self::Flying => f64::from(frames) / 60.0,
        };
        let ahead = camera.target - camera.position;
        let moved = 100.0 * seconds * ahead.normalize_or_zero();
        let turned = DQuat::from_axis_angle(DVec3::Y, (6.0 * seconds).to_radians()) * ahead;
        let position = camera.position + moved;
        Camera { position, target: position + turned, ..camera.clone() }
    }
}

impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Standing => "standing",
            Self::Flying => "flying",
        })
    }
}

/// Exact work of a frame, by pixel that clouds cover by more than half.
#[derive(Debug, Clone, Copy, Default, serde::Serialize)]
pub struct Usage {
    /// Rays launched.
    pub rays: f64,
    /// Rays that hit.
    pub hits: f64,
    /// Evaluations of the density.
    pub density: f64,
    /// Reads of the noise volume.
    pub noise_reads: f64,
    /// Reads of maps, volumes and tables of light.
    pub map_reads: f64,
    /// Ellipsoids asked.
    pub ellipsoids: f64,
    /// Reads of volumes of depths and of voxels.
    pub volume_reads: f64,
}

impl Usage {
    fn new(counts: &Counts, covered: usize) -> Self {
        let each = |count: u64| count as f64 / covered.max(1) as f64;
        Self {
            rays: each(counts.rays),
            hits: each(counts.rays_hit),
            density: each(counts.density_evaluations),
            noise_reads: each(counts.noise_reads),
            map_reads: each(counts.map_reads),
            ellipsoids: each(counts.ellipsoids),
            volume_reads: each(counts.volume_reads),
        }
    }
}

/// How fast one scene is, one way. Times are medians over frames with everything compiled and at hand.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Speed {
    /// Name of the scene.
    pub scene: String,
    /// Clouds in it.
    pub clouds: usize,
    /// Name of the quality.
    pub quality: &'static str,
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
    /// How the camera goes.
    pub motion: Motion,
    /// Until the first picture is there, with its light and what the driver compiles, s; the same for all motions.
    pub first_s: f64,
    /// Time of each pass of that picture by the adapter's clock, milliseconds; empty where it has none.
    pub first_passes: Vec<PassTime>,
    /// Time of the CPU to say what is to be drawn, milliseconds.
    pub recorded_ms: f64,
    /// Time of the CPU to hand that over to the driver, milliseconds.
    pub submitted_ms: f64,
    /// Wall time of a frame until it is drawn, milliseconds.
    pub frame_ms: f64,
    /// Time of each pass by the adapter's clock, milliseconds; empty where it has none.
    pub passes: Vec<PassTime>,
    /// What the last frame made on the device.
    pub made: Made,
    /// Pixels that clouds cover by more than half.
    pub covered: usize,
    /// Work of a covered pixel.
    pub usage: Usage,
    /// Memory of light and volumes, bytes.
    pub bytes: u64,
    /// Pixels of pictures a second.
    pub pixels_per_s: f64,
}

/// What was found of all scenes.
#[derive(Debug, Clone, serde::Serialize)]
pub struct SpeedReport {
    /// Version of the program.
    pub version: &'static str,
    /// The commit it was built from, as far as known.
    pub commit: Option<String>,
    /// Date and time, RFC 3339.
    pub date: String,
    /// The graphics adapter.
    pub adapter: AdapterSummary,
    /// What the adapter can do, GFLOPS, as far as it was told.
    pub gflops: Option<f64>,
    /// How many frames each median is of.
    pub frames: u32,
    /// Scene by scene.
    pub speeds: Vec<Speed>,
}

impl SpeedReport {
    /// Thousands of pixels a second for each GFLOPS, as [`KOL`] is told.
    pub fn efficiency(&self, speed: &Speed) -> Option<f64> {
        self.gflops.map(|gflops| 1e-3 * speed.pixels_per_s / gflops)
    }

    /// A table for terminals.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:<15}{:>7} {:<8}{:>10} {:<9}{:>8}{:>9}{:>9}{:>10}{:>8}{:>9}{:>9}{:>8}{:>7}{:>9}",
            "scene",
            "clouds",
            "quality",
            "size",
            "camera",
            "first s",
            "record",
            "submit",
            "frame ms",
            "made",
            "density",
            "noise",
            "maps",
            "MiB",
            "Mpix/s"
        );
        text += if self.gflops.is_some() { " kpix/s/GFLOPS\n" } else { "\n" };
        for speed in &self.speeds {
            text += &self.line(speed);
        }
        text + &self.legend()
    }

    fn line(&self, s: &Speed) -> String {
        let size = format!("{}x{}", s.size[0], s.size[1]);
        let Made { buffers, textures, groups, pipelines, .. } = s.made;
        let line = format!(
            "{:<15}{:>7} {:<8}{size:>10} {:<9}{:>8.2}{:>9.3}{:>9.3}{:>10.1}{:>8}{:>9.1}{:>9.1}{:>8.1}{:>7.1}{:>9.3}",
            s.scene,
            s.clouds,
            s.quality,
            s.motion.to_string(),
            s.first_s,
            s.recorded_ms,
            s.submitted_ms,
            s.frame_ms,
            buffers + textures + groups + pipelines,
            s.usage.density,
            s.usage.noise_reads,
            s.usage.map_reads,
            s.bytes as f64 / f64::from(1 << 20),
            1e-6 * s.pixels_per_s,
        );
        let last = self.efficiency(s).map_or(String::new(), |found| format!("{found:>14.2}"));
        let stands = s.motion == Motion::Standing;
        let first = if stands { by_pass("first picture, ", &s.first_passes) } else { String::new() };
        format!("{line}{last}\n{first}{}", by_pass("", &s.passes))
    }

    fn legend(&self) -> String {
        let kol = match self.gflops {
            Some(gflops) => format!(
                "; Kol (2013) has {KOL} kpix/s for each GFLOPS of his card, this adapter was said to have {gflops}"
            ),
            None => String::new(),
        };
        format!(
            "{} ({}, {}), medians of {} frames. record, submit: ms on the CPU; made: buffers, textures, bind groups \
             and pipelines of a frame; density, noise, maps: evaluations and reads of a pixel that clouds cover; \
             docs/speed.md has the definitions{kol}.\n",
            self.adapter.name, self.adapter.backend, self.adapter.driver, self.frames
        )
    }
}

/// A line of times; none without any.
fn by_pass(of: &str, passes: &[PassTime]) -> String {
    let passes: Vec<_> = passes.iter().map(|pass| format!("{} {:.2}", pass.pass, pass.ms)).collect();
    if passes.is_empty() { String::new() } else { format!("    {of}ms by pass: {}\n", passes.join(", ")) }
}

/// Draws frames one after another.
pub struct Track<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Size of the pictures, pixels.
    pub size: [u32; 2],
    /// How many frames a median is of.
    pub frames: u32,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

impl Track<'_> {
    /// How fast `scene`, named `name`, is in all motions; `told` is called after each.
    ///
    /// # Errors
    /// Where the scene is not valid or the device fails.
    pub fn speeds(
        &self,
        (name, scene): (&str, &Scene),
        quality: (&'static str, Quality),
        told: &mut dyn FnMut(),
    ) -> Result<Vec<Speed>> {
        let gpu = self.gpu;
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, FORMAT);
        renderer.settings.quality = quality.1;
        let frame = Frame::new(scene, self.size)?;
        let picture = renderer.picture("frames", self.size, FORMAT);
        let view = picture.create_view(&Default::default());
        let target = Target { color: &view, depth: None, sky: true };
        renderer.timing = Some(Timing::new(gpu));
        let started = Instant::now();
        renderer.render_in_pieces(gpu, &frame, &target, &mut |_| ())?;
        let first_s = started.elapsed().as_secs_f64();
        let timing = renderer.timing.take();
        let first_passes = timing.map_or_else(|| Ok(Vec::new()), |timing| timing.collect(gpu))?;
        let (counts, covered) = self.work(&mut renderer, &frame)?;
        let mut speeds = Vec::new();
        for motion in Motion::ALL {
            let Course { recorded, submitted, walls, passes, made } =
                self.course(&mut renderer, &frame, &scene.camera(), motion, &target)?;
            let frame_ms = middle(walls);
            speeds.push(Speed {
                scene: name.to_owned(),
                clouds: frame.clouds.len(),
                quality: quality.0,
                size: self.size,
                motion,
                first_s,
                first_passes: first_passes.clone(),
                recorded_ms: middle(recorded),
                submitted_ms: middle(submitted),
                frame_ms,
                passes: medians(&passes),
                made,
                covered,
                usage: Usage::new(&counts, covered),
                bytes: renderer.light_bytes() + renderer.volume_bytes() + renderer.brick_bytes(),
                pixels_per_s: f64::from(self.size[0] * self.size[1]) / (1e-3 * frame_ms.max(1e-6)),
            });
            told();
        }
        Ok(speeds)
    }

    /// Counts of a picture without a sky, and pixels that clouds cover by more than half.
    fn work(&self, renderer: &mut Renderer, frame: &Frame) -> Result<(Counts, usize)> {
        let picture = renderer.picture("counted", self.size, FORMAT);
        let view = picture.create_view(&Default::default());
        renderer.settings.counting = true;
        let target = Target { color: &view, depth: None, sky: false };
        renderer.render_in_pieces(self.gpu, frame, &target, &mut |_| ())?;
        renderer.settings.counting = false;
        let drawn = Picture::read(self.gpu, &picture)?;
        let covered = drawn.pixels.iter().filter(|pixel| pixel[3] > 0.5).count();
        Ok((renderer.counts(self.gpu)?, covered))
    }

    /// Frames one after another; one before them compiles what is missing.
    fn course(
        &self,
        renderer: &mut Renderer,
        frame: &Frame,
        camera: &Camera,
        motion: Motion,
        target: &Target<'_>,
    ) -> Result<Course> {
        renderer.timing = Some(Timing::new(self.gpu));
        let mut course = Course::default();
        for number in 0..=self.frames.max(1) {
            let frame = frame.seen_by(&motion.camera(camera, number), self.size)?;
            let (made, started) = (Made::so_far(), Instant::now());
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            renderer.render(&mut encoder, &frame, target);
            let recorded = started.elapsed();
            self.gpu.queue.submit([encoder.finish()]);
            let submitted = started.elapsed();
            self.gpu.finish("drawing frames one after another")?;
            let wall = started.elapsed();
            course.made = Made::so_far() - made;
            let passes = renderer.timing.as_ref().map(|timing| timing.collect(self.gpu)).transpose()?;
            if number > 0 {
                course.recorded.push(1e3 * recorded.as_secs_f64());
                course.submitted.push(1e3 * (submitted - recorded).as_secs_f64());
                course.walls.push(1e3 * wall.as_secs_f64());
                course.passes.extend(passes);
            }
        }
        renderer.timing = None;
        Ok(course)
    }
}

/// Times of frames, milliseconds, and what the last one made.
#[derive(Default)]
struct Course {
    recorded: Vec<f64>,
    submitted: Vec<f64>,
    walls: Vec<f64>,
    passes: Vec<Vec<PassTime>>,
    made: Made,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;

    #[test]
    fn flying_goes_ahead_and_turns_and_standing_does_not() {
        let camera = Preset::Sphere.scene(1).camera();
        assert_eq!(Motion::Standing.camera(&camera, 60), Motion::Standing.camera(&camera, 0));
        let later = Motion::Flying.camera(&camera, 60);
        assert!((later.position.distance(camera.position) - 100.0).abs() < 1e-9);
        let ahead = |camera: &Camera| (camera.target - camera.position).with_y(0.0).normalize();
        assert!((ahead(&later).angle_between(ahead(&camera)).to_degrees() - 6.0).abs() < 1e-6);
    }
}
