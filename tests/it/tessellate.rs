//! The tessellator's passes on the device against their twins.

mod bounds;
mod large;
mod refine;
mod whole;

use std::sync::Arc;

use displace_glsl::{reference::refine::Base, tables::Tables};
use displace_server::{
    domain::{
        detail::{Detail, Layer, LayerSource, Map, Sampling, Wrap},
        mesh::Mesh,
        request::Geometry,
    },
    render::{passes, refine::base},
};
use displace_tests::{
    maps,
    meshes::TestMesh,
    surfaces::{plan, uniform},
};

/// A base mesh with one detail everywhere.
struct Subject {
    mesh: Mesh,
    tables: Tables,
    base: Base,
}

impl Subject {
    fn new(mesh: &TestMesh, feather_texels: f32, layers: Vec<Layer>) -> Self {
        Self::with(mesh, &Geometry { feather_texels, ..uniform(0) }, layers)
    }

    fn with(mesh: &TestMesh, geometry: &Geometry, layers: Vec<Layer>) -> Self {
        let mesh = mesh.to_mesh_without_tangents();
        let detail = Arc::new(Detail { layers, uv_set: 0 });
        let details = vec![Some(detail); mesh.primitives.len()];
        let plan = plan(&mesh, geometry).expect("fits");
        Self { tables: passes::tables::build(&plan, &mesh, &details).expect("tables"), base: base(&mesh), mesh }
    }
}

fn layer(map: Map, scale: f32, map_from_uv: [[f32; 3]; 2]) -> Layer {
    Layer { source: LayerSource::Height(Arc::new(map)), scale, midlevel: 0.25, map_from_uv }
}

/// A map of `size` texels with the value `at(x, y)`, in [0, 1].
fn map(size: [u32; 2], wrap: Wrap, sampling: Sampling, at: impl Fn(u32, u32) -> f32) -> Map {
    let [width, height] = size;
    let texels: Vec<f32> = (0..width * height).map(|i| at(i % width, i / width)).collect();
    Map { width, height, channels: 1, texels: texels.into(), wrap: [wrap; 2], sampling, source_bits: 16 }
}

fn smooth(x: u32, y: u32) -> f32 {
    0.5 + 0.25 * (x as f32 * 0.11).sin() + 0.25 * (y as f32 * 0.07 + x as f32 * 0.02).cos()
}

fn noise(x: u32, y: u32) -> f32 {
    (maps::hash(x, y, 3) >> 16) as f32 / 65535.0
}

/// Rows of bricks with flat faces and steep sides.
fn bricks(x: u32, y: u32) -> f32 {
    let row = y / 8;
    let along = (x + 8 * (row % 2)) % 16;
    if y.is_multiple_of(8) || along == 0 { 0.0 } else { 1.0 }
}

/// The height of a texel.
type Height = fn(u32, u32) -> f32;

const MAPS: [(&str, Height); 3] = [("smooth", smooth), ("noise", noise), ("bricks", bricks)];
