//! How large the maps of what lights see are.

use displace_glsl::layout::shadow::SHADOW_FACES;

use super::{LightShape, RenderLight};

/// Texels each way of a map of what looks one way: a sun, or a spot of up to 60 degrees from its axis.
pub const WIDE_PX: u32 = 1024;
/// Of each of six sides.
pub const SIDE_PX: u32 = 512;
/// Cosine of the angle up to which one map sees a spot's cone.
const WIDEST_SPOT: f32 = 0.5;

impl LightShape {
    /// Whether a single map sees all that it lights.
    #[must_use]
    pub fn looks_one_way(&self) -> bool {
        match self {
            Self::Sun { .. } => true,
            Self::Point { .. } => false,
            Self::Spot { cone_cosines: [_, outer], .. } => *outer >= WIDEST_SPOT,
        }
    }
}

/// Texels of the maps of all lights.
pub(super) fn texels(lights: &[RenderLight]) -> u64 {
    let of_light = |light: &RenderLight| match light.shape.looks_one_way() {
        true => u64::from(WIDE_PX).pow(2),
        false => SHADOW_FACES as u64 * u64::from(SIDE_PX).pow(2),
    };
    lights.iter().map(of_light).sum()
}
