//! A sky of cumuli: sizes by a power law, in clusters along streets of the wind, on one level.

use glam::DVec3;

use super::weather;
use crate::scene::dice::Dice;
use crate::scene::{Cloud, Growth, GrowthKind};

/// Height at which vapour condenses, metres.
const LEVEL: f64 = 900.0;
/// Where the air goes: a compass direction, degrees, and the same as a unit vector. Streets run to the horizon.
const HEADING_DEG: f64 = 16.26;
const ALONG: DVec3 = DVec3::new(0.28, 0.0, -0.96);
/// Distance of streets, metres: about three times the depth of the mixed air.
const STREETS: f64 = 2800.0;
/// Clouds that are tried for.
const TRIES: usize = 1200;
/// Most clouds beside the one in front.
const MOST: usize = 150;
/// Nearest and farthest, metres from the camera.
const NEAR: f64 = 2300.0;
const FAR: f64 = 42_000.0;
/// Half the width of what is filled with clouds, by metre of distance: a little more than a picture shows.
const ASIDE: f64 = 0.72;
/// Widths by a power law: least, greatest, metres.
const LEAST: f64 = 450.0;
const GREATEST: f64 = 3000.0;

/// The clouds of a sky, the one in front first.
pub(super) fn clouds(dice: &mut Dice, seed: u32) -> Vec<Cloud> {
    let mut places = vec![hero(seed)];
    let phase = dice.between(0.0, STREETS);
    for _ in 0..TRIES {
        if places.len() > MOST {
            break;
        }
        let growth = one(dice, phase);
        if !hides(&growth, &places[0]) && places.iter().all(|other| are_apart(other, &growth)) {
            places.push(growth);
        }
    }
    let named = |(i, growth)| weather::cloud(&format!("cumulus {}", i + 1), growth);
    places.into_iter().enumerate().map(named).collect()
}

/// The cloud in front, a little off the middle.
fn hero(seed: u32) -> Growth {
    Growth {
        place: DVec3::new(-1000.0, LEVEL, -4700.0),
        width: 2400.0,
        height: 1150.0,
        heading_deg: HEADING_DEG,
        lean: 0.15,
        ..Growth::new(GrowthKind::Congestus, seed)
    }
}

/// A cloud by chance.
fn one(dice: &mut Dice, phase: f64) -> Growth {
    // More of them near than by area: what is far off is seen one behind the other.
    let away = NEAR + (FAR - NEAR) * dice.unit() * dice.unit();
    let aside = (ASIDE * away + 900.0) * dice.between(-1.0, 1.0);
    let place = streeted(dice, DVec3::new(aside, 0.0, -away), phase);
    // The share of clouds wider than w falls as 1/w: the width by the inverse of that.
    let share = dice.unit();
    let width = LEAST / (1.0 - share * (1.0 - LEAST / GREATEST));
    // Far off only the large ones are told apart.
    let width = width.max(away * 0.042);
    let kind = match width {
        w if w < 600.0 => GrowthKind::Humilis,
        w if w < 1500.0 => GrowthKind::Mediocris,
        _ => GrowthKind::Congestus,
    };
    let height = width * dice.between(0.26, 0.5) * if kind == GrowthKind::Humilis { 0.85 } else { 1.0 };
    Growth {
        place: place.with_y(LEVEL).round(),
        width: width.round(),
        height: height.round(),
        heading_deg: HEADING_DEG,
        age: (10.0 * dice.unit() * dice.unit()).round() / 10.0,
        detail: detail(width, away),
        ..Growth::new(kind, (dice.unit() * 1e9) as u32)
    }
}

/// `place` drawn to the nearest street.
fn streeted(dice: &mut Dice, place: DVec3, phase: f64) -> DVec3 {
    let across = DVec3::new(-ALONG.z, 0.0, ALONG.x);
    let offset = place.dot(across) + phase;
    let street = (offset / STREETS).round() * STREETS;
    let off = dice.between(-1.0, 1.0);
    place + (street - offset + 0.36 * STREETS * off * off * off) * across
}

fn are_apart(a: &Growth, b: &Growth) -> bool {
    let reach = 0.46 * (a.width + b.width);
    a.place.distance_squared(b.place) > reach * reach
}

/// Whether it is seen in front of the one that shall be seen whole.
fn hides(growth: &Growth, hero: &Growth) -> bool {
    let bearing = |growth: &Growth| growth.place.x / growth.place.z.min(-1.0);
    growth.place.z > hero.place.z && (bearing(growth) - bearing(hero)).abs() < 0.4
}

/// How much of a cloud is told apart: the least lumps of far ones shall be a seventh of a degree.
fn detail(width: f64, away: f64) -> f64 {
    let share = 12.0 * width / away;
    (20.0 * share.clamp(0.2, 0.95)).round() / 20.0
}
