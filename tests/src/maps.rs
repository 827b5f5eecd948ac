//! Procedural maps: written as real 16-bit PNGs, so that tests read them the way a user's map is read.

use std::io::Cursor;

use image::{ImageBuffer, ImageFormat, Luma};

/// A 16-bit grey PNG of `height(column, row)` in 0..=65535.
#[must_use]
pub fn png16(width: u32, height: u32, value: impl Fn(u32, u32) -> u16) -> Vec<u8> {
    let image = ImageBuffer::from_fn(width, height, |x, y| Luma([value(x, y)]));
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).expect("a PNG can be written to memory");
    bytes.into_inner()
}

/// White noise: the harshest map for seams, since no two neighbouring texels agree.
#[must_use]
pub fn noise16(size: u32, seed: u32) -> Vec<u8> {
    png16(size, size, |x, y| (hash(x, y, seed) >> 16) as u16)
}

/// The same value everywhere.
#[must_use]
pub fn constant16(value: u16) -> Vec<u8> {
    png16(4, 4, |_, _| value)
}

/// A well-mixed 32-bit hash of a texel (the finaliser of MurmurHash3).
#[must_use]
pub fn hash(x: u32, y: u32, seed: u32) -> u32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca6b) ^ seed.wrapping_mul(0xc2b2_ae35);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}
