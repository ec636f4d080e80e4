//! Growth and what is edited: a cloud grows anew with its numbers, is carried as a whole, and ends to grow where a
//! hand changes one of its ellipsoids.

use glam::DVec3;

use crate::scene::{Cloud, Scene};

/// How far ellipsoids that were moved together may be from moving alike, metres: what sums round off.
const ALIKE: f64 = 1e-6;

/// Makes growing clouds of `edited`, which was `before`, agree with their ellipsoids; tells, in a sentence, which
/// grow no more.
pub fn follow(before: &Scene, edited: &mut Scene) -> Option<String> {
    let mut ended = Vec::new();
    for (i, cloud) in edited.clouds.iter_mut().enumerate() {
        if cloud.growth.is_none() {
            continue;
        }
        let Some(old) = before.clouds.get(i).filter(|old| old.ellipsoids.len() == cloud.ellipsoids.len())
        else {
            end_unless_grown(cloud, &mut ended);
            continue;
        };
        match (old.growth == cloud.growth, old.ellipsoids == cloud.ellipsoids) {
            (true, true) => {}
            (false, true) => cloud.grow(),
            (true, false) => match carried(old, cloud) {
                Some(offset) => cloud.shift(offset),
                None => end_unless_grown(cloud, &mut ended),
            },
            (false, false) => end_unless_grown(cloud, &mut ended),
        }
    }
    let what = match ended.as_slice() {
        [] => return None,
        [one] => format!("`{one}` was changed by hand and grows no more"),
        several => format!("{} clouds were changed by hand and grow no more", several.len()),
    };
    Some(format!("{what}: undo gives its numbers back."))
}

fn end_unless_grown(cloud: &mut Cloud, ended: &mut Vec<String>) {
    if !cloud.is_as_grown() {
        cloud.growth = None;
        ended.push(cloud.name.clone());
    }
}

/// How far all ellipsoids of `old` were moved to be those of `new`, where nothing else was done to them.
fn carried(old: &Cloud, new: &Cloud) -> Option<DVec3> {
    let mut pairs = old.ellipsoids.iter().zip(&new.ellipsoids);
    let offset = pairs.clone().next().map(|(a, b)| b.center - a.center)?;
    let alike = pairs.all(|(a, b)| {
        let off = b.center - a.center - offset;
        off.abs().max_element() < ALIKE && *b == crate::scene::Ellipsoid { center: b.center, ..a.clone() }
    });
    alike.then_some(offset)
}
