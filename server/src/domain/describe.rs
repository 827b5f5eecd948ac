//! What a mesh holds and what is wrong with it, without doing anything to it.

use serde::{Deserialize, Serialize};

use super::{
    report::Warning,
    scene::{Scene, SceneMesh},
};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Description {
    pub meshes: Vec<MeshDescription>,
    pub materials: Vec<MaterialDescription>,
    pub images: Vec<ImageDescription>,
    pub cameras: Vec<CameraDescription>,
    pub instances: u32,
    /// Of all instances.
    pub triangles: u64,
    /// Box of the undisplaced scene, world units.
    pub bounds: [[f32; 3]; 2],
    pub diagonal: f64,
    pub extensions_used: Vec<String>,
    pub problems: Vec<Warning>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshDescription {
    pub name: String,
    pub triangles: u64,
    pub geometric_vertices: u64,
    pub attribute_vertices: u64,
    pub edges: u64,
    pub boundary_edges: u64,
    pub nonmanifold_edges: u64,
    pub seam_edges: u64,
    pub degenerate_triangles: u64,
    pub primitives: u32,
    pub instances: u32,
    /// UV sets that every primitive has.
    pub uv_sets: Vec<u32>,
    /// Attribute names of the file.
    pub attributes: Vec<String>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MaterialDescription {
    pub name: String,
    pub base_color_factor: [f32; 4],
    pub base_color_image: Option<u32>,
    pub displacement_image: Option<u32>,
    pub has_normal_map: bool,
    pub double_sided: bool,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImageDescription {
    pub media_type: String,
    pub size_bytes: Option<u64>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CameraDescription {
    pub name: String,
    pub yfov_degrees: Option<f32>,
}

#[must_use]
pub fn describe(scene: &Scene) -> Description {
    let triangles = scene.instances.iter().map(|i| scene.meshes[i.mesh].mesh.triangles.len() as u64).sum();
    let mut uses = vec![0; scene.meshes.len()];
    scene.instances.iter().for_each(|instance| uses[instance.mesh] += 1);
    Description {
        meshes: scene.meshes.iter().zip(uses).map(|(mesh, uses)| of_mesh(mesh, uses)).collect(),
        materials: scene.materials.iter().map(of_material).collect(),
        images: scene
            .images
            .iter()
            .map(|i| ImageDescription {
                media_type: i.media_type.clone(),
                size_bytes: i.bytes.as_ref().map(|b| b.len() as u64),
            })
            .collect(),
        cameras: scene
            .cameras
            .iter()
            .map(|c| CameraDescription {
                name: c.name.clone().unwrap_or_default(),
                yfov_degrees: c.yfov_radians.map(f32::to_degrees),
            })
            .collect(),
        instances: scene.instances.len() as u32,
        triangles,
        bounds: scene.bounds,
        diagonal: scene.diagonal,
        extensions_used: extensions_used(scene),
        problems: scene.warnings.clone(),
    }
}

fn of_mesh(mesh: &SceneMesh, instances: u32) -> MeshDescription {
    let mesh = &mesh.mesh;
    let everywhere =
        |n: &u32| mesh.attribute(&format!("TEXCOORD_{n}")).is_some_and(|a| a.primitives.iter().all(|p| *p));
    let mut attributes = vec!["POSITION".to_owned()];
    attributes.extend((!mesh.health.normals_generated).then(|| "NORMAL".into()));
    attributes.extend((!mesh.av_tangent.is_empty()).then(|| "TANGENT".into()));
    attributes.extend(mesh.attributes.iter().map(|a| a.semantic.clone()));
    MeshDescription {
        name: mesh.name.clone(),
        triangles: mesh.triangles.len() as u64,
        geometric_vertices: mesh.gv_position.len() as u64,
        attribute_vertices: mesh.av_gv.len() as u64,
        edges: mesh.ge_gv.len() as u64,
        boundary_edges: mesh.health.boundary_edges.into(),
        nonmanifold_edges: mesh.health.non_manifold_edges.into(),
        seam_edges: mesh.health.seam_edges.into(),
        degenerate_triangles: mesh.health.degenerate_triangles.into(),
        primitives: mesh.primitives.len() as u32,
        instances,
        uv_sets: (0..16).filter(everywhere).collect(),
        attributes,
    }
}

fn of_material(material: &super::scene::Material) -> MaterialDescription {
    MaterialDescription {
        name: material.name.clone().unwrap_or_default(),
        base_color_factor: material.base_color_factor,
        base_color_image: material.base_color.as_ref().map(|t| t.image as u32),
        displacement_image: material.displacement.as_ref().map(|d| d.texture.image as u32),
        has_normal_map: material.has_normal_map,
        double_sided: material.double_sided,
    }
}

fn extensions_used(scene: &Scene) -> Vec<String> {
    let used = scene.document.get("extensionsUsed").and_then(|e| e.as_array());
    used.into_iter().flatten().filter_map(|e| e.as_str()).map(str::to_owned).collect()
}
