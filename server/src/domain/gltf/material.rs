//! Materials and the textures they use, as far as displacing and rendering need them.

use super::{displacement::SPELLINGS, json::At};
use crate::domain::{
    Error, Result,
    detail::Wrap,
    scene::{Alpha, Material, MaterialDisplacement, TextureUse},
};

pub(super) fn read_all(root: &At<'_>) -> Result<Vec<Material>> {
    root.list("materials")?.iter().map(|at| material(root, at)).collect()
}

fn material(root: &At<'_>, at: &At<'_>) -> Result<Material> {
    let pbr = at.get("pbrMetallicRoughness");
    let in_pbr = |key: &str| pbr.as_ref().and_then(|pbr| pbr.get(key));
    let factor_in_pbr = |key: &str| pbr.as_ref().map_or(Ok(None), |pbr| share(pbr, key));
    let factor = pbr.as_ref().map_or(Ok(None), |pbr| pbr.numbers::<4>("baseColorFactor"))?;
    let used = |texture: Option<At<'_>>| texture.map_or(Ok(None), |texture| texture_use(root, &texture));
    let (normal, occlusion) = (at.get("normalTexture"), at.get("occlusionTexture"));
    let scale = normal.as_ref().map_or(Ok(None), |texture| texture.number("scale"))?;
    let strength = occlusion.as_ref().map_or(Ok(None), |texture| share(texture, "strength"))?;
    Ok(Material {
        name: at.text("name")?.map(str::to_owned),
        base_color_factor: factor.map_or([1.0; 4], |f| f.map(|c| c as f32)),
        base_color: used(in_pbr("baseColorTexture"))?,
        metallic_factor: factor_in_pbr("metallicFactor")?.unwrap_or(1.0),
        roughness_factor: factor_in_pbr("roughnessFactor")?.unwrap_or(1.0),
        metallic_roughness: used(in_pbr("metallicRoughnessTexture"))?,
        has_normal_map: normal.is_some(),
        normal_uv_set: normal.as_ref().map_or(Ok(0), uv_set)?,
        normal: used(normal)?,
        normal_scale: scale.unwrap_or(1.0) as f32,
        occlusion: used(occlusion)?,
        occlusion_strength: strength.unwrap_or(1.0),
        emissive: used(at.get("emissiveTexture"))?,
        emissive_factor: emissive(at)?,
        unlit: at.extension("KHR_materials_unlit").is_some(),
        double_sided: at.flag("doubleSided")?,
        alpha: alpha(at)?,
        displacement: displacement(root, at)?,
    })
}

/// Modes that the format does not know are opaque, as its default is.
fn alpha(at: &At<'_>) -> Result<Alpha> {
    let cutoff = at.number("alphaCutoff")?.unwrap_or(0.5) as f32;
    Ok(match at.text("alphaMode")? {
        Some("MASK") => Alpha::Mask { cutoff },
        Some("BLEND") => Alpha::Blend,
        _ => Alpha::Opaque,
    })
}

/// A number that the format wants within [0, 1]; brought there.
fn share(at: &At<'_>, key: &str) -> Result<Option<f32>> {
    Ok(at.number(key)?.map(|value| value.clamp(0.0, 1.0) as f32))
}

fn emissive(at: &At<'_>) -> Result<[f32; 3]> {
    let factor = at.numbers::<3>("emissiveFactor")?.unwrap_or([0.0; 3]);
    let extension = at.extension("KHR_materials_emissive_strength");
    let strength = extension.as_ref().map_or(Ok(None), |e| e.number("emissiveStrength"))?.unwrap_or(1.0);
    Ok(factor.map(|c| (c.max(0.0) * strength.max(0.0)).min(f64::from(f32::MAX)) as f32))
}

fn displacement(root: &At<'_>, at: &At<'_>) -> Result<Option<MaterialDisplacement>> {
    let Some(extension) = SPELLINGS.iter().find_map(|name| at.extension(name)) else { return Ok(None) };
    let Some(texture) = extension.get("displacementGeometryTexture") else { return Ok(None) };
    let Some(texture) = texture_use(root, &texture)? else { return Ok(None) };
    let number = |key: &str, default: f64| Ok::<_, Error>(extension.number(key)?.unwrap_or(default) as f32);
    let factor = number("displacementGeometryFactor", 1.0)?;
    Ok(Some(MaterialDisplacement { texture, factor, offset: number("displacementGeometryOffset", 0.0)? }))
}

fn uv_set(info: &At<'_>) -> Result<u32> {
    let transform = info.extension("KHR_texture_transform");
    let overriding = transform.as_ref().map_or(Ok(None), |t| t.whole("texCoord"))?;
    let set = overriding.map_or_else(|| info.whole("texCoord"), |set| Ok(Some(set)))?.unwrap_or(0);
    u32::try_from(set).map_err(|_| info.error(format!("texCoord {set} is out of range")))
}

/// `None` when the texture's image is only in a format of an extension.
fn texture_use(root: &At<'_>, info: &At<'_>) -> Result<Option<TextureUse>> {
    let index = info.need("index")?.index_here(root.count("textures")?, "textures")?;
    let texture = root.element("textures", index)?;
    let sampler = texture.index("sampler", root.count("samplers")?, "samplers")?;
    let sampler = sampler.map(|i| root.element("samplers", i)).transpose()?;
    let image = texture.index("source", root.count("images")?, "images")?;
    let wrap = |key: &str| sampler.as_ref().map_or(Ok(Wrap::Repeat), |sampler| wrap(sampler, key));
    let wrap = [wrap("wrapS")?, wrap("wrapT")?];
    let map_from_uv = transform(info)?;
    let uv_set = uv_set(info)?;
    Ok(image.map(|image| TextureUse { image, uv_set, wrap, map_from_uv }))
}

fn wrap(sampler: &At<'_>, key: &str) -> Result<Wrap> {
    match sampler.whole(key)?.unwrap_or(10497) {
        10497 => Ok(Wrap::Repeat),
        33648 => Ok(Wrap::Mirror),
        33071 => Ok(Wrap::Clamp),
        other => Err(sampler.error(format!("{key} {other} is none of 10497, 33648 and 33071"))),
    }
}

/// KHR_texture_transform: translation · rotation · scale, the rotation clockwise in an image with v down.
fn transform(info: &At<'_>) -> Result<[[f32; 3]; 2]> {
    let Some(at) = info.extension("KHR_texture_transform") else { return Ok([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]) };
    let [tx, ty] = at.numbers("offset")?.unwrap_or([0.0, 0.0]);
    let [sx, sy] = at.numbers("scale")?.unwrap_or([1.0, 1.0]);
    let (sin, cos) = at.number("rotation")?.unwrap_or(0.0).sin_cos();
    Ok([[cos * sx, sin * sy, tx], [-sin * sx, cos * sy, ty]].map(|row| row.map(|x| x as f32)))
}
