//! What an artist describes: clouds, light, air, camera. Plain validated data.
//!
//! Metres, y up, right-handed: +x is east, -z is north. Colours are linear RGB.

mod block;
mod camera;
mod cloud;
mod cover_map;
mod dice;
mod distance;
mod droplets;
mod edge;
mod ellipsoid;
mod evaporation;
mod explain;
mod file;
mod flow;
mod grid;
mod ground;
mod ground_picture;
mod growth;
mod layer;
mod life;
mod light;
mod mesh;
mod moment;
mod movement;
mod noise;
mod particles;
mod pixels;
mod presets;
mod sequence;
mod sky;
mod steps;
mod sun;
mod surface;
pub mod timeline;
mod tone;
mod validate;
mod volume;
mod whole;
mod wind;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(crate) use block::voxel;
pub use block::{BLOCK_EDGE, BLOCK_VOXELS, Block};
pub use camera::{Aperture, Camera, Projection};
pub use cloud::Cloud;
pub use cover_map::{Cover, CoverMap};
pub(crate) use dice::Dice;
pub use droplets::{Droplets, Phase};
pub use edge::Edge;
pub use ellipsoid::Ellipsoid;
pub use evaporation::Evaporation;
pub use file::schema;
#[cfg_attr(not(feature = "import"), allow(unused_imports, reason = "readers make it"))]
pub(crate) use flow::Velocity;
pub use grid::{Grid, MOST_ALONG};
pub use ground::{Ground, GroundKind, Land, Water};
pub use ground_picture::{GroundColors, GroundPicture};
pub use growth::{Growth, GrowthKind};
pub use layer::Layer;
pub use life::Life;
pub use light::{Light, LightSource, Lightning, MAX_LIGHTS};
pub use mesh::{Mesh, ReadMesh};
pub use movement::Movement;
pub use noise::{Noise, Renewed};
pub use particles::{Habit, Species};
#[cfg(feature = "measure")]
pub(crate) use presets::smooth::Smooth;
pub use presets::{Heaps, Preset};
pub use sequence::{Between, Beyond, Sequence};
pub use sky::{Atmosphere, Sky};
pub use sun::{Sun, SunPosition};
pub use surface::Surface;
pub use timeline::Timeline;
pub use tone::{Tone, ToneCurve};
pub use volume::{Brick, Endian, Opened, StepRange, Up, Volume};
pub use wind::Wind;

use crate::Result;
use validate::{At, Limits};
use whole::whole;

/// The version of the scene format that this program reads and writes.
pub const FORMAT: u32 = 1;

/// Most clouds in a scene.
pub const MAX_CLOUDS: usize = 4096;

/// Most ellipsoids in a scene, all clouds together.
pub const MAX_ELLIPSOIDS: usize = 65_536;

const TIME: Limits = Limits::new(-1e7, 1e7, "seconds");
const EXPOSURE: Limits = Limits::new(-20.0, 20.0, "stops");

/// An axis-aligned box: its least and its greatest corner, metres.
pub type Bounds = (DVec3, DVec3);

/// A sky with clouds. Everything may be left out; what is left out has a default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Scene {
    /// Where an editor of text finds this schema, for people; it changes nothing in the picture.
    #[serde(rename = "$schema", skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// Version of the scene format: 1.
    #[serde(deserialize_with = "whole")]
    #[schemars(with = "u32", range(min = FORMAT, max = FORMAT))]
    pub format: u32,
    /// A name for people; it changes nothing in the picture.
    pub name: String,
    /// The clouds, at most 4096; none is an empty sky.
    #[schemars(length(max = MAX_CLOUDS))]
    pub clouds: Vec<Cloud>,
    /// The noise that shapes the boundaries of clouds that have none of their own.
    pub noise: Noise,
    /// The light of the sun.
    pub sun: Sun,
    /// Lights beside the sun, at most 4.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = MAX_LIGHTS))]
    pub lights: Vec<Light>,
    /// The light of the sky and what is seen behind the clouds.
    pub sky: Sky,
    /// The land below.
    pub ground: Ground,
    /// The wind that carries the clouds.
    pub wind: Wind,
    /// Seconds since the scene's start, -10000000 to 10000000: the moment that a picture shows.
    /// The wind has blown that long, and the timeline is that far.
    #[schemars(range(min = TIME.min, max = TIME.max), extend("unit" = TIME.unit))]
    pub time: f64,
    /// Where the picture is taken from. Left out, it is taken from the ground in the
    /// south, filled with all clouds that are not hidden, as they are at time 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
    /// Brightness of the picture in stops, -20 to 20: each stop doubles it. With auto exposure it is
    /// what the picture shall be brighter than metered.
    #[schemars(range(min = EXPOSURE.min, max = EXPOSURE.max), extend("unit" = EXPOSURE.unit))]
    pub exposure: f64,
    /// Whether pictures for screens are exposed by the light of their clouds. Left out, they are where
    /// `exposure` is 0 and has no track: who gives an exposure of their own means it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub auto_exposure: Option<bool>,
    /// How light becomes what a screen shows: "photo", "natural", "filmic", "soft" or "linear"; "photo" where left out.
    #[serde(skip_serializing_if = "is_default")]
    pub tone_curve: ToneCurve,
    /// How the scene changes over time; left out where nothing but the wind moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timeline: Option<Timeline>,
}

fn is_default(curve: &ToneCurve) -> bool {
    *curve == ToneCurve::default()
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            schema: None,
            format: FORMAT,
            name: String::new(),
            clouds: Vec::new(),
            noise: Noise::default(),
            sun: Sun::default(),
            lights: Vec::new(),
            sky: Sky::default(),
            ground: Ground::default(),
            wind: Wind::default(),
            time: 0.0,
            camera: None,
            exposure: 0.0,
            auto_exposure: None,
            tone_curve: ToneCurve::default(),
            timeline: None,
        }
    }
}

impl Scene {
    /// Axis-aligned bounds of all ellipsoids and meshes (exact) and volumes at time 0, metres; `None` without any. Layers
    /// have none, and files that were not read.
    pub fn bounds(&self) -> Option<Bounds> {
        self.clouds.iter().filter_map(Cloud::bounds).reduce(union)
    }

    /// The same of those that pictures show.
    pub fn visible_bounds(&self) -> Option<Bounds> {
        self.clouds.iter().filter_map(Cloud::visible_bounds).reduce(union)
    }

    /// Size of the largest billows of all clouds that pictures show, m; 0 without clouds.
    pub fn largest_billows(&self) -> f64 {
        let size = |cloud: &Cloud| {
            Some(cloud.noise.as_ref().unwrap_or(&self.noise).scale_in(cloud.visible_bounds()?))
        };
        self.clouds.iter().filter_map(size).fold(0.0, f64::max)
    }

    /// The layers that are not hidden.
    pub fn layers(&self) -> impl Iterator<Item = &Layer> {
        self.clouds.iter().filter(|cloud| !cloud.hidden).filter_map(|cloud| cloud.layer.as_ref())
    }

    /// The volumes of all clouds.
    pub fn volumes_mut(&mut self) -> impl Iterator<Item = &mut Volume> {
        self.clouds.iter_mut().filter_map(|cloud| cloud.volume.as_mut())
    }

    /// The meshes of all clouds.
    pub fn meshes_mut(&mut self) -> impl Iterator<Item = &mut Mesh> {
        self.clouds.iter_mut().filter_map(|cloud| cloud.mesh.as_mut())
    }

    /// Everything that shapes boundaries: the scene's noise, and the clouds' own.
    pub fn noises_mut(&mut self) -> impl Iterator<Item = &mut Noise> {
        [&mut self.noise].into_iter().chain(self.clouds.iter_mut().filter_map(|cloud| cloud.noise.as_mut()))
    }

    /// The scene's camera, or one that stands on the ground south of the clouds and
    /// frames all of them that are not hidden in a 16:9 picture, as they are at time 0.
    pub fn camera(&self) -> Camera {
        if let Some(camera) = &self.camera {
            return camera.clone();
        }
        match self.visible_bounds().or_else(|| self.bounds()) {
            Some(bounds) => Camera::framing(bounds, self.ground.altitude),
            None => {
                let mut camera = Camera::default();
                camera.position.y += self.ground.altitude;
                camera.target.y += self.ground.altitude;
                camera
            }
        }
    }

    /// Whether its pictures are exposed by the light of their clouds: `auto_exposure`, or what is meant
    /// where that is left out.
    pub fn is_metered(&self) -> bool {
        let is_keyed = || self.timeline.as_ref().is_some_and(|timeline| timeline.curve("exposure").is_some());
        self.auto_exposure.unwrap_or_else(|| self.exposure == 0.0 && !is_keyed())
    }

    /// How its light becomes a picture for screens, by its own exposure alone:
    /// [`Renderer::meter`](crate::render::Renderer::meter) tells what auto exposure adds to that.
    pub fn tone(&self) -> Tone {
        Tone { stops: self.exposure, curve: self.tone_curve }
    }

    /// Checks every value of the scene and tells the first that is wrong.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) with the JSON path, the value and what was expected.
    pub fn validate(&self) -> Result<()> {
        self.check_moment()?;
        match &self.timeline {
            Some(timeline) => timeline.check(self, At::Root.field("timeline")),
            None => Ok(()),
        }
    }

    /// Checks everything but the timeline.
    fn check_moment(&self) -> Result<()> {
        let at = At::Root;
        self.check_format(at)?;
        self.check_clouds(at.field("clouds"))?;
        self.check_world()
    }

    /// Checks what is no cloud.
    fn check_world(&self) -> Result<()> {
        let at = At::Root;
        self.noise.check(at.field("noise"))?;
        self.sun.check(at.field("sun"))?;
        light::check(&self.lights, at.field("lights"))?;
        self.sky.check(at.field("sky"))?;
        self.ground.check(at.field("ground"))?;
        self.wind.check(at.field("wind"))?;
        at.field("time").number(self.time, TIME)?;
        if let Some(camera) = &self.camera {
            camera.check(at.field("camera"))?;
        }
        at.field("exposure").number(self.exposure, EXPOSURE)
    }

    fn check_format(&self, at: At) -> Result<()> {
        if self.format == FORMAT {
            return Ok(());
        }
        Err(at.field("format").problem(wrong_format(&self.format)))
    }

    fn check_clouds(&self, at: At) -> Result<()> {
        let clouds = self.clouds.len();
        if clouds > MAX_CLOUDS {
            return Err(at.problem(format!("{clouds} clouds are too many: expected at most {MAX_CLOUDS}")));
        }
        let ellipsoids: usize = self.clouds.iter().map(|cloud| cloud.ellipsoids.len()).sum();
        if ellipsoids > MAX_ELLIPSOIDS {
            return Err(at.problem(format!(
                "{ellipsoids} ellipsoids are too many: expected at most {MAX_ELLIPSOIDS} in all clouds together"
            )));
        }
        for (i, cloud) in self.clouds.iter().enumerate() {
            let at = at.index(i);
            cloud.check(at)?;
            if let Some(life) = &cloud.life {
                life.check_span(self.period(), at.field("life"))?;
            }
        }
        Ok(())
    }
}

/// What is wrong with a file of format `found`.
fn wrong_format(found: &impl std::fmt::Display) -> String {
    format!("the file has format {found}, but this program reads format {FORMAT}")
}

/// The smallest box around two.
fn union(a: Bounds, b: Bounds) -> Bounds {
    (a.0.min(b.0), a.1.max(b.1))
}
