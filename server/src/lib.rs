//! The Displace service: everything behind `displaced`, usable in-process.
//!
//! Dependency direction (checked by `tests/it/tidy.rs`):
//! `grpc -> jobs -> render -> {domain, vulkan, glsl}`, `store -> domain`, `domain -> glsl (data, reference)`.

pub mod domain;
pub mod render;
pub mod vulkan;
