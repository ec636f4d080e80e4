//! Pixels of the pictures that scenes name: PNG and EXR.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::Volume;
use crate::{Error, Result};

/// What was read of a file, and the folder that its path starts from. It is no part of what a scene says.
#[derive(Debug, Clone)]
pub(crate) struct FromFile<T> {
    pub found: Option<Arc<T>>,
    pub folder: PathBuf,
}

impl<T> Default for FromFile<T> {
    fn default() -> Self {
        Self { found: None, folder: PathBuf::new() }
    }
}

impl<T: PartialEq> PartialEq for FromFile<T> {
    fn eq(&self, other: &Self) -> bool {
        self.found == other.found
    }
}

impl<T> FromFile<T> {
    /// The path of `file` from another folder on.
    pub fn written_from(&self, folder: &Path, file: &str) -> String {
        if self.found.is_some() && self.folder != folder {
            return Volume::path_from(folder, &self.folder.join(file));
        }
        file.to_owned()
    }
}

/// A picture: rows from top to bottom of red, green and blue.
pub(super) struct Pixels {
    pub width: usize,
    pub values: Vec<[f32; 3]>,
    /// Whether values are as a PNG writes them, for screens; else they are light.
    pub is_encoded: bool,
}

/// Whether a file has the name of a picture: .png or .exr.
pub(super) fn is_named(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    ["png", "exr"].iter().any(|known| ending.eq_ignore_ascii_case(known))
}

/// Reads a picture of at most `most` pixels along an edge.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where it can't be read, is no picture, or too large.
#[cfg(feature = "export")]
pub(super) fn read(path: &Path, most: usize) -> Result<Pixels> {
    let is_exr = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    if is_exr { exr_pixels(path, most) } else { png_pixels(path, most) }
}

/// As above: this build reads none.
#[cfg(not(feature = "export"))]
pub(super) fn read(path: &Path, _most: usize) -> Result<Pixels> {
    Err(Error::Argument(format!(
        "`{}` is a picture, and this build reads none: build with the feature `export`, or give what it holds",
        path.display()
    )))
}

/// Refuses what is no picture that is small enough before its pixels are read.
#[cfg(feature = "export")]
fn fits(path: &Path, width: usize, height: usize, most: usize) -> Result<()> {
    if width.max(height) <= most {
        return Ok(());
    }
    let problem =
        format!("is {width} x {height} pixels, too large for a map: scale it to {most} x {most} at most");
    Err(Error::Format { path: path.to_owned(), problem })
}

#[cfg(feature = "export")]
fn png_pixels(path: &Path, most: usize) -> Result<Pixels> {
    let failed = |source| Error::File { action: "read", path: path.to_owned(), source };
    let refused = |error: &dyn std::fmt::Display| Error::Format {
        path: path.to_owned(),
        problem: format!("is no PNG picture ({error}): save the map as PNG or EXR"),
    };
    let file = std::io::BufReader::new(std::fs::File::open(path).map_err(failed)?);
    let mut decoder = png::Decoder::new(file);
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|error| refused(&error))?;
    let [width, height] = [reader.info().width, reader.info().height].map(|edge| edge as usize);
    fits(path, width, height, most)?;
    let size = reader.output_buffer_size().ok_or_else(|| refused(&"its size is not told"))?;
    let mut bytes = vec![0; size];
    let told = reader.next_frame(&mut bytes).map_err(|error| refused(&error))?;
    let (colour, depth) = (told.color_type, told.bit_depth);
    let numbers: Vec<f32> = match depth {
        png::BitDepth::Sixteen => bytes
            .chunks_exact(2)
            .map(|two| f32::from(u16::from_be_bytes([two[0], two[1]])) / 65535.0)
            .collect(),
        _ => bytes.iter().map(|&byte| f32::from(byte) / 255.0).collect(),
    };
    let has_colours = matches!(colour, png::ColorType::Rgb | png::ColorType::Rgba);
    let pixel = |pixel: &[f32]| if has_colours { [pixel[0], pixel[1], pixel[2]] } else { [pixel[0]; 3] };
    let values = numbers.chunks_exact(colour.samples()).take(width * height).map(pixel).collect();
    Ok(Pixels { width, values, is_encoded: true })
}

#[cfg(feature = "export")]
fn exr_pixels(path: &Path, most: usize) -> Result<Pixels> {
    use exr::prelude::{ReadChannels, ReadLayers};
    let refused = |error: exr::error::Error| match error {
        exr::error::Error::Io(source) => Error::File { action: "read", path: path.to_owned(), source },
        error => Error::Format { path: path.to_owned(), problem: format!("is no EXR picture: {error}") },
    };
    let headers = exr::meta::MetaData::read_from_file(path, false).map_err(refused)?.headers;
    if let Some(header) = headers.first() {
        fits(path, header.layer_size.0, header.layer_size.1, most)?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(refused)?;
    let layer = image.layer_data;
    let list = &layer.channel_data.list;
    let named = |name: &str| -> Option<Vec<f32>> {
        let found = list.iter().find(|channel| channel.name.to_string() == name)?;
        Some(found.sample_data.values_as_f32().collect())
    };
    let channels = ["R", "G", "B"].map(named);
    let known: Vec<Vec<f32>> = channels.iter().flatten().cloned().chain(named("Y")).collect();
    if known.is_empty() {
        let problem = "has no channel R, G, B or Y: save the map as grey or colours".to_owned();
        return Err(Error::Format { path: path.to_owned(), problem });
    }
    // A colour that is not there is the mean of those that are.
    let mean = |i: usize| known.iter().map(|channel| channel[i]).sum::<f32>() / known.len() as f32;
    let pixel = |i: usize| channels.each_ref().map(|own| own.as_ref().map_or_else(|| mean(i), |own| own[i]));
    let values = (0..layer.size.0 * layer.size.1).map(pixel).collect();
    Ok(Pixels { width: layer.size.0, values, is_encoded: false })
}
