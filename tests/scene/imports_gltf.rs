//! glTF 2.0 read as it is written: each test makes a box in one of the ways that the standard knows.
#![cfg(all(feature = "export", feature = "import"))]

use std::{fs, path::PathBuf};

use glam::DVec3;
use nephos::import::{Mesh, read_camera, read_mesh};
use serde_json::{Value, json};

/// Triangles of the box whose corner i has x, y, z by the bits of i.
const FACES: [[u16; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// A box from 0 to 2, 3 and 5 m along x, y, z.
const SIZE: [f32; 3] = [2.0, 3.0, 5.0];
const VOLUME: f64 = 30.0;

fn corner(i: usize) -> [f32; 3] {
    std::array::from_fn(|axis| if i >> axis & 1 == 1 { SIZE[axis] } else { 0.0 })
}

fn floats(values: impl IntoIterator<Item = f32>) -> Vec<u8> {
    values.into_iter().flat_map(f32::to_le_bytes).collect()
}

fn shorts(values: impl IntoIterator<Item = u16>) -> Vec<u8> {
    values.into_iter().flat_map(u16::to_le_bytes).collect()
}

/// A document of one scene whose parts tests change, and the bytes of its views, one file of bytes each.
struct Asset {
    folder: tempfile::TempDir,
    document: Value,
    views: Vec<Vec<u8>>,
}

impl Asset {
    /// Accessor 0 has the corners, accessor 1 the order of `order`.
    fn new(order: &[u16]) -> Self {
        let corners = floats((0..8).flat_map(corner));
        let document = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5123, "count": order.len(), "type": "SCALAR"},
            ],
        });
        Self {
            folder: tempfile::tempdir().unwrap(),
            document,
            views: vec![corners, shorts(order.iter().copied())],
        }
    }

    fn boxed() -> Self {
        Self::new(FACES.as_flattened())
    }

    fn with(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        match self.document.pointer_mut(parent).unwrap() {
            Value::Array(list) => match key.parse::<usize>() {
                Ok(at) => list[at] = value,
                Err(_) => list.push(value),
            },
            object => object[key] = value,
        }
        self
    }

    /// Adds bytes with an accessor of them.
    fn and(mut self, bytes: Vec<u8>, accessor: Value) -> Self {
        let mut accessor = accessor;
        accessor["bufferView"] = self.views.len().into();
        self.views.push(bytes);
        self.with("/accessors/-", accessor)
    }

    fn file(&self) -> PathBuf {
        let mut document = self.document.clone();
        let views = self.views.iter().enumerate();
        document["bufferViews"] = views
            .clone()
            .map(|(i, bytes)| {
                let mut view = json!({"buffer": i, "byteLength": bytes.len()});
                if let Some(stride) = self.document.pointer(&format!("/strides/{i}")) {
                    view["byteStride"] = stride.clone();
                }
                view
            })
            .collect();
        document["buffers"] = views
            .map(|(i, bytes)| json!({"uri": format!("bytes%20{i}.bin"), "byteLength": bytes.len()}))
            .collect();
        for (i, bytes) in self.views.iter().enumerate() {
            fs::write(self.folder.path().join(format!("bytes {i}.bin")), bytes).unwrap();
        }
        let path = self.folder.path().join("box.gltf");
        fs::write(&path, document.to_string()).unwrap();
        path
    }

    fn read(&self) -> Mesh {
        read_mesh(&self.file()).unwrap()
    }

    fn refused(&self) -> String {
        read_mesh(&self.file()).unwrap_err().to_string()
    }
}

/// What the faces enclose, m3, less than 0 where they look inwards.
fn volume(mesh: &Mesh) -> f64 {
    mesh.corners().map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

#[test]
fn places_that_mirror_turn_faces_round() {
    let mirrored = json!([{"mesh": 0, "scale": [-1, 1, 1]}]);
    let by_matrix = json!([{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1]}]);
    let by_parent = json!([{"children": [1], "scale": [1, -1, 1]}, {"mesh": 0, "scale": [1, 1, 2]}]);
    let twice = json!([{"children": [1], "scale": [1, -1, 1]}, {"mesh": 0, "scale": [1, 1, -2]}]);
    for (nodes, times) in [(mirrored, 1.0), (by_matrix, 1.0), (by_parent, 2.0), (twice, 2.0)] {
        let mesh = Asset::boxed().with("/nodes", nodes.clone()).read();
        assert!((volume(&mesh) - times * VOLUME).abs() < 1e-4, "{nodes}: {}", volume(&mesh));
    }
}

#[test]
fn strips_and_fans_are_triangles() {
    let primitive = |order: &[u16], mode: u32| {
        let asset = Asset::new(order);
        volume(&asset.with("/meshes/0/primitives/0/mode", mode.into()).read())
    };
    let round = primitive(&[2, 3, 6, 7, 5, 3, 1, 2, 0, 6, 4, 5, 0, 1], 5);
    assert!((round.abs() - VOLUME).abs() < 1e-4, "{round}");
    // A side each.
    let sides = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
    let sum: f64 = sides.iter().map(|side| primitive(side, 5)).sum();
    assert!((sum - VOLUME).abs() < 1e-4, "{sum}");
    // Three sides each.
    let sum = primitive(&[0, 1, 5, 4, 6, 2, 3, 1], 6) + primitive(&[7, 5, 1, 3, 2, 6, 4, 5], 6);
    assert!((sum - VOLUME).abs() < 1e-4, "{sum}");
    // Without numbers corners are taken in their order.
    let fan = json!([{"attributes": {"POSITION": 0}, "mode": 6}]);
    assert_eq!(Asset::boxed().with("/meshes/0/primitives", fan).read().triangles.len(), 6);
    let lines = json!([{"attributes": {"POSITION": 0}, "mode": 3}]);
    assert!(Asset::boxed().with("/meshes/0/primitives", lines).refused().contains("no triangles"));
}

#[test]
fn sparse_numbers_stand_in_place_of_those_of_the_view_or_of_zeros() {
    // The box is pushed to twice its height, by corners that stand on top: those of the bit of y.
    let tops = [2u16, 3, 6, 7];
    let places = tops.iter().flat_map(|&i| {
        let [x, y, z] = corner(i as usize);
        [x, 2.0 * y, z]
    });
    let sparse = |count: usize| {
        json!({
            "count": count,
            "indices": {"bufferView": 2, "componentType": 5123},
            "values": {"bufferView": 3}
        })
    };
    let mut pushed = Asset::boxed().with("/accessors/0/sparse", sparse(4));
    pushed.views.extend([shorts(tops), floats(places)]);
    assert!((volume(&pushed.read()) - 2.0 * VOLUME).abs() < 1e-4);
    // Seven of eight corners, for one is zero.
    let own = json!({"componentType": 5126, "count": 8, "type": "VEC3", "sparse": sparse(7)});
    let mut alone = Asset::boxed().with("/accessors/0", own);
    alone.views.extend([shorts(1..8), floats((1..8).flat_map(corner))]);
    assert!((volume(&alone.read()) - VOLUME).abs() < 1e-4);
    // Numbers of triangles may be sparse, too.
    let own = json!({"componentType": 5123, "count": 36, "type": "SCALAR", "sparse": sparse(36)});
    let mut order = Asset::boxed().with("/accessors/1", own);
    order.views.extend([shorts(0..36), shorts(FACES.as_flattened().iter().copied())]);
    assert!((volume(&order.read()) - VOLUME).abs() < 1e-4);
    // What is not there is told.
    let mut beyond = Asset::boxed().with("/accessors/0/sparse", sparse(4));
    beyond.views.extend([shorts([2, 3, 6, 8]), floats([0.0; 12])]);
    assert!(beyond.refused().contains("accessor 0 "), "{}", beyond.refused());
    let endless = json!({"componentType": 5126, "count": u64::MAX, "type": "VEC3"});
    assert!(Asset::boxed().with("/accessors/0", endless).refused().contains("accessor 0 "));
}

/// KHR_mesh_quantization: whole numbers of each size, normalized or not, with gaps between corners.
#[test]
fn whole_numbers_may_stand_for_corners() {
    let bits = || (0..8).map(|i: usize| [i & 1, i >> 1 & 1, i >> 2]);
    for (component, bytes, one, normalized) in [
        (5120, 1, 127u16, true),
        (5121, 1, 255, true),
        (5122, 2, 32767, true),
        (5123, 2, 65535, true),
        (5121, 1, 1, false),
        (5122, 2, 1, false),
    ] {
        let corner = |bits: [usize; 3]| {
            let mut corner: Vec<u8> =
                bits.iter().flat_map(|&bit| (bit as u16 * one).to_le_bytes()[..bytes].to_vec()).collect();
            corner.resize(4 * bytes, 0);
            corner
        };
        let stored = json!({
            "bufferView": 0, "componentType": component, "normalized": normalized, "count": 8, "type": "VEC3"
        });
        let mut asset = Asset::boxed()
            .with("/accessors/0", stored)
            .with("/nodes", json!([{"mesh": 0, "scale": SIZE}]))
            .with("/strides", json!({"0": 4 * bytes}));
        asset.views[0] = bits().flat_map(corner).collect();
        let refused = asset.refused();
        assert!(refused.contains("accessor 0 "), "not without the extension: {refused}");
        let asset = asset.with("/extensionsUsed", json!(["KHR_mesh_quantization"]));
        let asset = asset.with("/extensionsRequired", json!(["KHR_mesh_quantization"]));
        assert!((volume(&asset.read()) - VOLUME).abs() < 1e-3, "{component} {normalized}");
    }
}

#[test]
fn copies_are_all_there() {
    let attributes = json!({"TRANSLATION": 2, "ROTATION": 3, "SCALE": 4});
    let told = json!([{
        "mesh": 0, "translation": [0, 7, 0],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    }]);
    let half = 0.5f32.sqrt();
    let asset = Asset::boxed()
        .with("/nodes", told)
        .with("/extensionsRequired", json!(["EXT_mesh_gpu_instancing"]))
        .and(
            floats([0.0, 0.0, 0.0, 100.0, 0.0, 0.0, -50.0, 0.0, 0.0]),
            json!({"componentType": 5126, "count": 3, "type": "VEC3"}),
        )
        .and(
            floats([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half, 0.0, 0.0, 0.0, 1.0]),
            json!({"componentType": 5126, "count": 3, "type": "VEC4"}),
        )
        .and(
            floats([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0, 2.0, 1.0]),
            json!({"componentType": 5126, "count": 3, "type": "VEC3"}),
        );
    let mesh = asset.read();
    assert!((volume(&mesh) - 4.0 * VOLUME).abs() < 1e-3, "{}", volume(&mesh));
    // The second is turned from x to y: 3 m to the left, 2 m high.
    let (low, high) = mesh.bounds();
    assert!(low.distance(DVec3::new(-52.0, 7.0, 0.0)) < 1e-4, "{low}");
    assert!(high.distance(DVec3::new(100.0, 13.0, 5.0)) < 1e-4, "{high}");
}

#[test]
fn joints_place_a_skinned_mesh_and_its_node_does_not() {
    // The lower four corners hang on a joint that stays, the upper ones on one that has risen by 3 m since it was bound.
    let nodes = json!([
        {"children": [1, 2, 3]},
        {"mesh": 0, "skin": 0, "scale": [9, -9, 9], "translation": [1000, 0, 0]},
        {"translation": [1, 0, 0]},
        {"translation": [0, 6, 0]}
    ]);
    let shift = |x: f32, y: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, 0.0, 1.0];
    let joints = (0..8u8).flat_map(|i| [i >> 1 & 1, 0, 0, 0]).collect();
    let mut asset = Asset::boxed()
        .with("/nodes", nodes)
        .with("/skins", json!([{"inverseBindMatrices": 2, "joints": [2, 3]}]))
        .with("/meshes/0/primitives/0/attributes", json!({"POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 4}))
        .and(
            floats([shift(-1.0, 0.0), shift(0.0, -3.0)].concat()),
            json!({"componentType": 5126, "count": 2, "type": "MAT4"}),
        )
        .and(joints, json!({"componentType": 5121, "count": 8, "type": "VEC4"}))
        .and(
            [255, 0, 0, 0].repeat(8),
            json!({"componentType": 5121, "normalized": true, "count": 8, "type": "VEC4"}),
        );
    let mesh = asset.read();
    assert!((volume(&mesh) - 2.0 * VOLUME).abs() < 1e-3, "{}", volume(&mesh));
    assert_eq!(mesh.bounds(), (DVec3::ZERO, DVec3::new(2.0, 6.0, 5.0)));
    // Without matrices they were bound where the world begins.
    asset = asset.with("/skins", json!([{"joints": [2, 3]}]));
    assert_eq!(asset.read().bounds(), (DVec3::ZERO, DVec3::new(3.0, 9.0, 5.0)));
}

#[test]
fn weights_move_corners_to_their_targets() {
    let up = (0..8).flat_map(|i| [0.0, if i & 2 == 2 { 3.0 } else { 0.0 }, 0.0]);
    let asset = Asset::boxed()
        .and(floats(up), json!({"componentType": 5126, "count": 8, "type": "VEC3"}))
        .with("/meshes/0/primitives/0/targets", json!([{"POSITION": 2}]));
    assert!((volume(&asset.read()) - VOLUME).abs() < 1e-4);
    let asset = asset.with("/meshes/0/weights", json!([1.0]));
    assert!((volume(&asset.read()) - 2.0 * VOLUME).abs() < 1e-4);
    let asset = asset.with("/nodes", json!([{"mesh": 0, "weights": [0.5]}]));
    assert!((volume(&asset.read()) - 1.5 * VOLUME).abs() < 1e-4);
}

#[test]
fn extensions_count_where_they_concern_the_mesh() {
    for name in ["KHR_texture_transform", "KHR_materials_unlit", "KHR_texture_basisu", "ACME_sound"] {
        let asset = Asset::boxed()
            .with("/extensionsRequired", json!([name]))
            .with("/materials", json!([{"extensions": {name: {"offset": "any"}}, "alphaMode": 7}]))
            .with("/images", json!([{"uri": "missing.png"}]));
        assert!((volume(&asset.read()) - VOLUME).abs() < 1e-4, "{name}");
    }
    let draco = Asset::boxed()
        .with("/extensionsRequired", json!(["KHR_draco_mesh_compression"]))
        .with("/meshes/0/primitives/0/extensions", json!({"KHR_draco_mesh_compression": {"bufferView": 0}}));
    let foreign = Asset::boxed()
        .with("/extensionsRequired", json!(["ACME_bent_space"]))
        .with("/nodes", json!([{"mesh": 0, "extensions": {"ACME_bent_space": {}}}]));
    for (asset, name, way_out) in
        [(draco, "KHR_draco_mesh_compression", "compression off"), (foreign, "ACME_bent_space", "without")]
    {
        let refused = asset.refused();
        assert!(refused.contains(name) && refused.contains(way_out), "{refused}");
    }
    // Compressed, with no word of it at the top.
    let mut asset = Asset::boxed()
        .with("/accessors/0", json!({"componentType": 5126, "count": 8, "type": "VEC3"}))
        .with("/meshes/0/primitives/0/extensions", json!({"KHR_draco_mesh_compression": {"bufferView": 0}}));
    assert!(asset.refused().contains("compression off"), "{}", asset.refused());
    let hidden =
        json!([{"children": [1], "extensions": {"KHR_node_visibility": {"visible": false}}}, {"mesh": 0}]);
    asset = Asset::boxed().with("/nodes", hidden);
    assert!(asset.refused().contains("no triangles"));
}

#[test]
fn views_that_are_compressed_are_refused_by_name() {
    let asset = Asset::boxed();
    let path = asset.file();
    let text = fs::read_to_string(&path).unwrap();
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let packed = format!(r#""bufferViews":[{{"extensions":{{"{name}":{{"buffer":1}}}},"#);
        fs::write(&path, text.replace(r#""bufferViews":[{"#, &packed)).unwrap();
        let refused = read_mesh(&path).unwrap_err().to_string();
        assert!(refused.contains(name) && refused.contains("compression off"), "{refused}");
    }
}

#[test]
fn files_of_bytes_are_named_where_they_are_missing_or_short() {
    let asset = Asset::boxed();
    let path = asset.file();
    let bytes = asset.folder.path().join("bytes 0.bin");
    fs::write(&bytes, [0; 90]).unwrap();
    let short = read_mesh(&path).unwrap_err().to_string();
    assert!(short.contains("bytes%200.bin") && short.contains("90 bytes where 96"), "{short}");
    fs::remove_file(&bytes).unwrap();
    let missing = read_mesh(&path).unwrap_err().to_string();
    assert!(missing.contains("bytes 0.bin") && missing.contains("box.gltf"), "{missing}");
    // Cameras need none of it.
    assert!(read_camera(&path, None).unwrap_err().to_string().contains("has no camera"));
}

#[test]
fn corners_that_no_triangle_has_do_not_count() {
    for stray in [1e6, f32::NAN] {
        let mut asset = Asset::boxed().with("/accessors/0/count", json!(9));
        asset.views[0].extend(floats([stray, 0.0, 0.0]));
        assert_eq!(asset.read().bounds(), (DVec3::ZERO, DVec3::from(SIZE.map(f64::from))));
    }
}

#[test]
fn other_versions_are_named() {
    let old = Asset::boxed().with("/asset", json!({"version": "1.0"}));
    assert!(old.refused().contains("version is `1.0`"), "{}", old.refused());
    // A file may have no scene; then its trees are shown.
    let mut asset =
        Asset::boxed().with("/nodes", json!([{"mesh": 0}, {"children": [0], "scale": [2, 1, 1]}]));
    let document = asset.document.as_object_mut().unwrap();
    document.retain(|key, _| !key.starts_with("scene"));
    assert!((volume(&asset.read()) - 2.0 * VOLUME).abs() < 1e-4);
}
