//! The f64 twins of the passes, same stems: the oracle. Each takes the tables its pass takes.

pub mod base_color;
pub mod clip;
pub mod mip;
pub mod raster;
pub mod scan;
pub mod shade;
pub mod surface;
pub mod transform;
