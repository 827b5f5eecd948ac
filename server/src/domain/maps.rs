//! From map files to what passes read: pixels, then maps, then the detail of each material.
//!
//! Height, vector and direction maps are data and never sRGB-decoded; colour maps are.

mod bumps;
mod color;
mod float_tiff;
mod moments;
mod pixels;
mod reliefs;
mod resolve;
mod slopes;
mod thinnest;

pub use bumps::resolve_bumps;
pub use color::{Encoding, color_map, texture_map};
pub use moments::SlopeMaps;
pub use pixels::{Pixels, decode};
pub use reliefs::{marchable, resolve_reliefs};
pub use resolve::{AssetBytes, Details, resolve};

/// Largest width or height of a map.
pub const MAX_MAP_PIXELS: u32 = 16_384;
/// Most texels of a colour map, which is held as four floats a texel.
const MAX_COLOR_TEXELS: u64 = 1 << 26;
/// Most bytes that an image may have once it is decoded: 16384 x 16384 pixels of one float, or of four times 16 bits.
const MAX_DECODED_BYTES: u64 = 2 << 30;
