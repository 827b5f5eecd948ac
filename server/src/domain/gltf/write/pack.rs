//! The binary side of a GLB: what goes where, decided before anything is copied; then all of it in parallel.

use bytes::Bytes;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::domain::{Error, Result};

type Fill<'a> = Box<dyn Fn(&mut [u8]) + Send + Sync + 'a>;

/// Accessors, views and the data behind them; data is written straight into its place in the file.
#[derive(Default)]
pub(super) struct Builder<'a> {
    pub(super) accessors: Vec<Value>,
    pub(super) views: Vec<Value>,
    /// Bytes of the buffer so far; every chunk starts at a multiple of 4.
    pub(super) length: usize,
    chunks: Vec<(usize, usize, Fill<'a>)>,
}

pub(super) const ARRAY_BUFFER: u32 = 34962;
pub(super) const ELEMENT_ARRAY_BUFFER: u32 = 34963;
pub(super) const U8: u32 = 5121;
pub(super) const U16: u32 = 5123;
pub(super) const U32: u32 = 5125;
pub(super) const F32: u32 = 5126;

impl<'a> Builder<'a> {
    /// A view of `length` bytes that `fill` writes; `view` holds its other properties.
    pub(super) fn view(&mut self, mut view: Map<String, Value>, length: usize, fill: Fill<'a>) -> usize {
        view.insert("buffer".into(), 0.into());
        view.insert("byteOffset".into(), self.length.into());
        view.insert("byteLength".into(), length.into());
        self.views.push(Value::Object(view));
        self.chunks.push((self.length, length, fill));
        self.length = (self.length + length).next_multiple_of(4);
        self.views.len() - 1
    }

    pub(super) fn bytes(&mut self, bytes: Bytes) -> usize {
        self.view(Map::new(), bytes.len(), Box::new(move |out| out.copy_from_slice(&bytes)))
    }

    /// An accessor over a view of its own.
    pub(super) fn stream(&mut self, stream: Stream, fill: Fill<'a>) -> usize {
        let mut view = Map::new();
        view.insert("target".into(), stream.target.into());
        let view = self.view(view, stream.count * stream.element_bytes(), fill);
        let mut accessor = json!({
            "bufferView": view,
            "componentType": stream.component,
            "count": stream.count,
            "type": stream.kind(),
        });
        if let Some((low, high)) = stream.bounds {
            // Every f32 is an f64: printed and read back, the bounds are the values themselves.
            accessor["min"] = low.map(f64::from).to_vec().into();
            accessor["max"] = high.map(f64::from).to_vec().into();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The whole file.
    pub(super) fn pack(self, document: &Value) -> Result<Vec<u8>> {
        let mut json = serde_json::to_vec(document)
            .map_err(|e| Error::internal("the document cannot be written").with_cause(e))?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let binary = if self.length > 0 { 8 + self.length } else { 0 };
        let total = 20 + json.len() + binary;
        let words = u32::try_from(total).map_err(|_| {
            Error::too_large(
                "geometry",
                format!("the GLB would have {total} bytes and can have {}: lower the level", u32::MAX),
            )
        })?;
        let mut bytes = vec![0u8; total];
        put_words(
            &mut bytes,
            &[u32::from_le_bytes(*b"glTF"), 2, words, json.len() as u32, u32::from_le_bytes(*b"JSON")],
        );
        bytes[20..20 + json.len()].copy_from_slice(&json);
        if self.length > 0 {
            let binary = &mut bytes[20 + json.len()..];
            put_words(binary, &[self.length as u32, u32::from_le_bytes(*b"BIN\0")]);
            self.fill(&mut binary[8..]);
        }
        Ok(bytes)
    }

    fn fill(&self, mut rest: &mut [u8]) {
        let mut places = Vec::with_capacity(self.chunks.len());
        let mut at = 0;
        for (offset, length, fill) in &self.chunks {
            let (place, tail) = rest[offset - at..].split_at_mut(*length);
            places.push((place, fill));
            (rest, at) = (tail, offset + length);
        }
        places.into_par_iter().for_each(|(place, fill)| fill(place));
    }
}

fn put_words(bytes: &mut [u8], words: &[u32]) {
    bytes.as_chunks_mut().0.iter_mut().zip(words).for_each(|(out, word)| *out = word.to_le_bytes());
}

/// Shape of a fresh accessor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    pub(super) target: u32,
    pub(super) component: u32,
    pub(super) components: usize,
    pub(super) count: usize,
    pub(super) bounds: Option<([f32; 3], [f32; 3])>,
}

impl Stream {
    fn element_bytes(&self) -> usize {
        let component = match self.component {
            U8 => 1,
            U16 => 2,
            _ => 4,
        };
        component * self.components
    }

    fn kind(&self) -> &'static str {
        ["SCALAR", "VEC2", "VEC3", "VEC4"][(self.components - 1).min(3)]
    }
}
