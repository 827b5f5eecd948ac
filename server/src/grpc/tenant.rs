//! Whose call it is.

use displace_proto::TENANT_METADATA;
use tonic::metadata::MetadataMap;

use crate::{
    domain::{Error, Result},
    store::Tenant,
};

/// Reads `displace-tenant`; absent means `default`.
pub(super) fn of(metadata: &MetadataMap) -> Result<Tenant> {
    match metadata.get(TENANT_METADATA) {
        None => Ok(Tenant::default()),
        Some(name) => {
            name.to_str().map_err(|cause| Error::invalid(TENANT_METADATA, "is not text").with_cause(cause))?.parse()
        }
    }
}
