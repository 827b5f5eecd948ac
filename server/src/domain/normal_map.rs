//! A normal map that carries what the triangles of a result leave out of its surface.
//!
//! Each texel is a place of the surface: where its centre lies on the result's triangles by their texture coordinates.
//! It holds the surface's own normal there, in the frame that a reader of the result interpolates at that place, so
//! that shading shows the surface and not the triangles. Between islands it is continued, so that filters see no hole.
//!
//! | file | holds |
//! |---|---|
//! | `sheet.rs` | the triangles of a result as readers see them, and their frames |
//! | `coverage.rs` | which triangles have which texels |
//! | `texels.rs` | one normal for each texel, and what islands are continued by |
//! | `sampled.rs` | how far the map is from the surface, as a reader sees it |

mod coverage;
mod sampled;
mod sheet;
mod texels;

pub use coverage::{Claim, claims};
pub use sampled::{Sample, angles_degrees, samples};
pub use sheet::{Frame, Sheet};
pub use texels::{Disagreement, Texels};

/// Texels of a side where nothing says how many: of a detail without maps.
pub const DEFAULT_SIZE: u32 = 1024;
/// Texels of a side at least and at most.
pub const SIZES: std::ops::RangeInclusive<u32> = 4..=4096;
/// Islands are continued by so many texels: bilinear filters read one, and those of three coarser levels as many.
pub const GUTTER_TEXELS: u32 = 8;
/// Normals that two places want of one texel may be apart by so much: about what 8 bits and triangles take anyhow.
pub const MOST_APART_DEGREES: f64 = 5.0;
/// Of the texels that are covered: no map serves where more are wanted differently. Islands that touch in
/// slivers are let through.
pub const MOST_DISAGREEING: f64 = 1e-2;
