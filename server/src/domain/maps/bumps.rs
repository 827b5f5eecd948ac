//! From the details of a request to what bends normals.

use std::sync::Arc;

use super::{
    MAX_COLOR_TEXELS,
    pixels::Pixels,
    resolve::{AssetBytes, Resolver, axes, direction_component, entries, signed},
    slopes::{Axis, laid_out, slopes},
};
use crate::domain::{
    Error, Result,
    bump::{Bump, BumpLayer, BumpSource, Bumps, NormalTexture, Shading},
    detail::{Layer, LayerSource, Map, Sampling, Wrap},
    encode::encode_linear_rgb16,
    image::BumpKind,
    look,
    request::{LayerRequest, MapRequest, MaterialDetail, Method, Preset, SourceRequest, Space, Swizzle},
    scene::Scene,
};

use displace_glsl::layout::bump::{BUMP_SLOTS, MOST_FORMULAS};

/// What of the request's details, and under bump and per pixel of the file's, bends normals by this method. The first normal
/// map in tangent space that a glTF material can hold becomes its texture. Of heights that are shown per pixel the slopes
/// do, unless a normal map of the request tells of them. The file's own bends normals besides, as it does where vertices move.
pub fn resolve_bumps(
    scene: &Scene,
    requests: &[MaterialDetail],
    method: Method,
    assets: &AssetBytes<'_>,
) -> Result<Bumps> {
    if method == Method::Flat {
        return Ok(Bumps { of_material: vec![Shading::default(); scene.materials.len()], ..Bumps::default() });
    }
    let resolver = Bender { resolver: Resolver::new(assets), method };
    let entries = entries(scene, requests)?;
    let made = requests.iter().enumerate().map(|(index, request)| resolver.shading(index, request));
    let made: Vec<Shading> = made.collect::<Result<_>>()?;
    let of = |entry: Option<usize>| entry.map_or_else(Shading::default, |entry| made[entry].clone());
    let mut of_material: Vec<Shading> = entries.of_material.iter().map(|entry| of(*entry)).collect();
    let is_bare = |shading: &Shading| match method {
        Method::Bump => shading.bump.is_none(),
        _ => method.marcher().is_some() && shading.bump.is_none() && !shading.has_normals,
    };
    for (material, shading) in of_material.iter_mut().enumerate().filter(|(_, shading)| is_bare(shading)) {
        shading.bump = resolver.of_file(scene, material)?;
    }
    Ok(Bumps { of_material, of_none: of(entries.of_none) })
}

struct Bender<'a> {
    resolver: Resolver<'a>,
    method: Method,
}

/// A normal map of a request.
struct Normals<'r> {
    map: &'r MapRequest,
    space: Space,
    swizzle: Swizzle,
    flip_green: bool,
    exact_zero: bool,
}

fn is_printed_height(layer: &LayerRequest) -> bool {
    layer.preset == Preset::AsPrinted && !layer.source.is_normal()
}

impl Bender<'_> {
    /// Whether heights are shown per pixel.
    fn is_marched(&self) -> bool {
        self.method.marcher().is_some()
    }

    fn shading(&self, index: usize, request: &MaterialDetail) -> Result<Shading> {
        let mut shading = Shading::default();
        let mut bump = Bump { uv_set: request.uv_set, ..Bump::default() };
        // As printed all bend the triangle's own normal, a map that a file could hold, too.
        bump.faceted = self.method == Method::Bump && request.layers.iter().any(is_printed_height);
        let has_normals = request.layers.iter().any(|layer| layer.source.is_normal());
        for (k, layer) in request.layers.iter().enumerate() {
            let field = format!("details[{index}].layers[{k}]");
            match &layer.source {
                SourceRequest::Normal { map, space, swizzle, flip_green, exact_zero } => {
                    let (space, swizzle, flip_green, exact_zero) = (*space, *swizzle, *flip_green, *exact_zero);
                    let normals = Normals { map, space, swizzle, flip_green, exact_zero };
                    shading.has_normals = true;
                    if !bump.faceted && shading.texture.is_none() && normals.fits_gltf(layer) {
                        let texture = self.texture(&field, &normals, layer, request.uv_set)?;
                        shading.texture = Some(Arc::new(texture));
                    } else {
                        bump.layers.push(self.normals(&field, &normals, layer)?);
                    }
                }
                SourceRequest::Vector { .. } | SourceRequest::DirectionMagnitude { .. }
                    if self.method == Method::Bump =>
                {
                    let message = "holds vectors, and bump bends by heights and normal maps: choose method vector";
                    return Err(Error::invalid(field, message));
                }
                SourceRequest::Height { .. } if self.is_marched() && !has_normals => {
                    bump.layers.push(self.heights(&self.resolver.layer(&field, layer)?)?);
                }
                _ if self.method == Method::Bump => {
                    // Only displacement prints the other sign.
                    let heights = Layer { scale: layer.scale, ..self.resolver.layer(&field, layer)? };
                    bump.layers.push(self.heights(&heights)?);
                }
                _ => {}
            }
        }
        check_count(index, &bump)?;
        shading.bump = (!bump.layers.is_empty()).then(|| Arc::new(bump));
        Ok(shading)
    }

    /// KHR_materials_displacement.
    fn of_file(&self, scene: &Scene, material: usize) -> Result<Option<Arc<Bump>>> {
        let Some(displacement) = &scene.materials[material].displacement else { return Ok(None) };
        let detail = self.resolver.of_file(scene, material, displacement)?;
        let layers = detail.layers.iter().map(|layer| self.heights(layer)).collect::<Result<_>>()?;
        Ok(Some(Arc::new(Bump { layers, uv_set: detail.uv_set, faceted: false })))
    }

    fn heights(&self, layer: &Layer) -> Result<BumpLayer> {
        let scale = layer.scale;
        match &layer.source {
            LayerSource::Height(map) => {
                let [across, down] = axes_of([map.width, map.height], map.wrap, map.sampling);
                check_texels(&across, &down)?;
                let slopes = slopes(&map.texels, map.width as usize, [&across, &down]);
                let source =
                    BumpSource::Map { map: Arc::new(slopes), wrap: [across.wrap, down.wrap], kind: BumpKind::Height };
                Ok(BumpLayer { source, scale, map_from_uv: behind(layer.map_from_uv, &across, &down) })
            }
            LayerSource::Expression(program) => {
                let source = BumpSource::Formula(Arc::clone(program));
                Ok(BumpLayer { source, scale, map_from_uv: layer.map_from_uv })
            }
            LayerSource::VectorTangent(_) | LayerSource::VectorObject(_) => {
                Err(Error::internal("vectors where heights are read"))
            }
        }
    }

    fn normals(&self, field: &str, normals: &Normals<'_>, layer: &LayerRequest) -> Result<BumpLayer> {
        let field = format!("{field}.normal");
        let pixels = self.resolver.pixels(&field, &normals.map.asset)?;
        Map::check_nodes(&field, [pixels.width, pixels.height], normals.map.sampling)?;
        let vectors = normals.vectors(&field, &pixels)?;
        let wrap = [normals.map.wrap.unwrap_or(Wrap::Repeat); 2];
        let [across, down] = axes_of([pixels.width, pixels.height], wrap, normals.map.sampling);
        check_texels(&across, &down)?;
        let map = Arc::new(laid_out(&vectors, pixels.width as usize, [&across, &down]));
        let kind = match (normals.space, layer.preset) {
            (Space::Object, _) => BumpKind::Object,
            (Space::Tangent, Preset::CySlice) => BumpKind::CySlice,
            (Space::Tangent, _) => BumpKind::Tangent,
        };
        let source = BumpSource::Map { map, wrap: [across.wrap, down.wrap], kind };
        let map_from_uv = behind(Layer::map_from_uv(layer.flip_v), &across, &down);
        Ok(BumpLayer { source, scale: layer.scale, map_from_uv })
    }

    fn texture(&self, field: &str, normals: &Normals<'_>, layer: &LayerRequest, uv_set: u32) -> Result<NormalTexture> {
        let field = format!("{field}.normal");
        let pixels = self.resolver.pixels(&field, &normals.map.asset)?;
        let own = (self.resolver.assets)(&normals.map.asset)?;
        let media_type = look::media_type(&own).filter(|_| normals.is_plain() && !layer.flip_v);
        axes(&field, &pixels, normals.swizzle)?;
        let (image, media_type) = match media_type {
            Some(media_type) => (own, media_type),
            None => (normals.encoded(&field, &pixels, layer.flip_v)?.into(), "image/png"),
        };
        let wrap = [normals.map.wrap.unwrap_or(Wrap::Repeat); 2];
        Ok(NormalTexture { image, media_type, uv_set, wrap, scale: layer.scale })
    }
}

impl Normals<'_> {
    /// Whether a normalTexture can stand for it.
    fn fits_gltf(&self, layer: &LayerRequest) -> bool {
        self.space == Space::Tangent && layer.preset == Preset::Right && self.map.sampling == Sampling::Center
    }

    /// Whether glTF reads the image as this layer does.
    fn is_plain(&self) -> bool {
        self.swizzle == Swizzle::default() && !self.flip_green && !self.exact_zero
    }

    /// x, y and z of each texel, [-1, 1].
    fn vectors(&self, field: &str, pixels: &Pixels) -> Result<Vec<f32>> {
        let axes = axes(field, pixels, self.swizzle)?;
        let bits = if self.exact_zero && !pixels.is_float() { pixels.bits() } else { 0 };
        let component = |value: f32| if bits > 0 { direction_component(bits, value) } else { 2.0 * value - 1.0 };
        let green = |k: usize, value: f32| if self.flip_green && axes[k] == 1 { -value } else { value };
        Ok(pixels.texels(axes, |k, value| green(k, signed(self.swizzle, k, component(value)))))
    }

    /// As a PNG of 16 bits that glTF reads as this layer does.
    fn encoded(&self, field: &str, pixels: &Pixels, flip_v: bool) -> Result<Vec<u8>> {
        let vectors = self.vectors(field, pixels)?;
        let word = |x: &f32| ((0.5 * x + 0.5).clamp(0.0, 1.0) * 65535.0 + 0.5) as u16;
        let rows = vectors.chunks_exact(3 * pixels.width as usize).map(|row| row.iter().map(word).collect::<Vec<_>>());
        let mut rows: Vec<Vec<u16>> = rows.collect();
        if flip_v {
            rows.reverse();
        }
        encode_linear_rgb16(pixels.width, pixels.height, &rows.concat())
    }
}

pub(super) fn axes_of([width, height]: [u32; 2], wrap: [Wrap; 2], sampling: Sampling) -> [Axis; 2] {
    [Axis::new(width as usize, wrap[0], sampling), Axis::new(height as usize, wrap[1], sampling)]
}

/// The rows of a map to (u, v, 1) with the axes behind it.
pub(super) fn behind([u, v]: [[f32; 3]; 2], across: &Axis, down: &Axis) -> [[f32; 3]; 2] {
    [across.row(u), down.row(v)]
}

fn check_texels(across: &Axis, down: &Axis) -> Result<()> {
    let (width, height) = (across.texels.len() as u64, down.texels.len() as u64);
    if width * height <= MAX_COLOR_TEXELS {
        return Ok(());
    }
    let message = format!(
        "a map that bends normals has {width} x {height} texels, those of its mirror counted; allowed are {MAX_COLOR_TEXELS} in all: scale it down"
    );
    Err(Error::too_large("details", message))
}

fn check_count(index: usize, bump: &Bump) -> Result<()> {
    let formulas = bump.layers.iter().filter(|layer| matches!(layer.source, BumpSource::Formula(_))).count();
    let maps = bump.layers.len() - formulas;
    if maps <= BUMP_SLOTS && formulas <= MOST_FORMULAS {
        return Ok(());
    }
    let message = format!(
        "{maps} maps besides the material's normal map bend its normals; allowed are {BUMP_SLOTS}: merge heights into one map"
    );
    Err(Error::invalid(format!("details[{index}].layers"), message))
}
