//! Cameras that come as matrices, as game engines have them.

use glam::{DAffine3, DMat2, DMat3, DMat4, DVec2, DVec3, Mat4};

use super::CameraUniform;
use crate::{Error, Result};

/// How far from a rotation the axes of a camera may be.
const ROUNDING: f64 = 1e-3;

/// The lines of sight of a projection, in its own view: x to the right, y up, looking along -z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lens {
    /// Where they begin in the middle of the picture, m.
    origin: DVec3,
    /// What a unit of normalised device coordinates adds: per unit of distance along the axis, or m for
    /// an orthographic camera.
    right: DVec3,
    up: DVec3,
    /// The one in the middle of the picture, 1 long along the axis: not the axis where the lens is shifted.
    forward: DVec3,
    is_orthographic: bool,
}

impl Lens {
    /// The lens of a matrix. Where its planes of depth are makes no difference: points on the line of sight
    /// through (X, Y) have x_clip = X w and y_clip = Y w, and the third row has no part in that.
    ///
    /// # Errors
    /// [`Error::Argument`] where the matrix is no projection.
    pub fn new(clip_from_view: &DMat4) -> Result<Self> {
        let refuse = |problem: &str| Err(Error::Argument(format!("the camera's clip_from_view {problem}")));
        if !clip_from_view.is_finite() {
            return refuse("holds numbers that are not finite: all 16 must be");
        }
        let scale = clip_from_view.row(3).abs().max_element();
        let [x, y, w] = [0, 1, 3].map(|row| clip_from_view.row(row) / scale);
        let is_orthographic = match w.to_array() {
            [0.0, 0.0, -1.0, 0.0] => false,
            [0.0, 0.0, 0.0, 1.0] => true,
            _ => {
                return refuse(
                    "is no projection: its last row must be 0, 0, -1, 0 for a perspective along -Z, or 0, 0, \
                     0, 1 for an orthographic camera, or a multiple of these above 0",
                );
            }
        };
        let ndc_from_view = DMat2::from_cols(DVec2::new(x.x, y.x), DVec2::new(x.y, y.y));
        let view_from_ndc = ndc_from_view.inverse();
        if ndc_from_view.determinant() == 0.0 || !view_from_ndc.is_finite() {
            return refuse("has a picture without width or height: its first two rows must not be alike");
        }
        // A (x, y) + c z + t = (X, Y) w, for z = -distance and w = distance or 1.
        let [c, t] = [DVec2::new(x.z, y.z), DVec2::new(x.w, y.w)];
        Ok(Self {
            origin: (view_from_ndc * -t).extend(0.0),
            right: view_from_ndc.x_axis.extend(0.0),
            up: view_from_ndc.y_axis.extend(0.0),
            forward: (view_from_ndc * c).extend(-1.0),
            is_orthographic,
        })
    }
}

/// The camera of two matrices and where it is in the world, m, for a picture of `width` by `height` pixels
/// over ground at `ground` metres.
///
/// # Errors
/// [`Error::Argument`] where one of the matrices is not what it should be.
pub(super) fn camera(
    clip_from_view: Mat4,
    world_from_view: DAffine3,
    ground: f64,
    [width, height]: [u32; 2],
) -> Result<(CameraUniform, DVec3)> {
    let lens = Lens::new(&clip_from_view.as_dmat4())?;
    let axes = world_from_view.matrix3;
    let is_rigid =
        (axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, ROUNDING) && axes.determinant() > 0.0;
    if !is_rigid || !world_from_view.translation.is_finite() {
        return Err(Error::Argument(
            "the camera's world_from_view must turn and move only: its three axes at right angles, each 1 m \
             long, and its position finite"
                .to_owned(),
        ));
    }
    let [right, up] = [lens.right, lens.up].map(|half| axes * half);
    let pixel = (2.0 * right.length() / f64::from(width)).min(2.0 * up.length() / f64::from(height));
    let (forward, projection) = if lens.is_orthographic {
        (lens.forward.normalize(), CameraUniform::ORTHOGRAPHIC)
    } else {
        (lens.forward, CameraUniform::PERSPECTIVE)
    };
    let position = world_from_view.transform_point3(lens.origin);
    let camera = CameraUniform {
        right: right.as_vec3(),
        projection,
        up: up.as_vec3(),
        altitude: (position.y - ground) as f32,
        forward: (axes * forward).as_vec3(),
        pixel: pixel as f32,
        axis: (axes * DVec3::NEG_Z).as_vec3(),
        jitter: 0.0,
        size: [width as f32, height as f32],
        padding: [0.0; 2],
    };
    Ok((camera, position))
}
