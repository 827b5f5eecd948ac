//! The binary side of a GLB: what goes where, decided before anything is copied; then all of it in parallel.

mod meshopt;
mod stream;

use bytes::Bytes;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::domain::{Error, Result};
pub(super) use meshopt::NAME as MESHOPT;
pub(super) use stream::{Bounds, Component, Stream};

type Fill<'a> = Box<dyn Fn(&mut [u8]) + Send + Sync + 'a>;

/// Accessors, views and the data behind them; data is written straight into its place in the file.
#[derive(Default)]
pub(super) struct Builder<'a> {
    pub(super) accessors: Vec<Value>,
    pub(super) views: Vec<Value>,
    /// Bytes of the buffer so far; every chunk starts at a multiple of 4.
    length: usize,
    /// Bytes that compressed views decode to, in a buffer that no file has.
    decoded_length: usize,
    /// One for each view.
    chunks: Vec<Chunk<'a>>,
}

struct Chunk<'a> {
    offset: usize,
    length: usize,
    fill: Fill<'a>,
    /// What it holds, where that is a fresh accessor.
    stream: Option<Stream>,
}

impl<'a> Builder<'a> {
    /// A view of `length` bytes that `fill` writes; `view` holds its other properties.
    pub(super) fn view(&mut self, view: Map<String, Value>, length: usize, fill: Fill<'a>) -> usize {
        self.chunk(view, Chunk { offset: self.length, length, fill, stream: None })
    }

    fn chunk(&mut self, mut view: Map<String, Value>, chunk: Chunk<'a>) -> usize {
        view.insert("buffer".into(), 0.into());
        view.insert("byteOffset".into(), chunk.offset.into());
        view.insert("byteLength".into(), chunk.length.into());
        self.views.push(Value::Object(view));
        self.length = (chunk.offset + chunk.length).next_multiple_of(4);
        self.chunks.push(chunk);
        self.views.len() - 1
    }

    pub(super) fn bytes(&mut self, bytes: Bytes) -> usize {
        self.view(Map::new(), bytes.len(), Box::new(move |out| out.copy_from_slice(&bytes)))
    }

    /// An accessor over a view of its own. What `fill` leaves out is 0.
    pub(super) fn stream(&mut self, stream: Stream, fill: Fill<'a>) -> usize {
        let length = stream.count * stream.stride();
        let chunk = Chunk { offset: self.length, length, fill, stream: Some(stream) };
        let view = self.chunk(stream.view(), chunk);
        self.accessors.push(stream.accessor(view));
        self.accessors.len() - 1
    }

    /// The buffers of the file: its own and, where views are compressed, the one that they decode to.
    pub(super) fn buffers(&self) -> Value {
        let own = json!({ "byteLength": self.length });
        match self.decoded_length {
            0 => json!([own]),
            length => json!([own, meshopt::fallback(length)]),
        }
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
        for Chunk { offset, length, fill, .. } in &self.chunks {
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
