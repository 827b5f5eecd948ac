//! The encoded images of a document. They are optional: one that is not there is a warning.

use bytes::Bytes;

use super::{Resources, container::data_uri, json::At, source::Source, source::find};
use crate::domain::{Result, scene::SceneImage};

pub(super) fn read_all(root: &At<'_>, source: &Source<'_>, resources: &Resources<'_>) -> Result<Vec<SceneImage>> {
    root.list("images")?.iter().map(|at| image(at, source, resources)).collect()
}

fn image(at: &At<'_>, source: &Source<'_>, resources: &Resources<'_>) -> Result<SceneImage> {
    let declared = at.text("mimeType")?.map(str::to_owned);
    let (media_type, bytes) = match at.index("bufferView", source.views.len(), "bufferViews")? {
        Some(view) => (declared, Some(source.views[view].bytes.clone())),
        None => by_uri(at, declared, source, resources)?,
    };
    let sniffed = bytes.as_deref().and_then(media_type_of);
    // The bytes decide: files that say one format and hold another are common, and validators mind.
    let media_type = sniffed.map(str::to_owned).or(media_type).unwrap_or_default();
    Ok(SceneImage { media_type, bytes })
}

fn by_uri(
    at: &At<'_>,
    declared: Option<String>,
    source: &Source<'_>,
    resources: &Resources<'_>,
) -> Result<(Option<String>, Option<Bytes>)> {
    let Some(uri) = at.text("uri")? else { return Err(at.error("has neither uri nor bufferView")) };
    let found = match data_uri(uri) {
        Some(Ok((media_type, bytes))) => return Ok((declared.or(Some(media_type)), Some(bytes))),
        Some(Err(message)) => Err(message),
        None => find(uri, resources)
            .ok_or_else(|| format!("the file '{uri}' was not given: upload it and name it in `resources` by this URI")),
    };
    match found {
        Ok(bytes) => Ok((declared, Some(bytes))),
        Err(message) => {
            source.warn("image_missing", format!("{}: {message}; a plain pixel stands in for it", at.path));
            Ok((declared, None))
        }
    }
}

/// The media type of the formats glTF and its extensions know, from their first bytes.
pub(super) fn media_type_of(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xab, b'K', b'T', b'X', b' ', b'2', b'0', ..] => Some("image/ktx2"),
        [b'D', b'D', b'S', b' ', ..] => Some("image/vnd-ms.dds"),
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', b'f', ..] => Some("image/avif"),
        _ => None,
    }
}

/// A PNG of one pixel for an image that is missing: white changes no factor, and a normal map must be flat.
pub(super) fn stand_in(is_normal_map: bool) -> Bytes {
    let pixel = if is_normal_map { [128, 128, 255] } else { [255; 3] };
    let mut png = std::io::Cursor::new(Vec::new());
    // Writing one pixel to memory cannot fail; if it did, an empty image would say so.
    let written = image::RgbImage::from_pixel(1, 1, image::Rgb(pixel)).write_to(&mut png, image::ImageFormat::Png);
    written.map(|()| png.into_inner().into()).unwrap_or_default()
}
