//! Where things lie in the store, and whose they are.

use std::{fmt, str::FromStr, sync::Arc};

use object_store::path::Path;

use crate::domain::{Digest, Error, Result};

/// Scope of assets and result keys: 1 to 63 of `a-z 0-9 - _`, first a letter or digit. Checked once, here,
/// because it becomes a folder.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tenant(Arc<str>);

impl Default for Tenant {
    fn default() -> Self {
        Self("default".into())
    }
}

impl FromStr for Tenant {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let plain = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit();
        let all = name.bytes().all(|byte| plain(byte) || matches!(byte, b'-' | b'_'));
        if all && name.len() <= 63 && name.bytes().next().is_some_and(plain) {
            return Ok(Self(name.into()));
        }
        let rule = "allowed are 1 to 63 of a-z, 0-9, '-' and '_', first a letter or digit";
        Err(Error::invalid("displace-tenant", format!("'{}' is not a tenant; {rule}", name.escape_default())))
    }
}

impl fmt::Display for Tenant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// What a file in a tenant's folder is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    Upload,
    Output,
}

pub(super) fn folder(tenant: &Tenant, origin: Origin) -> Path {
    let kind = match origin {
        Origin::Upload => "assets",
        Origin::Output => "outputs",
    };
    Path::from(format!("t/{tenant}/{kind}"))
}

pub(super) fn asset(tenant: &Tenant, origin: Origin, digest: &Digest) -> Path {
    let hex = digest.hex();
    Path::from(format!("{}/{}/{hex}-{}", folder(tenant, origin), &hex[..2], digest.size_bytes))
}

pub(super) fn result(tenant: &Tenant, key_hex: &str) -> Path {
    let shard = key_hex.get(..2).unwrap_or("00");
    Path::from(format!("t/{tenant}/results/{shard}/{key_hex}.json"))
}

/// Whether eviction may take it before any upload.
pub(super) fn is_made_by_jobs(path: &Path) -> bool {
    path.parts().nth(2).is_some_and(|part| matches!(part.as_ref(), "outputs" | "results"))
}

/// Reads the digest back from an asset's path.
pub(super) fn digest_of(path: &Path) -> Option<Digest> {
    let (hex, size) = path.filename()?.split_once('-')?;
    format!("{hex}/{size}").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tenants_cannot_leave_their_folder() {
        for bad in ["", "..", "a/b", "A", "-a", "a b", "ä", &"a".repeat(64)] {
            assert!(bad.parse::<Tenant>().is_err(), "{bad}");
        }
        assert_eq!("studio-7".parse::<Tenant>().unwrap().to_string(), "studio-7");
    }

    #[test]
    fn paths_of_assets_read_back() {
        let digest = Digest::of(b"bytes");
        let path = asset(&Tenant::default(), Origin::Output, &digest);
        assert_eq!(digest_of(&path), Some(digest));
        assert!(is_made_by_jobs(&path));
        assert!(!is_made_by_jobs(&asset(&Tenant::default(), Origin::Upload, &digest)));
    }
}
