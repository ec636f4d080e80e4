//! PNG, 8 bits a channel, sRGB.

use std::{io, path::Path};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use crate::{Result, files::write_whole};

/// Writes RGBA bytes, row by row from the top; alpha is kept where `transparent`, else
/// left out.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_png(path: &Path, size: [u32; 2], rgba: &[u8], transparent: bool) -> Result<()> {
    let opaque: Vec<u8>;
    let (bytes, color) = if transparent {
        (rgba, ExtendedColorType::Rgba8)
    } else {
        opaque = rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
        (opaque.as_slice(), ExtendedColorType::Rgb8)
    };
    write(path, size, bytes, color)
}

/// Writes shares from 0 to 1 as grey levels, without the sRGB curve, 16 bits each.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_grey(path: &Path, size: [u32; 2], shares: &[f32]) -> Result<()> {
    let levels: Vec<u16> =
        shares.iter().map(|share| (65535.0 * share.clamp(0.0, 1.0)).round() as u16).collect();
    write(path, size, bytemuck::cast_slice(&levels), ExtendedColorType::L16)
}

fn write(path: &Path, [width, height]: [u32; 2], bytes: &[u8], color: ExtendedColorType) -> Result<()> {
    write_whole(path, |file| {
        PngEncoder::new(file).write_image(bytes, width, height, color).map_err(|error| match error {
            image::ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    })
}
