//! The density in voxels, and volumes as other programs read them.
#![cfg(feature = "export")]

use crate::common;

use std::{collections::BTreeMap, f64::consts::PI, fs, path::Path};

use common::{gpu, hull::extinction_at, picture::scene, readers};
use glam::{DVec3, IVec3};
use nephos::{
    export::{VdbOptions, write_vdb, write_vdb_with, write_vol},
    render::{Frame, VoxelGrid, Voxels},
    scene::{Preset, Scene},
};

/// A turned ellipsoid without noise, off the axes; its extinction is 400e6 2 pi (6e-6)^2.
const PLAIN: &str = r#"{"clouds":[{"edge":{"boundary":0},"ellipsoids":[{"center":[-300,900,70],
    "radii":[120,60,90],"orientation":[0.2,0.1,0.3,0.9]}]}]}"#;
const EXTINCTION: f64 = 400e6 * 2.0 * PI * 36e-12;
const NOISY: &str = r#"{"clouds":[{"edge":{"boundary":45,"wispiness":0.3},"ellipsoids":[
    {"center":[-130,900,70],"radii":[90,60,70]},{"center":[-60,930,50],"radii":[70,70,60],"density":0.5}]},
    {"droplets":{"concentration_per_cm3":100},"ellipsoids":[{"center":[140,-20,-2000],"radii":[50,50,50]}]}]}"#;

fn sampled(scene: &Scene, grid: VoxelGrid) -> Voxels {
    Voxels::sample(gpu(), &Frame::new(scene, [1, 1]).unwrap(), grid, &mut |_| ()).unwrap()
}

fn values(volume: &Voxels) -> BTreeMap<[i32; 3], f32> {
    volume.filled().map(|(at, value)| (at.to_array(), value)).collect()
}

#[test]
fn voxels_hold_the_matter_of_an_ellipsoid_in_its_place() {
    let grid = VoxelGrid::new(5.0);
    let volume = sampled(&scene(PLAIN), grid);
    let (mut mass, mut middle) = (0.0, DVec3::ZERO);
    for (at, value) in volume.filled() {
        mass += 125.0 * f64::from(value);
        middle += 125.0 * f64::from(value) * 5.0 * at.as_dvec3();
    }
    let whole = EXTINCTION * 4.0 / 3.0 * PI * 120.0 * 60.0 * 90.0;
    // 27 samples in each of some 6000 voxels on the surface: their noise is far below a thousandth.
    assert!((mass / whole - 1.0).abs() < 1e-3, "{mass} {whole}");
    assert!((middle / mass).distance(DVec3::new(-300.0, 900.0, 70.0)) < 0.05, "{}", middle / mass);
    let core = values(&volume)[&[-60, 180, 14]];
    assert!((f64::from(core) / EXTINCTION - 1.0).abs() < 1e-6);
}

#[test]
fn a_voxel_is_the_mean_of_the_density_that_pictures_are_drawn_with() {
    // One sample a voxel against the density's own functions, by the noise's mean at a corner:
    // finer samples have the same mean over all voxels.
    let scene = scene(NOISY);
    let one = sampled(&scene, VoxelGrid { samples: 1, ..VoxelGrid::new(8.0) });
    let many = sampled(&scene, VoxelGrid { samples: 5, ..VoxelGrid::new(8.0) });
    let sum = |volume: &Voxels| volume.filled().map(|(_, value)| f64::from(value)).sum::<f64>();
    assert!((sum(&one) / sum(&many) - 1.0).abs() < 0.01, "{} {}", sum(&one), sum(&many));
    // Halved voxels hold, eight by eight, what one voxel does: the same samples.
    let halves = sampled(&scene, VoxelGrid { samples: 1, ..VoxelGrid::new(4.0) });
    assert!((sum(&halves) / 8.0 / sum(&many) - 1.0).abs() < 0.005);
}

#[test]
fn overlapping_lumps_count_once_by_the_mean_of_their_densities() {
    let text = r#"{"clouds":[{"blend":0.7,"edge":{"boundary":0},"ellipsoids":[{"center":[0,0,0],
        "radii":[50,50,50]},{"center":[30,0,0],"radii":[50,50,50],"density":0.5}]}]}"#;
    let scene = scene(text);
    let volume = values(&sampled(&scene, VoxelGrid::new(10.0)));
    for x in [-3, 0, 1, 2, 4, 6] {
        // The mean of 27 cells, where the voxel's are drawn at random; it hardly changes within.
        let cell = |i: i32| DVec3::new(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1));
        let middle = DVec3::new(10.0 * f64::from(x), 0.0, 0.0);
        let cells = (0..27).map(|i| extinction_at(&scene.clouds[0], 0.0, middle + 10.0 / 3.0 * cell(i)));
        let wanted = cells.sum::<f64>() / 27.0;
        let found = f64::from(volume[&[x, 0, 0]]);
        assert!((found / wanted - 1.0).abs() < 0.02, "{x}: {found} for {wanted}");
    }
    let thin = f64::from(volume[&[6, 0, 0]]) / EXTINCTION;
    assert!((thin - 0.5).abs() < 1e-6, "where one is alone, it is its own: {thin}");
}

#[test]
fn of_overlapping_clouds_the_denser_one_counts() {
    let text = r#"{"clouds":[{"edge":{"boundary":0},"ellipsoids":[{"center":[0,0,0],"radii":[50,50,50]}]},
        {"edge":{"boundary":0},"ellipsoids":[{"center":[30,0,0],"radii":[50,50,50],"density":0.5}]}]}"#;
    let volume = values(&sampled(&scene(text), VoxelGrid::new(10.0)));
    assert!((f64::from(volume[&[1, 0, 0]]) / EXTINCTION - 1.0).abs() < 1e-6);
    assert!((f64::from(volume[&[6, 0, 0]]) / EXTINCTION - 0.5).abs() < 1e-6);
}

#[test]
fn with_z_up_north_is_y_and_the_cloud_the_same() {
    let scene = scene(NOISY);
    let grid = VoxelGrid::new(10.0);
    let (y_up, z_up) = (values(&sampled(&scene, grid)), values(&sampled(&scene, grid.z_up())));
    assert_eq!(y_up.len(), z_up.len());
    for ([x, y, z], value) in &y_up {
        let turned = z_up[&[*x, -z, *y]];
        // Coordinates are rounded another way.
        assert!((turned - value).abs() < 2e-4, "{x} {y} {z}: {value} {turned}");
    }
}

#[test]
fn openvdb_reads_values_transform_and_active_voxels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.vdb");
    // Across the borders of upper nodes: x is on both sides of 0, z 500 voxels apart.
    let volume = sampled(&scene(NOISY), VoxelGrid::new(4.0));
    write_vdb(&path, &volume).unwrap();
    let filled: Vec<_> = volume.filled().collect();
    let mut asked: Vec<_> = filled.iter().step_by(filled.len() / 400).map(|(at, _)| *at).collect();
    let (first, last) = volume.bounds().unwrap();
    asked.push(first - 1);
    let words: Vec<_> = asked.iter().map(|at| format!("{},{},{}", at.x, at.y, at.z)).collect();
    let mut all = vec![path.to_str().unwrap()];
    all.extend(words.iter().map(String::as_str));
    let Some(told) = readers::python("pyopenvdb", "openvdb_volume.py", &all) else { return };
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!((&told["grids"], &told["class"]), (&["density"].into(), &"fog volume".into()));
    assert_eq!((&told["type"], &told["background"]), (&"FloatGrid".into(), &0.0.into()));
    assert_eq!(told["active"], filled.len());
    assert_eq!(told["bounds"], serde_json::json!([first.to_array(), last.to_array()]));
    assert_eq!(told["voxel"], serde_json::json!([4.0, 4.0, 4.0]));
    assert_eq!(told["metadata"]["quantity"], "extinction coefficient, 1/m");
    let values = values(&volume);
    for (i, at) in asked.iter().enumerate() {
        let value = values.get(&at.to_array()).copied().unwrap_or(0.0);
        assert_eq!(told["values"][i].as_f64().unwrap() as f32, value, "{at}");
        assert_eq!(told["world"][i], serde_json::json!((4.0 * at.as_dvec3()).to_array()));
    }
}

/// A cloud that drifts to the east and another one that is carried by a curve, each in its own place.
fn moving() -> Scene {
    let mut scene = scene(NOISY);
    scene.wind.velocity = DVec3::new(7.0, 0.0, -3.0);
    let track = r#"{"length":10,"fps":24,"tracks":[{"path":"clouds[1].ellipsoids[0].center[1]","keys":[
        {"time":0,"value":-20,"interpolation":"linear"},{"time":10,"value":80}]}]}"#;
    scene.timeline = Some(serde_json::from_str(track).unwrap());
    scene
}

#[test]
fn openvdb_reads_velocities_and_halves() {
    let folder = tempfile::tempdir().unwrap();
    let grid = VoxelGrid::new(8.0).z_up();
    let scene = moving();
    let volume = sampled(&scene.at(0.0).unwrap(), grid);
    let movement = scene.movement(0.0, 1.0 / 24.0).unwrap();
    let velocity = |p: DVec3| 24.0 * movement.nearest(p);
    let filled: Vec<_> = volume.filled().collect();
    for half in [false, true] {
        let path = folder.path().join(format!("moving-{half}.vdb"));
        write_vdb_with(&path, &volume, VdbOptions { half, velocity: Some(&velocity) }).unwrap();
        let asked: Vec<_> = filled.iter().step_by(filled.len() / 300).collect();
        let words: Vec<_> = asked.iter().map(|(at, _)| format!("{},{},{}", at.x, at.y, at.z)).collect();
        let mut all = vec![path.to_str().unwrap()];
        all.extend(words.iter().map(String::as_str));
        let Some(told) = readers::python("pyopenvdb", "openvdb_volume.py", &all) else { return };
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!(told["grids"], serde_json::json!(["density", "vel"]));
        let vel = &told["others"][0];
        assert_eq!((&vel["type"], &vel["active"]), (&"Vec3SGrid".into(), &filled.len().into()));
        assert_eq!((&told["active"], &told["type"]), (&filled.len().into(), &"FloatGrid".into()));
        // Half floats are good to 1 in 2048 down to 2^-14, and to 2^-25 below.
        let near = if half { 1.0 / 2048.0 } else { 1e-6 };
        let mut carried = 0;
        for (i, (at, value)) in asked.iter().enumerate() {
            let found = told["values"][i].as_f64().unwrap();
            let value = f64::from(*value);
            assert!((found - value).abs() <= near * value.max(2f64.powi(-14)), "{at}: {found} {value}");
            // South of -1000 m there is the cloud that the curve carries; y of the file is north, z up.
            let is_carried = 8 * at.y > 1000;
            carried += u32::from(is_carried);
            let expected = [7.0, 3.0, if is_carried { 10.0 } else { 0.0 }];
            for (c, expected) in expected.into_iter().enumerate() {
                let found = vel["values"][i][c].as_f64().unwrap();
                assert!((found - expected).abs() <= 10.0 * near.max(1e-5), "{at} {c}: {found} {expected}");
            }
        }
        assert!(carried > 10 && carried < asked.len() as u32 - 10, "{carried}");
    }
    let size = |half: bool| {
        let path = folder.path().join(format!("{half}.vdb"));
        write_vdb_with(&path, &volume, VdbOptions { half, velocity: None }).unwrap();
        fs::metadata(path).unwrap().len() as f64
    };
    // Zipped floats take two to three bytes a voxel, halves half of that; the tree takes the same in both.
    let saved = (size(false) - size(true)) / filled.len() as f64;
    assert!((0.7..2.5).contains(&saved), "{saved} bytes a voxel");
}

#[test]
fn a_volume_of_mitsuba_has_its_box_where_the_cloud_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.vol");
    let volume = sampled(&Preset::Kol.scene(1), VoxelGrid::new(20.0));
    write_vol(&path, &volume).unwrap();
    let (first, last) = volume.bounds().unwrap();
    let (size, faces, voxels) = read_vol(&path);
    assert_eq!(size, last - first + 3);
    let expected = [first.as_vec3() - 1.5, last.as_vec3() + 1.5].map(|corner| 20.0 * corner);
    assert_eq!(faces, expected.map(|corner| corner.to_array()).concat());
    let values = values(&volume);
    let mut i = 0;
    for z in first.z - 1..=last.z + 1 {
        for y in first.y - 1..=last.y + 1 {
            for x in first.x - 1..=last.x + 1 {
                assert_eq!(voxels[i], values.get(&[x, y, z]).copied().unwrap_or(0.0));
                i += 1;
            }
        }
    }
    assert_eq!(i, voxels.len());
}

fn read_vol(path: &Path) -> (IVec3, Vec<f32>, Vec<f32>) {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[..8], b"VOL\x03\x01\0\0\0");
    let head: Vec<i32> = bytemuck::pod_collect_to_vec(&bytes[8..24]);
    assert_eq!(head[3], 1);
    let numbers: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes[24..]);
    (IVec3::new(head[0], head[1], head[2]), numbers[..6].to_vec(), numbers[6..].to_vec())
}

#[test]
fn volumes_that_cannot_be_are_refused_in_words() {
    let refusal = |scene: &Scene, voxel: f64| {
        let frame = Frame::new(scene, [1, 1]).unwrap();
        Voxels::sample(gpu(), &frame, VoxelGrid::new(voxel), &mut |_| ()).unwrap_err().to_string()
    };
    assert!(refusal(&Scene::default(), 1.0).contains("no cloud"));
    assert!(refusal(&scene(PLAIN), 1e-3).contains("make them larger"));
    let far = r#"{"clouds":[{"edge":{"boundary":0},"ellipsoids":[{"center":[0,0,0],"radii":[9,9,9]},{"center":[99999,99999,99999],
        "radii":[9,9,9]}]}]}"#;
    // The box is too large, what is filled is not.
    let volume = sampled(&scene(far), VoxelGrid::new(2.0));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.vol");
    assert!(write_vol(&path, &volume).unwrap_err().to_string().contains("write a .vdb file"));
    assert!(!path.exists());
    write_vdb(&folder.path().join("far.vdb"), &volume).unwrap();
}
