//! What is on the surface: decoded maps and compiled expressions, ready for a pass.
//!
//! f32 vectors are the one internal form: a height h is (0, 0, h) in the tangent frame, so
//! displacement = T x + B y + D z. H = scale (value − midlevel).

mod reach;

use std::sync::Arc;

use serde::Serialize;

use super::{Error, Result, expression::Program};

/// The detail of one material: its layers add.
#[derive(Clone, Debug, Default)]
pub struct Detail {
    pub layers: Vec<Layer>,
    /// Which TEXCOORD_n the layers read.
    pub uv_set: u32,
}

#[derive(Clone, Debug)]
pub struct Layer {
    pub source: LayerSource,
    /// Mesh-local units per unit of the map.
    pub scale: f32,
    pub midlevel: f32,
    /// Rows of the affine map uv' = M (u, v, 1): KHR_texture_transform and flips.
    pub map_from_uv: [[f32; 3]; 2],
}

#[derive(Clone, Debug)]
pub enum LayerSource {
    /// One channel, along the welded direction.
    Height(Arc<Map>),
    /// Three channels, in the tangent frame (x along T, y along B, z along the welded direction).
    VectorTangent(Arc<Map>),
    /// Three channels, in mesh-local axes.
    VectorObject(Arc<Map>),
    Expression(Arc<Program>),
}

impl Layer {
    /// `map_from_uv` of a map as it is, or whose rows start at the bottom.
    #[must_use]
    pub fn map_from_uv(flip_v: bool) -> [[f32; 3]; 2] {
        if flip_v { [[1.0, 0.0, 0.0], [0.0, -1.0, 1.0]] } else { [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] }
    }
}

impl Map {
    /// Refuses maps too small to have texels on nodes.
    pub fn check_nodes(field: &str, [width, height]: [u32; 2], sampling: Sampling) -> Result<()> {
        if sampling != Sampling::Node || (width >= 2 && height >= 2) {
            return Ok(());
        }
        let message = format!(
            "node sampling needs at least 2 x 2 pixels and the map has {width} x {height}: use center sampling"
        );
        Err(Error::invalid(field, message))
    }
}

impl LayerSource {
    /// Texels along u and along v; none of what has no map.
    #[must_use]
    pub fn size(&self) -> Option<[u32; 2]> {
        match self {
            Self::Height(map) | Self::VectorTangent(map) | Self::VectorObject(map) => Some([map.width, map.height]),
            Self::Expression(_) => None,
        }
    }
}

/// A decoded map: f32, row-major, `channels` (1 or 3) interleaved.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    pub width: u32,
    pub height: u32,
    pub channels: u32,
    /// Shared with the tables of a mesh that has no other map.
    pub texels: Arc<Vec<f32>>,
    /// Along u and along v.
    pub wrap: [Wrap; 2],
    pub sampling: Sampling,
    /// Bits per channel of the source, for terracing warnings: 8, 16 or 32.
    pub source_bits: u32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Wrap {
    #[default]
    Repeat,
    Mirror,
    Clamp,
}

/// Where texel i of n lies: `Center` at (i + 0.5) / n, `Node` at i / (n − 1) (u in [0, 1] never wraps,
/// period n − 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Sampling {
    #[default]
    Center,
    Node,
}
