//! The large corpus of real models and maps, found through `DISPLACE_CORPUS` (see `tests/README.md`).
//!
//! Without it the tests that need it say so and pass; `DISPLACE_REQUIRE_CORPUS=1` makes its absence a
//! failure, so that a continuous run cannot lose it unnoticed.

use std::path::{Path, PathBuf};

use serde::Deserialize;

pub struct Corpus {
    pub root: PathBuf,
    entries: Vec<Entry>,
}

/// One row of `corpus.json`.
#[derive(Clone, Debug, Deserialize)]
pub struct Entry {
    pub id: String,
    pub kind: String,
    pub expect: String,
    #[serde(default)]
    pub main: String,
    #[serde(default)]
    mains: Vec<String>,
    #[serde(default)]
    expect_by_main: std::collections::BTreeMap<String, String>,
    #[serde(default)]
    pub features: Vec<String>,
    #[serde(default)]
    pub triangles: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    Accept,
    AcceptOrReject,
    Reject,
}

/// One glTF file of the corpus and what must become of it.
#[derive(Clone, Debug)]
pub struct Model {
    pub path: PathBuf,
    pub expect: Expect,
}

#[derive(Deserialize)]
struct Index {
    entries: Vec<Entry>,
}

/// The corpus, or `None` after saying on stderr that `what` was skipped.
///
/// # Panics
/// When the corpus is required but absent, or its index cannot be read.
#[must_use]
pub fn corpus(what: &str) -> Option<Corpus> {
    let required = std::env::var_os("DISPLACE_REQUIRE_CORPUS").is_some_and(|value| value == "1");
    match std::env::var_os("DISPLACE_CORPUS") {
        Some(root) => Some(Corpus::open(Path::new(&root))),
        None if required => panic!("DISPLACE_REQUIRE_CORPUS is 1 but DISPLACE_CORPUS does not name the corpus folder"),
        None => {
            eprintln!("skipped: {what} needs the corpus; set DISPLACE_CORPUS to its folder to run it");
            None
        }
    }
}

impl Corpus {
    fn open(root: &Path) -> Self {
        let index = root.join("corpus.json");
        let text = std::fs::read(&index).unwrap_or_else(|error| panic!("cannot read {}: {error}", index.display()));
        let index: Index = serde_json::from_slice(&text).expect("corpus.json is valid");
        Self { root: root.to_owned(), entries: index.entries }
    }

    #[must_use]
    pub fn path(&self, relative: &str) -> PathBuf {
        self.root.join(relative)
    }

    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Every glTF file with its expectation, the invalid ones included.
    #[must_use]
    pub fn models(&self) -> Vec<Model> {
        let of_models = self.entries.iter().filter(|entry| matches!(entry.kind.as_str(), "model" | "invalid"));
        of_models
            .flat_map(|entry| entry.files().map(|(file, expect)| Model { path: self.path(file), expect }))
            .collect()
    }
}

impl Entry {
    fn files(&self) -> impl Iterator<Item = (&str, Expect)> {
        let mains = if self.mains.is_empty() { std::slice::from_ref(&self.main) } else { &self.mains };
        mains.iter().map(|main| (main.as_str(), self.expect_of(main)))
    }

    fn expect_of(&self, main: &str) -> Expect {
        // The index names the files of an entry by the end of their stems: `00` is `Compatibility_00.gltf`.
        let stem = main.rsplit_once('.').map_or(main, |(stem, _)| stem);
        let own = self.expect_by_main.iter().find(|(name, _)| main == name.as_str() || stem.ends_with(name.as_str()));
        let text = own.map_or(&self.expect, |(_, expect)| expect);
        match text.as_str() {
            "accept" => Expect::Accept,
            "reject" => Expect::Reject,
            "accept-or-reject-cleanly" => Expect::AcceptOrReject,
            other => panic!("{}: the corpus expects '{other}', which the harness does not know", self.id),
        }
    }
}
