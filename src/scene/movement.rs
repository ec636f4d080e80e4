//! How the matter of clouds goes from one moment to the next: what pictures tell as motion, and volumes as velocity.

use glam::DVec3;

use super::{Cloud, Ellipsoid, Scene};
use crate::Result;

/// How far the matter of each cloud of a moment goes until a later one. Clouds go with the wind, their lumps as curves,
/// shear and lives move them; what forms or dissolves in place stays where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Movement {
    clouds: Vec<Moving>,
}

/// A cloud that goes.
#[derive(Debug, Clone, PartialEq)]
struct Moving {
    ways: Ways,
    /// Where it is: nowhere, of a layer, which is everywhere.
    lumps: Vec<Lump>,
}

/// The ways of the matter of a cloud.
#[derive(Debug, Clone, PartialEq)]
enum Ways {
    /// All of it goes the same way, m.
    Together(DVec3),
    /// Lumps go ways of their own, m.
    Apart(Vec<DVec3>),
}

/// Where a lump is.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lump {
    center: DVec3,
    /// Its largest radius, m.
    radius: f64,
}

/// Ways that differ by less are the same, m.
const SAME: f64 = 1e-6;
/// What is added to squared distances in radii: within a third of its radius a lump's way is nearly all that counts.
const NEAR: f64 = 0.1;

impl Scene {
    /// How far the matter of each cloud that [`Scene::at`] has at `time` goes in `span` seconds from then on. Where a
    /// loop or a life begins anew within them, as far as it went in as many seconds before.
    ///
    /// # Errors
    /// Where the scene is not valid at these moments.
    pub fn movement(&self, time: f64, span: f64) -> Result<Movement> {
        let now = self.at(time)?;
        let (after, before) = (self.at(time + span)?, self.at(time - span)?);
        let begins_anew = |cloud: usize| match self.clouds.get(cloud) {
            Some(cloud) => self.begins_anew(cloud, time, span),
            None => self.wraps(time, span),
        };
        let wind = span * now.wind.velocity;
        let ways = |(number, cloud): (usize, &Cloud)| {
            let (from, to) = match begins_anew(number) {
                true => (before.clouds.get(number), Some(cloud)),
                false => (Some(cloud), after.clouds.get(number)),
            };
            let ways = from.zip(to).and_then(|(from, to)| Ways::between(from, to));
            let lumps = lumps(cloud);
            // Where it has other parts by then it goes with the wind.
            let known = ways.filter(|ways| !matches!(ways, Ways::Apart(list) if list.len() != lumps.len()));
            Moving { ways: known.unwrap_or(Ways::Together(wind)), lumps }
        };
        Ok(Movement { clouds: now.clouds.iter().enumerate().map(ways).collect() })
    }

    /// Whether a loop begins anew within `span` seconds from `time`.
    fn wraps(&self, time: f64, span: f64) -> bool {
        let timeline = self.timeline.as_ref();
        timeline.is_some_and(|timeline| timeline.wrapped(time + span) < timeline.wrapped(time))
    }

    /// Whether a cloud does: with a life of its own, when that does.
    fn begins_anew(&self, cloud: &Cloud, time: f64, span: f64) -> bool {
        match (&cloud.life, self.period()) {
            (Some(life), Some(period)) => life.age(time + span, Some(period)) < life.age(time, Some(period)),
            _ => self.wraps(time, span),
        }
    }
}

impl Movement {
    /// How far the matter of cloud number `cloud` that is at `p`, m, goes: m.
    pub fn at(&self, cloud: usize, p: DVec3) -> DVec3 {
        self.clouds.get(cloud).map_or(DVec3::ZERO, |cloud| cloud.at(p))
    }

    /// How far what is at `p`, m, goes: the matter of the cloud that is nearest, in radii of its lumps. Layers are left
    /// out.
    pub fn nearest(&self, p: DVec3) -> DVec3 {
        if let Some(way) = self.of_all() {
            return way;
        }
        let away = |cloud: &Moving| cloud.lumps.iter().map(|lump| lump.away(p)).reduce(f64::min);
        let nearest = self.clouds.iter().filter_map(|cloud| Some((away(cloud)?, cloud)));
        nearest.min_by(|(a, _), (b, _)| a.total_cmp(b)).map_or(DVec3::ZERO, |(_, cloud)| cloud.at(p))
    }

    /// The one way that all clouds go, m, if there is one.
    pub fn of_all(&self) -> Option<DVec3> {
        let mut ways = self.clouds.iter().map(|cloud| match &cloud.ways {
            Ways::Together(way) => Some(*way),
            Ways::Apart(_) => None,
        });
        let first = ways.next().unwrap_or(Some(DVec3::ZERO))?;
        ways.all(|way| way.is_some_and(|way| way.distance(first) < SAME)).then_some(first)
    }
}

impl Moving {
    /// That of the matter at `p`, m: the mean of the lumps' ways, weighted by the inverse square of the squared distance
    /// in radii (Shepard 1968).
    fn at(&self, p: DVec3) -> DVec3 {
        let ways = match &self.ways {
            Ways::Together(way) => return *way,
            Ways::Apart(ways) => ways,
        };
        let weighted = self.lumps.iter().zip(ways).map(|(lump, way)| ((lump.away(p) + NEAR).powi(-2), *way));
        let (weights, ways) = weighted
            .fold((0.0, DVec3::ZERO), |(sum, ways), (weight, way)| (sum + weight, ways + weight * way));
        ways / weights
    }
}

impl Lump {
    /// Squared distance of `p` from its middle, in radii.
    fn away(&self, p: DVec3) -> f64 {
        p.distance_squared(self.center) / (self.radius * self.radius)
    }
}

/// Where a cloud is.
fn lumps(cloud: &Cloud) -> Vec<Lump> {
    let lump =
        |ellipsoid: &Ellipsoid| Lump { center: ellipsoid.center, radius: ellipsoid.radii.max_element() };
    match cloud.bounds() {
        Some((low, high)) if cloud.is_of_file() => {
            vec![Lump { center: 0.5 * (low + high), radius: 0.5 * low.distance(high) }]
        }
        _ => cloud.ellipsoids.iter().map(lump).collect(),
    }
}

impl Ways {
    /// From one moment to another; none where its parts are others by then.
    fn between(from: &Cloud, to: &Cloud) -> Option<Self> {
        if let (Some(from), Some(to)) = (&from.volume, &to.volume) {
            return Some(Self::Together(to.place - from.place));
        }
        if let (Some(from), Some(to)) = (&from.mesh, &to.mesh) {
            return Some(Self::Together(to.place - from.place));
        }
        if let (Some(from), Some(to)) = (&from.layer, &to.layer) {
            let [x, z] = [0, 1].map(|i| to.offset[i] - from.offset[i]);
            return Some(Self::Together(DVec3::new(x, to.base - from.base, z)));
        }
        let [from, to] = [from, to].map(|cloud| cloud.ellipsoids.as_slice());
        if from.is_empty() || from.len() != to.len() {
            return None;
        }
        let ways: Vec<_> = from.iter().zip(to).map(|(from, to)| to.center - from.center).collect();
        let together = ways.iter().all(|way| way.distance(ways[0]) < SAME);
        Some(if together { Self::Together(ways[0]) } else { Self::Apart(ways) })
    }
}
