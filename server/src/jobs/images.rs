//! From displaced surfaces and the file's materials to what the renderer takes.

use std::{collections::HashMap, sync::Arc};

use glam::{Mat4, Vec3};
use rayon::prelude::*;

use crate::domain::{
    Error, Result, camera,
    image::{ColorMap, RenderInstance, RenderLight, RenderMaterial, RenderMesh, RenderScene},
    maps,
    mesh::Mesh,
    report::Warning,
    request::RenderRequest,
    scene::{Material, Scene, TextureUse},
    surface::Surface,
};

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Of all base colour maps together, 16 bytes each while they are decoded.
const MOST_TEXELS: usize = 1 << 27;

/// Consumes the surfaces: their streams become the renderer's without a copy.
pub(super) fn render_scene(request: &RenderRequest, scene: &mut Scene, surfaces: Vec<Surface>) -> Result<RenderScene> {
    let bounds = bounds(scene, &surfaces);
    let materials = materials(scene)?;
    let meshes = scene.meshes.iter().zip(surfaces);
    let meshes = meshes.map(|(m, surface)| render_mesh(&m.mesh, &scene.materials, surface)).collect();
    let instances = scene.instances.iter();
    let look = &request.look;
    Ok(RenderScene {
        meshes,
        instances: instances.map(|i| RenderInstance { mesh: i.mesh, world_from_mesh: i.world_from_mesh }).collect(),
        materials,
        camera: camera::render_camera(&request.camera, scene, bounds, request.width, request.height)?,
        light: RenderLight { direction_world: look.light_direction, ambient: look.ambient, ..RenderLight::default() },
        aovs: request.aovs.clone(),
    })
}

/// Box of the displaced scene, world units.
fn bounds(scene: &Scene, surfaces: &[Surface]) -> [[f32; 3]; 2] {
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

/// The scene's materials, then one for primitives without.
pub(super) fn materials(scene: &mut Scene) -> Result<Vec<RenderMaterial>> {
    let mut images: HashMap<usize, Option<Arc<ColorMap>>> = HashMap::new();
    let mut texels = 0;
    let mut materials = Vec::new();
    for material in scene.materials.clone().iter().chain([&without()]) {
        let texture = material.base_color.as_ref();
        if let Some(new) = texture.map(|texture| texture.image).filter(|image| !images.contains_key(image)) {
            let map = of_file(scene, new);
            texels += map.as_ref().map_or(0, |map| map.texels.len());
            if texels > MOST_TEXELS {
                let message = format!("the base colour maps have more than {MOST_TEXELS} texels: use smaller maps");
                return Err(Error::too_large("images", message));
            }
            images.insert(new, map);
        }
        let map = texture.and_then(|texture| images.get(&texture.image).cloned().flatten());
        materials.push(render_material(material, texture, map));
    }
    Ok(materials)
}

fn without() -> Material {
    Material { base_color_factor: [1.0; 4], ..Material::default() }
}

/// An image of the file; one that cannot be had is left out with a warning, as viewers do.
fn of_file(scene: &mut Scene, image: usize) -> Option<Arc<ColorMap>> {
    let bytes = scene.images.get(image)?.bytes.clone()?;
    match maps::color_map(&format!("images[{image}]"), &bytes) {
        Ok(map) => Some(Arc::new(map)),
        Err(error) => {
            scene.warnings.push(Warning::new("image_unreadable", format!("{error}; the factor alone is used")));
            None
        }
    }
}

fn render_material(material: &Material, texture: Option<&TextureUse>, map: Option<Arc<ColorMap>>) -> RenderMaterial {
    RenderMaterial {
        base_color_factor: material.base_color_factor,
        base_color: map,
        map_from_uv: texture.map_or(IDENTITY, |t| t.map_from_uv),
        wrap: texture.map_or_else(Default::default, |t| t.wrap),
        double_sided: material.double_sided,
        alpha_cutoff: material.alpha_cutoff,
    }
}

fn render_mesh(mesh: &Mesh, materials: &[Material], mut surface: Surface) -> RenderMesh {
    let uvs = uvs(mesh, materials, &surface);
    let colors = colors(mesh, &surface);
    let material_of_triangles = mesh
        .primitives
        .iter()
        .map(|p| {
            let first = surface.layout.triangles_of_primitive(p).start;
            (first as u32, p.material.unwrap_or(materials.len()) as u32)
        })
        .collect();
    RenderMesh {
        positions: Arc::new(std::mem::take(&mut surface.positions)),
        normals: Arc::new(std::mem::take(&mut surface.normals)),
        uvs: Arc::new(uvs),
        colors: Arc::new(colors),
        triangles: Arc::new(std::mem::take(&mut surface.triangles)),
        material_of_triangles,
    }
}

/// Each vertex's UV in the set its material's base colour map reads.
fn uvs(mesh: &Mesh, materials: &[Material], surface: &Surface) -> Vec<[f32; 2]> {
    let mut uvs = vec![[0.0; 2]; surface.positions.len()];
    for primitive in &mesh.primitives {
        let texture = primitive.material.and_then(|m| materials[m].base_color.as_ref());
        let semantic = format!("TEXCOORD_{}", texture.map_or(0, |t| t.uv_set));
        let Some(index) = mesh.attributes.iter().position(|a| a.semantic == semantic) else { continue };
        let values: &[[f32; 2]] = bytemuck::cast_slice(&surface.attributes[index]);
        for range in surface.vertices_of(mesh, primitive) {
            uvs[range.clone()].copy_from_slice(&values[range]);
        }
    }
    uvs
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
