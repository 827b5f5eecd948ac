//! Reads assets in ranges, a chunk at a time, with the file held open so that eviction cannot cut a read.

use std::{
    fs::File,
    io::{Read as _, Seek as _, SeekFrom},
};

use bytes::Bytes;
use futures::{Stream, stream};
use object_store::{GetOptions, GetResultPayload, ObjectStore as _, path::Path};
use sha2::{Digest as _, Sha256};

use super::{TenantStore, crashed, disk_error, lost_or_disk, missing};
use crate::domain::{Digest, Error, Result};

/// Bytes of one chunk: long enough to be cheap, short enough to keep many reads in little memory.
pub const CHUNK_BYTES: u64 = 256 << 10;

/// A read under way.
pub struct Chunks {
    store: TenantStore,
    digest: Digest,
    path: Path,
    file: File,
    left_bytes: u64,
    /// Runs over reads of the whole asset only; a range cannot be checked.
    hasher: Option<Sha256>,
}

impl TenantStore {
    /// Starts a read of at most `limit_bytes` (0: all) from `offset_bytes`.
    pub async fn read(&self, digest: &Digest, offset_bytes: u64, limit_bytes: u64) -> Result<Chunks> {
        let left_bytes = length(digest, offset_bytes, limit_bytes)?;
        let (_, meta) = self.locate(digest).await?.ok_or_else(|| missing(digest))?;
        let got = self.store.disk.get_opts(&meta.location, GetOptions::default()).await;
        let GetResultPayload::File(mut file, _) = got.map_err(|cause| lost_or_disk(digest, cause))?.payload else {
            return Err(Error::internal("the store is not a folder"));
        };
        file.seek(SeekFrom::Start(offset_bytes)).map_err(|cause| disk_error("read", cause))?;
        let hasher = (left_bytes == digest.size_bytes).then(Sha256::new);
        Ok(Chunks { store: self.clone(), digest: *digest, path: meta.location, file, left_bytes, hasher })
    }
}

fn length(digest: &Digest, offset_bytes: u64, limit_bytes: u64) -> Result<u64> {
    let rest = digest.size_bytes.checked_sub(offset_bytes).ok_or_else(|| {
        let size = digest.size_bytes;
        Error::invalid("read_offset_bytes", format!("{offset_bytes} is beyond the end; allowed are 0 to {size}"))
    })?;
    Ok(if limit_bytes == 0 { rest } else { rest.min(limit_bytes) })
}

impl Chunks {
    /// The chunks in order. Damage found at the end of a whole read is the last item.
    pub fn into_stream(self) -> impl Stream<Item = Result<Bytes>> + Send + 'static {
        stream::unfold(Some(self), |chunks| async move {
            match chunks?.next().await {
                Ok(Some((bytes, rest))) => Some((Ok(bytes), Some(rest))),
                Ok(None) => None,
                Err(error) => Some((Err(error), None)),
            }
        })
    }

    async fn next(mut self) -> Result<Option<(Bytes, Self)>> {
        if self.left_bytes == 0 {
            return self.finish().await.map(|()| None);
        }
        let read = tokio::task::spawn_blocking(move || self.read_chunk().map(|bytes| (bytes, self)));
        let (bytes, rest) = read.await.map_err(crashed)?.map_err(|cause| disk_error("read", cause))?;
        if bytes.is_empty() {
            return Err(rest.store.quarantine(&rest.digest, &rest.path).await);
        }
        Ok(Some((bytes, rest)))
    }

    fn read_chunk(&mut self) -> std::io::Result<Bytes> {
        let wanted = self.left_bytes.min(CHUNK_BYTES) as usize;
        let mut bytes = vec![0; wanted];
        let count = self.file.read(&mut bytes)?;
        bytes.truncate(count);
        self.left_bytes -= count as u64;
        if let Some(hasher) = &mut self.hasher {
            hasher.update(&bytes);
        }
        Ok(bytes.into())
    }

    async fn finish(self) -> Result<()> {
        match self.hasher.map(|hasher| <[u8; 32]>::from(hasher.finalize())) {
            Some(hash) if hash != self.digest.hash => Err(self.store.quarantine(&self.digest, &self.path).await),
            _ => Ok(()),
        }
    }
}
