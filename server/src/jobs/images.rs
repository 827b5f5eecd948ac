//! From displaced surfaces and the file's materials to what the renderer takes.

use std::sync::Arc;

use glam::{Mat4, Vec3};
use rayon::prelude::*;

use super::{
    looks::{self, UvSets},
    reliefs,
};
use crate::domain::{
    Result,
    bump::Bumps,
    camera,
    environment::Environment,
    image::{ReliefSettings, RenderInstance, RenderMesh, RenderScene},
    mesh::{Mesh, Primitive},
    projection::{Projection, ProjectionBox},
    relief::Reliefs,
    report::Warning,
    request::RenderRequest,
    scene::{Material, Scene},
    surface::Surface,
    weld::mikk_tangents,
};

/// Consumes the surfaces: their streams become the renderer's without a copy. `moments`: with those of slopes.
pub(super) fn render_scene(
    request: &RenderRequest,
    scene: &mut Scene,
    (bumps, shown_reliefs): (&Bumps, &Reliefs),
    surfaces: Vec<Surface>,
    environment: Option<Arc<Environment>>,
    moments: bool,
) -> Result<RenderScene> {
    let bounds = bounds(scene, &surfaces);
    let meshes = meshes(request, scene, (bumps, shown_reliefs), surfaces)?;
    let sets = UvSets::of(&scene.materials, bumps, shown_reliefs);
    let reflectors = looks::reflectors(&request.look, scene)?;
    let projection = request.surface.maps.projection;
    let (alpha, steps) = (request.look.alpha, request.look.relief.steps);
    let shown = looks::Shown { alpha, projection, moments, reliefs: shown_reliefs, steps };
    let relief = reliefs::settings(request, shown_reliefs);
    let materials = looks::materials(scene, &sets, bumps, shown)?;
    let instances = scene.instances.iter();
    Ok(RenderScene {
        meshes,
        instances: instances
            .map(|i| RenderInstance { mesh: i.mesh, world_from_mesh: i.world_from_mesh, stands_for: None })
            .collect(),
        materials,
        camera: camera::render_camera(&request.camera, scene, bounds, request.width, request.height)?,
        lighting: looks::lighting(&request.look, scene, environment),
        shading: request.look.shading,
        shadows: request.look.shadows,
        filter: request.look.filter,
        projection,
        relief,
        reflectors,
        bounces: request.look.bounces,
        uv_channels: sets.count(),
        aovs: request.aovs.clone(),
    })
}

/// The meshes of the renderer, of surfaces that are consumed.
pub(super) fn meshes(
    request: &RenderRequest,
    scene: &mut Scene,
    (bumps, shown_reliefs): (&Bumps, &Reliefs),
    surfaces: Vec<Surface>,
) -> Result<Vec<RenderMesh>> {
    let sets = UvSets::of(&scene.materials, bumps, shown_reliefs);
    let seen = (request.surface.maps.projection, reliefs::settings(request, shown_reliefs));
    let mut meshes = Vec::with_capacity(surfaces.len());
    for (m, surface) in scene.meshes.iter().zip(surfaces) {
        let mut warnings = Vec::new();
        meshes.push(render_mesh(&m.mesh, (&scene.materials, bumps), &sets, surface, seen, &mut warnings)?);
        scene.warnings.extend(warnings);
    }
    Ok(meshes)
}

/// Box of the displaced scene, world units.
pub(super) fn bounds(scene: &Scene, surfaces: &[Surface]) -> [[f32; 3]; 2] {
    let nothing = || (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let union = |a: (Vec3, Vec3), b: (Vec3, Vec3)| (a.0.min(b.0), a.1.max(b.1));
    let of_instance = |instance: &crate::domain::scene::Instance| {
        let world_from_mesh = Mat4::from_cols_array(&instance.world_from_mesh);
        let points = surfaces[instance.mesh].positions.par_iter().map(|p| {
            let p = world_from_mesh.transform_point3(Vec3::from(*p));
            (p, p)
        });
        points.reduce(nothing, union)
    };
    let (low, high) = scene.instances.iter().map(of_instance).fold(nothing(), union);
    if low.is_finite() && high.is_finite() { [low.into(), high.into()] } else { scene.bounds }
}

fn render_mesh(
    mesh: &Mesh,
    (materials, bumps): (&[Material], &Bumps),
    sets: &UvSets,
    mut surface: Surface,
    (projection, relief): (Projection, ReliefSettings),
    warnings: &mut Vec<Warning>,
) -> Result<RenderMesh> {
    let directions = reliefs::directions(mesh, &surface, relief);
    let uvs = uvs(mesh, sets, &surface);
    let colors = colors(mesh, &surface);
    // Projections have frames of their own.
    let tangents = match projection {
        Projection::Uv => tangents(mesh, (materials, bumps), &surface, warnings)?,
        _ => Vec::new(),
    };
    let material_of_triangles = mesh
        .primitives
        .iter()
        .map(|p| {
            let first = surface.layout.triangles_of_primitive(p).start;
            (first as u32, p.material.unwrap_or(materials.len()) as u32)
        })
        .collect();
    Ok(RenderMesh {
        positions: Arc::new(std::mem::take(&mut surface.positions)),
        normals: Arc::new(std::mem::take(&mut surface.normals)),
        uvs: Arc::new(uvs),
        tangents: Arc::new(tangents),
        colors: Arc::new(colors),
        triangles: Arc::new(std::mem::take(&mut surface.triangles)),
        directions: Arc::new(directions),
        material_of_triangles,
        projection_box: ProjectionBox::of(mesh.gv_position.iter().copied()),
    })
}

/// Each vertex's UVs in the sets that maps read.
fn uvs(mesh: &Mesh, sets: &UvSets, surface: &Surface) -> Vec<[f32; 2]> {
    let count = sets.count() as usize;
    let mut uvs = vec![[0.0; 2]; count * surface.positions.len()];
    for (channel, semantic) in sets.semantics().enumerate() {
        let Some(index) = mesh.attributes.iter().position(|a| a.semantic == semantic) else { continue };
        let values: &[[f32; 2]] = bytemuck::cast_slice(&surface.attributes[index]);
        uvs.par_chunks_mut(count).zip(values).for_each(|(uvs, value)| uvs[channel] = *value);
    }
    uvs
}

/// The UV set of a material's tangents, where it has a normal map in tangent space.
pub(super) fn tangent_uv_set(materials: &[Material], bumps: &Bumps, material: Option<usize>) -> Option<u32> {
    let of_file = material.map(|m| &materials[m]).filter(|m| m.normal.is_some()).map(|m| m.normal_uv_set);
    let of_bump = bumps.of(material).bump.as_ref().filter(|bump| bump.is_in_tangent_space()).map(|bump| bump.uv_set);
    of_file.or(of_bump)
}

/// Of corners, where a material has a normal map: as a result's file has them. Empty where none has.
fn tangents(
    mesh: &Mesh,
    (materials, bumps): (&[Material], &Bumps),
    surface: &Surface,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<[f32; 4]>> {
    let mut tangents = Vec::new();
    for (p, primitive) in mesh.primitives.iter().enumerate() {
        let Some(uv_set) = tangent_uv_set(materials, bumps, primitive.material) else { continue };
        let semantic = format!("TEXCOORD_{uv_set}");
        let attribute = mesh.attributes.iter().position(|a| a.semantic == semantic && a.primitives[p]);
        let Some(index) = attribute else { continue };
        let range = surface.layout.triangles_of_primitive(primitive);
        let values: &[[f32; 2]] = bytemuck::cast_slice(&surface.attributes[index]);
        match of_primitive(mesh, primitive, surface, values) {
            Ok(made) => {
                tangents.resize(3 * surface.triangles.len(), [0.0; 4]);
                tangents[3 * range.start..3 * range.end].copy_from_slice(&made);
            }
            Err(error) if error.kind == crate::domain::ErrorKind::TooLarge => {
                let message = format!("mesh '{}': {error}; its normal map is not shown", mesh.name);
                warnings.push(Warning::new("no_tangents", message));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(tangents)
}

/// The file's own where the surface is the mesh itself, else those of MikkTSpace.
fn of_primitive(mesh: &Mesh, primitive: &Primitive, surface: &Surface, uvs: &[[f32; 2]]) -> Result<Vec<[f32; 4]>> {
    let triangles = &surface.triangles[surface.layout.triangles_of_primitive(primitive)];
    let is_of_file = mesh.has_tangents(primitive) && !primitive.made_tangents;
    if is_of_file && surface.positions.len() == mesh.av_gv.len() {
        return Ok(triangles.as_flattened().iter().map(|v| mesh.av_tangent[*v as usize]).collect());
    }
    mikk_tangents(triangles, |v| surface.positions[v as usize], |v| surface.normals[v as usize], |v| uvs[v as usize])
}

/// COLOR_0 as RGBA, white where a primitive has none; empty when no primitive has any.
fn colors(mesh: &Mesh, surface: &Surface) -> Vec<[f32; 4]> {
    let Some(index) = mesh.attributes.iter().position(|a| a.semantic == "COLOR_0") else { return Vec::new() };
    let attribute = &mesh.attributes[index];
    let mut colors = vec![[1.0; 4]; surface.positions.len()];
    for (p, primitive) in mesh.primitives.iter().enumerate().filter(|(p, _)| attribute.primitives[*p]) {
        debug_assert!(attribute.primitives[p]);
        for range in surface.vertices_of(mesh, primitive) {
            for vertex in range {
                let value = &surface.attributes[index][vertex * attribute.components..][..attribute.components];
                colors[vertex][..value.len().min(4)].copy_from_slice(&value[..value.len().min(4)]);
            }
        }
    }
    colors
}
