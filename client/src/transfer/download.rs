//! Reads an asset into a writer, going on where a broken stream stopped, and checks it against its digest.

use std::io::Write;

use displace_proto::v1::{Digest, ReadRequest};
use tonic::Status;

use super::{blob::Hasher, resource_name};
use crate::{
    connection::{Attempts, Connection, STREAM_DEADLINE, failure, is_transient, request},
    error::{Error, Kind, Result},
    output::{Bar, Progress, Target},
};

/// Downloads to a file that is replaced whole or not at all.
pub(crate) async fn download(
    connection: &Connection,
    digest: &Digest,
    target: &Target,
    progress: &Progress,
) -> Result<()> {
    let mut file = target.begin()?;
    to_writer(connection, digest, &mut file, progress).await?;
    file.finish()
}

/// Downloads to any writer; a writer that cannot take back what it got may end with a part of the asset.
pub(crate) async fn to_writer(
    connection: &Connection,
    digest: &Digest,
    writer: &mut dyn Write,
    progress: &Progress,
) -> Result<()> {
    let bar = progress.bytes("download", digest.size_bytes);
    let mut copy = Copy { writer, hasher: Hasher::default(), offset: 0, bar };
    let mut attempts = Attempts::default();
    while copy.offset < digest.size_bytes {
        let before = copy.offset;
        let outcome = copy.read_on(connection, digest).await;
        if copy.offset > before {
            attempts.reset();
        }
        match outcome {
            Ok(()) if copy.offset < digest.size_bytes => attempts.pause_or(ended_early(digest), None).await?,
            Ok(()) => {}
            Err(Stop::Here(error)) => return Err(error),
            Err(Stop::ReaderLeft) => return Ok(()),
            Err(Stop::There(status)) => match is_transient(&status) {
                Some(asked) => attempts.pause_or(failure(&status), asked).await?,
                None => return Err(failure(&status)),
            },
        }
    }
    let Copy { hasher, .. } = copy;
    if hasher.finish() == *digest { Ok(()) } else { Err(damaged(digest)) }
}

fn ended_early(digest: &Digest) -> Error {
    Error::new(Kind::DataLoss, format!("the server sent fewer bytes than {} has", resource_name(digest)))
}

fn damaged(digest: &Digest) -> Error {
    let message =
        format!("what arrived is not {}: its SHA-256 or size differ; run the command again", resource_name(digest));
    Error::new(Kind::DataLoss, message)
}

/// Which side ended a stream.
enum Stop {
    Here(Error),
    /// Whoever reads the pipe written to has enough: no fault.
    ReaderLeft,
    There(Box<Status>),
}

impl From<Status> for Stop {
    fn from(status: Status) -> Self {
        Self::There(Box::new(status))
    }
}

struct Copy<'w> {
    writer: &'w mut dyn Write,
    hasher: Hasher,
    offset: u64,
    bar: Bar,
}

impl Copy<'_> {
    /// One stream, from the offset reached to where it ends.
    async fn read_on(&mut self, connection: &Connection, digest: &Digest) -> Result<(), Stop> {
        let message = ReadRequest { name: resource_name(digest), read_offset_bytes: self.offset, read_limit_bytes: 0 };
        let mut parts = connection.assets().read(request(message, STREAM_DEADLINE)).await?.into_inner();
        while let Some(part) = parts.message().await? {
            let data = part.data;
            if self.offset + data.len() as u64 > digest.size_bytes {
                return Err(Stop::Here(damaged(digest)));
            }
            self.writer.write_all(&data).map_err(|e| unwritable(&e))?;
            self.hasher.update(&data);
            self.offset += data.len() as u64;
            self.bar.set(self.offset);
        }
        Ok(())
    }
}

fn unwritable(cause: &std::io::Error) -> Stop {
    match cause.kind() {
        std::io::ErrorKind::BrokenPipe => Stop::ReaderLeft,
        _ => Stop::Here(Error::new(Kind::Io, format!("the output cannot be written: {cause}"))),
    }
}
