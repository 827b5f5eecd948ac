//! What bends normals and moves nothing: slopes of heights, normal maps, formulas. All of it adds, as gradients along the
//! surface (Mikkelsen 2010).

use std::sync::Arc;

use super::{detail::Wrap, expression::Program, image::BumpKind, image::ColorMap};

/// What bends the normals of one material.
#[derive(Clone, Debug, Default)]
pub struct Bump {
    pub layers: Vec<BumpLayer>,
    /// Which TEXCOORD_n the layers read.
    pub uv_set: u32,
    /// The normal is bent from that of the triangle.
    pub faceted: bool,
}

#[derive(Clone, Debug)]
pub struct BumpLayer {
    pub source: BumpSource,
    /// Of heights: mesh-local units per unit of the value. Of normals: strength of the slopes.
    pub scale: f32,
    /// Rows of the affine map from (u, v, 1) to where texel i of n is at (i + 1/2) / n.
    pub map_from_uv: [[f32; 3]; 2],
}

#[derive(Clone, Debug)]
pub enum BumpSource {
    /// A map, and what its texels hold.
    Map {
        map: Arc<ColorMap>,
        wrap: [Wrap; 2],
        kind: BumpKind,
    },
    Formula(Arc<Program>),
}

/// A normal map that a glTF material can hold, as an encoded image; it replaces the material's own.
#[derive(Clone, Debug)]
pub struct NormalTexture {
    /// PNG or JPEG, glTF's way round.
    pub image: bytes::Bytes,
    pub media_type: &'static str,
    pub uv_set: u32,
    pub wrap: [Wrap; 2],
    pub scale: f32,
}

/// What shades each material besides what moves it.
#[derive(Clone, Debug, Default)]
pub struct Bumps {
    /// Parallel to `Scene::materials`.
    pub of_material: Vec<Shading>,
    /// Of primitives without a material.
    pub of_none: Shading,
}

/// What a request has for the normals of one material.
#[derive(Clone, Debug, Default)]
pub struct Shading {
    pub bump: Option<Arc<Bump>>,
    pub texture: Option<Arc<NormalTexture>>,
    /// Some layer is a normal map: it describes the surface that other layers make by moving vertices.
    pub has_normals: bool,
}

impl Shading {
    /// Whether it tells what a surface looks like whose vertices move, so that normals are bent from those of the base.
    #[must_use]
    pub fn tells_normals(&self) -> bool {
        self.has_normals || self.bump.is_some()
    }
}

impl Bumps {
    #[must_use]
    pub fn of(&self, material: Option<usize>) -> &Shading {
        material.and_then(|m| self.of_material.get(m)).unwrap_or(&self.of_none)
    }

    /// Of all materials, then of none.
    pub fn all(&self) -> impl Iterator<Item = &Shading> {
        self.of_material.iter().chain([&self.of_none])
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all().all(|shading| shading.bump.is_none() && shading.texture.is_none())
    }
}

impl Bump {
    /// Whether tangents are needed.
    #[must_use]
    pub fn is_in_tangent_space(&self) -> bool {
        let of_frame = |layer: &BumpLayer| matches!(layer.source, BumpSource::Map { kind: BumpKind::Tangent, .. });
        self.layers.iter().any(of_frame)
    }

    /// Whether texture coordinates are needed.
    #[must_use]
    pub fn reads_uv(&self) -> bool {
        self.layers.iter().any(|layer| match &layer.source {
            BumpSource::Map { .. } => true,
            BumpSource::Formula(program) => program.reads_uv(),
        })
    }
}
