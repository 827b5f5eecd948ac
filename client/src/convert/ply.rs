//! Stanford PLY, ASCII and binary: vertices with normals, texture coordinates and colours; polygon faces.

use std::io::BufReader;

use ply_rs_bw::{
    parser::{Parser, Reader},
    ply::{Header, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType, ScalarType},
};

use super::vertices::{Primitive, fan, linear_from_srgb, unit};

#[derive(Debug)]
pub(super) struct Model {
    pub(super) primitive: Primitive,
    pub(super) notes: Vec<String>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Model, String> {
    let mut reader = Reader::new(BufReader::new(bytes));
    let header = Parser::<Vertex>::new().read_header(&mut reader).map_err(|e| sentence(&e))?;
    check_counts(&header, bytes.len())?;
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    let mut notes = Vec::new();
    for element in header.elements.values() {
        let failed = |e| format!("element '{}': {}", element.name, sentence(&e));
        match element.name.as_str() {
            "vertex" => {
                vertices =
                    Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header).map_err(failed)?;
            }
            "face" => {
                faces = Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header).map_err(failed)?
            }
            other => {
                Parser::<Skipped>::new().read_payload_for_element(&mut reader, element, &header).map_err(failed)?;
                notes.push(format!("element '{other}' is left out, being no part of a polygon mesh"));
            }
        }
    }
    let primitive = primitive(&vertices, &faces, &header, &mut notes)?;
    Ok(Model { primitive, notes })
}

/// The parser tells on several lines, the offending one quoted whole; here it is one line, and short.
fn sentence(error: &ply_rs_bw::parser::ParseError) -> String {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default().trim_end_matches('.');
    let part = |name: &str| text.lines().find_map(|line| line.trim().strip_prefix(name).map(str::trim));
    match (part("String:"), part("Error:")) {
        (Some(line), _) => format!("{first}: {}", line.chars().take(60).collect::<String>()),
        (None, Some(cause)) => format!("{first}: {cause}"),
        (None, None) => first.to_owned(),
    }
}

/// Every element takes at least a byte, so a header cannot ask for more work than the file is long.
fn check_counts(header: &Header, file_bytes: usize) -> Result<(), String> {
    for element in header.elements.values() {
        if element.count > file_bytes || (element.properties.is_empty() && element.count > 0) {
            return Err(format!(
                "the header promises {} elements '{}' with {} properties; the file has {file_bytes} bytes",
                element.count,
                element.name,
                element.properties.len()
            ));
        }
    }
    for name in ["vertex", "face"] {
        if header.elements.get(name).is_none_or(|element| element.count == 0) {
            return Err(format!(
                "there is no element '{name}', so there is no surface; give a PLY with vertex and face"
            ));
        }
    }
    Ok(())
}

#[derive(Clone, Copy, Debug, Default)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
    /// As stored: 0 to 255 for bytes, 0 to 65535 for shorts, 0 to 1 for floats.
    color: [f32; 4],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self { color: [0.0, 0.0, 0.0, f32::NAN], ..Self::default() }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let Some(value) = value.to_f32_lossy() else { return PropertyAccessResult::Ignored };
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "u" | "s" | "texture_u" | "texture_s" => &mut self.uv[0],
            "v" | "t" | "texture_v" | "texture_t" => &mut self.uv[1],
            "red" | "r" | "diffuse_red" => &mut self.color[0],
            "green" | "g" | "diffuse_green" => &mut self.color[1],
            "blue" | "b" | "diffuse_blue" => &mut self.color[2],
            "alpha" | "a" => &mut self.color[3],
            _ => return PropertyAccessResult::Ignored,
        };
        *slot = value;
        PropertyAccessResult::Set
    }
}

#[derive(Clone, Debug, Default)]
struct Face {
    /// Negative where the file has a negative index.
    corners: Vec<i64>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        self.corners = match value {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An element that is read past.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

fn primitive(
    vertices: &[Vertex],
    faces: &[Face],
    header: &Header,
    notes: &mut Vec<String>,
) -> Result<Primitive, String> {
    let has = |names: &[&str]| names.iter().any(|name| header.elements["vertex"].properties.contains_key(*name));
    for axis in ["x", "y", "z"] {
        if !has(&[axis]) {
            return Err(format!("element 'vertex' has no property '{axis}'"));
        }
    }
    if let Some(index) = vertices.iter().position(|v| v.position.iter().any(|c| !c.is_finite())) {
        return Err(format!("vertex {index} has a position that is not finite"));
    }
    let mut normals = None;
    if has(&["nx"]) && has(&["ny"]) && has(&["nz"]) {
        normals = vertices.iter().map(|v| unit(v.normal)).collect();
        if normals.is_none() {
            notes.push("some normals have no length; normals are left out".to_owned());
        }
    }
    let has_uvs =
        has(&["u", "s", "texture_u", "texture_s"]) && vertices.iter().all(|v| v.uv.iter().all(|c| c.is_finite()));
    Ok(Primitive {
        positions: vertices.iter().map(|v| v.position).collect(),
        normals,
        uvs: has_uvs.then(|| vertices.iter().map(|v| [v.uv[0], 1.0 - v.uv[1]]).collect()),
        colors: color_range(header).map(|range| vertices.iter().map(|v| color(v, range)).collect()),
        triangles: triangles(faces, vertices.len())?,
        material: None,
    })
}

/// What full intensity is stored as; `None` without colours.
fn color_range(header: &Header) -> Option<f32> {
    let properties = &header.elements["vertex"].properties;
    let red: &PropertyDef = ["red", "r", "diffuse_red"].iter().find_map(|name| properties.get(*name))?;
    match &red.data_type {
        PropertyType::Scalar(ScalarType::Float | ScalarType::Double) => Some(1.0),
        PropertyType::Scalar(ScalarType::UShort | ScalarType::Short) => Some(65_535.0),
        PropertyType::Scalar(_) => Some(255.0),
        PropertyType::List(..) => None,
    }
}

fn color(vertex: &Vertex, range: f32) -> [f32; 4] {
    let stored = vertex.color.map(|c| c / range);
    let [r, g, b] = [stored[0], stored[1], stored[2]].map(|c| if c.is_finite() { linear_from_srgb(c) } else { 0.0 });
    let alpha = if stored[3].is_finite() { stored[3].clamp(0.0, 1.0) } else { 1.0 };
    [r, g, b, alpha]
}

fn triangles(faces: &[Face], vertices: usize) -> Result<Vec<[u32; 3]>, String> {
    let mut triangles = Vec::with_capacity(faces.len());
    let mut corners = Vec::new();
    for (number, face) in faces.iter().enumerate() {
        corners.clear();
        for &corner in &face.corners {
            let inside = usize::try_from(corner).is_ok_and(|corner| corner < vertices);
            if !inside {
                return Err(format!("face {number} names vertex {corner}; there are {vertices}, counted from 0"));
            }
            corners.push(corner as u32);
        }
        if corners.len() < 3 {
            return Err(format!(
                "face {number} has {} corners; it needs a list 'vertex_indices' of at least 3",
                corners.len()
            ));
        }
        triangles.extend(fan(&corners));
    }
    Ok(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

    #[test]
    fn an_ascii_quad_with_colours_is_two_triangles() {
        let text = format!(
            "ply\nformat ascii 1.0\n{HEADER}0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 255 255 255\n4 0 1 2 3\n"
        );
        let model = parse(text.as_bytes()).unwrap();
        assert_eq!(model.primitive.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(model.primitive.colors.unwrap()[1], [0.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn both_byte_orders_are_read() {
        for little in [true, false] {
            let float = |v: f32| if little { v.to_le_bytes() } else { v.to_be_bytes() };
            let int = |v: i32| if little { v.to_le_bytes() } else { v.to_be_bytes() };
            let order = if little { "little" } else { "big" };
            let mut file = format!("ply\nformat binary_{order}_endian 1.0\n{HEADER}").into_bytes();
            for p in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 7.0f32]] {
                file.extend(p.into_iter().flat_map(float).chain([1, 2, 3]));
            }
            file.push(3);
            file.extend([0, 1, 3].into_iter().flat_map(int));
            let model = parse(&file).unwrap();
            assert_eq!(model.primitive.triangles, [[0, 1, 3]]);
            assert_eq!(model.primitive.positions[3], [0.0, 1.0, 7.0]);
        }
    }

    #[test]
    fn every_truncation_is_refused() {
        let text = format!(
            "ply\nformat ascii 1.0\n{HEADER}0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 255 255 255\n4 0 1 2 3\n"
        );
        for end in 0..text.len() - 2 {
            assert!(parse(&text.as_bytes()[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn false_promises_and_indices_are_refused() {
        let vertex = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
        let face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
        for (body, part) in [
            (format!("{vertex}{face}0 0 0\n3 0 0 1\n"), "vertex 1"),
            (format!("{vertex}{face}0 0 0\n3 0 0 -1\n"), "vertex -1"),
            (format!("{vertex}{face}0 0 0\n2 0 0\n"), "at least 3"),
            (format!("{vertex}{face}nan 0 0\n3 0 0 0\n"), "nan 0 0"),
            (format!("{}{face}", vertex.replace("vertex 1", "vertex 99999999999")), "promises"),
            ("element vertex 9999999999999\nend_header\n".to_owned(), "promises"),
            (format!("{vertex}end_header\n0 0 0\n"), "'face'"),
            (format!("{}{face}0 0\n3 0 0 0\n", vertex.replace("property float z\n", "")), "'z'"),
        ] {
            let error = parse(format!("ply\nformat ascii 1.0\n{body}").as_bytes()).expect_err(&body);
            assert!(error.contains(part), "{body}: {error}");
        }
    }
}
