//! Radiance HDR: three bytes and an exponent a pixel, which every engine reads.

use std::{io, path::Path};

use image::{Rgb, codecs::hdr::HdrEncoder};

use super::Picture;
use crate::{Result, files::write_whole};

/// Writes the linear light of `picture`; it has no alpha, and is good to 1 in 256 of the brightest
/// channel.
///
/// # Errors
/// [`crate::Error::File`] when the file can't be written.
pub fn write_hdr(path: &Path, picture: &Picture) -> Result<()> {
    let pixels: Vec<_> = picture.pixels.iter().map(|&[r, g, b, _]| Rgb([r, g, b])).collect();
    write_whole(path, |file| {
        HdrEncoder::new(file).encode(&pixels, picture.width, picture.height).map_err(|error| match error {
            image::ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    })
}
