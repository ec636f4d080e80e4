//! Impostors: pictures of a cloud from many sides in one atlas, from which engines take those next to
//! the line of sight.
//!
//! Sides are the points of an octahedron that is unfolded into a square (Cigolle et al. 2014, "A
//! survey of efficient representations for independent unit vectors"), or of its upper or lower half
//! (Brucks 2018, "Octahedral impostors").

use glam::{DVec2, DVec3};

use super::{Shot, Studio, sprite::Subject};
use crate::Result;

/// From where a cloud can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Around {
    /// All sides.
    Sphere,
    /// Level and from above.
    Above,
    /// Level and from below.
    Below,
}

impl Around {
    /// Direction from the cloud to the eye, for a place on the square from (-1, -1) to (1, 1).
    pub fn to_eye(self, place: DVec2) -> DVec3 {
        let half = |y: f64| {
            let (x, z) = (0.5 * (place.x + place.y), 0.5 * (place.x - place.y));
            DVec3::new(x, y * (1.0 - x.abs() - z.abs()), z).normalize()
        };
        match self {
            Self::Above => half(1.0),
            Self::Below => half(-1.0),
            Self::Sphere => {
                let y = 1.0 - place.x.abs() - place.y.abs();
                let folded = (1.0 - DVec2::new(place.y, place.x).abs()) * place.signum();
                let level = if y < 0.0 { folded } else { place };
                DVec3::new(level.x, y, level.y).normalize()
            }
        }
    }
}

/// Shots of `subject` from `views` by `views` sides, row by row of the square; tells the share done.
///
/// # Errors
/// Where the scene is not valid or the device fails.
pub fn impostor(
    studio: &mut Studio,
    subject: &Subject,
    around: Around,
    views: u32,
    size: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Shot>> {
    let place = |i: u32| 2.0 * f64::from(i) / f64::from((views - 1).max(1)) - 1.0;
    let mut shots = Vec::new();
    for i in 0..views * views {
        let to_eye = around.to_eye(DVec2::new(place(i % views), place(i / views)));
        shots.push(studio.shot(&subject.seen_from(to_eye), [size; 2])?);
        progress(f64::from(i + 1) / f64::from(views * views));
    }
    Ok(shots)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_vectors_that_cover_their_side() {
        for (around, low, high) in
            [(Around::Sphere, -1.0, 1.0), (Around::Above, 0.0, 1.0), (Around::Below, -1.0, 0.0)]
        {
            let mut found: Vec<DVec3> = Vec::new();
            for i in 0..441 {
                let place = DVec2::new(f64::from(i % 21), f64::from(i / 21)) / 10.0 - 1.0;
                let d = around.to_eye(place);
                assert!((d.length() - 1.0).abs() < 1e-12 && d.y >= low - 1e-12 && d.y <= high + 1e-12);
                found.push(d);
            }
            // No direction of that side is far from one that there is.
            for i in 0..500 {
                let t = (f64::from(i) + 0.5) / 500.0;
                let (y, a) = (low + (high - low) * t, 2.399963 * f64::from(i));
                let d = DVec3::new((1.0 - y * y).sqrt() * a.cos(), y, (1.0 - y * y).sqrt() * a.sin());
                assert!(found.iter().any(|f| f.dot(d) > 0.98), "{around:?} {d}");
            }
        }
        assert_eq!(Around::Sphere.to_eye(DVec2::ZERO), DVec3::Y);
        assert_eq!(Around::Below.to_eye(DVec2::ZERO), DVec3::NEG_Y);
        assert_eq!(Around::Above.to_eye(DVec2::ONE), DVec3::X);
    }
}
