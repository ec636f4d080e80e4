//! `nephos export impostor`: a cloud from all sides.

use clap::{Args, ValueEnum};

use super::{
    super::{camera::CameraOption, terminal},
    shares,
    sprite::{Sprite, size},
};
use crate::{
    Result,
    export::{Around, Picture, Shot, atlas, impostor, write_grey, write_named},
};

/// Write an impostor of a cloud: an atlas of pictures from many sides, with depth and normals.
///
/// Sides are the points of an unfolded octahedron, row by row: the middle of the atlas is the view from
/// straight above (or below). The picture's up is the world's, north where it looks straight up or down.
/// NAME_depth is 0 at the nearest and 1 at the farthest side of the ball around the cloud; NAME_normal
/// has the axes of the scene, 0.5 being 0. Light is that of the scene's sun and sky.
#[derive(Debug, Args)]
pub struct Impostor {
    #[command(flatten)]
    sprite: Sprite,
    /// Pictures along an edge of the atlas.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(2..=64))]
    views: u32,
    /// From where the cloud will be seen.
    #[arg(long, value_enum, default_value_t = From::Sphere)]
    from: From,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum From {
    /// All sides.
    Sphere,
    /// Level and from above.
    Above,
    /// Level and from below.
    Below,
}

impl Impostor {
    pub(super) fn run(self) -> Result<()> {
        let files = [self.sprite.output.clone(), self.sprite.named("normal"), self.sprite.named("depth")];
        let mut stage = self.sprite.stage(&CameraOption::default(), [self.views; 2], &files)?;
        let around = match self.from {
            From::Sphere => Around::Sphere,
            From::Above => Around::Above,
            From::Below => Around::Below,
        };
        let shots = shares("rendering", |progress| {
            let subject = stage.subject.clone();
            impostor(&mut stage.studio, &subject, around, self.views, self.sprite.tile, progress)
        })?;
        let gather = |tile: fn(&Shot) -> Picture| {
            Picture::in_rows(&shots.iter().map(tile).collect::<Vec<_>>(), self.views as usize)
        };
        let color = gather(|shot| shot.color.clone());
        let normal = gather(|shot| atlas::normals(&shot.normal));
        let extent = stage.subject.extent() as f32;
        // The eye is as far from the middle as the square is wide.
        let depth = |&[distance, .., alpha]: &[f32; 4]| {
            if alpha > 1e-3 { (distance / (alpha * extent) - 0.5).clamp(0.0, 1.0) } else { 1.0 }
        };
        let depths: Vec<f32> = gather(|shot| shot.distance.clone()).pixels.iter().map(depth).collect();
        let told = stage.write_light(&self.sprite.output, &color)?;
        stage.write_shares(&self.sprite.named("normal"), &normal)?;
        let path = self.sprite.named("depth");
        match stage.kind {
            "exr" => write_named(&path, [color.width, color.height], &[("Y".to_owned(), depths)])?,
            _ => write_grey(&path, size(&color), &depths)?,
        }
        terminal::print(&format!(
            "{}: {} by {} views, a tile is {extent:.1} m wide and depth {extent:.1} m deep{told}\n",
            self.sprite.output.display(),
            self.views,
            self.views
        ))
    }
}
