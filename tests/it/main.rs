//! The one integration binary: one module per topic, all over the harness in `tests/src`.
mod tidy;
mod vulkan;
