//! Maps that surfaces are shaded with: colours decoded to linear RGBA, shares, vectors.

use rayon::prelude::*;

use super::{
    MAX_COLOR_TEXELS,
    pixels::{Pixels, Values, decode},
};
use crate::domain::{Error, Result, image::ColorMap};

/// What the values of an image that is shaded with stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// 8 and 16 bits are sRGB, floats linear; alpha is linear.
    Color,
    /// Linear as they are.
    Linear,
    /// Vectors: 2 v - 1 of v in [0, 1] (glTF 2.0, 3.9.3).
    Vector,
}

/// Decodes a colour image to linear RGBA.
pub fn color_map(field: &str, bytes: &[u8]) -> Result<ColorMap> {
    texture_map(field, bytes, Encoding::Color)
}

/// Decodes an image that is shaded with.
pub fn texture_map(field: &str, bytes: &[u8], encoding: Encoding) -> Result<ColorMap> {
    let pixels = decode(field, bytes)?;
    let (width, height) = (pixels.width, pixels.height);
    if u64::from(width) * u64::from(height) > MAX_COLOR_TEXELS {
        let message =
            format!("the map has {width} x {height} pixels; allowed are {MAX_COLOR_TEXELS} in all: scale it down");
        return Err(Error::too_large(field, message));
    }
    let texels = match &pixels.values {
        Values::U8(values) => {
            let table: Vec<f32> = (0..=255u8).map(|v| of_whole(encoding, v.into(), 255)).collect();
            gathered(&pixels, values, |v| table[usize::from(v)], |v| f32::from(v) / 255.0)
        }
        Values::U16(values) => gathered(&pixels, values, |v| of_whole(encoding, v, 65535), |v| f32::from(v) / 65535.0),
        Values::F32(values) => gathered(&pixels, values, |v| of_float(encoding, v), |v| v.clamp(0.0, 1.0)),
    };
    Ok(ColorMap { width, height, texels })
}

fn of_whole(encoding: Encoding, value: u16, most: u16) -> f32 {
    let share = f32::from(value) / f32::from(most);
    match encoding {
        Encoding::Color => linear_from_srgb(share),
        Encoding::Linear => share,
        Encoding::Vector => 2.0 * share - 1.0,
    }
}

fn of_float(encoding: Encoding, value: f32) -> f32 {
    match encoding {
        Encoding::Vector => 2.0 * value - 1.0,
        Encoding::Color | Encoding::Linear => value.max(0.0),
    }
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
    fn vectors_reach_from_minus_one_to_one() {
        assert_eq!([0, 255].map(|v| of_whole(Encoding::Vector, v, 255)), [-1.0, 1.0]);
        assert_eq!(of_float(Encoding::Vector, 0.5), 0.0);
    }

    #[test]
    fn srgb_decoding_keeps_the_ends_and_the_known_middle() {
        assert_eq!(linear_from_srgb(0.0), 0.0);
        assert_eq!(linear_from_srgb(1.0), 1.0);
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-6);
    }
}
