//! Uploads what the server does not have: small blobs together, others as a resumable stream.

use std::{
    collections::HashSet,
    fs::File,
    io::{Read, Seek, SeekFrom},
};

use bytes::Bytes;
use displace_proto::v1::{
    BatchWriteRequest, FindMissingRequest, QueryWriteRequest, QueryWriteResponse, WriteRequest,
    batch_write_request::Blob as BatchBlob,
};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Status;

use super::{Blob, CHUNK_BYTES, Content, resource_name};
use crate::{
    connection::{Attempts, CALL_DEADLINE, Connection, STREAM_DEADLINE, failure, is_transient, request},
    error::{Error, Result},
    output::Progress,
};

/// Blobs up to this size travel together.
const SMALL_BYTES: u64 = 256 * 1024;
/// Most bytes that travel together: well below any server's limit for a message.
const BATCH_BYTES: u64 = 1 << 20;
const BATCH_BLOBS: usize = 500;
const DIGESTS_PER_CALL: usize = 5_000;

/// Makes every blob present at the server.
pub(crate) async fn upload(connection: &Connection, blobs: &[Blob], progress: &Progress) -> Result<()> {
    let missing = find_missing(connection, blobs).await?;
    let bar = progress.bytes("upload", missing.iter().map(|blob| blob.digest.size_bytes).sum());
    let (small, large): (Vec<&Blob>, Vec<&Blob>) =
        missing.into_iter().partition(|blob| blob.digest.size_bytes <= SMALL_BYTES);
    for batch in batches(&small) {
        write_batch(connection, batch).await?;
        bar.advance(batch.iter().map(|blob| blob.digest.size_bytes).sum());
    }
    let mut done: u64 = small.iter().map(|blob| blob.digest.size_bytes).sum();
    for blob in large {
        write_stream(connection, blob, |sent| bar.set(done + sent)).await?;
        done += blob.digest.size_bytes;
    }
    Ok(())
}

/// Those that are not stored, each once.
async fn find_missing<'b>(connection: &Connection, blobs: &'b [Blob]) -> Result<Vec<&'b Blob>> {
    let mut seen = HashSet::new();
    let distinct: Vec<&Blob> = blobs.iter().filter(|blob| seen.insert(&blob.digest.hash)).collect();
    let mut missing = HashSet::new();
    for part in distinct.chunks(DIGESTS_PER_CALL) {
        let digests: Vec<_> = part.iter().map(|blob| blob.digest.clone()).collect();
        let answer = unary(|| {
            let message = FindMissingRequest { digests: digests.clone() };
            async move { connection.assets().find_missing(request(message, CALL_DEADLINE)).await }
        })
        .await?;
        missing.extend(answer.missing.into_iter().map(|digest| digest.hash));
    }
    Ok(distinct.into_iter().filter(|blob| missing.contains(&blob.digest.hash)).collect())
}

/// Cuts a list where the next blob would pass the limits.
fn batches<'s, 'b>(blobs: &'s [&'b Blob]) -> Vec<&'s [&'b Blob]> {
    let mut cuts = vec![0];
    let (mut bytes, mut count) = (0, 0);
    for (index, blob) in blobs.iter().enumerate() {
        let size = blob.digest.size_bytes;
        if count > 0 && (bytes + size > BATCH_BYTES || count == BATCH_BLOBS) {
            cuts.push(index);
            (bytes, count) = (0, 0);
        }
        bytes += size;
        count += 1;
    }
    cuts.push(blobs.len());
    cuts.windows(2).map(|cut| &blobs[cut[0]..cut[1]]).filter(|batch| !batch.is_empty()).collect()
}

async fn write_batch(connection: &Connection, batch: &[&Blob]) -> Result<()> {
    let mut blobs = Vec::with_capacity(batch.len());
    for blob in batch {
        blobs.push(BatchBlob { digest: Some(blob.digest.clone()), data: blob.bytes()? });
    }
    let answer = unary(|| {
        let message = BatchWriteRequest { blobs: blobs.clone() };
        async move { connection.assets().batch_write(request(message, CALL_DEADLINE)).await }
    })
    .await?;
    for (entry, blob) in answer.entries.into_iter().zip(batch) {
        if let Some(status) = entry.status.filter(|status| status.code != 0) {
            return Err(told_of(blob, failure(&crate::jobs::status_of(&status))));
        }
    }
    Ok(())
}

/// Sends one blob, going on where a broken stream stopped.
async fn write_stream(connection: &Connection, blob: &Blob, sent: impl Fn(u64)) -> Result<()> {
    let mut attempts = Attempts::default();
    let mut reached = 0;
    loop {
        let state = query(connection, blob).await?;
        sent(state.committed_bytes);
        if state.complete {
            return Ok(());
        }
        if state.committed_bytes > reached {
            attempts.reset();
        }
        reached = state.committed_bytes;
        match write_from(connection, blob, reached, &sent).await {
            Ok(true) => return Ok(()),
            Ok(false) => attempts.pause_or(Error::internal("the server did not finish the upload"), None).await?,
            Err(Stop::Here(error)) => return Err(error),
            Err(Stop::There(status)) => {
                let error = told_of(blob, failure(&status));
                match is_transient(&status) {
                    Some(asked) => attempts.pause_or(error, asked).await?,
                    None => return Err(error),
                }
            }
        }
    }
}

async fn query(connection: &Connection, blob: &Blob) -> Result<QueryWriteResponse> {
    let name = resource_name(&blob.digest);
    unary(|| {
        let message = QueryWriteRequest { name: name.clone(), ..QueryWriteRequest::default() };
        async move { connection.assets().query_write(request(message, CALL_DEADLINE)).await }
    })
    .await
}

/// Which side ended a stream.
enum Stop {
    Here(Error),
    There(Box<Status>),
}

/// One stream from an offset to the end. True when the server has it all, which it may say early.
async fn write_from(connection: &Connection, blob: &Blob, offset: u64, sent: &impl Fn(u64)) -> Result<bool, Stop> {
    let (messages, outgoing) = mpsc::channel(4);
    let (told, mut offsets) = mpsc::unbounded_channel();
    let source = blob.clone();
    let reader = tokio::task::spawn_blocking(move || send_parts(&source, offset, &messages, &told));
    let mut assets = connection.assets();
    let call = assets.write(request(ReceiverStream::new(outgoing), STREAM_DEADLINE));
    tokio::pin!(call);
    let answer = loop {
        tokio::select! {
            answer = &mut call => break answer,
            Some(offset) = offsets.recv() => sent(offset),
        }
    };
    // Ends with the stream: its channel is closed.
    let read = reader.await.map_err(|_| Stop::Here(Error::internal("the file reader stopped")))?;
    match (answer, read) {
        (Ok(answer), _) if answer.get_ref().complete => Ok(true),
        (_, Err(error)) => Err(Stop::Here(error)),
        (Ok(_), Ok(())) => Ok(false),
        (Err(status), Ok(())) => Err(Stop::There(Box::new(status))),
    }
}

/// Reads the content and hands it over in parts. Stops without a fault when nobody takes them any more.
fn send_parts(
    blob: &Blob,
    offset: u64,
    messages: &mpsc::Sender<WriteRequest>,
    told: &mpsc::UnboundedSender<u64>,
) -> Result<()> {
    let name = resource_name(&blob.digest);
    let mut parts = Parts::open(blob, offset)?;
    let mut write_offset_bytes = offset;
    let mut first = true;
    loop {
        let data = parts.next()?;
        let finish = data.len() < CHUNK_BYTES;
        let length = data.len() as u64;
        let name = if first { name.clone() } else { String::new() };
        let message = WriteRequest { name, upload_id: String::new(), write_offset_bytes, data, finish };
        if messages.blocking_send(message).is_err() || finish {
            return Ok(());
        }
        first = false;
        write_offset_bytes += length;
        let _ = told.send(write_offset_bytes);
    }
}

/// Content piece by piece.
enum Parts<'b> {
    File { file: File, blob: &'b Blob },
    Bytes(Bytes),
}

impl<'b> Parts<'b> {
    fn open(blob: &'b Blob, offset: u64) -> Result<Self> {
        match &blob.content {
            Content::Bytes(bytes) => {
                Ok(Self::Bytes(bytes.slice(usize::try_from(offset).unwrap_or(bytes.len()).min(bytes.len())..)))
            }
            Content::File(path) => {
                let failed = |e: std::io::Error| Error::reading(path, &e);
                let mut file = File::open(path).map_err(failed)?;
                file.seek(SeekFrom::Start(offset)).map_err(failed)?;
                Ok(Self::File { file, blob })
            }
        }
    }

    /// The next part; shorter than a whole one, perhaps empty, at the end.
    fn next(&mut self) -> Result<Bytes> {
        match self {
            Self::Bytes(rest) => Ok(rest.split_to(rest.len().min(CHUNK_BYTES))),
            Self::File { file, blob } => {
                let mut part = Vec::with_capacity(CHUNK_BYTES);
                file.take(CHUNK_BYTES as u64)
                    .read_to_end(&mut part)
                    .map_err(|e| Error::reading(blob.label.as_ref(), &e))?;
                Ok(part.into())
            }
        }
    }
}

/// Repeats a call while the connection or the server is not up to it.
pub(crate) async fn unary<T, F>(mut call: impl FnMut() -> F) -> Result<T>
where
    F: Future<Output = Result<tonic::Response<T>, Status>>,
{
    let mut attempts = Attempts::default();
    loop {
        match call().await {
            Ok(answer) => return Ok(answer.into_inner()),
            Err(status) => match is_transient(&status) {
                Some(asked) => attempts.pause_or(failure(&status), asked).await?,
                None => return Err(failure(&status)),
            },
        }
    }
}

fn told_of(blob: &Blob, error: Error) -> Error {
    Error { message: format!("{} (while uploading {})", error.message, blob.label), ..error }
}

#[cfg(test)]
mod tests {
    use displace_proto::v1::Digest;

    use super::*;

    fn blob(size_bytes: u64) -> Blob {
        Blob { digest: Digest { hash: size_bytes.to_string(), size_bytes }, ..Blob::of_bytes("b", "") }
    }

    #[test]
    fn batches_keep_to_the_limit_and_lose_nothing() {
        let blobs: Vec<Blob> = [600_000, 400_000, 100_000, 1_000_000, 900_000].into_iter().map(blob).collect();
        let blobs: Vec<&Blob> = blobs.iter().collect();
        let sizes: Vec<usize> = batches(&blobs).into_iter().map(<[_]>::len).collect();
        assert_eq!(sizes, [2, 1, 1, 1]);
        assert!(batches(&[]).is_empty());
    }

    #[test]
    fn parts_start_at_an_offset_and_end_with_a_short_one() {
        let content = vec![7; CHUNK_BYTES * 2 + 5];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f");
        std::fs::write(&path, &content).unwrap();
        for blob in [Blob::of_bytes("b", content.clone()), Blob::of_file(&path).unwrap()] {
            let mut parts = Parts::open(&blob, 5).unwrap();
            let lengths: Vec<usize> = (0..3).map(|_| parts.next().unwrap().len()).collect();
            assert_eq!(lengths, [CHUNK_BYTES, CHUNK_BYTES, 0]);
        }
    }
}
