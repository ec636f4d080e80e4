//! Cameras as glTF, which 3-D programs and engines import.

use std::{borrow::Cow, io, path::Path};

use glam::DQuat;
use gltf::binary::{Glb, Header};
use serde_json::{Value, json};

use super::header::{FAR, NEAR};
use crate::{
    Error, Result,
    files::write_whole,
    scene::{Camera, Projection},
};

/// Writes `camera` for pictures of `aspect`, width over height: .glb where the name ends in that, else
/// .gltf. glTF has metres, Y up and -Z forward, as scenes have. A shifted lens, which it does not know, is told in
/// `extras`: nephos reads it back.
///
/// # Errors
/// [`Error::Argument`] where it is no camera that glTF knows, [`Error::File`] when the file can't be
/// written.
pub fn write_camera(path: &Path, camera: &Camera, aspect: f64) -> Result<()> {
    write(path, &document(camera, aspect)?, None)
}

/// Writes a camera that moves into a .glb file: keys are times, s, from 0 on, each later than the one before, between
/// which it goes straight.
///
/// # Errors
/// As [`write_camera`], and [`Error::Argument`] where there are no keys, their times are no times of glTF, the lens
/// changes, or the file ends in another name.
pub fn write_moving_camera(path: &Path, keys: &[(f64, Camera)], aspect: f64) -> Result<()> {
    check_keys(path, keys)?;
    let times: Vec<f32> = keys.iter().map(|(time, _)| *time as f32).collect();
    let places = keys.iter().flat_map(|(_, camera)| camera.position.as_vec3().to_array());
    let mut document = document(&keys[0].1, aspect)?;
    let numbers: Vec<f32> = times.iter().copied().chain(places).chain(rotations(keys)).collect();
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    let count = keys.len();
    let view = |first: usize, width: usize| json!({"buffer": 0, "byteOffset": 4 * first, "byteLength": 4 * width * count});
    let accessor = |view: usize, kind: &str| json!({"bufferView": view, "componentType": FLOAT, "count": count, "type": kind});
    let mut of_times = accessor(0, "SCALAR");
    of_times["min"] = json!([times[0]]);
    of_times["max"] = json!([times[count - 1]]);
    document["buffers"] = json!([{"byteLength": bytes.len()}]);
    document["bufferViews"] = json!([view(0, 1), view(count, 3), view(4 * count, 4)]);
    document["accessors"] = json!([of_times, accessor(1, "VEC3"), accessor(2, "VEC4")]);
    let channel =
        |sampler: usize, path: &str| json!({"sampler": sampler, "target": {"node": 0, "path": path}});
    document["animations"] = json!([{
        "name": "camera",
        "samplers": [{"input": 0, "output": 1}, {"input": 0, "output": 2}],
        "channels": [channel(0, "translation"), channel(1, "rotation")],
    }]);
    write(path, &document, Some(bytes))
}

/// glTF's name of 32-bit floats.
const FLOAT: u32 = 5126;

fn check_keys(path: &Path, keys: &[(f64, Camera)]) -> Result<()> {
    let refuse = |problem: String| Err(Error::Argument(problem));
    if !ends_in_glb(path) {
        return refuse(format!(
            "`{}` does not end in .glb: a camera that moves has numbers that a .gltf file would keep elsewhere",
            path.display()
        ));
    }
    let Some((first, camera)) = keys.first() else {
        return refuse("a camera that moves has keys, and there are none: name some frames".to_owned());
    };
    if *first < 0.0 {
        return refuse(format!(
            "glTF begins at 0 seconds, and a key is at {first}: leave frames before frame 1 out"
        ));
    }
    let lens = |camera: &Camera| (camera.projection, camera.shift_x, camera.shift_y);
    match keys.iter().find(|(_, other)| lens(other) != lens(camera)) {
        Some((time, _)) => refuse(format!(
            "the lens is another one at {time} seconds than at {first}, and glTF has no lens that changes: export frames \
             in which it does not"
        )),
        None => Ok(()),
    }
}

/// Rotations of the keys, x, y, z, w: each of the two that are one turn which is nearer to the one before.
fn rotations(keys: &[(f64, Camera)]) -> Vec<f32> {
    let mut before: Option<DQuat> = None;
    let mut numbers = Vec::with_capacity(4 * keys.len());
    for (_, camera) in keys {
        let turn = camera.world_from_camera().normalize();
        let turn = if before.is_some_and(|before| before.dot(turn) < 0.0) { -turn } else { turn };
        before = Some(turn);
        numbers.extend(turn.as_quat().normalize().to_array());
    }
    numbers
}

fn ends_in_glb(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"))
}

fn write(path: &Path, document: &Value, numbers: Option<Vec<u8>>) -> Result<()> {
    let text = document.to_string();
    write_whole(path, |file| {
        if !ends_in_glb(path) {
            return io::Write::write_all(file, text.as_bytes());
        }
        let header = Header { magic: *b"glTF", version: 2, length: 0 };
        let glb =
            Glb { header, json: Cow::Borrowed(text.as_bytes()), bin: numbers.as_deref().map(Cow::Borrowed) };
        glb.to_writer(file).map_err(io::Error::other)
    })
}

fn document(camera: &Camera, aspect: f64) -> Result<Value> {
    let mut lens = match (camera.projection, camera.projection.vertical_fov(aspect)) {
        (_, Some(fov)) => {
            let lens = json!({"yfov": fov, "aspectRatio": aspect, "znear": NEAR, "zfar": FAR});
            json!({"name": "camera", "type": "perspective", "perspective": lens})
        }
        (Projection::Orthographic { height }, None) => {
            let (x, y) = (0.5 * height * aspect, 0.5 * height);
            let lens = json!({"xmag": x, "ymag": y, "znear": NEAR, "zfar": FAR});
            json!({"name": "camera", "type": "orthographic", "orthographic": lens})
        }
        (_, None) => {
            return Err(Error::Argument(
                "glTF has no equirectangular cameras: give the scene a perspective or an orthographic one"
                    .to_owned(),
            ));
        }
    };
    if (camera.shift_x, camera.shift_y) != (0.0, 0.0) {
        lens["extras"] = json!({"shift_x": camera.shift_x, "shift_y": camera.shift_y});
    }
    let rotation = camera.world_from_camera();
    Ok(json!({
        "asset": {"version": "2.0", "generator": concat!("nephos ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{
            "name": "camera",
            "camera": 0,
            "translation": camera.position.to_array(),
            "rotation": rotation.normalize().to_array(),
        }],
        "cameras": [lens],
    }))
}
