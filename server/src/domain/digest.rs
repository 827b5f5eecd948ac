//! Content address of an asset: SHA-256 and size, so that a truncated hash match is still refused.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::Error;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Digest {
    pub hash: [u8; 32],
    pub size_bytes: u64,
}

impl Digest {
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        Self { hash: Sha256::digest(bytes).into(), size_bytes: bytes.len() as u64 }
    }

    /// Lower-case hexadecimal hash, 64 characters.
    #[must_use]
    pub fn hex(&self) -> String {
        self.hash.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Resource name: `assets/sha256/{hash}/{size}`.
    #[must_use]
    pub fn resource_name(&self) -> String {
        format!("assets/sha256/{}/{}", self.hex(), self.size_bytes)
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.hex(), self.size_bytes)
    }
}

impl From<Digest> for String {
    fn from(digest: Digest) -> Self {
        digest.to_string()
    }
}

impl TryFrom<String> for Digest {
    type Error = Error;

    fn try_from(text: String) -> Result<Self, Error> {
        text.parse()
    }
}

impl FromStr for Digest {
    type Err = Error;

    /// Reads `HASH/SIZE` or a full resource name.
    fn from_str(text: &str) -> Result<Self, Error> {
        let bad = || {
            Error::invalid(
                "digest",
                format!("'{text}' is not 'HASH/SIZE' with 64 lower-case hexadecimal digits and a decimal size"),
            )
        };
        let text = text.strip_prefix("assets/sha256/").unwrap_or(text);
        let (hex, size) = text.split_once('/').ok_or_else(bad)?;
        if hex.len() != 64 || !hex.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f')) {
            return Err(bad());
        }
        let mut hash = [0; 32];
        for (byte, pair) in hash.iter_mut().zip(hex.as_bytes().chunks(2)) {
            let pair = std::str::from_utf8(pair).map_err(|_| bad())?;
            *byte = u8::from_str_radix(pair, 16).map_err(|_| bad())?;
        }
        Ok(Self { hash, size_bytes: size.parse().map_err(|_| bad())? })
    }
}
