//! Handlers of `displace.v1.Assets`.

use displace_proto::v1::{self, assets_server::Assets};
use futures::{StreamExt as _, stream::BoxStream};
use tokio::sync::OwnedSemaphorePermit;
use tonic::{Request, Response, Status, Streaming};

use super::{Services, convert, status::rpc_status, status::status, tenant};
use crate::{
    domain::{Digest, Error, ErrorKind, Result},
    store::{AssetInfo, Committed, Part, TenantStore, UploadId},
};

pub(super) struct AssetsService(pub(super) Services);

const MAX_DIGESTS: usize = 10_000;
const MAX_BLOBS: usize = 1000;
const MAX_PAGE: u32 = 1000;
const DEFAULT_PAGE: u32 = 100;

impl AssetsService {
    fn store<T>(&self, request: &Request<T>) -> Result<TenantStore> {
        Ok(self.0.store.tenant(tenant::of(request.metadata())?))
    }

    fn transfer(&self) -> Result<OwnedSemaphorePermit> {
        let limit = self.0.config.max_transfers;
        let busy = || {
            let message =
                format!("{limit} uploads and downloads run already, as many as are allowed; call again in 1 s");
            Error::new(ErrorKind::Busy { retry_secs: 1 }, message).with_field("max_transfers")
        };
        self.0.transfers.clone().try_acquire_owned().map_err(|_| busy())
    }

    async fn find_missing(&self, request: Request<v1::FindMissingRequest>) -> Result<v1::FindMissingResponse> {
        let store = self.store(&request)?;
        let digests = request.into_inner().digests;
        check_count("digests", digests.len(), MAX_DIGESTS)?;
        let parse = |(n, digest)| convert::digest(&format!("digests[{n}]"), Some(digest));
        let digests = digests.iter().enumerate().map(parse).collect::<Result<Vec<Digest>>>()?;
        let missing = store.missing(&digests).await?;
        Ok(v1::FindMissingResponse { missing: missing.iter().map(convert::to_digest).collect() })
    }

    async fn batch_write(&self, request: Request<v1::BatchWriteRequest>) -> Result<v1::BatchWriteResponse> {
        let store = self.store(&request)?;
        let blobs = request.into_inner().blobs;
        check_count("blobs", blobs.len(), MAX_BLOBS)?;
        let bytes: u64 = blobs.iter().map(|blob| blob.data.len() as u64).sum();
        let limit = self.0.config.max_batch_bytes;
        if bytes > limit {
            return Err(Error::invalid(
                "blobs",
                format!("{bytes} bytes are above the limit of {limit} for a batch; use Write"),
            ));
        }
        let mut entries = Vec::with_capacity(blobs.len());
        for (n, blob) in blobs.into_iter().enumerate() {
            let stored = match convert::digest(&format!("blobs[{n}].digest"), blob.digest.as_ref()) {
                Ok(digest) => store.put(&digest, blob.data).await,
                Err(error) => Err(error),
            };
            let status = stored.map_or_else(|error| rpc_status(&error), |()| displace_proto::rpc::Status::default());
            entries.push(v1::batch_write_response::Entry { digest: blob.digest, status: Some(status) });
        }
        Ok(v1::BatchWriteResponse { entries })
    }

    async fn write_part(&self, request: Request<v1::WritePartRequest>) -> Result<v1::WritePartResponse> {
        let store = self.store(&request)?;
        let part = request.into_inner();
        let (digest, id) = upload_name(&part.name, &part.upload_id)?;
        let part = Part { offset_bytes: part.write_offset_bytes, data: part.data, finish: part.finish };
        let Committed { bytes, complete } = store.upload(&digest, &id, part).await?;
        Ok(v1::WritePartResponse { committed_bytes: bytes, complete })
    }

    async fn query_write(&self, request: Request<v1::QueryWriteRequest>) -> Result<v1::QueryWriteResponse> {
        let store = self.store(&request)?;
        let request = request.into_inner();
        let (digest, id) = upload_name(&request.name, &request.upload_id)?;
        let Committed { bytes, complete } = store.query_upload(&digest, &id).await?;
        Ok(v1::QueryWriteResponse { committed_bytes: bytes, complete })
    }

    async fn list(&self, request: Request<v1::ListRequest>) -> Result<v1::ListResponse> {
        let store = self.store(&request)?;
        let request = request.into_inner();
        let size = match request.page_size {
            0 => DEFAULT_PAGE,
            size => size.min(MAX_PAGE),
        } as usize;
        let after = Some(request.page_token).filter(|token| !token.is_empty());
        let after = after.map(|token| name("page_token", &token)).transpose()?;
        let mut assets = store.list(after.as_ref(), size + 1).await?;
        let has_more = assets.len() > size;
        assets.truncate(size);
        let last = assets.last().filter(|_| has_more).map(|asset| asset.digest.resource_name());
        Ok(v1::ListResponse {
            assets: assets.iter().map(to_asset).collect(),
            next_page_token: last.unwrap_or_default(),
        })
    }
}

#[tonic::async_trait]
impl Assets for AssetsService {
    type ReadStream = BoxStream<'static, Result<v1::ReadResponse, Status>>;

    async fn find_missing(
        &self,
        request: Request<v1::FindMissingRequest>,
    ) -> Result<Response<v1::FindMissingResponse>, Status> {
        answer(self.find_missing(request).await)
    }

    async fn batch_write(
        &self,
        request: Request<v1::BatchWriteRequest>,
    ) -> Result<Response<v1::BatchWriteResponse>, Status> {
        answer(self.batch_write(request).await)
    }

    async fn write(
        &self,
        request: Request<Streaming<v1::WriteRequest>>,
    ) -> Result<Response<v1::WriteResponse>, Status> {
        let store = self.store(&request).map_err(|error| status(&error))?;
        let mut parts = request.into_inner();
        let mut upload: Option<(Digest, UploadId)> = None;
        let mut committed = Committed { bytes: 0, complete: false };
        // Taken with the first part: a silent stream must not keep others away.
        let mut transfer = None;
        while let Some(part) = next_part(&mut parts).await? {
            if transfer.is_none() {
                transfer = Some(self.transfer().map_err(|error| status(&error))?);
            }
            let (digest, id) = continued(&mut upload, &part).map_err(|error| status(&error))?;
            let part = Part { offset_bytes: part.write_offset_bytes, data: part.data, finish: part.finish };
            committed = store.upload(&digest, &id, part).await.map_err(|error| status(&error))?;
            if committed.complete {
                break;
            }
        }
        Ok(Response::new(v1::WriteResponse { committed_bytes: committed.bytes, complete: committed.complete }))
    }

    async fn write_part(
        &self,
        request: Request<v1::WritePartRequest>,
    ) -> Result<Response<v1::WritePartResponse>, Status> {
        answer(self.write_part(request).await)
    }

    async fn query_write(
        &self,
        request: Request<v1::QueryWriteRequest>,
    ) -> Result<Response<v1::QueryWriteResponse>, Status> {
        answer(self.query_write(request).await)
    }

    async fn read(&self, request: Request<v1::ReadRequest>) -> Result<Response<Self::ReadStream>, Status> {
        let store = self.store(&request).map_err(|error| status(&error))?;
        let transfer = self.transfer().map_err(|error| status(&error))?;
        let request = request.into_inner();
        let digest = name("name", &request.name).map_err(|error| status(&error))?;
        let (offset, limit) = (request.read_offset_bytes, request.read_limit_bytes);
        let chunks = store.read(&digest, offset, limit).await.map_err(|error| status(&error))?;
        let stream = chunks.into_stream().map(move |chunk| {
            // Held until the stream is dropped.
            let _ = &transfer;
            chunk.map(|data| v1::ReadResponse { data }).map_err(|error| status(&error))
        });
        Ok(Response::new(stream.boxed()))
    }

    async fn get(&self, request: Request<v1::GetRequest>) -> Result<Response<v1::GetResponse>, Status> {
        let info = async { self.store(&request)?.info(&name("name", &request.get_ref().name)?).await };
        answer(info.await.map(|info| v1::GetResponse { asset: Some(to_asset(&info)) }))
    }

    async fn list(&self, request: Request<v1::ListRequest>) -> Result<Response<v1::ListResponse>, Status> {
        answer(self.list(request).await)
    }

    async fn delete(&self, request: Request<v1::DeleteRequest>) -> Result<Response<v1::DeleteResponse>, Status> {
        let deleted = async { self.store(&request)?.delete(&name("name", &request.get_ref().name)?).await };
        answer(deleted.await.map(|deleted| v1::DeleteResponse { deleted }))
    }
}

fn answer<T>(result: Result<T>) -> Result<Response<T>, Status> {
    result.map(Response::new).map_err(|error| status(&error))
}

/// Name and id come with the first part; later ones may repeat the name.
fn continued(upload: &mut Option<(Digest, UploadId)>, part: &v1::WriteRequest) -> Result<(Digest, UploadId)> {
    match upload {
        None => Ok(upload.insert(upload_name(&part.name, &part.upload_id)?).clone()),
        Some(known) if part.name.is_empty() || name("name", &part.name)? == known.0 => Ok(known.clone()),
        Some(known) => {
            let first = known.0.resource_name();
            Err(Error::invalid(
                "name",
                format!("'{}' is not the name this stream began with, {first}", part.name.escape_default()),
            ))
        }
    }
}

fn upload_name(asset: &str, id: &str) -> Result<(Digest, UploadId)> {
    Ok((name("name", asset)?, id.parse()?))
}

fn name(field: &str, text: &str) -> Result<Digest> {
    let bad = || {
        let text = text.escape_default();
        Error::invalid(
            field,
            format!("'{text}' is not a name; write assets/sha256/HASH/SIZE with 64 lower-case hexadecimal digits"),
        )
    };
    let pair = text.strip_prefix("assets/sha256/").ok_or_else(bad)?;
    pair.parse().map_err(|_| bad())
}

fn check_count(field: &str, count: usize, most: usize) -> Result<()> {
    if (1..=most).contains(&count) {
        return Ok(());
    }
    Err(Error::invalid(field, format!("{count} entries; allowed are 1 to {most}")))
}

fn to_asset(info: &AssetInfo) -> v1::Asset {
    let origin = if info.is_output { v1::AssetOrigin::Output } else { v1::AssetOrigin::Upload };
    v1::Asset {
        name: info.digest.resource_name(),
        digest: Some(convert::to_digest(&info.digest)),
        origin: origin.into(),
        last_use_time: Some(info.last_use.into()),
    }
}

/// How long an upload may say nothing.
const SILENCE: std::time::Duration = std::time::Duration::from_secs(60);

async fn next_part(parts: &mut Streaming<v1::WriteRequest>) -> Result<Option<v1::WriteRequest>, Status> {
    tokio::time::timeout(SILENCE, parts.message()).await.unwrap_or_else(|_| {
        let message = format!("no part came for {} s; ask QueryWrite and go on", SILENCE.as_secs());
        Err(status(&Error::new(ErrorKind::Unavailable, message)))
    })
}
