//! What other clouds that end do to the light that comes to a cloud: they stand before sky and ground, shade the ground,
//! and shine themselves.
//!
//! How it works. From afar a cloud is a **body**: the even ellipsoid with the second moments of its lumps. Rays go from
//! all over a cloud into the patch of the sphere that each direction of its light stands for. What such a ray meets of a
//! body shines as Lambert's law has it: on its lit side with what a slab sends back of the sun's light that is as thick as the
//! body is on average along the beam, on its far side with what comes through that slab. Nothing is lost by that: of the
//! light that comes to the silhouette of a body as much goes out. Of diffuse light a body returns the mean. The sun's light on a
//! body, and on the ground that a ray ends at, is dimmed by the other bodies.
//!
//! Why not by the fields of those clouds: they would have to be there first, each for all others; light from beside is a
//! twentieth of a cloud's, and the mean of a face tells it well enough (docs/shadows.md has the error).

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    super::field::{DIRECTIONS, patches},
    body::{Body, Meeting},
    slab::Returned,
};
use crate::frame::{CloudFrame, Frame};

/// Rays along each side of a patch.
const SIDE: usize = 8;
/// Most bodies around a cloud: those that look largest.
const MOST: usize = 16;
/// Bodies farther away than so many of their radii, 0.02 sr, are none.
const FAR: f64 = 12.0;
/// The bodies of a frame.
pub(super) struct Bodies<'a> {
    clouds: &'a [CloudFrame],
    bodies: Vec<Option<Body>>,
    /// Number, place in the world and radius of each that there is: thousands are asked for each other.
    places: Vec<(usize, DVec3, f64)>,
    ground: Option<f64>,
}

impl<'a> Bodies<'a> {
    /// Those of `frame`; `grounded` tells whether its ground is lit.
    pub fn of(frame: &'a Frame, grounded: bool) -> Self {
        let clouds = &frame.clouds;
        let mut bodies: Vec<Option<Body>> = Vec::new();
        clouds.par_iter().map(Body::of).collect_into_vec(&mut bodies);
        let place = |(number, body): (usize, &Option<Body>)| {
            let body = body.as_ref()?;
            Some((number, clouds[number].origin + body.middle, body.radius()))
        };
        let places = bodies.iter().enumerate().filter_map(place).collect();
        Self { clouds, bodies, places, ground: grounded.then_some(frame.ground) }
    }

    /// What they do to the light that comes to cloud `number`; none where nothing is near.
    pub fn beside(&self, number: usize) -> Option<Beside> {
        let own = self.bodies[number].clone()?;
        let cloud = &self.clouds[number];
        let here = cloud.origin + own.middle;
        let mut near: Vec<(f64, usize)> = Vec::new();
        for &(other, place, radius) in &self.places {
            let distance = (place - here).length_squared();
            if other != number && distance <= (FAR * radius).powi(2) {
                near.push((radius / distance.sqrt().max(1e-3), other));
            }
        }
        near.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        near.truncate(MOST);
        let ground = self.ground.map(|ground| own.rounded(DVec3::Y * (ground - cloud.origin.y)).y);
        let is_alone = near.is_empty() && ground.is_none();
        let seen = |(_, other): (f64, usize)| {
            let offset = self.clouds[other].origin - cloud.origin;
            self.bodies[other].as_ref().map(|body| body.at(offset))
        };
        let others = near.into_iter().filter_map(seen).collect();
        (!is_alone).then_some(Beside { own, others, ground })
    }
}

/// What is beside a cloud, in its frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Beside {
    own: Body,
    others: Vec<Body>,
    /// Height of the ground, m.
    ground: Option<f64>,
}

/// What comes to a cloud from beside it, by direction that light is solved for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FromBeside {
    /// Share of sky and ground that is seen between others.
    pub open: [f32; DIRECTIONS],
    /// Share of the mean of diffuse light that others return.
    pub returned: [f32; DIRECTIONS],
    /// Of the sun's light that they scatter, for each unit of its irradiance, 1/sr.
    pub sun: [f32; DIRECTIONS],
    /// Share of the sun's light that the ground lacks, of all of the ground that a patch may hold.
    pub shaded: [f32; DIRECTIONS],
}

impl FromBeside {
    /// Nothing is there.
    pub const NONE: Self = Self {
        open: [1.0; DIRECTIONS],
        returned: [0.0; DIRECTIONS],
        sun: [0.0; DIRECTIONS],
        shaded: [0.0; DIRECTIONS],
    };
}

impl Beside {
    /// In the light of a sun in direction `to_sun`.
    pub fn told(&self, to_sun: DVec3) -> FromBeside {
        let shining: Vec<_> = self.others.iter().map(|body| Shining::new(body, to_sun)).collect();
        let points = self.own.points(SIDE * SIDE);
        let mut told = FromBeside::NONE;
        for (direction, patch) in patches().into_iter().enumerate() {
            let mut mean = Seen::default();
            for (i, &point) in points.iter().enumerate() {
                let place = [i % SIDE, i / SIDE].map(|x| (x as f64 + 0.5) / SIDE as f64);
                mean.add(&self.seen(&shining, point, way(patch, place), to_sun), 1.0 / points.len() as f64);
            }
            told.open[direction] = mean.open as f32;
            told.returned[direction] = mean.returned as f32;
            told.sun[direction] = mean.sun as f32;
            told.shaded[direction] = mean.shaded as f32;
        }
        told
    }

    /// What is seen along a ray.
    fn seen<'a>(&self, shining: &'a [Shining<'a>], from: DVec3, along: DVec3, to_sun: DVec3) -> Seen {
        let met = |shining: &'a Shining<'a>| Some((shining, shining.body.meet(from, along)?));
        let mut met: Vec<_> = shining.iter().filter_map(met).collect();
        met.sort_by(|(_, a), (_, b)| a.enters.total_cmp(&b.enters));
        let mut seen = Seen { open: 1.0, ..Seen::default() };
        for (body, Meeting { enters, chord }) in met {
            let taken = seen.open * (1.0 - (-body.body.extinction * chord).exp());
            let p = from + enters * along;
            let cosine = body.body.facing(p).dot(to_sun);
            let light = if cosine > 0.0 { body.lit * cosine } else { -body.far * cosine };
            seen.sun += taken * light * (-self.shade(Some(body.body), p, to_sun)).exp();
            seen.returned += taken * body.returned;
            seen.open -= taken;
        }
        if let Some(ground) = self.ground.filter(|_| along.y < 0.0 && to_sun.y > 0.0) {
            let foot = from + (ground - from.y) / along.y * along;
            let depth = self.shade(None, foot, to_sun);
            let turning = 1.0 - f64::from(self.own.species.beyond_ahead()[1]);
            seen.shaded = seen.open * (1.0 - through(depth, to_sun.y, turning));
        }
        seen
    }

    /// Optical depth from a point to the sun in all bodies but `besides`.
    fn shade(&self, besides: Option<&Body>, p: DVec3, to_sun: DVec3) -> f64 {
        let all = self.others.iter().chain([&self.own]);
        all.filter(|body| besides.is_none_or(|own| !std::ptr::eq(*body, own)))
            .map(|body| body.depth(p, to_sun))
            .sum()
    }
}

/// Share of sunlight that comes out below a broad cloud in all, as `sun_map_whole` of `shaders/lib/sun_map.wgsl` has it.
fn through(depth: f64, mu: f64, turning: f64) -> f64 {
    let entering = 2.0 / 3.0 + mu + (2.0 / 3.0 - mu) * (-depth).exp();
    entering / (4.0 / 3.0 + turning * mu * depth)
}

/// What is seen along one ray, or a mean of such.
#[derive(Default)]
struct Seen {
    open: f64,
    returned: f64,
    sun: f64,
    shaded: f64,
}

impl Seen {
    fn add(&mut self, other: &Self, weight: f64) {
        self.open += weight * other.open;
        self.returned += weight * other.returned;
        self.sun += weight * other.sun;
        self.shaded += weight * other.shaded;
    }
}

/// A body in the light of the sun.
struct Shining<'a> {
    body: &'a Body,
    /// Radiance of its lit and of its far side where the sun is upright on it, for each unit of its irradiance, 1/sr.
    lit: f64,
    far: f64,
    /// Share of diffuse light that it returns of what it takes.
    returned: f64,
}

impl<'a> Shining<'a> {
    /// Mean over the silhouette of a body of the cosine of the sun to its surface.
    const COSINE: f64 = 2.0 / 3.0;

    fn new(body: &'a Body, to_sun: DVec3) -> Self {
        // Of all ways through an ellipsoid along one direction the mean is two thirds of the longest.
        let depth = body.extinction * 2.0 / 3.0 * body.width(to_sun);
        let slab = Returned::of(&body.species, depth * Self::COSINE, Self::COSINE);
        let taken = 1.0 - (-depth).exp();
        Self { body, lit: slab.back / (PI * taken), far: slab.through / (PI * taken), returned: slab.diffuse }
    }
}

/// The unit vector to a place of a patch of the sphere, told from 0 to 1.
fn way([low, high, start, end]: [f32; 4], [x, y]: [f64; 2]) -> DVec3 {
    let between = |a: f32, b: f32, share: f64| f64::from(a) + share * f64::from(b - a);
    let (height, azimuth) = (between(low, high, x), between(start, end, y));
    let around = (1.0 - height * height).max(0.0).sqrt();
    DVec3::new(around * azimuth.cos(), height, around * azimuth.sin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::light::{around::body::tests::frame, field::directions};

    fn ball(center: [f64; 3], radius: f64, per_cm3: f64) -> String {
        format!(
            r#"{{"edge": {{"boundary": 0}}, "droplets": {{"phase": "isotropic", "concentration_per_cm3": {per_cm3}}},
                "ellipsoids": [{{"center": {center:?}, "radii": [{radius}, {radius}, {radius}]}}]}}"#
        )
    }

    /// Integral over the sphere, sr.
    fn over_sphere(values: &[f32; DIRECTIONS]) -> f64 {
        directions().iter().zip(values).map(|(way, value)| f64::from(way.w * value)).sum()
    }

    #[test]
    fn another_cloud_hides_the_solid_angle_that_it_fills_and_returns_what_it_takes() {
        // Seen from a small cloud a ball two of its radii away fills 2 pi (1 - cos 30 degrees).
        let clouds = [ball([0.0, 2000.0, 0.0], 5.0, 300.0), ball([0.0, 2000.0, 800.0], 400.0, 300.0)];
        let frame = frame(&clouds);
        let beside = Bodies::of(&frame, false).beside(0).unwrap().told(DVec3::Y);
        let hidden = 4.0 * PI - over_sphere(&beside.open);
        let wanted = 2.0 * PI * (1.0 - 30f64.to_radians().cos());
        assert!((hidden / wanted - 1.0).abs() < 0.03, "{hidden} {wanted}");
        let all = beside.open.iter().zip(&beside.returned).map(|(open, back)| open + back);
        assert!(all.into_iter().all(|light| (light - 1.0).abs() < 1e-4));
        assert!(beside.shaded.iter().all(|share| *share == 0.0));
    }

    #[test]
    fn as_much_of_the_sun_leaves_a_body_as_it_takes() {
        for per_cm3 in [3.0, 40.0, 400.0] {
            let body = Body::of(&frame(&[ball([0.0, 2000.0, 0.0], 300.0, per_cm3)]).clouds[0]).unwrap();
            let to_sun = DVec3::new(0.6, 0.8, 0.0);
            let shining = Shining::new(&body, to_sun);
            let (count, mut out) = (4000, 0.0);
            for i in 0..count {
                // Points of it, evenly.
                let height = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(count);
                let angle = 2.399_963 * f64::from(i);
                let around = (1.0 - height * height).sqrt();
                let cosine = DVec3::new(around * angle.cos(), height, around * angle.sin()).dot(to_sun);
                let light = if cosine > 0.0 { shining.lit * cosine } else { -shining.far * cosine };
                out += PI * light * 4.0 / f64::from(count);
            }
            // Over the area of its silhouette, and as far as that is opaque.
            assert!((out - 1.0).abs() < 0.02, "{per_cm3}: {out}");
        }
    }

    #[test]
    fn the_ground_below_a_cloud_is_in_its_shadow_under_a_high_sun_and_not_under_a_low_one() {
        let frame = frame(&[ball([0.0, 450.0, 0.0], 400.0, 300.0)]);
        let beside = Bodies::of(&frame, true).beside(0).unwrap();
        let below: Vec<_> = (0..DIRECTIONS).filter(|i| directions()[*i].y > 0.9).collect();
        let shaded = |to_sun: DVec3| {
            let told = beside.told(to_sun.normalize());
            assert!(told.open.iter().all(|open| *open == 1.0));
            below.iter().map(|i| told.shaded[*i]).sum::<f32>() / below.len() as f32
        };
        let (high, low) = (shaded(DVec3::Y), shaded(DVec3::new(3.0, 1.0, 0.0)));
        assert!(high > 0.6 && low < 0.3 * high, "{high} {low}");
    }

    #[test]
    fn what_moves_by_a_hair_changes_nothing_and_what_is_far_is_nothing() {
        let at = |x: f64| {
            let clouds = [ball([0.0, 2000.0, 0.0], 100.0, 300.0), ball([x, 2000.0, 0.0], 100.0, 300.0)];
            Bodies::of(&frame(&clouds), false).beside(0)
        };
        assert!(at(400.2) == at(400.0) && at(400.0) != at(410.0));
        assert!(at(400.0).is_some() && at(1300.0).is_none());
    }
}
