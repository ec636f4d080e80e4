//! Cameras to and from glTF, and meshes filled with ellipsoids.
#![cfg(all(feature = "export", feature = "import"))]

use std::{fmt::Write, fs, path::Path};

use crate::readers;
use glam::{DQuat, DVec3};
use nephos::{
    export::{write_camera, write_moving_camera},
    import::{Inside, Mesh, MovingCamera, fill, read_camera, read_mesh},
    scene::{Camera, Projection},
};

fn cameras() -> Vec<Camera> {
    let camera = |position: [f64; 3], target: [f64; 3], roll_deg, projection| Camera {
        position: position.into(),
        target: target.into(),
        roll_deg,
        projection,
        ..Camera::default()
    };
    vec![
        camera([150.0, 900.0, 600.0], [0.0, 1030.0, 0.0], 0.0, Projection::default()),
        camera(
            [-3000.0, 20.0, -8.0],
            [5.0, 4000.0, 30.0],
            -37.0,
            Projection::Perspective { vertical_fov_deg: 12.0 },
        ),
        camera([0.0, 5.0, 0.0], [0.0, 9.0, 0.0], 12.0, Projection::Orthographic { height: 300.0 }),
        camera(
            [1.0, 2.0, 3.0],
            [1.0, 2.0, 2.0],
            180.0,
            Projection::Lens { focal_length_mm: 50.0, sensor_width_mm: 36.0 },
        ),
        Camera {
            shift_x: 0.25,
            shift_y: -0.5,
            ..camera([1.0, 2.0, 3.0], [7.0, 2.0, 2.0], 0.0, Projection::default())
        },
    ]
}

#[test]
fn cameras_come_back_from_gltf() {
    let folder = tempfile::tempdir().unwrap();
    for (i, camera) in cameras().iter().enumerate() {
        for ending in ["glb", "gltf"] {
            let path = folder.path().join(format!("{i}.{ending}"));
            write_camera(&path, camera, 1.5).unwrap();
            let back = read_camera(&path, Some("camera")).unwrap();
            assert!(back.position.distance(camera.position) < 1e-3, "{back:?}");
            // Rotations are floats: 1e-7 rad.
            let (a, b) = (back.world_from_camera(), camera.world_from_camera());
            assert!(a.angle_between(b) < 1e-5, "{i}: {camera:?} {back:?}");
            let height = |camera: &Camera| match camera.projection {
                Projection::Orthographic { height } => height,
                lens => lens.vertical_fov(1.5).unwrap(),
            };
            assert!((height(&back) / height(camera) - 1.0).abs() < 1e-5, "{back:?}");
            assert_eq!([back.shift_x, back.shift_y], [camera.shift_x, camera.shift_y]);
        }
    }
}

/// A camera that flies and turns all the way round.
fn flight(time: f64) -> Camera {
    let turn = 1.3 * time;
    let position = DVec3::new(40.0 * time, 100.0 - 3.0 * time * time, -5.0);
    Camera { position, target: position + DVec3::new(turn.sin(), 0.2, turn.cos()), ..Camera::default() }
}

fn keys() -> Vec<(f64, Camera)> {
    (0..=120).map(|i| f64::from(i) / 24.0).map(|time| (time, flight(time))).collect()
}

#[test]
fn cameras_that_move_come_back_from_gltf() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.glb");
    write_moving_camera(&path, &keys(), 1.5).unwrap();
    let back = MovingCamera::read(&path, None).unwrap();
    assert_eq!(back.length(), 5.0);
    for (time, camera) in keys() {
        let found = back.at(time);
        // Floats: of 200 m, and of a rotation.
        assert!(found.position.distance(camera.position) < 1e-4, "{time}: {found:?}");
        assert!(found.world_from_camera().angle_between(camera.world_from_camera()) < 1e-5, "{time}");
    }
    // Between keys it goes the shorter way round.
    let (between, exact) = (back.at(2.51), flight(2.51));
    assert!(between.world_from_camera().angle_between(exact.world_from_camera()) < 1e-3);
}

#[test]
fn cameras_that_gltf_can_not_move_end_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, keys: &[(f64, Camera)]| {
        let path = folder.path().join(name);
        let error = write_moving_camera(&path, keys, 1.5).unwrap_err().to_string();
        assert!(!path.exists());
        error
    };
    let still = Camera::default();
    let zoom = Camera { projection: Projection::Perspective { vertical_fov_deg: 20.0 }, ..still.clone() };
    assert!(refused("a.gltf", &[(0.0, still.clone())]).contains(".glb"));
    assert!(refused("a.glb", &[]).contains("frames"));
    assert!(refused("a.glb", &[(-0.5, still.clone())]).contains("-0.5"));
    assert!(refused("a.glb", &[(0.0, still), (0.5, zoom)]).contains("0.5 seconds"));
}

#[test]
fn a_validator_of_gltf_finds_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    for (i, camera) in cameras().iter().enumerate() {
        let path = folder.path().join(format!("{i}.{}", ["glb", "gltf"][i % 2]));
        match i {
            0 => write_moving_camera(&path, &keys(), 1.5).unwrap(),
            _ => write_camera(&path, camera, 1.5).unwrap(),
        }
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/validate_gltf.js");
        let words = [script.to_str().unwrap(), path.to_str().unwrap()];
        let Some(told) = readers::node("gltf-validator", &words) else { return };
        let report: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!((&report["numErrors"], &report["numWarnings"]), (&0.into(), &0.into()), "{told}");
    }
}

#[test]
fn files_without_the_camera_say_which_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("camera.gltf");
    write_camera(&path, &cameras()[0], 1.5).unwrap();
    assert!(read_camera(&path, Some("shot 2")).unwrap_err().to_string().contains("`camera`"));
    fs::write(&path, r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}],"scene":0}"#).unwrap();
    assert!(read_camera(&path, None).unwrap_err().to_string().contains("has no camera"));
    fs::write(&path, "nothing").unwrap();
    assert!(read_camera(&path, None).unwrap_err().to_string().contains("no glTF 2.0 file"));
    let whole = Camera { projection: Projection::Equirectangular, ..cameras()[0].clone() };
    assert!(write_camera(&path, &whole, 1.5).unwrap_err().to_string().contains("equirectangular"));
}

/// A closed ball of triangles.
fn ball(center: DVec3, radii: DVec3) -> Mesh {
    let (rows, columns) = (24u32, 48u32);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..columns {
            let (a, b) = (
                std::f64::consts::PI * f64::from(row) / f64::from(rows),
                std::f64::consts::TAU * f64::from(column) / f64::from(columns),
            );
            mesh.positions.push(center + radii * DVec3::new(a.sin() * b.sin(), a.cos(), a.sin() * b.cos()));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let next = (column + 1) % columns;
            let at = |row: u32, column: u32| row * columns + column;
            mesh.triangles.push([at(row, column), at(row + 1, column), at(row + 1, next)]);
            mesh.triangles.push([at(row, column), at(row + 1, next), at(row, next)]);
        }
    }
    mesh
}

fn together(meshes: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for mesh in meshes {
        let first = all.positions.len() as u32;
        all.positions.extend(&mesh.positions);
        all.triangles.extend(mesh.triangles.iter().map(|triangle| triangle.map(|i| first + i)));
    }
    all
}

fn cube() -> Mesh {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 200.0;
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions: (0..8).map(corner).collect(), triangles }
}

#[test]
fn what_is_inside_has_the_volume_of_the_mesh() {
    let volume = |mesh: &Mesh| {
        let inside = Inside::new(mesh, 50);
        inside.points().len() as f64 * inside.step.powi(3)
    };
    let ball_volume = 4.0 / 3.0 * std::f64::consts::PI * 100.0 * 60.0 * 80.0;
    let one = ball(DVec3::new(5.0, 900.0, -30.0), DVec3::new(100.0, 60.0, 80.0));
    // The mesh's flat triangles take 1 % away.
    assert!((volume(&one) / ball_volume - 1.0).abs() < 0.02, "{}", volume(&one) / ball_volume);
    assert!((volume(&cube()) / 8e6 - 1.0).abs() < 0.03, "{}", volume(&cube()));
    // What overlaps counts once: two balls of which one is inside the other.
    let nested = together(&[one.clone(), ball(DVec3::new(5.0, 900.0, -30.0), DVec3::splat(40.0))]);
    assert!((volume(&nested) / volume(&one) - 1.0).abs() < 1e-9);
    // A triangle that is not there does not spoil it: two axes of three go past it.
    let mut holed = one.clone();
    holed.triangles.swap_remove(700);
    assert!((volume(&holed) / volume(&one) - 1.0).abs() < 0.01);
    assert!(Inside::new(&Mesh { triangles: one.triangles[..40].to_vec(), ..one }, 30).points().is_empty());
}

#[test]
fn a_ball_is_filled_by_one_ellipsoid_that_is_it() {
    let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
    let mut mesh = ball(DVec3::ZERO, DVec3::new(100.0, 60.0, 80.0));
    mesh.positions.iter_mut().for_each(|p| *p = turned * *p + DVec3::new(50.0, 900.0, 0.0));
    let filled = fill(&Inside::new(&mesh, 50), 1, 1).unwrap();
    let e = &filled.ellipsoids[0];
    assert!(filled.overlap > 0.95 && filled.ellipsoids.len() == 1, "{}", filled.overlap);
    assert!(e.center.distance(DVec3::new(50.0, 900.0, 0.0)) < 1.0, "{}", e.center);
    let mut radii = e.radii.to_array();
    radii.sort_by(f64::total_cmp);
    for (found, expected) in radii.iter().zip([60.0, 80.0, 100.0]) {
        assert!((found / expected - 1.0).abs() < 0.03, "{radii:?}");
    }
    let longest = e.orientation * DVec3::AXES[e.radii.max_position()];
    assert!(longest.dot(turned * DVec3::X).abs() > 0.99);
}

#[test]
fn more_ellipsoids_fill_better_and_overlap_most_of_the_mesh() {
    let heap = together(&[
        ball(DVec3::ZERO, DVec3::new(150.0, 50.0, 100.0)),
        ball(DVec3::new(60.0, 60.0, 0.0), DVec3::splat(70.0)),
        ball(DVec3::new(-70.0, 45.0, 20.0), DVec3::splat(55.0)),
    ]);
    for (mesh, least) in [(heap, 0.85), (cube(), 0.75)] {
        let inside = Inside::new(&mesh, 40);
        let [few, many] = [3, 24].map(|count| fill(&inside, count, 1).unwrap());
        assert!(
            many.overlap > least && many.overlap > few.overlap - 0.05,
            "{} {}",
            few.overlap,
            many.overlap
        );
        assert_eq!(many, fill(&inside, 24, 1).unwrap());
        assert!(many.ellipsoids.len() > 12);
    }
    let flat = Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Z], triangles: vec![[0, 1, 2]] };
    assert!(fill(&Inside::new(&flat, 20), 4, 1).unwrap_err().to_string().contains("encloses nothing"));
}

/// Quads between the points of a net, as two triangles each.
fn net(size: [u32; 2], at: impl Fn(u32, u32) -> DVec3) -> Mesh {
    let [columns, rows] = size;
    let corners = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
    let number = |column: u32, row: u32| row * (columns + 1) + column;
    let quads = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let triangles = quads.flat_map(|(column, row)| {
        let [a, b] = [number(column, row), number(column + 1, row)];
        let [c, d] = [number(column + 1, row + 1), number(column, row + 1)];
        [[a, c, b], [a, d, c]]
    });
    Mesh { triangles: triangles.collect(), positions: corners.map(|(column, row)| at(column, row)).collect() }
}

#[test]
fn sheets_are_refused_as_open_and_holes_are_told() {
    let hill = |x: u32, z: u32| {
        let (x, z) = (f64::from(x) * 10.0, f64::from(z) * 10.0);
        DVec3::new(x, 12.0 * (0.1 * x).sin() * (0.13 * z).cos() + 0.3 * x, z)
    };
    let slope =
        |x: u32, z: u32| DVec3::new(f64::from(x), f64::from(z) - 0.4 * f64::from(x), f64::from(z)) * 50.0;
    let without = |faces: &[usize]| {
        let mut mesh = cube();
        mesh.triangles = (0..12).filter(|i| !faces.contains(&(i / 2))).map(|i| mesh.triangles[i]).collect();
        mesh
    };
    for (name, mesh) in
        [("hills", net([20, 20], hill)), ("slope", net([1, 1], slope)), ("corner", without(&[0, 2, 4]))]
    {
        let error = fill(&Inside::new(&mesh, 40), 4, 1).unwrap_err().to_string();
        assert!(error.contains("open"), "{name}: {error}");
    }
    let mut turned = cube();
    turned.triangles[3].swap(0, 1);
    let mut bowl = ball(DVec3::ZERO, DVec3::new(100.0, 60.0, 80.0));
    bowl.triangles.truncate(bowl.triangles.len() / 2);
    for (name, mesh) in [("no lid", without(&[3])), ("turned", turned), ("bowl", bowl)] {
        let inside = Inside::new(&mesh, 40);
        assert!(inside.openness > 0.05 && inside.openness < 0.75, "{name}: {}", inside.openness);
        let filled = fill(&inside, 12, 1).unwrap();
        assert!(filled.overlap > 0.75, "{name}: {}", filled.overlap);
    }
    assert_eq!(Inside::new(&cube(), 40).openness, 0.0);
    assert_eq!(Inside::new(&ball(DVec3::ZERO, DVec3::new(100.0, 60.0, 80.0)), 40).openness, 0.0);
}

#[test]
fn meshes_are_read_from_obj_and_gltf() {
    let folder = tempfile::tempdir().unwrap();
    let cube = cube();
    let mut text = String::from("mtllib missing.mtl\no cube\n");
    for p in &cube.positions {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
    }
    // Quads, as modellers write them.
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        writeln!(text, "f {} {} {} {}", a + 1, b + 1, c + 1, d + 1).unwrap();
    }
    let path = folder.path().join("cube.obj");
    fs::write(&path, text).unwrap();
    let read = read_mesh(&path).unwrap();
    assert_eq!((read.triangles.len(), read.bounds()), (12, (DVec3::ZERO, DVec3::splat(200.0))));
    assert_eq!(Inside::new(&read, 10).points().len(), Inside::new(&cube, 10).points().len());
    let gltf = folder.path().join("cube.gltf");
    fs::write(&gltf, gltf_of(&cube)).unwrap();
    let read = read_mesh(&gltf).unwrap();
    // Its node is twice as large and moved up by 50 m.
    assert_eq!(read.bounds(), (DVec3::new(0.0, 50.0, 0.0), DVec3::new(400.0, 450.0, 400.0)));
    assert_eq!(Inside::new(&read, 10).points().len(), Inside::new(&cube, 10).points().len());
    let nowhere = gltf_of(&cube).replace(r#""POSITION":0"#, r#""POSITION":7"#);
    for (name, text) in [
        ("empty.obj", ""),
        ("bad.obj", "v 1 2\n"),
        ("bad.glb", "glTF"),
        ("nowhere.gltf", &nowhere),
        ("mesh.stl", "solid"),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        assert!(read_mesh(&path).unwrap_err().to_string().contains(name), "{name}");
    }
}

const BOX: &str = "v 0 0 0
v 2 0 0
v 2 3 0
v 0 3 0
v 0 0 5
v 2 0 5
v 2 3 5
v 0 3 5
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 4 8 7 3
f 1 5 8 4
f 2 3 7 6
";

/// Names, materials, coordinates of textures and the way that a file is written say nothing about shape.
#[test]
fn what_says_nothing_about_the_shape_keeps_no_obj_from_being_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.obj");
    let read = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let mesh = read_mesh(&path).unwrap();
        let volume: f64 = mesh.corners().map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!(
            (volume - 30.0).abs() < 1e-9 && mesh.triangles.len() == 12,
            "{}",
            String::from_utf8_lossy(bytes)
        );
    };
    let before = |head: &str| format!("{head}\n{BOX}");
    for text in [
        before("mtllib\nusemtl\no\ng\ns"),
        before("usemtl a b c # d\nmtllib x.mtl y.mtl\ns off\ns -1\nlod 3"),
        before("vt\nvt 0.5\nvt 1 2 3 4\nvn 1\nvn a b c\nvp 0.3\ncstype bezier\nend"),
        before("l 1 2\np 9\nf 1 2\nl 1/1 77/5"),
        before("call other.obj\ncsh echo\n\"quoted\"\n\0"),
        BOX.replace("v 2 3 5", "v 2 3 5 1.0 0.2 0.3 # corner"),
        BOX.replace("v 2 3 5", "  v\t2   3\t5e0"),
        BOX.replace("v 2 3 5", "v 2 \\\n3 \\\r\n 5"),
        BOX.replace("f 1 2 6 5", "f 1/1/1 2//3 6/900 5/"),
        BOX.replace("f 2 3 7 6", "f -7 -6 -2 -3"),
        BOX.replace('\n', "\r\n"),
        BOX.replace('\n', "\r"),
        BOX.trim_end().to_owned(),
        // Faces before their corners, and a corner that no face has.
        BOX.lines().rev().filter(|line| line.starts_with('f')).collect::<Vec<_>>().join("\n")
            + "\n"
            + &BOX.replace('f', "#")
            + "v nan 1 2",
    ] {
        read(text.as_bytes());
    }
    read(&[b"\xef\xbb\xbf", BOX.as_bytes()].concat());
    read(&[b"o H\xf6henwolke\n# \x93quoted\x94\ng \xff\xfe\n", BOX.as_bytes()].concat());
}

#[test]
fn lines_of_an_obj_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.obj");
    for (right, wrong, line, word) in [
        ("v 2 3 5", "v 2 3", 7, "three numbers"),
        ("v 2 3 5", "v 2,0 3,0 5,0", 7, "three numbers"),
        ("f 1 2 6 5", "f 1 2 six 5", 11, "`six`"),
        ("f 1 2 6 5", "f 1 2 9 5", 11, "`9`"),
        ("f 1 2 6 5", "f 1 2 0 5", 11, "`0`"),
        ("f 1 2 6 5", "f 1 2 -9 5", 11, "`-9`"),
        ("f 1 2 6 5", "f 1 2 99999999999999999999 5", 11, "`99999999999999999999`"),
    ] {
        fs::write(&path, BOX.replace(right, wrong)).unwrap();
        let error = read_mesh(&path).unwrap_err().to_string();
        assert!(error.contains(&format!("line {line}")) && error.contains(word), "{wrong}: {error}");
    }
    let wide: Vec<u8> = "\u{feff}v 0 0 0".encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(&path, wide).unwrap();
    let error = read_mesh(&path).unwrap_err().to_string();
    assert!(error.contains("UTF-16"), "{error}");
}

/// What the reader of glTF files trusts, and no file need keep to.
#[test]
fn numbers_of_a_mesh_that_are_not_there_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, path) = (gltf_of(&cube()), folder.path().join("cube.gltf"));
    for (right, wrong, accessor) in [
        (r#""type":"VEC3""#, r#""type":"VEC2""#, 0),
        (r#""componentType":5126"#, r#""componentType":5123"#, 0),
        (r#""count":8"#, r#""count":9"#, 0),
        (r#""count":8"#, r#""count":0"#, 0),
        (r#""count":8"#, r#""count":18446744073709551615"#, 0),
        (r#""byteLength":96"#, r#""byteLength":96,"byteStride":8"#, 0),
        (r#""componentType":5123"#, r#""componentType":5126"#, 1),
        (r#""type":"SCALAR""#, r#""type":"VEC2""#, 1),
        (r#""byteOffset":96"#, r#""byteOffset":97"#, 1),
    ] {
        assert!(whole.contains(right), "{right} is in {whole}");
        fs::write(&path, whole.replace(right, wrong)).unwrap();
        let error = read_mesh(&path).unwrap_err().to_string();
        assert!(error.contains(&format!("accessor {accessor} ")), "{wrong}: {error}");
    }
}

#[test]
fn a_ring_of_nodes_is_gone_round_once() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, path) = (gltf_of(&cube()), folder.path().join("ring.gltf"));
    fs::write(&path, whole.replace(r#"{"mesh":0}"#, r#"{"children":[0,0,1],"mesh":0}"#)).unwrap();
    assert_eq!(read_mesh(&path).unwrap().triangles.len(), 12);
}

/// With its data inside, in base64.
fn gltf_of(mesh: &Mesh) -> String {
    let mut bytes: Vec<u8> =
        mesh.positions.iter().flat_map(|p| p.as_vec3().to_array()).flat_map(f32::to_le_bytes).collect();
    let positions = bytes.len();
    bytes.extend(mesh.triangles.iter().flatten().flat_map(|&i| (i as u16).to_le_bytes()));
    serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"translation": [0, 50, 0], "scale": [2, 2, 2], "children": [1]}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": mesh.positions.len(), "type": "VEC3", "min": [0, 0, 0], "max": [200, 200, 200]},
            {"bufferView": 1, "componentType": 5123, "count": 3 * mesh.triangles.len(), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": positions},
            {"buffer": 0, "byteOffset": positions, "byteLength": bytes.len() - positions},
        ],
        "buffers": [{"byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{}", base64(&bytes))}],
    })
    .to_string()
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let n = chunk.iter().fold(0u32, |n, byte| n << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        for k in 0..4 {
            let letter = LETTERS[(n >> (18 - 6 * k) & 63) as usize] as char;
            text.push(if k <= chunk.len() { letter } else { '=' });
        }
    }
    text
}
