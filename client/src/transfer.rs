//! Bytes to and from the server. The digest is the only proof that a transfer is whole; a broken stream
//! goes on at the offset reached.

mod blob;
mod download;
mod upload;

pub(crate) use blob::{Blob, Content, parse_name, resource_name};
pub(crate) use download::{download, to_writer};
pub(crate) use upload::{unary, upload};

/// Bytes in one message of a stream.
const CHUNK_BYTES: usize = 256 * 1024;
