//! OpenEXR, linear, colours multiplied by alpha as the format asks.

use std::{collections::HashMap, io, path::Path};

use exr::{
    meta::attribute::AttributeValue,
    prelude::{self as openexr, WritableImage},
};
use half::f16;

use super::{ColorSpace, Notes, Picture};
use crate::{
    Result,
    files::write_whole,
    gpu::Gpu,
    render::{Layers, LightLayers},
};

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

/// Writes the beauty and the layers that it is the sum of:
/// `beauty = sky * transmittance + single + multiple + air`, and `depth.Z`, the distance
/// of the clouds in metres, 1e10 where there are none. A `transparent` beauty leaves the
/// sky out and has the clouds' alpha. Where there are lights beside the sun, `light.sun` and `light.NAME` have what
/// each of them gives to the beauty. Squares of `reduce` pixels become one.
///
/// # Errors
/// [`crate::Error::Gpu`] when the device fails, [`crate::Error::File`] when the file
/// can't be written.
pub fn write_layers(path: &Path, gpu: &Gpu, layers: &Layers, transparent: bool, reduce: usize) -> Result<()> {
    write_layers_noted(path, gpu, layers, transparent, reduce, &Notes::default())
}

/// The same with notes, as attributes.
///
/// # Errors
/// [`crate::Error::Gpu`] when the device fails, [`crate::Error::File`] when the file
/// can't be written.
pub fn write_layers_noted(
    path: &Path,
    gpu: &Gpu,
    layers: &Layers,
    transparent: bool,
    reduce: usize,
    notes: &Notes,
) -> Result<()> {
    let read = |texture: &wgpu::Texture| Picture::read(gpu, texture).map(|picture| picture.reduced(reduce));
    let mut list = Vec::new();
    let mut all = Apart::read(&layers.sun, layers.unit, read)?;
    if !layers.lights.is_empty() {
        list.extend(without_alpha(channels("light.sun", &all.beauty(transparent))));
    }
    for (name, light) in &layers.lights {
        let light = Apart::read(light, layers.unit, read)?;
        list.extend(without_alpha(channels(&format!("light.{name}"), &light.beauty(transparent))));
        all.add(&light);
    }
    let (distance, normal) = (read(&layers.distance)?, read(&layers.normal)?);
    list.extend(channels("", &all.beauty(transparent)));
    let Apart([sky, single, multiple, air]) = &all;
    for (name, layer) in [("sky", sky), ("single", single), ("multiple", multiple), ("air", air)] {
        list.extend(without_alpha(channels(name, layer)));
    }
    let from = |picture: &Picture, value: fn(&[f32; 4]) -> f32| picture.pixels.iter().map(value).collect();
    list.push(("transmittance.Y".to_owned(), from(single, |pixel| 1.0 - pixel[3])));
    list.push(("depth.Z".to_owned(), from(&distance, metres)));
    for (axis, name) in ["normal.X", "normal.Y", "normal.Z"].into_iter().enumerate() {
        list.push((name.to_owned(), normal.pixels.iter().map(|pixel| pixel[axis]).collect()));
    }
    write_channels(path, sky, list, notes, Attributes::new())
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

/// Distance in metres; a cloud that hides less than a thousandth is none.
fn metres(pixel: &[f32; 4]) -> f32 {
    if pixel[3] > 1e-3 { 1e3 * pixel[0] / pixel[3] } else { 1e10 }
}

/// What light is made of: sky, single, multiple, air.
struct Apart([Picture; 4]);

impl Apart {
    fn read(
        light: &LightLayers,
        unit: f32,
        read: impl Fn(&wgpu::Texture) -> Result<Picture>,
    ) -> Result<Self> {
        let layer = |texture| Ok(read(texture)?.times(unit));
        Ok(Self([layer(&light.sky)?, layer(&light.single)?, layer(&light.multiple)?, layer(&light.air)?]))
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(own, other)| own.add_light(other));
    }

    /// Put together again: opaque over the sky, or the clouds alone.
    fn beauty(&self, transparent: bool) -> Picture {
        let Self([sky, light @ ..]) = self;
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
}

fn without_alpha(channels: Vec<(String, Vec<f32>)>) -> impl Iterator<Item = (String, Vec<f32>)> {
    channels.into_iter().filter(|(name, _)| !name.ends_with('A'))
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

/// Layers that half floats can't hold: depths, and what is added to later.
const FLOATS: [&str; 3] = ["depth.", "cloud.", "error."];

/// Puts the colours of all layers but [`FLOATS`] into another space.
fn put_into(color: ColorSpace, list: &mut [(String, Vec<f32>)]) {
    let layer_of = |name: &str| name.strip_suffix('R').map(str::to_owned);
    let layers: Vec<String> = list.iter().filter_map(|(name, _)| layer_of(name)).collect();
    for layer in layers.iter().filter(|layer| !FLOATS.contains(&layer.as_str())) {
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
    let is_float = |name: &str| FLOATS.iter().any(|layer| name.starts_with(layer));
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
