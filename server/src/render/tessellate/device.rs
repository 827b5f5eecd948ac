//! The tessellator's passes on a Vulkan device, for meshes whose details are height layers.
//!
//! | file | passes | makes |
//! |---|---|---|
//! | `tables.rs` | | what the bound reads of the base mesh |
//! | `bounds.rs` | bound_maps, bound_fields, bound_line_counts, bound_lines, bound_ramps | the bound of listed triangles |
//! | `refine.rs` | refine_new, refine_places, refine_judge, and those of `render::refine` | rounds of refinement |

pub mod bounds;
mod refine;
pub mod tables;

pub use refine::refine;
