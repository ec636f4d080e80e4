//! What it costs, and what error it makes, that light is kept while things move a little
//! ([`Settings::light_slack_deg`](crate::render::Settings::light_slack_deg)).

use std::{fmt, time::Instant};

use glam::{DQuat, DVec3};

use super::cost::middle;
use crate::{
    Result,
    export::Picture,
    gpu::{AdapterSummary, Gpu},
    render::{Film, Frame, Quality, Renderer},
    scene::{Scene, Sky, SunPosition},
};

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// The sun turns by a quarter of a degree each frame around the vertical.
    Sun,
    /// Noise wanders through the clouds, half a metre each frame.
    Noise,
}

impl Change {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Sun, Self::Noise];

    /// The scene some frames later.
    fn after(self, scene: &Scene, frames: u32) -> Scene {
        let frames = f64::from(frames);
        let mut scene = scene.clone();
        match self {
            Self::Sun => {
                let turn = DQuat::from_axis_angle(DVec3::Y, (0.25 * frames).to_radians());
                scene.sun.position = SunPosition::Direction(turn * scene.sun.to_sun());
            }
            Self::Noise => {
                let way = 0.5 * frames * DVec3::X;
                scene.noise.offset += way;
                let own = scene.clouds.iter_mut().filter_map(|cloud| cloud.noise.as_mut());
                own.for_each(|noise| noise.offset += way);
            }
        }
        scene
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Sun => "sun",
            Self::Noise => "noise",
        })
    }
}

/// Frames of one scene in which something moves, with light kept so long.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Moving {
    /// Name of the scene.
    pub scene: String,
    /// Name of the quality.
    pub quality: &'static str,
    /// What moves.
    pub change: Change,
    /// By how much, degrees.
    pub slack_deg: f64,
    /// Share of the frames, after the first, in which light was made.
    pub made: f64,
    /// Wall time of a frame, mean and median, milliseconds.
    pub mean_ms: f64,
    /// Median of the same.
    pub middle_ms: f64,
    /// Root of the mean square of the difference to pictures in exact light, over that of their light, all frames.
    pub rmse: f64,
    /// Largest difference of a pixel, in steps of 255 to the brightest.
    pub most: f64,
    /// Largest change of that difference from one frame to the next, likewise: what pops.
    pub jump: f64,
}

/// What was found of all scenes.
#[derive(Debug, Clone, serde::Serialize)]
pub struct MovingReport {
    /// Version of the program.
    pub version: &'static str,
    /// The commit it was built from, as far as known.
    pub commit: Option<String>,
    /// Date and time, RFC 3339.
    pub date: String,
    /// The graphics adapter.
    pub adapter: AdapterSummary,
    /// Frames of each row.
    pub frames: u32,
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
    /// Row by row.
    pub rows: Vec<Moving>,
}

impl MovingReport {
    /// A table for terminals.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:<15}{:<9}{:<7}{:>7}{:>7}{:>10}{:>11}{:>9}{:>7}{:>7}\n",
            "scene", "quality", "moves", "slack", "made", "mean ms", "median ms", "rmse", "most", "jump"
        );
        for row in &self.rows {
            text += &format!(
                "{:<15}{:<9}{:<7}{:>7.2}{:>7.2}{:>10.1}{:>11.1}{:>9.4}{:>7.2}{:>7.2}\n",
                row.scene,
                row.quality,
                row.change.to_string(),
                row.slack_deg,
                row.made,
                row.mean_ms,
                row.middle_ms,
                row.rmse,
                row.most,
                row.jump
            );
        }
        text + &format!(
            "{} ({}, {}), {} frames of {}x{} a row. slack: degrees; made: share of frames in which light was made; \
             most, jump: largest difference to exact light and change of it in a frame, of 255 to the brightest.\n",
            self.adapter.name,
            self.adapter.backend,
            self.adapter.driver,
            self.frames,
            self.size[0],
            self.size[1]
        )
    }
}

/// Draws scenes in which something moves.
pub struct Shift<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Size of the pictures, pixels.
    pub size: [u32; 2],
    /// Frames of a row.
    pub frames: u32,
}

/// Frames in a row.
struct Course {
    pictures: Vec<Picture>,
    walls: Vec<f64>,
    made: u32,
}

impl Shift<'_> {
    /// What `scene`, named `name`, is while `change` moves in it, with exact light and for each slack; `told` is called after each.
    ///
    /// # Errors
    /// Where the scene is not valid or the device fails.
    pub fn rows(
        &self,
        (name, scene): (&str, &Scene),
        quality: (&'static str, Quality),
        change: Change,
        slacks_deg: &[f64],
        told: &mut dyn FnMut(),
    ) -> Result<Vec<Moving>> {
        let mut scene = scene.clone();
        // Tables of an atmosphere are made anew whenever the sun turns: what light of clouds costs is to be told.
        scene.sky = Sky::Uniform { radiance: [0.06, 0.09, 0.15] };
        let exact = self.course(&scene, quality.1, change, 0.0)?;
        let mut rows = Vec::new();
        for &slack_deg in slacks_deg {
            let kept;
            let course = if slack_deg > 0.0 {
                kept = self.course(&scene, quality.1, change, slack_deg)?;
                &kept
            } else {
                &exact
            };
            let [rmse, most, jump] = differences(&course.pictures, &exact.pictures);
            rows.push(Moving {
                scene: name.to_owned(),
                quality: quality.0,
                change,
                slack_deg,
                made: f64::from(course.made) / f64::from(self.frames.max(1)),
                mean_ms: course.walls.iter().sum::<f64>() / course.walls.len().max(1) as f64,
                middle_ms: middle(course.walls.clone()),
                rmse,
                most,
                jump,
            });
            told();
        }
        Ok(rows)
    }

    fn course(&self, scene: &Scene, quality: Quality, change: Change, slack_deg: f64) -> Result<Course> {
        let gpu = self.gpu;
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
        renderer.settings.quality = quality;
        renderer.settings.light_slack_deg = slack_deg;
        let film = Film::new(self.size, 1);
        let mut course = Course { pictures: Vec::new(), walls: Vec::new(), made: 0 };
        for number in 0..=self.frames.max(1) {
            let frame = Frame::new(&change.after(scene, number), self.size)?;
            let (updates, started) = (renderer.light_updates(), Instant::now());
            let picture = film.take(gpu, &mut renderer, &frame, false, &mut |_| ())?;
            // The first compiles all, and has no light to keep.
            if number > 0 {
                course.walls.push(1e3 * started.elapsed().as_secs_f64());
                course.made += u32::from(renderer.light_updates() > updates);
                course.pictures.push(picture);
            }
        }
        Ok(course)
    }
}

/// Of pictures in kept light and in exact light: the relative RMSE, the largest difference, and the largest change of a
/// difference from one frame to the next, both in steps of 255 to the brightest.
fn differences(kept: &[Picture], exact: &[Picture]) -> [f64; 3] {
    let light =
        |picture: &Picture| picture.pixels.iter().map(|pixel| f64::from(pixel[1])).collect::<Vec<_>>();
    let brightest = exact.iter().flat_map(light).fold(1e-12, f64::max);
    let (mut square, mut all, mut most, mut jump) = (0.0, 1e-30, 0.0f64, 0.0f64);
    let mut last: Option<Vec<f64>> = None;
    for (kept, exact) in kept.iter().zip(exact) {
        let (kept, exact) = (light(kept), light(exact));
        let off: Vec<f64> = kept.iter().zip(&exact).map(|(a, b)| a - b).collect();
        square += off.iter().map(|off| off * off).sum::<f64>();
        all += exact.iter().map(|light| light * light).sum::<f64>();
        most = off.iter().fold(most, |most, off| most.max(off.abs()));
        let changes = last.iter().flat_map(|last| off.iter().zip(last)).map(|(a, b)| (a - b).abs());
        jump = changes.fold(jump, f64::max);
        last = Some(off);
    }
    let steps = 255.0 / brightest;
    [(square / all).sqrt(), steps * most, steps * jump]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_those_of_the_pictures() {
        let picture = |light: f32| Picture { width: 2, height: 1, pixels: vec![[0.0, light, 0.0, 1.0]; 2] };
        let exact = [1.0, 1.0, 1.0].map(picture);
        let kept = [1.0, 0.9, 1.0].map(picture);
        let [rmse, most, jump] = differences(&kept, &exact);
        assert!((rmse - (0.01f64 / 3.0).sqrt()).abs() < 1e-6, "{rmse}");
        assert!((most - 25.5).abs() < 1e-3 && (jump - 25.5).abs() < 1e-3, "{most} {jump}");
    }
}
