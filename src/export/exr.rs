//! OpenEXR, half floats, linear, colours multiplied by alpha as the format asks.

use std::{collections::BTreeMap, io, path::Path};

use exr::{
    meta::attribute::AttributeValue,
    prelude::{self as openexr, WritableImage},
};
use half::f16;

use super::Picture;
use crate::{Error, Result, files::write_whole, gpu::Gpu, render::Layers};

/// Writes one picture as R, G, B, A.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_beauty(path: &Path, picture: &Picture) -> Result<()> {
    write_channels(path, picture, &channels("", picture), &[])
}

/// Writes a path traced picture and the standard error of each of its channels.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_estimate(path: &Path, picture: &Picture, error: &[[f32; 3]]) -> Result<()> {
    write_noted_estimate(path, picture, error, &[])
}

/// The same with notes, ASCII names and texts, among the file's attributes.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_noted_estimate(
    path: &Path,
    picture: &Picture,
    error: &[[f32; 3]],
    notes: &[(&str, String)],
) -> Result<()> {
    let mut list = channels("", picture);
    for (i, name) in ERRORS.into_iter().enumerate() {
        list.push((name.to_owned(), error.iter().map(|error| error[i]).collect()));
    }
    write_channels(path, picture, &list, notes)
}

/// A path traced picture as it was written.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredEstimate {
    /// Mean radiance and opacity, colours multiplied by opacity.
    pub picture: Picture,
    /// Standard error of the mean radiance, by channel.
    pub error: Vec<[f32; 3]>,
    /// Names and texts of all text attributes of the file.
    pub notes: BTreeMap<String, String>,
}

/// Reads what [`write_estimate`] wrote.
///
/// # Errors
/// [`Error::File`] where the file can't be read, [`Error::Format`] where it is no path traced
/// picture.
pub fn read_estimate(path: &Path) -> Result<StoredEstimate> {
    let image = openexr::read_first_flat_layer_from_file(path).map_err(|error| match error {
        openexr::Error::Io(source) => Error::File { action: "read", path: path.to_owned(), source },
        other => damaged(path, &format!("is no OpenEXR picture that can be read: {other}")),
    })?;
    let layer = &image.layer_data;
    let channel = |name: &str| -> Result<Vec<f32>> {
        let found = layer.channel_data.list.iter().find(|channel| channel.name.eq(name));
        let values = found.map(|channel| channel.sample_data.values_as_f32().collect());
        values.ok_or_else(|| damaged(path, &format!("has no channel `{name}`: it is no path traced picture")))
    };
    let [r, g, b, a] = COLOURS.map(channel);
    let [er, eg, eb] = ERRORS.map(channel);
    let (r, g, b, a, er, eg, eb) = (r?, g?, b?, a?, er?, eg?, eb?);
    let pixels = (0..r.len()).map(|i| [r[i], g[i], b[i], a[i]]).collect();
    Ok(StoredEstimate {
        picture: Picture { width: layer.size.width(), height: layer.size.height(), pixels },
        error: (0..r.len()).map(|i| [er[i], eg[i], eb[i]]).collect(),
        notes: layer.attributes.other.iter().filter_map(note).collect(),
    })
}

fn note((name, value): (&openexr::Text, &AttributeValue)) -> Option<(String, String)> {
    match value {
        AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    }
}

fn damaged(path: &Path, problem: &str) -> Error {
    Error::Format { path: path.to_owned(), problem: problem.to_owned() }
}

/// Writes the beauty and the layers that it is the sum of:
/// `beauty = sky * transmittance + single + multiple + air`, and `depth.Z`, the distance
/// of the clouds in metres, 1e10 where there are none. A `transparent` beauty leaves the
/// sky out and has the clouds' alpha. Squares of `reduce` pixels become one.
///
/// # Errors
/// [`crate::Error::Gpu`] when the device fails, [`crate::Error::File`] when the file
/// can't be written.
pub fn write_layers(path: &Path, gpu: &Gpu, layers: &Layers, transparent: bool, reduce: usize) -> Result<()> {
    let read = |texture| Picture::read(gpu, texture).map(|picture| picture.reduced(reduce));
    let [sky, single, multiple, air, distance, normal] =
        [&layers.sky, &layers.single, &layers.multiple, &layers.air, &layers.distance, &layers.normal]
            .map(read);
    let (sky, single, multiple, air, distance, normal) = (sky?, single?, multiple?, air?, distance?, normal?);
    let mut list = channels("", &beauty(&sky, &[&single, &multiple, &air], transparent));
    for (name, layer) in [("sky", &sky), ("single", &single), ("multiple", &multiple), ("air", &air)] {
        list.extend(channels(name, layer).into_iter().filter(|(name, _)| !name.ends_with('A')));
    }
    let from = |picture: &Picture, value: fn(&[f32; 4]) -> f32| picture.pixels.iter().map(value).collect();
    list.push(("transmittance.Y".to_owned(), from(&single, |pixel| 1.0 - pixel[3])));
    list.push(("depth.Z".to_owned(), from(&distance, metres)));
    for (axis, name) in ["normal.X", "normal.Y", "normal.Z"].into_iter().enumerate() {
        list.push((name.to_owned(), normal.pixels.iter().map(|pixel| pixel[axis]).collect()));
    }
    write_channels(path, &sky, &list, &[])
}

/// Distance in metres; a cloud that hides less than a thousandth is none.
fn metres(pixel: &[f32; 4]) -> f32 {
    if pixel[3] > 1e-3 { 1e3 * pixel[0] / pixel[3] } else { 1e10 }
}

/// The layers put together again: opaque over the sky, or the clouds alone.
fn beauty(sky: &Picture, light: &[&Picture; 3], transparent: bool) -> Picture {
    let pixel = |(i, behind): (usize, &[f32; 4])| {
        let alpha = light[0].pixels[i][3];
        let mut sum = behind.map(|c| if transparent { 0.0 } else { c * (1.0 - alpha) });
        for layer in light {
            sum.iter_mut().zip(layer.pixels[i]).for_each(|(sum, c)| *sum += c);
        }
        [sum[0], sum[1], sum[2], if transparent { alpha } else { 1.0 }]
    };
    Picture { pixels: sky.pixels.iter().enumerate().map(pixel).collect(), ..*sky }
}

const COLOURS: [&str; 4] = ["R", "G", "B", "A"];
const ERRORS: [&str; 3] = ["error.R", "error.G", "error.B"];

fn channels(layer: &str, picture: &Picture) -> Vec<(String, Vec<f32>)> {
    let name =
        |channel: &str| if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") };
    COLOURS
        .into_iter()
        .enumerate()
        .map(|(i, channel)| (name(channel), picture.pixels.iter().map(|pixel| pixel[i]).collect()))
        .collect()
}

/// Colours as half floats; depths, which half floats can't hold, as floats.
fn write_channels(
    path: &Path,
    size: &Picture,
    list: &[(String, Vec<f32>)],
    notes: &[(&str, String)],
) -> Result<()> {
    let channels = list.iter().map(|(name, values)| {
        let samples = if name.ends_with('Z') && name.starts_with("depth") {
            openexr::FlatSamples::F32(values.clone())
        } else {
            openexr::FlatSamples::F16(values.iter().map(|&value| f16::from_f32(value)).collect())
        };
        openexr::AnyChannel::new(name.as_str(), samples)
    });
    let layer = openexr::Layer::new(
        (size.width, size.height),
        attributes(notes),
        openexr::Encoding::SMALL_LOSSLESS,
        openexr::AnyChannels::sort(channels.collect()),
    );
    let image = openexr::Image::from_layer(layer);
    write_whole(path, |file| {
        image.write().to_buffered(file).map_err(|error| match error {
            openexr::Error::Io(error) => error,
            other => io::Error::other(other.to_string()),
        })
    })
}

fn attributes(notes: &[(&str, String)]) -> openexr::LayerAttributes {
    let mut attributes = openexr::LayerAttributes::named("nephos");
    for (name, text) in notes {
        let note = openexr::Text::new_or_none(name).zip(openexr::Text::new_or_none(text));
        attributes.other.extend(note.map(|(name, text)| (name, AttributeValue::Text(text))));
    }
    attributes
}
