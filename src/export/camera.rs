//! Cameras as glTF, which 3-D programs and engines import.

use std::{borrow::Cow, io, path::Path};

use gltf::binary::{Glb, Header};
use serde_json::{Value, json};

use super::header::{FAR, NEAR};
use crate::{
    Error, Result,
    files::write_whole,
    scene::{Camera, Projection},
};

/// Writes `camera` for pictures of `aspect`, width over height: .glb where the name ends in that, else
/// .gltf. glTF has metres, Y up and -Z forward, as scenes have.
///
/// # Errors
/// [`Error::Argument`] where it is no camera that glTF knows, [`Error::File`] when the file can't be
/// written.
pub fn write_camera(path: &Path, camera: &Camera, aspect: f64) -> Result<()> {
    let text = document(camera, aspect)?.to_string();
    let binary = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"));
    write_whole(path, |file| {
        if !binary {
            return io::Write::write_all(file, text.as_bytes());
        }
        let header = Header { magic: *b"glTF", version: 2, length: 0 };
        let glb = Glb { header, json: Cow::Borrowed(text.as_bytes()), bin: None };
        glb.to_writer(file).map_err(io::Error::other)
    })
}

fn document(camera: &Camera, aspect: f64) -> Result<Value> {
    let lens = match (camera.projection, camera.projection.vertical_fov(aspect)) {
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
