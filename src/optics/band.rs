//! The wavelengths of a channel. Bows and halos are as sharp as a colour is pure, so that three pure colours would
//! draw three thin arcs with nothing between them; a channel sees a band.

use super::WAVELENGTHS_UM;

/// Half the width of a channel's band at its foot, micrometres: bands are triangles about
/// [`WAVELENGTHS_UM`], which add up to the same everywhere from 450 to 650 nm.
pub const HALF_WIDTH_UM: f64 = 0.1;

/// Shortest wavelength that is seen, micrometres.
const SHORTEST_UM: f64 = 0.38;

/// The wavelength of a channel, micrometres, below which lies the share `share` (0 to 1) of what it sees.
pub fn wavelength_um(channel: usize, share: f64) -> f64 {
    // The area of a triangle of width 2 and height 1 up to a distance y from its end is y^2 / 2.
    let from_end = (2.0 * share.min(1.0 - share)).max(0.0).sqrt();
    let place = if share < 0.5 { from_end - 1.0 } else { 1.0 - from_end };
    (WAVELENGTHS_UM[channel] + HALF_WIDTH_UM * place).max(SHORTEST_UM)
}

/// `count` wavelengths of a channel, micrometres, each of which stands for the same share of it.
pub fn wavelengths_um(channel: usize, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| wavelength_um(channel, (i as f64 + 0.5) / count as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_has_its_channels_wavelength_in_the_middle_and_the_variance_of_a_triangle() {
        for channel in [0, 1] {
            let all: Vec<f64> = wavelengths_um(channel, 4000).collect();
            let mean = all.iter().sum::<f64>() / 4000.0;
            let variance = all.iter().map(|um| (um - mean).powi(2)).sum::<f64>() / 4000.0;
            assert!((mean - WAVELENGTHS_UM[channel]).abs() < 1e-9, "{mean}");
            assert!((variance / (HALF_WIDTH_UM.powi(2) / 6.0) - 1.0).abs() < 1e-3, "{variance}");
        }
        // What is not seen of blue is taken as violet.
        assert!(wavelengths_um(2, 400).all(|um| (SHORTEST_UM..0.55).contains(&um)));
    }
}
