//! Cube maps as KTX 2 with BC6H: half floats of which GPUs take one byte a pixel as they are.

use std::{io::Write, path::Path};

use block_compression::{BC6HSettings, CompressionVariant, encode::compress_rgba16};
use half::f16;
use ktx2::{Format, Header, Index, LevelIndex, dfd};
use rayon::prelude::*;

use super::Picture;
use crate::{Error, Result, files::write_whole};

/// Edge of a compressed block, pixels.
const BLOCK: usize = 4;
/// The largest half float, and the least brightest pixel of a picture that still has its shades in them.
const MOST: f32 = 65504.0;
const LEAST: f32 = 1e-3;
/// What is told beside the pixels: the first row is on top, the first column on the left.
const KEYS: [(&str, &str); 2] =
    [("KTXorientation", "rd"), ("KTXwriter", concat!("nephos ", env!("CARGO_PKG_VERSION")))];

/// Writes six square faces in the order +X, -X, +Y, -Y, +Z, -Z with their mip levels down to one pixel.
///
/// # Errors
/// [`Error::Argument`] where the edges of the faces are no multiple of 4 or their light is more than half floats
/// hold, [`Error::File`] when the file can't
/// be written.
pub fn write_ktx2(path: &Path, faces: &[Picture]) -> Result<()> {
    let size = faces.first().map_or(0, |face| face.width);
    if size == 0 || !size.is_multiple_of(BLOCK) {
        return Err(Error::Argument(format!(
            "faces of {size} pixels can't be compressed in blocks of 4 by 4: take a multiple of 4, \
             best a power of two"
        )));
    }
    check_light(faces)?;
    let levels: Vec<Vec<u8>> =
        mips(faces).iter().map(|faces| faces.par_iter().flat_map(compressed).collect()).collect();
    let failed = |error: dfd::BuildError| Error::Argument(format!("KTX 2 does not know BC6H: {error:?}"));
    let (basic, type_size) = dfd::Basic::from_format(Format::BC6H_UFLOAT_BLOCK).map_err(failed)?;
    let described = described(basic);
    let keys = keys();
    let dfd_at = Header::LENGTH + levels.len() * LevelIndex::LENGTH;
    let keys_at = dfd_at + described.len();
    let begin = (keys_at + keys.len()).next_multiple_of(16);
    let header = Header {
        format: Some(Format::BC6H_UFLOAT_BLOCK),
        type_size,
        pixel_width: size as u32,
        pixel_height: size as u32,
        pixel_depth: 0,
        layer_count: 0,
        face_count: faces.len() as u32,
        level_count: levels.len() as u32,
        supercompression_scheme: None,
        index: Index {
            dfd_byte_offset: dfd_at as u32,
            dfd_byte_length: described.len() as u32,
            kvd_byte_offset: keys_at as u32,
            kvd_byte_length: keys.len() as u32,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    write_whole(path, |file| {
        file.write_all(&header.as_bytes())?;
        for (i, level) in levels.iter().enumerate() {
            // The smallest level comes first, so that a stream can show something soon.
            let byte_offset = begin + levels[i + 1..].iter().map(Vec::len).sum::<usize>();
            let length = level.len() as u64;
            let index = LevelIndex {
                byte_offset: byte_offset as u64,
                byte_length: length,
                uncompressed_byte_length: length,
            };
            file.write_all(&index.as_bytes())?;
        }
        file.write_all(&described)?;
        file.write_all(&keys)?;
        file.write_all(&vec![0; begin - keys_at - keys.len()])?;
        levels.iter().rev().try_for_each(|level| file.write_all(level))
    })
}

/// BC6H has half floats, and no scale beside them.
fn check_light(faces: &[Picture]) -> Result<()> {
    let lights = faces.iter().flat_map(|face| &face.pixels).flat_map(|pixel| &pixel[..3]);
    let largest = lights.fold(0f32, |largest, light| largest.max(*light));
    if largest == 0.0 || (LEAST..=MOST).contains(&largest) {
        return Ok(());
    }
    Err(Error::Argument(format!(
        "the brightest pixel is {largest}, and the half floats of KTX 2 with BC6H hold {LEAST} to {MOST}: give the sun \
         another irradiance, 1 is good for most, or a larger disc, or write .exr or .hdr"
    )))
}

/// Each level's faces, the largest first, down to one pixel: each edge is half of the one before, rounded down.
fn mips(faces: &[Picture]) -> Vec<Vec<Picture>> {
    let mut levels = vec![faces.to_vec()];
    while let Some(last) = levels.last()
        && last[0].width > 1
    {
        levels.push(last.iter().map(halved).collect());
    }
    levels
}

/// A square of half the edge, rounded down: each pixel is the mean of what it covers.
fn halved(face: &Picture) -> Picture {
    let size = face.width / 2;
    let step = face.width as f32 / size as f32;
    // Pixels of the old row that a new one covers, and how much of each.
    let covered = |i: usize| {
        let (begin, end) = (i as f32 * step, (i + 1) as f32 * step);
        (begin as usize..(end.ceil() as usize).min(face.width))
            .map(move |old| (old, (end.min(old as f32 + 1.0) - begin.max(old as f32)).max(0.0) / step))
    };
    let mean = |i: usize| {
        let mut sum = [0.0; 4];
        for (y, height) in covered(i / size) {
            for (x, width) in covered(i % size) {
                let pixel = face.pixels[y * face.width + x];
                sum.iter_mut().zip(pixel).for_each(|(sum, c)| *sum += width * height * c);
            }
        }
        sum
    };
    Picture { width: size, height: size, pixels: (0..size * size).map(mean).collect() }
}

fn compressed(face: &Picture) -> Vec<u8> {
    // Blocks are whole: beyond the picture its last pixels go on.
    let size = face.width.next_multiple_of(BLOCK);
    let within = |n: usize| n.min(face.width - 1);
    let pixel = |i: usize| face.pixels[within(i / size) * face.width + within(i % size)];
    let halves: Vec<f16> =
        (0..size * size).flat_map(pixel).map(|c| f16::from_f32(c.clamp(0.0, MOST))).collect();
    let size = size as u32;
    let variant = CompressionVariant::BC6H(BC6HSettings::basic());
    let mut blocks = vec![0; variant.blocks_byte_size(size, size)];
    compress_rgba16(variant, &halves, &mut blocks, size, size, 4 * size);
    blocks
}

fn described(basic: dfd::Basic) -> Vec<u8> {
    let block = dfd::Block::Basic(basic).to_vec();
    [((block.len() + 4) as u32).to_le_bytes().to_vec(), block].concat()
}

fn keys() -> Vec<u8> {
    let mut out = Vec::new();
    for (key, value) in KEYS {
        let entry = format!("{key}\0{value}\0");
        out.extend((entry.len() as u32).to_le_bytes());
        out.extend(entry.as_bytes());
        out.resize(out.len().next_multiple_of(4), 0);
    }
    out
}
