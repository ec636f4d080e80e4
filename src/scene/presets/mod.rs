//! Clouds to start from, each with a camera and a sun that suit it.

mod deck;
mod drift;
mod field;
mod grow;
mod heap;
mod layer;
mod shower;
#[cfg(feature = "measure")]
pub(crate) mod smooth;
mod weather;

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::dice::Dice;
use super::explain::nearest;
use super::{
    Camera, Cloud, Edge, Ellipsoid, Ground, GroundKind, Growth, GrowthKind, Land, Noise, Projection, Scene,
    Sun, SunPosition, Water, Wind,
};
use crate::{Error, Result};
pub use grow::Heaps;
use heap::tenths;

/// Vertical field of view of the presets' cameras, degrees.
const FIELD_OF_VIEW: f64 = 40.0;

/// A kind of cloud, grown by chance from a seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Preset {
    /// Fair-weather cumulus, 200 to 500 m wide, wider than tall.
    Humilis,
    /// Cumulus about as tall as wide, 800 m.
    Mediocris,
    /// Towering cumulus of 2 to 3 km with sharp cauliflower turrets.
    Congestus,
    /// Small torn shreds.
    Fractus,
    /// Patches of stratocumulus in closed cells: flat, with narrow gaps.
    ClosedCells,
    /// A layer of stratocumulus in open cells: rings around clear air.
    OpenCells,
    /// A thunderstorm of 10 km: tower, overshooting top, anvil with fibres, mammatus.
    Cumulonimbus,
    /// A towering cumulus that leans with the shear of the wind.
    Tower,
    /// A sky of a hundred cumuli and more, in streets along the wind, with a large one in front.
    Field,
    /// A thin sheet from above, the sun behind the camera: glory and fogbow.
    Glory,
    /// One homogeneous sphere, which no seed changes.
    Sphere,
    /// Eight ellipsoids, 400 m wide, with a boundary of 62 m, after Kol (2013); the
    /// seed changes only the noise.
    Kol,
    /// A loop of ten seconds: five fair-weather cumuli that form, drift and dissolve.
    Drift,
    /// A low grey layer from horizon to horizon.
    Stratus,
    /// A layer of stratocumulus to the horizon: heaps side by side with gaps.
    Stratocumulus,
    /// A layer of altocumulus to the horizon: small heaps side by side.
    Altocumulus,
    /// A mackerel sky: ripples of thin cloud in rows.
    Mackerel,
    /// A veil of ice high up, with a halo around the sun.
    Cirrostratus,
    /// Streaks of ice along the shear of the wind.
    Cirrus,
    /// A shower under a towering cumulus, the sun behind the camera: a rainbow.
    Shower,
}

impl Preset {
    /// All presets, in the order of their documentation.
    pub const ALL: [Self; 20] = [
        Self::Humilis,
        Self::Mediocris,
        Self::Congestus,
        Self::Fractus,
        Self::ClosedCells,
        Self::OpenCells,
        Self::Cumulonimbus,
        Self::Tower,
        Self::Field,
        Self::Glory,
        Self::Sphere,
        Self::Kol,
        Self::Drift,
        Self::Stratus,
        Self::Stratocumulus,
        Self::Altocumulus,
        Self::Mackerel,
        Self::Cirrostratus,
        Self::Cirrus,
        Self::Shower,
    ];

    /// The name in kebab-case, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Humilis => "humilis",
            Self::Mediocris => "mediocris",
            Self::Congestus => "congestus",
            Self::Fractus => "fractus",
            Self::ClosedCells => "closed-cells",
            Self::OpenCells => "open-cells",
            Self::Cumulonimbus => "cumulonimbus",
            Self::Tower => "tower",
            Self::Field => "field",
            Self::Glory => "glory",
            Self::Sphere => "sphere",
            Self::Kol => "kol",
            Self::Drift => "drift",
            Self::Stratus => "stratus",
            Self::Stratocumulus => "stratocumulus",
            Self::Altocumulus => "altocumulus",
            Self::Mackerel => "mackerel",
            Self::Cirrostratus => "cirrostratus",
            Self::Cirrus => "cirrus",
            Self::Shower => "shower",
        }
    }

    /// The scene that grows from `seed`: the same on every platform and in every run.
    pub fn scene(self, seed: u64) -> Scene {
        let dice = &mut Dice::new(seed);
        let short = (seed ^ (seed >> 32)) as u32;
        let clouds = self.clouds(dice, short);
        let mut scene = Scene { name: self.name().to_owned(), clouds, ..Scene::default() };
        scene.noise = Noise { seed: short, scale: self.noise_scale(), ..Noise::default() };
        scene.sun.position = SunPosition::Angles { azimuth_deg: 252.0, elevation_deg: 30.0 };
        scene.wind.velocity = DVec3::new(4.0, 0.0, 0.0);
        scene.ground = self.ground();
        match self {
            Self::Glory => aim_at_glory(&mut scene),
            Self::ClosedCells => look_along_the_field(&mut scene),
            Self::OpenCells => look_down_on_cells(&mut scene),
            Self::Field => look_over_the_land(&mut scene),
            Self::Sphere => scene.wind = Wind::default(),
            Self::Drift => drift::set_in_motion(&mut scene),
            Self::Shower => shower::look_at_the_bow(&mut scene),
            Self::Cirrostratus => deck::look_at_the_halo(&mut scene),
            _ if scene.layers().next().is_some() => deck::look_up(&mut scene),
            _ => {}
        }
        if scene.camera.is_none() {
            scene.camera = scene.bounds().map(|bounds| portrait(bounds, scene.ground.altitude));
        }
        if self == Self::Cumulonimbus {
            look_from_afar(&mut scene);
        }
        scene
    }

    /// What it stands over: cells and sheets over the sea, where they are at home; what shows light alone over even ground.
    fn ground(self) -> Ground {
        let sea = [0.05, 0.06, 0.08];
        match self {
            Self::ClosedCells | Self::OpenCells | Self::Glory => {
                Ground { albedo: sea, kind: GroundKind::Water(Water::default()), ..Ground::default() }
            }
            Self::Sphere | Self::Kol => Ground::default(),
            _ => Ground { kind: GroundKind::Land(Land::default()), ..Ground::default() },
        }
    }

    fn clouds(self, dice: &mut Dice, seed: u32) -> Vec<Cloud> {
        let grown = |kind| vec![weather::cloud(self.name(), Growth::new(kind, seed))];
        match self {
            Self::Humilis => grown(GrowthKind::Humilis),
            Self::Mediocris => grown(GrowthKind::Mediocris),
            Self::Congestus => grown(GrowthKind::Congestus),
            Self::Fractus => grown(GrowthKind::Fractus),
            Self::ClosedCells => grown(GrowthKind::ClosedCells),
            Self::OpenCells => grown(GrowthKind::OpenCells),
            Self::Cumulonimbus => grown(GrowthKind::Cumulonimbus),
            Self::Tower => vec![weather::cloud(self.name(), tower(seed))],
            Self::Field => field::clouds(dice, seed),
            Self::Glory => vec![layer::sheet(dice)],
            Self::Sphere => vec![sphere()],
            Self::Kol => vec![kol()],
            Self::Drift => drift::clouds(dice),
            Self::Shower => shower::clouds(dice, seed),
            Self::Stratus
            | Self::Stratocumulus
            | Self::Altocumulus
            | Self::Mackerel
            | Self::Cirrostratus
            | Self::Cirrus => deck::cloud(self, seed).into_iter().collect(),
        }
    }

    /// Size of the largest billows of the scene's noise, metres, where clouds have none of their own.
    fn noise_scale(self) -> Option<f64> {
        match self {
            Self::Glory => Some(60.0),
            Self::Drift => Some(45.0),
            Self::Sphere | Self::Kol => Some(80.0),
            _ => None,
        }
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Preset {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if let Some(preset) = Self::ALL.into_iter().find(|preset| preset.name() == text) {
            return Ok(preset);
        }
        let names = Self::ALL.map(Self::name);
        let hint = match nearest(text, &names) {
            Some(name) => format!("; did you mean `{name}`?"),
            None => ".".to_owned(),
        };
        Err(Error::Argument(format!("there is no preset `{text}`{hint} Known: {}", names.join(", "))))
    }
}

/// A homogeneous sphere of 100 m radius, optical thickness 18 through the middle.
fn sphere() -> Cloud {
    Cloud {
        name: "sphere".to_owned(),
        ellipsoids: vec![Ellipsoid::new(DVec3::new(0.0, 1000.0, 0.0), DVec3::splat(100.0))],
        edge: Edge { boundary: 0.0, wispiness: 0.0 },
        ..Cloud::default()
    }
}

/// Kol's cumulus: he gives number, width and boundary [Kol 4, Fig. 4.3], not the
/// places; these are ours. His edges are all wispy.
fn kol() -> Cloud {
    let lumps = [
        ([0.0, 1075.0, 0.0], [110.0, 75.0, 95.0]),
        ([-105.0, 1055.0, 10.0], [95.0, 55.0, 80.0]),
        ([100.0, 1058.0, -15.0], [95.0, 58.0, 85.0]),
        ([-40.0, 1060.0, 70.0], [90.0, 60.0, 75.0]),
        ([50.0, 1058.0, -65.0], [90.0, 58.0, 75.0]),
        ([-35.0, 1135.0, -10.0], [80.0, 65.0, 75.0]),
        ([55.0, 1120.0, 15.0], [75.0, 60.0, 70.0]),
        ([5.0, 1170.0, 5.0], [60.0, 55.0, 60.0]),
    ];
    Cloud {
        name: "kol".to_owned(),
        ellipsoids: lumps.map(|(center, radii)| Ellipsoid::new(center.into(), radii.into())).to_vec(),
        edge: Edge { boundary: 62.0, wispiness: 0.75 },
        ..Cloud::default()
    }
}

/// A camera in the south, below the base, that fills the picture with `bounds` (metres) above a low horizon; never
/// under `ground`.
fn portrait((min, max): super::Bounds, ground: f64) -> Camera {
    // Slopes (tangents of elevations) in a picture whose horizon is a sixth of its height from its foot.
    const MIDDLE: f64 = 0.25;
    const BASE: f64 = 0.09;
    const TOP: f64 = 0.56;
    // Share of the width that the cloud may fill: of 16:9, twice tan(20 degrees) high.
    const WIDE: f64 = 0.68 * 0.728 * 16.0 / 9.0;
    let (middle, size) = (0.5 * (min + max), max - min);
    let near = (size.y / (TOP - BASE)).max(size.x / WIDE);
    let distance = near + 0.2 * size.z;
    let altitude = (min.y - BASE * near).max(ground + 1.7);
    let eye = middle.with_y(altitude) + DVec3::Z * distance;
    camera(eye, eye + distance * DVec3::new(0.0, MIDDLE, -1.0))
}

/// Narrow and tall, under strong shear.
fn tower(seed: u32) -> Growth {
    Growth {
        width: 1500.0,
        height: 2500.0,
        lean: 0.3,
        coverage: 0.35,
        age: 0.0,
        ..Growth::new(GrowthKind::Congestus, seed)
    }
}

/// From so far that the near rim of an anvil does not hide what is above it.
fn look_from_afar(scene: &mut Scene) {
    const FARTHER: f64 = 1.8;
    let Some(camera) = &mut scene.camera else { return };
    let way = (camera.target - camera.position).with_y(0.0);
    camera.position -= (FARTHER - 1.0) * way;
    camera.projection = Projection::Perspective { vertical_fov_deg: 20.0 };
}

/// From a hill, far over the land.
fn look_over_the_land(scene: &mut Scene) {
    let eye = DVec3::new(0.0, 60.0, 0.0);
    scene.wind.velocity = DVec3::new(1.7, 0.0, -5.8);
    scene.camera = Some(camera(eye, eye + DVec3::new(0.0, 235.0, -1000.0)));
}

/// From an aeroplane above the layer, the horizon high in the picture.
fn look_down_on_cells(scene: &mut Scene) {
    let eye = DVec3::new(0.0, 2900.0, 4200.0);
    scene.camera = Some(camera(eye, eye + DVec3::new(0.0, -260.0, -1000.0)));
}

/// Under the near edge of the field, so that it runs to the horizon.
fn look_along_the_field(scene: &mut Scene) {
    let eye = DVec3::new(0.0, 500.0, 3600.0);
    scene.camera = Some(camera(eye, eye + DVec3::new(0.0, 210.0, -1000.0)));
}

/// From above the sheet towards the point opposite the sun, wide enough for the
/// fogbow at 40 degrees. The direction is exact: no sine rounds it.
fn aim_at_glory(scene: &mut Scene) {
    let to_sun = DVec3::new(0.0, 0.8, 0.6);
    let eye = DVec3::new(0.0, 1500.0, 0.0);
    scene.sun = Sun { position: SunPosition::Direction(to_sun), ..Sun::default() };
    // Thin and of large droplets: little light scattered more often hides the rings.
    for sheet in &mut scene.clouds {
        sheet.droplets.concentration_per_cm3 = 100.0;
        sheet.droplets.effective_radius_um = 8.0;
    }
    scene.camera = Some(Camera {
        projection: Projection::Perspective { vertical_fov_deg: 90.0 },
        ..camera(eye, eye - 1000.0 * to_sun)
    });
}

fn camera(position: DVec3, target: DVec3) -> Camera {
    Camera {
        position: tenths(position),
        target: tenths(target),
        roll_deg: 0.0,
        projection: Projection::Perspective { vertical_fov_deg: FIELD_OF_VIEW },
        ..Camera::default()
    }
}
