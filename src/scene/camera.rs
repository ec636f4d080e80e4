//! The camera, and the one that is taken where a scene has none.

use glam::{DMat3, DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Bounds;
use super::validate::{At, COORDINATE, Limits};
use crate::Result;

const ROLL: Limits = Limits::new(-360.0, 360.0, "degrees");
const FIELD_OF_VIEW: Limits = Limits::new(0.1, 170.0, "degrees");
const FOCAL_LENGTH: Limits = Limits::new(0.1, 1e5, "millimetres");
const SENSOR: Limits = Limits::new(0.1, 1e3, "millimetres");
const FOCUS: Limits = Limits::new(0.01, 1e6, "metres");
const F_STOP: Limits = Limits::new(0.1, 1000.0, "");
const OPENING: Limits = Limits::new(0.0, 1000.0, "metres");
const SHIFT: Limits = Limits::new(-10.0, 10.0, "");
const HEIGHT: Limits = Limits::new(0.01, 1e7, "metres");

/// Height of the eye above the ground where a scene has no camera, metres.
const EYE_HEIGHT: f64 = 1.7;
/// Greatest vertical field of view where a scene has no camera, degrees.
const FRAME_FIELD_OF_VIEW: f64 = 40.0;
/// Tangent of half of that.
const FRAME_HALF_HEIGHT: f64 = 0.363_970_234_266_202_36;
/// Tangent of the greatest elevation of a cloud where a scene has no camera: 20 degrees.
const FRAME_SLOPE: f64 = FRAME_HALF_HEIGHT;
/// Aspect, width over height, of the picture into which all clouds must fit.
const FRAME_ASPECT: f64 = 16.0 / 9.0;
/// Share of the picture that the clouds may fill, so that they keep off its rim.
const FRAME_FILL: f64 = 0.8;

/// Where the picture is taken from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where the camera is [x, y, z], metres: x east, y up, z south.
    #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    pub position: DVec3,
    /// The point in the middle of the picture [x, y, z], metres.
    #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
    pub target: DVec3,
    /// Turns the camera clockwise about its line of sight, as seen from behind it,
    /// degrees, -360 to 360. 0 keeps the horizon level.
    #[serde(default)]
    #[schemars(range(min = ROLL.min, max = ROLL.max), extend("unit" = ROLL.unit))]
    pub roll_deg: f64,
    /// How directions become places in the picture.
    #[serde(default)]
    pub projection: Projection,
    /// Shifts the lens to the right, as a share of the picture's width, -10 to 10: what is farther right is in the
    /// picture, and the camera does not turn. Not for equirectangular cameras.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = SHIFT.min, max = SHIFT.max))]
    pub shift_x: f64,
    /// Shifts the lens upwards, as a share of the picture's width, -10 to 10: verticals of what is high up stay
    /// parallel where the camera is level. Not for equirectangular cameras.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = SHIFT.min, max = SHIFT.max))]
    pub shift_y: f64,
    /// How wide the lens is open: what lies before and behind its focus is blurred, in pictures of several samples. A
    /// pinhole where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aperture: Option<Aperture>,
}

/// A lens with a round opening, said by its radius or by its f-stop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Aperture {
    /// Radius of the opening, metres, 0 to 1000: clouds kilometres away are blurred by openings of metres, as if they
    /// were small.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = OPENING.min, max = OPENING.max), extend("unit" = OPENING.unit))]
    pub radius: Option<f64>,
    /// In place of a radius, the focal length over the diameter of the opening, 0.1 to 1000: for cameras said by their
    /// lens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = F_STOP.min, max = F_STOP.max))]
    pub f_stop: Option<f64>,
    /// Distance along the line of sight at which the picture is sharp, metres, 0.01 to 1000000.
    #[schemars(range(min = FOCUS.min, max = FOCUS.max), extend("unit" = FOCUS.unit))]
    pub focus: f64,
}

impl Aperture {
    fn check(&self, projection: Projection, at: At) -> Result<()> {
        at.field("focus").number(self.focus, FOCUS)?;
        match (self.radius, self.f_stop, projection) {
            (_, _, Projection::Orthographic { .. } | Projection::Equirectangular) => Err(at.problem(
                "blurs what is out of focus, which only perspective cameras and lenses do: leave it out, or choose one of \
                 these projections"
                    .to_owned(),
            )),
            (Some(radius), None, _) => at.field("radius").number(radius, OPENING),
            (None, Some(f), Projection::Lens { .. }) => at.field("f_stop").number(f, F_STOP),
            (None, Some(f), Projection::Perspective { .. }) => Err(at.field("f_stop").problem(format!(
                "{f} is a share of a focal length, which a camera said by its field of view does not have: give it a `lens`, \
                 or a `radius` in metres"
            ))),
            (None, None, _) | (Some(_), Some(_), _) => {
                Err(at.problem("is said by a `radius` or by an `f_stop`: give one of them".to_owned()))
            }
        }
    }

    /// Radius of the opening, m.
    fn radius(&self, projection: Projection) -> f64 {
        match (self.radius, self.f_stop, projection) {
            (Some(radius), ..) => radius,
            (None, Some(f), Projection::Lens { focal_length_mm, .. }) => 0.5e-3 * focal_length_mm / f,
            _ => 0.0,
        }
    }
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// How directions become places in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Projection {
    /// A pinhole, said by its field of view.
    Perspective {
        /// Angle from the lower to the upper edge of the picture, degrees, 0.1 to 170.
        #[schemars(range(min = FIELD_OF_VIEW.min, max = FIELD_OF_VIEW.max), extend("unit" = FIELD_OF_VIEW.unit))]
        vertical_fov_deg: f64,
    },
    /// A pinhole, said by its lens. The width of the sensor fills the width of the
    /// picture; the height follows from the picture's aspect.
    Lens {
        /// Focal length, millimetres, 0.1 to 100000.
        #[schemars(range(min = FOCAL_LENGTH.min, max = FOCAL_LENGTH.max), extend("unit" = FOCAL_LENGTH.unit))]
        focal_length_mm: f64,
        /// Width of the sensor or film, millimetres, 0.1 to 1000; 36 where left out.
        #[serde(default = "full_frame_width")]
        #[schemars(range(min = SENSOR.min, max = SENSOR.max), extend("unit" = SENSOR.unit))]
        sensor_width_mm: f64,
    },
    /// Parallel lines of sight, without perspective.
    Orthographic {
        /// What the height of the picture spans, metres, 0.01 to 10000000.
        #[schemars(range(min = HEIGHT.min, max = HEIGHT.max), extend("unit" = HEIGHT.unit))]
        height: f64,
    },
    /// The whole sphere around the camera: longitude across, latitude upwards, the
    /// target in the middle. For sky maps.
    Equirectangular,
}

fn full_frame_width() -> f64 {
    36.0
}

impl Default for Projection {
    fn default() -> Self {
        Self::Perspective { vertical_fov_deg: FRAME_FIELD_OF_VIEW }
    }
}

impl Projection {
    /// Angle from the lower to the upper edge of a picture of `aspect` (width over
    /// height), radians; `None` where the projection is no pinhole.
    pub fn vertical_fov(&self, aspect: f64) -> Option<f64> {
        match *self {
            Self::Perspective { vertical_fov_deg } => Some(vertical_fov_deg.to_radians()),
            Self::Lens { focal_length_mm, sensor_width_mm } => {
                Some(2.0 * (0.5 * sensor_width_mm / (aspect * focal_length_mm)).atan())
            }
            Self::Orthographic { .. } | Self::Equirectangular => None,
        }
    }

    fn check(&self, at: At) -> Result<()> {
        match *self {
            Self::Perspective { vertical_fov_deg } => {
                let at = at.field("perspective");
                at.field("vertical_fov_deg").number(vertical_fov_deg, FIELD_OF_VIEW)
            }
            Self::Lens { focal_length_mm, sensor_width_mm } => {
                let at = at.field("lens");
                at.field("focal_length_mm").number(focal_length_mm, FOCAL_LENGTH)?;
                at.field("sensor_width_mm").number(sensor_width_mm, SENSOR)
            }
            Self::Orthographic { height } => {
                let at = at.field("orthographic");
                at.field("height").number(height, HEIGHT)
            }
            Self::Equirectangular => Ok(()),
        }
    }
}

impl Default for Camera {
    /// At eye height over the origin, looking north and a little up.
    fn default() -> Self {
        Self::standing_at(DVec3::new(0.0, EYE_HEIGHT, 0.0), 0.25)
    }
}

impl Camera {
    /// A camera at `position` that looks north, raised by `slope` (tangent of the elevation).
    fn standing_at(position: DVec3, slope: f64) -> Self {
        Self {
            position,
            target: position + 1000.0 * DVec3::new(0.0, slope, -1.0),
            roll_deg: 0.0,
            projection: Projection::default(),
            shift_x: 0.0,
            shift_y: 0.0,
            aperture: None,
        }
    }

    /// The camera at a point of its lens, of a disc of radius 1, x to the right and y up, for pictures of `aspect` (width
    /// over height): what is at its focus is where it was in the picture. The camera itself where it is a pinhole.
    pub(crate) fn through(&self, [x, y]: [f64; 2], aspect: f64) -> Self {
        let half = self.projection.vertical_fov(aspect).map(|fov| aspect * (0.5 * fov).tan());
        let (Some(aperture), Some(half)) = (self.aperture, half) else { return self.clone() };
        let [x, y] = [x, y].map(|at| at * aperture.radius(self.projection));
        let offset = self.world_from_camera() * DVec3::new(x, y, 0.0);
        // Of the width that the picture has at the focus.
        let width = 2.0 * half * aperture.focus;
        Self {
            position: self.position + offset,
            target: self.target + offset,
            shift_x: self.shift_x - x / width,
            shift_y: self.shift_y - y / width,
            ..self.clone()
        }
    }

    /// How far the lens is shifted to the right and up, in halves of the picture's width and height, for a picture of
    /// `aspect` (width over height).
    pub(crate) fn shift(&self, aspect: f64) -> [f64; 2] {
        [2.0 * self.shift_x, 2.0 * self.shift_y * aspect]
    }

    /// Where the lines of sight begin, or those of the middle of the picture do where they are parallel, m: the position,
    /// but for orthographic cameras with a shifted lens.
    pub fn eye(&self, aspect: f64) -> DVec3 {
        let Projection::Orthographic { height } = self.projection else { return self.position };
        let [x, y] = self.shift(aspect);
        self.position
            + self.world_from_camera() * DVec3::new(0.5 * height * aspect * x, 0.5 * height * y, 0.0)
    }

    /// Unit vector of the line of sight, from the camera to its target.
    pub fn forward(&self) -> DVec3 {
        (self.target - self.position).normalize_or(DVec3::NEG_Z)
    }

    /// Rotation from the camera's space (x right, y up, -z forward) to the world's.
    ///
    /// Up in the picture is up in the world; where the camera looks straight up or
    /// down it is north (-z).
    pub fn world_from_camera(&self) -> DQuat {
        let forward = self.forward();
        let across = forward.cross(DVec3::Y);
        let level = if across.length_squared() > 1e-12 {
            across.normalize()
        } else {
            forward.cross(DVec3::NEG_Z).normalize()
        };
        let basis = DMat3::from_cols(level, level.cross(forward), -forward);
        DQuat::from_axis_angle(forward, self.roll_deg.to_radians()) * DQuat::from_mat3(&basis)
    }

    /// A camera on the ground (at `ground` metres) to the south of `bounds`, looking
    /// north, that fills a 16:9 picture with them up to a margin.
    ///
    /// It stands so far away that they fit into 40 degrees and rise no higher than 20
    /// degrees: seen from nearer, clouds show their dark bases. Small clouds high up
    /// are then drawn near by a longer lens.
    pub fn framing(bounds: Bounds, ground: f64) -> Self {
        let (min, max) = bounds;
        let eye = DVec3::new(0.5 * (min.x + max.x), ground + EYE_HEIGHT, max.z);
        let view = |distance: f64| {
            let position = eye + DVec3::Z * distance;
            Self::standing_at(position, middle_slope(bounds, position))
        };
        let mut distance = ((max.y - eye.y) / FRAME_SLOPE).max(1.0);
        while view(distance).half_height_of(bounds) > FRAME_HALF_HEIGHT && distance < COORDINATE.max {
            distance *= 1.1;
        }
        let mut camera = view(distance);
        let half_height = camera.half_height_of(bounds).min(FRAME_HALF_HEIGHT);
        camera.projection = Projection::Perspective {
            vertical_fov_deg: (2.0 * half_height.atan().to_degrees()).max(FIELD_OF_VIEW.min),
        };
        camera
    }

    /// Tangent of half the vertical field of view that holds `bounds` in a 16:9
    /// picture with a margin; infinite where they reach behind the camera.
    fn half_height_of(&self, bounds: Bounds) -> f64 {
        let camera_from_world = self.world_from_camera().inverse();
        let tangents = corners(bounds).map(|corner| {
            let p = camera_from_world * (corner - self.position);
            match -p.z {
                depth if depth > 0.0 => p.y.abs().max(p.x.abs() / FRAME_ASPECT) / depth,
                _ => f64::INFINITY,
            }
        });
        tangents.into_iter().fold(0.0, f64::max) / FRAME_FILL
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("position").position(self.position)?;
        at.field("target").position(self.target)?;
        if self.position.distance(self.target) < 1e-6 {
            return Err(at.field("target").problem(format!(
                "{} is where the camera is: expected a point that it can look at",
                self.target
            )));
        }
        at.field("roll_deg").number(self.roll_deg, ROLL)?;
        for (name, shift) in [("shift_x", self.shift_x), ("shift_y", self.shift_y)] {
            at.field(name).number(shift, SHIFT)?;
            if shift != 0.0 && self.projection == Projection::Equirectangular {
                return Err(at.field(name).problem(format!(
                    "{shift} shifts a lens, and an equirectangular camera has none: expected 0"
                )));
            }
        }
        self.projection.check(at.field("projection"))?;
        self.aperture.map_or(Ok(()), |aperture| aperture.check(self.projection, at.field("aperture")))
    }
}

/// Tangent of the elevation half way between the lowest and the highest direction in
/// which `eye` sees `bounds`.
fn middle_slope(bounds: Bounds, eye: DVec3) -> f64 {
    let elevations = corners(bounds).map(|p| (p.y - eye.y).atan2(eye.z - p.z));
    let lowest = elevations.into_iter().fold(f64::INFINITY, f64::min);
    let highest = elevations.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (0.5 * (lowest + highest)).tan()
}

fn corners((min, max): Bounds) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        DVec3::new(
            if i & 1 == 0 { min.x } else { max.x },
            if i & 2 == 0 { min.y } else { max.y },
            if i & 4 == 0 { min.z } else { max.z },
        )
    })
}
