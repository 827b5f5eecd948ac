//! Golden images: small pictures that only a person changes.
//!
//! A device is compared with the f64 twins elsewhere; a golden is compared with itself, so that a change
//! of the picture is seen and explained in the commit that makes it. `cargo bless NAME` accepts it.

use std::path::PathBuf;

use image::{Rgba, RgbaImage};

use crate::data;

/// The largest file a golden may have.
const MAX_BYTES: u64 = 64 * 1024;
/// Largest difference of one 8-bit channel: rounding differs between devices.
const MAX_DIFFERENCE: u8 = 3;
/// Largest share of pixels that may differ by more: coverage of an edge may fall the other way.
const MAX_OUTLIERS: f64 = 0.002;

/// Compares `actual` with `tests/golden/{name}.png`, or writes it when blessing.
///
/// # Panics
/// When the pictures differ, with the command that accepts the new one.
pub fn check(name: &str, actual: &RgbaImage) {
    let golden = folder().join(format!("{name}.png"));
    if std::env::var_os("DISPLACE_BLESS").is_some_and(|value| value == "1") {
        bless(&golden, actual);
        return;
    }
    let expected = image::open(&golden).map(|image| image.to_rgba8());
    let Ok(expected) = expected else { fail(name, actual, None, "there is no such golden") };
    if expected.dimensions() != actual.dimensions() {
        fail(
            name,
            actual,
            None,
            &format!("it is {:?}, the golden is {:?}", actual.dimensions(), expected.dimensions()),
        );
    }
    let (difference, outliers, largest) = compare(&expected, actual);
    if outliers > MAX_OUTLIERS {
        fail(
            name,
            actual,
            Some(&difference),
            &format!("{:.3} % of its pixels differ, by up to {largest}", 100.0 * outliers),
        );
    }
}

fn folder() -> PathBuf {
    data::package().join("golden")
}

fn bless(golden: &PathBuf, actual: &RgbaImage) {
    std::fs::create_dir_all(folder()).expect("the golden folder can be made");
    actual.save(golden).expect("the golden can be written");
    let size_bytes = std::fs::metadata(golden).map_or(0, |file| file.len());
    assert!(
        size_bytes <= MAX_BYTES,
        "{} has {size_bytes} bytes; a golden has at most {MAX_BYTES}: render it smaller",
        golden.display()
    );
}

/// The picture of the differences, the share of pixels above the limit, and the largest difference.
fn compare(expected: &RgbaImage, actual: &RgbaImage) -> (RgbaImage, f64, u8) {
    let mut difference = RgbaImage::new(actual.width(), actual.height());
    let (mut outliers, mut largest) = (0u32, 0);
    for (x, y, pixel) in actual.enumerate_pixels() {
        let apart: Vec<u8> = pixel.0.iter().zip(expected.get_pixel(x, y).0).map(|(a, b)| a.abs_diff(b)).collect();
        let worst = apart.iter().copied().max().unwrap_or(0);
        largest = largest.max(worst);
        outliers += u32::from(worst > MAX_DIFFERENCE);
        let shown = |k: usize| apart[k].saturating_mul(8).saturating_add(apart[3]);
        difference.put_pixel(x, y, Rgba([shown(0), shown(1), shown(2), 255]));
    }
    (difference, f64::from(outliers) / f64::from(actual.width() * actual.height()), largest)
}

fn fail(name: &str, actual: &RgbaImage, difference: Option<&RgbaImage>, why: &str) -> ! {
    let mut written = vec![folder().join(format!("{name}.actual.png"))];
    std::fs::create_dir_all(folder()).expect("the golden folder can be made");
    actual.save(&written[0]).expect("the actual picture can be written");
    if let Some(difference) = difference {
        written.push(folder().join(format!("{name}.difference.png")));
        difference.save(&written[1]).expect("the difference can be written");
    }
    panic!(
        "golden '{name}': {why}. Look at {written:?}; if the new picture is right, run `cargo bless {name}` and commit it"
    );
}
