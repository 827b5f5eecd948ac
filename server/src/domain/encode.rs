//! Images to bytes: PNG in 8-bit sRGB with an extra file for each further output, or one EXR that holds all.

mod ordered;

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec, Text,
    WritableImage,
};
use png::{BitDepth, ColorType, SrgbRenderingIntent};

use super::{
    Error, Result,
    image::{ImageSet, ImageSettings, LightShape, RenderLight},
    request::{ImageFormat, Shadows},
};

/// OpenEXR attribute (m44f) that holds the camera: 16 floats, the columns of the matrix that takes world space to
/// clip space one after the other. OpenEXR's own programs, which write vectors as rows, read it as it is meant.
pub const CLIP_FROM_WORLD: &str = "displace.clip_from_world";

/// The three parts of the cost of a pixel.
const COSTS: [&str; 3] = ["fetches", "steps", "capped"];

/// One file of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedImage {
    /// `color` for the picture itself, otherwise the name of the output: `depth`, `normal`, ...
    pub name: &'static str,
    pub media_type: &'static str,
    pub bytes: Vec<u8>,
}

/// The files of a render; the picture comes first.
pub fn encode(images: &ImageSet, format: ImageFormat) -> Result<Vec<EncodedImage>> {
    encode_with(images, format, None)
}

/// As `encode`; an EXR also says how the image was taken, in attributes `displace.*`.
pub fn encode_with(
    images: &ImageSet,
    format: ImageFormat,
    settings: Option<&ImageSettings>,
) -> Result<Vec<EncodedImage>> {
    match format {
        ImageFormat::Png => encode_png(images),
        ImageFormat::Exr => {
            let bytes = encode_exr(images, settings.map(settings_attributes).unwrap_or_default())?;
            Ok(vec![EncodedImage { name: "color", media_type: "image/x-exr", bytes }])
        }
    }
}

fn settings_attributes(settings: &ImageSettings) -> Vec<(&'static str, AttributeValue)> {
    // The format's texts are of Latin-1.
    let latin = |text: &str| text.chars().map(|c| if u32::from(c) < 256 { c } else { '?' }).collect::<String>();
    let text = |text: &str| AttributeValue::Text(Text::from(latin(text).as_str()));
    let vector = |[x, y, z]: [f32; 3]| AttributeValue::FloatVec3((x, y, z));
    let shadows = match settings.shadows {
        Shadows::None => "none",
        Shadows::Ray => "ray",
        Shadows::Map => "map",
    };
    let mut attributes = vec![
        ("displace.samples", AttributeValue::I32(settings.samples as i32)),
        ("displace.filter", text("box")),
        ("displace.shadows", text(shadows)),
        ("displace.lights", AttributeValue::I32(settings.lighting.lights.len() as i32)),
        ("displace.ambient", AttributeValue::F32(settings.lighting.ambient)),
        ("displace.background", vector(settings.lighting.background)),
        ("displace.device", text(&settings.device)),
        ("displace.build", text(&settings.build)),
        ("displace.residual_world", AttributeValue::F64(settings.residual_world)),
    ];
    if let [RenderLight { shape: LightShape::Sun { direction_world }, color, .. }] = settings.lighting.lights[..] {
        attributes.push(("displace.light_direction", vector(direction_world)));
        attributes.push(("displace.light_color", vector(color)));
    }
    attributes
}

/// Linear light to the sRGB curve (IEC 61966-2-1), 8 bits.
#[must_use]
pub fn srgb_from_linear(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    // A NaN becomes 0.
    (encoded * 255.0 + 0.5) as u8
}

/// A picture of interleaved 8-bit sRGB, as PNG.
pub fn encode_rgb8(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    Png { width, height }.write(ColorType::Rgb, BitDepth::Eight, true, &[], rgb)
}

/// A picture of interleaved 8-bit sRGB and alpha, as PNG.
pub fn encode_rgba8(width: u32, height: u32, rgba: &[u8]) -> Result<Vec<u8>> {
    Png { width, height }.write(ColorType::Rgba, BitDepth::Eight, true, &[], rgba)
}

/// An image of interleaved 8-bit RGB that is not colour, as PNG.
pub fn encode_linear_rgb8(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    Png { width, height }.write(ColorType::Rgb, BitDepth::Eight, false, &[], rgb)
}

/// An image of interleaved 16-bit RGB that is not colour, as PNG.
pub fn encode_linear_rgb16(width: u32, height: u32, rgb: &[u16]) -> Result<Vec<u8>> {
    let bytes: Vec<u8> = rgb.iter().flat_map(|value| value.to_be_bytes()).collect();
    Png { width, height }.write(ColorType::Rgb, BitDepth::Sixteen, false, &[], &bytes)
}

fn encode_png(images: &ImageSet) -> Result<Vec<EncodedImage>> {
    let png = Png { width: images.width, height: images.height };
    let mut files = vec![("color", png.color(&images.color)?)];
    if let Some(depth) = &images.depth {
        files.push(("depth", png.depth(depth)?));
    }
    if let Some(normal) = &images.normal {
        files.push(("normal", png.normal(normal)?));
    }
    if let Some(position) = &images.position {
        files.push(("position", png.position(position, images.depth.as_deref(), images.triangle.as_deref())?));
    }
    if let Some(uv) = &images.uv {
        files.push(("uv", png.uv(uv)?));
    }
    if let Some(triangle) = &images.triangle {
        files.push(("triangle", png.triangle(triangle)?));
    }
    for (name, counts) in [("overdraw", &images.overdraw), ("samples", &images.samples)] {
        if let Some(counts) = counts {
            files.push((name, png.counts(name, counts)?));
        }
    }
    if let Some(cost) = &images.cost {
        files.push(("cost", png.cost(cost)?));
    }
    Ok(files.into_iter().map(|(name, bytes)| EncodedImage { name, media_type: "image/png", bytes }).collect())
}

struct Png {
    width: u32,
    height: u32,
}

impl Png {
    fn color(&self, color: &[[f32; 4]]) -> Result<Vec<u8>> {
        let alpha = |a: f32| (a.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let texels = color
            .iter()
            .flat_map(|c| [srgb_from_linear(c[0]), srgb_from_linear(c[1]), srgb_from_linear(c[2]), alpha(c[3])]);
        self.write(ColorType::Rgba, BitDepth::Eight, true, &[], &texels.collect::<Vec<_>>())
    }

    /// 16-bit grey: 65535 is nearest, 1 farthest, 0 nothing. The range is in the file's text.
    fn depth(&self, depth: &[f32]) -> Result<Vec<u8>> {
        let (near, far) = range(depth.iter().copied());
        let scale = if far > near { 65534.0 / (far - near) } else { 0.0 };
        let grey = |d: f32| if d.is_finite() { 1 + ((far - d) * scale + 0.5) as u16 } else { 0 };
        let bytes: Vec<u8> = depth.iter().flat_map(|&d| grey(d).to_be_bytes()).collect();
        let text = [("depth_nearest", near.to_string()), ("depth_farthest", far.to_string())];
        self.write(ColorType::Grayscale, BitDepth::Sixteen, false, &text, &bytes)
    }

    /// n / 2 + 1/2; black where nothing is.
    fn normal(&self, normal: &[[f32; 3]]) -> Result<Vec<u8>> {
        let byte = |n: f32| ((n * 0.5 + 0.5).clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let texel = |n: &[f32; 3]| if *n == [0.0; 3] { [0; 3] } else { n.map(byte) };
        self.rgb8(normal.iter().map(texel))
    }

    /// 16-bit per axis within the box of what is seen, which is in the file's text.
    fn position(&self, position: &[[f32; 3]], depth: Option<&[f32]>, triangle: Option<&[u32]>) -> Result<Vec<u8>> {
        let seen = |i: usize| match (triangle, depth) {
            (Some(triangle), _) => triangle[i] != u32::MAX,
            (None, Some(depth)) => depth[i].is_finite(),
            (None, None) => position[i] != [0.0; 3],
        };
        let axis = |k: usize| range(position.iter().enumerate().filter(|(i, _)| seen(*i)).map(|(_, p)| p[k]));
        let ranges = [axis(0), axis(1), axis(2)];
        let word = |p: &[f32; 3], k: usize| {
            let (low, high) = ranges[k];
            let scale = if high > low { 65535.0 / (high - low) } else { 0.0 };
            ((p[k] - low) * scale + 0.5) as u16
        };
        let texel = |(i, p): (usize, &[f32; 3])| if seen(i) { [0, 1, 2].map(|k| word(p, k)) } else { [0; 3] };
        let bytes: Vec<u8> = position.iter().enumerate().flat_map(texel).flat_map(u16::to_be_bytes).collect();
        let text = [
            ("position_low", format!("{:?}", ranges.map(|r| r.0))),
            ("position_high", format!("{:?}", ranges.map(|r| r.1))),
        ];
        self.write(ColorType::Rgb, BitDepth::Sixteen, false, &text, &bytes)
    }

    /// The place within the tile, so that repeated maps show.
    fn uv(&self, uv: &[[f32; 2]]) -> Result<Vec<u8>> {
        let byte = |x: f32| if (0.0..=1.0).contains(&x) { x } else { x - x.floor() };
        self.rgb8(uv.iter().map(|t| [(byte(t[0]) * 255.0 + 0.5) as u8, (byte(t[1]) * 255.0 + 0.5) as u8, 0]))
    }

    /// A colour per triangle.
    fn triangle(&self, triangle: &[u32]) -> Result<Vec<u8>> {
        self.rgb8(triangle.iter().map(|&id| if id == u32::MAX { [0; 3] } else { hashed_color(id) }))
    }

    /// Grey: white is the most, at least 4, which is in the file's text.
    fn counts(&self, name: &str, counts: &[u32]) -> Result<Vec<u8>> {
        let most = counts.iter().copied().fold(4, u32::max);
        let grey = |count: &u32| ((u64::from(*count) * 510 + u64::from(most)) / (2 * u64::from(most))) as u8;
        let text = [(format!("{name}_most"), most.to_string())];
        let text: Vec<(&str, String)> = text.iter().map(|(key, value)| (key.as_str(), value.clone())).collect();
        self.write(ColorType::Grayscale, BitDepth::Eight, false, &text, &counts.iter().map(grey).collect::<Vec<_>>())
    }

    /// Each of red (fetches), green (steps) and blue (cap hits) as bright as its share of its most, which is in the file's
    /// text.
    fn cost(&self, cost: &[[f32; 3]]) -> Result<Vec<u8>> {
        let most = [0, 1, 2].map(|k| cost.iter().map(|c| c[k]).fold(1.0, f32::max));
        let bytes: Vec<u8> =
            cost.iter().flat_map(|c| [0, 1, 2].map(|k| (c[k] / most[k] * 255.0 + 0.5) as u8)).collect();
        let text: Vec<(String, String)> =
            COSTS.iter().zip(most).map(|(name, most)| (format!("cost_{name}_most"), most.to_string())).collect();
        let text: Vec<(&str, String)> = text.iter().map(|(key, value)| (key.as_str(), value.clone())).collect();
        self.write(ColorType::Rgb, BitDepth::Eight, false, &text, &bytes)
    }

    fn rgb8(&self, texels: impl Iterator<Item = [u8; 3]>) -> Result<Vec<u8>> {
        self.write(ColorType::Rgb, BitDepth::Eight, false, &[], &texels.flatten().collect::<Vec<_>>())
    }

    fn write(
        &self,
        color: ColorType,
        depth: BitDepth,
        srgb: bool,
        text: &[(&str, String)],
        data: &[u8],
    ) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.set_compression(png::Compression::Fast);
        if srgb {
            encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        }
        for (key, value) in text {
            encoder.add_text_chunk((*key).into(), value.clone()).map_err(png_failed)?;
        }
        encoder.write_header().and_then(|mut writer| writer.write_image_data(data)).map_err(png_failed)?;
        Ok(bytes)
    }
}

fn png_failed(error: png::EncodingError) -> Error {
    Error::internal("the image could not be written as PNG").with_cause(error)
}

/// Smallest and largest of the finite values; (0, 0) of none.
fn range(values: impl Iterator<Item = f32>) -> (f32, f32) {
    let finite = values.filter(|v| v.is_finite());
    let (low, high) = finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// Far apart for neighbouring ids, never black.
fn hashed_color(id: u32) -> [u8; 3] {
    let mut hash = id.wrapping_mul(0x9E37_79B1) ^ 0x85EB_CA6B;
    hash ^= hash >> 15;
    hash = hash.wrapping_mul(0x2C1B_3C6D);
    hash ^= hash >> 13;
    [hash, hash >> 8, hash >> 16].map(|h| 48 + (h & 0xFF) as u8 % 208)
}

/// Channels R, G, B, A, Z, normal.X to normal.Z, position.X to position.Z, uv.U, uv.V, cost.fetches, cost.steps, cost.capped
/// (f32), triangle.id, overdraw.count, samples.count (u32).
fn encode_exr(images: &ImageSet, settings: Vec<(&str, AttributeValue)>) -> Result<Vec<u8>> {
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = SmallVec::new();
    let mut float = |name: &str, values: Vec<f32>| channels.push(AnyChannel::new(name, FlatSamples::F32(values)));
    for (k, name) in ["R", "G", "B", "A"].iter().enumerate() {
        float(name, images.color.iter().map(|c| c[k]).collect());
    }
    if let Some(depth) = &images.depth {
        float("Z", depth.clone());
    }
    for (layer, values) in [("normal", &images.normal), ("position", &images.position)] {
        for (k, axis) in ["X", "Y", "Z"].iter().enumerate() {
            if let Some(values) = values {
                float(&format!("{layer}.{axis}"), values.iter().map(|v| v[k]).collect());
            }
        }
    }
    if let Some(uv) = &images.uv {
        float("uv.U", uv.iter().map(|t| t[0]).collect());
        float("uv.V", uv.iter().map(|t| t[1]).collect());
    }
    for (k, name) in COSTS.iter().enumerate() {
        if let Some(cost) = &images.cost {
            float(&format!("cost.{name}"), cost.iter().map(|c| c[k]).collect());
        }
    }
    if let Some(triangle) = &images.triangle {
        channels.push(AnyChannel::new("triangle.id", FlatSamples::U32(triangle.clone())));
    }
    for (name, counts) in [("overdraw.count", &images.overdraw), ("samples.count", &images.samples)] {
        if let Some(counts) = counts {
            channels.push(AnyChannel::new(name, FlatSamples::U32(counts.clone())));
        }
    }
    let mut attributes = LayerAttributes::named("displace");
    attributes.software_name = Some(Text::from("displace"));
    if let Some(matrix) = images.clip_from_world {
        attributes.other.insert(Text::from(CLIP_FROM_WORLD), AttributeValue::Matrix4x4(matrix));
    }
    attributes.other.extend(settings.into_iter().map(|(name, value)| (Text::from(name), value)));
    let size = (images.width as usize, images.height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    let written = Image::from_layer(layer).write().to_buffered(&mut bytes);
    written.map_err(|error| Error::internal("the image could not be written as EXR").with_cause(error))?;
    let mut bytes = bytes.into_inner();
    ordered::by_name(&mut bytes);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_pixels() -> ImageSet {
        ImageSet {
            width: 2,
            height: 1,
            color: vec![[0.5, 0.0, 1.0, 1.0], [0.0, 0.002, 2.0, 1.0]],
            depth: Some(vec![1.5, f32::INFINITY]),
            normal: Some(vec![[0.0, 0.0, 1.0], [0.0; 3]]),
            position: Some(vec![[1.0, 2.0, 3.0], [0.0; 3]]),
            uv: Some(vec![[0.25, 1.75], [0.0, 0.0]]),
            triangle: Some(vec![7, u32::MAX]),
            overdraw: Some(vec![8, 0]),
            samples: Some(vec![2, 0]),
            cost: Some(vec![[30.0, 10.0, 0.0], [15.0, 0.0, 0.0]]),
            counters: None,
            clip_from_world: Some(std::array::from_fn(|k| k as f32)),
            layers_left_out: false,
        }
    }

    fn decode(bytes: &[u8]) -> (png::OutputInfo, Vec<u8>) {
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        data.truncate(info.buffer_size());
        (info, data)
    }

    #[test]
    fn the_picture_is_srgb_and_says_so() {
        let files = encode(&two_pixels(), ImageFormat::Png).unwrap();
        assert!(files[0].bytes.windows(4).any(|w| w == b"sRGB"));
        let (_, data) = decode(&files[0].bytes);
        assert_eq!(data, [188, 0, 255, 255, 0, 7, 255, 255]);
    }

    #[test]
    fn each_further_output_is_a_file_of_its_own() {
        let files = encode(&two_pixels(), ImageFormat::Png).unwrap();
        let names: Vec<_> = files.iter().map(|f| f.name).collect();
        assert_eq!(names, ["color", "depth", "normal", "position", "uv", "triangle", "overdraw", "samples", "cost"]);
        assert_eq!(decode(&files[1].bytes).1, [0, 1, 0, 0]);
        assert_eq!(decode(&files[2].bytes).1, [128, 128, 255, 0, 0, 0]);
        assert_eq!(decode(&files[4].bytes).1[..2], [64, 191]);
        assert_eq!(decode(&files[6].bytes).1, [255, 0]);
        assert_eq!(decode(&files[7].bytes).1, [128, 0]);
        assert_eq!(decode(&files[8].bytes).1, [255, 255, 0, 128, 0, 0]);
    }

    #[test]
    fn an_exr_holds_every_output_bit_for_bit() {
        use exr::prelude::{ReadChannels, ReadLayers, read};
        let images = two_pixels();
        let files = encode(&images, ImageFormat::Exr).unwrap();
        let read = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let image = read.from_buffered(Cursor::new(&files[0].bytes)).unwrap();
        let channels = &image.layer_data[0].channel_data.list;
        let channel = |name: &str| &channels.iter().find(|c| c.name == *name).unwrap().sample_data;
        assert_eq!(*channel("triangle.id"), FlatSamples::U32(vec![7, u32::MAX]));
        assert_eq!(*channel("Z"), FlatSamples::F32(vec![1.5, f32::INFINITY]));
        assert_eq!(*channel("B"), FlatSamples::F32(vec![1.0, 2.0]));
        assert_eq!(*channel("overdraw.count"), FlatSamples::U32(vec![8, 0]));
        assert_eq!(*channel("cost.steps"), FlatSamples::F32(vec![10.0, 0.0]));
        assert_eq!(channels.len(), 19);
        let matrix = image.layer_data[0].attributes.other.get(&Text::from(CLIP_FROM_WORLD));
        assert_eq!(matrix, Some(&AttributeValue::Matrix4x4(std::array::from_fn(|k| k as f32))));
    }

    #[test]
    fn an_exr_says_how_the_image_was_taken() {
        let settings = ImageSettings {
            samples: 256,
            shadows: Shadows::Ray,
            lighting: crate::domain::image::Lighting::default(),
            device: "Δ é".into(),
            build: "1+2".into(),
            residual_world: 1.5e-9,
        };
        let bytes = &encode_with(&two_pixels(), ImageFormat::Exr, Some(&settings)).unwrap()[0].bytes;
        let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), true).unwrap();
        let attribute = |name: &str| meta.headers[0].own_attributes.other.get(&Text::from(name)).cloned();
        assert_eq!(attribute("displace.samples"), Some(AttributeValue::I32(256)));
        assert_eq!(attribute("displace.shadows"), Some(AttributeValue::Text(Text::from("ray"))));
        assert_eq!(attribute("displace.device"), Some(AttributeValue::Text(Text::from("? é"))));
        assert_eq!(attribute("displace.residual_world"), Some(AttributeValue::F64(1.5e-9)));
        assert_eq!(attribute("displace.background"), Some(AttributeValue::FloatVec3((0.05, 0.05, 0.05))));
    }

    #[test]
    fn the_srgb_curve_passes_through_known_points() {
        assert_eq!([0.0, 0.215_861, 1.0, 9.0, f32::NAN].map(srgb_from_linear), [0, 128, 255, 255, 0]);
    }
}
