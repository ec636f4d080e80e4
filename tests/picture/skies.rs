//! Sky maps and shadows on the ground: the same light as in pictures, and files that others read.
#![cfg(feature = "export")]

use crate::common;

use common::{
    gpu,
    picture::{in_coarse_light, scene},
    readers,
};
use glam::{DVec3, Vec3};
use nephos::{
    export::{FACES, Picture, Studio, cube_faces, equirectangular, write_hdr, write_ktx2, write_named},
    render::Quality,
    scene::{Camera, Projection, Scene},
};

/// Clouds on all sides, one across an edge of the cube, the sun behind another.
const AROUND: &str = r#"{"clouds":[{"edge":{"boundary":20},"ellipsoids":[
    {"center":[400,300,-410],"radii":[120,70,100]},{"center":[-500,120,100],"radii":[100,60,90]},
    {"center":[20,600,30],"radii":[160,50,150]}]}],
    "sun":{"position":{"angles":{"azimuth_deg":60,"elevation_deg":35}}},
    "camera":{"position":[0,30,0],"target":[0,30,-1]}}"#;

/// Quick, and without grain.
fn studio() -> Studio {
    let mut studio = Studio::new(gpu(), 1, true);
    studio.renderer().settings.quality = in_coarse_light(Quality { jitter: false, ..Quality::DRAFT });
    studio
}

fn faces(scene: &Scene, size: u32) -> Vec<Picture> {
    cube_faces(&mut studio(), scene, size, &mut |_| ()).unwrap()
}

/// Direction of the scene that the standard tables of cube maps (Vulkan 1.3, 16.5.4) have at a place on a face,
/// from (-1, -1) at the top left: the cube's z is the scene's -z.
fn direction(face: usize, s: f32, t: f32) -> Vec3 {
    let [x, y, z] = match face {
        0 => [1.0, -t, -s],
        1 => [-1.0, -t, s],
        2 => [s, 1.0, t],
        3 => [s, -1.0, -t],
        4 => [s, -t, 1.0],
        _ => [-s, -t, -1.0],
    };
    Vec3::new(x, y, -z).normalize()
}

fn at(picture: &Picture, x: usize, y: usize) -> Vec3 {
    Vec3::from_slice(&picture.pixels[y * picture.width + x])
}

/// What is seen in a direction, by a camera of its own.
fn seen(studio: &mut Studio, scene: &Scene, direction: Vec3) -> Vec3 {
    let position = scene.camera().position;
    let camera = Camera {
        position,
        target: position + 1000.0 * direction.as_dvec3(),
        roll_deg: 0.0,
        projection: Projection::Perspective { vertical_fov_deg: 90.0 / 16.0 },
        ..Camera::default()
    };
    let scene = Scene { camera: Some(camera), ..scene.clone() };
    let picture = studio.picture(&scene, [1, 1], true).unwrap();
    at(&picture, 0, 0)
}

#[test]
fn faces_of_the_cube_show_what_is_in_their_directions() {
    let scene = scene(AROUND);
    let faces = faces(&scene, 16);
    let mut studio = studio();
    for face in 0..6 {
        for (x, y) in [(3, 2), (12, 5), (8, 11)] {
            let place = |i: usize| (i as f32 + 0.5) / 8.0 - 1.0;
            let (found, expected) =
                (at(&faces[face], x, y), seen(&mut studio, &scene, direction(face, place(x), place(y))));
            // Edges of clouds are filtered over pixels of other shapes.
            assert!(
                (found - expected).abs().max_element() < 0.03 * expected.max_element() + 1e-3,
                "{} {x} {y}: {found} {expected}",
                FACES[face].0
            );
        }
    }
}

/// Largest and mean difference of pixels on both sides of all twelve edges, over what neighbours inside
/// of faces differ.
#[test]
fn faces_meet_without_seams() {
    let size = 24;
    let scene = scene(AROUND);
    let faces = faces(&scene, size as u32);
    let place = |i: usize| (i as f32 + 0.5) / (size as f32 / 2.0) - 1.0;
    // Each pixel on a rim, and the pixel of another face whose direction is nearest to its mirror beyond the rim.
    let mut across: Vec<f32> = Vec::new();
    let mut inside: Vec<f32> = Vec::new();
    for face in 0..6 {
        for i in 0..size {
            let one = 1.0 + 1.0 / size as f32;
            for (x, y, s, t, inner) in [
                (0, i, -one, place(i), (1, i)),
                (size - 1, i, one, place(i), (size - 2, i)),
                (i, 0, place(i), -one, (i, 1)),
                (i, size - 1, place(i), one, (i, size - 2)),
            ] {
                let beyond = direction(face, s, t);
                let (other, ox, oy) = pixel_of(beyond, size);
                assert_ne!(other, face);
                let (a, b) = (at(&faces[face], x, y), at(&faces[other], ox, oy));
                let scale = 0.5 * (a + b).max_element();
                across.push((a - b).abs().max_element() / scale);
                inside.push((a - at(&faces[face], inner.0, inner.1)).abs().max_element() / scale);
            }
        }
    }
    let mean = |list: &[f32]| list.iter().sum::<f32>() / list.len() as f32;
    let (across, inside) = (mean(&across), mean(&inside));
    // Neighbours across a rim are as like one another as neighbours are.
    assert!(across < 1.3 * inside + 1e-3, "{across} {inside}");
}

/// Face and pixel in which a direction of the scene is.
fn pixel_of(d: Vec3, size: usize) -> (usize, usize, usize) {
    let (x, y, z) = (d.x, d.y, -d.z);
    let most = x.abs().max(y.abs()).max(z.abs());
    let (face, s, t) = if x.abs() == most {
        if x > 0.0 { (0, -z, -y) } else { (1, z, -y) }
    } else if y.abs() == most {
        if y > 0.0 { (2, x, z) } else { (3, x, -z) }
    } else if z > 0.0 {
        (4, x, -y)
    } else {
        (5, -x, -y)
    };
    let pixel = |s: f32| (((s / most + 1.0) * 0.5 * size as f32) as usize).min(size - 1);
    (face, pixel(s), pixel(t))
}

#[test]
fn an_equirectangular_map_closes_and_has_north_in_its_middle() {
    let scene = scene(AROUND);
    let mut studio = studio();
    let map = equirectangular(&mut studio, &scene, 48).unwrap();
    assert_eq!((map.width, map.height), (96, 48));
    let mean = |list: Vec<f32>| list.iter().sum::<f32>() / list.len() as f32;
    let difference = |a: usize, b: usize| {
        mean(
            (0..48)
                .map(|y| (at(&map, a, y) - at(&map, b, y)).abs().max_element() / at(&map, a, y).max_element())
                .collect(),
        )
    };
    let (seam, inside) = (difference(95, 0), 0.5 * (difference(94, 95) + difference(0, 1)));
    assert!(seam < 1.3 * inside + 1e-3, "{seam} {inside}");
    for (x, y) in [(48, 20), (70, 17), (10, 22), (30, 5), (60, 40)] {
        let longitude = ((x as f32 + 0.5) / 96.0 - 0.5) * std::f32::consts::TAU;
        let latitude = (0.5 - (y as f32 + 0.5) / 48.0) * std::f32::consts::PI;
        let d =
            Vec3::new(longitude.sin() * latitude.cos(), latitude.sin(), -longitude.cos() * latitude.cos());
        let (found, expected) = (at(&map, x, y), seen(&mut studio, &scene, d));
        assert!(
            (found - expected).abs().max_element() < 0.03 * expected.max_element() + 1e-3,
            "{x} {y}: {found} {expected}"
        );
    }
}

#[test]
fn radiance_files_hold_the_light() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.hdr");
    let pixels = (0..12).map(|i| [0.1 * i as f32, 1.0, 5000.0 / (1 + i) as f32, 1.0]).collect();
    let picture = Picture { width: 4, height: 3, pixels };
    write_hdr(&path, &picture).unwrap();
    let read = image::open(&path).unwrap().to_rgb32f();
    assert_eq!(read.dimensions(), (4, 3));
    for (found, expected) in read.pixels().zip(&picture.pixels) {
        let brightest = expected[..3].iter().copied().fold(0.0, f32::max);
        assert!(found.0.iter().zip(expected).all(|(a, b)| (a - b).abs() <= brightest / 128.0), "{found:?}");
    }
}

#[test]
fn ktx_files_hold_six_faces_with_their_levels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.ktx2");
    let face = |f: usize| {
        let pixel = |i: usize| [0.5 + f as f32, 0.01 * (i % 16) as f32, 2.0, 1.0];
        Picture { width: 16, height: 16, pixels: (0..256).map(pixel).collect() }
    };
    let faces: Vec<_> = (0..6).map(face).collect();
    write_ktx2(&path, &faces).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let reader = ktx2::Reader::new(&bytes).unwrap();
    let header = reader.header();
    assert_eq!(header.format, Some(ktx2::Format::BC6H_UFLOAT_BLOCK));
    assert_eq!((header.pixel_width, header.face_count, header.level_count), (16, 6, 5));
    assert_eq!(
        reader.levels().map(|level| level.data.len()).collect::<Vec<_>>(),
        [6 * 256, 6 * 64, 6 * 16, 6 * 16, 6 * 16]
    );
    assert!(header.index.dfd_byte_length > 0 && reader.basic_dfd().is_some());
    let keys: Vec<_> = reader.key_value_data().map(|(key, _)| key.to_owned()).collect();
    assert_eq!(keys, ["KTXorientation", "KTXwriter"]);
    for (f, blocks) in reader.levels().next().unwrap().data.chunks(256).enumerate() {
        for (b, block) in blocks.chunks(16).enumerate() {
            let mut pixels = [half::f16::ZERO; 48];
            block_compression::decode::decode_block_bc6h(block, &mut pixels, 12, false);
            for (i, found) in pixels.chunks(3).enumerate() {
                let (x, y) = (4 * (b % 4) + i % 4, 4 * (b / 4) + i / 4);
                let expected = faces[f].pixels[16 * y + x];
                let near = |c: usize| (found[c].to_f32() - expected[c]).abs() < 0.03 * expected[c] + 0.02;
                assert!((0..3).all(near), "{f} {x} {y}: {found:?} {expected:?}");
            }
        }
    }
    // Levels are halved to the last pixel whatever the size, and each has the mean of the whole.
    for (size, levels) in [(4usize, 3), (12, 4), (20, 5), (36, 6)] {
        let pixel = |i: usize| [1.0 + (i % size) as f32, 1.0 + (i / size) as f32, 3.0, 1.0];
        let face = Picture { width: size, height: size, pixels: (0..size * size).map(pixel).collect() };
        write_ktx2(&path, &vec![face; 6]).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let reader = ktx2::Reader::new(&bytes).unwrap();
        let blocks = |level: usize| (size >> level).div_ceil(4).pow(2) * 16 * 6;
        let lengths: Vec<_> = reader.levels().map(|level| level.data.len()).collect();
        assert_eq!(lengths, (0..levels).map(blocks).collect::<Vec<_>>());
        let last = reader.levels().last().unwrap();
        let mut pixels = [half::f16::ZERO; 48];
        block_compression::decode::decode_block_bc6h(&last.data[..16], &mut pixels, 12, false);
        let mean = 0.5 * (1.0 + size as f32);
        for (c, expected) in [mean, mean, 3.0].into_iter().enumerate() {
            let found = pixels[c].to_f32();
            assert!((found / expected - 1.0).abs() < 0.02, "{size} {c}: {found} {expected}");
        }
    }
    let odd = Picture { width: 6, height: 6, pixels: vec![[0.0; 4]; 36] };
    assert!(write_ktx2(&path, &[odd]).unwrap_err().to_string().contains("multiple of 4"));
}

#[test]
fn a_shadow_is_what_is_seen_towards_the_sun() {
    let mut scene = scene(AROUND);
    let mut studio = studio();
    studio.renderer().settings.transport = nephos::render::Transport::SINGLE;
    for altitude in [0.0, 250.0] {
        let (center, extent) = studio.shadows_of(&scene, altitude).unwrap();
        let map = studio.sunlight_on(&scene, center, extent, 24).unwrap();
        assert!(map.iter().any(|share| *share < 0.01) && map.contains(&1.0));
        // All shadows are inside: its rim is lit.
        let rim = |i: usize| [0, 23].contains(&(i % 24)) || [0, 23].contains(&(i / 24));
        assert!(map.iter().enumerate().filter(|(i, _)| rim(*i)).all(|(_, share)| *share == 1.0));
        for i in (0..576).step_by(29) {
            let place = |n: usize| extent * ((n as f64 + 0.5) / 24.0 - 0.5);
            let ground = center + DVec3::new(place(i % 24), 0.0, place(i / 24));
            // A picture taken there along the same line, as wide as the map's pixel.
            let projection = Projection::Orthographic { height: extent / 24.0 };
            let position = ground;
            let target = ground + 1000.0 * scene.sun.to_sun();
            scene.camera = Some(Camera { position, target, roll_deg: 0.0, projection, ..Camera::default() });
            let alpha = studio.picture(&scene, [1, 1], false).unwrap().pixels[0][3];
            assert!((map[i] - (1.0 - alpha)).abs() < 0.02, "{i}: {} {}", map[i], 1.0 - alpha);
        }
    }
}

#[test]
fn a_homogeneous_ball_dims_the_sun_by_beer_and_lambert() {
    let text = r#"{"clouds":[{"edge":{"boundary":0},"droplets":{"concentration_per_cm3":20,"phase":"isotropic"},
        "ellipsoids":[{"center":[0,500,0],"radii":[100,100,100]}]}],
        "sun":{"position":{"angles":{"azimuth_deg":90,"elevation_deg":30}}}}"#;
    let scene = scene(text);
    let to_sun = scene.sun.to_sun();
    // One map whose middle is lit through the middle of the ball, and one above the ball.
    let below = DVec3::new(0.0, 500.0, 0.0) - to_sun * (500.0 / to_sun.y);
    let map = studio().sunlight_on(&scene, below, 9.0, 3).unwrap();
    let optical_depth = 20e6 * 2.0 * std::f64::consts::PI * 36e-12 * 200.0;
    let expected = (-optical_depth).exp();
    assert!((f64::from(map[4]) - expected).abs() < 0.003, "{} {expected}", map[4]);
    let above = studio().sunlight_on(&scene, DVec3::new(0.0, 700.0, 0.0), 9.0, 3).unwrap();
    assert!(above.iter().all(|share| *share == 1.0));
    // Droplets send much light on by less than 8 degrees, which counts as let through, as in pictures.
    let mut mie = scene.clone();
    mie.clouds[0].droplets.phase = nephos::scene::Phase::Mie;
    let peak = f64::from(studio().sunlight_on(&mie, below, 9.0, 3).unwrap()[4]).ln() / -optical_depth;
    assert!((0.5..0.6).contains(&peak), "{peak}");
    // Inside of the ball, through half of it: not what is below counts, nor what is beside.
    let inside = studio().sunlight_on(&scene, DVec3::new(0.0, 500.0, 0.0), 3.0, 3).unwrap();
    assert!((f64::from(inside[4]) - (-0.5 * optical_depth).exp()).abs() < 0.003, "{}", inside[4]);
}

#[test]
fn without_a_sun_or_a_cloud_there_is_no_shadow() {
    let mut scene = scene(AROUND);
    scene.sun.position = nephos::scene::SunPosition::Direction(DVec3::NEG_Y);
    assert!(studio().shadows_of(&scene, 0.0).unwrap_err().to_string().contains("above the horizon"));
    assert!(studio().shadows_of(&Scene::default(), 0.0).unwrap_err().to_string().contains("no cloud"));
}

#[test]
fn openexr_reads_a_shadow_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shadow.exr");
    write_named(&path, [3, 2], &[("Y".to_owned(), vec![0.5; 6])]).unwrap();
    let Some(told) = readers::program("exrheader", &[path.to_str().unwrap()]) else { return };
    assert!(
        told.contains("Y, 16-bit floating-point") && told.contains("dataWindow (type box2i): (0 0) - (2 1)"),
        "{told}"
    );
}
