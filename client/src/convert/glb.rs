//! Writes indexed triangles as GLB: one mesh, one node, one primitive per material.

use serde_json::{Value, json};

use super::vertices::Primitive;

/// What of a material comes along.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Material {
    pub(super) name: String,
    /// Linear RGBA.
    pub(super) base_color_factor: [f32; 4],
    pub(super) base_color: Option<Image>,
}

/// An encoded image.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Image {
    pub(super) media_type: &'static str,
    pub(super) bytes: Vec<u8>,
}

const F32: u32 = 5126;
const U16: u32 = 5123;
const U32: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Fails with a sentence when the file would pass GLB's 4 GiB.
pub(super) fn write(name: &str, primitives: &[Primitive], materials: &[Material]) -> Result<Vec<u8>, String> {
    let mut file = Builder::default();
    let primitives: Vec<Value> = primitives.iter().map(|p| file.primitive(p)).collect();
    let materials: Vec<Value> = materials.iter().map(|m| file.material(m)).collect();
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "displace" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": name, "mesh": 0 }],
        "meshes": [{ "name": name, "primitives": primitives }],
        "buffers": [{ "byteLength": file.bytes.len() }],
        "bufferViews": file.views,
        "accessors": file.accessors,
    });
    for (key, values) in [("materials", materials), ("textures", file.textures), ("images", file.images)] {
        if !values.is_empty() {
            document[key] = values.into();
        }
    }
    container(&document, &file.bytes)
}

#[derive(Default)]
struct Builder {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    textures: Vec<Value>,
    images: Vec<Value>,
}

impl Builder {
    fn primitive(&mut self, primitive: &Primitive) -> Value {
        let mut attributes = json!({ "POSITION": self.positions(&primitive.positions) });
        if let Some(normals) = &primitive.normals {
            attributes["NORMAL"] = self.floats(normals, "VEC3").into();
        }
        if let Some(uvs) = &primitive.uvs {
            attributes["TEXCOORD_0"] = self.floats(uvs, "VEC2").into();
        }
        if let Some(colors) = &primitive.colors {
            attributes["COLOR_0"] = self.floats(colors, "VEC4").into();
        }
        let indices = self.indices(&primitive.triangles, primitive.positions.len());
        let mut value = json!({ "attributes": attributes, "indices": indices });
        if let Some(material) = primitive.material {
            value["material"] = material.into();
        }
        value
    }

    fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for position in positions {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(position[axis]);
                bounds[1][axis] = bounds[1][axis].max(position[axis]);
            }
        }
        let accessor = self.floats(positions, "VEC3");
        self.accessors[accessor]["min"] = json!(bounds[0]);
        self.accessors[accessor]["max"] = json!(bounds[1]);
        accessor
    }

    fn floats<const N: usize>(&mut self, values: &[[f32; N]], shape: &str) -> usize {
        let view = self.view(values.iter().flatten().flat_map(|v| v.to_le_bytes()), Some(VERTICES));
        self.accessor(view, F32, values.len(), shape)
    }

    /// 16-bit where they suffice; 65535 itself is reserved for primitive restart.
    fn indices(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        let corners = triangles.iter().flatten();
        let (view, kind) = if vertices <= usize::from(u16::MAX) {
            (self.view(corners.flat_map(|&i| (i as u16).to_le_bytes()), Some(INDICES)), U16)
        } else {
            (self.view(corners.flat_map(|&i| i.to_le_bytes()), Some(INDICES)), U32)
        };
        self.accessor(view, kind, triangles.len() * 3, "SCALAR")
    }

    fn accessor(&mut self, view: usize, component_type: u32, count: usize, shape: &str) -> usize {
        self.accessors.push(json!({
            "bufferView": view, "componentType": component_type, "count": count, "type": shape
        }));
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: impl Iterator<Item = u8>, target: Option<u32>) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    fn material(&mut self, material: &Material) -> Value {
        let mut metallic_roughness =
            json!({ "baseColorFactor": material.base_color_factor, "metallicFactor": 0.0, "roughnessFactor": 1.0 });
        if let Some(image) = &material.base_color {
            metallic_roughness["baseColorTexture"] = json!({ "index": self.texture(image) });
        }
        let mut value = json!({ "name": material.name, "pbrMetallicRoughness": metallic_roughness });
        if material.base_color_factor[3] < 1.0 {
            value["alphaMode"] = "BLEND".into();
        }
        value
    }

    fn texture(&mut self, image: &Image) -> usize {
        let view = self.view(image.bytes.iter().copied(), None);
        self.images.push(json!({ "bufferView": view, "mimeType": image.media_type }));
        self.textures.push(json!({ "source": self.images.len() - 1 }));
        self.textures.len() - 1
    }
}

fn container(document: &Value, binary: &[u8]) -> Result<Vec<u8>, String> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + binary.len();
    let too_large = |_| format!("as GLB it would take {total} bytes; GLB ends at 4 GiB: split the mesh");
    let total_u32 = u32::try_from(total).map_err(too_large)?;
    let mut glb = Vec::with_capacity(total);
    glb.extend_from_slice(b"glTF");
    glb.extend(2u32.to_le_bytes());
    glb.extend(total_u32.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_slice()), (b"BIN\0", binary)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend_from_slice(kind);
        glb.extend_from_slice(chunk);
    }
    Ok(glb)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_container_is_aligned_and_says_its_length() {
        let primitive = Primitive {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Primitive::default()
        };
        let glb = write("t", &[primitive], &[]).unwrap();
        assert_eq!(&glb[..4], b"glTF");
        assert_eq!(u32::from_le_bytes(glb[8..12].try_into().unwrap()) as usize, glb.len());
        let json_bytes = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        assert_eq!((json_bytes % 4, glb.len() % 4), (0, 0));
        let document: Value = serde_json::from_slice(&glb[20..20 + json_bytes]).unwrap();
        assert_eq!(document["accessors"][0]["max"], json!([1.0, 2.0, 0.0]));
        assert_eq!(document["accessors"][1]["componentType"], U16);
        assert_eq!(document["buffers"][0]["byteLength"], glb.len() - 28 - json_bytes);
    }
}
