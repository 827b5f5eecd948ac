//! Wavefront OBJ: polygons with positions, texture coordinates, normals and vertex colours.
//!
//! Read by hand rather than by a crate: faults are told by line, names need not be UTF-8, corners with and
//! without texture coordinates may mix, and no input can make it panic.

use std::collections::HashMap;

use super::{
    LineError,
    vertices::{Primitive, fan, linear_from_srgb, unit},
};

/// What an OBJ file holds.
#[derive(Debug, Default)]
pub(super) struct Model {
    pub(super) primitives: Vec<Primitive>,
    /// Names by `usemtl`, in the order in which primitives refer to them.
    pub(super) material_names: Vec<String>,
    /// Names by `mtllib`.
    pub(super) libraries: Vec<String>,
    pub(super) notes: Vec<String>,
}

pub(super) fn parse(text: &[u8]) -> Result<Model, LineError> {
    let mut reader = Reader::default();
    for (number, line) in logical_lines(text) {
        reader.line(&line).map_err(|message| LineError { line: number, message })?;
    }
    reader.finish()
}

/// Lines with comments cut and continued lines (`\` at the end) joined; numbered from 1 by their first.
fn logical_lines(text: &[u8]) -> impl Iterator<Item = (usize, String)> + '_ {
    let mut lines = text.split(|&byte| byte == b'\n').enumerate();
    std::iter::from_fn(move || {
        let (index, first) = lines.next()?;
        // A comment ends with its own line, whatever it ends with.
        let without_comment = |line| {
            let line = String::from_utf8_lossy(line);
            line.split('#').next().unwrap_or_default().to_owned()
        };
        let mut whole = without_comment(first);
        while whole.trim_end().ends_with('\\') {
            whole.truncate(whole.trim_end().len() - 1);
            let Some((_, next)) = lines.next() else { break };
            whole.push(' ');
            whole.push_str(&without_comment(next));
        }
        Some((index + 1, whole))
    })
}

/// Indices of a corner into the file's lists, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Corner {
    position: usize,
    uv: Option<usize>,
    normal: Option<usize>,
}

/// Triangles that have the same material and the same attributes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct GroupKey {
    material: Option<usize>,
    has_uvs: bool,
    has_normals: bool,
}

#[derive(Default)]
struct Group {
    vertex_of_corner: HashMap<Corner, u32>,
    primitive: Primitive,
}

#[derive(Default)]
struct Reader {
    positions: Vec<[f32; 3]>,
    /// As many as `positions` once the first is met; white before.
    colors: Vec<[f32; 4]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    model: Model,
    material: Option<usize>,
    groups: Vec<(GroupKey, Group)>,
    group_of_key: HashMap<GroupKey, usize>,
    left_out: Vec<String>,
}

impl Reader {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        let rest = line.trim_start().strip_prefix(keyword).unwrap_or_default().trim();
        match keyword {
            "v" => self.vertex(&numbers(words)?)?,
            "vt" => self.uvs.push(match numbers(words)?[..] {
                [u] => [u, 1.0],
                [u, v] | [u, v, _] => [u, 1.0 - v],
                ref other => return Err(format!("vt has {} numbers; allowed are 1 to 3", other.len())),
            }),
            "vn" => self.normals.push(
                numbers(words)?.try_into().map_err(|n: Vec<f32>| format!("vn has {} numbers; it needs 3", n.len()))?,
            ),
            "f" => self.face(words)?,
            "usemtl" => self.use_material(rest),
            "mtllib" => self.model.libraries.push(rest.to_owned()),
            "o" | "g" | "s" | "mg" | "vp" | "lod" | "shadow_obj" | "trace_obj" | "bevel" | "c_interp" | "d_interp" => {}
            other => self.leave_out(other),
        }
        Ok(())
    }

    fn vertex(&mut self, numbers: &[f32]) -> Result<(), String> {
        let color = match *numbers {
            [_, _, _] | [_, _, _, _] => None,
            [.., r, g, b] if numbers.len() == 6 || numbers.len() == 7 => Some([r, g, b]),
            _ => return Err(format!("v has {} numbers; allowed are x y z, with w, with r g b", numbers.len())),
        };
        if let Some(color) = color {
            self.colors.resize(self.positions.len(), [1.0; 4]);
            let [r, g, b] = color.map(linear_from_srgb);
            self.colors.push([r, g, b, 1.0]);
        }
        self.positions.push([numbers[0], numbers[1], numbers[2]]);
        Ok(())
    }

    fn use_material(&mut self, name: &str) {
        let names = &mut self.model.material_names;
        let index = names.iter().position(|known| known == name).unwrap_or_else(|| {
            names.push(name.to_owned());
            names.len() - 1
        });
        self.material = Some(index);
    }

    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<(), String> {
        let corners: Vec<Corner> = words.map(|word| self.corner(word)).collect::<Result<_, _>>()?;
        if corners.len() < 3 {
            return Err(format!("f has {} corners; a face needs at least 3", corners.len()));
        }
        let key = GroupKey {
            material: self.material,
            has_uvs: corners.iter().all(|c| c.uv.is_some()),
            has_normals: corners.iter().all(|c| c.normal.is_some()),
        };
        let index = *self.group_of_key.entry(key).or_insert_with(|| {
            self.groups.push((key, Group::default()));
            self.groups.len() - 1
        });
        let group = &mut self.groups[index].1;
        let vertices: Vec<u32> = corners
            .into_iter()
            .map(|corner| {
                let corner = Corner {
                    uv: corner.uv.filter(|_| key.has_uvs),
                    normal: corner.normal.filter(|_| key.has_normals),
                    ..corner
                };
                let next = group.vertex_of_corner.len() as u32;
                *group.vertex_of_corner.entry(corner).or_insert(next)
            })
            .collect();
        group.primitive.triangles.extend(fan(&vertices));
        Ok(())
    }

    /// `p`, `p/t`, `p//n` or `p/t/n`; numbers from 1, or from -1 backwards.
    fn corner(&self, word: &str) -> Result<Corner, String> {
        let mut parts = word.split('/');
        let position = index(parts.next(), self.positions.len(), "vertex", word)?
            .ok_or_else(|| format!("'{word}' names no vertex"))?;
        let uv = index(parts.next(), self.uvs.len(), "texture coordinate", word)?;
        let normal = index(parts.next(), self.normals.len(), "normal", word)?;
        if parts.next().is_some() {
            return Err(format!("'{word}' has more than three parts; a corner is v, v/vt, v//vn or v/vt/vn"));
        }
        Ok(Corner { position, uv, normal })
    }

    fn leave_out(&mut self, keyword: &str) {
        if self.left_out.len() < 8 && !self.left_out.iter().any(|known| known == keyword) {
            self.left_out.push(keyword.to_owned());
        }
    }

    fn finish(mut self) -> Result<Model, LineError> {
        if self.groups.is_empty() {
            return Err(LineError { line: 1, message: "the file has no faces (f), so there is no surface".to_owned() });
        }
        let colors = !self.colors.is_empty();
        self.colors.resize(self.positions.len(), [1.0; 4]);
        let mut bad_normals = false;
        for (key, group) in std::mem::take(&mut self.groups) {
            let mut primitive = Primitive { material: key.material, ..group.primitive };
            let mut corners: Vec<(Corner, u32)> = group.vertex_of_corner.into_iter().collect();
            corners.sort_unstable_by_key(|&(_, vertex)| vertex);
            let corners: Vec<Corner> = corners.into_iter().map(|(corner, _)| corner).collect();
            primitive.positions = corners.iter().map(|c| self.positions[c.position]).collect();
            primitive.colors = colors.then(|| corners.iter().map(|c| self.colors[c.position]).collect());
            primitive.uvs = key.has_uvs.then(|| corners.iter().filter_map(|c| c.uv).map(|i| self.uvs[i]).collect());
            if key.has_normals {
                primitive.normals = corners.iter().map(|c| c.normal.and_then(|i| unit(self.normals[i]))).collect();
                bad_normals |= primitive.normals.is_none();
            }
            self.model.primitives.push(primitive);
        }
        if bad_normals {
            self.model.notes.push("some normals have no length; those of their material are left out".to_owned());
        }
        if !self.left_out.is_empty() {
            self.model.notes.push(format!("left out, being no part of a polygon mesh: {}", self.left_out.join(", ")));
        }
        Ok(self.model)
    }
}

fn numbers<'w>(words: impl Iterator<Item = &'w str>) -> Result<Vec<f32>, String> {
    words
        .map(|word| {
            let value = word.parse::<f32>().ok().filter(|v| v.is_finite());
            value.ok_or_else(|| format!("'{word}' is not a finite number"))
        })
        .collect()
}

/// An index of the file as one from 0; `None` where the part is missing or empty.
fn index(part: Option<&str>, count: usize, what: &str, word: &str) -> Result<Option<usize>, String> {
    let Some(text) = part.filter(|text| !text.is_empty()) else { return Ok(None) };
    let number: i64 = text.parse().map_err(|_| format!("'{word}': '{text}' is not an index"))?;
    let count_i64 = i64::try_from(count).unwrap_or(i64::MAX);
    match number {
        1.. if number <= count_i64 => Ok(Some(number as usize - 1)),
        ..=-1 if number >= -count_i64 => Ok(Some((count_i64 + number) as usize)),
        _ => Err(format!("'{word}' names {what} {number}; there are {count} so far, counted from 1")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 2\n";

    fn read(faces: &str) -> Model {
        parse(format!("{QUAD}{faces}").as_bytes()).expect(faces)
    }

    #[test]
    fn a_quad_is_two_triangles_with_v_turned_down() {
        let model = read("f 1/1/1 2/2/1 3/3/1 4/4/1\n");
        let [primitive] = &model.primitives[..] else { panic!("one primitive") };
        assert_eq!(primitive.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(primitive.uvs.as_ref().unwrap()[0], [0.0, 1.0]);
        assert_eq!(primitive.normals.as_ref().unwrap()[0], [0.0, 0.0, 1.0]);
        assert_eq!(primitive.positions.len(), 4);
    }

    #[test]
    fn a_comment_that_ends_in_a_backslash_swallows_nothing() {
        let model = parse(b"# from C:\\models\\\nv 0 0 0\nv 1 0 \\\n0\nv 0 1 0\nf 1 2 3\n").unwrap();
        assert_eq!(model.primitives[0].positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn negative_indices_count_backwards() {
        assert_eq!(read("f -4 -3 -2").primitives[0].positions, read("f 1 2 3").primitives[0].positions);
    }

    #[test]
    fn corners_with_and_without_attributes_make_two_primitives() {
        let model = read("f 1/1 2/2 3/3\nf 1 3 4\n");
        let has_uvs: Vec<bool> = model.primitives.iter().map(|p| p.uvs.is_some()).collect();
        assert_eq!(has_uvs, [true, false]);
    }

    #[test]
    fn colours_follow_their_vertices() {
        let model = parse(b"v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 9 9 9\nf 1 2 3\n").unwrap();
        assert_eq!(model.primitives[0].colors.as_ref().unwrap()[1], [0.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn materials_split_the_mesh() {
        let model = read("mtllib a b.mtl\nusemtl Red paint\nf 1 2 3\nusemtl B\nf 1 3 4\nusemtl Red paint\nf 2 3 4\n");
        assert_eq!(model.material_names, ["Red paint", "B"]);
        assert_eq!(model.libraries, ["a b.mtl"]);
        assert_eq!(model.primitives.iter().map(|p| p.triangles.len()).collect::<Vec<_>>(), [2, 1]);
    }

    #[test]
    fn continued_lines_comments_and_foreign_bytes_are_read() {
        let model = parse(b"# caf\xe9\nv 0 0 0\r\nv 1 0 0 # x\nv 0 1 0\nf 1 \\\n 2 3\nl 1 2\n").unwrap();
        assert_eq!(model.primitives[0].triangles.len(), 1);
        assert_eq!(model.notes.len(), 1);
    }

    #[test]
    fn faults_are_told_by_line() {
        for (text, line, part) in [
            ("v 0 0\n", 1, "3"),
            ("v 0 0 x\n", 1, "'x'"),
            ("v 0 0 nan\n", 1, "'nan'"),
            ("v 0 0 0\nf 1 1\n", 2, "at least 3"),
            ("v 0 0 0\nf 1 1 2\n", 2, "vertex 2"),
            ("v 0 0 0\nf 0 1 1\n", 2, "vertex 0"),
            ("v 0 0 0\nf 1/5 1 1\n", 2, "texture coordinate 5"),
            ("v 0 0 0\nf -9223372036854775808 1 1\n", 2, "vertex"),
            ("v 0 0 0\nf 99999999999999999999 1 1\n", 2, "not an index"),
            ("v 0 0 0\nf 1/1/1/1 1 1\n", 2, ""),
            ("v 0 0 0\nf / 1 1\n", 2, "names no vertex"),
            ("", 1, "no faces"),
        ] {
            let error = parse(text.as_bytes()).expect_err(text);
            assert_eq!(error.line, line, "{text}: {error:?}");
            assert!(text == "v 0 0\n" || error.message.contains(part), "{text}: {error:?}");
        }
    }
}
