//! The device layer: everything that calls Vulkan, and all `unsafe` of the project, is below here. It
//! knows shaders as data and streams of elements; meshes, jobs and transports are foreign to it.
//!
//! Lifetimes follow five rules, so that no order of destruction is written down anywhere:
//! 1. One shared device; every wrapper holds a clone and destroys its own handle in `Drop`.
//! 2. A wrapper owns one handle and exists before the next call that can fail: constructors are plain
//!    `?` chains.
//! 3. A batch keeps what it recorded until the device has run it. Submissions are waited for.
//! 4. No resource has a state: one global barrier stands between passes.
//! 5. Pipelines come from the shader table and live as long as the device.
//!
//! One thread owns a device and records jobs one after the other; several threads are safe but gain
//! nothing. Work is cut into submissions of about 60 ms, and between them a job can be cancelled.
#![allow(unsafe_code, reason = "Vulkan is a C interface; this folder is the one place that calls it")]

mod access;
mod batch;
pub(crate) mod cache_file;
mod device;
mod error;
mod features;
mod instance;
mod memory;
mod messenger;
mod pipeline;
mod raw;
mod recorder;
mod schedule;
mod select;
mod self_test;
mod stream;

pub use cache_file::keep_driver_cache_in;
pub use device::{Device, DeviceOptions, Testing};
pub use error::{Error, ErrorKind};
pub use recorder::{CancelSignal, PassObserver, PassTime, Recorder};
pub use select::{DeviceInfo, DeviceKind, list_devices};
pub use stream::{MAX_PAGES, PAGE_SHIFT, Stream, TEXELS_MORE_SHIFT};
