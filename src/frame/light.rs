//! Lights beside the sun. Each makes a picture of its own, and light adds up: [`Frame::lit_by`] is the frame with one
//! of them in place of the sun.

use glam::{DVec3, Vec3, Vec4};

use super::{CloudFrame, Frame, SkySettings, Sun};
use crate::scene::{self, LightSource, Scene};

/// Sine of an elevation, 18 degrees below the horizon, from which no light reaches what air there is.
const DARK: f64 = -0.309;

/// What a frame is lit by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LitBy {
    /// The sun or another light above the air, which lights air and ground, too.
    Sky,
    /// One that lights clouds alone.
    Key,
    /// A ball that shines to all sides: its centre and radius, m.
    Flash(DVec3, f64),
}

/// A light beside the sun.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrameLight {
    /// What files call it.
    pub name: String,
    /// Which of the scene's lights it is.
    pub number: usize,
    pub by: LitBy,
    /// Where it stands and how bright it is; of a flash the irradiance at its radius.
    pub sun: Sun,
}

impl FrameLight {
    /// Those of a validated scene that shine.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let shines = |light: &scene::Light| !light.hidden && light.source.irradiance() != [0.0; 3];
        let lights = scene.lights.iter().enumerate().filter(|(_, light)| shines(light));
        let lights = lights.map(|(number, light)| {
            let (by, sun) = match &light.source {
                LightSource::Moon(sun) => (LitBy::Sky, Sun::new(sun)),
                LightSource::Key(sun) => (LitBy::Key, Sun::new(sun)),
                LightSource::Lightning(flash) => {
                    let irradiance = Vec3::from(flash.irradiance.map(|x| x as f32));
                    let by = LitBy::Flash(flash.position, flash.radius);
                    (by, Sun { to_sun: DVec3::Y, irradiance, radius: 0.0 })
                }
            };
            Self { name: light.label(number), number, by, sun }
        });
        let has_air = matches!(scene.sky, scene::Sky::Atmosphere(_));
        lights.filter(|light| light.by != LitBy::Sky || !light.sun.has_set(has_air)).collect()
    }
}

impl Sun {
    /// That of a validated scene.
    pub fn new(sun: &scene::Sun) -> Self {
        Self {
            to_sun: sun.to_sun(),
            irradiance: Vec3::from(sun.irradiance.map(|x| x as f32)),
            radius: (0.5 * sun.angular_diameter_deg.to_radians()) as f32,
        }
    }

    /// Whether it stands so low that nothing is lit by it, where there is an atmosphere.
    pub fn has_set(&self, has_air: bool) -> bool {
        has_air && self.to_sun.y < DARK
    }
}

impl Frame {
    /// The lights beside the sun that shine.
    pub(crate) fn lights(&self) -> &[FrameLight] {
        &self.lights
    }

    /// How many of those have discs in the sky.
    pub(crate) fn moons(&self) -> u32 {
        self.lights.iter().filter(|light| light.by == LitBy::Sky).count() as u32
    }

    /// The frame with this light in place of the sun and of the light of the sky.
    pub(crate) fn lit_by(&self, light: &FrameLight) -> Self {
        let irradiance = if light.by == LitBy::Sky { light.sun.irradiance } else { Vec3::ZERO };
        Self {
            sun: light.sun,
            by: light.by,
            sky: self.sky.of_light(&Sun { irradiance, ..light.sun }),
            lights: Vec::new(),
            ..self.clone()
        }
    }

    /// The frame in the light of each of those, with the light's number in the scene.
    pub(crate) fn lit_apart(&self) -> Vec<(usize, Self)> {
        self.lights.iter().map(|light| (light.number, self.lit_by(light))).collect()
    }
}

impl CloudFrame {
    /// The ball that shines in this cloud, in its frame: its centre and radius, m; none where it lies outside of it.
    pub(crate) fn flash(&self, by: LitBy) -> Option<Vec4> {
        let LitBy::Flash(center, radius) = by else { return None };
        let from = center - self.origin;
        let outside = (from.abs() - self.half).max(DVec3::ZERO);
        let touches = self.medium.layer.is_none() && outside.length() < radius;
        touches.then(|| from.as_vec3().extend(radius as f32))
    }
}

impl SkySettings {
    /// The same sky with another light above it and none of its own.
    fn of_light(mut self, sun: &Sun) -> Self {
        self.uniform.atmosphere.sun_radius = sun.radius;
        self.uniform.to_sun = sun.to_sun.as_vec3();
        self.uniform.irradiance = sun.irradiance;
        self.uniform.radiance = Vec3::ZERO;
        self
    }
}
