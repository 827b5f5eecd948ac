//! Colour maps: decoded to linear RGBA.

use rayon::prelude::*;

use super::{
    MAX_COLOR_TEXELS,
    pixels::{Pixels, Values, decode},
};
use crate::domain::{Error, Result, image::ColorMap};

/// Decodes a colour image: 8-bit and 16-bit values are sRGB, floats are linear. Alpha is always linear.
pub fn color_map(field: &str, bytes: &[u8]) -> Result<ColorMap> {
    let pixels = decode(field, bytes)?;
    let (width, height) = (pixels.width, pixels.height);
    if u64::from(width) * u64::from(height) > MAX_COLOR_TEXELS {
        let message = format!(
            "the colour map has {width} x {height} pixels; allowed are {MAX_COLOR_TEXELS} in all: scale it down"
        );
        return Err(Error::too_large(field, message));
    }
    let texels = match &pixels.values {
        Values::U8(values) => {
            let table: Vec<f32> = (0..=255u8).map(|v| linear_from_srgb(f32::from(v) / 255.0)).collect();
            gathered(&pixels, values, |v| table[usize::from(v)], |v| f32::from(v) / 255.0)
        }
        Values::U16(values) => {
            gathered(&pixels, values, |v| linear_from_srgb(f32::from(v) / 65535.0), |v| f32::from(v) / 65535.0)
        }
        Values::F32(values) => gathered(&pixels, values, |v| v.max(0.0), |v| v.clamp(0.0, 1.0)),
    };
    Ok(ColorMap { width, height, texels })
}

fn gathered<T: Copy + Sync>(
    pixels: &Pixels,
    values: &[T],
    color: impl Fn(T) -> f32 + Sync,
    alpha: impl Fn(T) -> f32 + Sync,
) -> Vec<[f32; 4]> {
    let texel = |texel: &[T]| match *texel {
        [y] => [color(y), color(y), color(y), 1.0],
        [y, a] => [color(y), color(y), color(y), alpha(a)],
        [r, g, b] => [color(r), color(g), color(b), 1.0],
        [r, g, b, a, ..] => [color(r), color(g), color(b), alpha(a)],
        [] => [0.0; 4],
    };
    values.par_chunks_exact(pixels.channels).map(texel).collect()
}

/// IEC 61966-2-1.
fn linear_from_srgb(value: f32) -> f32 {
    let value = f64::from(value);
    let linear = if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
    linear as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_decoding_keeps_the_ends_and_the_known_middle() {
        assert_eq!(linear_from_srgb(0.0), 0.0);
        assert_eq!(linear_from_srgb(1.0), 1.0);
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-6);
    }
}
