//! The validated Vulkan device that tests share, and the processor's f64 one beside it.

use std::sync::{Arc, OnceLock};

use displace_server::render::{self, Executor, ExecutorOptions};

/// Device memory a test may use.
pub const TEST_DEVICE_BYTES: u64 = 2 << 30;

/// True when tests of the device are switched off; says so for `what`.
#[must_use]
pub fn without_gpu(what: &str) -> bool {
    let off = std::env::var_os("DISPLACE_NO_GPU").is_some_and(|value| value == "1");
    if off {
        eprintln!("skipped: {what} needs a Vulkan device and DISPLACE_NO_GPU is 1");
    }
    off
}

/// The Vulkan executor with the validation layers on: what they find fails the job that caused it.
/// `None` with `DISPLACE_NO_GPU=1`.
///
/// # Panics
/// When there is no device: a suite that skips its device tests in silence tests nothing.
#[must_use]
pub fn executor(what: &str) -> Option<Arc<dyn Executor>> {
    static SHARED: OnceLock<Arc<dyn Executor>> = OnceLock::new();
    (!without_gpu(what)).then(|| Arc::clone(SHARED.get_or_init(|| open(None))))
}

/// The f64 executor.
///
/// # Panics
/// When it cannot be made.
#[must_use]
pub fn reference() -> Arc<dyn Executor> {
    open(Some("reference"))
}

fn open(device: Option<&str>) -> Arc<dyn Executor> {
    let cache = tempfile::tempdir().expect("a temporary folder can be made");
    let options = ExecutorOptions {
        device: device.map(Into::into),
        validation: device.is_none(),
        cache: cache.path().to_owned(),
        device_bytes: TEST_DEVICE_BYTES,
        warm_up: false,
    };
    let opened = render::open(&options);
    opened
        .unwrap_or_else(|error| panic!("{error}: run deploy/setup, or set DISPLACE_NO_GPU=1 to skip these tests"))
        .into()
}
