//! The harness of the integration tests and benchmarks: procedural meshes and maps, sample data, the
//! corpus, a validated device, and goldens.
//!
//! It drives the packages from outside; nothing here is used by them.

pub mod cli;
pub mod corpus;
pub mod data;
pub mod device;
pub mod glb;
pub mod golden;
pub mod maps;
pub mod march;
pub mod meshes;
pub mod predicted;
pub mod projective;
pub mod reprojected;
pub mod server;
pub mod subdivided;
pub mod surfaces;
