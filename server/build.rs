//! Gives the build an identity: results stored by a build with other sources are never reused.

use std::{fs, io, path::Path};

/// What results depend on.
const SOURCES: [&str; 4] = ["src", "../glsl/src", "../glsl/shaders", "../Cargo.lock"];

fn main() -> io::Result<()> {
    let mut files = Vec::new();
    for source in SOURCES {
        println!("cargo:rerun-if-changed={source}");
        collect(Path::new(source), &mut files)?;
    }
    files.sort();
    let mut hash = FNV_OFFSET;
    for (name, bytes) in &files {
        hash = fnv1a(fnv1a(hash, name.as_bytes()), bytes);
    }
    println!("cargo:rustc-env=DISPLACE_SOURCE_ID={hash:016x}");
    Ok(())
}

fn collect(path: &Path, files: &mut Vec<(String, Vec<u8>)>) -> io::Result<()> {
    if !path.exists() {
        return Ok(());
    }
    if path.is_file() {
        files.push((path.to_string_lossy().into_owned(), fs::read(path)?));
        return Ok(());
    }
    fs::read_dir(path)?.try_for_each(|entry| collect(&entry?.path(), files))
}

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// Fowler, Noll and Vo: tells builds apart, guards against nothing.
fn fnv1a(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}
