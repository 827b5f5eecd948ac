//! An image as the metrics see it, read from PNG or OpenEXR by the image libraries alone.

use std::io::Cursor;

use exr::prelude::{AnyChannels, AttributeValue, FlatSamples, Layer, MetaData, ReadChannels, ReadLayers, Text, Vec2};
use image::{DynamicImage, ImageDecoder, codecs::png::PngDecoder};
use rayon::prelude::*;

use super::light::linear_from_encoded;
use crate::domain::{Error, Result, encode::CLIP_FROM_WORLD, image::ImageSet};

/// An image, row-major from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    /// Linear light, finite.
    pub linear: Vec<[f32; 3]>,
    /// Whether a surface is seen.
    pub covered: Option<Vec<bool>>,
    /// Places seen, world units; finite where covered.
    pub positions: Option<Vec<[f32; 3]>>,
    /// Of the camera, column-major.
    pub clip_from_world: Option<[f32; 16]>,
}

/// What an image may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest width and height.
    pub max_side: u32,
    /// Most bytes of what is decoded, and of what comparing takes.
    pub max_bytes: u64,
}

/// Bytes of a pixel of one image while two are compared: light and luma of each, positions, FLIP's own images.
const BYTES_PER_PIXEL: u64 = 128;
const FORMATS: &str = "give PNG or OpenEXR, as `render` writes them";

/// Decodes an image. PNG is taken as sRGB with 8 or 16 bits, its alpha left out. Of OpenEXR the first flat layer
/// counts: R, G and B, or Y alone, linear; what is covered by `Z` (finite) or `triangle.id` (not the largest);
/// `position.X`, `.Y` and `.Z`; the matrix of the camera.
///
/// # Errors
/// Not an image of these kinds, damaged, larger than the limits, or with a colour or a covered place that is not
/// finite. Every error names `field`.
pub fn read(field: &str, bytes: &[u8], limits: Limits) -> Result<Picture> {
    let picture = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png(field, bytes, limits)?,
        [0x76, 0x2f, 0x31, 0x01, ..] => exr(field, bytes, limits)?,
        [] => return Err(Error::invalid(field, format!("the file is empty; {FORMATS}"))),
        _ => return Err(Error::invalid(field, format!("the file is neither PNG nor OpenEXR; {FORMATS}"))),
    };
    picture.refuse_infinite(field)?;
    Ok(picture)
}

impl Limits {
    /// `pixel_bytes`: of a decoded pixel.
    fn check(self, field: &str, width: u64, height: u64, pixel_bytes: u64) -> Result<()> {
        let most = u64::from(self.max_side);
        let size = format!("the image has {width} x {height} pixels");
        if width.min(height) == 0 || width.max(height) > most {
            let message = format!("{size}; allowed are 1 to {most} each way: scale it");
            return Err(Error::too_large(field, message));
        }
        let needed = width.saturating_mul(height).saturating_mul(BYTES_PER_PIXEL + pixel_bytes);
        if needed > self.max_bytes {
            let message =
                format!("{size} and takes {needed} bytes; this server gives a job {}: scale it down", self.max_bytes);
            return Err(Error::too_large(field, message));
        }
        Ok(())
    }
}

impl Picture {
    /// An image as `read` gives it of the file that it would be written to.
    ///
    /// # Errors
    /// A colour or a covered place is not finite; the error names `field`.
    pub fn of_images(field: &str, images: &ImageSet) -> Result<Self> {
        let covered = images.depth.as_ref().map(|depth| depth.iter().map(|d| d.is_finite()).collect());
        let picture = Self {
            width: images.width,
            height: images.height,
            linear: images.color.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect(),
            covered,
            positions: images.position.clone(),
            clip_from_world: images.clip_from_world,
        };
        picture.refuse_infinite(field)?;
        Ok(picture)
    }

    fn refuse_infinite(&self, field: &str) -> Result<()> {
        let finite = |v: &[f32; 3]| v.iter().all(|x| x.is_finite());
        if let Some(at) = self.linear.par_iter().position_first(|light| !finite(light)) {
            return Err(self.infinite(field, at, "colour", self.linear[at]));
        }
        let (Some(positions), Some(covered)) = (&self.positions, &self.covered) else { return Ok(()) };
        let hit = positions.par_iter().zip(covered).position_first(|(place, covered)| *covered && !finite(place));
        hit.map_or(Ok(()), |at| Err(self.infinite(field, at, "position", positions[at])))
    }

    fn infinite(&self, field: &str, at: usize, what: &str, value: [f32; 3]) -> Error {
        let (x, y) = (at % self.width as usize, at / self.width as usize);
        Error::invalid(field, format!("the {what} of pixel ({x}, {y}) is {value:?}; values must be finite"))
    }
}

fn png(field: &str, bytes: &[u8], limits: Limits) -> Result<Picture> {
    let unreadable = |e: image::ImageError| Error::invalid(field, format!("the PNG file cannot be decoded ({e})"));
    let mut library = image::Limits::default();
    library.max_alloc = Some(limits.max_bytes);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), library).map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    limits.check(field, width.into(), height.into(), decoder.color_type().bytes_per_pixel().into())?;
    let image = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
    let linear = |v: f64| linear_from_encoded(v) as f32;
    let linear = if image.color().bytes_per_pixel() / image.color().channel_count() > 1 {
        texels(&image.into_rgb16(), |v| linear(f64::from(v) / 65535.0))
    } else {
        let table: Vec<f32> = (0..=255u8).map(|v| linear(f64::from(v) / 255.0)).collect();
        texels(&image.into_rgb8(), |v: u8| table[usize::from(v)])
    };
    Ok(Picture { width, height, linear, ..Picture::default() })
}

fn texels<T: Copy + Sync>(values: &[T], linear: impl Fn(T) -> f32 + Sync) -> Vec<[f32; 3]> {
    values.par_chunks_exact(3).map(|v| [linear(v[0]), linear(v[1]), linear(v[2])]).collect()
}

fn exr(field: &str, bytes: &[u8], limits: Limits) -> Result<Picture> {
    let unreadable = |e: exr::error::Error| Error::invalid(field, format!("the OpenEXR file cannot be decoded ({e})"));
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(unreadable)?;
    for header in &meta.headers {
        let Vec2(width, height) = header.layer_size;
        limits.check(field, width as u64, height as u64, header.channels.bytes_per_pixel as u64)?;
    }
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_buffered(Cursor::new(bytes)).map_err(unreadable)?;
    let layer = File { field, layer: &image.layer_data };
    Ok(Picture {
        width: image.layer_data.size.0 as u32,
        height: image.layer_data.size.1 as u32,
        linear: layer.colors()?,
        covered: layer.covered()?,
        positions: layer.vectors(["position.X", "position.Y", "position.Z"])?,
        clip_from_world: layer.clip_from_world(),
    })
}

struct File<'a> {
    field: &'a str,
    layer: &'a Layer<AnyChannels<FlatSamples>>,
}

impl File<'_> {
    fn samples(&self, name: &str) -> Result<Option<&FlatSamples>> {
        let channel = self.layer.channel_data.list.iter().find(|channel| channel.name.eq(name));
        match channel {
            Some(channel) if channel.sampling != Vec2(1, 1) => {
                let message = format!("channel {name} is subsampled; store it at full resolution");
                Err(Error::unsupported(self.field, message))
            }
            channel => Ok(channel.map(|channel| &channel.sample_data)),
        }
    }

    fn colors(&self) -> Result<Vec<[f32; 3]>> {
        let colors = match self.vectors(["R", "G", "B"])? {
            Some(colors) => Some(colors),
            None => self.vectors(["Y", "Y", "Y"])?,
        };
        colors.ok_or_else(|| {
            let names: Vec<String> = self.layer.channel_data.list.iter().map(|c| c.name.to_string()).collect();
            let message = format!("channels {} hold neither R, G and B nor Y; {FORMATS}", names.join(", "));
            Error::invalid(self.field, message)
        })
    }

    fn covered(&self) -> Result<Option<Vec<bool>>> {
        if let Some(FlatSamples::U32(ids)) = self.samples("triangle.id")? {
            return Ok(Some(ids.iter().map(|id| *id != u32::MAX).collect()));
        }
        let depths = self.samples("Z")?;
        Ok(depths.map(|depths| depths.values_as_f32().map(f32::is_finite).collect()))
    }

    fn vectors(&self, names: [&str; 3]) -> Result<Option<Vec<[f32; 3]>>> {
        let mut vectors = vec![[0.0; 3]; self.layer.size.area()];
        for (k, name) in names.iter().enumerate() {
            let Some(samples) = self.samples(name)? else { return Ok(None) };
            vectors.iter_mut().zip(samples.values_as_f32()).for_each(|(vector, value)| vector[k] = value);
        }
        Ok(Some(vectors))
    }

    fn clip_from_world(&self) -> Option<[f32; 16]> {
        match self.layer.attributes.other.get(&Text::from(CLIP_FROM_WORLD)) {
            Some(AttributeValue::Matrix4x4(matrix)) => Some(*matrix),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{
        ErrorKind,
        encode::encode,
        image::ImageSet,
        request::ImageFormat::{Exr, Png},
    };

    const LIMITS: Limits = Limits { max_side: 64, max_bytes: 1 << 20 };

    fn rendered() -> ImageSet {
        ImageSet {
            width: 3,
            height: 1,
            color: vec![[0.5, 0.0, 4.0, 1.0], [0.25, 1.0, 0.125, 1.0], [0.0, 0.0, 0.0, 0.0]],
            depth: Some(vec![1.0, 2.0, f32::INFINITY]),
            position: Some(vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [f32::NAN; 3]]),
            clip_from_world: Some(std::array::from_fn(|k| k as f32)),
            layers_left_out: false,
            ..ImageSet::default()
        }
    }

    fn file(images: &ImageSet, format: crate::domain::request::ImageFormat) -> Vec<u8> {
        encode(images, format).unwrap().swap_remove(0).bytes
    }

    fn png16() -> Vec<u8> {
        let mut bytes = Vec::new();
        let image = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 1, vec![0u16, 32768]).unwrap();
        let image = DynamicImage::ImageLuma16(image);
        image.write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
        bytes
    }

    #[test]
    fn an_exr_is_read_as_it_was_written() {
        let images = rendered();
        let picture = read("a", &file(&images, Exr), LIMITS).unwrap();
        assert_eq!((picture.width, picture.height), (3, 1));
        assert_eq!(picture.linear, [[0.5, 0.0, 4.0], [0.25, 1.0, 0.125], [0.0; 3]]);
        assert_eq!(picture.covered, Some(vec![true, true, false]));
        assert_eq!(picture.positions.as_ref().unwrap()[1], [4.0, 5.0, 6.0]);
        assert_eq!(picture.clip_from_world, images.clip_from_world);
        let direct = Picture::of_images("a", &images).unwrap();
        assert_eq!(direct.positions.as_ref().unwrap()[..2], picture.positions.as_ref().unwrap()[..2]);
        assert_eq!((direct.linear, direct.covered), (picture.linear, picture.covered));
    }

    #[test]
    fn triangle_ids_tell_coverage_as_well() {
        let images = ImageSet { depth: None, triangle: Some(vec![u32::MAX, 0, 7]), ..rendered() };
        let covered = read("a", &file(&ImageSet { position: None, ..images }, Exr), LIMITS).unwrap().covered;
        assert_eq!(covered, Some(vec![false, true, true]));
    }

    #[test]
    fn a_png_is_srgb_of_8_or_16_bits_and_nothing_else_is_known() {
        let picture = read("a", &file(&rendered(), Png), LIMITS).unwrap();
        assert!((picture.linear[0][0] - 0.5).abs() < 4e-3 && picture.linear[0][2] == 1.0, "{:?}", picture.linear);
        assert_eq!((picture.covered, picture.positions, picture.clip_from_world), (None, None, None));
        let grey = read("a", &png16(), LIMITS).unwrap().linear;
        let half = linear_from_encoded(32768.0 / 65535.0) as f32;
        assert_eq!(grey, [[0.0; 3], [half; 3]]);
    }

    #[test]
    fn what_is_no_image_or_a_piece_of_one_is_refused_by_name() {
        for format in [Png, Exr] {
            let bytes = file(&rendered(), format);
            for length in 0..bytes.len() - 12 {
                let error = read("b", &bytes[..length], LIMITS).expect_err("truncated");
                assert_eq!((error.kind, error.field.as_deref()), (ErrorKind::InvalidInput, Some("b")), "{length}");
            }
        }
        for other in [&b"GIF89a"[..], b"glTF", &[0xff, 0xd8, 0xff, 0xe0]] {
            assert!(read("a", other, LIMITS).unwrap_err().message.contains("neither PNG nor OpenEXR"));
        }
    }

    #[test]
    fn colours_and_covered_places_are_finite() {
        for value in [f32::NAN, f32::INFINITY] {
            let mut images = rendered();
            images.color[1][2] = value;
            let error = read("a", &file(&images, Exr), LIMITS).unwrap_err();
            assert!(error.message.contains("colour of pixel (1, 0)"), "{error}");
            let mut images = rendered();
            images.position.as_mut().unwrap()[0][1] = value;
            let error = read("b", &file(&images, Exr), LIMITS).unwrap_err();
            assert!(error.message.contains("position of pixel (0, 0)"), "{error}");
        }
    }

    #[test]
    fn an_image_above_a_limit_is_refused_before_it_is_decoded() {
        for format in [Png, Exr] {
            let bytes = file(&rendered(), format);
            for limits in [Limits { max_side: 2, ..LIMITS }, Limits { max_bytes: 3 * BYTES_PER_PIXEL, ..LIMITS }] {
                let error = read("a", &bytes, limits).unwrap_err();
                assert_eq!((error.kind, error.field.as_deref()), (ErrorKind::TooLarge, Some("a")));
                assert!(error.message.contains("3 x 1 pixels"), "{}", error.message);
            }
        }
    }
}
