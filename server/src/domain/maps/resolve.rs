//! From the details of a request (and of the file's materials) to the detail of each material.

use std::{cell::RefCell, collections::HashMap, sync::Arc};

use bytes::Bytes;

use super::pixels::{Pixels, decode};
use crate::domain::{
    Digest, Error, ErrorKind, Result,
    detail::{Detail, Layer, LayerSource, Map, Sampling, Wrap},
    expression::Program,
    plan::MAX_TEXELS,
    request::{Channel, LayerRequest, MapRequest, MaterialDetail, Preset, SourceRequest, Space, Swizzle},
    scene::{MaterialDisplacement, Scene},
};

/// How assets are read.
pub type AssetBytes<'a> = dyn Fn(&Digest) -> Result<Bytes> + 'a;

/// The detail of every material.
#[derive(Clone, Debug, Default)]
pub struct Details {
    /// Parallel to `Scene::materials`.
    pub of_material: Vec<Option<Arc<Detail>>>,
    /// Of primitives without a material.
    pub of_none: Option<Arc<Detail>>,
}

impl Details {
    #[must_use]
    pub fn of(&self, material: Option<usize>) -> Option<&Arc<Detail>> {
        match material {
            Some(index) => self.of_material.get(index)?.as_ref(),
            None => self.of_none.as_ref(),
        }
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.of_none.is_none() && self.of_material.iter().all(Option::is_none)
    }
}

/// The request's details by material; an entry without a material is for all that no other entry names. A
/// material the request leaves unmoved keeps the displacement of the file (KHR_materials_displacement).
pub fn resolve(scene: &Scene, requests: &[MaterialDetail], assets: &AssetBytes<'_>) -> Result<Details> {
    let resolver = Resolver::new(assets);
    let entries = entries(scene, requests)?;
    let made = requests.iter().enumerate().map(|(index, request)| Ok(resolver.detail(index, request)?.map(Arc::new)));
    let made: Vec<Option<Arc<Detail>>> = made.collect::<Result<_>>()?;
    let of = |entry: &Option<usize>| entry.and_then(|entry| made[entry].clone());
    let mut details =
        Details { of_material: entries.of_material.iter().map(of).collect(), of_none: of(&entries.of_none) };
    for (material, slot) in details.of_material.iter_mut().enumerate().filter(|(_, slot)| slot.is_none()) {
        if let Some(displacement) = &scene.materials[material].displacement {
            *slot = Some(Arc::new(resolver.of_file(scene, material, displacement)?));
        }
    }
    Ok(details)
}

/// Which entry of a request is for which material.
pub(super) struct Entries {
    /// Parallel to `Scene::materials`.
    pub(super) of_material: Vec<Option<usize>>,
    pub(super) of_none: Option<usize>,
}

/// An entry without a material is for all that no other entry names.
pub(super) fn entries(scene: &Scene, requests: &[MaterialDetail]) -> Result<Entries> {
    let mut of_material = vec![None; scene.materials.len()];
    for (index, request) in requests.iter().enumerate() {
        let Some(name) = &request.material else { continue };
        for material in materials_called(scene, index, name)? {
            if of_material[material].replace(index).is_some() {
                let field = format!("details[{index}].material");
                return Err(Error::invalid(
                    field,
                    format!("'{name}' is named by an earlier entry too: give one entry for each material"),
                ));
            }
        }
    }
    let mut general = requests.iter().enumerate().filter(|(_, request)| request.material.is_none());
    let of_none = general.next().map(|(index, _)| index);
    if let Some((index, _)) = general.next() {
        let field = format!("details[{index}].material");
        return Err(Error::invalid(
            field,
            "a second entry is for all materials: name a material, or merge the entries",
        ));
    }
    Ok(Entries { of_material: of_material.into_iter().map(|own: Option<usize>| own.or(of_none)).collect(), of_none })
}

fn materials_called(scene: &Scene, index: usize, name: &str) -> Result<Vec<usize>> {
    let is_called = |i: &usize| scene.materials[*i].name.as_deref() == Some(name);
    let found: Vec<usize> = (0..scene.materials.len()).filter(is_called).collect();
    if found.is_empty() {
        let known: Vec<&str> = scene.materials.iter().filter_map(|m| m.name.as_deref()).collect();
        let known =
            if known.is_empty() { "it has no named materials".into() } else { format!("it has {}", known.join(", ")) };
        return Err(Error::new(ErrorKind::NotFound, format!("the mesh has no material '{name}'; {known}"))
            .with_field(format!("details[{index}].material")));
    }
    Ok(found)
}

pub(super) struct Resolver<'a> {
    pub(super) assets: &'a AssetBytes<'a>,
    /// Decoded once however many layers use it.
    images: RefCell<HashMap<Digest, Arc<Pixels>>>,
    /// Held once however many layers have it, by all that it is made of.
    maps: RefCell<HashMap<String, Arc<Map>>>,
}

/// Values of all maps of one job together: 2 GiB.
const MAX_VALUES: u64 = MAX_TEXELS;
/// Of all decoded images of one job together.
const MAX_IMAGE_BYTES: u64 = 4 << 30;

impl<'a> Resolver<'a> {
    pub(super) fn new(assets: &'a AssetBytes<'a>) -> Self {
        Self { assets, images: RefCell::default(), maps: RefCell::default() }
    }
}

impl Resolver<'_> {
    /// None where nothing moves; normal maps bend alone.
    fn detail(&self, index: usize, request: &MaterialDetail) -> Result<Option<Detail>> {
        let moves = |layer: &LayerRequest| !matches!(layer.source, SourceRequest::Normal { .. });
        let layers = request.layers.iter().enumerate().filter(|(_, layer)| moves(layer));
        let layers = layers.map(|(k, layer)| self.layer(&format!("details[{index}].layers[{k}]"), layer));
        let layers: Vec<Layer> = layers.collect::<Result<_>>()?;
        Ok((!layers.is_empty()).then_some(Detail { layers, uv_set: request.uv_set }))
    }

    pub(super) fn layer(&self, field: &str, request: &LayerRequest) -> Result<Layer> {
        let (source, midlevel) = match &request.source {
            SourceRequest::Height { map, channel } => {
                let key = format!("{map:?} {channel:?} {}", request.invert_height);
                let make = || self.height(&format!("{field}.height"), map, *channel, request.invert_height);
                (LayerSource::Height(self.shared(key, make)?), request.midlevel.unwrap_or(0.0))
            }
            SourceRequest::Vector { map, space, swizzle } => {
                let key = format!("{map:?} {swizzle:?} {:?}", request.midlevel);
                let make = || self.vector(&format!("{field}.vector"), map, *swizzle, request.midlevel);
                (placed(self.shared(key, make)?, *space), 0.0)
            }
            SourceRequest::DirectionMagnitude { direction, magnitude, space, swizzle } => {
                let how = (request.midlevel, request.invert_height, request.preset);
                let key = format!("{direction:?} {magnitude:?} {swizzle:?} {how:?}");
                let make = || self.direction_magnitude(field, direction, magnitude, *swizzle, request);
                (placed(self.shared(key, make)?, *space), 0.0)
            }
            SourceRequest::Expression { source } => {
                let program = Program::parse(source).map_err(|e| e.with_field(format!("{field}.expression")))?;
                (LayerSource::Expression(Arc::new(program)), request.midlevel.unwrap_or(0.0))
            }
            SourceRequest::Normal { .. } => return Err(Error::internal("a normal map moves nothing")),
        };
        // West 2007 prints P − N·mag·Km for heights: inwards. Directions carry their own sign.
        let inwards = request.preset == Preset::AsPrinted
            && matches!(source, LayerSource::Height(_) | LayerSource::Expression(_));
        Ok(Layer {
            source,
            scale: if inwards { -request.scale } else { request.scale },
            midlevel,
            map_from_uv: Layer::map_from_uv(request.flip_v),
        })
    }

    fn shared(&self, key: String, make: impl FnOnce() -> Result<Map>) -> Result<Arc<Map>> {
        if let Some(known) = self.maps.borrow().get(&key) {
            return Ok(Arc::clone(known));
        }
        let map = Arc::new(make()?);
        self.maps.borrow_mut().insert(key, Arc::clone(&map));
        Ok(map)
    }

    /// Refuses a map of so many channels before there is room for it.
    fn check_room(&self, pixels: &Pixels, channels: u64) -> Result<()> {
        let held: u64 = self.maps.borrow().values().map(|map| map.texels.len() as u64).sum();
        if held + u64::from(pixels.width) * u64::from(pixels.height) * channels <= MAX_VALUES {
            return Ok(());
        }
        let message = format!("the maps of one job hold more than {MAX_VALUES} values: use smaller or fewer maps");
        Err(Error::too_large("details", message))
    }

    pub(super) fn pixels(&self, field: &str, asset: &Digest) -> Result<Arc<Pixels>> {
        if let Some(known) = self.images.borrow().get(asset) {
            return Ok(Arc::clone(known));
        }
        let pixels = Arc::new(decode(field, &(self.assets)(asset)?)?);
        let held: u64 = self.images.borrow().values().map(|pixels| pixels.bytes()).sum();
        if held + pixels.bytes() > MAX_IMAGE_BYTES {
            let message = format!(
                "the images of one job take more than {MAX_IMAGE_BYTES} bytes once decoded: use smaller or fewer maps"
            );
            return Err(Error::too_large(field, message));
        }
        self.images.borrow_mut().insert(*asset, Arc::clone(&pixels));
        Ok(pixels)
    }

    fn height(&self, field: &str, request: &MapRequest, channel: Channel, invert: bool) -> Result<Map> {
        let pixels = self.pixels(field, &request.asset)?;
        let channel = channel_index(field, &pixels, channel)?;
        self.check_room(&pixels, 1)?;
        let texels = pixels.texels([channel], |_, v| if invert { 1.0 - v } else { v });
        map(field, &pixels, 1, texels, request)
    }

    fn vector(&self, field: &str, request: &MapRequest, swizzle: Swizzle, midlevel: Option<f32>) -> Result<Map> {
        let pixels = self.pixels(field, &request.asset)?;
        let axes = axes(field, &pixels, swizzle)?;
        self.check_room(&pixels, 3)?;
        let midlevel = midlevel.unwrap_or(if pixels.is_float() { 0.0 } else { 0.5 });
        let texels = pixels.texels(axes, |k, v| signed(swizzle, k, v - midlevel));
        map(field, &pixels, 3, texels, request)
    }

    /// P' = P + normalize(d)·magnitude (West 2007, put right: d = 2c − 1 with an exact zero).
    fn direction_magnitude(
        &self,
        field: &str,
        direction: &MapRequest,
        magnitude: &MapRequest,
        swizzle: Swizzle,
        request: &LayerRequest,
    ) -> Result<Map> {
        let field_of = |part: &str| format!("{field}.{part}");
        let d = self.pixels(&field_of("direction"), &direction.asset)?;
        let m = self.pixels(&field_of("magnitude"), &magnitude.asset)?;
        if (d.width, d.height) != (m.width, m.height) {
            return Err(Error::invalid(
                field_of("magnitude"),
                format!(
                    "has {} x {} pixels and the direction map {} x {}: both must be of one size",
                    m.width, m.height, d.width, d.height
                ),
            ));
        }
        let axes = axes(&field_of("direction"), &d, swizzle)?;
        self.check_room(&d, 3)?;
        let as_printed = request.preset == Preset::AsPrinted;
        let bits = d.bits();
        let mut texels =
            d.texels(axes, |k, v| signed(swizzle, k, if as_printed { v } else { direction_component(bits, v) }));
        let midlevel = request.midlevel.unwrap_or(0.0);
        let lengths = m.texels([0], |_, v| if request.invert_height { 1.0 - v - midlevel } else { v - midlevel });
        for (vector, length) in texels.chunks_exact_mut(3).zip(lengths) {
            scale_direction(vector, length);
        }
        map(&field_of("direction"), &d, 3, texels, direction)
    }

    /// KHR_materials_displacement: H = factor · red + offset.
    pub(super) fn of_file(
        &self,
        scene: &Scene,
        material: usize,
        displacement: &MaterialDisplacement,
    ) -> Result<Detail> {
        let field = format!("materials[{material}].extensions.KHR_materials_displacement");
        let bytes = scene.images.get(displacement.texture.image).and_then(|image| image.bytes.as_ref());
        let bytes = bytes.ok_or_else(|| Error::invalid(&field, "its image is not there: upload the file it names"))?;
        let (factor, offset, wrap) = (displacement.factor, displacement.offset, displacement.texture.wrap);
        let make = || {
            let pixels = decode(&field, bytes)?;
            self.check_room(&pixels, 1)?;
            Ok(Map {
                width: pixels.width,
                height: pixels.height,
                channels: 1,
                texels: Arc::new(pixels.texels([0], |_, v| factor * v + offset)),
                wrap,
                sampling: Sampling::Center,
                source_bits: pixels.bits(),
            })
        };
        let key = format!("image {} {factor} {offset} {wrap:?}", displacement.texture.image);
        let map = self.shared(key, make)?;
        let map_from_uv = displacement.texture.map_from_uv;
        let layer = Layer { source: LayerSource::Height(map), scale: 1.0, midlevel: 0.0, map_from_uv };
        Ok(Detail { layers: vec![layer], uv_set: displacement.texture.uv_set })
    }
}

fn placed(map: Arc<Map>, space: Space) -> LayerSource {
    match space {
        Space::Tangent => LayerSource::VectorTangent(map),
        Space::Object => LayerSource::VectorObject(map),
    }
}

fn map(field: &str, pixels: &Pixels, channels: u32, texels: Vec<f32>, request: &MapRequest) -> Result<Map> {
    Map::check_nodes(field, [pixels.width, pixels.height], request.sampling)?;
    let wrap = [request.wrap.unwrap_or(Wrap::Repeat); 2];
    Ok(Map {
        width: pixels.width,
        height: pixels.height,
        channels,
        texels: texels.into(),
        wrap,
        sampling: request.sampling,
        source_bits: pixels.bits(),
    })
}

fn channel_index(field: &str, pixels: &Pixels, channel: Channel) -> Result<usize> {
    let alpha = matches!(pixels.channels, 2 | 4).then(|| pixels.channels - 1);
    let found = match (channel, pixels.channels) {
        (Channel::R, _) => Some(0),
        (Channel::G, 3..) => Some(1),
        (Channel::B, 3..) => Some(2),
        (Channel::A, _) => alpha,
        _ => None,
    };
    found.ok_or_else(|| {
        Error::invalid(field, format!("has {} channel(s) and no {channel:?}: choose another channel", pixels.channels))
    })
}

pub(super) fn axes(field: &str, pixels: &Pixels, swizzle: Swizzle) -> Result<[usize; 3]> {
    if pixels.channels < 3 {
        return Err(Error::invalid(
            field,
            format!("has {} channel(s); vectors need red, green and blue", pixels.channels),
        ));
    }
    Ok(swizzle.0.map(|(axis, _)| usize::from(axis)))
}

pub(super) fn signed(swizzle: Swizzle, k: usize, value: f32) -> f32 {
    if swizzle.0[k].1 { -value } else { value }
}

/// A component in [−1, 1] with an exact zero: (c − 128) / 127 for 8 bits, (c − 32768) / 32767 for 16.
pub(super) fn direction_component(bits: u32, value: f32) -> f32 {
    let component = match bits {
        8 => (value * 255.0 - 128.0) / 127.0,
        16 => (value * 65535.0 - 32768.0) / 32767.0,
        _ => value,
    };
    component.max(-1.0)
}

/// The direction to unit length, times `length`; an undefined direction displaces nothing.
fn scale_direction(vector: &mut [f32], length: f32) {
    let norm = vector.iter().map(|x| x * x).sum::<f32>().sqrt();
    let factor = if norm > 1e-6 { length / norm } else { 0.0 };
    vector.iter_mut().for_each(|x| *x *= factor);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neutral_grey_and_black_directions_displace_nothing() {
        for color in [128.0 / 255.0, 0.0] {
            let mut vector = [color; 3].map(|v| if color == 0.0 { 0.0 } else { direction_component(8, v) });
            scale_direction(&mut vector, 1.0);
            assert_eq!(vector, [0.0; 3]);
        }
    }

    #[test]
    fn the_flat_normal_map_colour_points_straight_out() {
        let mut vector = [128.0, 128.0, 255.0].map(|c| direction_component(8, c / 255.0));
        scale_direction(&mut vector, 0.5);
        assert_eq!(vector, [0.0, 0.0, 0.5]);
    }

    #[test]
    fn an_unknown_material_is_named_with_those_there_are() {
        let mut scene = Scene::default();
        scene.materials.push(crate::domain::scene::Material { name: Some("wood".into()), ..Default::default() });
        let request = MaterialDetail { material: Some("stone".into()), layers: vec![], uv_set: 0 };
        let error = resolve(&scene, &[request], &|_| Err(Error::internal("unused"))).expect_err("unknown");
        assert_eq!(error.to_string(), "details[0].material: the mesh has no material 'stone'; it has wood");
    }
}
