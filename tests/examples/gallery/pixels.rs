//! Pictures made small: a palette of few colours by median cut (Heckbert 1982), in an indexed PNG.

use std::{collections::BTreeMap, path::Path};

use image::RgbImage;

use crate::Result;

/// The colours of a picture; those of renders are opaque.
pub(crate) fn read(file: &Path) -> Result<RgbImage> {
    let picture = image::open(file).map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(picture.to_rgb8())
}

/// A PNG of all of the picture's colours, or, where that is large, of 256.
pub(crate) fn colored(picture: &RgbImage) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(picture.as_raw())?;
    if bytes.len() > 50_000 { indexed(picture, 256) } else { Ok(bytes) }
}

/// A PNG of at most so many colours, 256 or fewer, none of them dithered.
pub(crate) fn indexed(picture: &RgbImage, most: usize) -> Result<Vec<u8>> {
    let palette = Palette::of(picture, most);
    let indices: Vec<u8> = picture.pixels().map(|pixel| palette.index_of[&pixel.0]).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.colors.concat());
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.write_header()?.write_image_data(&indices)?;
    Ok(bytes)
}

/// Colours, and which of them stands for each of the picture's.
struct Palette {
    colors: Vec<[u8; 3]>,
    index_of: BTreeMap<[u8; 3], u8>,
}

/// A colour of the picture, and how many pixels have it.
type Counted = ([u8; 3], u64);

impl Palette {
    fn of(picture: &RgbImage, most: usize) -> Self {
        let mut counts = BTreeMap::new();
        for pixel in picture.pixels() {
            *counts.entry(pixel.0).or_insert(0u64) += 1;
        }
        let mut boxes: Vec<Vec<Counted>> = vec![counts.into_iter().collect()];
        while boxes.len() < most {
            let spreads = boxes.iter().map(|colors| spread(colors).1);
            let widest = spreads.enumerate().max_by_key(|&(at, spread)| (spread, std::cmp::Reverse(at)));
            let Some((at, 1..)) = widest else { break };
            let upper = split(&mut boxes[at]);
            boxes.push(upper);
        }
        let colors = boxes.iter().map(|colors| mean(colors)).collect();
        let of_box =
            |(at, colors): (usize, &Vec<Counted>)| colors.iter().map(move |c| (c.0, at as u8)).collect::<Vec<_>>();
        Self { colors, index_of: boxes.iter().enumerate().flat_map(of_box).collect() }
    }
}

/// The channel in which colours differ most, and by how much, with the root of their number as weight.
fn spread(colors: &[Counted]) -> (usize, u64) {
    let range = |k: usize| {
        let values = colors.iter().map(|c| c.0[k]);
        u64::from(values.clone().max().unwrap_or(0) - values.min().unwrap_or(0))
    };
    let channel = (0..3).max_by_key(|&k| range(k)).unwrap_or(0);
    let pixels: u64 = colors.iter().map(|c| c.1).sum();
    (channel, range(channel) * range(channel) * pixels.isqrt())
}

/// Cuts a box where half of its pixels lie on either side, and returns the upper part.
fn split(colors: &mut Vec<Counted>) -> Vec<Counted> {
    let channel = spread(colors).0;
    colors.sort_by_key(|c| (c.0[channel], c.0));
    let half = colors.iter().map(|c| c.1).sum::<u64>() / 2;
    let mut below = 0;
    let cut = colors
        .iter()
        .take_while(|c| {
            below += c.1;
            below <= half
        })
        .count();
    colors.split_off(cut.clamp(1, colors.len() - 1))
}

fn mean(colors: &[Counted]) -> [u8; 3] {
    let pixels: u64 = colors.iter().map(|c| c.1).sum();
    [0, 1, 2]
        .map(|k| ((colors.iter().map(|c| u64::from(c.0[k]) * c.1).sum::<u64>() + pixels / 2) / pixels.max(1)) as u8)
}
