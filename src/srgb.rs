//! Light and numbers as screens take it (IEC 61966-2-1).

/// What stands for linear light from 0 to 1.
pub(crate) fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear light of what stands for it.
pub(crate) fn decoded(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// A byte that stands for linear light; what is no number or less than 0 is 0, more than 1 is 255.
pub(crate) fn byte(linear: f32) -> u8 {
    let linear = if linear > 0.0 { f64::from(linear.min(1.0)) } else { 0.0 };
    (255.0 * encoded(linear)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_as_they_were() {
        for i in 0..=255u8 {
            assert_eq!(byte(decoded(f64::from(i) / 255.0) as f32), i);
        }
        assert_eq!([f32::NAN, -1.0, 7.0].map(byte), [0, 0, 255]);
    }
}
