//! What a mesh holds.

use displace_proto::v1;

use super::update::to_warning;
use crate::domain::describe::{CameraDescription, Description, ImageDescription, MaterialDescription, MeshDescription};

pub(crate) fn to_description(described: &Description) -> v1::DescribeResponse {
    let [min, max] = described.bounds;
    v1::DescribeResponse {
        meshes: described.meshes.iter().map(to_mesh).collect(),
        materials: described.materials.iter().map(to_material).collect(),
        images: described.images.iter().map(to_image).collect(),
        cameras: described.cameras.iter().map(to_camera).collect(),
        instances: described.instances,
        triangles: described.triangles,
        bounds: Some(v1::Box { min: min.into(), max: max.into() }),
        diagonal: described.diagonal,
        extensions_used: described.extensions_used.clone(),
        problems: described.problems.iter().map(to_warning).collect(),
    }
}

fn to_mesh(mesh: &MeshDescription) -> v1::MeshDescription {
    v1::MeshDescription {
        name: mesh.name.clone(),
        triangles: mesh.triangles,
        geometric_vertices: mesh.geometric_vertices,
        attribute_vertices: mesh.attribute_vertices,
        edges: mesh.edges,
        boundary_edges: mesh.boundary_edges,
        nonmanifold_edges: mesh.nonmanifold_edges,
        seam_edges: mesh.seam_edges,
        degenerate_triangles: mesh.degenerate_triangles,
        primitives: mesh.primitives,
        instances: mesh.instances,
        uv_sets: mesh.uv_sets.clone(),
        attributes: mesh.attributes.clone(),
    }
}

fn to_material(material: &MaterialDescription) -> v1::MaterialDescription {
    v1::MaterialDescription {
        name: material.name.clone(),
        base_color_factor: material.base_color_factor.into(),
        base_color_image: material.base_color_image,
        displacement_image: material.displacement_image,
        has_normal_map: material.has_normal_map,
        double_sided: material.double_sided,
    }
}

fn to_image(image: &ImageDescription) -> v1::ImageDescription {
    v1::ImageDescription { media_type: image.media_type.clone(), size_bytes: image.size_bytes }
}

fn to_camera(camera: &CameraDescription) -> v1::CameraDescription {
    v1::CameraDescription { name: camera.name.clone(), yfov_degrees: camera.yfov_degrees }
}
