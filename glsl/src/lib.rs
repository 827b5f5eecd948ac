//! Compute shaders as data, their checked layouts, and the f64 twin of every pass. No GPU API here.

pub mod bezier;
pub mod expression;
pub mod lattice;
pub mod layout;
pub mod methods;
pub mod patches;
pub mod reference;
pub mod tables;

/// A compiled compute shader and what its SPIR-V says of its interface.
#[derive(Debug)]
pub struct ComputeShader {
    /// Name of the pass: file stem, table field, twin and debug label.
    pub name: &'static str,
    pub words: &'static [u32],
    pub local_size: [u32; 3],
    pub push_constant_bytes: u32,
    pub bindings: &'static [Binding],
}

/// A storage buffer binding of set 0, or an array of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    pub name: &'static str,
    pub binding: u32,
    /// Descriptors in the array: the pages of a stream the shader can see.
    pub count: u32,
    /// Array stride of the block's runtime array.
    pub element_bytes: u32,
    pub writable: bool,
}

mod generated {
    use crate::{Binding, ComputeShader};
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}

pub(crate) use generated::offsets;
pub use generated::{ALL_SHADERS, SHADERS, Shaders};
