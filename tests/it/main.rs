//! The one integration binary: one module per topic, all over the harness in `tests/src`.
mod cli;
mod tidy;
mod vulkan;
