//! Writes a test mesh as a GLB and reads a GLB's triangles back, independently of the server's own code.

use std::path::Path;

use base64::Engine as _;
use serde_json::{Value, json};

use crate::meshes::TestMesh;

/// The triangles of one primitive, as a viewer sees them.
#[derive(Clone, Debug, Default)]
pub struct Part {
    pub mesh: usize,
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

impl TestMesh {
    /// A GLB with one node, one mesh and one material named `surface`.
    #[must_use]
    pub fn to_glb(&self) -> Vec<u8> {
        self.to_glb_with_material(&json!({ "name": "surface", "doubleSided": true }))
    }

    #[must_use]
    pub fn to_glb_with_material(&self, material: &Value) -> Vec<u8> {
        let mut bin = Vec::new();
        let views = [
            append(&mut bin, bytemuck::cast_slice(&self.positions)),
            append(&mut bin, bytemuck::cast_slice(&self.normals)),
            append(&mut bin, bytemuck::cast_slice(&self.uvs)),
            append(&mut bin, bytemuck::cast_slice(&self.triangles)),
        ];
        let (low, high) = bounds(&self.positions);
        let (vertices, indices) = (self.positions.len(), 3 * self.triangles.len());
        let document = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0, "name": self.name }],
            "meshes": [{ "name": self.name, "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0 }] }],
            "materials": [material],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3", "min": low, "max": high },
                { "bufferView": 1, "componentType": 5126, "count": vertices, "type": "VEC3" },
                { "bufferView": 2, "componentType": 5126, "count": vertices, "type": "VEC2" },
                { "bufferView": 3, "componentType": 5125, "count": indices, "type": "SCALAR" },
            ],
            "bufferViews": views, "buffers": [{ "byteLength": bin.len() }],
        });
        pack(&document, &bin)
    }
}

fn append(bin: &mut Vec<u8>, bytes: &[u8]) -> Value {
    let offset = bin.len();
    bin.extend_from_slice(bytes);
    json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() })
}

fn bounds(positions: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let mut range = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for p in positions {
        for (k, &value) in p.iter().enumerate() {
            range.0[k] = range.0[k].min(value);
            range.1[k] = range.1[k].max(value);
        }
    }
    range
}

/// A binary glTF of a document and its one buffer.
#[must_use]
pub fn pack(document: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut glb = Vec::new();
    glb.extend(b"glTF");
    for word in [2, 28 + json.len() as u32 + bin.len() as u32, json.len() as u32, 0x4e4f_534a] {
        glb.extend(word.to_le_bytes());
    }
    glb.extend(&json);
    for word in [bin.len() as u32, 0x004e_4942] {
        glb.extend(word.to_le_bytes());
    }
    glb.extend(&bin);
    glb
}

/// The triangle primitives of a self-contained GLB, in the order of the file.
///
/// # Panics
/// When the bytes are not a GLB, or a primitive has no positions or reaches outside its buffer.
#[must_use]
pub fn read(bytes: &[u8]) -> Vec<Part> {
    let gltf = gltf::Gltf::from_slice_without_validation(bytes).expect("the result is a GLB");
    read_parts(&gltf, gltf.blob.as_deref())
}

/// The same of a .gltf whose one buffer is a file beside it, or a base64 URI in it.
///
/// # Panics
/// When the file is not of that kind.
#[must_use]
pub fn read_gltf(path: &Path) -> Vec<Part> {
    let bytes = std::fs::read(path).expect("the file can be read");
    let gltf = gltf::Gltf::from_slice_without_validation(&bytes).expect("the file is glTF");
    let buffer = gltf.buffers().next().expect("the file has a buffer");
    let gltf::buffer::Source::Uri(uri) = buffer.source() else { panic!("{} has no URI", path.display()) };
    let blob = match uri.split_once(";base64,") {
        Some((_, text)) => base64::engine::general_purpose::STANDARD.decode(text).expect("the URI is base64"),
        None => std::fs::read(path.with_file_name(uri)).expect("the buffer lies beside the file"),
    };
    read_parts(&gltf, Some(&blob))
}

fn read_parts(gltf: &gltf::Gltf, blob: Option<&[u8]>) -> Vec<Part> {
    let mut parts = Vec::new();
    for mesh in gltf.meshes() {
        let triangles = mesh.primitives().filter(|primitive| primitive.mode() == gltf::mesh::Mode::Triangles);
        parts.extend(triangles.map(|primitive| read_primitive(mesh.index(), &primitive, blob)));
    }
    parts
}

fn read_primitive(mesh: usize, primitive: &gltf::Primitive<'_>, blob: Option<&[u8]>) -> Part {
    let reader = primitive.reader(|_| blob);
    let positions: Vec<[f32; 3]> = reader.read_positions().expect("a primitive has positions").collect();
    let indices: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..positions.len() as u32).collect(),
    };
    Part {
        mesh,
        normals: reader.read_normals().map(Iterator::collect).unwrap_or_default(),
        uvs: reader.read_tex_coords(0).map(|uvs| uvs.into_f32().collect()).unwrap_or_default(),
        triangles: indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        positions,
    }
}

/// All primitives as one: primitives of a mesh that share a border close each other's edges.
#[must_use]
pub fn joined(parts: &[Part]) -> Part {
    let mut whole = Part::default();
    for part in parts {
        let first = whole.positions.len() as u32;
        whole.positions.extend(&part.positions);
        whole.normals.extend(&part.normals);
        whole.uvs.extend(&part.uvs);
        whole.triangles.extend(part.triangles.iter().map(|t| t.map(|i| first + i)));
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes;

    #[test]
    fn a_written_mesh_reads_back_unchanged() {
        let cube = meshes::cube();
        let parts = read(&cube.to_glb());
        assert_eq!(parts.len(), 1);
        assert_eq!(parts[0].positions, cube.positions);
        assert_eq!(parts[0].normals, cube.normals);
        assert_eq!(parts[0].uvs, cube.uvs);
        assert_eq!(parts[0].triangles, cube.triangles);
    }
}
