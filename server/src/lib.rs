//! The Displace service: everything behind `displaced`, usable in-process.
//!
//! Dependency direction (checked by `tests/it/tidy.rs`):
//! `grpc -> jobs -> render -> {oracle, domain, vulkan, glsl}`, `{store, oracle} -> domain`, `domain -> glsl (data, reference)`.

pub mod args;
pub mod config;
pub mod domain;
pub mod grpc;
pub mod jobs;
pub mod oracle;
pub mod render;
pub mod service;
pub mod store;
pub mod telemetry;
pub mod vulkan;

pub use jobs::BUILD_ID;
