//! `displace describe`: what a mesh holds, and what is wrong with it.

use std::fmt::Write as _;

use displace_proto::v1::{DescribeRequest, DescribeResponse, MeshDescription};
use serde_json::{Map, Value, json};

use super::{Session, blocking};
use crate::{
    args::DescribeArgs,
    connection::{MESH_DEADLINE, request},
    error::Result,
    output::{Terminal, bytes, count},
    report,
    request::Parcel,
    transfer::{unary, upload},
};

pub(super) async fn run(session: &Session, args: &DescribeArgs, terminal: &mut Terminal<'_>) -> Result<()> {
    let path = args.mesh.clone();
    let (mesh, parcel) = blocking(move || {
        let mut parcel = Parcel::default();
        let mesh = parcel.mesh(&path)?;
        Ok((mesh, parcel))
    })
    .await?;
    let connection = session.connection().await?;
    upload(connection, &parcel.blobs, &terminal.progress()).await?;
    let mut answer = unary(|| {
        let message = DescribeRequest { mesh: Some(mesh.clone()) };
        async move { connection.displacement().describe(request(message, MESH_DEADLINE)).await }
    })
    .await?;
    answer.problems.extend(report::conversion_warnings(&parcel.notes));
    terminal.report(&as_json(&answer), &words(&answer))
}

/// Names that a file may lack are absent, not empty.
fn named(name: &str, rest: Value) -> Value {
    let mut object = Map::new();
    if !name.is_empty() {
        object.insert("name".into(), name.into());
    }
    if let Value::Object(rest) = rest {
        object.extend(rest.into_iter().filter(|(_, value)| !value.is_null()));
    }
    object.into()
}

fn as_json(answer: &DescribeResponse) -> Value {
    let materials = answer.materials.iter().map(|m| {
        named(&m.name, json!({
            "base_color_factor": m.base_color_factor, "base_color_image": m.base_color_image,
            "displacement_image": m.displacement_image, "has_normal_map": m.has_normal_map, "double_sided": m.double_sided,
        }))
    });
    let images = answer.images.iter().map(|i| named("", json!({ "media_type": i.media_type, "bytes": i.size_bytes })));
    let cameras = answer.cameras.iter().map(|c| named(&c.name, json!({ "yfov_degrees": c.yfov_degrees })));
    let bounds = answer.bounds.as_ref().map(|b| json!({ "min": b.min, "max": b.max }));
    named(
        "",
        json!({
            "triangles": answer.triangles,
            "instances": answer.instances,
            "meshes": answer.meshes.iter().map(mesh_json).collect::<Vec<_>>(),
            "materials": materials.collect::<Vec<_>>(),
            "images": images.collect::<Vec<_>>(),
            "cameras": cameras.collect::<Vec<_>>(),
            "bounds": bounds,
            "diagonal": answer.diagonal,
            "extensions_used": answer.extensions_used,
            "problems": report::warnings_json(&answer.problems),
        }),
    )
}

fn mesh_json(m: &MeshDescription) -> Value {
    named(
        &m.name,
        json!({
            "triangles": m.triangles, "geometric_vertices": m.geometric_vertices, "attribute_vertices": m.attribute_vertices,
            "edges": m.edges, "boundary_edges": m.boundary_edges, "nonmanifold_edges": m.nonmanifold_edges,
            "seam_edges": m.seam_edges, "degenerate_triangles": m.degenerate_triangles, "primitives": m.primitives,
            "instances": m.instances, "uv_sets": m.uv_sets, "attributes": m.attributes,
        }),
    )
}

fn words(answer: &DescribeResponse) -> String {
    let mut text = format!(
        "{} triangles in {} instances, diagonal {:.6}\n",
        count(answer.triangles),
        answer.instances,
        answer.diagonal
    );
    if let Some(bounds) = &answer.bounds {
        let _ = writeln!(text, "box {:?} to {:?}", bounds.min, bounds.max);
    }
    answer.meshes.iter().for_each(|mesh| text += &mesh_words(mesh));
    for material in &answer.materials {
        let part = |image: Option<u32>, what: &str| image.map(|i| format!(", {what} image {i}")).unwrap_or_default();
        let _ = writeln!(
            text,
            "material '{}'{}{}{}{}",
            material.name,
            part(material.base_color_image, "base colour"),
            part(material.displacement_image, "displacement"),
            if material.has_normal_map { ", normal map" } else { "" },
            if material.double_sided { ", double sided" } else { "" },
        );
    }
    for (index, image) in answer.images.iter().enumerate() {
        let size = image.size_bytes.map_or_else(|| "missing".to_owned(), bytes);
        let _ = writeln!(text, "image {index}: {} {size}", image.media_type);
    }
    for camera in &answer.cameras {
        let view = camera.yfov_degrees.map_or_else(|| "orthographic".to_owned(), |fov| format!("{fov:.1} degrees"));
        let _ = writeln!(text, "camera '{}': {view}", camera.name);
    }
    if !answer.extensions_used.is_empty() {
        let _ = writeln!(text, "extensions: {}", answer.extensions_used.join(", "));
    }
    text + &report::warnings_words(&answer.problems)
}

fn mesh_words(mesh: &MeshDescription) -> String {
    let uv_sets: Vec<String> = mesh.uv_sets.iter().map(|set| format!("TEXCOORD_{set}")).collect();
    let uv_sets = if uv_sets.is_empty() { "no UVs".to_owned() } else { uv_sets.join(", ") };
    format!(
        "mesh '{}': {} triangles, {} positions, {} vertices, {} primitives, {} instances\n  {} edges: {} boundary, {} non-manifold, {} seams; {} degenerate triangles; {uv_sets}; {}\n",
        mesh.name,
        count(mesh.triangles),
        count(mesh.geometric_vertices),
        count(mesh.attribute_vertices),
        mesh.primitives,
        mesh.instances,
        count(mesh.edges),
        count(mesh.boundary_edges),
        count(mesh.nonmanifold_edges),
        count(mesh.seam_edges),
        count(mesh.degenerate_triangles),
        mesh.attributes.join(", "),
    )
}
