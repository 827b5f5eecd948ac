//! Where the committed samples lie. Their licences are in `deploy/licenses`.

use std::path::{Path, PathBuf};

/// A file of `tests/data`, by its path below that folder.
///
/// # Panics
/// When the file does not exist: a sample is part of the checkout.
#[must_use]
pub fn sample(path: &str) -> PathBuf {
    let file = package().join("data").join(path);
    assert!(file.exists(), "the sample {} is missing from the checkout", file.display());
    file
}

/// The folder of this package.
#[must_use]
pub fn package() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The root of the checkout.
#[must_use]
pub fn repository() -> &'static Path {
    package().parent().expect("the tests package lies in the checkout")
}
