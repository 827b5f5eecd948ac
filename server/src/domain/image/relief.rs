//! Heights that images show per pixel.

use std::sync::Arc;

use displace_glsl::methods::Method;
use serde::{Deserialize, Serialize};

/// How all materials with relief show it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReliefSettings {
    /// One that marches, where any material has relief.
    pub method: Method,
    pub silhouettes: Silhouettes,
    pub self_shadow: SelfShadow,
}

/// Whether relief changes the outline of what it is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Silhouettes {
    /// The outline is that of the base.
    #[default]
    None,
    /// Rays are followed through the prisms between the base and the greatest height (Porumbescu et al. 2005).
    Shell,
    /// Rays are followed over a quadric that the base is near to (Oliveira and Policarpo 2005).
    Quadric,
}

/// Whether relief takes its own light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum SelfShadow {
    #[default]
    None,
    /// A march towards the light meets it or not.
    Hard,
    /// By how far the way towards the light comes below the heights.
    Soft,
}

/// What marching over height maps took; of fragments, each of which is one ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MarchCounters {
    pub rays: u64,
    /// Bilinear values, bounds and cones that were read.
    pub fetches: u64,
    pub steps: u64,
    /// Rays that a bound on steps ended.
    pub cap_hits: u64,
}

/// The heights of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderRelief {
    pub map: Arc<HeightMap>,
    /// Of each vertex's `uvs`.
    pub uv_channel: u32,
    pub map_from_uv: [[f32; 3]; 2],
    /// Linear steps of a march; 0: as many as the angle asks for.
    pub steps: u32,
}

/// Heights above the base as they are marched: texel i of n lies at (i + 1/2) / n.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeightMap {
    pub width: u32,
    pub height: u32,
    /// Mesh-local units, midlevel and scale in it; row-major.
    pub heights: Vec<f32>,
    /// Along u and v; else the border's texel goes on.
    pub repeats: [bool; 2],
    /// Width of its thinnest feature, texels.
    pub thinnest_texels: f32,
}

impl HeightMap {
    /// Least and greatest height.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        // Lanes that do not wait for each other.
        const LANES: usize = 16;
        let mut ends = [[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]];
        let chunks = self.heights.chunks_exact(LANES);
        let rest = chunks.remainder();
        for chunk in chunks {
            for (k, height) in chunk.iter().enumerate() {
                ends[0][k] = ends[0][k].min(*height);
                ends[1][k] = ends[1][k].max(*height);
            }
        }
        let [low, high] = [rest, rest].map(|rest| rest.iter().copied());
        [low.chain(ends[0]).fold(f32::INFINITY, f32::min), high.chain(ends[1]).fold(f32::NEG_INFINITY, f32::max)]
    }
}
