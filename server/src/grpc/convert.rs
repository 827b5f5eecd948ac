//! Between the messages of `displace.v1` and the words of the domain. Ranges are checked here, once, with the
//! path of the field in the error; inside the server nobody checks again.

mod chart;
mod choice;
mod description;
mod details;
mod geometry;
mod look;
mod measurement;
mod relief;
mod request;
mod sequence;
mod stability;
mod tolerance;
mod update;
mod view;

pub(super) use chart::chart;
pub(super) use description::to_description;
pub(super) use request::{compare, displace, estimate, measure, mesh_source, render};
pub(super) use sequence::sequence;
pub(super) use update::{to_estimate, to_update};
pub(super) use view::MAX_VIEWS;

use displace_proto::v1;

use crate::domain::{Digest, Error, Result};

/// `prefix.field`, or `field` at the top.
fn join(prefix: &str, field: &str) -> String {
    if prefix.is_empty() { field.into() } else { format!("{prefix}.{field}") }
}

pub(super) fn digest(field: &str, digest: Option<&v1::Digest>) -> Result<Digest> {
    let digest = digest.ok_or_else(|| Error::invalid(field, "is required; name an asset by hash and size"))?;
    let parsed = format!("{}/{}", digest.hash, digest.size_bytes).parse();
    parsed.map_err(|_| {
        let hash = digest.hash.escape_default();
        Error::invalid(
            join(field, "hash"),
            format!("'{hash}' is not a SHA-256; write 64 lower-case hexadecimal digits"),
        )
    })
}

pub(super) fn to_digest(digest: &Digest) -> v1::Digest {
    v1::Digest { hash: digest.hex(), size_bytes: digest.size_bytes }
}

/// Three finite components.
fn vector(field: &str, components: &[f32]) -> Result<[f32; 3]> {
    let count = components.len();
    let vector: [f32; 3] =
        components.try_into().map_err(|_| Error::invalid(field, format!("has {count} components; allowed are 3")))?;
    for (axis, value) in vector.iter().enumerate() {
        finite(&format!("{field}[{axis}]"), *value)?;
    }
    Ok(vector)
}

fn finite(field: &str, value: f32) -> Result<f32> {
    if value.is_finite() { Ok(value) } else { Err(Error::invalid(field, format!("{value} is not a finite number"))) }
}

fn within(field: &str, value: f32, least: f32, most: f32) -> Result<f32> {
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    Err(Error::invalid(field, format!("{value} is out of range; allowed are {least} to {most}")))
}

fn at_most(field: &str, value: u32, least: u32, most: u32) -> Result<u32> {
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    Err(Error::invalid(field, format!("{value} is out of range; allowed are {least} to {most}: take one of these")))
}

/// An enum of the API; a number that this version does not know is an error, not a default.
fn known<E: TryFrom<i32>>(field: &str, value: i32) -> Result<E> {
    E::try_from(value).map_err(|_| Error::unsupported(field, format!("{value} is not a value this version knows")))
}
