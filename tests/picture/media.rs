//! What is there: a baked volume of depths against the ellipsoids that it is baked from, and species.
#![cfg(feature = "export")]

use crate::common;

use common::{
    gpu,
    picture::{draw, renderer, scene},
};
use glam::DVec3;
use nephos::{
    export::Picture,
    optics::{peak::Chopped, phase::Phase},
    render::{Frame, Quality, Renderer, Transport},
    scene::{Camera, Ellipsoid, Projection, Scene},
};

const SIZE: [u32; 2] = [48, 27];
/// Both ways are lit alike: how finely is no matter.
const STILL: Quality = Quality { jitter: false, light_resolution: 32, light_cells: 24, ..Quality::PREVIEW };

/// A heap of `count` lumps on a spiral over a dome, seen from the south.
fn heap(count: u32, edge: &str) -> Scene {
    let mut heap = scene(&format!(
        r#"{{"sky": "none", "noise": {{"scale": 60}}, "clouds": [{{"edge": {edge}, "ellipsoids": []}}],
            "sun": {{"position": {{"angles": {{"azimuth_deg": 250, "elevation_deg": 30}}}}}},
            "camera": {{"position": [0, 1100, 1500], "target": [0, 1150, 0],
                "projection": {{"perspective": {{"vertical_fov_deg": 30}}}}}}}}"#
    ));
    heap.clouds[0].ellipsoids = (0..count)
        .map(|i| {
            let t = (f64::from(i) + 0.5) / f64::from(count);
            let (angle, out) = (2.399_963 * f64::from(i), t.sqrt());
            let up = 320.0 * (1.0 - t) * (0.5 + 0.5 * (0.7 * f64::from(i)).sin());
            let around = 330.0 * out * DVec3::new(angle.cos(), 0.0, angle.sin());
            let radius = 45.0 + 25.0 * (1.3 * f64::from(i)).sin();
            Ellipsoid::new(DVec3::Y * (1000.0 + up) + around, radius * DVec3::new(1.0, 0.8, 1.1))
        })
        .collect();
    heap
}

/// A renderer that bakes clouds of so many ellipsoids.
fn baking(from: u32, transport: Transport) -> Renderer {
    let mut renderer = renderer(STILL, transport);
    renderer.settings.bake_from = from;
    renderer
}

/// Root of the mean square of the difference, over the mean.
fn difference(a: &Picture, b: &Picture) -> f64 {
    let pairs = || a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    let squares: f64 = pairs().map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let mean: f64 = pairs().map(|(a, _)| f64::from(*a)).sum();
    let count = pairs().count() as f64;
    (squares / count).sqrt() / (mean / count)
}

#[test]
fn a_baked_cloud_looks_like_its_ellipsoids() {
    for edge in [r#"{"boundary": 30, "wispiness": 0.2}"#, r#"{"boundary": 12, "wispiness": 0}"#] {
        let heap = heap(300, edge);
        let mut renderers = [u32::MAX, 1].map(|from| baking(from, Transport::SINGLE));
        for transport in [Transport::SINGLE, Transport::MOMENTS, Transport::SLAB] {
            let [exact, baked] = renderers.each_mut().map(|renderer| {
                renderer.settings.transport = transport;
                draw(renderer, &heap, SIZE, false)
            });
            let found = difference(&exact, &baked);
            // A cell is a sixth of a lump's radius: creases are rounded within it. Slabs also face where
            // the depth falls, not away from the middles of lumps.
            let bound = if transport == Transport::SLAB { 0.1 } else { 0.04 };
            assert!(found > 0.0 && found < bound, "{transport} {edge}: {found}");
        }
    }
}

#[test]
fn a_baked_heap_that_is_blended_stratified_diluted_and_flat_below_looks_like_its_ellipsoids() {
    let mut heap = heap(300, r#"{"boundary": 20, "wispiness": 0.2}"#);
    let cloud = &mut heap.clouds[0];
    (cloud.blend, cloud.stratification, cloud.dilution) = (0.9, 1.0, 0.5);
    let (low, high) = cloud.bounds().unwrap();
    cloud.level = Some(0.8 * low.y + 0.2 * high.y);
    cloud.droplets.concentration_per_cm3 = 40.0;
    let mut drawn = [u32::MAX, 1].map(|from| {
        let mut renderer = baking(from, Transport::SINGLE);
        let picture = draw(&mut renderer, &heap, SIZE, false);
        assert_eq!(renderer.volumes_baked(), u32::from(from == 1));
        picture
    });
    let found = difference(&drawn[0], &drawn[1]);
    // Opacity alone: the light of its depths is that of the same volume.
    drawn.iter_mut().flat_map(|picture| &mut picture.pixels).for_each(|p| *p = [p[3]; 4]);
    let opacity = difference(&drawn[0], &drawn[1]);
    eprintln!("light {found:.4}, opacity {opacity:.4}");
    assert!(found > 0.0 && found < 0.04 && opacity < 0.02, "{found} {opacity}");
}

#[test]
fn lumps_of_other_density_within_others_are_baked_as_their_mean() {
    let mut heap = heap(200, r#"{"boundary": 20, "wispiness": 0.1}"#);
    let mut veil = Ellipsoid::new(DVec3::new(0.0, 1150.0, 0.0), DVec3::new(700.0, 400.0, 700.0));
    veil.density = 0.02;
    heap.clouds[0].ellipsoids.push(veil);
    let drawn = |from| draw(&mut baking(from, Transport::SINGLE), &heap, SIZE, false);
    let found = difference(&drawn(u32::MAX), &drawn(1));
    assert!(found < 0.04, "{found}");
}

#[test]
fn clouds_too_large_for_a_volume_that_tells_their_lumps_ask_each() {
    let mut long = heap(60, r#"{"boundary": 30, "wispiness": 0.2}"#);
    for (i, ellipsoid) in (0u32..).zip(&mut long.clouds[0].ellipsoids) {
        ellipsoid.center.x += 800.0 * f64::from(i);
    }
    let mut renderer = baking(1, Transport::SINGLE);
    let picture = draw(&mut renderer, &long, SIZE, false);
    assert_eq!(renderer.volumes_baked(), 0);
    assert_eq!(picture.pixels, draw(&mut baking(u32::MAX, Transport::SINGLE), &long, SIZE, false).pixels);
}

#[test]
fn a_baked_sphere_dims_by_beer_and_lambert() {
    let mut sphere = heap(1, r#"{"boundary": 0, "wispiness": 0}"#);
    sphere.clouds[0].droplets.concentration_per_cm3 = 20.0;
    sphere.clouds[0].droplets.phase = nephos::scene::Phase::Isotropic;
    sphere.clouds[0].ellipsoids = vec![Ellipsoid::new(DVec3::new(0.0, 1150.0, 0.0), DVec3::splat(100.0)); 3];
    // Through the middle and half a radius beside it.
    for (aside, chord) in [(0.0, 200.0), (50.0, 2.0 * 7500f64.sqrt())] {
        sphere.camera = Some(Camera {
            position: DVec3::new(aside, 1150.0, 900.0),
            target: DVec3::new(aside, 1150.0, 0.0),
            roll_deg: 0.0,
            projection: Projection::Orthographic { height: 2.0 },
            ..Camera::default()
        });
        let picture = draw(&mut baking(1, Transport::SINGLE), &sphere, [3, 3], false);
        let expected = 1.0 - (-chord * sphere.clouds[0].droplets.extinction()).exp();
        let found = f64::from(picture.pixels[4][3]);
        // The sharp edge is spread over a cell of 17 m at either end.
        assert!((found - expected).abs() < 0.03, "{aside}: {found} for {expected}");
    }
}

#[test]
fn a_shape_is_baked_once_and_only_where_it_has_enough_ellipsoids() {
    let mut cloud = heap(60, r#"{"boundary": 30, "wispiness": 0.2}"#);
    let mut renderer = baking(50, Transport::SINGLE);
    let mut baked = |scene: &Scene| {
        draw(&mut renderer, scene, SIZE, false);
        (renderer.volumes_baked(), renderer.volume_bytes() > 0)
    };
    assert_eq!(baked(&cloud), (1, true));
    cloud.camera.as_mut().unwrap().position.x += 100.0;
    assert_eq!(baked(&cloud), (1, true), "a camera bakes nothing");
    cloud.noise.offset.x += 30.0;
    assert_eq!(baked(&cloud), (1, true), "noise that drifts bakes nothing");
    cloud.clouds[0].droplets.concentration_per_cm3 *= 0.3;
    assert_eq!(baked(&cloud), (1, true), "a cloud that fades bakes nothing");
    cloud.clouds[0].ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.density *= 0.37);
    assert_eq!(baked(&cloud), (1, true), "nor one all of whose lumps fade");
    (cloud.clouds[0].stratification, cloud.clouds[0].dilution) = (0.8, 0.0);
    assert_eq!(baked(&cloud), (1, true), "its heights are told apart where it is drawn");
    cloud.clouds[0].ellipsoids[7].center.y += 20.0;
    assert_eq!(baked(&cloud), (2, true), "another shape");
    cloud.clouds[0].blend = 0.9;
    assert_eq!(baked(&cloud), (3, true), "lumps that join otherwise");
    cloud.clouds[0].ellipsoids[7].density *= 0.5;
    assert_eq!(baked(&cloud), (4, true), "one lump that fades alone");
    cloud.clouds[0].ellipsoids.truncate(40);
    assert_eq!(baked(&cloud).0, 4, "few ellipsoids are asked");
}

#[test]
fn a_baked_cloud_of_many_lumps_costs_what_one_of_few_does() {
    let reads = |count, from| {
        let mut renderer = baking(from, Transport::SINGLE);
        renderer.settings.counting = true;
        draw(&mut renderer, &heap(count, r#"{"boundary": 30, "wispiness": 0.2}"#), SIZE, false);
        let counts = renderer.counts(gpu()).unwrap();
        (counts.ellipsoids + counts.volume_reads + counts.noise_reads) as f64 / counts.rays_hit as f64
    };
    let (few, many, asked) = (reads(60, u32::MAX), reads(1500, 1), reads(1500, u32::MAX));
    assert!(many < 1.3 * few && many < asked, "{many} for {few}, and {asked} without a volume");
}

#[test]
fn the_same_frame_is_seen_by_two_cameras() {
    let scene = heap(40, r#"{"boundary": 30, "wispiness": 0.2}"#);
    let frame = Frame::new(&scene, SIZE).unwrap();
    let other = Camera { position: DVec3::new(900.0, 1300.0, 900.0), ..scene.camera.clone().unwrap() };
    let drawn = |frame: &Frame| {
        let mut renderer = renderer(STILL, Transport::SINGLE);
        let texture = renderer.picture("seen", SIZE, wgpu::TextureFormat::Rgba16Float);
        let view = texture.create_view(&Default::default());
        let target = nephos::render::Target { color: &view, depth: None, sky: false };
        renderer.render_in_pieces(gpu(), frame, &target, &mut |_| ()).unwrap();
        Picture::read(gpu(), &texture).unwrap().pixels
    };
    let moved = Scene { camera: Some(other.clone()), ..scene };
    assert_eq!(drawn(&frame.seen_by(&other, SIZE).unwrap()), drawn(&Frame::new(&moved, SIZE).unwrap()));
    assert!(frame.seen_by(&other, [0, 9]).is_err());
}

#[test]
fn the_shadow_of_another_cloud_is_that_of_what_it_is_made_of() {
    // A veil far below a ball, with the sun above both.
    let veil = |phase: &str| {
        format!(
            r#"{{"edge": {{"boundary": 0}}, "droplets": {{"phase": "isotropic", "concentration_per_cm3": 0.5}},
                "ellipsoids": [{{"center": [0, 1000, 0], "radii": [40, 4, 40]}}]}}
            {phase}"#
        )
    };
    let ball = |phase: &str| {
        format!(
            r#", {{"edge": {{"boundary": 0}}, "droplets": {{"phase": "{phase}", "concentration_per_cm3": 20}},
                "ellipsoids": [{{"center": [0, 1500, 0], "radii": [100, 100, 100]}}]}}"#
        )
    };
    let light = |clouds: &str| {
        let scene = scene(&format!(
            r#"{{"sky": "none", "clouds": [{clouds}],
                "sun": {{"position": {{"direction": [0, 1, 0]}}, "angular_diameter_deg": 0}},
                "camera": {{"position": [0, 1000, 200], "target": [0, 1000, 0],
                    "projection": {{"orthographic": {{"height": 1}}}}}}}}"#
        ));
        let mut renderer = renderer(Quality { jitter: false, ..Quality::PREVIEW }, Transport::SINGLE);
        (f64::from(draw(&mut renderer, &scene, [3, 3], false).pixels[4][1]), scene)
    };
    let (bright, _) = light(&veil(""));
    for (phase, f) in [("isotropic", 0.0), ("mie", Chopped::new(Phase::mie(6.0).unwrap()).f)] {
        let (dimmed, scene) = light(&veil(&ball(phase)));
        let depth = 200.0 * scene.clouds[1].droplets.extinction();
        // Twelve samples across the ball soften its edge; a wrong share f would be off by a half and more.
        let found = -(dimmed / bright).ln() / depth;
        assert!((found / (1.0 - f) - 1.0).abs() < 0.12, "{phase}: {found} for {}", 1.0 - f);
    }
}

#[test]
fn two_veils_before_the_sun_have_the_glow_of_one_as_thick_as_both() {
    // What the farther one's peak scatters comes through the nearer one's: it is not to be had from both.
    let veil = |height: f64, depth: f64| {
        let concentration = depth / (120.0 * std::f64::consts::TAU * 36e-6);
        format!(
            r#"{{"edge": {{"boundary": 0}}, "droplets": {{"concentration_per_cm3": {concentration}, "effective_radius_um": 6}},
                "ellipsoids": [{{"center": [0, {height}, 0], "radii": [900, 60, 900]}}]}}"#
        )
    };
    let glow = |veils: &[String]| {
        let scene = scene(&format!(
            r#"{{"sky": "none", "clouds": [{}], "sun": {{"position": {{"direction": [0, 1, 0]}}, "angular_diameter_deg": 0}},
                "camera": {{"position": [0, 0, 0], "target": [0, 100, 0], "projection": {{"perspective": {{"vertical_fov_deg": 0.8}}}}}}}}"#,
            veils.join(", ")
        ));
        let mut renderer = renderer(Quality { jitter: false, ..Quality::PREVIEW }, Transport::SINGLE);
        let row = draw(&mut renderer, &scene, [41, 3], false).pixels[41..82].to_vec();
        // Light in rings from a third of a degree on.
        row.iter()
            .zip(-20..)
            .filter(|(_, x)| *x > 1)
            .map(|(p, x)| f64::from(p[1]) * f64::from(x))
            .sum::<f64>()
    };
    let (one, two) = (glow(&[veil(2500.0, 6.0)]), glow(&[veil(2000.0, 3.0), veil(3500.0, 3.0)]));
    assert!((two / one - 1.0).abs() < 0.25, "{two} {one}");
}

#[test]
fn no_lump_behind_the_wall_of_a_brick_is_jumped_over() {
    // Flat lumps side by side, six kilometres of them: bricks are as wide as gaps between lumps.
    let deck = Scene::load("examples/scenes/gallery-glory.json").unwrap();
    let of = |from| draw(&mut baking(from, Transport::SINGLE), &deck, [96, 54], false);
    let (baked, exact) = (of(1), of(u32::MAX));
    let apart = baked.pixels.iter().zip(&exact.pixels).map(|(a, b)| (a[1] / b[1] - 1.0).abs());
    let worst = apart.fold(0.0, f32::max);
    // A ray that jumps sees the dark between: 0.3.
    assert!(worst < 0.2, "{worst}");
}
