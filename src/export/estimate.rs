//! Path traced pictures as EXR files that can be gone on with: beside the beauty, the clouds' own
//! light and its error as floats, and the number of samples and the scene as attributes.

use std::{io, path::Path};

use exr::{
    meta::attribute::AttributeValue,
    prelude::{self as openexr, Text},
};

use super::{
    Notes, Picture,
    exr::{Attributes, channels, write_channels},
};
use crate::{Error, Result, reference::Estimate, scene::Scene};

const SAMPLES: &str = "nephos.samples";
const SCENE: &str = "nephos.scene";
const MEAN: [&str; 4] = ["cloud.R", "cloud.G", "cloud.B", "cloud.A"];
const ERROR: [&str; 3] = ["error.R", "error.G", "error.B"];

/// What a path traced picture holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Earlier {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// What it shows.
    pub scene: Scene,
    /// What was found.
    pub estimate: Estimate,
}

/// Writes a path traced `picture`, the `estimate` that it is made of (layers `cloud` and `error`,
/// the standard error of the mean), and which `scene` it shows.
///
/// # Errors
/// [`Error::File`] when the file can't be written.
pub fn write_estimate(path: &Path, picture: &Picture, estimate: &Estimate, scene: &Scene) -> Result<()> {
    write_estimate_noted(path, picture, estimate, scene, &Notes::default())
}

/// The same with notes, as attributes.
///
/// # Errors
/// [`Error::File`] when the file can't be written.
pub fn write_estimate_noted(
    path: &Path,
    picture: &Picture,
    estimate: &Estimate,
    scene: &Scene,
    notes: &Notes,
) -> Result<()> {
    let mut list = channels("", picture);
    for (c, name) in MEAN.into_iter().enumerate() {
        list.push((name.to_owned(), estimate.mean.iter().map(|pixel| pixel[c]).collect()));
    }
    for (c, name) in ERROR.into_iter().enumerate() {
        list.push((name.to_owned(), estimate.error.iter().map(|error| error[c]).collect()));
    }
    let mut attributes = Attributes::new();
    attributes.insert(SAMPLES.into(), AttributeValue::I32(estimate.samples as i32));
    if let Some(text) = Text::new_or_none(ascii(&scene.to_json())) {
        attributes.insert(SCENE.into(), AttributeValue::Text(text));
    }
    write_channels(path, picture, list, notes, attributes)
}

/// Reads what [`write_estimate`] wrote.
///
/// # Errors
/// [`Error::File`] when the file can't be read, [`Error::Format`] when it is no such picture.
pub fn read_estimate(path: &Path) -> Result<Earlier> {
    let foreign = || Error::Format {
        path: path.to_owned(),
        problem: "is no path traced picture that can be gone on with: give one that \
                  `nephos render --transport path` wrote, or leave --resume out to replace it"
            .to_owned(),
    };
    let image = openexr::read_first_flat_layer_from_file(path).map_err(|error| match error {
        openexr::Error::Io(source) if source.kind() != io::ErrorKind::UnexpectedEof => {
            Error::File { action: "read", path: path.to_owned(), source }
        }
        _ => foreign(),
    })?;
    let layer = image.layer_data;
    let channel = |name: &str| {
        let found = layer.channel_data.list.iter().find(|channel| channel.name == *name);
        found.map(|channel| channel.sample_data.values_as_f32().collect::<Vec<_>>()).ok_or_else(foreign)
    };
    let attribute = |name: &str| layer.attributes.other.get(&Text::from(name));
    let (Some(AttributeValue::I32(samples)), Some(AttributeValue::Text(scene))) =
        (attribute(SAMPLES), attribute(SCENE))
    else {
        return Err(foreign());
    };
    let [r, g, b, a] = MEAN.map(channel);
    let [error_r, error_g, error_b] = ERROR.map(channel);
    let estimate = Estimate {
        mean: zipped([r?, g?, b?, a?]),
        error: zipped([error_r?, error_g?, error_b?]),
        samples: u32::try_from(*samples).map_err(|_| foreign())?,
    };
    let scene = Scene::from_json(&scene.to_string()).map_err(|_| foreign())?;
    let size = [layer.size.width() as u32, layer.size.height() as u32];
    Ok(Earlier { size, scene, estimate })
}

/// Pixels of their channels.
fn zipped<const N: usize>(channels: [Vec<f32>; N]) -> Vec<[f32; N]> {
    (0..channels[0].len()).map(|i| std::array::from_fn(|c| channels[c][i])).collect()
}

/// JSON with what is beyond ASCII escaped: EXR's attributes have one byte a letter.
fn ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for letter in json.chars() {
        if letter.is_ascii() {
            text.push(letter);
        } else {
            let mut units = [0; 2];
            letter.encode_utf16(&mut units).iter().for_each(|unit| text += &format!("\\u{unit:04x}"));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read_and_other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("truth.exr");
        let mut scene = Scene::default();
        scene
            .clouds
            .push(crate::scene::Cloud { name: "Wölkchen \u{1F325}".to_owned(), ..Default::default() });
        let pixel = |i: u8| f32::from(i) / 3.0;
        let estimate = Estimate {
            mean: (0..6).map(|i| [pixel(i), pixel(i + 1), 1e-9, 0.5]).collect(),
            error: (0..6).map(|i| [1e-7 * pixel(i), 0.1, 0.2]).collect(),
            samples: 99,
        };
        let picture = Picture { width: 3, height: 2, pixels: estimate.mean.clone() };
        write_estimate(&path, &picture, &estimate, &scene).unwrap();
        assert_eq!(read_estimate(&path).unwrap(), Earlier { size: [3, 2], scene, estimate });
        super::super::write_beauty(&path, &picture).unwrap();
        assert!(read_estimate(&path).unwrap_err().to_string().contains("no path traced picture"));
        std::fs::write(&path, b"nothing").unwrap();
        assert!(read_estimate(&path).unwrap_err().to_string().contains("no path traced picture"));
        assert!(read_estimate(&folder.path().join("missing.exr")).is_err());
    }
}
