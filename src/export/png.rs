//! PNG, 8 bits a channel, sRGB.

use std::{io, path::Path};

use super::{Notes, bleed::bled_bytes};
use crate::{Error, Result, files::write_whole};

/// Writes RGBA bytes, row by row from the top; alpha is kept where `transparent`, else
/// left out. Colours under alpha 0 are those of the nearest pixels that are seen.
///
/// # Errors
/// [`Error::File`] when the file can't be written.
pub fn write_png(path: &Path, size: [u32; 2], rgba: &[u8], transparent: bool) -> Result<()> {
    write_png_noted(path, size, rgba, transparent, &Notes::default())
}

/// The same with notes, as text chunks.
///
/// # Errors
/// [`Error::File`] when the file can't be written.
pub fn write_png_noted(
    path: &Path,
    size: [u32; 2],
    rgba: &[u8],
    transparent: bool,
    notes: &Notes,
) -> Result<()> {
    let (bytes, color) = match transparent {
        true => (bled_bytes(rgba, size[0] as usize), png::ColorType::Rgba),
        false => (opaque_of(rgba), png::ColorType::Rgb),
    };
    write(path, size, &bytes, (color, png::BitDepth::Eight), notes)
}

/// Writes shares from 0 to 1 as grey levels, without the sRGB curve, 16 bits each.
///
/// # Errors
/// [`Error::File`] when the file can't be written.
pub fn write_grey(path: &Path, size: [u32; 2], shares: &[f32]) -> Result<()> {
    let level = |share: &f32| ((65535.0 * share.clamp(0.0, 1.0)).round() as u16).to_be_bytes();
    let levels: Vec<u8> = shares.iter().flat_map(level).collect();
    write(path, size, &levels, (png::ColorType::Grayscale, png::BitDepth::Sixteen), &Notes::default())
}

fn write(
    path: &Path,
    [width, height]: [u32; 2],
    bytes: &[u8],
    (color, depth): (png::ColorType, png::BitDepth),
    notes: &Notes,
) -> Result<()> {
    write_whole(path, |file| {
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        for (name, text) in &notes.texts {
            encoder.add_text_chunk(name.clone(), text.clone()).map_err(io::Error::other)?;
        }
        let mut writer = encoder.write_header().map_err(plain)?;
        writer.write_image_data(bytes).map_err(plain)?;
        writer.finish().map_err(plain)
    })
}

/// RGB bytes of RGBA bytes.
pub fn opaque_of(rgba: &[u8]) -> Vec<u8> {
    rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect()
}

/// Reads a PNG file as RGB bytes, row by row from the top.
///
/// # Errors
/// [`Error::Format`] where it is no PNG file, or not whole.
pub fn read_rgb(path: &Path) -> Result<Vec<u8>> {
    let picture = image::open(path).map_err(|error| Error::Format {
        path: path.to_owned(),
        problem: format!("can't be read as a picture: {error}"),
    })?;
    Ok(picture.into_rgb8().into_raw())
}

fn plain(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}
