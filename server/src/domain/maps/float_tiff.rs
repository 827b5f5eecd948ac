//! TIFF with one float channel, as sculpting programs write heights: the image library reads floats only by three
//! and four.

use std::io::Cursor;

use tiff::{
    ColorType, TiffResult,
    decoder::{Decoder, DecodingResult, Limits},
};

use super::{
    MAX_DECODED_BYTES,
    pixels::{Pixels, Values, check_size},
};
use crate::domain::{Error, Result};

/// The heights; `None` for every other kind of file.
pub(super) fn decode(field: &str, bytes: &[u8]) -> Result<Option<Pixels>> {
    if !bytes.starts_with(b"II*\0") && !bytes.starts_with(b"MM\0*") {
        return Ok(None);
    }
    // What the header alone cannot be read from is for the general reader to tell of.
    let Ok(mut decoder) = open(bytes) else { return Ok(None) };
    let Ok((width, height)) = decoder.dimensions() else { return Ok(None) };
    let Ok(ColorType::Gray(bits @ (16 | 32 | 64))) = decoder.colortype() else { return Ok(None) };
    if !holds_floats(&mut decoder) {
        return Ok(None);
    }
    check_size(field, width, height, u64::from(bits) / 8)?;
    let unreadable = |cause: tiff::TiffError| {
        Error::invalid(field, format!("the TIFF file cannot be decoded ({cause}); write it anew, or give OpenEXR"))
    };
    let values = match decoder.read_image().map_err(unreadable)? {
        DecodingResult::F16(values) => values.into_iter().map(f32::from).collect(),
        DecodingResult::F32(values) => values,
        DecodingResult::F64(values) => values.into_iter().map(|value| value as f32).collect(),
        _ => return Err(Error::internal("a TIFF of floats gave something else")),
    };
    Ok(Some(Pixels { width, height, channels: 1, values: Values::F32(values) }))
}

fn open(bytes: &[u8]) -> TiffResult<Decoder<Cursor<&[u8]>>> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MAX_DECODED_BYTES as usize;
    limits.intermediate_buffer_size = limits.decoding_buffer_size;
    Ok(Decoder::new(Cursor::new(bytes))?.with_limits(limits))
}

fn holds_floats(decoder: &mut Decoder<Cursor<&[u8]>>) -> bool {
    const IEEE_FLOAT: u64 = 3;
    let formats = decoder.get_tag_u64_vec(tiff::tags::Tag::SampleFormat);
    formats.is_ok_and(|formats| formats.iter().all(|format| *format == IEEE_FLOAT))
}

#[cfg(test)]
mod tests {
    use tiff::encoder::{TiffEncoder, colortype::Gray32Float};

    use super::super::pixels;
    use super::*;

    fn file(width: u32, height: u32, values: &[f32]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).expect("starts");
        encoder.write_image::<Gray32Float>(width, height, values).expect("writes");
        bytes.into_inner()
    }

    #[test]
    fn heights_beyond_0_and_1_are_read_as_they_are() {
        let heights = [-1.5, 0.0, 2.25, 1e-20, 3e8, 0.1];
        let pixels = pixels::decode("height", &file(3, 2, &heights)).expect("decodes");
        let expected = Pixels { width: 3, height: 2, channels: 1, values: Values::F32(heights.to_vec()) };
        assert_eq!(pixels, expected);
    }

    #[test]
    fn damage_is_an_error_that_names_the_field() {
        let bytes = file(3, 2, &[0.0, 1.0, 2.0, f32::NAN, 4.0, 5.0]);
        assert!(pixels::decode("height", &bytes).expect_err("not finite").message.contains("texel (0, 1)"));
        for length in 0..bytes.len() {
            if let Err(error) = pixels::decode("height", &bytes[..length]) {
                assert_eq!(error.field.as_deref(), Some("height"), "{length}");
            }
        }
    }
}
