//! The attributes of an EXR in the order of their names: the library keeps them in a table that has none, and equal images
//! are to be equal files.

/// Of the magic number and the version.
const START: usize = 8;

/// Sorts those of the first header. Their lengths stay, so that the places of pixels in the file do, too. What is no such
/// header is left as it is.
pub(super) fn by_name(bytes: &mut [u8]) {
    let Some((attributes, end)) = attributes(bytes) else { return };
    let mut sorted: Vec<&[u8]> = attributes.into_iter().map(|(from, to)| &bytes[from..to]).collect();
    sorted.sort_unstable();
    let sorted = sorted.concat();
    bytes[START..end].copy_from_slice(&sorted);
}

/// Where each begins and ends, and where all do. Each is a name and the name of a type, both ended by 0, a length, and so
/// many bytes; a name of no length ends the header.
fn attributes(bytes: &[u8]) -> Option<(Vec<(usize, usize)>, usize)> {
    let (mut found, mut at) = (Vec::new(), START);
    while *bytes.get(at)? != 0 {
        let kind = after_text(bytes, at)?;
        let length = after_text(bytes, kind)?;
        let size = u32::from_le_bytes(bytes.get(length..length + 4)?.try_into().ok()?);
        let end = length.checked_add(4)?.checked_add(size as usize)?;
        found.push((at, end));
        at = end;
    }
    Some((found, at))
}

fn after_text(bytes: &[u8], from: usize) -> Option<usize> {
    Some(from + bytes.get(from..)?.iter().position(|byte| *byte == 0)? + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(attributes: &[(&str, &[u8])]) -> Vec<u8> {
        let mut bytes = b"magic...".to_vec();
        for (name, value) in attributes {
            bytes.extend(format!("{name}\0text\0").bytes());
            bytes.extend((value.len() as u32).to_le_bytes());
            bytes.extend(*value);
        }
        bytes.extend(b"\0pixels");
        bytes
    }

    #[test]
    fn attributes_come_by_name_and_pixels_stay() {
        let all = [("b", &b"two"[..]), ("channels", b"x\0y"), ("a", b"")];
        let mut bytes = file(&all);
        by_name(&mut bytes);
        assert_eq!(bytes, file(&[all[2], all[0], all[1]]));
    }

    #[test]
    fn what_ends_early_is_left_as_it_is() {
        let whole = file(&[("b", b"two"), ("a", b"one")]);
        for end in 0..whole.len() - 8 {
            let mut cut = whole[..end].to_vec();
            by_name(&mut cut);
            assert_eq!(cut, whole[..end]);
        }
    }
}
