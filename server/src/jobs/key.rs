//! Result keys: what makes two jobs the same.

use std::fmt;

use sha2::{Digest as _, Sha256};

use super::Work;
use crate::store::Tenant;

/// Version of the program with the identity of its sources: results of another build are never reused.
pub const BUILD_ID: &str = concat!(env!("CARGO_PKG_VERSION"), "+", env!("DISPLACE_SOURCE_ID"));

/// SHA-256 of canonical request (input digests are in it), build, device class and tenant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ResultKey([u8; 32]);

impl ResultKey {
    #[must_use]
    pub fn of(work: &dyn Work, device_class: &str, tenant: &Tenant) -> Self {
        let mut hasher = Sha256::new();
        let tenant = tenant.to_string();
        let parts = [
            work.kind().as_bytes(),
            &work.canonical(),
            BUILD_ID.as_bytes(),
            device_class.as_bytes(),
            tenant.as_bytes(),
        ];
        for part in parts {
            // With its length, so that no two lists of parts read the same.
            hasher.update((part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
        Self(hasher.finalize().into())
    }

    /// 64 lower-case hexadecimal digits.
    #[must_use]
    pub fn hex(&self) -> String {
        self.0.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Short form for logs.
impl fmt::Display for ResultKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0[..6].iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
