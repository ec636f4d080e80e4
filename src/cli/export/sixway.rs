//! `nephos export sixway`: light from six sides, to be mixed by an engine.

use clap::Args;

use super::{
    super::{camera::CameraOption, numbers::above_zero, terminal},
    shares,
    sprite::{Frames, Sprite},
};
use crate::{
    Result,
    export::{Picture, atlas, bled},
};

/// Write six-way light maps of a cloud: how it looks in light from right, left, top, bottom, back
/// and front, which engines mix by where their lights are.
///
/// NAME_positive has light from right, top and back in red, green and blue, and the opacity in alpha;
/// NAME_negative that from left, bottom and front, alpha 0 for no light of its own: the layout of
/// Unity's Six-way Smoke Lit. Sides are those of the picture; back is light from behind the cloud. Each is the mean
/// of four lights at 45 degrees to it. Values are
/// linear and not multiplied by the opacity. In .exr files 1 is as bright as a white sheet that the
/// light hits straight on; in .png files they are multiplied by a gain, which is told.
#[derive(Debug, Args)]
pub struct Sixway {
    #[command(flatten)]
    sprite: Sprite,
    #[command(flatten)]
    course: Frames,
    #[command(flatten)]
    camera: CameraOption,
    /// Frames of a flip-book; 1 is a single sprite.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    frames: u32,
    /// Multiplies the maps; left out, 1 for .exr files, and for .png such that they are just not cut.
    #[arg(long, value_name = "FACTOR", value_parser = above_zero)]
    gain: Option<f64>,
}

impl Sixway {
    pub(super) fn run(self) -> Result<()> {
        self.sprite.tone.refuse_for("a light map")?;
        self.sprite.color.refuse_for("a light map")?;
        self.course.check(self.frames)?;
        let columns = self.course.columns(self.frames);
        let files = ["positive", "negative"].map(|map| self.sprite.named(map));
        let mut stage = self.sprite.stage(&self.camera, [columns, self.frames.div_ceil(columns)], &files)?;
        let to_eye = stage.subject.to_camera();
        let course = self.course.course(&stage.scene);
        let (positive, negative) = shares("rendering", |progress| {
            let (mut positive, mut negative) = (Vec::new(), Vec::new());
            for frame in 0..self.frames {
                let subject = stage.subject.at(course, frame, self.frames);
                let [p, n] = subject.six_ways(&mut stage.studio, to_eye, self.sprite.tile)?;
                positive.push(p);
                negative.push(n);
                progress(f64::from(frame + 1) / f64::from(self.frames));
            }
            Ok((positive, negative))
        })?;
        let [mut positive, mut negative] =
            [positive, negative].map(|tiles| Picture::in_rows(&tiles, columns as usize));
        let fitting = if stage.kind == "exr" { 1.0 } else { 1.0 / atlas::brightest(&[&positive, &negative]) };
        let gain = self.gain.map_or(fitting, |gain| gain as f32);
        for map in [&mut positive, &mut negative] {
            map.pixels.iter_mut().for_each(|pixel| (0..3).for_each(|c| pixel[c] *= gain));
        }
        // Its alpha is no opacity, which the other map has.
        negative = bled(&negative);
        negative.pixels.iter_mut().for_each(|pixel| pixel[3] = 0.0);
        stage.write_shares(&files[0], &positive)?;
        stage.write_shares(&files[1], &negative)?;
        terminal::print(&format!(
            "{}: {} frames in {columns} columns, a tile is {:.1} m wide, gain {gain}\n",
            files[0].display(),
            self.frames,
            stage.subject.extent()
        ))
    }
}
