//! EXT_meshopt_compression (Khronos registry, 2020), written: fresh accessors' views hold packed bytes, and say in which
//! buffer, that no file has, they would lie unpacked.

use ::meshopt::{encode_filter_oct, encode_index_buffer, encode_vertex_buffer_level};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::{Builder, Chunk};
use crate::domain::{Error, Result};

pub(in super::super) const NAME: &str = "EXT_meshopt_compression";

/// Of each of the two coordinates of a direction on the octahedron: moves it by 0.06 degrees at most.
const DIRECTION_BITS: i32 = 12;
/// What the extension decodes; later ones are KHR_meshopt_compression's.
const VERTEX_VERSION: i32 = 0;

struct Packed {
    bytes: Vec<u8>,
    /// The extension's properties but for where the bytes are.
    says: Value,
}

impl Builder<'_> {
    /// Compresses the views of fresh accessors, and moves all to where they lie then. A view that is no shorter for it
    /// stays plain.
    pub(in super::super) fn compress(&mut self) -> Result<()> {
        let packed: Vec<Option<Packed>> = self.chunks.par_iter().map(pack).collect::<Result<_>>()?;
        self.length = 0;
        for (n, packed) in packed.into_iter().enumerate() {
            if let Some(packed) = packed {
                self.replace(n, packed);
            } else {
                self.views[n]["byteOffset"] = self.length.into();
            }
            let chunk = &mut self.chunks[n];
            chunk.offset = self.length;
            self.length = (chunk.offset + chunk.length).next_multiple_of(4);
        }
        Ok(())
    }

    fn replace(&mut self, n: usize, Packed { bytes, says }: Packed) {
        let (view, chunk) = (&mut self.views[n], &mut self.chunks[n]);
        view["buffer"] = 1.into();
        view["byteOffset"] = self.decoded_length.into();
        self.decoded_length = (self.decoded_length + chunk.length).next_multiple_of(4);
        view["extensions"][NAME] = says;
        view["extensions"][NAME]["byteOffset"] = self.length.into();
        view["extensions"][NAME]["byteLength"] = bytes.len().into();
        chunk.length = bytes.len();
        chunk.fill = Box::new(move |out| out.copy_from_slice(&bytes));
    }
}

/// The buffer of what the views decode to, which is nowhere.
pub(super) fn fallback(length: usize) -> Value {
    json!({ "byteLength": length, "extensions": { NAME: { "fallback": true } } })
}

fn pack(chunk: &Chunk<'_>) -> Result<Option<Packed>> {
    let Some(stream) = chunk.stream else { return Ok(None) };
    let mut plain = vec![0; chunk.length];
    (chunk.fill)(&mut plain);
    let stride = stream.stride();
    let mut says = json!({ "buffer": 0, "byteStride": stride, "count": stream.count });
    let bytes = if stream.is_indices {
        says["mode"] = "TRIANGLES".into();
        indices(&plain, stride)
    } else {
        says["mode"] = "ATTRIBUTES".into();
        if stream.is_directions {
            says["filter"] = "OCTAHEDRAL".into();
            plain = on_octahedron(&plain);
        }
        vertices(&plain, stride)
    };
    let bytes = bytes.map_err(|e| Error::internal("a stream cannot be compressed").with_cause(e))?;
    Ok((bytes.len() < chunk.length).then_some(Packed { bytes, says }))
}

fn indices(plain: &[u8], stride: usize) -> ::meshopt::Result<Vec<u8>> {
    let indices: Vec<u32> = plain.chunks_exact(stride).map(word).collect();
    let vertices = indices.iter().max().map_or(0, |most| *most as usize + 1);
    encode_index_buffer(&indices, vertices)
}

fn word(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte))
}

/// Directions in 16 bits to their places on the octahedron; the fourth component stays.
fn on_octahedron(plain: &[u8]) -> Vec<u8> {
    let component = |b: &[u8]| f32::from(i16::from_le_bytes([b[0], b[1]])) / f32::from(i16::MAX);
    let directions: Vec<[f32; 4]> =
        plain.chunks_exact(8).map(|b| std::array::from_fn(|k| component(&b[2 * k..2 * k + 2]))).collect();
    let places = encode_filter_oct::<i16>(&directions, DIRECTION_BITS);
    places.as_flattened().iter().flat_map(|place| place.to_le_bytes()).collect()
}

/// The encoder takes the size of an element from its type; all strides here are multiples of 4.
fn vertices(plain: &[u8], stride: usize) -> ::meshopt::Result<Vec<u8>> {
    macro_rules! by_words {
        ($($words:literal)*) => {
            match stride / 4 {
                $($words => encode_vertex_buffer_level(plain.as_chunks::<{ 4 * $words }>().0, 2, Some(VERTEX_VERSION)),)*
                _ => Ok(plain.to_vec()),
            }
        };
    }
    by_words!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_of_two_and_of_four_bytes_are_words() {
        assert_eq!(word(&[0x34, 0x12]), 0x1234);
        assert_eq!(word(&[0x78, 0x56, 0x34, 0x12]), 0x1234_5678);
    }

    #[test]
    fn directions_move_by_less_than_six_hundredths_of_a_degree() {
        let mut worst: f64 = 0.0;
        for i in 0..20_000 {
            // Evenly, by the golden spiral.
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 20_000.0;
            let (radius, turn) = ((1.0 - z * z).sqrt(), 2.399_963_229_728_653 * f64::from(i));
            let direction = glam::DVec3::new(radius * turn.cos(), radius * turn.sin(), z);
            let plain = direction.extend(0.0).to_array().map(|x| (x * 32767.0).round() as i16);
            let places = on_octahedron(bytemuck::cast_slice(&plain));
            let mut found: Vec<[i16; 4]> = bytemuck::pod_collect_to_vec(&places);
            ::meshopt::decode_filter_oct(&mut found);
            let found = glam::I16Vec4::from_array(found[0]).truncate().as_dvec3().normalize();
            worst = worst.max(found.cross(direction).length().asin().to_degrees());
        }
        assert!((0.03..0.06).contains(&worst), "{worst} degrees");
    }
}
