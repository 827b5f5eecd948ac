//! EXT_meshopt_compression (Khronos registry, 2020), read: every compressed buffer view becomes a plain one over a
//! buffer of its own, before anything else looks at the document. KHR_meshopt_compression says the same with the same
//! words and one more filter.

mod packed;

use std::collections::{HashMap, HashSet};

use bytes::Bytes;
use serde_json::{Value, json};

use self::packed::Packed;
use super::{Limits, Resources, json::At, source};
use crate::domain::{Error, Result, report::Warning};

pub(super) const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Where decoded bytes are found: no file has such a name.
const SCHEME: &str = "decoded://bufferViews/";

/// Decoded bytes by the URIs of the buffers that hold them now.
#[derive(Default)]
pub(super) struct Decoded(HashMap<String, Bytes>);

impl Decoded {
    pub(super) fn find(&self, uri: &str) -> Option<Bytes> {
        self.0.get(uri).cloned()
    }

    pub(super) fn bytes(&self) -> u64 {
        self.0.values().map(|bytes| bytes.len() as u64).sum()
    }
}

/// Decodes what is compressed and takes the extension out of the document.
pub(super) fn decode_all(
    document: &mut Value,
    bin: Option<&Bytes>,
    resources: &Resources<'_>,
    limits: &Limits,
    warnings: &mut Vec<Warning>,
) -> Result<Decoded> {
    let mut decoded = Decoded::default();
    let root = At::root(document);
    let views: Vec<(usize, Bytes)> = {
        let mut buffers = Buffers { list: root.list("buffers")?, read: HashMap::new(), bin, resources };
        let mut left = limits.decoded_bytes;
        let mut views = Vec::new();
        for (i, view) in root.list("bufferViews")?.iter().enumerate() {
            if let Some(packed) = extension(view) {
                let packed = Packed::read(view, &packed, &mut buffers)?;
                // Twice, for what they are turned into and from.
                left = left.checked_sub(2 * packed.bytes() as u64).ok_or_else(|| too_large(view))?;
                views.push((i, packed.decode()?));
            }
        }
        views
    };
    let plain = plain_buffers(&root)?;
    if !views.is_empty() {
        let message = format!(
            "{} compressed buffer views were decoded; what of them passes through is written uncompressed",
            views.len()
        );
        warnings.push(Warning::new("compression_dropped", message));
    }
    let first = root.count("buffers")?;
    for (buffer, (view, bytes)) in (first..).zip(views) {
        let uri = format!("{SCHEME}{view}");
        point_at(&mut document["bufferViews"][view], buffer, bytes.len());
        if let Some(buffers) = document["buffers"].as_array_mut() {
            buffers.push(json!({ "byteLength": bytes.len(), "uri": uri }));
        }
        decoded.0.insert(uri, bytes);
    }
    forget(document, &plain, &mut decoded);
    Ok(decoded)
}

fn too_large(view: &At<'_>) -> Error {
    Error::too_large(&view.path, "its decoded bytes exceed the limit for one file: split the file")
}

pub(super) fn extension<'a>(at: &At<'a>) -> Option<At<'a>> {
    NAMES.iter().find_map(|name| at.extension(name))
}

fn point_at(view: &mut Value, buffer: usize, bytes: usize) {
    view["buffer"] = buffer.into();
    view["byteOffset"] = 0.into();
    view["byteLength"] = bytes.into();
    remove_extension(view);
}

fn remove_extension(value: &mut Value) {
    if let Some(extensions) = value.get_mut("extensions").and_then(Value::as_object_mut) {
        NAMES.iter().for_each(|name| {
            extensions.remove(*name);
        });
        if extensions.is_empty() {
            value.as_object_mut().map(|object| object.remove("extensions"));
        }
    }
}

/// The buffers of views that are not compressed.
fn plain_buffers(root: &At<'_>) -> Result<HashSet<u64>> {
    let views = root.list("bufferViews")?;
    let plain = views.iter().filter(|view| extension(view).is_none());
    Ok(plain.filter_map(|view| view.whole("buffer").ok().flatten()).collect())
}

/// The names of the extension, and the buffers that stand in for what it compressed and are of no use now.
fn forget(document: &mut Value, plain: &HashSet<u64>, decoded: &mut Decoded) {
    for list in ["extensionsUsed", "extensionsRequired"] {
        if let Some(names) = document.get_mut(list).and_then(Value::as_array_mut) {
            names.retain(|name| !name.as_str().is_some_and(|name| NAMES.contains(&name)));
            if names.is_empty() {
                document.as_object_mut().map(|object| object.remove(list));
            }
        }
    }
    let uri = format!("{SCHEME}none");
    let buffers = document.get_mut("buffers").and_then(Value::as_array_mut);
    for (i, buffer) in (0..).zip(buffers.into_iter().flatten()) {
        let stands_in = NAMES.iter().any(|name| buffer["extensions"][name]["fallback"] == true);
        remove_extension(buffer);
        if stands_in && !plain.contains(&i) {
            *buffer = json!({ "byteLength": 1, "uri": uri });
        }
    }
    decoded.0.insert(uri, Bytes::from_static(&[0]));
}

/// Buffers that hold compressed bytes, each read once.
struct Buffers<'a> {
    list: Vec<At<'a>>,
    read: HashMap<usize, Bytes>,
    bin: Option<&'a Bytes>,
    resources: &'a Resources<'a>,
}

impl Buffers<'_> {
    fn read(&mut self, at: &At<'_>) -> Result<Bytes> {
        let buffer = at.index_here(self.list.len(), "buffers")?;
        if let Some(known) = self.read.get(&buffer) {
            return Ok(known.clone());
        }
        let bytes = source::buffer(&self.list[buffer], self.bin.filter(|_| buffer == 0), self.resources)?;
        self.read.insert(buffer, bytes.clone());
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests;
