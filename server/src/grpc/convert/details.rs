//! What is on the materials.

use std::collections::HashSet;

use displace_proto::v1;

use super::{digest, finite, join, known};
use crate::domain::{
    Error, Result,
    detail::{Sampling, Wrap},
    request::{Channel, LayerRequest, MapRequest, MaterialDetail, Method, Preset, SourceRequest, Space, Swizzle},
};

const MAX_DETAILS: usize = 1000;
const MAX_LAYERS: usize = 8;
const MAX_UV_SET: u32 = 7;
const MAX_EXPRESSION_BYTES: usize = 4096;

pub(super) fn parse(path: &str, details: Vec<v1::MaterialDetail>, method: Method) -> Result<Vec<MaterialDetail>> {
    count(path, details.len(), 0, MAX_DETAILS)?;
    let mut named = HashSet::new();
    let mut parsed = Vec::with_capacity(details.len());
    for (n, entry) in details.into_iter().enumerate() {
        let entry = detail(&format!("{path}[{n}]"), entry, method)?;
        if !named.insert(entry.material.clone()) {
            let name = entry.material.unwrap_or_default();
            let message = format!("'{name}' is named by another entry too; put all its layers into one");
            return Err(Error::invalid(format!("{path}[{n}].material"), message));
        }
        parsed.push(entry);
    }
    Ok(parsed)
}

fn detail(path: &str, detail: v1::MaterialDetail, method: Method) -> Result<MaterialDetail> {
    let uv_set = detail.uv_set;
    if uv_set > MAX_UV_SET {
        let message = format!("{uv_set} is out of range; allowed are 0 to {MAX_UV_SET}");
        return Err(Error::invalid(join(path, "uv_set"), message));
    }
    count(&join(path, "layers"), detail.layers.len(), 1, MAX_LAYERS)?;
    let parse = |(n, layer)| layer_of(&format!("{path}.layers[{n}]"), layer, method);
    let layers = detail.layers.into_iter().enumerate().map(parse).collect::<Result<Vec<_>>>()?;
    let material = Some(detail.material).filter(|name| !name.is_empty());
    Ok(MaterialDetail { material, layers, uv_set })
}

fn layer_of(path: &str, layer: v1::Layer, method: Method) -> Result<LayerRequest> {
    let source = layer.source.ok_or_else(|| Error::invalid(join(path, "source"), "is required"))?;
    let source = source_of(path, source)?;
    let is_height = matches!(source, SourceRequest::Height { .. } | SourceRequest::Expression { .. });
    let is_normal = matches!(source, SourceRequest::Normal { .. });
    if method == Method::Vector && matches!(source, SourceRequest::Height { .. }) {
        return Err(Error::invalid(join(path, "height"), "holds no vectors; use the method displacement"));
    }
    if is_normal && layer.midlevel.is_some() {
        let message = "is for heights, vectors and magnitudes; the zero of a normal map is at half range: leave it out";
        return Err(Error::invalid(join(path, "midlevel"), message));
    }
    if layer.invert_height && !is_height {
        return Err(Error::invalid(join(path, "invert_height"), "is for heights; this layer holds others"));
    }
    let preset = match known(&join(path, "preset"), layer.preset)? {
        v1::Preset::Unspecified => Preset::Right,
        v1::Preset::AsPrinted => Preset::AsPrinted,
        v1::Preset::Cyslice => Preset::CySlice,
    };
    check_preset(&join(path, "preset"), preset, &source)?;
    Ok(LayerRequest {
        source,
        scale: finite(&join(path, "scale"), layer.scale.unwrap_or(1.0))?,
        midlevel: layer.midlevel.map(|midlevel| finite(&join(path, "midlevel"), midlevel)).transpose()?,
        invert_height: layer.invert_height,
        flip_v: layer.flip_v,
        preset,
    })
}

/// What is printed of a kind of layer.
fn check_preset(field: &str, preset: Preset, source: &SourceRequest) -> Result<()> {
    let is_normal = matches!(source, SourceRequest::Normal { .. });
    let in_tangent_space = matches!(source, SourceRequest::Normal { space: Space::Tangent, .. });
    let message = match preset {
        Preset::AsPrinted if is_normal => "as-printed prints nothing of normal maps: leave it out, or take cyslice",
        Preset::CySlice if !in_tangent_space => {
            "cyslice prints the frame of normal maps in tangent space: leave it out for other layers"
        }
        _ => return Ok(()),
    };
    Err(Error::invalid(field, message))
}

fn source_of(path: &str, source: v1::layer::Source) -> Result<SourceRequest> {
    use v1::layer::Source;
    Ok(match source {
        Source::Height(height) => SourceRequest::Height {
            map: map(&join(path, "height.map"), height.map)?,
            channel: channel(&join(path, "height.channel"), height.channel)?,
        },
        Source::Vector(vector) => SourceRequest::Vector {
            map: map(&join(path, "vector.map"), vector.map)?,
            space: space(&join(path, "vector.space"), vector.space)?,
            swizzle: swizzle(&join(path, "vector.swizzle"), &vector.swizzle)?,
        },
        Source::Direction(direction) => SourceRequest::DirectionMagnitude {
            direction: map(&join(path, "direction.direction"), direction.direction)?,
            magnitude: map(&join(path, "direction.magnitude"), direction.magnitude)?,
            space: space(&join(path, "direction.space"), direction.space)?,
            swizzle: swizzle(&join(path, "direction.swizzle"), &direction.swizzle)?,
        },
        Source::Normal(normal) => SourceRequest::Normal {
            map: map(&join(path, "normal.map"), normal.map)?,
            space: space(&join(path, "normal.space"), normal.space)?,
            swizzle: swizzle(&join(path, "normal.swizzle"), &normal.swizzle)?,
            flip_green: normal.flip_green,
            exact_zero: normal.exact_zero,
        },
        Source::Expression(expression) => {
            count(&join(path, "expression.source"), expression.source.len(), 1, MAX_EXPRESSION_BYTES)?;
            SourceRequest::Expression { source: expression.source }
        }
    })
}

fn map(path: &str, map: Option<v1::MapSource>) -> Result<MapRequest> {
    let map = map.ok_or_else(|| Error::invalid(path, "is required; name the map by its digest"))?;
    let asset = digest(&join(path, "asset"), map.asset.as_ref())?;
    let wrap = match known(&join(path, "wrap"), map.wrap)? {
        v1::Wrap::Unspecified => None,
        v1::Wrap::Repeat => Some(Wrap::Repeat),
        v1::Wrap::Mirror => Some(Wrap::Mirror),
        v1::Wrap::Clamp => Some(Wrap::Clamp),
    };
    let sampling = match known(&join(path, "sampling"), map.sampling)? {
        v1::Sampling::Unspecified | v1::Sampling::Center => Sampling::Center,
        v1::Sampling::Node => Sampling::Node,
    };
    Ok(MapRequest { asset, wrap, sampling })
}

fn channel(field: &str, channel: i32) -> Result<Channel> {
    Ok(match known(field, channel)? {
        v1::Channel::Unspecified | v1::Channel::R => Channel::R,
        v1::Channel::G => Channel::G,
        v1::Channel::B => Channel::B,
        v1::Channel::A => Channel::A,
    })
}

fn space(field: &str, space: i32) -> Result<Space> {
    Ok(match known(field, space)? {
        v1::Space::Unspecified | v1::Space::Tangent => Space::Tangent,
        v1::Space::Object => Space::Object,
    })
}

/// A permutation of `rgb`, upper case negated.
fn swizzle(field: &str, text: &str) -> Result<Swizzle> {
    if text.is_empty() {
        return Ok(Swizzle::default());
    }
    let axis =
        |letter: char| "rgb".find(letter.to_ascii_lowercase()).map(|axis| (axis as u8, letter.is_ascii_uppercase()));
    let axes: Option<Vec<(u8, bool)>> = text.chars().map(axis).collect();
    let axes: Option<[(u8, bool); 3]> = axes.and_then(|axes| axes.try_into().ok());
    let is_permutation = |axes: &[(u8, bool); 3]| axes.iter().fold(0, |seen, (axis, _)| seen | 1 << axis) == 0b111;
    axes.filter(is_permutation).map(Swizzle).ok_or_else(|| {
        let text = text.escape_default();
        Error::invalid(field, format!("'{text}' is not a permutation of rgb, upper case for negative, such as rBg"))
    })
}

fn count(field: &str, count: usize, least: usize, most: usize) -> Result<()> {
    if (least..=most).contains(&count) {
        return Ok(());
    }
    Err(Error::invalid(field, format!("has length {count}; allowed are {least} to {most}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swizzles_are_permutations_with_signs() {
        assert_eq!(swizzle("s", "rBg").unwrap(), Swizzle([(0, false), (2, true), (1, false)]));
        assert_eq!(swizzle("s", "").unwrap(), Swizzle::default());
        for bad in ["rrg", "rg", "rgba", "xyz"] {
            assert!(swizzle("s", bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn errors_name_the_path_of_the_field() {
        let layer = v1::Layer {
            source: Some(v1::layer::Source::Expression(v1::Expression { source: "u".into() })),
            scale: Some(f32::NAN),
            ..Default::default()
        };
        let entry = v1::MaterialDetail { layers: vec![layer], ..Default::default() };
        let error = parse("details", vec![entry], Method::Displacement).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("details[0].layers[0].scale"));
    }
}
