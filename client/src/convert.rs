//! Turns OBJ and PLY into GLB before upload: the service reads glTF alone.

mod glb;
mod mtl;
mod obj;
mod ply;
mod vertices;

use std::path::Path;

pub(crate) use vertices::Primitive;

use crate::error::{Error, Result};

/// A mesh as GLB, and what could not come along.
#[derive(Debug)]
pub(crate) struct Converted {
    pub(crate) glb: Vec<u8>,
    /// Sentences for the user.
    pub(crate) notes: Vec<String>,
}

/// The kinds of mesh file the client tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Sent as it is.
    Glb,
    Gltf,
    Obj,
    Ply,
}

/// Tells the kind from the first bytes, and where they do not tell from the name.
pub(crate) fn kind(path: &Path, head: &[u8]) -> Result<Kind> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    match extension.as_str() {
        _ if head.starts_with(b"glTF") => Ok(Kind::Glb),
        _ if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") => Ok(Kind::Ply),
        "obj" => Ok(Kind::Obj),
        _ if text.starts_with(b"{") => Ok(Kind::Gltf),
        "glb" => Ok(Kind::Glb),
        "gltf" => Ok(Kind::Gltf),
        "ply" => Ok(Kind::Ply),
        _ => Err(Error::invalid(
            path.display().to_string(),
            "this is no mesh the client knows; give a .glb, .gltf, .obj or .ply file",
        )),
    }
}

/// Reads an OBJ file with the materials it names.
pub(crate) fn obj(path: &Path, text: &[u8]) -> Result<Converted> {
    let name = path.display().to_string();
    let mut model = obj::parse(text).map_err(|e| e.in_file(&name))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let materials = mtl::load(folder, &model.libraries, &model.material_names, &mut model.notes);
    let glb = glb::write(&stem(path), &model.primitives, &materials).map_err(|m| Error::invalid(&name, m))?;
    Ok(Converted { glb, notes: model.notes })
}

/// Reads a PLY file, ASCII or binary.
pub(crate) fn ply(path: &Path, bytes: &[u8]) -> Result<Converted> {
    let name = path.display().to_string();
    let model = ply::parse(bytes).map_err(|message| Error::invalid(&name, message))?;
    let glb = glb::write(&stem(path), &[model.primitive], &[]).map_err(|m| Error::invalid(&name, m))?;
    Ok(Converted { glb, notes: model.notes })
}

/// One indexed mesh of one colour (linear RGB) as GLB; a sentence where it is too large for that.
pub(crate) fn glb(name: &str, mesh: Primitive, [r, g, b]: [f32; 3]) -> Result<Vec<u8>, String> {
    let material = glb::Material { name: name.to_owned(), base_color_factor: [r, g, b, 1.0], base_color: None };
    glb::write(name, &[Primitive { material: Some(0), ..mesh }], &[material])
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A fault at a line of a text file.
#[derive(Debug, PartialEq)]
struct LineError {
    /// From 1.
    line: usize,
    message: String,
}

impl LineError {
    fn in_file(self, name: &str) -> Error {
        Error::invalid(name, format!("line {}: {}", self.line, self.message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bytes_count_more_than_the_name() {
        assert_eq!(kind(Path::new("a.gltf"), b"glTF\x02"), Ok(Kind::Glb));
        assert_eq!(kind(Path::new("a.dat"), b"ply\nformat"), Ok(Kind::Ply));
        assert_eq!(kind(Path::new("a"), b"\xef\xbb\xbf  {\"asset\""), Ok(Kind::Gltf));
        assert_eq!(kind(Path::new("A.OBJ"), b"# wavefront"), Ok(Kind::Obj));
        assert_eq!(kind(Path::new("broken.glb"), b""), Ok(Kind::Glb));
        assert!(kind(Path::new("a.png"), b"\x89PNG").is_err());
    }
}
