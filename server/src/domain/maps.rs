//! From map files to what passes read: pixels, then maps, then the detail of each material.
//!
//! Height, vector and direction maps are data and never sRGB-decoded; colour maps are.

mod color;
mod float_tiff;
mod pixels;
mod resolve;

pub use color::color_map;
pub use pixels::{Pixels, decode};
pub use resolve::{AssetBytes, Details, resolve};

/// Largest width or height of a map.
pub const MAX_MAP_PIXELS: u32 = 16_384;
/// Most texels of a map: one stream of 16 pages of 2^22 f32 holds them.
pub const MAX_MAP_TEXELS: u64 = 1 << 26;
