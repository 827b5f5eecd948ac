//! The outer shell: GLB chunks or plain JSON, and data URIs.

use base64::{Engine as _, engine::general_purpose};
use bytes::Bytes;
use serde_json::Value;

use super::Limits;
use crate::domain::{Error, Result, report::Warning};

pub(super) struct Container {
    pub(super) document: Value,
    pub(super) bin: Option<Bytes>,
    pub(super) warnings: Vec<Warning>,
}

const HEADER_BYTES: usize = 12;
const CHUNK_JSON: u32 = 0x4e4f_534a;
const CHUNK_BIN: u32 = 0x004e_4942;

pub(super) fn split(bytes: &Bytes, limits: &Limits) -> Result<Container> {
    if bytes.starts_with(b"glTF") { glb(bytes, limits) } else { plain(bytes, limits) }
}

fn plain(bytes: &Bytes, limits: &Limits) -> Result<Container> {
    Ok(Container { document: parse(bytes, limits)?, bin: None, warnings: Vec::new() })
}

fn glb(bytes: &Bytes, limits: &Limits) -> Result<Container> {
    let word = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(bad(format!("the file ends within its header of {HEADER_BYTES} bytes; it has {}", bytes.len())));
    };
    if version != 2 {
        return Err(Error::unsupported("GLB", format!("version {version} is not read; give a version 2 file")));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(bad(format!("the header says {length} bytes and the file has {}: it is cut off", bytes.len())));
    }
    let mut warnings = Vec::new();
    if length < bytes.len() {
        let extra = bytes.len() - length;
        warnings
            .push(Warning::new("glb_trailing_bytes", format!("{extra} bytes after the end of the GLB were left out")));
    }
    chunks(&bytes.slice(..length), limits, warnings)
}

fn chunks(bytes: &Bytes, limits: &Limits, mut warnings: Vec<Warning>) -> Result<Container> {
    let mut json = None;
    let mut bin = None;
    let mut at = HEADER_BYTES;
    while at < bytes.len() {
        let (kind, chunk) = chunk(bytes, at)?;
        at += 8 + chunk.len();
        match kind {
            CHUNK_JSON if json.is_none() => json = Some(chunk),
            _ if json.is_none() => return Err(bad("the first chunk is not JSON")),
            CHUNK_BIN if bin.is_none() => bin = Some(chunk),
            CHUNK_JSON | CHUNK_BIN => {
                return Err(bad("a second chunk of one kind; a GLB has one JSON and at most one BIN chunk"));
            }
            other => {
                warnings.push(Warning::new("glb_unknown_chunk", format!("a chunk of kind {other:#010x} was left out")))
            }
        }
    }
    let json = json.ok_or_else(|| bad("has no JSON chunk"))?;
    Ok(Container { document: parse(&json, limits)?, bin, warnings })
}

fn chunk(bytes: &Bytes, at: usize) -> Result<(u32, Bytes)> {
    let head = bytes
        .get(at..at + 8)
        .ok_or_else(|| bad(format!("the chunk at byte {at} ends within its header of 8 bytes")))?;
    let word = |k: usize| u32::from_le_bytes([head[k], head[k + 1], head[k + 2], head[k + 3]]);
    let length = word(0) as usize;
    if !length.is_multiple_of(4) {
        return Err(bad(format!("the chunk at byte {at} has {length} bytes; lengths are multiples of 4")));
    }
    let start = at + 8;
    let end = start.checked_add(length).filter(|end| *end <= bytes.len());
    let end = end.ok_or_else(|| {
        bad(format!(
            "the chunk at byte {at} has {length} bytes and {} are left: the file is cut off",
            bytes.len() - start
        ))
    })?;
    Ok((word(4), bytes.slice(start..end)))
}

fn bad(message: impl Into<String>) -> Error {
    Error::invalid("GLB", message)
}

fn parse(json: &[u8], limits: &Limits) -> Result<Value> {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    if json.len() > limits.json_bytes {
        let message = format!(
            "the JSON has {} bytes; allowed are {}: move data to external buffers",
            json.len(),
            limits.json_bytes
        );
        return Err(Error::too_large("document", message));
    }
    // Each value follows one of these, so that their number bounds the memory of the parsed tree.
    let values = json.iter().filter(|b| matches!(b, b',' | b'[' | b'{')).count();
    if values > limits.json_values {
        let message = format!("the JSON has about {values} values; allowed are {}", limits.json_values);
        return Err(Error::too_large("document", message));
    }
    let document: Value = serde_json::from_slice(json)
        .map_err(|e| Error::invalid("document", format!("is neither a GLB nor glTF JSON ({e})")))?;
    if document.is_object() { Ok(document) } else { Err(Error::invalid("document", "the JSON is not an object")) }
}

/// Media type and bytes of a `data:` URI; `None` for any other URI.
pub(super) fn data_uri(uri: &str) -> Option<Result<(String, Bytes), String>> {
    let rest = uri.get(..5).filter(|scheme| scheme.eq_ignore_ascii_case("data:")).map(|_| &uri[5..])?;
    Some(data_parts(rest))
}

fn data_parts(rest: &str) -> Result<(String, Bytes), String> {
    let (head, body) = rest.split_once(',').ok_or("the data URI has no comma")?;
    let (head, is_base64) = head.strip_suffix(";base64").map_or((head, false), |head| (head, true));
    let mut parts = head.split(';');
    let media_type = parts.next().unwrap_or_default().to_owned();
    if parts.any(|parameter| !parameter.contains('=')) {
        return Err(format!("the data URI's media type '{head}' is malformed"));
    }
    if !is_base64 {
        return Ok((media_type, percent_encoding::percent_decode_str(body).collect::<Vec<u8>>().into()));
    }
    let indifferent = base64::engine::GeneralPurposeConfig::new()
        .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent);
    let engine = general_purpose::GeneralPurpose::new(&base64::alphabet::STANDARD, indifferent);
    let bytes = engine.decode(body).map_err(|e| format!("the data URI is not valid base64 ({e})"))?;
    Ok((media_type, bytes.into()))
}
