//! How the alpha of materials is realised.

use serde::{Deserialize, Serialize};

use crate::domain::scene::Alpha;

/// How an image shows materials of glTF's alpha mode BLEND.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum AlphaMode {
    /// Cut off at [`BLEND_CUTOFF`].
    Mask,
    /// In layers from front to back: exactly.
    #[default]
    Blend,
    /// Each sample keeps a surface or leaves it out by chance (Enderton et al. 2010), as likely as its alpha says.
    Stochastic,
}

/// What of a blended material counts as there where it must be one or the other: all of its alpha from here on.
pub const BLEND_CUTOFF: f32 = 0.5;

/// What the renderer does with the alpha of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RenderAlpha {
    /// Nothing.
    #[default]
    Opaque,
    /// Lower alpha is a hole.
    Mask {
        cutoff: f32,
    },
    Blend,
    Stochastic,
}

impl RenderAlpha {
    #[must_use]
    pub fn new(alpha: Alpha, mode: AlphaMode) -> Self {
        match (alpha, mode) {
            (Alpha::Opaque, _) => Self::Opaque,
            (Alpha::Mask { cutoff }, _) => Self::Mask { cutoff },
            (Alpha::Blend, AlphaMode::Mask) => Self::Mask { cutoff: BLEND_CUTOFF },
            (Alpha::Blend, AlphaMode::Blend) => Self::Blend,
            (Alpha::Blend, AlphaMode::Stochastic) => Self::Stochastic,
        }
    }

    /// Whether several of them are seen one behind the other.
    #[must_use]
    pub fn is_blended(self) -> bool {
        matches!(self, Self::Blend | Self::Stochastic)
    }

    /// From which alpha on a ray of light is stopped; 0: always.
    #[must_use]
    pub fn cutoff(self) -> f32 {
        match self {
            Self::Opaque => 0.0,
            // A cut-off of 0 lets everything pass.
            Self::Mask { cutoff } => cutoff.max(0.0),
            Self::Blend | Self::Stochastic => BLEND_CUTOFF,
        }
    }
}
