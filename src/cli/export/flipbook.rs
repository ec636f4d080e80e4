//! `nephos export flipbook`: a cloud that changes, frame by frame.

use clap::Args;

use super::{
    super::{camera::CameraOption, terminal},
    shares,
    sprite::{Frames, Sprite},
};
use crate::{
    Result,
    export::{Motion, Picture, turning},
};

/// Write a flip-book of a cloud: an atlas of frames with alpha, that closes to a loop.
///
/// Frames go from the top left, row by row. The cloud is seen from the scene's camera along parallel lines.
/// Where it turns, NAME_motion has the way from each frame to the next: red to the right and green down,
/// 0.5 where nothing moves; 0 and 1 are the strongest motion, which is told as a share of a tile's edge: give it
/// to the engine as the scale of motion vectors. Noise alone moves nothing: fade from frame to frame.
#[derive(Debug, Args)]
pub struct Flipbook {
    #[command(flatten)]
    sprite: Sprite,
    #[command(flatten)]
    course: Frames,
    #[command(flatten)]
    camera: CameraOption,
    /// Frames of the atlas.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(2..=1024))]
    frames: u32,
}

impl Flipbook {
    pub(super) fn run(self) -> Result<()> {
        self.course.check(self.frames)?;
        let columns = self.course.columns(self.frames);
        let output = self.sprite.output.clone();
        let files =
            if self.course.turns == 0 { vec![output] } else { vec![output, self.sprite.named("motion")] };
        let mut stage = self.sprite.stage(&self.camera, [columns, self.frames.div_ceil(columns)], &files)?;
        let to_eye = stage.subject.to_camera();
        let course = self.course.course(&stage.scene);
        let turn = course.turn(self.frames);
        let (mut tiles, mut shifts) = (Vec::new(), Vec::new());
        shares("rendering", |progress| {
            for frame in 0..self.frames {
                let scene = stage.subject.at(course, frame, self.frames).seen_from(to_eye);
                let size = [self.sprite.tile; 2];
                if course.turns == 0 {
                    tiles.push(stage.studio.picture(&scene, size, false)?);
                } else {
                    let shot = stage.studio.shot(&scene, size)?;
                    let camera = scene.camera().world_from_camera();
                    shifts.push(turning(&shot, camera, stage.subject.extent(), turn));
                    tiles.push(shot.color);
                }
                progress(f64::from(frame + 1) / f64::from(self.frames));
            }
            Ok(())
        })?;
        let atlas = Picture::in_rows(&tiles, columns as usize);
        let mut told = stage.write_light(&self.sprite.output, &atlas)?;
        if course.turns != 0 {
            let motion = Motion::new(&shifts, self.sprite.tile as usize);
            let atlas = Picture::in_rows(&motion.frames, columns as usize);
            stage.write_shares(&self.sprite.named("motion"), &atlas)?;
            told += &format!(", strongest motion {:.5} of a tile", motion.strongest);
        }
        terminal::print(&format!(
            "{}: {} frames in {columns} columns, a tile is {:.1} m wide{told}\n",
            self.sprite.output.display(),
            self.frames,
            stage.subject.extent()
        ))
    }
}
