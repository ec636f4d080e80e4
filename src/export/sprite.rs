//! Sprites of clouds: the cloud on its own, seen along parallel lines from any side, in a square
//! that it never leaves.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::{Picture, Studio};
use crate::{
    Error, Result,
    scene::{Camera, Cloud, Ellipsoid, Ground, Projection, Scene, Sky, Sun, SunPosition},
};

/// The square is larger than the ball around the cloud by this, so that tiles of an atlas don't bleed.
const MARGIN: f64 = 1.04;

/// What sprites are taken of.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The scene with nothing but the cloud.
    scene: Scene,
    /// Middle of the ball around it at time 0, m.
    center: DVec3,
    /// Half the edge of the square, m.
    half: f64,
    /// How far it is turned about the vertical through its middle, rad.
    turned: f64,
}

/// How a sprite changes from its first frame to the one after the last.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Course {
    /// Way of the noise through the cloud, once round a level circle, m.
    pub travel: f64,
    /// How often the cloud turns about the vertical, light and eye standing still: against the
    /// clock from above.
    pub turns: i32,
    /// How much of the scene's own time goes by, s: its wind carries the cloud through the noise, the
    /// square with it. Where it is 0, the frame after the last is the first.
    pub seconds: f64,
}

impl Course {
    /// By what the cloud turns from one of so many frames to the next, rad.
    pub fn turn(&self, frames: u32) -> f64 {
        TAU * f64::from(self.turns) / f64::from(frames)
    }
}

/// Light from one side of a sprite, and the channel that Unity's six-way lighting has it in: the first
/// three in the map of positive axes, the others in that of negative ones.
pub const SIDES: [(&str, DVec3); 6] = [
    ("right", DVec3::X),
    ("top", DVec3::Y),
    ("back", DVec3::NEG_Z),
    ("left", DVec3::NEG_X),
    ("bottom", DVec3::NEG_Y),
    ("front", DVec3::Z),
];

/// Between two sides each: directions to the edges of a cube.
pub const EDGES: [DVec3; 12] = {
    const fn edge(x: i32, y: i32, z: i32) -> DVec3 {
        DVec3::new(x as f64, y as f64, z as f64)
    }
    [
        edge(1, 1, 0),
        edge(1, -1, 0),
        edge(-1, 1, 0),
        edge(-1, -1, 0),
        edge(1, 0, 1),
        edge(1, 0, -1),
        edge(-1, 0, 1),
        edge(-1, 0, -1),
        edge(0, 1, 1),
        edge(0, 1, -1),
        edge(0, -1, 1),
        edge(0, -1, -1),
    ]
};

impl Subject {
    /// The cloud called `name`, or with that number, from 0; all clouds where there is no name.
    ///
    /// # Errors
    /// [`Error::Argument`] where there is no such cloud or it has no ellipsoids.
    pub fn new(scene: &Scene, name: Option<&str>) -> Result<Self> {
        let mut alone = scene.clone();
        if let Some(name) = name {
            let index = (scene.clouds.iter().position(|cloud| cloud.name == name))
                .or_else(|| name.parse().ok().filter(|&i: &usize| i < scene.clouds.len()))
                .ok_or_else(|| unknown(scene, name))?;
            alone.clouds = vec![scene.clouds[index].clone()];
        }
        // Layers have no end, and do not fit into a sprite.
        alone.clouds.retain(|cloud| cloud.layer.is_none());
        let visible = || alone.clouds.iter().flat_map(Cloud::visible);
        let bounds = visible().map(Ellipsoid::bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let Some((low, high)) = bounds else {
            return Err(Error::Argument("there is no cloud to take a sprite of at that moment: clouds that form and dissolve are there at \
                 others (--time), and layers, which have no end, are left out".to_owned()));
        };
        let center = 0.5 * (low + high);
        let reach = visible().map(|e| e.center.distance(center) + e.radii.max_element());
        let radius = reach.fold(0.0, f64::max).min(0.5 * (high - low).length());
        Ok(Self { scene: alone, center, half: MARGIN * radius, turned: 0.0 })
    }

    /// Edge of the square, m.
    pub fn extent(&self) -> f64 {
        2.0 * self.half
    }

    /// Unit vector from the cloud to the scene's camera; level south where that is inside the cloud.
    pub fn to_camera(&self) -> DVec3 {
        (self.scene.camera().position - self.center).try_normalize().unwrap_or(DVec3::Z)
    }

    /// The cloud seen from where `to_eye` points, without a picture's sky.
    pub fn seen_from(&self, to_eye: DVec3) -> Scene {
        let target = self.center + self.scene.drift();
        // Eye and light go round the cloud the other way.
        let back = DQuat::from_rotation_y(-self.turned);
        let camera = Camera {
            position: target + 2.0 * self.half * (back * to_eye),
            target,
            roll_deg: 0.0,
            projection: Projection::Orthographic { height: 2.0 * self.half },
            ..Camera::default()
        };
        let mut scene = self.scene.seen_by(camera);
        let further = scene.lights.iter_mut().filter_map(|light| light.source.as_sun_mut());
        for sun in [&mut scene.sun].into_iter().chain(further) {
            sun.position = SunPosition::Direction(back * sun.to_sun());
        }
        scene
    }

    /// The cloud at frame `frame` of `frames`.
    #[must_use]
    pub fn at(&self, course: Course, frame: u32, frames: u32) -> Self {
        let share = f64::from(frame) / f64::from(frames);
        let mut subject = self.clone();
        let (sin, cos) = (TAU * share).sin_cos();
        let way = course.travel / TAU * DVec3::new(sin, 0.0, 1.0 - cos);
        subject.scene.noises_mut().for_each(|noise| noise.offset += way);
        subject.scene.time += course.seconds * share;
        subject.turned += course.turn(frames) * f64::from(frame);
        subject
    }

    /// Its light from each of [`SIDES`], seen from where `to_eye` points: 1 is as bright as a white sheet that
    /// the same light hits straight on. Mean of red, green and blue, not multiplied by the opacity,
    /// which is in the last channel: two pictures, of three sides each.
    ///
    /// A side stands for all light that comes from about there, so that it is the mean of four lights at
    /// 45 degrees to it; one straight behind would shine through by the forward peak of droplets alone, a
    /// hundred times as bright as the others. Neighbouring sides share a light: there are [`EDGES`].
    ///
    /// # Errors
    /// Where the scene is not valid or the device fails.
    pub fn six_ways(&self, studio: &mut Studio, to_eye: DVec3, size: u32) -> Result<[Picture; 2]> {
        let mut scene = self.seen_from(to_eye);
        scene.lights.clear();
        scene.sky = Sky::None;
        scene.ground = Ground { albedo: [0.0; 3], ..scene.ground };
        let world_from_camera = scene.camera().world_from_camera();
        let blank = Picture {
            width: size as usize,
            height: size as usize,
            pixels: vec![[0.0; 4]; (size * size) as usize],
        };
        let mut maps = [blank.clone(), blank];
        for edge in EDGES {
            let position = SunPosition::Direction(world_from_camera * edge);
            scene.sun = Sun { position, irradiance: [1.0; 3], ..scene.sun };
            let lit = studio.picture(&scene, [size; 2], false)?;
            for (side, _) in SIDES.iter().enumerate().filter(|(_, (_, side))| side.dot(edge) > 0.0) {
                for (sum, pixel) in maps[side / 3].pixels.iter_mut().zip(&lit.pixels) {
                    sum[side % 3] += 0.25 * reflectance(*pixel);
                    sum[3] = pixel[3];
                }
            }
        }
        Ok(maps)
    }
}

fn unknown(scene: &Scene, name: &str) -> Error {
    let names: Vec<_> =
        scene.clouds.iter().enumerate().map(|(i, cloud)| format!("{i} `{}`", cloud.name)).collect();
    Error::Argument(format!("there is no cloud `{name}`; the scene has {}", names.join(", ")))
}

/// Light of a pixel over that of a white sheet under the same light, 1/pi.
fn reflectance([r, g, b, alpha]: [f32; 4]) -> f32 {
    if alpha > 1e-3 { std::f32::consts::PI * (r + g + b) / (3.0 * alpha) } else { 0.0 }
}
