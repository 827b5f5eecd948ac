//! The command line: exit codes, JSON shapes, files replaced whole, conversion, groups of materials.
//!
//! Most run through the library's entry against one server on the reference device; a few run the real
//! command, with the service inside it.

mod conversion;
mod jobs;
mod process;
mod store;
mod usage;

use std::path::PathBuf;

use displace_tests::{
    cli::Run,
    server::{displace, reference},
};

/// Runs a command line through the library, against the shared server.
fn remote<S: AsRef<str>>(args: &[S]) -> Run {
    let mut all: Vec<&str> = args.iter().map(AsRef::as_ref).collect();
    all.extend(["--server", reference()]);
    displace(&all)
}

/// The same, with a JSON report.
fn report<S: AsRef<str>>(args: &[S]) -> serde_json::Value {
    let mut all: Vec<&str> = args.iter().map(AsRef::as_ref).collect();
    all.push("--json");
    remote(&all).expect_success().json()
}

fn keys(value: &serde_json::Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

/// A temporary folder with files.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("temporary folders are UTF-8").to_owned()
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = PathBuf::from(self.path(name));
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("the folder can be made");
        std::fs::write(&path, content).expect("the file can be written");
        self.path(name)
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the folder can be read");
        let mut names: Vec<_> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}
