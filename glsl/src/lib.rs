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

impl ComputeShader {
    /// Whether it declares the capability `Int64Atomics` (SPIR-V 2.3: capabilities come first, after a header of 5 words).
    #[must_use]
    pub fn needs_int64_atomics(&self) -> bool {
        const CAPABILITY: u32 = 2 << 16 | 17;
        const INT64_ATOMICS: u32 = 12;
        let capabilities = self.words.get(5..).unwrap_or_default().chunks_exact(2);
        capabilities.take_while(|words| words[0] == CAPABILITY).any(|words| words[1] == INT64_ATOMICS)
    }
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
