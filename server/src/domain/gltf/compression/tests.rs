//! What was packed comes back; what is damaged is refused.

use meshopt::{encode_filter_exp, encode_filter_oct, encode_index_buffer, encode_index_sequence, encode_vertex_buffer};

use super::packed::{Filter, Mode, Packed};

fn packed(bytes: Vec<u8>, count: usize, stride: usize, mode: Mode, filter: Filter) -> Packed {
    Packed { path: "bufferViews[0]".into(), bytes: bytes.into(), count, stride, mode, filter }
}

#[test]
fn every_mode_gives_back_what_was_packed() {
    let vertices: Vec<[u32; 5]> = (0..300u32).map(|i| std::array::from_fn(|k| i * 7 + k as u32 * 1000)).collect();
    let bytes: Vec<u8> = vertices.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let encoded = encode_vertex_buffer(&vertices).unwrap();
    let decoded = packed(encoded, 300, 20, Mode::Attributes, Filter::None).decode().unwrap();
    assert_eq!(decoded, bytes);
    // Triangles may start at another corner, which this list does not invite.
    let indices: Vec<u32> = (0..60).flat_map(|i| [i, i + 1, i + 2]).collect();
    let decoded = |mode, stride, encoded| packed(encoded, indices.len(), stride, mode, Filter::None).decode().unwrap();
    let sequence = encode_index_sequence(&indices, 62).unwrap();
    let wide: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let narrow: Vec<u8> = indices.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect();
    assert_eq!(decoded(Mode::Indices, 4, sequence.clone()), wide);
    assert_eq!(decoded(Mode::Indices, 2, sequence), narrow);
    let triangles = decoded(Mode::Triangles, 4, encode_index_buffer(&indices, 62).unwrap());
    let sorted = |bytes: &[u8]| -> Vec<Vec<u8>> {
        bytes
            .chunks_exact(12)
            .map(|t| {
                let mut t = t.to_vec();
                t.sort_unstable();
                t
            })
            .collect()
    };
    assert_eq!(sorted(&triangles), sorted(&wide));
}

#[test]
fn filters_give_back_numbers_and_directions() {
    let numbers: Vec<[f32; 3]> = (0..50).map(|i| [i as f32 * 0.37, -1.0 / (i as f32 + 1.0), 1e3]).collect();
    let encoded = encode_filter_exp(&numbers, 15, meshopt::EncodeExpMode::Separate);
    let encoded = encode_vertex_buffer(&encoded).unwrap();
    let decoded = packed(encoded, 50, 12, Mode::Attributes, Filter::Exponential).decode().unwrap();
    let found = decoded.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    for (found, number) in found.zip(numbers.iter().flatten()) {
        assert!((found - number).abs() <= number.abs() / 8192.0, "{found} for {number}");
    }
    let directions: Vec<[f32; 4]> = (0..50)
        .map(|i| {
            let a = i as f32;
            [a.cos(), a.sin(), 0.0, 0.0]
        })
        .collect();
    let encoded = encode_vertex_buffer(&encode_filter_oct::<i16>(&directions, 16)).unwrap();
    let decoded = packed(encoded, 50, 8, Mode::Attributes, Filter::Octahedral).decode().unwrap();
    for (found, direction) in decoded.chunks_exact(8).zip(&directions) {
        let x = f32::from(i16::from_le_bytes([found[0], found[1]])) / 32767.0;
        assert!((x - direction[0]).abs() < 1e-3, "{x} for {direction:?}");
    }
}

#[test]
fn damaged_streams_are_refused() {
    let encoded = encode_vertex_buffer(&vec![[7u32; 4]; 100]).unwrap();
    for cut in [0, 1, encoded.len() / 2, encoded.len() - 1] {
        let error = packed(encoded[..cut].to_vec(), 100, 16, Mode::Attributes, Filter::None).decode();
        assert!(error.unwrap_err().message.contains("damaged"), "cut at {cut}");
    }
    for seed in 0..200u8 {
        let noise: Vec<u8> = (0..400u32).map(|i| (i.wrapping_mul(u32::from(seed) * 2 + 1) >> 3) as u8).collect();
        for mode in [Mode::Attributes, Mode::Triangles, Mode::Indices] {
            // Refused or nonsense, never worse.
            let _ = packed(noise.clone(), 99, 4, mode, Filter::None).decode();
        }
    }
}
