//! The sun: where it stands and how bright it is.

use chrono::{DateTime, TimeDelta};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use solar_positioning::{Location, SolarPositions, delta_t};

use super::validate::{At, COORDINATE, Limits};
use crate::{Error, Result};

const IRRADIANCE: Limits = Limits::new(0.0, 1e6, "");
const DIAMETER: Limits = Limits::new(0.0, 10.0, "degrees");
const AZIMUTH: Limits = Limits::new(-360.0, 360.0, "degrees");
const ELEVATION: Limits = Limits::new(-90.0, 90.0, "degrees");
const LATITUDE: Limits = Limits::new(-90.0, 90.0, "degrees");
const HOURS: Limits = Limits::new(-1e5, 1e5, "hours");
const LONGITUDE: Limits = Limits::new(-180.0, 180.0, "degrees");

/// The light of the sun.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sun {
    /// Where the sun stands.
    pub position: SunPosition,
    /// Linear RGB irradiance on a plane across the light, each 0 to 1000000, in any
    /// unit: all radiances of the picture come out in it, per steradian. Above the
    /// atmosphere where the sky is `atmosphere`, otherwise at the cloud.
    #[schemars(inner(range(min = IRRADIANCE.min, max = IRRADIANCE.max)))]
    pub irradiance: [f64; 3],
    /// Apparent diameter of the disc, degrees, 0 (a point) to 10. The real sun has 0.53.
    #[schemars(range(min = DIAMETER.min, max = DIAMETER.max), extend("unit" = DIAMETER.unit))]
    pub angular_diameter_deg: f64,
}

/// Where the sun stands, said in one of three ways.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SunPosition {
    /// By compass and height.
    Angles {
        /// Degrees clockwise from north, -360 to 360: 90 is east (+x), 180 south (+z).
        #[schemars(range(min = AZIMUTH.min, max = AZIMUTH.max), extend("unit" = AZIMUTH.unit))]
        azimuth_deg: f64,
        /// Degrees above the horizon, -90 to 90.
        #[schemars(range(min = ELEVATION.min, max = ELEVATION.max), extend("unit" = ELEVATION.unit))]
        elevation_deg: f64,
    },
    /// A vector [x, y, z] towards the sun, of any length but zero: x east, y up, z south.
    Direction(
        #[schemars(with = "[f64; 3]", inner(range(min = COORDINATE.min, max = COORDINATE.max)), extend("unit" = COORDINATE.unit))]
         DVec3,
    ),
    /// By place and time on Earth.
    Place {
        /// Degrees north of the equator, -90 to 90.
        #[schemars(range(min = LATITUDE.min, max = LATITUDE.max), extend("unit" = LATITUDE.unit))]
        latitude_deg: f64,
        /// Degrees east of Greenwich, -180 to 180.
        #[schemars(range(min = LONGITUDE.min, max = LONGITUDE.max), extend("unit" = LONGITUDE.unit))]
        longitude_deg: f64,
        /// Date and time with zone as in RFC 3339, such as `2026-06-21T18:30:00+02:00`.
        #[schemars(extend("format" = "date-time"))]
        time: String,
        /// Hours that have passed since `time`, -100000 to 100000; 0 where left out. Animate it
        /// to let the sun go its way.
        #[serde(default, skip_serializing_if = "is_zero")]
        #[schemars(range(min = HOURS.min, max = HOURS.max), extend("unit" = HOURS.unit))]
        hours: f64,
    },
}

fn is_zero(hours: &f64) -> bool {
    *hours == 0.0
}

impl Default for Sun {
    fn default() -> Self {
        Self { position: SunPosition::default(), irradiance: [1.0; 3], angular_diameter_deg: 0.53 }
    }
}

impl Default for SunPosition {
    /// In the south-west, half way up: for a camera that looks north it stands
    /// behind the left shoulder and models the clouds from the side.
    fn default() -> Self {
        Self::Angles { azimuth_deg: 225.0, elevation_deg: 45.0 }
    }
}

impl Sun {
    /// Unit vector towards the sun; see [`SunPosition::to_sun`].
    ///
    /// # Panics
    /// Where the position would not pass [`Scene::validate`](super::Scene::validate).
    pub fn to_sun(&self) -> DVec3 {
        self.position.to_sun().expect("a validated scene has a position of the sun")
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        self.position.check(at.field("position"))?;
        at.field("irradiance").numbers(&self.irradiance, IRRADIANCE)?;
        at.field("angular_diameter_deg").number(self.angular_diameter_deg, DIAMETER)
    }
}

impl SunPosition {
    /// Unit vector towards the centre of the sun.
    ///
    /// A place gives the position by NREL's SPA (Reda and Andreas 2004, 0.0003
    /// degrees) for an observer at sea level, without refraction: light travels in
    /// straight lines in the rest of the program. The seen sun stands higher by 0.02
    /// degrees at 40 degrees of elevation, by 0.5 to 0.6 degrees on the horizon.
    ///
    /// # Errors
    /// [`Error::Scene`] where a field is out of range or the time cannot be read.
    pub fn to_sun(&self) -> Result<DVec3> {
        let root = At::Root;
        let sun = root.field("sun");
        let at = sun.field("position");
        self.check(at)?;
        match self {
            Self::Angles { azimuth_deg, elevation_deg } => Ok(from_angles(*azimuth_deg, *elevation_deg)),
            Self::Direction(v) => Ok(v.normalize()),
            Self::Place { latitude_deg, longitude_deg, time, hours } => {
                from_place(*latitude_deg, *longitude_deg, (time, *hours), at.field("place"))
            }
        }
    }

    fn check(&self, at: At) -> Result<()> {
        match self {
            Self::Angles { azimuth_deg, elevation_deg } => {
                let angles = at.field("angles");
                angles.field("azimuth_deg").number(*azimuth_deg, AZIMUTH)?;
                angles.field("elevation_deg").number(*elevation_deg, ELEVATION)
            }
            Self::Direction(v) => at.field("direction").direction(*v),
            Self::Place { latitude_deg, longitude_deg, time, hours } => {
                let place = at.field("place");
                place.field("hours").number(*hours, HOURS)?;
                place.field("latitude_deg").number(*latitude_deg, LATITUDE)?;
                place.field("longitude_deg").number(*longitude_deg, LONGITUDE)?;
                from_place(*latitude_deg, *longitude_deg, (time, *hours), place).map(drop)
            }
        }
    }
}

/// Unit vector of a compass direction (degrees clockwise from north, -z) and a height
/// above the horizon (degrees).
fn from_angles(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
    let (sin_elevation, cos_elevation) = elevation_deg.to_radians().sin_cos();
    DVec3::new(sin_azimuth * cos_elevation, sin_elevation, -cos_azimuth * cos_elevation)
}

/// Unit vector towards the sun from a place (degrees), so many hours after a time (RFC 3339),
/// without refraction.
fn from_place(latitude: f64, longitude: f64, (time, hours): (&str, f64), at: At) -> Result<DVec3> {
    let at = at.field("time");
    let when = DateTime::parse_from_rfc3339(time).map_err(|reason| unreadable(at, time, reason))?;
    let later = TimeDelta::nanoseconds((hours * 3.6e12).round() as i64);
    let when = when.checked_add_signed(later).ok_or_else(|| unreadable(at, time, "too far away"))?;
    let location = Location { latitude, longitude };
    let seconds = delta_t::estimate_from_date_like(&when).map_err(|reason| unreadable(at, time, reason))?;
    let position = SolarPositions::new()
        .at(&when, location, 0.0, seconds, None)
        .map_err(|reason| unreadable(at, time, reason))?;
    Ok(from_angles(position.azimuth(), position.elevation_angle()))
}

fn unreadable(at: At, time: &str, reason: impl std::fmt::Display) -> Error {
    at.problem(format!(
        "`{time}` is no usable time ({reason}): expected date, time and zone, such as `2026-06-21T18:30:00+02:00`"
    ))
}
