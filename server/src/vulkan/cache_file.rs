//! Small files that make the next start faster. They are replaced whole or not at all, and nothing
//! depends on them: a missing or unwritable one costs time only.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
};

use sha2::{Digest as _, Sha256};

/// Larger caches are not worth reading at a start.
const MAX_BYTES: u64 = 64 << 20;

/// A file in `folder` for `purpose`, named after everything its contents depend on.
pub(crate) fn path(folder: &Path, purpose: &str, depends_on: &[&[u8]]) -> PathBuf {
    let mut hash = Sha256::new();
    for part in depends_on {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    folder.join(format!("{purpose}-{}", super::select::hex(&hash.finalize()[..12])))
}

/// The contents, or nothing.
pub(crate) fn read(file: &Path) -> Vec<u8> {
    let fits = fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() <= MAX_BYTES);
    if fits { fs::read(file).unwrap_or_default() } else { Vec::new() }
}

/// True if the file now holds `data`.
pub(crate) fn write(file: &Path, data: &[u8]) -> bool {
    let written = try_write(file, data);
    if let Err(error) = &written {
        tracing::warn!(file = %file.display(), %error, "a device cache file could not be written");
    }
    written.is_ok()
}

fn try_write(file: &Path, data: &[u8]) -> std::io::Result<()> {
    let folder = file.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    // Other processes may write the same file now: each writes its own and the last rename wins.
    let part = file.with_extension(format!("{}.part", std::process::id()));
    let result = fs::File::create(&part).and_then(|mut out| out.write_all(data)).and_then(|()| fs::rename(&part, file));
    if result.is_err() {
        let _ = fs::remove_file(&part);
    }
    result
}

/// Has Mesa keep its compiled shaders in `folder`, unless the environment says where; true if it will.
/// Without this it uses `mesa_shader_cache` under the user's cache folder, and none where there is no such
/// folder. To be called first in `main`: does nothing once a second thread runs.
pub fn keep_driver_cache_in(folder: &Path) -> bool {
    const VARIABLE: &str = "MESA_SHADER_CACHE_DIR";
    let threads = fs::read_dir("/proc/self/task").map(Iterator::count).unwrap_or(usize::MAX);
    if threads != 1 || std::env::var_os(VARIABLE).is_some() || fs::create_dir_all(folder).is_err() {
        return false;
    }
    // SAFETY: this is the only thread, so nobody reads the environment meanwhile.
    unsafe { std::env::set_var(VARIABLE, folder) };
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_back_and_named_after_what_it_depends_on() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = path(&folder.path().join("new"), "pipelines", &[b"driver", b"1"]);
        assert!(read(&file).is_empty());
        assert!(write(&file, b"data"));
        assert_eq!(read(&file), b"data");
        assert_ne!(file, path(&folder.path().join("new"), "pipelines", &[b"driver1", b""]));
    }
}
