//! What each method would be off by, before anything is rendered: facts of the heights, patches of the base as a view sees
//! them, and upper bounds of the error in pixels from both (`methods.md` D.2 and D.3).
//!
//! What is bounded is the **reprojection error**. Where a pixel p shows the surface at a parameter u, the true displaced
//! surface is at X(u) = b(u) + h(u) D(u), b being the base, D the displacement direction, h the height, bilinear at full
//! resolution, midlevel and scale in it: the error is |project(X(u)) - p|. Whether X(u) is hidden there by another part of
//! the surface is another question: [`predict::Predicted::may_show_hidden`].
//!
//! Nothing is traced: facts take time and memory that grow as the texels, and a patch takes as much as the blocks of the map
//! that it borders on.

pub mod cost;
pub mod facts;
mod greatest;
pub mod kept;
mod lay;
pub mod patch;
pub mod patches;
pub mod predict;
