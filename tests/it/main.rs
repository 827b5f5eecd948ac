//! The one integration binary: one module per topic, all over the harness in `tests/src`.
mod cli;
mod compare;
mod corpus;
mod determinism;
mod gltf;
mod invariants;
mod measure;
mod oracle;
mod oracle_image;
mod oracle_rays;
mod passes;
mod raster;
mod service;
mod tidy;
mod vulkan;
mod warnings;
mod watertight;
