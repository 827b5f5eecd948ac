//! Bytes with their name: SHA-256 and size.

use std::{
    fmt::Write as _,
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use bytes::Bytes;
use displace_proto::v1::Digest;
use sha2::{Digest as _, Sha256};

use crate::error::{Error, Result};

/// Something to upload. Files are read again when they are sent, so they never lie in memory whole.
#[derive(Clone, Debug)]
pub(crate) struct Blob {
    /// What messages call it.
    pub(crate) label: String,
    pub(crate) digest: Digest,
    pub(crate) content: Content,
}

#[derive(Clone, Debug)]
pub(crate) enum Content {
    File(PathBuf),
    Bytes(Bytes),
}

impl Blob {
    /// Hashes a file piece by piece. Blocks.
    pub(crate) fn of_file(path: &Path) -> Result<Self> {
        let failed = |e: std::io::Error| Error::reading(path, &e);
        let mut file = File::open(path).map_err(failed)?;
        let mut hasher = Hasher::default();
        let mut buffer = vec![0; 1 << 20];
        loop {
            match file.read(&mut buffer).map_err(failed)? {
                0 => break,
                count => hasher.update(&buffer[..count]),
            }
        }
        Ok(Self { label: path.display().to_string(), digest: hasher.finish(), content: Content::File(path.into()) })
    }

    pub(crate) fn of_bytes(label: impl Into<String>, bytes: impl Into<Bytes>) -> Self {
        let bytes = bytes.into();
        let mut hasher = Hasher::default();
        hasher.update(&bytes);
        Self { label: label.into(), digest: hasher.finish(), content: Content::Bytes(bytes) }
    }

    /// All bytes; for small blobs.
    pub(super) fn bytes(&self) -> Result<Bytes> {
        match &self.content {
            Content::Bytes(bytes) => Ok(bytes.clone()),
            Content::File(path) => std::fs::read(path).map(Bytes::from).map_err(|e| Error::reading(path, &e)),
        }
    }
}

/// A digest under construction.
#[derive(Default)]
pub(super) struct Hasher {
    sha256: Sha256,
    size_bytes: u64,
}

impl Hasher {
    pub(super) fn update(&mut self, bytes: &[u8]) {
        self.sha256.update(bytes);
        self.size_bytes += bytes.len() as u64;
    }

    pub(super) fn finish(self) -> Digest {
        let mut hash = String::with_capacity(64);
        for byte in self.sha256.finalize() {
            let _ = write!(hash, "{byte:02x}");
        }
        Digest { hash, size_bytes: self.size_bytes }
    }
}

/// `assets/sha256/{hash}/{size}`.
pub(crate) fn resource_name(digest: &Digest) -> String {
    format!("assets/sha256/{}/{}", digest.hash, digest.size_bytes)
}

/// Reads `HASH/SIZE` or a resource name.
pub(crate) fn parse_name(text: &str) -> Result<Digest> {
    let refuse = || {
        let message = format!(
            "'{text}' is no name of an asset; give HASH/SIZE with 64 lower-case hexadecimal digits and a decimal size, as `displace assets ls` prints it"
        );
        Error::usage("NAME", message)
    };
    let (hash, size) = text.strip_prefix("assets/sha256/").unwrap_or(text).split_once('/').ok_or_else(refuse)?;
    let is_hash = hash.len() == 64 && hash.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
    let size_bytes = size.parse().map_err(|_| refuse())?;
    if is_hash { Ok(Digest { hash: hash.to_owned(), size_bytes }) } else { Err(refuse()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_and_its_bytes_have_the_same_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, "abc").unwrap();
        let digest = Blob::of_file(&path).unwrap().digest;
        assert_eq!(digest, Blob::of_bytes("x", "abc").digest);
        assert_eq!(digest.hash, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!(parse_name(&resource_name(&digest)), Ok(digest));
    }

    #[test]
    fn names_that_are_none_are_refused() {
        let upper = "A".repeat(64) + "/3";
        for bad in ["", "abc/3", &"a".repeat(64), &upper, &("a".repeat(64) + "/-1"), &("é".repeat(32) + "/1")] {
            assert!(parse_name(bad).is_err(), "{bad}");
        }
    }
}
