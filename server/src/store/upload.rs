//! Uploads that can be continued: bytes are appended to a staging file and hashed as they come; when whole
//! and right, the file is renamed into place.

use std::{
    collections::HashMap,
    fs::{File, OpenOptions},
    io::{Read as _, Write as _},
    path::{Path, PathBuf},
    str::FromStr,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use bytes::Bytes;
use sha2::{Digest as _, Sha256};
use tokio::sync::OwnedMutexGuard;

use super::{Class, Digest, Error, ErrorKind, Result, Tenant, TenantStore, crashed, disk_error, mismatch, names};

/// An upload nobody continued for this long is closed; it is opened, and hashed, again when needed.
const IDLE: Duration = Duration::from_secs(60);

/// Each open upload holds a file: the one not used for longest makes room.
const MOST_OPEN: usize = 256;

/// Tells uploads of the same asset apart. Checked, because it becomes part of a file name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct UploadId(String);

impl FromStr for UploadId {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.len() <= 64 && text.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_')) {
            return Ok(Self(text.into()));
        }
        let text = text.escape_default();
        Err(Error::invalid(
            "upload_id",
            format!("'{text}' is not an upload id; allowed are up to 64 of a-z, A-Z, 0-9, '-' and '_'"),
        ))
    }
}

/// How far an upload is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Committed {
    pub bytes: u64,
    pub complete: bool,
}

/// One part of an upload.
#[derive(Clone, Debug)]
pub struct Part {
    pub offset_bytes: u64,
    pub data: Bytes,
    pub finish: bool,
}

type Key = (Tenant, Digest, UploadId);
type Slot = Arc<tokio::sync::Mutex<Option<Session>>>;

/// Uploads that are open now.
#[derive(Debug)]
pub(super) struct Uploads {
    folder: PathBuf,
    open: Mutex<HashMap<Key, Slot>>,
}

/// One open upload. `committed_bytes` is the length of the file and what `hasher` has seen.
#[derive(Debug)]
struct Session {
    path: PathBuf,
    file: File,
    hasher: Sha256,
    committed_bytes: u64,
    last_use: Instant,
}

impl Uploads {
    pub(super) fn new(folder: PathBuf) -> Self {
        Self { folder, open: Mutex::default() }
    }

    fn slot(&self, key: &Key) -> Slot {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if open.len() >= MOST_OPEN && !open.contains_key(key) {
            close_oldest(&mut open);
        }
        Arc::clone(open.entry(key.clone()).or_default())
    }

    fn forget(&self, key: &Key) {
        self.open.lock().unwrap_or_else(PoisonError::into_inner).remove(key);
    }

    pub(super) fn close_idle(&self) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.retain(|_, slot| match slot.try_lock() {
            Ok(session) => session.as_ref().is_some_and(|session| session.last_use.elapsed() < IDLE),
            Err(_) => true,
        });
    }

    /// Bytes of unfinished uploads, of all processes.
    pub(super) fn staged_bytes(&self) -> u64 {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return 0 };
        entries.flatten().filter_map(|entry| entry.metadata().ok()).map(|meta| meta.len()).sum()
    }

    fn path(&self, (tenant, digest, id): &Key) -> PathBuf {
        self.folder.join(format!("{tenant}+{}-{}+{}", digest.hex(), digest.size_bytes, id.0))
    }
}

fn close_oldest(open: &mut HashMap<Key, Slot>) {
    let last_use = |slot: &Slot| slot.try_lock().ok()?.as_ref().map(|session| session.last_use);
    let oldest = open.iter().filter_map(|(key, slot)| Some((last_use(slot)?, key))).min_by_key(|(used, _)| *used);
    if let Some(key) = oldest.map(|(_, key)| key.clone()) {
        open.remove(&key);
    }
}

impl TenantStore {
    /// How much of an asset is here.
    pub async fn query_upload(&self, digest: &Digest, id: &UploadId) -> Result<Committed> {
        if self.locate(digest).await?.is_some() {
            return Ok(whole(digest));
        }
        let key = (self.tenant.clone(), *digest, id.clone());
        let path = self.store.uploads.path(&key);
        if !path.exists() {
            return Ok(Committed { bytes: 0, complete: false });
        }
        let mut slot = self.store.uploads.slot(&key).lock_owned().await;
        let opened = tokio::task::spawn_blocking(move || slot.open(&path).map(|session| session.committed_bytes));
        let bytes = opened.await.map_err(crashed)?.map_err(|cause| disk_error("continue", cause))?;
        Ok(Committed { bytes, complete: false })
    }

    /// Appends a part. `complete` in the answer: the asset is stored, by this part or already before.
    pub async fn upload(&self, digest: &Digest, id: &UploadId, part: Part) -> Result<Committed> {
        self.check_size(digest)?;
        let key = (self.tenant.clone(), *digest, id.clone());
        let slot = self.store.uploads.slot(&key).lock_owned().await;
        // Looked up with the slot held: whoever finished the upload has given it back.
        if slot.is_none() && self.promote(digest).await? {
            self.store.uploads.forget(&key);
            return Ok(whole(digest));
        }
        self.store.make_room(part.data.len() as u64).await?;
        let (path, digest) = (self.store.uploads.path(&key), *digest);
        // The guard goes along: if this future is dropped, the part is still appended before anybody else.
        let appended = tokio::task::spawn_blocking(move || append(slot, &path, &digest, part));
        match appended.await.map_err(crashed)? {
            Ok(Appended { grown_bytes, committed_bytes, staged: None }) => {
                self.store.grow(grown_bytes);
                Ok(Committed { bytes: committed_bytes, complete: false })
            }
            Ok(Appended { grown_bytes, staged: Some(staged), .. }) => {
                self.store.grow(grown_bytes);
                self.settle(&key, &staged).await
            }
            Err(error) => {
                self.drop_if_wrong(&key, &error);
                Err(error)
            }
        }
    }

    async fn settle(&self, key: &Key, staged: &Staged) -> Result<Committed> {
        let target = names::asset(&self.tenant, Class::Upload, &key.1);
        let name = staged.path.file_name().unwrap_or_default().to_string_lossy();
        let from = object_store::path::Path::from(format!("staging/{name}"));
        let moved = self.store.rename(&from, &target).await;
        self.store.uploads.forget(key);
        moved.map(|()| whole(&key.1))
    }

    fn drop_if_wrong(&self, key: &Key, error: &Error) {
        if error.kind == ErrorKind::InvalidInput && error.field.as_deref() == Some("digest") {
            self.store.uploads.forget(key);
            self.store.shrink(key.1.size_bytes);
        }
    }
}

fn whole(digest: &Digest) -> Committed {
    Committed { bytes: digest.size_bytes, complete: true }
}

struct Appended {
    grown_bytes: u64,
    committed_bytes: u64,
    staged: Option<Staged>,
}

/// A whole, verified file. The guard keeps other writers out until it is renamed.
struct Staged {
    path: PathBuf,
    _slot: OwnedMutexGuard<Option<Session>>,
}

fn append(mut slot: OwnedMutexGuard<Option<Session>>, path: &Path, digest: &Digest, part: Part) -> Result<Appended> {
    let session = slot.open(path).map_err(|cause| disk_error("continue", cause))?;
    let fresh = session.fresh_part(digest, &part)?;
    let grown_bytes = fresh.len() as u64;
    session.write(&fresh).map_err(|cause| disk_error("write", cause))?;
    let committed_bytes = session.committed_bytes;
    if !part.finish {
        return Ok(Appended { grown_bytes, committed_bytes, staged: None });
    }
    if committed_bytes != digest.size_bytes {
        let size = digest.size_bytes;
        return Err(Error::invalid(
            "finish",
            format!("the upload has {committed_bytes} of {size} bytes; send the rest first"),
        ));
    }
    let path = slot.verify(digest)?;
    Ok(Appended { grown_bytes, committed_bytes, staged: Some(Staged { path, _slot: slot }) })
}

/// What can be done with the place of a session.
trait SessionSlot {
    fn open(&mut self, path: &Path) -> std::io::Result<&mut Session>;
    fn verify(&mut self, digest: &Digest) -> Result<PathBuf>;
}

impl SessionSlot for Option<Session> {
    fn open(&mut self, path: &Path) -> std::io::Result<&mut Session> {
        if self.is_none() {
            *self = Some(Session::open(path)?);
        }
        let session = self.as_mut().ok_or(std::io::ErrorKind::NotFound)?;
        session.last_use = Instant::now();
        Ok(session)
    }

    /// Ends the session: the file is the asset, or it is gone.
    fn verify(&mut self, digest: &Digest) -> Result<PathBuf> {
        let session = self.take().ok_or_else(|| Error::internal("the upload is not open"))?;
        let actual = Digest { hash: session.hasher.finalize().into(), size_bytes: session.committed_bytes };
        if actual != *digest {
            // Sent anew from 0, so a file that cannot be removed now is overwritten then.
            let _ = std::fs::remove_file(&session.path);
            return Err(mismatch(digest, &actual));
        }
        // Uploads survive a power cut; outputs need not, they can be computed again.
        session.file.sync_data().map_err(|cause| disk_error("write", cause))?;
        Ok(session.path)
    }
}

impl Session {
    /// Opens a staging file and hashes what is in it. A file that another process holds is left to it.
    fn open(path: &Path) -> std::io::Result<Self> {
        let mut path = path.to_owned();
        let options = || OpenOptions::new().create(true).read(true).append(true).clone();
        let mut file = options().open(&path)?;
        if file.try_lock().is_err() {
            path.as_mut_os_string().push(format!("+{}", uuid::Uuid::new_v4()));
            file = options().open(&path)?;
        }
        let (mut hasher, mut committed_bytes) = (Sha256::new(), 0);
        let mut block = vec![0; 1 << 20];
        loop {
            match file.read(&mut block)? {
                0 => break,
                count => {
                    hasher.update(&block[..count]);
                    committed_bytes += count as u64;
                }
            }
        }
        Ok(Self { path, file, hasher, committed_bytes, last_use: Instant::now() })
    }

    /// The bytes of a part that are new.
    fn fresh_part(&self, digest: &Digest, part: &Part) -> Result<Bytes> {
        let committed = self.committed_bytes;
        if part.offset_bytes > committed {
            let offset = part.offset_bytes;
            return Err(Error::invalid(
                "write_offset_bytes",
                format!("{offset} leaves a gap; continue at {committed}"),
            ));
        }
        let end = part.offset_bytes.saturating_add(part.data.len() as u64);
        if end > digest.size_bytes {
            let size = digest.size_bytes;
            return Err(Error::invalid("data", format!("the upload reaches byte {end} of an asset of {size} bytes")));
        }
        let known = (committed - part.offset_bytes).min(part.data.len() as u64);
        Ok(part.data.slice(known as usize..))
    }

    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        if let Err(error) = self.file.write_all(bytes) {
            // Part of the block may be in the file: cut it off, so that file and hash agree.
            self.file.set_len(self.committed_bytes)?;
            return Err(error);
        }
        self.hasher.update(bytes);
        self.committed_bytes += bytes.len() as u64;
        Ok(())
    }
}
