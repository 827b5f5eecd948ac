//! One compressed buffer view: what it says of itself, and its bytes.

use bytes::Bytes;
use meshopt::{
    decode_filter_color, decode_filter_exp, decode_filter_oct, decode_filter_quat, decode_index_buffer,
    decode_index_sequence, decode_vertex_buffer,
};

use super::{At, Buffers};
use crate::domain::{Error, Result};

/// A compressed buffer view.
pub(super) struct Packed {
    pub(super) path: String,
    pub(super) bytes: Bytes,
    pub(super) count: usize,
    pub(super) stride: usize,
    pub(super) mode: Mode,
    pub(super) filter: Filter,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl Packed {
    pub(super) fn read(view: &At<'_>, at: &At<'_>, buffers: &mut Buffers<'_>) -> Result<Self> {
        let data = buffers.read(&at.need("buffer")?)?;
        let (offset, length) = (at.whole("byteOffset")?.unwrap_or(0), at.need_whole("byteLength")?);
        let end = offset.checked_add(length).filter(|end| *end <= data.len() as u64);
        let end = end
            .ok_or_else(|| at.error(format!("bytes {offset} + {length} do not lie in the buffer's {}", data.len())))?;
        let packed = Self {
            path: at.path.clone(),
            bytes: data.slice(offset as usize..end as usize),
            count: u32::try_from(at.need_whole("count")?).map_err(|_| at.error("count is above 4294967295"))? as usize,
            stride: at.need_whole("byteStride")? as usize,
            mode: mode(&at.need("mode")?)?,
            filter: at.get("filter").map_or(Ok(Filter::None), |at| filter(&at))?,
        };
        packed.check(view, at)?;
        Ok(packed)
    }

    fn check(&self, view: &At<'_>, at: &At<'_>) -> Result<()> {
        let stride = self.stride;
        let fits = match self.mode {
            Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
            Mode::Triangles | Mode::Indices => stride == 2 || stride == 4,
        };
        let filtered = match self.filter {
            Filter::None => true,
            Filter::Octahedral | Filter::Color => stride == 4 || stride == 8,
            Filter::Quaternion => stride == 8,
            Filter::Exponential => stride.is_multiple_of(4),
        };
        if !fits || !filtered || (self.filter != Filter::None && self.mode != Mode::Attributes) {
            return Err(at.error(format!("byteStride {stride} does not go with its mode and filter")));
        }
        if self.mode == Mode::Triangles && !self.count.is_multiple_of(3) {
            return Err(at.error(format!("count {} is not a multiple of 3, as mode TRIANGLES needs", self.count)));
        }
        if view.whole("byteStride")?.is_some_and(|own| own != stride as u64) {
            return Err(view.error(format!("byteStride is not the {stride} of what is packed")));
        }
        // A short stream must not make a large buffer.
        if self.bytes.len() < self.least_bytes() {
            return Err(at.error(format!("{} bytes are too few for {} elements", self.bytes.len(), self.count)));
        }
        let length = view.need_whole("byteLength")?;
        if self.count == 0 || length != self.bytes() as u64 {
            let message = format!("byteLength is {length} and {} elements of {stride} bytes are packed", self.count);
            return Err(view.error(message));
        }
        Ok(())
    }

    /// No stream of as many elements is shorter, by the codecs of the extension's appendices: a head, a code for each
    /// triangle or index and a tail; or a control byte for four bytes of an element and a block.
    fn least_bytes(&self) -> usize {
        match self.mode {
            Mode::Triangles => 1 + self.count / 3 + 16,
            Mode::Indices => 1 + self.count + 4,
            Mode::Attributes => {
                let block = ((8192 / self.stride) & !15).min(256);
                1 + self.count.div_ceil(block) * (self.stride / 4)
            }
        }
    }

    /// Decoded.
    pub(super) fn bytes(&self) -> usize {
        self.count * self.stride
    }

    pub(super) fn decode(&self) -> Result<Bytes> {
        let decoded = match self.mode {
            Mode::Attributes => attributes(&self.bytes, self.count, self.stride),
            Mode::Triangles if self.stride == 2 => {
                decode_index_buffer::<u16>(&self.bytes, self.count).ok().map(|v| flat(v, u16::to_le_bytes))
            }
            Mode::Triangles => {
                decode_index_buffer::<u32>(&self.bytes, self.count).ok().map(|v| flat(v, u32::to_le_bytes))
            }
            Mode::Indices if self.stride == 2 => {
                decode_index_sequence::<u16>(&self.bytes, self.count).ok().map(|v| flat(v, u16::to_le_bytes))
            }
            Mode::Indices => {
                decode_index_sequence::<u32>(&self.bytes, self.count).ok().map(|v| flat(v, u32::to_le_bytes))
            }
        };
        let decoded = decoded.ok_or_else(|| {
            Error::invalid(&self.path, "is damaged: its bytes are no stream of its mode; export it again")
        })?;
        Ok(self.filtered(decoded).into())
    }

    fn filtered(&self, bytes: Vec<u8>) -> Vec<u8> {
        let words = |bytes: &[u8]| -> Vec<[u32; 1]> {
            bytes.chunks_exact(4).map(|b| [u32::from_le_bytes([b[0], b[1], b[2], b[3]])]).collect()
        };
        match (self.filter, self.stride) {
            (Filter::None, _) => bytes,
            (Filter::Octahedral, 4) => with_bytes(&bytes, decode_filter_oct::<i8>),
            (Filter::Octahedral, _) => with_shorts(&bytes, decode_filter_oct::<i16>),
            (Filter::Quaternion, _) => with_shorts(&bytes, decode_filter_quat),
            (Filter::Color, 4) => with_bytes(&bytes, decode_filter_color::<i8>),
            (Filter::Color, _) => with_shorts(&bytes, decode_filter_color::<i16>),
            (Filter::Exponential, _) => {
                let mut words = words(&bytes);
                decode_filter_exp(&mut words);
                words.into_iter().flat_map(|[word]| word.to_le_bytes()).collect()
            }
        }
    }
}

fn mode(at: &At<'_>) -> Result<Mode> {
    Ok(match at.text_here()? {
        "ATTRIBUTES" => Mode::Attributes,
        "TRIANGLES" => Mode::Triangles,
        "INDICES" => Mode::Indices,
        other => return Err(at.error(format!("'{other}' is none of ATTRIBUTES, TRIANGLES and INDICES"))),
    })
}

fn filter(at: &At<'_>) -> Result<Filter> {
    Ok(match at.text_here()? {
        "NONE" => Filter::None,
        "OCTAHEDRAL" => Filter::Octahedral,
        "QUATERNION" => Filter::Quaternion,
        "EXPONENTIAL" => Filter::Exponential,
        "COLOR" => Filter::Color,
        other => {
            return Err(at.error(format!("'{other}' is none of NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL and COLOR")));
        }
    })
}

fn flat<T, const N: usize>(values: Vec<T>, bytes: fn(T) -> [u8; N]) -> Vec<u8> {
    values.into_iter().flat_map(bytes).collect()
}

fn with_bytes(bytes: &[u8], filter: fn(&mut [[i8; 4]])) -> Vec<u8> {
    let mut values: Vec<[i8; 4]> = bytes.chunks_exact(4).map(|b| std::array::from_fn(|k| b[k] as i8)).collect();
    filter(&mut values);
    values.into_iter().flatten().map(|x| x as u8).collect()
}

fn with_shorts(bytes: &[u8], filter: fn(&mut [[i16; 4]])) -> Vec<u8> {
    let short = |b: &[u8], k: usize| i16::from_le_bytes([b[2 * k], b[2 * k + 1]]);
    let mut values: Vec<[i16; 4]> = bytes.chunks_exact(8).map(|b| std::array::from_fn(|k| short(b, k))).collect();
    filter(&mut values);
    values.into_iter().flatten().flat_map(i16::to_le_bytes).collect()
}

/// One element of a stream: the decoder takes its size from the type.
#[derive(Clone)]
struct Element<const BYTES: usize>([u8; BYTES]);

impl<const BYTES: usize> Default for Element<BYTES> {
    fn default() -> Self {
        Self([0; BYTES])
    }
}

fn of_size<const BYTES: usize>(packed: &[u8], count: usize) -> Option<Vec<u8>> {
    let elements = decode_vertex_buffer::<Element<BYTES>>(packed, count).ok()?;
    Some(elements.into_iter().flat_map(|element| element.0).collect())
}

/// The stride is a multiple of 4 from 4 to 256.
fn attributes(packed: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    macro_rules! by_size {
        ($($size:literal)*) => {
            match stride { $($size => of_size::<$size>(packed, count),)* _ => None }
        };
    }
    by_size!(4 8 12 16 20 24 28 32 36 40 44 48 52 56 60 64 68 72 76 80 84 88 92 96 100 104 108 112 116 120 124 128
        132 136 140 144 148 152 156 160 164 168 172 176 180 184 188 192 196 200 204 208 212 216 220 224 228 232 236
        240 244 248 252 256)
}
