//! Compute shaders as data, their checked layouts, and the f64 twin of every pass. No GPU API here.

pub mod lattice;
