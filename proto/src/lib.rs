//! The `displace.v1` API: generated messages, clients and servers. Nothing is written by hand here;
//! the specification is the comments of `displace/v1/*.proto`.

/// Messages and services of package `displace.v1`.
#[allow(clippy::all, clippy::allow_attributes_without_reason, unreachable_pub, missing_docs, reason = "generated")]
pub mod v1 {
    tonic::include_proto!("displace.v1");
}

/// `google.rpc.Status` and the messages in its details.
pub use tonic_types::pb as rpc;

/// Encoded `FileDescriptorSet` of the API and all it imports, for reflection.
pub const FILE_DESCRIPTOR_SET: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/displace.v1.bin"));

/// Metadata that names the tenant of a call.
pub const TENANT_METADATA: &str = "displace-tenant";

/// `domain` of every `google.rpc.ErrorInfo`.
pub const ERROR_DOMAIN: &str = "displace";
