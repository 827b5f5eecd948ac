//! How the normals of a material are bent for images.

use std::sync::Arc;

use displace_glsl::layout::bump::{
    BUMP_CYSLICE, BUMP_FACETED, BUMP_HEIGHT, BUMP_NONE, BUMP_OBJECT, BUMP_SLOTS, BUMP_TANGENT,
};

use crate::domain::expression::Program;

/// What bends the normals of a material besides its own normal map: all of it adds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderBump {
    /// Of the maps in `MAP_DETAIL` and the slots after it.
    pub uses: [BumpUse; BUMP_SLOTS],
    pub formulas: Vec<RenderFormula>,
    /// The normal is bent from that of the triangle.
    pub faceted: bool,
}

/// What the map of a slot holds, and what it is multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BumpUse {
    pub kind: BumpKind,
    /// Of heights: mesh-local units per unit of the map. Of normals: strength of the slopes.
    pub scale: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BumpKind {
    #[default]
    None,
    /// Slopes of heights, by u and v of the map.
    Height,
    /// Normals in the frame of MikkTSpace.
    Tangent,
    /// Normals in the mesh's space.
    Object,
    /// Normals in the frame that CySlice's shader prints.
    CySlice,
}

/// Heights from a formula.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderFormula {
    pub program: Arc<Program>,
    /// Mesh-local units per unit of the value.
    pub scale: f32,
    pub uv_channel: u32,
    pub map_from_uv: [[f32; 3]; 2],
}

impl RenderBump {
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.formulas.is_empty() && self.uses.iter().all(|used| used.kind == BumpKind::None)
    }

    /// As `Bump::flags` has it.
    #[must_use]
    pub fn flags(&self) -> u32 {
        if self.faceted { BUMP_FACETED } else { 0 }
    }
}

impl BumpKind {
    /// As `Bump::kinds` has it.
    #[must_use]
    pub fn number(self) -> u32 {
        match self {
            Self::None => BUMP_NONE,
            Self::Height => BUMP_HEIGHT,
            Self::Tangent => BUMP_TANGENT,
            Self::Object => BUMP_OBJECT,
            Self::CySlice => BUMP_CYSLICE,
        }
    }
}
