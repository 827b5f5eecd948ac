//! The geometry passes: each against its f64 twin fed the same inputs, closed forms, watertightness, and
//! the same bytes again and again.

mod bench;
mod closed_forms;
mod determinism;
mod seams;
mod twins;

use std::sync::{Arc, OnceLock};

use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Detail, Layer, LayerSource, Map, Sampling, Wrap},
        expression::Program,
        mesh::Mesh,
        plan::SurfacePlan,
        request::{Geometry, Normals, SeamRule},
        surface::Surface,
        weld::{PrimitiveInput, VertexAttribute, weld, with_tangents},
    },
    render::{Executor, JobContext, reference::ReferenceExecutor, vulkan::VulkanExecutor},
    vulkan::{Device, DeviceOptions},
};
use displace_tests::{maps, meshes::TestMesh, surfaces};

/// One validated device for all tests of this module.
fn vulkan() -> &'static VulkanExecutor {
    static DEVICE: OnceLock<VulkanExecutor> = OnceLock::new();
    DEVICE.get_or_init(|| {
        let options = DeviceOptions { validation: true, ..Default::default() };
        VulkanExecutor::with_device(
            Device::open(&options).expect("a Vulkan device that passes its self-test; run deploy/setup to install one"),
        )
    })
}

fn primitive(mesh: &TestMesh) -> PrimitiveInput {
    PrimitiveInput {
        positions: mesh.positions.clone(),
        normals: Some(mesh.normals.clone()),
        attributes: vec![VertexAttribute {
            semantic: "TEXCOORD_0".into(),
            components: 2,
            values: mesh.uvs.iter().flatten().copied().collect(),
        }],
        triangles: mesh.triangles.clone(),
        ..PrimitiveInput::default()
    }
}

fn welded(mesh: &TestMesh) -> Mesh {
    weld(mesh.name, &[primitive(mesh)]).expect("test meshes are valid")
}

fn welded_with_tangents(mesh: &TestMesh) -> Mesh {
    with_tangents(&welded(mesh), |_| Some(0)).expect("test meshes have texture coordinates")
}

fn geometry(level: u32) -> Geometry {
    surfaces::uniform(level)
}

fn planned(mesh: &Mesh, geometry: &Geometry) -> SurfacePlan {
    surfaces::plan(mesh, geometry).expect("fits")
}

fn run(executor: &dyn Executor, mesh: &Mesh, geometry: &Geometry, detail: Option<&Arc<Detail>>) -> Surface {
    let details = vec![detail.cloned(); mesh.primitives.len()];
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let (surface, _) = executor
        .displace(&job, &planned(mesh, geometry), mesh, &details)
        .unwrap_or_else(|error| panic!("{}: {error}", mesh.name));
    surface
}

fn on_both(mesh: &Mesh, geometry: &Geometry, detail: Option<&Arc<Detail>>) -> [Surface; 2] {
    [run(vulkan(), mesh, geometry, detail), run(&ReferenceExecutor, mesh, geometry, detail)]
}

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn layer(source: LayerSource, scale: f32, midlevel: f32) -> Layer {
    Layer { source, scale, midlevel, map_from_uv: IDENTITY }
}

fn detail(layers: impl IntoIterator<Item = Layer>) -> Arc<Detail> {
    Arc::new(Detail { layers: layers.into_iter().collect(), uv_set: 0 })
}

fn map(size: [u32; 2], channels: u32, value: impl Fn(u32, u32, u32) -> f32) -> Map {
    let [width, height] = size;
    let texels: Vec<f32> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .flat_map(|(x, y)| (0..channels).map(move |c| (x, y, c)))
        .map(|(x, y, c)| value(x, y, c))
        .collect();
    Map {
        width,
        height,
        channels,
        texels: texels.into(),
        wrap: [Wrap::Repeat; 2],
        sampling: Sampling::Center,
        source_bits: 16,
    }
}

/// White noise in [0, 1] in steps of 1 / 65535.
fn noise(size: [u32; 2], channels: u32) -> Map {
    map(size, channels, |x, y, c| (maps::hash(x, y, c + 7) >> 16) as f32 / 65535.0)
}

fn height(map: Map, scale: f32) -> Arc<Detail> {
    detail([layer(LayerSource::Height(Arc::new(map)), scale, 0.0)])
}

fn expression(source: &str, scale: f32) -> Arc<Detail> {
    let program = Program::parse(source).unwrap_or_else(|error| panic!("{error}"));
    detail([layer(LayerSource::Expression(Arc::new(program)), scale, 0.0)])
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    glam::Vec3::from(a).distance(b.into())
}

/// Largest distance between corresponding vectors.
fn worst(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| distance(*a, *b)).fold(0.0, f32::max)
}
