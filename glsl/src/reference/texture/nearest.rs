//! Twin of `texture_nearest`: the texel of the finest level under the middle of the pixel.

use super::{super::mip::Level, covering, places, texel};

#[must_use]
pub fn nearest(level: &Level, uv: [f64; 2], wrap: [u32; 2]) -> [f64; 4] {
    let [x, y] = places(level, uv).map(|p| (p + 0.5).floor() as i64);
    covering(level, texel(level, x, y, wrap))
}
