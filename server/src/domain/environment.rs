//! Surroundings that light a scene: an equirectangular map of linear radiance.

mod layout;

use rayon::prelude::*;

use super::{
    Error, Result,
    maps::{Pixels, decode},
};

pub use layout::EnvironmentLayout;
pub(crate) use layout::panorama;

/// Most texels of a map: 8192 x 4096. On a device it takes 16 bytes a texel, its mips a third more.
pub const MAX_TEXELS: u64 = 1 << 25;

const FIELD: &str = "lighting.environment";

/// Light from everywhere. Direction d is at u = 1/2 + atan2(d.z, d.x) / 2 pi, v = acos(d.y) / pi from the top: the middle
/// is +x, as three.js and Khronos' viewer have it.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    pub width: u32,
    pub height: u32,
    /// Linear radiance, top row first, finite and not below 0.
    pub texels: Vec<[f32; 3]>,
}

impl Environment {
    /// Reads a Radiance HDR or OpenEXR file, whatever it is called.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        Self::decode_as(bytes, EnvironmentLayout::Equirect)
    }

    /// The same, of another layout.
    pub fn decode_as(bytes: &[u8], layout: EnvironmentLayout) -> Result<Self> {
        check_format(bytes)?;
        let pixels = decode(FIELD, bytes)?;
        check_size(&pixels)?;
        let texels = rgb(&pixels);
        if let Some(at) = texels.par_iter().position_first(|texel| texel.iter().any(|v| *v < 0.0)) {
            let (x, y) = (at % pixels.width as usize, at / pixels.width as usize);
            let message = format!("texel ({x}, {y}) is {:?}; radiance is 0 or more: clamp the map", texels[at]);
            return Err(Error::invalid(FIELD, message));
        }
        layout.resampled(Self { width: pixels.width, height: pixels.height, texels })
    }
}

fn check_format(bytes: &[u8]) -> Result<()> {
    let known: [&[u8]; 3] = [b"#?RADIANCE", b"#?RGBE", &[0x76, 0x2f, 0x31, 0x01]];
    if known.iter().any(|magic| bytes.starts_with(magic)) {
        return Ok(());
    }
    let message = "the map is neither Radiance HDR nor OpenEXR, the two that hold radiance: convert it";
    Err(Error::invalid(FIELD, message))
}

fn check_size(pixels: &Pixels) -> Result<()> {
    let (width, height) = (pixels.width, pixels.height);
    if u64::from(width) * u64::from(height) <= MAX_TEXELS {
        return Ok(());
    }
    let message =
        format!("the map has {width} x {height} pixels; allowed are {MAX_TEXELS} in all (8192 x 4096): scale it down");
    Err(Error::too_large(FIELD, message))
}

/// Grey where there is one channel; alpha is left out.
fn rgb(pixels: &Pixels) -> Vec<[f32; 3]> {
    let channels = if pixels.channels >= 3 { [0, 1, 2] } else { [0; 3] };
    pixels.texels(channels, |_, v| v).as_chunks().0.to_vec()
}

#[cfg(test)]
mod tests {
    use exr::prelude::*;

    use super::*;

    fn written(texel: [f32; 3]) -> Vec<u8> {
        let color = |at: Vec2<usize>| if at == Vec2(2, 1) { texel.into() } else { (1.0f32, 2.0f32, 3.0f32) };
        let image = Image::from_channels((4, 2), SpecificChannels::rgb(color));
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).expect("writes");
        bytes.into_inner()
    }

    #[test]
    fn an_exr_map_is_read_as_it_is() {
        let environment = Environment::decode(&written([0.0, 9.5, 1000.0])).expect("reads");
        assert_eq!((environment.width, environment.height), (4, 2));
        assert_eq!((environment.texels[0], environment.texels[6]), ([1.0, 2.0, 3.0], [0.0, 9.5, 1000.0]));
    }

    #[test]
    fn a_radiance_map_is_read_by_its_content() {
        let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
        // Mantissas over 256 times two to the exponent less 128.
        bytes.extend([128, 64, 0, 129, 128, 128, 128, 130]);
        let environment = Environment::decode(&bytes).expect("reads");
        assert_eq!(environment.texels, [[1.0, 0.5, 0.0], [2.0; 3]]);
    }

    #[test]
    fn texels_that_are_no_radiance_are_refused_by_their_place() {
        for (value, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (-0.5, "-0.5")] {
            let error = Environment::decode(&written([1.0, value, 1.0])).expect_err("refused").to_string();
            assert!(error.starts_with("lighting.environment: texel (2, 1) is") && error.contains(shown), "{error}");
        }
    }

    #[test]
    fn other_files_are_refused() {
        for bytes in [&b"\x89PNG\r\n\x1a\n"[..], b"", b"#?"] {
            let error = Environment::decode(bytes).expect_err("refused").to_string();
            assert!(error.contains("neither Radiance HDR nor OpenEXR"), "{error}");
        }
        let error = Environment::decode(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n").expect_err("cut off");
        assert_eq!(error.field.as_deref(), Some("lighting.environment"));
    }
}
