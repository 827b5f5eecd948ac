//! Decoding image files without any colour conversion: PNG 8/16, JPEG, TIFF 8/16 and float, Radiance HDR, OpenEXR.

use std::io::Cursor;

use image::{ColorType, DynamicImage, ImageDecoder, ImageReader, Limits};
use rayon::prelude::*;

use super::{MAX_DECODED_BYTES, MAX_MAP_PIXELS, float_tiff};
use crate::domain::{Error, Result};

/// A decoded image, channels interleaved, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    pub width: u32,
    pub height: u32,
    /// 1 to 4.
    pub channels: usize,
    pub values: Values,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    U8(Vec<u8>),
    U16(Vec<u16>),
    F32(Vec<f32>),
}

impl Pixels {
    /// Bits per channel of the file: 8, 16 or 32.
    #[must_use]
    pub fn bits(&self) -> u32 {
        match self.values {
            Values::U8(_) => 8,
            Values::U16(_) => 16,
            Values::F32(_) => 32,
        }
    }

    #[must_use]
    pub fn bytes(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * self.channels as u64 * u64::from(self.bits()) / 8
    }

    #[must_use]
    pub fn is_float(&self) -> bool {
        matches!(self.values, Values::F32(_))
    }

    /// One value per texel for each of `channels`, interleaved: v/255, v/65535, or the float itself, mapped by `f`
    /// (which is told the position within `channels`).
    #[must_use]
    pub fn texels<const N: usize>(&self, channels: [usize; N], f: impl Fn(usize, f32) -> f32 + Sync) -> Vec<f32> {
        fn pick<T: Copy + Sync, const N: usize>(
            values: &[T],
            stride: usize,
            channels: [usize; N],
            f: impl Fn(usize, T) -> f32 + Sync,
        ) -> Vec<f32> {
            let texels = values.len() / stride;
            let mut out = vec![0.0; texels * N];
            const BLOCK: usize = 1 << 16;
            out.par_chunks_mut(BLOCK * N).zip(values.par_chunks(BLOCK * stride)).for_each(|(out, values)| {
                for (out, texel) in out.chunks_exact_mut(N).zip(values.chunks_exact(stride)) {
                    for k in 0..N {
                        out[k] = f(k, texel[channels[k]]);
                    }
                }
            });
            out
        }
        match &self.values {
            Values::U8(v) => pick(v, self.channels, channels, |k, x| f(k, f32::from(x) / 255.0)),
            Values::U16(v) => pick(v, self.channels, channels, |k, x| f(k, f32::from(x) / 65535.0)),
            Values::F32(v) => pick(v, self.channels, channels, f),
        }
    }
}

/// Decodes an image file. `field` names it in errors.
pub fn decode(field: &str, bytes: &[u8]) -> Result<Pixels> {
    let pixels = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr(field, bytes)?
    } else if let Some(heights) = float_tiff::decode(field, bytes)? {
        heights
    } else {
        plain(field, bytes)?
    };
    if let Values::F32(values) = &pixels.values
        && let Some(at) = values.par_iter().position_first(|v| !v.is_finite())
    {
        let texel = at / pixels.channels;
        let (x, y) = (texel % pixels.width as usize, texel / pixels.width as usize);
        return Err(Error::invalid(field, format!("texel ({x}, {y}) is {}; values must be finite", values[at])));
    }
    Ok(pixels)
}

/// `pixel_bytes`: of a decoded pixel.
pub(super) fn check_size(field: &str, width: u32, height: u32, pixel_bytes: u64) -> Result<()> {
    if width == 0 || height == 0 || width > MAX_MAP_PIXELS || height > MAX_MAP_PIXELS {
        return Err(Error::too_large(
            field,
            format!(
                "the image has {width} x {height} pixels; allowed are 1 to {MAX_MAP_PIXELS} each way: scale it down"
            ),
        ));
    }
    let bytes = u64::from(width) * u64::from(height) * pixel_bytes;
    if bytes > MAX_DECODED_BYTES {
        let message = format!(
            "the image has {bytes} bytes once it is decoded ({width} x {height} pixels of {pixel_bytes}); allowed are {MAX_DECODED_BYTES}: scale it down, or give fewer channels or bits"
        );
        return Err(Error::too_large(field, message));
    }
    Ok(())
}

fn plain(field: &str, bytes: &[u8]) -> Result<Pixels> {
    let unreadable = |e: image::ImageError| {
        Error::invalid(
            field,
            format!("the image cannot be decoded ({e}); give PNG, JPEG, TIFF, Radiance HDR or OpenEXR"),
        )
    };
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| Error::invalid(field, "the image cannot be read").with_cause(e))?;
    let mut limits = Limits::default();
    // Checked below; readers ask for buffers of their own besides.
    limits.max_alloc = Some(2 * MAX_DECODED_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    check_size(field, width, height, u64::from(decoder.color_type().bytes_per_pixel()))?;
    let image = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
    let channels = usize::from(image.color().channel_count());
    let values = match image {
        DynamicImage::ImageLuma8(i) => Values::U8(i.into_raw()),
        DynamicImage::ImageLumaA8(i) => Values::U8(i.into_raw()),
        DynamicImage::ImageRgb8(i) => Values::U8(i.into_raw()),
        DynamicImage::ImageRgba8(i) => Values::U8(i.into_raw()),
        DynamicImage::ImageLuma16(i) => Values::U16(i.into_raw()),
        DynamicImage::ImageLumaA16(i) => Values::U16(i.into_raw()),
        DynamicImage::ImageRgb16(i) => Values::U16(i.into_raw()),
        DynamicImage::ImageRgba16(i) => Values::U16(i.into_raw()),
        DynamicImage::ImageRgb32F(i) => Values::F32(i.into_raw()),
        DynamicImage::ImageRgba32F(i) => Values::F32(i.into_raw()),
        other => return Err(unsupported_color(field, other.color())),
    };
    Ok(Pixels { width, height, channels, values })
}

fn unsupported_color(field: &str, color: ColorType) -> Error {
    Error::unsupported(
        field,
        format!("pixels of type {color:?} are not read; give 8-bit, 16-bit or 32-bit float channels"),
    )
}

fn exr(field: &str, bytes: &[u8]) -> Result<Pixels> {
    use exr::prelude::*;
    let unreadable = |e: exr::error::Error| {
        crate::domain::Error::invalid(field, format!("the OpenEXR file cannot be decoded ({e})"))
    };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(unreadable)?;
    for header in &meta.headers {
        let stored = header.channels.list.iter().map(|channel| channel.sample_type.bytes_per_sample() as u64).sum();
        let pixel_bytes = (4 * header.channels.list.len().min(4) as u64).max(stored);
        check_size(field, header.layer_size.0 as u32, header.layer_size.1 as u32, pixel_bytes)?;
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(unreadable)?;
    let layer = image.layer_data;
    let named = |name: &str| layer.channel_data.list.iter().find(|c| c.name.eq(name));
    let chosen: Vec<_> = ["R", "G", "B", "A"].iter().map_while(|name| named(name)).collect();
    // Files of one channel call it Y, Z, height, ...: whatever it is called, it is the one.
    let chosen = match (chosen.is_empty(), layer.channel_data.list.as_slice()) {
        (false, _) => chosen,
        (true, [only]) => vec![only],
        (true, all) => named("Y").map(|y| vec![y]).ok_or_else(|| {
            let names: Vec<String> = all.iter().map(|c| c.name.to_string()).collect();
            crate::domain::Error::invalid(field, format!("channels {} hold neither R, G, B nor Y", names.join(", ")))
        })?,
    };
    let (width, height) = (layer.size.0, layer.size.1);
    let mut values = vec![0.0; width * height * chosen.len()];
    for (k, channel) in chosen.iter().enumerate() {
        if channel.sampling != Vec2(1, 1) {
            return Err(crate::domain::Error::unsupported(
                field,
                "subsampled OpenEXR channels are not read; store them at full resolution",
            ));
        }
        for (texel, value) in values.iter_mut().skip(k).step_by(chosen.len()).zip(channel.sample_data.values_as_f32()) {
            *texel = value;
        }
    }
    Ok(Pixels { width: width as u32, height: height as u32, channels: chosen.len(), values: Values::F32(values) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png16(width: u32, height: u32, values: Vec<u16>) -> Vec<u8> {
        let image = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(width, height, values).expect("sizes agree");
        let mut bytes = Vec::new();
        DynamicImage::ImageLuma16(image)
            .write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png)
            .expect("writes");
        bytes
    }

    #[test]
    fn sixteen_bit_values_decode_to_v_over_65535() {
        let pixels = decode("height", &png16(3, 1, vec![0, 32768, 65535])).expect("decodes");
        assert_eq!((pixels.bits(), pixels.channels), (16, 1));
        assert_eq!(pixels.texels([0], |_, v| v), [0.0, 32768.0 / 65535.0, 1.0]);
    }

    #[test]
    fn every_truncation_of_an_image_is_an_error_that_names_the_field() {
        let bytes = png16(9, 7, (0..63).map(|i| i * 1000).collect());
        for length in 0..bytes.len() - 12 {
            let error = decode("details[0].height", &bytes[..length]).expect_err("truncated");
            assert_eq!(error.field.as_deref(), Some("details[0].height"), "{length}");
        }
    }

    #[test]
    fn maps_have_up_to_16384_pixels_each_way_and_2_gib_decoded() {
        assert!(check_size("height", 16_384, 16_384, 4).is_ok() && check_size("height", 16_384, 16_384, 8).is_ok());
        for (width, height, pixel_bytes) in [(0, 5, 1), (16_385, 1, 1), (16_384, 16_384, 12)] {
            let error = check_size("height", width, height, pixel_bytes).expect_err("too large");
            assert!(error.message.contains(&format!("{width} x {height}")), "{}", error.message);
        }
    }
}
