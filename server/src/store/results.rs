//! The index of results: result key -> report and outputs.

use object_store::{GetOptions, ObjectStore as _, ObjectStoreExt as _};
use serde::{Deserialize, Serialize};

use super::{TenantStore, disk_error, names};
use crate::domain::{Digest, Result, report::Report};

/// What a finished job left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredResult {
    pub report: Report,
    pub outputs: Vec<StoredOutput>,
}

/// One asset a job made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoredOutput {
    /// With the file ending of its type: `mesh.glb`.
    pub name: String,
    pub media_type: String,
    pub digest: Digest,
}

impl TenantStore {
    /// The result under a key, if all its outputs are still stored.
    pub async fn result(&self, key_hex: &str) -> Result<Option<StoredResult>> {
        let path = names::result(&self.tenant, key_hex);
        let got = match self.store.disk.get_opts(&path, GetOptions::default()).await {
            Ok(got) => got,
            Err(object_store::Error::NotFound { .. }) => return Ok(None),
            Err(cause) => return Err(disk_error("look up", cause)),
        };
        let meta = got.meta.clone();
        let text = got.bytes().await.map_err(|cause| disk_error("read", cause))?;
        // An entry written by another version is a miss, not an error.
        let Ok(result) = serde_json::from_slice::<StoredResult>(&text) else { return Ok(None) };
        let digests: Vec<Digest> = result.outputs.iter().map(|output| output.digest).collect();
        if !self.missing(&digests).await?.is_empty() {
            return Ok(None);
        }
        self.store.touch(&meta).await;
        Ok(Some(result))
    }

    pub async fn put_result(&self, key_hex: &str, result: &StoredResult) -> Result<()> {
        let text = serde_json::to_vec(result).map_err(|cause| disk_error("describe", cause))?;
        let size_bytes = text.len() as u64;
        self.store.make_room(size_bytes).await?;
        let path = names::result(&self.tenant, key_hex);
        self.store.disk.put(&path, text.into()).await.map_err(|cause| disk_error("write", cause))?;
        self.store.grow(size_bytes);
        Ok(())
    }
}
