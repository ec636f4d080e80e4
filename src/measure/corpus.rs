//! The pictures that models are measured on.
//!
//! Every one fills most of the frame with cloud, keeps the sun's disc out of it, and has its
//! sun where the name says: `front` behind the camera, `back` behind the cloud, `side` at a
//! right angle to the line of sight.

use std::fmt;

use glam::{DVec3, dvec3};

use crate::scene::{
    Atmosphere, Camera, Cloud, Edge, Ellipsoid, Ground, Noise, Preset, Projection, Scene, Sky, Smooth, Sun,
    SunPosition,
};

/// Width and height of every picture, pixels.
pub const SIZE: [u32; 2] = [96, 54];

/// What a picture may be used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Set {
    /// Numbers of a model may be fitted to it.
    Fit,
    /// Nothing is ever tuned on it: it tells what a model is worth elsewhere.
    HeldOut,
}

impl fmt::Display for Set {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Fit => "fit",
            Self::HeldOut => "held-out",
        })
    }
}

/// A named picture.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The name, which is its reference's file name too.
    pub name: &'static str,
    /// What it may be used for.
    pub set: Set,
    make: fn() -> Scene,
}

impl Entry {
    /// The scene, the same in every run, in air that is almost pure and over even ground.
    pub fn scene(&self) -> Scene {
        let sky = Sky::Atmosphere(Atmosphere { haze: 1.0, ..Atmosphere::default() });
        let ground = Ground::default();
        Scene { name: self.name.to_owned(), sky, ground, ..(self.make)() }
    }
}

const fn fit(name: &'static str, make: fn() -> Scene) -> Entry {
    Entry { name, set: Set::Fit, make }
}

const fn held_out(name: &'static str, make: fn() -> Scene) -> Entry {
    Entry { name, set: Set::HeldOut, make }
}

/// All pictures. Those held out are of other seeds and, where they can be, of other kinds.
pub const CORPUS: [Entry; 34] = [
    fit("humilis-front", || portrait(Smooth::Humilis.scene(1), FRONT, 40.0)),
    fit("humilis-back", || portrait(Smooth::Humilis.scene(1), BACK, 25.0)),
    fit("mediocris-side", || portrait(Smooth::Mediocris.scene(1), EAST, 25.0)),
    fit("congestus-front", || portrait(Smooth::Congestus.scene(1), FRONT, 40.0)),
    fit("congestus-back", || portrait(Smooth::Congestus.scene(1), BACK, 25.0)),
    fit("fractus-side", || portrait(Smooth::Fractus.scene(1), WEST, 30.0)),
    fit("sphere-side", || portrait(Preset::Sphere.scene(1), EAST, 30.0)),
    fit("kol-front", || portrait(Preset::Kol.scene(1), FRONT, 40.0)),
    fit("kol-above", || seen(sunlit(Preset::Kol.scene(1), 230.0, 40.0), dvec3(0.0, 0.77, 0.64))),
    fit("stratocumulus-below", stratocumulus_below),
    fit("sheet-back", sheet_back),
    fit("kol-thick", || seen(sunlit(scaled(Preset::Kol.scene(1), 4.0), 120.0, 65.0), dvec3(0.0, -0.2, 1.0))),
    fit("grown-mediocris-front", || portrait(Preset::Mediocris.scene(1), FRONT, 40.0)),
    fit("grown-congestus-side", || portrait(scaled(Preset::Congestus.scene(1), 0.5), EAST, 25.0)),
    held_out("humilis-side", || portrait(Smooth::Humilis.scene(12), WEST, 25.0)),
    held_out("mediocris-front", || portrait(Smooth::Mediocris.scene(12), 160.0, 40.0)),
    held_out("mediocris-back", || portrait(Smooth::Mediocris.scene(12), 340.0, 25.0)),
    held_out("congestus-side", || portrait(Smooth::Congestus.scene(12), EAST, 6.0)),
    held_out("cumulonimbus-front", || portrait(cumulonimbus(), FRONT, 40.0)),
    held_out("cumulonimbus-back", || portrait(cumulonimbus(), BACK, 25.0)),
    held_out("fractus-back", || portrait(Smooth::Fractus.scene(12), 345.0, 25.0)),
    held_out("stratocumulus-above", stratocumulus_above),
    held_out("two-spheres", two_spheres),
    held_out("concavity", concavity),
    held_out("inside", inside),
    held_out("thin", thin),
    held_out("humilis-sunset", || portrait(Smooth::Humilis.scene(13), 245.0, 3.0)),
    held_out("wisps", wisps),
    held_out("glory", glory),
    held_out("grown-humilis-side", || portrait(Preset::Humilis.scene(12), WEST, 30.0)),
    held_out("grown-mediocris-back", || portrait(Preset::Mediocris.scene(12), BACK, 25.0)),
    held_out("grown-congestus-low", || portrait(scaled(Preset::Congestus.scene(12), 0.5), 250.0, 5.0)),
    held_out("grown-tower-front", || portrait(scaled(Preset::Tower.scene(12), 0.25), 160.0, 35.0)),
    held_out("facing", facing),
];

/// Compass directions of the sun for a camera that looks north, degrees; a little off the line
/// of sight, so that shadows show.
const FRONT: f64 = 200.0;
const BACK: f64 = 15.0;
const EAST: f64 = 90.0;
const WEST: f64 = 270.0;

/// Seen from the south and a little below.
fn portrait(scene: Scene, azimuth_deg: f64, elevation_deg: f64) -> Scene {
    seen(sunlit(scene, azimuth_deg, elevation_deg), dvec3(0.0, -0.14, 1.0))
}

fn sunlit(mut scene: Scene, azimuth_deg: f64, elevation_deg: f64) -> Scene {
    scene.sun = Sun { position: SunPosition::Angles { azimuth_deg, elevation_deg }, ..Sun::default() };
    scene
}

/// Looks at the clouds from the direction `to_camera`, with a lens that fills the picture with
/// them: their outlines touch its edge.
fn seen(mut scene: Scene, to_camera: DVec3) -> Scene {
    let Some((low, high)) = scene.bounds() else { return scene };
    let (middle, to_camera) = (0.5 * (low + high), to_camera.normalize());
    // From so far away, perspective is slight and the sun's disc stays out of the picture.
    let distance = 2.0 * (high - low).length();
    let across = DVec3::Y.cross(to_camera).normalize();
    let up = to_camera.cross(across);
    let (left, right) = extent(&scene, middle, across);
    let (bottom, top) = extent(&scene, middle, up);
    let target = middle + 0.5 * ((left + right) * across + (bottom + top) * up);
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let half_height = 0.5 * (top - bottom).max((right - left) / aspect);
    scene.camera = Some(Camera {
        position: target + distance * to_camera,
        target,
        roll_deg: 0.0,
        projection: Projection::Perspective {
            vertical_fov_deg: 2.0 * (half_height / distance).atan().to_degrees(),
        },
        ..Camera::default()
    });
    scene
}

/// Least and greatest coordinate of the clouds along the unit vector `axis`, from `middle`, m.
fn extent(scene: &Scene, middle: DVec3, axis: DVec3) -> (f64, f64) {
    let ends = scene.clouds.iter().flat_map(|cloud| &cloud.ellipsoids).map(|ellipsoid| {
        let place = (ellipsoid.center - middle).dot(axis);
        let support = (ellipsoid.radii * (ellipsoid.orientation.inverse() * axis)).length();
        (place - support, place + support)
    });
    ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
}

fn looking(mut scene: Scene, position: DVec3, forward: DVec3, vertical_fov_deg: f64) -> Scene {
    scene.camera = Some(Camera {
        position,
        target: position + 1000.0 * forward.normalize(),
        roll_deg: 0.0,
        projection: Projection::Perspective { vertical_fov_deg },
        ..Camera::default()
    });
    scene
}

/// The same cloud larger or smaller about its base, with the same droplets: `factor` times the
/// optical depth.
fn scaled(mut scene: Scene, factor: f64) -> Scene {
    let Some((low, high)) = scene.bounds() else { return scene };
    let base = (0.5 * (low + high)).with_y(low.y);
    for cloud in &mut scene.clouds {
        // What it grew is no longer what it would grow.
        cloud.growth = None;
        cloud.edge.boundary *= factor;
        if let Some(noise) = &mut cloud.noise {
            noise.scale = noise.scale.map(|scale| factor * scale);
        }
        for ellipsoid in &mut cloud.ellipsoids {
            ellipsoid.center = base + factor * (ellipsoid.center - base);
            ellipsoid.radii *= factor;
            if let Some(edge) = &mut ellipsoid.edge {
                edge.boundary *= factor;
            }
        }
    }
    scene.noise.scale = scene.noise.scale.map(|scale| factor * scale);
    scene
}

/// A cloud of its own, with the default droplets.
fn cloud(ellipsoids: Vec<Ellipsoid>, boundary: f64, wispiness: f64) -> Cloud {
    Cloud { ellipsoids, edge: Edge { boundary, wispiness }, ..Cloud::default() }
}

fn of(clouds: Vec<Cloud>, noise_scale: f64, seed: u32) -> Scene {
    Scene { clouds, noise: Noise { seed, scale: Some(noise_scale), ..Noise::default() }, ..Scene::default() }
}

fn ball(center: DVec3, radius: f64) -> Ellipsoid {
    Ellipsoid::new(center, DVec3::splat(radius))
}

/// A quarter of the preset in size, 2 km tall: at full size, through optical depths of
/// hundreds, no reference would converge.
fn cumulonimbus() -> Scene {
    scaled(Smooth::Cumulonimbus.scene(12), 0.25)
}

/// Grey bases from between the rolls, the sun at the side.
fn stratocumulus_below() -> Scene {
    let scene = sunlit(Smooth::Stratocumulus.scene(1), EAST, 35.0);
    looking(scene, dvec3(0.0, 700.0, 1500.0), dvec3(0.0, 0.5, -0.85), 45.0)
}

/// Tops under a low sun at the side.
fn stratocumulus_above() -> Scene {
    let scene = sunlit(Smooth::Stratocumulus.scene(12), 250.0, 12.0);
    looking(scene, dvec3(100.0, 2300.0, 1300.0), dvec3(0.0, -0.7, -0.7), 45.0)
}

/// A thin sheet, through which the sun shines at 25 to 50 degrees from the line of sight.
fn sheet_back() -> Scene {
    let sheet = Ellipsoid::new(dvec3(0.0, 1000.0, 0.0), dvec3(700.0, 28.0, 700.0));
    let scene = of(vec![cloud(vec![sheet], 40.0, 0.9)], 90.0, 1);
    looking(sunlit(scene, 60.0, 50.0), dvec3(0.0, 600.0, 335.0), dvec3(0.0, 0.77, -0.64), 30.0)
}

/// Two clouds; the shadow of one falls on the upper half of the other.
fn two_spheres() -> Scene {
    let clouds = [ball(dvec3(-150.0, 1130.0, 0.0), 90.0), ball(dvec3(110.0, 1000.0, 0.0), 120.0)];
    let scene = of(clouds.map(|sphere| cloud(vec![sphere], 30.0, 0.2)).into(), 60.0, 12);
    portrait(scene, WEST, 20.0)
}

/// Two clouds; the small one turns its dark side to the bright side of the other, which lights it.
fn facing() -> Scene {
    let clouds = [ball(dvec3(-130.0, 1080.0, 0.0), 150.0), ball(dvec3(90.0, 950.0, 0.0), 75.0)];
    let scene = of(clouds.map(|sphere| cloud(vec![sphere], 30.0, 0.2)).into(), 60.0, 13);
    portrait(scene, EAST, 35.0)
}

/// Lumps with a deep crease between them, which the sun behind the camera shines into.
fn concavity() -> Scene {
    let lumps = vec![
        ball(dvec3(-125.0, 1000.0, 40.0), 125.0),
        ball(dvec3(125.0, 1010.0, 30.0), 130.0),
        ball(dvec3(0.0, 1130.0, -80.0), 120.0),
    ];
    portrait(of(vec![cloud(lumps, 35.0, 0.0)], 60.0, 12), 190.0, 30.0)
}

/// From within the boundary, out along it: thin droplets, so that there is something to see.
fn inside() -> Scene {
    let mut scene = sunlit(Smooth::Mediocris.scene(12), 230.0, 40.0);
    scene.clouds[0].droplets.concentration_per_cm3 = 60.0;
    let trunk = &scene.clouds[0].ellipsoids[7];
    let place = trunk.center + 0.55 * trunk.radii.min_element() * DVec3::Z;
    looking(scene, place, dvec3(1.0, 0.0, 0.25), 60.0)
}

/// Of optical depth 1 to 3, the sun at the side.
fn thin() -> Scene {
    let mut scene = Smooth::Humilis.scene(14);
    scene.clouds[0].droplets.concentration_per_cm3 = 100.0;
    portrait(scene, EAST, 30.0)
}

/// Soft all through, without a core.
fn wisps() -> Scene {
    let mut scene = Smooth::Humilis.scene(15);
    for ellipsoid in &mut scene.clouds[0].ellipsoids {
        let boundary = 1.5 * ellipsoid.radii.min_element();
        ellipsoid.edge = Some(Edge { boundary, wispiness: 1.0 });
    }
    portrait(scene, 130.0, 35.0)
}

/// Rings about the point opposite the sun, and the fogbow at the sides.
fn glory() -> Scene {
    let mut scene = Preset::Glory.scene(2);
    if let Some(camera) = &mut scene.camera {
        camera.projection = Projection::Perspective { vertical_fov_deg: 60.0 };
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_valid_and_names_are_unique() {
        for (i, entry) in CORPUS.iter().enumerate() {
            entry.scene().validate().unwrap();
            assert!(CORPUS[..i].iter().all(|other| other.name != entry.name), "{}", entry.name);
        }
    }

    #[test]
    fn scenes_are_read_from_references_as_they_are() {
        for entry in CORPUS {
            let read = Scene::from_json(&entry.scene().to_json()).unwrap();
            assert!(read == entry.scene(), "{}", entry.name);
        }
    }

    #[test]
    fn the_suns_disc_is_in_no_picture() {
        for entry in CORPUS {
            let scene = entry.scene();
            let camera = scene.camera();
            let sun = camera.world_from_camera().inverse() * scene.sun.to_sun();
            let half_height = (0.5 * camera.projection.vertical_fov(16.0 / 9.0).unwrap()).tan();
            // A degree of room for the disc and the pixel.
            let inside = |x: f64, half: f64| x.abs() < -sun.z * half + 0.02;
            let seen = sun.z < 0.0 && inside(sun.x, half_height * 16.0 / 9.0) && inside(sun.y, half_height);
            assert!(!seen, "{}", entry.name);
        }
    }
}
