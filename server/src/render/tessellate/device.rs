//! The tessellator's passes on a Vulkan device, for meshes whose details are height layers.
//!
//! | file | passes | makes |
//! |---|---|---|
//! | `tables.rs` | | what the bound reads of the base mesh |
//! | `bounds.rs` | bound_maps, bound_fields, bound_line_counts, bound_lines, bound_ramps | the bound of listed triangles |
//! | `refine.rs` | refine_new, refine_places, refine_judge, and those of `render::refine` | rounds of refinement |
//! | `simplify.rs`, `simplify/` | star_*, simplify_places, collapse_*, flip_* | rounds of collapses and flips |

pub mod bounds;
mod refine;
pub mod simplify;
pub mod tables;

pub use refine::refine;
