//! A mesh file and the files it refers to, ready for upload. OBJ and PLY are converted here.

use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::{Component, Path, PathBuf},
};

use percent_encoding::percent_decode_str;
use serde_json::Value;

use crate::{
    convert::{self, Converted, Kind},
    error::{Error, Result},
    transfer::Blob,
};

/// What one mesh needs on the server.
#[derive(Debug)]
pub(crate) struct MeshFiles {
    pub(crate) mesh: Blob,
    /// External files by the URI the mesh uses.
    pub(crate) resources: Vec<(String, Blob)>,
    /// What the user should know of the conversion.
    pub(crate) notes: Vec<String>,
}

/// Opens, converts where needed, and hashes. Blocks.
pub(crate) fn read(path: &Path) -> Result<MeshFiles> {
    let mut file = File::open(path).map_err(|e| Error::reading(path, &e))?;
    let mut head = Vec::new();
    file.by_ref().take(4096).read_to_end(&mut head).map_err(|e| Error::reading(path, &e))?;
    match convert::kind(path, &head)? {
        Kind::Obj => converted(path, convert::obj(path, &whole(path)?)?),
        Kind::Ply => converted(path, convert::ply(path, &whole(path)?)?),
        Kind::Gltf => referring(path, &whole(path)?),
        Kind::Glb => referring(path, &glb_json(path, &mut file)?),
    }
}

fn whole(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|e| Error::reading(path, &e))
}

fn converted(path: &Path, converted: Converted) -> Result<MeshFiles> {
    let mesh = Blob::of_bytes(path.display().to_string(), converted.glb);
    Ok(MeshFiles { mesh, resources: Vec::new(), notes: converted.notes })
}

fn referring(path: &Path, json: &[u8]) -> Result<MeshFiles> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut resources = Vec::new();
    // A document that is not JSON refers to nothing; the service says what is wrong with it.
    if let Ok(document) = serde_json::from_slice::<Value>(json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json)) {
        for reference in references(&document) {
            if let Some(blob) = resource(folder, &reference)? {
                resources.push((reference.uri, blob));
            }
        }
    }
    Ok(MeshFiles { mesh: Blob::of_file(path)?, resources, notes: Vec::new() })
}

/// The JSON chunk of a GLB; empty where the file is too damaged to have one.
fn glb_json(path: &Path, file: &mut File) -> Result<Vec<u8>> {
    let failed = |e: std::io::Error| Error::reading(path, &e);
    let mut header = Vec::new();
    file.seek(SeekFrom::Start(0)).map_err(failed)?;
    file.by_ref().take(20).read_to_end(&mut header).map_err(failed)?;
    let mut json = Vec::new();
    if let Some(length) = header.get(12..16).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes) {
        file.by_ref().take(length.into()).read_to_end(&mut json).map_err(failed)?;
    }
    Ok(json)
}

/// A URI of a glTF file, and where it stands.
#[derive(Debug, PartialEq)]
struct Reference {
    field: String,
    uri: String,
    /// Geometry cannot do without; an image can be missing, the service warns.
    required: bool,
}

/// URIs of buffers and images that name other files, each once.
fn references(document: &Value) -> Vec<Reference> {
    let mut found: Vec<Reference> = Vec::new();
    for (list, required) in [("buffers", true), ("images", false)] {
        for (index, entry) in document[list].as_array().into_iter().flatten().enumerate() {
            let Some(uri) = entry["uri"].as_str().filter(|uri| !uri.starts_with("data:")) else { continue };
            match found.iter_mut().find(|known| known.uri == uri) {
                Some(known) => known.required |= required,
                None => found.push(Reference { field: format!("{list}[{index}].uri"), uri: uri.to_owned(), required }),
            }
        }
    }
    found
}

fn resource(folder: &Path, reference: &Reference) -> Result<Option<Blob>> {
    let path = resolve(folder, reference)?;
    if !path.is_file() {
        if !reference.required {
            return Ok(None);
        }
        let message = format!(
            "'{}' is not there: {} is missing or no file; put it beside the mesh",
            reference.uri,
            path.display()
        );
        return Err(Error::invalid(&reference.field, message));
    }
    Blob::of_file(&path).map(Some)
}

/// The file a URI means. It stays inside the mesh's folder: a mesh from elsewhere must not send private
/// files to a server.
fn resolve(folder: &Path, reference: &Reference) -> Result<PathBuf> {
    let refuse = |why: &str| Error::invalid(&reference.field, format!("'{}' {why}", reference.uri));
    if let Some((scheme, _)) = reference.uri.split_once("://") {
        return Err(refuse(&format!(
            "is a {scheme} address; download the file beside the mesh and name it relatively"
        )));
    }
    let decoded = percent_decode_str(&reference.uri).decode_utf8().map_err(|_| refuse("is not UTF-8 when decoded"))?;
    let relative = Path::new(decoded.as_ref());
    if decoded.is_empty() || decoded.contains('\0') {
        return Err(refuse("names no file"));
    }
    if !stays_inside(relative) {
        return Err(refuse("lies outside the mesh's folder; copy the file there and name it relatively"));
    }
    let path = folder.join(relative);
    let literal = folder.join(&reference.uri);
    // Some writers do not encode: a file literally named `a%20b.png` is meant as it is.
    Ok(if !path.is_file() && literal.is_file() && stays_inside(Path::new(&reference.uri)) { literal } else { path })
}

/// Whether a relative path never leaves the folder it starts from.
pub(crate) fn stays_inside(relative: &Path) -> bool {
    let mut depth = 0i32;
    for component in relative.components() {
        depth += match component {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            Component::ParentDir => -1,
            Component::RootDir | Component::Prefix(_) => return false,
        };
        if depth < 0 {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn reference(uri: &str) -> Reference {
        Reference { field: "buffers[0].uri".into(), uri: uri.into(), required: true }
    }

    #[test]
    fn references_are_found_once_and_data_is_not_one() {
        let document = json!({
            "buffers": [{ "uri": "a.bin" }, { "uri": "data:,x" }, {}],
            "images": [{ "uri": "b.png" }, { "uri": "b.png" }, { "bufferView": 0 }],
        });
        let uris: Vec<_> = references(&document).into_iter().map(|r| (r.field, r.uri, r.required)).collect();
        assert_eq!(
            uris,
            [
                ("buffers[0].uri".to_owned(), "a.bin".to_owned(), true),
                ("images[0].uri".to_owned(), "b.png".to_owned(), false)
            ]
        );
        assert!(references(&json!([1])).is_empty() && references(&json!({ "buffers": 3 })).is_empty());
    }

    #[test]
    fn uris_are_decoded_and_stay_inside() {
        let folder = Path::new("f");
        assert_eq!(resolve(folder, &reference("a%20b/../c.bin")), Ok("f/a b/../c.bin".into()));
        for bad in ["../x.bin", "a/../../x", "/etc/passwd", "%2e%2e/x", "http://h/x", "file:///x", "", "a%00b", "%ff"] {
            let error = resolve(folder, &reference(bad)).expect_err(bad);
            assert_eq!(error.field.as_deref(), Some("buffers[0].uri"), "{bad}");
        }
    }
}
