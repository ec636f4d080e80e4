//! The ends of what a scene may be, each by name: pictures stay finite, and right where a closed
//! form or another scene tells what is right.
#![cfg(feature = "export")]

use crate::common;

use common::{
    hull::power,
    picture::{draw, lent, renderer},
    random::white,
};
use glam::{DQuat, DVec3};
use nephos::{
    export::Picture,
    gpu::Gpu,
    render::{Frame, Quality, Renderer, Target, Transport},
    scene::{Camera, Cloud, Droplets, Edge, Ellipsoid, Noise, Phase, Projection, Scene, Sky, SunPosition},
};

const SIZE: [u32; 2] = [17, 17];
const COARSE: Quality = Quality { light_resolution: 16, light_cells: 8, jitter: false, ..Quality::DRAFT };
const MIDDLE: DVec3 = DVec3::new(0.0, 1500.0, 0.0);

/// A picture, finite and never negative.
fn picture_of(scene: &Scene, size: [u32; 2]) -> Picture {
    // With the sky, and the clouds alone.
    let [whole, clouds] = lent(COARSE, Transport::MOMENTS, |renderer| {
        [true, false].map(|sky| draw(renderer, scene, size, sky))
    });
    for pixel in &whole.pixels {
        assert!(pixel.iter().all(|c| c.is_finite() && *c >= 0.0) && pixel[3] <= 1.0, "{pixel:?}");
    }
    clouds
}

fn picture(scene: &Scene) -> Picture {
    picture_of(scene, SIZE)
}

fn middle(picture: &Picture) -> [f32; 4] {
    picture.pixels[picture.pixels.len() / 2]
}

fn covered(picture: &Picture) -> f64 {
    picture.pixels.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>() / picture.pixels.len() as f64
}

/// One ellipsoid of this optical depth across its least radius, which scatters alike in all directions,
/// seen from `distance` metres towards the south.
fn scene(radii: DVec3, optical_depth: f64, distance: f64) -> Scene {
    let unit = Droplets { concentration_per_cm3: 1.0, phase: Phase::Isotropic, ..Droplets::default() };
    let concentration = optical_depth / (2.0 * radii.min_element() * unit.extinction());
    // The densest droplets at a hundred times their density are not enough for a centimetre.
    let density = (concentration / 1e5).clamp(1.0, 100.0);
    let cloud = Cloud {
        ellipsoids: vec![Ellipsoid { density, ..Ellipsoid::new(MIDDLE, radii) }],
        droplets: Droplets { concentration_per_cm3: (concentration / density).min(1e5), ..unit },
        edge: Edge { boundary: 0.0, wispiness: 0.0 },
        ..Cloud::default()
    };
    Scene { clouds: vec![cloud], sky: Sky::None, camera: Some(camera(distance)), ..Scene::default() }
}

fn camera(distance: f64) -> Camera {
    let projection = Projection::Perspective { vertical_fov_deg: 40.0 };
    Camera {
        position: MIDDLE + distance * DVec3::Z,
        target: MIDDLE,
        roll_deg: 0.0,
        projection,
        ..Camera::default()
    }
}

fn seen_through(scene: &Scene) -> f64 {
    1.0 - f64::from(middle(&picture(scene))[3])
}

#[test]
fn spheres_from_a_centimetre_to_a_hundred_kilometres() {
    for radius in [0.01, 1.0, 100.0, 1e4, 1e5] {
        let scene = scene(DVec3::splat(radius), 1.5, 4.0 * radius);
        let depth =
            2.0 * radius * scene.clouds[0].droplets.extinction() * scene.clouds[0].ellipsoids[0].density;
        // Half floats, and the width of a pixel.
        let through = seen_through(&scene);
        assert!((through - (-depth).exp()).abs() < 0.01, "{radius} m: {through} for {}", (-depth).exp());
    }
}

#[test]
fn ellipsoids_ten_thousand_times_as_long_as_thick() {
    let disc = scene(DVec3::new(1e4, 1e4, 1.0), 1.0, 1e4);
    assert!((seen_through(&disc) - (-1f64).exp()).abs() < 0.01, "a disc from its face");
    let mut needle = scene(DVec3::new(1e4, 1.0, 1.0), 1.0, 10.0);
    needle.clouds[0].ellipsoids[0].orientation = DQuat::from_rotation_z(0.7);
    assert!((seen_through(&needle) - (-1f64).exp()).abs() < 0.02, "a tilted needle from its side");
    let mut sheet = scene(DVec3::new(1e5, 10.0, 1e5), 3.0, 500.0);
    sheet.clouds[0].edge.boundary = 60.0;
    let camera = sheet.camera.as_mut().unwrap();
    (camera.position, camera.target) = (MIDDLE - 300.0 * DVec3::Y, MIDDLE + 500.0 * DVec3::NEG_Z);
    assert!(covered(&picture(&sheet)) > 0.01, "a sheet with a boundary thicker than itself, from below");
}

#[test]
fn coincident_ellipsoids_join_to_one_that_is_deeper() {
    // A hundred join to a depth that is the p-th root of 100 times that of one: in a boundary so much thicker
    // they are as dense where one is.
    let mut one = scene(DVec3::splat(100.0), 4.0, 400.0);
    one.clouds[0].edge.boundary = 20.0;
    let mut many = one.clone();
    many.clouds[0].edge.boundary *= 100f64.powf(1.0 / power(one.clouds[0].blend));
    let alone = picture(&one);
    // More than a ray has room for.
    let copy = many.clouds[0].ellipsoids[0].clone();
    many.clouds[0].ellipsoids = vec![copy; 100];
    let together = picture(&many);
    let pairs = || alone.pixels.iter().flatten().zip(together.pixels.iter().flatten());
    let squares: f64 = pairs().map(|(a, b)| f64::from(a - b).powi(2)).sum();
    // Steps go by the boundary, and are longer in a thicker one: pixels on its rim may miss it.
    let found = (squares / pairs().count() as f64).sqrt();
    assert!(found < 0.04, "{found}");
}

#[test]
fn a_row_of_more_ellipsoids_than_a_ray_has_room_for() {
    let mut row = scene(DVec3::splat(10.0), 0.05, 2000.0);
    let first = row.clouds[0].ellipsoids[0].clone();
    row.clouds[0].ellipsoids = (0..60)
        .map(|i| Ellipsoid { center: first.center - f64::from(i) * 25.0 * DVec3::Z, ..first.clone() })
        .collect();
    row.camera.as_mut().unwrap().projection = Projection::Perspective { vertical_fov_deg: 1.0 };
    let through = seen_through(&row);
    assert!((through - (-3f64).exp()).abs() < 0.02, "{through} for {}", (-3f64).exp());
    // In any order.
    row.clouds[0].ellipsoids.reverse();
    assert!((seen_through(&row) - through).abs() < 1e-3);
}

#[test]
fn twenty_thousand_ellipsoids() {
    let mut heap = scene(DVec3::splat(6.0), 1.0, 600.0);
    let first = heap.clouds[0].ellipsoids[0].clone();
    let spiral = |i: u32| {
        let (t, a) = (f64::from(i) / 20_000.0, 2.399963 * f64::from(i));
        let out = 150.0 * (7.3 * t).fract().cbrt();
        let z = 2.0 * t - 1.0;
        out * DVec3::new((1.0 - z * z).sqrt() * a.cos(), z, (1.0 - z * z).sqrt() * a.sin())
    };
    heap.clouds[0].ellipsoids =
        (0..20_000).map(|i| Ellipsoid { center: first.center + spiral(i), ..first.clone() }).collect();
    let picture = picture(&heap);
    assert!(middle(&picture)[3] > 0.9 && middle(&picture)[1] > 0.0);
    assert_eq!(picture.pixels[0][3], 0.0);
}

#[test]
fn cameras_on_a_boundary_at_a_centre_and_a_thousand_kilometres_away() {
    let radius = 100.0;
    for (distance, length) in [(radius, 2.0 * radius), (radius + 1e-4, 2.0 * radius), (1e-3, radius)] {
        let scene = scene(DVec3::splat(radius), 1.0, distance);
        let through = seen_through(&scene);
        let expected = (-length / (2.0 * radius)).exp();
        assert!((through - expected).abs() < 0.02, "from {distance} m: {through} for {expected}");
    }
    let mut far = scene(DVec3::splat(1000.0), 1.0, 1e6);
    far.camera.as_mut().unwrap().projection = Projection::Perspective { vertical_fov_deg: 0.2 };
    assert!((seen_through(&far) - (-1f64).exp()).abs() < 0.01);
}

#[test]
fn fields_of_view_from_a_tenth_of_a_degree_to_a_hundred_and_seventy() {
    for (vertical_fov_deg, distance) in [(0.1, 2e5), (40.0, 300.0), (170.0, 110.0)] {
        let mut scene = scene(DVec3::splat(100.0), 1.0, distance);
        scene.camera.as_mut().unwrap().projection = Projection::Perspective { vertical_fov_deg };
        assert!((seen_through(&scene) - (-1f64).exp()).abs() < 0.01, "{vertical_fov_deg} degrees");
    }
}

#[test]
fn suns_at_the_zenith_at_and_below_the_horizon_and_along_the_view() {
    let mut scene = scene(DVec3::splat(100.0), 10.0, 400.0);
    scene.sky = Sky::default();
    scene.clouds[0].droplets.phase = Phase::Mie;
    for (azimuth_deg, elevation_deg) in [(0.0, 90.0), (0.0, 0.0), (180.0, 0.0), (90.0, -90.0), (200.0, -0.3)]
    {
        scene.sun.position = SunPosition::Angles { azimuth_deg, elevation_deg };
        let picture = picture(&scene);
        assert!(middle(&picture)[3] > 0.9, "{elevation_deg}");
    }
    let camera = scene.camera.clone().unwrap();
    for sign in [-1.0, 1.0] {
        scene.sun.position = SunPosition::Direction(sign * (camera.target - camera.position));
        picture(&scene);
    }
}

#[test]
fn droplets_from_none_to_ten_million() {
    for (concentration, density, seen) in
        [(0.0, 1.0, 0.0), (1e-3, 1.0, 0.0), (1e5, 1.0, 1.0), (1e5, 100.0, 1.0)]
    {
        let mut scene = scene(DVec3::splat(100.0), 1.0, 400.0);
        scene.sky = white();
        scene.clouds[0].droplets.concentration_per_cm3 = concentration;
        scene.clouds[0].ellipsoids[0].density = density;
        scene.clouds[0].edge.boundary = 50.0;
        let alpha = middle(&picture(&scene))[3];
        assert!((alpha - seen).abs() < 1e-3, "{concentration}: {alpha}");
    }
}

#[test]
fn noise_of_every_size_and_strength() {
    for (scale, detail, wispiness) in [(0.1, 1.0, 1.0), (1e5, 0.0, 0.0), (120.0, 1.0, 1.0), (120.0, 0.0, 0.5)]
    {
        for boundary in [0.0, 1e-3, 50.0, 1e4] {
            let mut scene = scene(DVec3::splat(100.0), 20.0, 400.0);
            scene.noise = Noise { scale: Some(scale), detail, ..Noise::default() };
            scene.clouds[0].edge = Edge { boundary, wispiness };
            let most = covered(&picture(&scene));
            assert!(most < 0.5 && (boundary > 50.0 || most > 0.1), "{scale} {boundary}: {most}");
        }
    }
}

#[test]
fn pictures_of_one_pixel_and_of_one_row() {
    let scene = scene(DVec3::splat(100.0), 1.0, 400.0);
    assert_eq!(picture_of(&scene, [1, 1]).pixels.len(), 1);
    assert_eq!(picture_of(&scene, [8192, 1]).pixels.len(), 8192);
    assert_eq!(picture_of(&scene, [1, 8192]).pixels.len(), 8192);
}

/// As `nephos render` draws it, in pieces; read back it is larger than a buffer may be.
#[test]
fn the_largest_picture() {
    let scene = scene(DVec3::splat(4.0), 1.0, 400.0);
    let mut renderer = renderer(COARSE, Transport::SINGLE);
    let picture = draw(&mut renderer, &scene, [8192, 8192], false);
    let at = |x: usize, y: usize| f64::from(picture.pixels[y * 8192 + x][3]);
    assert!((at(4096, 4096) - 1.0 + (-1f64).exp()).abs() < 0.01, "{}", at(4096, 4096));
    // The disc is 8 / 400 over 2 tan 20 degrees of 8192 pixels wide: 225.
    let covered = |along: &dyn Fn(usize) -> f64| (0..8192).filter(|&i| along(i) > 0.01).count();
    let across = [covered(&|i| at(i, 4096)), covered(&|i| at(4096, i))];
    assert!(across.iter().all(|n| n.abs_diff(225) <= 4), "{across:?}");
}

/// A device with the least that a browser promises, or less, says what it lacks.
#[test]
fn pictures_larger_than_the_device_are_refused_with_a_sentence() {
    let limits = wgpu::Limits { max_texture_dimension_2d: 2048, ..wgpu::Limits::default() };
    let small = device(limits);
    let scene = scene(DVec3::splat(100.0), 1.0, 400.0);
    let drawn = |size: [u32; 2]| {
        let mut renderer = Renderer::new(&small.device, &small.queue, wgpu::TextureFormat::Rgba16Float);
        (renderer.settings.quality, renderer.settings.transport) = (COARSE, Transport::SINGLE);
        let frame = Frame::new(&scene, size).unwrap();
        let texture = renderer.picture("test", size, wgpu::TextureFormat::Rgba16Float);
        let view = texture.create_view(&Default::default());
        let target = Target { color: &view, depth: None, sky: false };
        renderer.render_in_pieces(&small, &frame, &target, &mut |_| ()).map_err(|error| error.to_string())
    };
    let refusal = drawn([2049, 8]).unwrap_err();
    assert!(refusal.contains("2049") && refusal.contains("2048"), "{refusal}");
    assert_eq!(drawn([2048, 8]), Ok(()), "what fits is drawn, after what did not");
}

fn device(required_limits: wgpu::Limits) -> Gpu {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let name = &common::gpu().adapter.name;
    pollster::block_on(async {
        let adapters = instance.enumerate_adapters(wgpu::Backends::PRIMARY).await;
        let adapter = adapters.into_iter().find(|adapter| adapter.get_info().name == *name).unwrap();
        let wanted = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
        let (device, queue) = adapter.request_device(&wanted).await.unwrap();
        Gpu::from_device(device, queue, adapter.get_info())
    })
}

/// Steps are as long as boundaries are thick, but no longer than the ellipsoid is: from within a sheet
/// a tenth of it was seen.
#[test]
fn boundaries_thicker_than_their_ellipsoid_are_not_stepped_over() {
    let mut sheet = scene(DVec3::new(150.0, 7.0, 150.0), 3000.0, 10.0);
    sheet.noise.scale = Some(30.0);
    sheet.clouds[0].edge = Edge { boundary: 60.0, wispiness: 0.9 };
    let mut renderer = renderer(COARSE, Transport::EMITTER);
    let mut seen = |first_step: f32, longest_step: f32| {
        renderer.settings.quality = Quality { first_step, longest_step, max_steps: 1024, ..COARSE };
        covered(&draw(&mut renderer, &sheet, [48, 48], false))
    };
    let (coarse, fine) = (seen(COARSE.first_step, COARSE.longest_step), seen(0.005, 0.02));
    assert!(fine > 0.99 && coarse > 0.95 * fine, "{coarse} of {fine}");
}

#[test]
fn light_beyond_what_half_floats_hold_is_not_cut() {
    let mut scene = scene(DVec3::splat(100.0), 50.0, 400.0);
    let mut green = |light: f64| {
        scene.sun.irradiance = [light; 3];
        scene.sky = Sky::Uniform { radiance: [light; 3] };
        f64::from(middle(&picture(&scene))[1])
    };
    let (dim, bright) = (green(1.0), green(1e6));
    assert!(bright > 65504.0 && (bright / dim - 1e6).abs() < 3e3, "{dim} {bright}");
}
