//! One auto exposure for all frames: what changes from frame to frame is the scene, never the exposure.
//! It is the scene's alone, whichever frames are drawn and by whom.

use super::{
    super::picture::{Painter, PictureOptions},
    stamp::identity,
};
use crate::{Result, scene::Scene};

/// The moments that are metered, as shares of the timeline; the middle one of what they give counts.
const METERED: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

/// Moments of `scene` that tell its exposure, s: of its timeline, or else its first frame.
fn moments(scene: &Scene) -> Vec<f64> {
    match &scene.timeline {
        Some(timeline) => METERED.map(|share| share * timeline.length).to_vec(),
        None => vec![0.0],
    }
}

/// All that the exposure of `scene` follows from, as text.
///
/// # Errors
/// Where the scene is not good at one of those moments.
pub fn basis(scene: &Scene) -> Result<String> {
    let moments = moments(scene).into_iter().map(|time| Ok(identity(&scene.at(time)?)));
    moments.collect::<Result<Vec<_>>>().map(|texts| texts.concat())
}

/// Auto exposure of the whole of `scene` in stops, where it has one: the middle one of its moments'.
///
/// # Errors
/// Where the device fails.
pub fn meter(picture: &PictureOptions, painter: &mut Painter, scene: &Scene) -> Result<Option<f64>> {
    let mut found = Vec::new();
    for time in moments(scene) {
        let moment = Scene { time, ..scene.clone() };
        found.extend(picture.meter_beside(painter, scene, &picture.frame(&moment)?)?);
    }
    found.sort_by(f64::total_cmp);
    Ok(found.get(found.len() / 2).copied())
}
