//! Motion from one picture of a turning cloud to the next, by which engines blend flip-books.
//!
//! It follows from where the cloud is in each pixel. What noise does to a cloud that it drifts
//! through is no motion: boundaries form and dissolve in place, and a fade is nearer to what is
//! between two frames than any shift (tried: Lucas and Kanade's optical flow, and the noise's own way).

use glam::{DQuat, DVec3};

use super::{Picture, Shot};

/// Motion as engines take it: red to the right and green down, 0.5 where nothing moves and 0 or 1
/// at `strongest`, the largest motion of all in shares of a tile's edge.
pub struct Motion {
    /// One picture a frame.
    pub frames: Vec<Picture>,
    /// What 0 and 1 stand for, shares of a tile's edge.
    pub strongest: f32,
}

impl Motion {
    /// Of shifts in shares of a tile's edge, frame by frame, of tiles of `size` pixels.
    pub fn new(shifts: &[Vec<[f32; 2]>], size: usize) -> Self {
        let largest = shifts.iter().flatten().flatten().fold(0f32, |most, shift| most.max(shift.abs()));
        let strongest = largest.max(1e-6);
        let share = |shift: f32| 0.5 + 0.5 * shift / strongest;
        let pixels =
            |shifts: &Vec<[f32; 2]>| shifts.iter().map(|&[x, y]| [share(x), share(y), 0.0, 1.0]).collect();
        let picture = |shifts| Picture { width: size, height: size, pixels: pixels(shifts) };
        Self { frames: shifts.iter().map(picture).collect(), strongest }
    }
}

/// How the cloud of a shot moves when it turns by `angle`, rad, about the vertical through its middle:
/// right and down, in shares of a tile's edge. `extent` is the edge, m, as far from the middle as the
/// eye; where there is no cloud nothing moves.
pub fn turning(shot: &Shot, world_from_camera: DQuat, extent: f64, angle: f64) -> Vec<[f32; 2]> {
    let turn = world_from_camera.inverse() * DQuat::from_rotation_y(angle) * world_from_camera;
    let size = shot.distance.width;
    let place = |i: usize| (i as f64 + 0.5) / size as f64 - 0.5;
    let shift = |(i, &[distance, _, _, alpha]): (usize, &[f32; 4])| {
        if alpha < 1e-3 {
            return [0.0; 2];
        }
        let toward_eye = extent - f64::from(distance / alpha);
        let here = DVec3::new(extent * place(i % size), -extent * place(i / size), toward_eye);
        let moved = (turn * here - here) / extent;
        [moved.x as f32, -moved.y as f32]
    };
    shot.distance.pixels.iter().enumerate().map(shift).collect()
}
