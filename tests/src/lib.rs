//! The harness of the integration tests and benchmarks: procedural meshes and maps, sample data, the
//! corpus, a validated device, goldens, and the invariants every result must keep.
//!
//! It drives the packages from outside; nothing here is used by them.

pub mod cli;
pub mod corpus;
pub mod data;
pub mod device;
pub mod glb;
pub mod golden;
pub mod invariants;
pub mod maps;
pub mod meshes;
pub mod server;
pub mod subdivided;
pub mod surfaces;
