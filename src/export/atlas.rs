//! What the files of sprites hold: tiles side by side, and numbers as colours.

use super::Picture;

/// Unit vectors as colours, from -1 at 0 to 1 at 1: those of a picture whose vectors are multiplied by
/// alpha. Up is green; empty pixels point nowhere.
pub fn normals(picture: &Picture) -> Picture {
    let pixel = |&[x, y, z, a]: &[f32; 4]| {
        let length = (x * x + y * y + z * z).sqrt().max(1e-6);
        let share = |n: f32| 0.5 + 0.5 * n / length;
        [share(x), share(y), share(z), a]
    };
    Picture { pixels: picture.pixels.iter().map(pixel).collect(), ..*picture }
}

/// Bytes of shares from 0 to 1, without a curve.
pub fn bytes(picture: &Picture) -> Vec<u8> {
    picture.pixels.iter().flatten().map(|share| (255.0 * share.clamp(0.0, 1.0)).round() as u8).collect()
}

/// Rows and columns for so many tiles: as near to a square as can be.
pub fn columns(tiles: u32) -> u32 {
    f64::from(tiles).sqrt().ceil() as u32
}

/// What all colours but one in a thousand are below, at least 1e-6: a few glints may be cut.
pub fn brightest(pictures: &[&Picture]) -> f32 {
    let pixels = pictures.iter().flat_map(|picture| &picture.pixels);
    let mut values: Vec<f32> =
        pixels.filter(|pixel| pixel[3] > 0.0).flat_map(|pixel| pixel[..3].to_vec()).collect();
    values.sort_by(f32::total_cmp);
    let place = values.len().saturating_sub(1 + values.len() / 1000);
    values.get(place).copied().unwrap_or(1.0).max(1e-6)
}
