//! Exported volumes drawn by Mitsuba and by Blender: the same cloud in the same place, with the same
//! light as the path traced truth. Skipped where neither is installed.
#![cfg(feature = "export")]

use crate::common;

use std::{fs, path::Path};

use common::{gpu, picture::scene, readers};
use glam::DVec3;
use nephos::{
    export::{write_vdb, write_vol},
    reference::PathTracer,
    render::{Frame, VoxelGrid, Voxels},
    scene::{Projection, Scene},
};

/// Sharp and wispy edges, thin enough for Monte Carlo; only the sun shines, with irradiance 1.
pub const CLOUD: &str = r#"{"clouds":[{"edge":{"boundary":45,"wispiness":0.3},
    "droplets":{"concentration_per_cm3":80,"phase":{"henyey_greenstein":{"g":0.3}}},"ellipsoids":[
        {"center":[0,1000,0],"radii":[150,80,110]},
        {"center":[90,1080,10],"radii":[80,70,70],"edge":{"boundary":40,"wispiness":0.2}},
        {"center":[-110,1050,30],"radii":[70,60,60],"edge":{"boundary":60,"wispiness":1}}]}],
    "noise":{"seed":4,"scale":70},"sky":"none","ground":{"albedo":[0,0,0]},
    "sun":{"position":{"angles":{"azimuth_deg":120,"elevation_deg":35}},"angular_diameter_deg":0},
    "camera":{"position":[150,900,600],"target":[0,1030,0],
        "projection":{"perspective":{"vertical_fov_deg":36}}}}"#;
const SIZE: [u32; 2] = [48, 27];
const VOXEL: f64 = 3.0;

type Pixels = Vec<[f32; 4]>;

fn truth(scene: &Scene) -> Pixels {
    let mut tracer = PathTracer::new(gpu(), &Frame::new(scene, SIZE).unwrap(), 0).unwrap();
    tracer.trace(192, &mut |_| true).unwrap();
    tracer.estimate().unwrap().mean
}

/// What the scripts take, with the axes of the volume.
fn shot(scene: &Scene, grid: &VoxelGrid, samples: u32) -> String {
    let camera = scene.camera();
    let Projection::Perspective { vertical_fov_deg } = camera.projection else { panic!("a perspective") };
    let turned = |v: DVec3| (grid.world_from_volume.transpose() * v).to_array();
    serde_json::json!({
        "size": SIZE, "samples": samples, "g": 0.3, "vertical_fov_deg": vertical_fov_deg,
        "position": turned(camera.position), "target": turned(camera.target), "up": turned(DVec3::Y),
        "to_sun": turned(scene.sun.to_sun()),
    })
    .to_string()
}

fn volume(scene: &Scene, grid: VoxelGrid) -> Voxels {
    Voxels::sample(gpu(), &Frame::new(scene, [1, 1]).unwrap(), grid, &mut |_| ()).unwrap()
}

fn read(path: &Path) -> Pixels {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// Sum, and centre in pixels, of what `value` has.
fn middle(pixels: &Pixels, value: fn(&[f32; 4]) -> f32) -> (f64, [f64; 2]) {
    let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
    for (i, pixel) in pixels.iter().enumerate() {
        let value = f64::from(value(pixel));
        sum += value;
        x += value * (i as u32 % SIZE[0]) as f64;
        y += value * (i as u32 / SIZE[0]) as f64;
    }
    (sum, [x / sum, y / sum])
}

/// The same opacity and light in the same place: `apart` is how far the middles may be, in pixels.
fn assert_same(found: &Pixels, truth: &Pixels, apart: f64) {
    let alpha = |pixel: &[f32; 4]| pixel[3];
    let light = |pixel: &[f32; 4]| (pixel[0] + pixel[1] + pixel[2]) / 3.0;
    let ((opacity, place), (opacity_there, place_there)) = (middle(truth, alpha), middle(found, alpha));
    let ((bright, _), (bright_there, _)) = (middle(truth, light), middle(found, light));
    let squares = found.iter().zip(truth).map(|(a, b)| f64::from(a[3] - b[3]).powi(2)).sum::<f64>();
    let rmse = (squares / truth.len() as f64).sqrt();
    eprintln!(
        "opacity {opacity_there:.2} of {opacity:.2}, rmse {rmse:.4}; light {bright_there:.3} of {bright:.3}; \
        middle {place_there:.3?} of {place:.3?}"
    );
    assert!((opacity_there / opacity - 1.0).abs() < 0.015);
    assert!((bright_there / bright - 1.0).abs() < 0.03);
    assert!((0..2).all(|i| (place[i] - place_there[i]).abs() < apart));
    assert!(rmse < 0.05);
}

#[test]
fn mitsuba_draws_the_same_cloud() {
    let scene = scene(CLOUD);
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().join("cloud.vol"), folder.path().join("out.json"));
    let grid = VoxelGrid::new(VOXEL);
    write_vol(&path, &volume(&scene, grid)).unwrap();
    let words = [path.to_str().unwrap(), &shot(&scene, &grid, 256), out.to_str().unwrap()];
    if readers::python("mitsuba", "mitsuba_volume.py", &words).is_some() {
        assert_same(&read(&out), &truth(&scene), 0.05);
    }
}

#[test]
fn blender_draws_the_same_cloud() {
    let scene = scene(CLOUD);
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().join("cloud.vdb"), folder.path().join("out.json"));
    let grid = VoxelGrid::new(VOXEL).z_up();
    write_vdb(&path, &volume(&scene, grid)).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/blender_volume.py");
    let (shot, script) = (shot(&scene, &grid, 256), script.to_str().unwrap().to_owned());
    let words = ["-b", "--factory-startup", "--python-exit-code", "1", "-P", &script, "--"];
    let words = [&words[..], &[path.to_str().unwrap(), &shot, out.to_str().unwrap()]].concat();
    if readers::program("blender", &words).is_some() {
        // Blender 3.4 takes a voxel's value to be in its far corner: half a voxel, 0.1 pixel here.
        assert_same(&read(&out), &truth(&scene), 0.2);
    }
}
