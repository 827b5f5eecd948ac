//! Material libraries of OBJ: name, diffuse colour and map, opacity. A library or a map that is missing or
//! damaged costs its looks, not the mesh; a note says so.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

use super::glb::{Image, Material};

/// What an MTL file says of a material.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    diffuse: [f32; 3],
    opacity: f32,
    map: Option<String>,
}

impl Default for Entry {
    fn default() -> Self {
        Self { diffuse: [1.0; 3], opacity: 1.0, map: None }
    }
}

/// The materials named, in that order; those no library defines are plain white.
pub(super) fn load(folder: &Path, libraries: &[String], names: &[String], notes: &mut Vec<String>) -> Vec<Material> {
    let mut entries = HashMap::new();
    for library in libraries {
        match read_inside(folder, library) {
            Ok(text) => parse(&String::from_utf8_lossy(&text), &mut entries),
            Err(why) => notes.push(format!("material library '{library}' is left out: {why}")),
        }
    }
    names.iter().map(|name| material(folder, name, entries.get(name.as_str()), notes)).collect()
}

fn material(folder: &Path, name: &str, entry: Option<&Entry>, notes: &mut Vec<String>) -> Material {
    let entry = entry.cloned().unwrap_or_default();
    let base_color = entry.map.as_deref().and_then(|map| match image(folder, map) {
        Ok(image) => Some(image),
        Err(why) => {
            notes.push(format!("map '{map}' of material '{name}' is left out: {why}"));
            None
        }
    });
    // A map replaces the diffuse colour: many writers leave that at 0 or 0.8 beside one.
    let [r, g, b] = if base_color.is_some() { [1.0; 3] } else { entry.diffuse };
    Material { name: name.to_owned(), base_color_factor: [r, g, b, entry.opacity], base_color }
}

fn parse(text: &str, entries: &mut HashMap<String, Entry>) {
    let mut current: Option<&mut Entry> = None;
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if keyword == "newmtl" {
            current = Some(entries.entry(rest.to_owned()).or_default());
            continue;
        }
        let Some(entry) = current.as_deref_mut() else { continue };
        let numbers: Vec<f32> =
            rest.split_whitespace().map_while(|w| w.parse().ok()).map(|v: f32| v.clamp(0.0, 1.0)).collect();
        match (keyword, &numbers[..]) {
            ("Kd", &[r, g, b, ..]) => entry.diffuse = [r, g, b],
            ("d", &[opacity, ..]) => entry.opacity = opacity,
            ("Tr", &[transparency, ..]) => entry.opacity = 1.0 - transparency,
            ("map_Kd", _) => entry.map = map_name(rest),
            _ => {}
        }
    }
    for entry in entries.values_mut() {
        entry.opacity = if entry.opacity.is_finite() { entry.opacity } else { 1.0 };
        entry.diffuse = entry.diffuse.map(|c| if c.is_finite() { c } else { 1.0 });
    }
}

/// The file of a map statement: what follows its options. Names with spaces occur; options have known sizes.
fn map_name(rest: &str) -> Option<String> {
    let mut words = rest;
    while let Some(option) = words.strip_prefix('-') {
        let (name, after) = option.split_once(char::is_whitespace)?;
        words = after.trim_start();
        let most = match name {
            "o" | "s" | "t" => 3,
            "mm" => 2,
            _ => 1,
        };
        for taken in 0..most {
            let (word, after) = words.split_once(char::is_whitespace)?;
            if taken > 0 && word.parse::<f32>().is_err() {
                break;
            }
            words = after.trim_start();
        }
    }
    (!words.is_empty()).then(|| words.to_owned())
}

fn image(folder: &Path, map: &str) -> Result<Image, String> {
    let bytes = read_inside(folder, map)?;
    let media_type = match &bytes[..] {
        [0x89, b'P', b'N', b'G', ..] => "image/png",
        [0xff, 0xd8, 0xff, ..] => "image/jpeg",
        _ => return Err("it is neither PNG nor JPEG, which glTF can hold".to_owned()),
    };
    Ok(Image { media_type, bytes })
}

/// Files named by files stay inside the folder: a mesh from elsewhere must not send private files away.
fn read_inside(folder: &Path, name: &str) -> Result<Vec<u8>, String> {
    let relative = PathBuf::from(name.replace('\\', "/"));
    if !crate::mesh_files::stays_inside(&relative) {
        return Err("it lies outside the mesh's folder; copy it there".to_owned());
    }
    std::fs::read(folder.join(relative)).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
        _ => e.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_opacity_and_maps_are_read() {
        let mut entries = HashMap::new();
        parse(
            "Kd 9 9 9\nnewmtl A b\nKd 0.5 0.25 1\nd 0.5\nmap_Kd -s 2 2 -bm 1 my map.png\nnewmtl C\nKd 1\nKd x y z\n",
            &mut entries,
        );
        let a = &entries["A b"];
        assert_eq!((a.diffuse, a.opacity, a.map.as_deref()), ([0.5, 0.25, 1.0], 0.5, Some("my map.png")));
        assert_eq!(entries["C"], Entry::default());
    }

    #[test]
    fn a_missing_library_or_map_is_a_note() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.mtl"), "newmtl A\nmap_Kd ../secret.png\nnewmtl B\nmap_Kd none.png\n")
            .unwrap();
        let mut notes = Vec::new();
        let libraries = ["a.mtl".to_owned(), "missing.mtl".to_owned()];
        let materials = load(folder.path(), &libraries, &["A".to_owned(), "B".to_owned()], &mut notes);
        assert_eq!(materials.len(), 2);
        assert_eq!(notes.len(), 3, "{notes:?}");
    }
}
