//! The sRGB curve and luminance, in f64.

/// IEC 61966-2-1. Values outside 0 to 1 are cut.
#[must_use]
pub fn encoded_from_linear(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// IEC 61966-2-1, from 0 to 1.
#[must_use]
pub fn linear_from_encoded(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Rec. 709 weights on sRGB-encoded values: luma, 0 to 1.
#[must_use]
pub fn luma(linear: [f32; 3]) -> f64 {
    let [r, g, b] = linear.map(|light| encoded_from_linear(f64::from(light)));
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// 8-bit sRGB.
#[must_use]
pub fn byte(linear: f32) -> u8 {
    (encoded_from_linear(f64::from(linear)) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_way_to_linear_light_and_back() {
        for value in 0..=255u8 {
            assert_eq!(byte(linear_from_encoded(f64::from(value) / 255.0) as f32), value);
        }
    }

    #[test]
    fn the_curve_passes_through_its_known_points() {
        assert_eq!([-1.0, 0.0].map(encoded_from_linear), [0.0; 2]);
        assert!((encoded_from_linear(1.0) - 1.0).abs() < 1e-15);
        assert_eq!(encoded_from_linear(7.0), encoded_from_linear(1.0));
        assert!((linear_from_encoded(0.5) - 0.214_041_14).abs() < 1e-8);
        assert!((luma([1.0; 3]) - 1.0).abs() < 1e-12 && luma([0.0; 3]) == 0.0);
    }
}
