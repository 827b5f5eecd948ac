//! Twin of `texture_bilinear`, and what the other filters are made of: four texels of one level.

use super::{super::mip::Level, covering, mix, places, texel};

/// The level at (u, v), texel i of n at (i + 1/2) / n.
#[must_use]
pub fn bilinear(level: &Level, uv: [f64; 2], wrap: [u32; 2]) -> [f64; 4] {
    let p = places(level, uv);
    let (x, y) = (p[0].floor(), p[1].floor());
    let at = |dx, dy| texel(level, x as i64 + dx, y as i64 + dy, wrap);
    let (tx, ty) = (p[0] - x, p[1] - y);
    covering(level, mix(mix(at(0, 0), at(1, 0), tx), mix(at(0, 1), at(1, 1), tx), ty))
}
