//! What bends normals: read before anything moves, given to the renderer, and what of it files can hold.

use std::{mem, sync::Arc};

use displace_glsl::layout::{bump::BUMP_SLOTS, raster::MAP_DETAIL};

use super::{
    AssetReader, WorkContext,
    inputs::{self, Inputs},
    looks::UvSets,
};
use crate::domain::{
    Error, Result,
    bump::{Bump, BumpLayer, BumpSource, Bumps},
    detail::Detail,
    image::{BumpUse, RenderFormula, RenderMap, RenderMaterial},
    look, maps,
    mesh::Mesh,
    plan::SurfacePlan,
    report::PassTime,
    request::{DisplaceRequest, Geometry, Method, Normals},
    scene::Scene,
    surface::{Layout, Shape, Surface},
};

/// Reads it, and puts into the scene's materials what they can hold.
pub(super) fn load(assets: &dyn AssetReader, scene: &mut Scene, request: &DisplaceRequest) -> Result<Bumps> {
    let read = |digest: &crate::domain::Digest| assets.read(digest);
    let mut bumps = maps::resolve_bumps(scene, &request.details, request.method, &read)?;
    require_some(&bumps, request.method)?;
    refuse_made_maps(&bumps, &request.geometry)?;
    look::replace_normals(scene, &mut bumps)?;
    for m in &scene.meshes {
        for (p, primitive) in m.mesh.primitives.iter().enumerate() {
            require_uvs(&m.mesh, p, bumps.of(primitive.material))?;
        }
    }
    Ok(bumps)
}

fn require_some(bumps: &Bumps, method: Method) -> Result<()> {
    let message = match method {
        Method::Bump if bumps.is_empty() => {
            "neither the request nor the mesh's materials have anything that bends normals: give a height map, an expression or a normal map, or choose method flat"
        }
        Method::Normal if !bumps.all().any(|shading| shading.has_normals) => {
            "the request has no normal map: give one, or choose method bump, which bends normals by heights"
        }
        _ => return Ok(()),
    };
    Err(Error::invalid("details", message))
}

/// A result has one normal map.
fn refuse_made_maps(bumps: &Bumps, geometry: &Geometry) -> Result<()> {
    if !matches!(geometry.normals, Normals::Map { .. }) || !bumps.all().any(|shading| shading.has_normals) {
        return Ok(());
    }
    let message = "a normal map would be made beside the one that the details give: leave one of them out";
    Err(Error::invalid("geometry.normals", message))
}

fn require_uvs(mesh: &Mesh, primitive: usize, shading: &crate::domain::bump::Shading) -> Result<()> {
    let of_bump = shading.bump.as_ref().filter(|bump| bump.reads_uv()).map(|bump| bump.uv_set);
    let Some(uv_set) = shading.texture.as_ref().map(|texture| texture.uv_set).or(of_bump) else { return Ok(()) };
    inputs::require_uv_set(mesh, primitive, uv_set)
}

/// Files hold one normal map of a material, in tangent space, and nothing else that bends normals.
pub(super) fn refuse_in_files(bumps: &Bumps, requests: &DisplaceRequest) -> Result<()> {
    let Some(bump) = bumps.all().find_map(|shading| shading.bump.as_ref()) else { return Ok(()) };
    let heights = "heights that bend normals, which glTF materials do not hold: choose displacement, or render it";
    let what = match bump.layers.first().map(|layer| &layer.source) {
        Some(BumpSource::Map { kind, .. }) => match kind {
            crate::domain::image::BumpKind::Object => {
                "a normal map in object space, which glTF materials do not hold: bake it into tangent space, or render it"
            }
            crate::domain::image::BumpKind::CySlice => {
                "a normal map in CySlice's frame, which glTF materials do not hold: take --swizzle grb, or render it"
            }
            crate::domain::image::BumpKind::Tangent => {
                "a second normal map, or one whose texels lie on nodes, which glTF materials do not hold: merge them, sample at centers, or render it"
            }
            _ => heights,
        },
        _ => heights,
    };
    let method = requests.method.name();
    Err(Error::unsupported("details", format!("method {method} has {what}")))
}

/// Gives the renderer's materials what bends their normals.
pub(super) fn give(bumps: &Bumps, sets: &UvSets, materials: &mut [RenderMaterial]) {
    let last = materials.len() - 1;
    for (index, material) in materials.iter_mut().enumerate() {
        let shading = bumps.of((index < last).then_some(index));
        if let Some(bump) = &shading.bump {
            give_one(bump, sets, material);
        }
    }
}

fn give_one(bump: &Bump, sets: &UvSets, material: &mut RenderMaterial) {
    let uv_channel = sets.channel(bump.uv_set);
    let mut slot = 0;
    material.bump.faceted = bump.faceted;
    for BumpLayer { source, scale, map_from_uv } in &bump.layers {
        let (scale, map_from_uv) = (*scale, *map_from_uv);
        match source {
            BumpSource::Map { map, wrap, kind } if slot < BUMP_SLOTS => {
                material.bump.uses[slot] = BumpUse { kind: *kind, scale };
                let map = RenderMap { map: Arc::clone(map), uv_channel, map_from_uv, wrap: *wrap };
                material.maps[MAP_DETAIL + slot] = Some(map);
                slot += 1;
            }
            BumpSource::Map { .. } => {}
            BumpSource::Formula(program) => {
                let program = Arc::clone(program);
                material.bump.formulas.push(RenderFormula { program, scale, uv_channel, map_from_uv });
            }
        }
    }
}

/// Whether a primitive's vertices move and a normal map, or its heights pixel by pixel, tells its normals: those of the base are
/// bent by it, as CySlice's displacement shader keeps them for it.
pub(super) fn keeps_base_normals(inputs: &Inputs, mesh: usize, primitive: usize) -> bool {
    let material = inputs.scene.meshes[mesh].mesh.primitives[primitive].material;
    inputs.details[mesh][primitive].is_some() && inputs.bumps.of(material).tells_normals()
}

/// Puts the base's normals in place of the displaced surface's, where these are bent to what it looks like.
pub(super) fn keep_base_normals(
    context: &WorkContext<'_>,
    inputs: &Inputs,
    geometry: &Geometry,
    (mesh, surface): (usize, &mut Surface),
    passes: &mut Vec<PassTime>,
) -> Result<()> {
    let own = &inputs.scene.meshes[mesh].mesh;
    let kept: Vec<usize> = (0..own.primitives.len()).filter(|p| keeps_base_normals(inputs, mesh, *p)).collect();
    if kept.is_empty() {
        return Ok(());
    }
    let base = base_normals(context, geometry, (mesh, own), surface, passes)?;
    for primitive in kept {
        for range in surface.vertices_of(own, &own.primitives[primitive]) {
            surface.normals[range.clone()].copy_from_slice(&base[range]);
        }
    }
    Ok(())
}

/// Of every vertex of a surface: by the passes that make them, without detail.
fn base_normals(
    context: &WorkContext<'_>,
    geometry: &Geometry,
    (index, mesh): (usize, &Mesh),
    surface: &mut Surface,
    passes: &mut Vec<PassTime>,
) -> Result<Vec<[f32; 3]>> {
    let geometry = Geometry { normals: Normals::Analytic, ..geometry.clone() };
    let plan = |level: u32| SurfacePlan::uniform(index, mesh, level, &geometry);
    let bare: Vec<Option<Arc<Detail>>> = vec![None; mesh.primitives.len()];
    let (executor, job) = (context.executor, context.job());
    let (base, times) = match &surface.layout {
        Layout::Uniform { level } => executor.displace(&job, &plan(*level)?, mesh, &bare)?,
        Layout::Pieces(pieces) => {
            let (pieces, positions) = ((**pieces).clone(), mem::take(&mut surface.positions));
            let shape = Shape { pieces, positions, triangles: mem::take(&mut surface.triangles) };
            let (mut base, times) = executor.finish(&job, &plan(0)?, mesh, &bare, shape)?;
            surface.positions = mem::take(&mut base.positions);
            surface.triangles = mem::take(&mut base.triangles);
            (base, times)
        }
    };
    inputs::add_times(passes, times);
    Ok(base.normals)
}
