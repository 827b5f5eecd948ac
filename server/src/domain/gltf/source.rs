//! The bytes behind a document: buffers, buffer views and accessors, every range checked on opening.

use std::cell::{Cell, RefCell};

use bytes::Bytes;

use super::{Limits, Resources, accessor::Accessor, container::data_uri, json::At};
use crate::domain::{Error, Result, report::Warning};

pub(super) struct Source<'a> {
    pub(super) root: At<'a>,
    pub(super) views: Vec<View>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) quantized: bool,
    buffers: Vec<Bytes>,
    decodable_bytes: Cell<u64>,
    warnings: RefCell<Vec<Warning>>,
}

pub(super) struct View {
    pub(super) bytes: Bytes,
    pub(super) stride: Option<usize>,
}

impl<'a> Source<'a> {
    pub(super) fn open(root: &At<'a>, bin: Option<Bytes>, resources: &Resources<'_>, limits: &Limits) -> Result<Self> {
        let buffers: Vec<Bytes> = root
            .list("buffers")?
            .iter()
            .enumerate()
            .map(|(i, at)| buffer(at, bin.as_ref().filter(|_| i == 0), resources))
            .collect::<Result<_>>()?;
        let views: Vec<View> = root.list("bufferViews")?.iter().map(|at| view(at, &buffers)).collect::<Result<_>>()?;
        let accessors = root.list("accessors")?;
        let accessors = accessors.iter().map(|at| Accessor::read(at, &views)).collect::<Result<_>>()?;
        let used = root.list("extensionsUsed")?;
        Ok(Self {
            root: root.clone(),
            quantized: used.iter().any(|e| e.value.as_str() == Some("KHR_mesh_quantization")),
            views,
            accessors,
            buffers,
            decodable_bytes: Cell::new(limits.decoded_bytes),
            warnings: RefCell::default(),
        })
    }

    /// Takes `bytes` off what may still be decoded; called before allocating them.
    pub(super) fn charge(&self, path: &str, bytes: u64) -> Result<()> {
        let left = self.decodable_bytes.get().checked_sub(bytes).ok_or_else(|| {
            Error::too_large(
                path,
                format!("decoding {bytes} more bytes exceeds the limit for one file: split the file"),
            )
        })?;
        self.decodable_bytes.set(left);
        Ok(())
    }

    pub(super) fn warn(&self, code: &str, message: impl Into<String>) {
        self.warnings.borrow_mut().push(Warning::new(code, message));
    }

    pub(super) fn take_warnings(&self) -> Vec<Warning> {
        self.warnings.take()
    }

    /// The accessor that `at` is the index of.
    pub(super) fn accessor(&self, at: &At<'_>) -> Result<&Accessor> {
        Ok(&self.accessors[at.index_here(self.accessors.len(), "accessors")?])
    }

    /// Whether node `node`, which exists, has this key.
    pub(super) fn has_in_node(&self, node: usize, key: &str) -> bool {
        self.root.value["nodes"][node].get(key).is_some()
    }

    pub(super) fn into_buffers(self) -> Vec<Bytes> {
        self.buffers
    }
}

pub(super) fn buffer(at: &At<'_>, bin: Option<&Bytes>, resources: &Resources<'_>) -> Result<Bytes> {
    let length = at.need_whole("byteLength")?;
    let bytes = match at.get("uri") {
        Some(uri) => external(&uri, resources)?,
        None => bin.cloned().ok_or_else(|| at.error("has no uri, and the file no BIN chunk for it"))?,
    };
    match usize::try_from(length).ok().filter(|n| (1..=bytes.len()).contains(n)) {
        Some(length) => Ok(bytes.slice(..length)),
        None => Err(at.error(format!("byteLength is {length} and the data has {} bytes", bytes.len()))),
    }
}

/// The bytes of a buffer or image named by a URI.
pub(super) fn external(uri: &At<'_>, resources: &Resources<'_>) -> Result<Bytes> {
    let text = uri.text_here()?;
    match data_uri(text) {
        Some(data) => data.map(|(_, bytes)| bytes).map_err(|message| uri.error(message)),
        None => find(text, resources).ok_or_else(|| {
            uri.error(format!("the file '{text}' was not given: upload it and name it in `resources` by this URI"))
        }),
    }
}

/// Looks a URI up as it is written and with percent signs decoded.
pub(super) fn find(uri: &str, resources: &Resources<'_>) -> Option<Bytes> {
    resources(uri).or_else(|| {
        let decoded = percent_encoding::percent_decode_str(uri).decode_utf8().ok()?;
        if decoded == uri { None } else { resources(&decoded) }
    })
}

fn view(at: &At<'_>, buffers: &[Bytes]) -> Result<View> {
    let buffer = &buffers[at.need("buffer")?.index_here(buffers.len(), "buffers")?];
    let offset = at.whole("byteOffset")?.unwrap_or(0);
    let length = at.need_whole("byteLength")?;
    let end = offset.checked_add(length).filter(|end| length > 0 && *end <= buffer.len() as u64);
    let end =
        end.ok_or_else(|| at.error(format!("bytes {offset} + {length} do not lie in the buffer's {}", buffer.len())))?;
    let stride = at.whole("byteStride")?;
    if let Some(stride) = stride.filter(|s| !(4..=252).contains(s) || s % 4 != 0) {
        return Err(at.error(format!("byteStride {stride} is not a multiple of 4 from 4 to 252")));
    }
    Ok(View { bytes: buffer.slice(offset as usize..end as usize), stride: stride.map(|s| s as usize) })
}
