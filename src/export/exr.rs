//! OpenEXR, linear, colours multiplied by alpha as the format asks.

use std::{collections::HashMap, io, path::Path};

use exr::{
    meta::attribute::AttributeValue,
    prelude::{self as openexr, WritableImage},
};
use half::f16;

use super::{ColorSpace, Notes, Picture};
use crate::{Result, files::write_whole};

/// Writes one picture as R, G, B, A.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_beauty(path: &Path, picture: &Picture) -> Result<()> {
    write_beauty_noted(path, picture, &Notes::default())
}

/// The same with notes, as attributes.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_beauty_noted(path: &Path, picture: &Picture, notes: &Notes) -> Result<()> {
    write_channels(path, picture, channels("", picture), notes, Attributes::new())
}

/// Writes channels by their names, such as `Y` or `depth.Z`, row by row from the top: half floats, or
/// floats in the layers `depth`, `cloud` and `error`.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_named(path: &Path, [width, height]: [usize; 2], list: &[(String, Vec<f32>)]) -> Result<()> {
    let size = Picture { width, height, pixels: Vec::new() };
    write_channels(path, &size, list.to_vec(), &Notes::default(), Attributes::new())
}

pub(super) fn channels(layer: &str, picture: &Picture) -> Vec<(String, Vec<f32>)> {
    let name =
        |channel: &str| if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") };
    ["R", "G", "B", "A"]
        .into_iter()
        .enumerate()
        .map(|(i, channel)| (name(channel), picture.pixels.iter().map(|pixel| pixel[i]).collect()))
        .collect()
}

/// Whether half floats hold such values: the largest is not cut, and is no speck of the smallest.
fn held_by_halves<'a>(values: impl Iterator<Item = &'a f32>) -> bool {
    let largest = values.fold(0f32, |largest, value| largest.max(value.abs()));
    largest == 0.0 || (LEAST_HALF..=f16::MAX.to_f32()).contains(&largest)
}

/// Pictures whose largest value is below this have few shades in half floats.
const LEAST_HALF: f32 = 1e-3;

/// What a file tells beside its pixels.
pub(super) type Attributes = HashMap<openexr::Text, AttributeValue>;

/// Layers that half floats can't hold: lengths, numbers that are names, and what is added to later.
const FLOATS: [&str; 7] = ["depth.", "planar.", "position.", "motion.", "CryptoCloud", "cloud.", "error."];

fn is_float(name: &str) -> bool {
    FLOATS.iter().any(|layer| name.starts_with(layer))
}

/// Puts the colours of all layers but [`FLOATS`] into another space.
fn put_into(color: ColorSpace, list: &mut [(String, Vec<f32>)]) {
    let layer_of = |name: &str| name.strip_suffix('R').map(str::to_owned);
    let layers: Vec<String> = list.iter().filter_map(|(name, _)| layer_of(name)).collect();
    for layer in layers.iter().filter(|layer| !is_float(layer)) {
        let place = |c: &str| list.iter().position(|(name, _)| *name == format!("{layer}{c}"));
        let (Some(r), Some(g), Some(b)) = (place("R"), place("G"), place("B")) else { continue };
        for i in 0..list[r].1.len() {
            let [x, y, z] = color.from_scene([list[r].1[i], list[g].1[i], list[b].1[i]]);
            (list[r].1[i], list[g].1[i], list[b].1[i]) = (x, y, z);
        }
    }
}

/// Colours as half floats where these hold them, [`FLOATS`] as floats; with what there is to tell, and `more`.
pub(super) fn write_channels(
    path: &Path,
    size: &Picture,
    mut list: Vec<(String, Vec<f32>)>,
    notes: &Notes,
    more: Attributes,
) -> Result<()> {
    if let Some(color @ ColorSpace::AcesCg) = notes.header.color {
        put_into(color, &mut list);
    }
    let mut attributes = notes.attributes();
    attributes.extend(more);
    let is_light = |name: &str| name.ends_with(['R', 'G', 'B']) && !is_float(name);
    let light = list.iter().filter(|(name, _)| is_light(name)).flat_map(|(_, values)| values);
    let halves = held_by_halves(light);
    let channels = list.iter().map(|(name, values)| {
        let samples = if !halves || is_float(name) {
            openexr::FlatSamples::F32(values.clone())
        } else {
            openexr::FlatSamples::F16(values.iter().map(|&value| f16::from_f32(value)).collect())
        };
        openexr::AnyChannel::new(name.as_str(), samples)
    });
    let mut about =
        openexr::LayerAttributes { other: attributes, ..openexr::LayerAttributes::named("nephos") };
    let size = (size.width, size.height);
    let mut of_image = openexr::ImageAttributes::with_size(size);
    notes.header.put_into(&mut about, &mut of_image);
    let channels = openexr::AnyChannels::sort(channels.collect());
    let layer = openexr::Layer::new(size, about, openexr::Encoding::SMALL_LOSSLESS, channels);
    let image = openexr::Image::new(of_image, layer);
    write_whole(path, |file| {
        image.write().to_buffered(file).map_err(|error| match error {
            openexr::Error::Io(error) => error,
            other => io::Error::other(other.to_string()),
        })
    })
}
