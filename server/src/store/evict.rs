//! Keeps the store within its limit: least recently used results first, then uploads; and sweeps up what
//! killed processes left.

use std::{
    path::Path as FilePath,
    sync::{Weak, atomic::Ordering},
    time::{Duration, SystemTime},
};

use futures::TryStreamExt as _;
use object_store::{ObjectMeta, ObjectStore as _, ObjectStoreExt as _, path::Path};

use super::{Store, crashed, disk_error, names};
use crate::domain::{Error, ErrorKind, Result};

/// How often leftovers are looked for.
const SWEEP_EVERY: Duration = Duration::from_secs(60);

/// Counts and tidies while the store is open.
pub(super) async fn keep_tidy(store: Weak<Store>) {
    loop {
        let Some(open) = store.upgrade() else { return };
        if let Err(error) = open.sweep().await {
            tracing::warn!(%error, cause = ?error.cause, "the store could not be tidied");
        }
        drop(open);
        tokio::time::sleep(SWEEP_EVERY).await;
    }
}

impl Store {
    async fn sweep(&self) -> Result<()> {
        self.uploads.close_idle();
        let (root, ttl) = (self.options.root.clone(), self.options.upload_ttl);
        tokio::task::spawn_blocking(move || sweep_leftovers(&root, ttl)).await.map_err(crashed)?;
        self.count().await.map(drop)
    }

    /// All files of all tenants; corrects the estimate on the way.
    async fn count(&self) -> Result<Vec<ObjectMeta>> {
        let listing = self.disk.list(Some(&Path::from("t")));
        let files: Vec<ObjectMeta> = listing.try_collect().await.map_err(|cause| disk_error("list", cause))?;
        let staged: u64 = self.uploads.staged_bytes();
        let used = files.iter().map(|file| file.size).sum::<u64>() + staged;
        self.used_bytes.store(used, Ordering::Relaxed);
        Ok(files)
    }

    /// Makes sure that `incoming_bytes` fit, by removing what was used longest ago.
    pub(super) async fn make_room(&self, incoming_bytes: u64) -> Result<()> {
        let limit = self.options.limit_bytes;
        if self.used_bytes() + incoming_bytes <= limit {
            return Ok(());
        }
        let _one_at_a_time = self.evicting.lock().await;
        let mut files = self.count().await?;
        let keep_from = SystemTime::now().checked_sub(self.options.keep).unwrap_or(SystemTime::UNIX_EPOCH);
        files.sort_by_cached_key(|file| eviction_rank(file, keep_from));
        // A tenth below the limit, so that the next upload need not look again; of what is in use only as
        // much as must be.
        let roomy = (limit - limit / 10).saturating_sub(incoming_bytes);
        let tight = limit.saturating_sub(incoming_bytes);
        for file in files {
            let goal = if eviction_rank(&file, keep_from).0 { tight } else { roomy };
            if self.used_bytes() <= goal {
                break;
            }
            tracing::debug!(path = %file.location, bytes = file.size, "removed to make room");
            self.remove(&file.location, file.size).await?;
        }
        if self.used_bytes() <= tight { Ok(()) } else { Err(full(limit)) }
    }

    /// Whether there was something to remove.
    pub(super) async fn remove(&self, path: &Path, size_bytes: u64) -> Result<bool> {
        match self.disk.delete(path).await {
            Ok(()) => {
                self.shrink(size_bytes);
                Ok(true)
            }
            Err(object_store::Error::NotFound { .. }) => Ok(false),
            Err(cause) => Err(disk_error("remove", cause)),
        }
    }

    pub(super) async fn rename(&self, from: &Path, to: &Path) -> Result<()> {
        let target = self.disk.path_to_filesystem(to).map_err(|cause| disk_error("move", cause))?;
        if let Some(parent) = target.parent() {
            tokio::fs::create_dir_all(parent).await.map_err(|cause| disk_error("move", cause))?;
        }
        self.disk.rename(from, to).await.map_err(|cause| disk_error("move", cause))
    }
}

/// (in use, upload, last use): what sorts first goes first.
fn eviction_rank(file: &ObjectMeta, keep_from: SystemTime) -> (bool, bool, SystemTime) {
    let last_use: SystemTime = file.last_modified.into();
    (last_use > keep_from, !names::is_made_by_jobs(&file.location), last_use)
}

fn full(limit_bytes: u64) -> Error {
    let message = format!("the store is full of assets in use (limit {limit_bytes} bytes); call again later");
    Error::new(ErrorKind::Busy { retry_secs: 30 }, message).with_field("store_bytes")
}

/// Removes unfinished uploads and temporary files that nobody has touched for `ttl`.
fn sweep_leftovers(root: &FilePath, ttl: Duration) {
    let mut folders = vec![root.join("t"), root.join("staging")];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let Ok(meta) = entry.metadata() else { continue };
            if meta.is_dir() {
                folders.push(entry.path());
            } else if is_leftover(root, &entry.path()) && is_older(&meta, ttl) {
                // Another process may have been faster.
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

/// `NAME#N` is how the store names a file it has not yet renamed.
fn is_leftover(root: &FilePath, file: &FilePath) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    file.starts_with(root.join("staging")) || name.contains('#')
}

fn is_older(meta: &std::fs::Metadata, age: Duration) -> bool {
    let modified = meta.modified().unwrap_or_else(|_| SystemTime::now());
    SystemTime::now().duration_since(modified).unwrap_or_default() > age
}
