//! Heights that are shown per pixel: what methods find on random courses over random maps.

mod exact;
mod failures;
mod rays;
mod surfaces;
mod twins;

use std::sync::{Arc, OnceLock};

use displace_server::vulkan::{Device, DeviceOptions};

/// One validated device for all tests of this module.
fn device() -> &'static Arc<Device> {
    static DEVICE: OnceLock<Arc<Device>> = OnceLock::new();
    DEVICE.get_or_init(|| {
        let options = DeviceOptions { validation: true, ..Default::default() };
        Device::open(&options).expect("a Vulkan device that passes its self-test; run deploy/setup to install one")
    })
}
