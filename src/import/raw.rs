//! Bricks of floats: nothing but numbers, x fastest.

use glam::{DAffine3, DVec3};

use super::bytes::Problem;
use crate::scene::{Grid, MOST_ALONG};

/// How the numbers of a brick lie, which its file does not tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raw {
    /// Voxels along x (fastest), y and z.
    pub size: [u32; 3],
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
    /// Edges of a voxel, in the file's lengths.
    pub voxel: DVec3,
}

/// Values that are no density but say that there is none, as files from the weather have them.
const MISSING: f32 = 1e30;

pub(super) fn read(bytes: &[u8], raw: &Raw) -> Result<Grid, Problem> {
    let [x, y, z] = raw.size;
    if raw.size.iter().any(|n| !(1..=MOST_ALONG as u32).contains(n)) {
        return Err(format!("would have {x} x {y} x {z} voxels: 1 to {MOST_ALONG} along each axis are read"));
    }
    let expected = 4 * u64::from(x) * u64::from(y) * u64::from(z);
    if bytes.len() as u64 != expected {
        return Err(format!(
            "has {} bytes, and {x} x {y} x {z} floats have {expected}: give its true `size`",
            bytes.len()
        ));
    }
    let number = |value: &[u8]| {
        let value: [u8; 4] = std::array::from_fn(|i| value.get(i).copied().unwrap_or_default());
        if raw.big_endian { f32::from_be_bytes(value) } else { f32::from_le_bytes(value) }
    };
    let values = || bytes.chunks_exact(4).map(number);
    // Floats in the other order are tiny or huge, or no numbers.
    let odd = |value: &f32| !value.is_finite() || (*value != 0.0 && !(1e-25..MISSING).contains(&value.abs()));
    let strange = values().filter(odd).filter(|value| *value < MISSING || !value.is_finite()).count();
    if strange as u64 > expected / 16 {
        return Err(format!(
            "has {strange} values that are no numbers of any measure: its bytes stand in the other order; give the other \
             `endian`"
        ));
    }
    let values = values().map(|value| if value.is_finite() && value >= MISSING { 0.0 } else { value });
    Grid::dense("density".to_owned(), DAffine3::from_scale(raw.voxel), raw.size, values)
}
