//! Mitsuba's grid volumes: every voxel of a box (`gridvolume`, version 3).

use glam::{DAffine3, DMat3, DVec3};
use half::f16;

use super::bytes::{Bytes, Problem};
use crate::scene::{Grid, MOST_ALONG};

/// What files begin with.
const HEAD: &[u8] = b"VOL";
/// Encodings: floats, half floats, bytes from 0 to 1.
const FLOATS: i32 = 1;
const HALVES: i32 = 2;
const BYTES: i32 = 3;

pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(HEAD)
}

pub(super) fn read(all: &[u8]) -> Result<Grid, Problem> {
    let mut bytes = Bytes::new(all);
    if bytes.take(3)? != HEAD {
        return Err("is no volume of Mitsuba's: it does not begin with VOL".to_owned());
    }
    let version = bytes.byte()?;
    if version != 3 {
        return Err(format!(
            "has version {version} of Mitsuba's format, and version 3 is read: write it by Mitsuba 3"
        ));
    }
    let encoding = bytes.i32()?;
    let [x, y, z, channels] = [bytes.i32()?, bytes.i32()?, bytes.i32()?, bytes.i32()?];
    if channels != 1 {
        return Err(format!("has {channels} channels, and one of density is read: write that alone"));
    }
    let size = [x, y, z];
    if size.iter().any(|n| !(1..=MOST_ALONG).contains(n)) {
        return Err(format!("has {x} x {y} x {z} voxels: 1 to {MOST_ALONG} along each axis are read"));
    }
    let mut corner =
        || Ok::<_, Problem>(DVec3::new(bytes.f32()?.into(), bytes.f32()?.into(), bytes.f32()?.into()));
    let (low, high) = (corner()?, corner()?);
    let size = size.map(|n| n as u32);
    let width = match encoding {
        FLOATS => 4,
        HALVES => 2,
        BYTES => 1,
        _ => {
            return Err(format!(
                "has values of encoding {encoding}: floats (1), halves (2) and bytes (3) are read"
            ));
        }
    };
    let count: usize = size.iter().map(|n| *n as usize).product();
    let values = bytes.take(count * width)?.chunks_exact(width).map(|value| match *value {
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
        [a, b] => f16::from_le_bytes([a, b]).to_f32(),
        _ => value.first().map_or(0.0, |byte| f32::from(*byte) / 255.0),
    });
    // Corners are faces of the outermost voxels.
    let edge = (high - low) / DVec3::from(size.map(f64::from));
    let place = DAffine3::from_mat3_translation(DMat3::from_diagonal(edge), low + 0.5 * edge);
    let mut grid = Grid::dense("density".to_owned(), place, size, values)?;
    // What media of Mitsuba's take such volumes for.
    grid.quantity = "extinction coefficient".to_owned();
    Ok(grid)
}
