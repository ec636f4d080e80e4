//! PNG, 8 bits a channel, sRGB.

use std::{io, path::Path};

use super::write_atomically;
use crate::Result;

/// Writes RGBA bytes, row by row from the top; alpha is kept where `transparent`, else
/// left out.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_png(path: &Path, [width, height]: [u32; 2], rgba: &[u8], transparent: bool) -> Result<()> {
    let opaque: Vec<u8>;
    let (bytes, color) = if transparent {
        (rgba, image::ExtendedColorType::Rgba8)
    } else {
        opaque = rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
        (opaque.as_slice(), image::ExtendedColorType::Rgb8)
    };
    write_atomically(path, |path| {
        image::save_buffer_with_format(path, bytes, width, height, color, image::ImageFormat::Png).map_err(
            |error| match error {
                image::ImageError::IoError(error) => error,
                other => io::Error::other(other),
            },
        )
    })
}
