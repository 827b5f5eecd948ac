//! Content-addressed assets and the index of results, in one folder.
//!
//! The disk is the truth: nothing is cached in memory that another process sharing the folder could make
//! wrong. Every write goes to a temporary file that is renamed when whole, so a killed process leaves no torn
//! asset. Tenants scope every path. Not here: what the bytes mean.
//!
//! ```text
//! t/TENANT/assets/HH/HASH-SIZE     uploads           staging/      unfinished uploads
//! t/TENANT/outputs/HH/HASH-SIZE    made by jobs      quarantine/   bytes that no longer match their name
//! t/TENANT/results/KK/KEY.json     result key -> report and outputs
//! ```

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, SystemTime},
};

use bytes::Bytes;
use futures::{StreamExt as _, TryStreamExt as _};
use object_store::{
    GetOptions, ObjectMeta, ObjectStore, ObjectStoreExt as _, PutPayload, local::LocalFileSystem, path::Path,
};

use crate::domain::{Digest, Error, ErrorKind, Result};

mod evict;
mod names;
mod read;
mod results;
mod upload;

pub use names::Tenant;
pub use read::{CHUNK_BYTES, Chunks};
pub use results::{StoredOutput, StoredResult};
pub use upload::{Committed, Part, UploadId};

use names::Origin as Class;
use upload::Uploads;

/// Where and how much.
#[derive(Clone, Debug)]
pub struct StoreOptions {
    pub root: PathBuf,
    /// Most bytes of all tenants together.
    pub limit_bytes: u64,
    pub max_asset_bytes: u64,
    /// What was used this recently is removed only if nothing else is left.
    pub keep: Duration,
    /// An unfinished upload untouched for this long is removed.
    pub upload_ttl: Duration,
}

/// All tenants' bytes.
#[derive(Debug)]
pub struct Store {
    disk: Arc<LocalFileSystem>,
    options: StoreOptions,
    /// Estimate: exact after every eviction, kept up by this process in between.
    used_bytes: AtomicU64,
    evicting: tokio::sync::Mutex<()>,
    uploads: Uploads,
}

/// What is stored under a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetInfo {
    pub digest: Digest,
    pub is_output: bool,
    pub last_use: SystemTime,
}

/// One tenant's view of the store.
#[derive(Clone, Debug)]
pub struct TenantStore {
    store: Arc<Store>,
    tenant: Tenant,
}

impl Store {
    /// Opens or makes the folder, and starts counting and tidying it in the background.
    pub async fn open(options: StoreOptions) -> Result<Arc<Self>> {
        let staging = options.root.join("staging");
        let made = tokio::fs::create_dir_all(&staging).await;
        made.map_err(|cause| cannot_open(&options.root, cause))?;
        let disk =
            LocalFileSystem::new_with_prefix(&options.root).map_err(|cause| cannot_open(&options.root, cause))?;
        let store = Arc::new(Self {
            disk: Arc::new(disk),
            uploads: Uploads::new(staging),
            options,
            used_bytes: AtomicU64::new(0),
            evicting: tokio::sync::Mutex::default(),
        });
        tokio::spawn(evict::keep_tidy(Arc::downgrade(&store)));
        Ok(store)
    }

    #[must_use]
    pub fn tenant(self: &Arc<Self>, tenant: Tenant) -> TenantStore {
        TenantStore { store: Arc::clone(self), tenant }
    }

    #[must_use]
    pub fn used_bytes(&self) -> u64 {
        self.used_bytes.load(Ordering::Relaxed)
    }

    #[must_use]
    pub fn options(&self) -> &StoreOptions {
        &self.options
    }

    fn grow(&self, bytes: u64) {
        self.used_bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    fn shrink(&self, bytes: u64) {
        let less = |used: u64| Some(used.saturating_sub(bytes));
        // Never fails: the closure always answers.
        let _ = self.used_bytes.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less);
    }

    async fn head(&self, path: &Path) -> Result<Option<ObjectMeta>> {
        match self.disk.head(path).await {
            Ok(meta) => Ok(Some(meta)),
            Err(object_store::Error::NotFound { .. }) => Ok(None),
            Err(cause) => Err(disk_error("look up", cause)),
        }
    }

    /// Marks a file as used now, which is what eviction goes by.
    async fn touch(&self, meta: &ObjectMeta) {
        let age = SystemTime::now().duration_since(meta.last_modified.into()).unwrap_or_default();
        let Ok(file) = self.disk.path_to_filesystem(&meta.location) else { return };
        if age > Duration::from_secs(1) {
            // A file that vanished meanwhile needs no mark.
            let _ =
                tokio::task::spawn_blocking(move || std::fs::File::open(file)?.set_modified(SystemTime::now())).await;
        }
    }
}

impl TenantStore {
    #[must_use]
    pub fn tenant(&self) -> &Tenant {
        &self.tenant
    }

    /// What is stored under a digest, and counts as a use of it.
    pub async fn info(&self, digest: &Digest) -> Result<AssetInfo> {
        let (class, meta) = self.locate(digest).await?.ok_or_else(|| missing(digest))?;
        Ok(AssetInfo { digest: *digest, is_output: class == Class::Output, last_use: meta.last_modified.into() })
    }

    /// Those that are not stored, in the order given.
    pub async fn missing(&self, digests: &[Digest]) -> Result<Vec<Digest>> {
        let look_up = |digest: Digest| async move {
            let place = self.locate(&digest).await;
            place.map(|place| place.is_none().then_some(digest))
        };
        let looked_up = futures::stream::iter(digests.to_vec()).map(look_up).buffered(16);
        let found: Vec<Option<Digest>> = looked_up.try_collect().await?;
        Ok(found.into_iter().flatten().collect())
    }

    /// Stores a small asset whose name the client claims.
    pub async fn put(&self, claimed: &Digest, bytes: Bytes) -> Result<()> {
        let actual = Digest::of(&bytes);
        if actual != *claimed {
            return Err(mismatch(claimed, &actual));
        }
        if self.promote(claimed).await? {
            return Ok(());
        }
        self.put_as(Class::Upload, &actual, bytes).await
    }

    /// Stores what a job made.
    pub async fn put_output(&self, bytes: Bytes) -> Result<Digest> {
        let hashed = bytes.clone();
        let digest = tokio::task::spawn_blocking(move || Digest::of(&hashed)).await.map_err(crashed)?;
        if self.locate(&digest).await?.is_none() {
            self.put_as(Class::Output, &digest, bytes).await?;
        }
        Ok(digest)
    }

    async fn put_as(&self, class: Class, digest: &Digest, bytes: Bytes) -> Result<()> {
        self.check_size(digest)?;
        self.store.make_room(digest.size_bytes).await?;
        let path = names::asset(&self.tenant, class, digest);
        self.store.disk.put(&path, PutPayload::from_bytes(bytes)).await.map_err(|cause| disk_error("write", cause))?;
        self.store.grow(digest.size_bytes);
        Ok(())
    }

    /// All bytes of an asset, checked against the digest.
    pub async fn get(&self, digest: &Digest) -> Result<Bytes> {
        let (_, meta) = self.locate(digest).await?.ok_or_else(|| missing(digest))?;
        let got = self.store.disk.get_opts(&meta.location, GetOptions::default()).await;
        let bytes = got.map_err(|cause| lost_or_disk(digest, cause))?.bytes().await;
        let bytes = bytes.map_err(|cause| lost_or_disk(digest, cause))?;
        let hashed = bytes.clone();
        let actual = tokio::task::spawn_blocking(move || Digest::of(&hashed)).await.map_err(crashed)?;
        if actual == *digest { Ok(bytes) } else { Err(self.quarantine(digest, &meta.location).await) }
    }

    /// A page of assets after `after`, in the order of digests.
    pub async fn list(&self, after: Option<&Digest>, count: usize) -> Result<Vec<AssetInfo>> {
        let mut found = Vec::new();
        for class in [Class::Upload, Class::Output] {
            let folder = names::folder(&self.tenant, class);
            let mut entries = self.store.disk.list(Some(&folder));
            while let Some(meta) = entries.try_next().await.map_err(|cause| disk_error("list", cause))? {
                let Some(digest) = names::digest_of(&meta.location) else { continue };
                if after.is_none_or(|after| digest > *after) {
                    let last_use = meta.last_modified.into();
                    found.push(AssetInfo { digest, is_output: class == Class::Output, last_use });
                }
            }
        }
        found.sort_by_key(|asset| (asset.digest, asset.is_output));
        found.dedup_by_key(|asset| asset.digest);
        found.truncate(count);
        Ok(found)
    }

    /// Whether there was something to remove.
    pub async fn delete(&self, digest: &Digest) -> Result<bool> {
        let mut deleted = false;
        for class in [Class::Upload, Class::Output] {
            let path = names::asset(&self.tenant, class, digest);
            if self.store.head(&path).await?.is_some() {
                deleted |= self.store.remove(&path, digest.size_bytes).await?;
            }
        }
        Ok(deleted)
    }

    /// Where an asset lies, if it is whole; marks it as used.
    async fn locate(&self, digest: &Digest) -> Result<Option<(Class, ObjectMeta)>> {
        for class in [Class::Upload, Class::Output] {
            let path = names::asset(&self.tenant, class, digest);
            let Some(meta) = self.store.head(&path).await? else { continue };
            if meta.size != digest.size_bytes {
                // Whoever needs it stores it again.
                let _logged = self.quarantine(digest, &path).await;
                continue;
            }
            self.store.touch(&meta).await;
            return Ok(Some((class, meta)));
        }
        Ok(None)
    }

    /// Whether the asset is stored already; an output that a client uploads is kept like an upload.
    async fn promote(&self, digest: &Digest) -> Result<bool> {
        let Some((class, meta)) = self.locate(digest).await? else { return Ok(false) };
        if class == Class::Output {
            self.store.rename(&meta.location, &names::asset(&self.tenant, Class::Upload, digest)).await?;
        }
        Ok(true)
    }

    fn check_size(&self, digest: &Digest) -> Result<()> {
        let limit = self.store.options.max_asset_bytes.min(self.store.options.limit_bytes);
        if digest.size_bytes <= limit {
            return Ok(());
        }
        let size = digest.size_bytes;
        Err(Error::too_large("digest.size_bytes", format!("an asset of {size} bytes is above the limit of {limit}")))
    }

    /// Puts damaged bytes out of the way, so that the asset can be stored again.
    async fn quarantine(&self, digest: &Digest, path: &Path) -> Error {
        let place = Path::from(format!("quarantine/{}-{}-{}", self.tenant, digest.hex(), digest.size_bytes));
        let moved = self.store.rename(path, &place).await;
        tracing::error!(%digest, tenant = %self.tenant, moved = moved.is_ok(), "stored bytes do not match their digest");
        let message =
            format!("the stored bytes of {digest} no longer match it and were put aside; upload or compute them again");
        Error::new(ErrorKind::DataLoss, message)
    }
}

fn missing(digest: &Digest) -> Error {
    Error::new(
        ErrorKind::Missing(vec![*digest]),
        format!("{} is not stored; upload it and call again", digest.resource_name()),
    )
}

fn mismatch(claimed: &Digest, actual: &Digest) -> Error {
    Error::invalid("digest", format!("the bytes are {actual}, not {claimed} as named; nothing was stored"))
}

fn cannot_open(root: &std::path::Path, cause: impl std::error::Error + Send + Sync + 'static) -> Error {
    Error::invalid("store", format!("cannot use the folder '{}': {cause}", root.display())).with_cause(cause)
}

fn disk_error(action: &str, cause: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
    Error::internal(format!("the store cannot {action} an asset")).with_cause(cause)
}

fn lost_or_disk(digest: &Digest, cause: object_store::Error) -> Error {
    match cause {
        object_store::Error::NotFound { .. } => missing(digest),
        cause => disk_error("read", cause),
    }
}

fn crashed(cause: tokio::task::JoinError) -> Error {
    Error::internal("a task of the store ended early").with_cause(cause)
}
