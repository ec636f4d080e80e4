//! What must hold for every scene, tried on random ones. Each property runs on a few scenes here,
//! always the same; `cargo test --release --test picture random_scenes -- --ignored --nocapture` tries a
//! thousand, or as many as NEPHOS_SCENES says, and prints the worst of each (docs/numerics.md).
//! Scenes that failed once are in `random_scenes.seeds` and are tried first.
#![cfg(feature = "export")]

use crate::common;

use common::{
    picture::{draw, lent},
    random::{Bounds, ENOUGH, check, scenes, white},
};
use glam::{DQuat, DVec3};
use nephos::{
    export::Picture,
    render::{Quality, Transport},
    scene::{Cloud, Ellipsoid, Noise, Phase, Projection, Scene, Sky, SunPosition},
};
use proptest::strategy::Strategy;

const SIZE: [u32; 2] = [32, 18];
/// Scenes of each property in the normal run, and in the long one.
const FEW: u32 = 2;
const MANY: u32 = 1000;

/// How many scenes the long run tries.
fn many() -> u32 {
    std::env::var("NEPHOS_SCENES").ok().and_then(|many| many.parse().ok()).unwrap_or(MANY)
}

/// Coarse light, so that a picture takes a tenth of a second; no grain.
const COARSE: Quality = Quality { light_resolution: 16, light_cells: 8, jitter: false, ..Quality::DRAFT };

fn picture(scene: &Scene, quality: Quality, transport: Transport) -> Picture {
    lent(quality, transport, |renderer| draw(renderer, scene, SIZE, false))
}

/// The same in coarse light, solved for.
fn coarse(scene: &Scene) -> Picture {
    picture(scene, COARSE, Transport::MOMENTS)
}

/// The same of a scene that has a cloud in its picture: every other random one has none, and needs no light for that.
fn lit(scene: &Scene) -> Option<Picture> {
    let opacity = picture(scene, COARSE, Transport::EMITTER);
    opacity.pixels.iter().any(|pixel| pixel[3] != 0.0).then(|| coarse(scene))
}

fn sum_of_squares(values: impl Iterator<Item = f32>) -> f64 {
    values.map(|x| f64::from(x).powi(2)).sum()
}

/// Sum of the squares of light and opacity; none of a picture in which as good as nothing is seen:
/// where their root mean square is below 1 %.
fn seen(picture: &Picture) -> Option<f64> {
    let least = 1e-4 * 4.0 * picture.pixels.len() as f64;
    Some(sum_of_squares(picture.pixels.iter().flatten().copied())).filter(|sum| *sum > least)
}

/// Root mean square difference of light and opacity over that of the first picture.
fn difference(a: &Picture, b: &Picture) -> Option<f64> {
    let pairs = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    Some((sum_of_squares(pairs.map(|(a, b)| a - b)) / seen(a)?).sqrt())
}

/// Noise that moves an edge by many times its own scale leaves spikes, which only steps as short as
/// they are thin find: it is kept within four times its scale.
fn calm_scenes() -> impl Strategy<Value = Scene> {
    scenes().prop_map(without_spikes)
}

fn without_spikes(mut scene: Scene) -> Scene {
    for cloud in &mut scene.clouds {
        let most = 4.0 * billows(&scene.noise, cloud);
        let own = cloud.ellipsoids.iter_mut().filter_map(|ellipsoid| ellipsoid.edge.as_mut());
        own.chain([&mut cloud.edge]).for_each(|edge| edge.boundary = edge.boundary.min(most));
    }
    scene
}

/// Size of the largest billows of a cloud, m.
fn billows(noise: &Noise, cloud: &Cloud) -> f64 {
    cloud.noise.as_ref().unwrap_or(noise).scale_in(cloud.bounds().unwrap())
}

/// Clouds as there are: at most 1000 droplets in a cubic centimetre, edges no thicker than what they are
/// the edges of, and no rougher than the noise is large. Steps are made for these.
fn natural_scenes() -> impl Strategy<Value = Scene> {
    scenes().prop_map(|mut scene| {
        for cloud in &mut scene.clouds {
            let droplets = &mut cloud.droplets.concentration_per_cm3;
            *droplets = droplets.min(1000.0);
            let billows = billows(&scene.noise, cloud);
            for ellipsoid in &mut cloud.ellipsoids {
                let mut edge = ellipsoid.edge.take().unwrap_or_else(|| cloud.edge.clone());
                edge.boundary = edge.boundary.min(billows).min(ellipsoid.radii.min_element());
                ellipsoid.edge = Some(edge);
            }
        }
        scene
    })
}

/// The property that a change of the scene changes the picture by less than `bound`.
fn keeps_the_picture(
    cases: u32,
    scenes: &impl Strategy<Value = Scene>,
    bounds: Bounds,
    change: impl Fn(&mut Scene),
) {
    check(cases, scenes, bounds, |scene| {
        let mut other = scene.clone();
        change(&mut other);
        let picture = lit(&scene)?;
        seen(&picture)?;
        difference(&picture, &coarse(&other))
    });
}

fn light_is_finite_and_bounded(cases: u32) {
    check(cases, &scenes(), Bounds { half: 0.0, most: 0.0, all: 0.0 }, |scene| {
        let good = |pixel: &&[f32; 4]| pixel.iter().all(|c| c.is_finite() && *c >= 0.0) && pixel[3] <= 1.0;
        let picture = coarse(&scene);
        let bad = picture.pixels.len() - picture.pixels.iter().filter(good).count();
        // What is not a number is not seen either.
        if bad > 0 { Some(bad as f64) } else { seen(&picture).map(|_| 0.0) }
    });
}

/// Seen from outside, for light in the middle of a cloud hundreds of mean free paths thick is not
/// found, nor seen by anyone; and so near that clouds are larger than a pixel.
fn a_white_furnace_stays_white(cases: u32) {
    check(cases, &scenes(), Bounds { half: 0.003, most: 0.01, all: 0.02 }, |mut scene| {
        scene.sky = white();
        scene.sun.irradiance = [0.0; 3];
        for cloud in &mut scene.clouds {
            cloud.droplets.albedo = 1.0;
            cloud.droplets.concentration_per_cm3 = cloud.droplets.concentration_per_cm3.min(400.0);
        }
        let camera = scene.camera.as_mut().unwrap();
        let away = (camera.position - camera.target).normalize();
        camera.position = camera.target + 3000.0 * away;
        camera.projection = Projection::Perspective { vertical_fov_deg: 20.0 };
        // Where clouds cross, visibilities are kept in few numbers: tests/picture/mixed.rs has bounds of that.
        let picture = lent(COARSE, Transport::MOMENTS, |renderer| {
            renderer.settings.crossings = false;
            draw(renderer, &scene, SIZE, false)
        });
        let thick = picture.pixels.iter().filter(|pixel| pixel[3] > 0.1);
        thick.map(|pixel| f64::from(pixel[1] / pixel[3] - 1.0).abs()).max_by(f64::total_cmp)
    });
}

/// A conservative half-space that scatters alike in all directions returns at most
/// H(1)^2 / 8 pi = 0.34 of the irradiance as radiance, where sun and eye are at the zenith, and
/// H(1)^2 / 4 pi where the sun grazes it (Chandrasekhar 1950).
fn isotropic_clouds_return_no_more_than_a_half_space(cases: u32) {
    check(cases, &scenes(), Bounds { half: 0.34, most: 0.34, all: 0.68 }, |mut scene| {
        scene.sky = Sky::None;
        scene.clouds.iter_mut().for_each(|cloud| cloud.droplets.phase = Phase::Isotropic);
        let picture = lit(&scene)?;
        seen(&picture)?;
        picture.pixels.iter().map(|pixel| f64::from(pixel[1])).max_by(f64::total_cmp)
    });
}

fn the_order_of_ellipsoids_does_not_matter(cases: u32) {
    keeps_the_picture(cases, &calm_scenes(), Bounds { half: 1e-4, most: 1e-3, all: 0.01 }, |scene| {
        scene.clouds.iter_mut().for_each(|cloud| cloud.ellipsoids.reverse());
    });
}

fn far_from_the_origin_is_like_near_it(cases: u32) {
    keeps_the_picture(cases, &calm_scenes(), Bounds { half: 1e-4, most: 1e-3, all: 0.01 }, |scene| {
        let far = DVec3::new(1e5, 0.0, -7e4);
        scene.clouds.iter_mut().flat_map(|cloud| &mut cloud.ellipsoids).for_each(|e| e.center += far);
        scene.noises_mut().for_each(|noise| noise.offset += far);
        let camera = scene.camera.as_mut().unwrap();
        camera.position += far;
        camera.target += far;
    });
}

/// A second copy of every ellipsoid cuts each ray into more pieces. Depths of both join to a larger one,
/// behind which an edge of any width would be another: clouds are homogeneous, with hard edges, which only
/// maps of light widen to their texels.
fn a_homogeneous_ellipsoid_twice_is_one_once(cases: u32) {
    let hard = calm_scenes().prop_map(|mut scene| {
        for cloud in &mut scene.clouds {
            (cloud.edge.boundary, cloud.stratification, cloud.dilution) = (0.0, 0.0, 0.0);
            cloud.level = None;
            for ellipsoid in &mut cloud.ellipsoids {
                (ellipsoid.edge, ellipsoid.density) = (None, 1.0);
            }
        }
        scene
    });
    keeps_the_picture(cases, &hard, Bounds { half: 1e-3, most: 5e-3, all: 0.02 }, |scene| {
        scene.clouds.iter_mut().for_each(|cloud| cloud.ellipsoids.extend_from_within(..));
    });
}

/// A speck of a twentieth of the radii weighs at most 0.003 of what it is in, and deepens that by a tenth
/// of this; a ray is cut all the same.
fn a_speck_within_an_ellipsoid_changes_nothing(cases: u32) {
    keeps_the_picture(cases, &natural_scenes(), Bounds { half: 0.002, most: 0.15, all: 0.3 }, |scene| {
        for cloud in &mut scene.clouds {
            let speck = |e: &Ellipsoid| Ellipsoid { radii: 0.05 * e.radii, ..e.clone() };
            let within: Vec<_> = cloud.ellipsoids.iter().map(speck).collect();
            cloud.ellipsoids.extend(within);
        }
    });
}

/// A ray may begin its steps anywhere.
fn where_steps_fall_does_not_matter(cases: u32) {
    check(cases, &natural_scenes(), Bounds { half: 0.005, most: 0.25, all: 0.7 }, |scene| {
        samples_differ(&scene, COARSE, Quality { jitter: true, ..COARSE })
    });
}

/// By a quarter, which the directions that light is solved along go with.
fn the_world_has_no_north(cases: u32) {
    turned_about_the_zenith(cases, 90.0, Bounds { half: 1e-3, most: 0.005, all: 0.01 });
}

/// By any angle, which the directions that light is solved along do not go with, nor the boxes of
/// its maps.
fn the_world_has_no_axes(cases: u32) {
    turned_about_the_zenith(cases, 37.0, Bounds { half: 0.02, most: 0.1, all: 0.3 });
}

fn turned_about_the_zenith(cases: u32, angle_deg: f64, bounds: Bounds) {
    keeps_the_picture(cases, &natural_scenes(), bounds, |scene| {
        let turn = DQuat::from_rotation_y(-angle_deg.to_radians());
        // The size of billows that none told is that of a box along the axes.
        for cloud in &mut scene.clouds {
            let size = cloud.noise.as_ref().map(|_| billows(&scene.noise, cloud));
            cloud.noise.iter_mut().for_each(|noise| noise.scale = size);
        }
        for ellipsoid in scene.clouds.iter_mut().flat_map(|cloud| &mut cloud.ellipsoids) {
            ellipsoid.center = turn * ellipsoid.center;
            ellipsoid.orientation = (turn * ellipsoid.orientation).normalize();
        }
        for noise in scene.noises_mut() {
            noise.rotation = (turn * noise.rotation).normalize();
            noise.offset = turn * noise.offset;
        }
        let camera = scene.camera.as_mut().unwrap();
        camera.position = turn * camera.position;
        camera.target = turn * camera.target;
        if let SunPosition::Angles { azimuth_deg, .. } = &mut scene.sun.position {
            *azimuth_deg = (*azimuth_deg + angle_deg) % 360.0;
        }
    });
}

/// How far pictures of two qualities are apart, lit once: the steps along rays are those of any light.
fn samples_differ(scene: &Scene, one: Quality, other: Quality) -> Option<f64> {
    let opacity = picture(scene, one, Transport::EMITTER);
    if opacity.pixels.iter().all(|pixel| pixel[3] == 0.0) {
        return None;
    }
    let [one, other] = [one, other].map(|quality| picture(scene, quality, Transport::SINGLE));
    difference(&other, &one)
}

/// The coarse quality with so many times the samples, and room for them all.
fn finer(times: u16) -> Quality {
    let share = 1.0 / f32::from(times);
    Quality {
        first_step: share * COARSE.first_step,
        longest_step: share * COARSE.longest_step,
        growth: COARSE.growth.powf(share),
        max_steps: 1 << 14,
        ..COARSE
    }
}

fn twice_the_samples_show_the_same(cases: u32) {
    check(cases, &natural_scenes(), Bounds { half: 1e-3, most: 0.15, all: 0.3 }, |scene| {
        samples_differ(&scene, COARSE, finer(2))
    });
}

/// What coarse steps do not find, finer ones do: a scene comes to its picture.
fn sixteen_times_the_samples_are_enough(cases: u32) {
    check(cases, &natural_scenes(), Bounds { half: 1e-4, most: 0.005, all: 0.01 }, |scene| {
        samples_differ(&scene, finer(16), finer(32))
    });
}

fn finer_maps_show_the_same(cases: u32) {
    check(cases, &natural_scenes(), Bounds { half: 0.005, most: 0.15, all: 0.5 }, |scene| {
        samples_differ(&scene, COARSE, Quality { light_resolution: 32, ..COARSE })
    });
}

/// Pictures along a way change evenly: what the middle of three differs by from the mean of its
/// neighbours.
fn nothing_pops(cases: u32, bounds: Bounds, step: impl Fn(&mut Scene, f64)) {
    check(cases, &natural_scenes(), bounds, |scene| {
        let moved = |i: u32| {
            let mut moved = scene.clone();
            step(&mut moved, f64::from(i));
            moved
        };
        let mut pictures = vec![lit(&moved(0))?];
        seen(&pictures[0])?;
        // Two jumps of each in the long run.
        pictures.extend((1..if cases < ENOUGH { 3 } else { 4 }).map(|i| coarse(&moved(i))));
        let jump = |three: &[Picture]| {
            let mut between = three[0].clone();
            for (a, b) in between.pixels.iter_mut().flatten().zip(three[2].pixels.iter().flatten()) {
                *a = 0.5 * (*a + b);
            }
            difference(&three[1], &between)
        };
        pictures.windows(3).map(jump).collect::<Option<Vec<_>>>()?.into_iter().max_by(f64::total_cmp)
    });
}

fn nothing_pops_when_the_sun_moves(cases: u32) {
    nothing_pops(cases, Bounds { half: 0.003, most: 0.03, all: 0.06 }, |scene, i| {
        if let SunPosition::Angles { azimuth_deg, elevation_deg } = &mut scene.sun.position {
            *azimuth_deg += 0.1 * i;
            *elevation_deg += 0.05 * i;
        }
    });
}

fn nothing_pops_when_the_camera_moves(cases: u32) {
    nothing_pops(cases, Bounds { half: 0.003, most: 0.03, all: 0.05 }, |scene, i| {
        let camera = scene.camera.as_mut().unwrap();
        let away = camera.position - camera.target;
        camera.position += 1e-4 * i * away.any_orthogonal_vector();
    });
}

fn nothing_pops_when_an_ellipsoid_moves(cases: u32) {
    nothing_pops(cases, Bounds { half: 0.003, most: 0.02, all: 0.05 }, |scene, i| {
        scene.clouds[0].ellipsoids[0].center.x += 0.02 * i;
    });
}

/// Each property twice: on a few scenes, and on many.
macro_rules! properties {
    ($($name:ident),* $(,)?) => {
        mod few {
            $(#[test] fn $name() { super::$name(super::FEW); })*
        }
        mod many {
            $(#[test] #[ignore = "long"] fn $name() { super::$name(super::many()); })*
        }
    };
}

properties!(
    light_is_finite_and_bounded,
    a_white_furnace_stays_white,
    isotropic_clouds_return_no_more_than_a_half_space,
    the_order_of_ellipsoids_does_not_matter,
    far_from_the_origin_is_like_near_it,
    a_homogeneous_ellipsoid_twice_is_one_once,
    a_speck_within_an_ellipsoid_changes_nothing,
    where_steps_fall_does_not_matter,
    the_world_has_no_north,
    the_world_has_no_axes,
    twice_the_samples_show_the_same,
    sixteen_times_the_samples_are_enough,
    finer_maps_show_the_same,
    nothing_pops_when_the_sun_moves,
    nothing_pops_when_the_camera_moves,
    nothing_pops_when_an_ellipsoid_moves,
);
