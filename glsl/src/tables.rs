//! The base mesh and its details as flat tables: what the geometry passes and their twins read. The host
//! builds them (`server/src/render/passes`); nothing here decides anything.

use std::{ops::Range, sync::Arc};

use crate::{
    layout::geometry::{BaseEdge, BaseTriangle, Correction, Instruction, Lattice, Layer, NONE, Seam, SeamSide},
    patches::Patches,
};

/// All tables of one base mesh. Names are those of the shaders' bindings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tables {
    pub lattice: Lattice,
    /// Position and u of each attribute vertex.
    pub av_position_u: Vec<[f32; 4]>,
    /// Welded direction and v.
    pub av_direction_v: Vec<[f32; 4]>,
    pub av_normal: Vec<[f32; 3]>,
    /// Empty unless a layer reads tangents.
    pub av_tangent: Vec<[f32; 4]>,
    /// Of a base that is not flat.
    pub patches: Option<Arc<Patches>>,
    pub base_edges: Vec<BaseEdge>,
    pub base_triangles: Vec<BaseTriangle>,
    /// Direction a base triangle's fine triangles should face; zero where it has none.
    pub triangle_facing: Vec<[f32; 3]>,
    /// Layers of each detail, by detail number.
    pub details: Vec<Range<u32>>,
    pub layers: Vec<Layer>,
    pub texels: Arc<Vec<f32>>,
    pub instructions: Vec<Instruction>,
    /// Lists per av, then per ae: `triangle * 3 + corner or side` of the triangles that shade it.
    pub contribution_first: Vec<u32>,
    pub contributions: Vec<u32>,
    /// Base triangles without corrections, by detail; then those with, by detail.
    pub triangle_order: Vec<u32>,
    /// How many of `triangle_order` have no corrections.
    pub uncorrected_triangles: u32,
    pub seam_vertices: Vec<Seam>,
    pub seam_corners: Vec<SeamSide>,
    pub seams: Vec<Seam>,
    pub seam_sides: Vec<SeamSide>,
    pub triangle_correction: Vec<u32>,
    pub corrections: Vec<Correction>,
    /// Most sides of any seam that has distinct ones.
    pub max_rank: u32,
    /// [`crate::layout::geometry::rule`]
    pub rule: u32,
}

impl Tables {
    /// Segments of a base edge.
    #[must_use]
    pub fn segments(&self) -> u32 {
        1 << self.lattice.level
    }

    /// The base triangles that shade an av, or ae `list − corners`.
    #[must_use]
    pub fn contributions_of(&self, list: u32) -> &[u32] {
        let [first, end] = [0, 1].map(|k| self.contribution_first[list as usize + k] as usize);
        &self.contributions[first..end]
    }

    /// The correction of a base triangle, if it touches a seam.
    #[must_use]
    pub fn correction(&self, triangle: u32) -> Option<&Correction> {
        let list = *self.triangle_correction.get(triangle as usize)?;
        if list == NONE { None } else { self.corrections.get(list as usize) }
    }
}
