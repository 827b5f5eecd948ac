//! What methods that march get wrong and what they read, on maps of the corpus, generated ones, and those named; and
//! how many rays they march beside plain code on all cores. Writes `tests/charts/relief.csv` and `relief_speed.csv`.
//!
//! `DISPLACE_CORPUS=... cargo bench --profile dev -p displace-tests --bench relief [-- MAP.png ...]`

#[path = "relief/maps.rs"]
mod maps;
#[path = "relief/native.rs"]
mod native;
#[path = "relief/rays.rs"]
mod rays;
#[path = "relief/speed.rs"]
mod speed;
#[path = "relief/table.rs"]
mod table;

use displace_server::vulkan::{Device, DeviceOptions};
use displace_tests::data::repository;

/// From the base's normal.
const DEGREES: [f64; 3] = [30.0, 60.0, 80.0];

fn main() {
    let files: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let device = Device::open(&DeviceOptions::default()).expect("a Vulkan device; run deploy/setup to install one");
    let maps = maps::all(&files);
    write("relief_speed.csv", &speed::of(&device, &maps));
    write("relief.csv", &table::of(&device, &maps));
}

fn write(name: &str, text: &str) {
    std::fs::write(repository().join("tests/charts").join(name), text).expect("the chart can be written");
}
