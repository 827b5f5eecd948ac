//! From a test mesh and a detail to a displaced surface, through the domain and an executor alone.

use std::sync::Arc;

use displace_server::{
    domain::{
        Result,
        cancel::{Cancel, NoProgress},
        detail::{Detail, Layer, LayerSource, Map, Sampling, Wrap},
        expression::Program,
        mesh::Mesh,
        plan::SurfacePlan,
        request::{Base, Geometry, Normals, Refinement, SeamRule, Tolerance},
        scene::{Instance, Scene, SceneMesh},
        surface::Surface,
        weld::{PrimitiveInput, VertexAttribute, weld, with_tangents},
    },
    render::{Executor, JobContext},
};

use crate::{maps, meshes::TestMesh};

/// Uniform subdivision to `level`, everything else as the service defaults it.
#[must_use]
pub fn uniform(level: u32) -> Geometry {
    Geometry {
        refinement: Refinement::Uniform(level),
        max_triangles: None,
        normals: Normals::Analytic,
        seams: SeamRule::Mean,
        feather_texels: 3.0,
        base: Base::Flat,
    }
}

impl TestMesh {
    /// The welded base mesh with made tangents, as a detail in the tangent frame needs it.
    ///
    /// # Panics
    /// When the mesh cannot be welded: a test mesh is sound.
    #[must_use]
    pub fn to_mesh(&self) -> Mesh {
        with_tangents(&self.to_mesh_without_tangents(), |_| Some(0)).expect("a test mesh has tangents")
    }

    /// The welded base mesh as a loaded file without tangents gives it.
    ///
    /// # Panics
    /// When the mesh cannot be welded: a test mesh is sound.
    #[must_use]
    pub fn to_mesh_without_tangents(&self) -> Mesh {
        let uvs = VertexAttribute {
            semantic: "TEXCOORD_0".into(),
            components: 2,
            values: self.uvs.iter().flatten().copied().collect(),
        };
        let primitive = PrimitiveInput {
            positions: self.positions.clone(),
            normals: Some(self.normals.clone()),
            attributes: vec![uvs],
            triangles: self.triangles.clone(),
            ..PrimitiveInput::default()
        };
        weld(self.name, &[primitive]).expect("a test mesh welds")
    }
}

/// A detail of one layer.
#[must_use]
pub fn detail(source: LayerSource, scale: f32) -> Arc<Detail> {
    let map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    Arc::new(Detail { layers: vec![Layer { source, scale, midlevel: 0.0, map_from_uv }], uv_set: 0 })
}

/// A height map of white noise, square, at 16 bits.
#[must_use]
pub fn noise_height(size: u32, seed: u32) -> LayerSource {
    let at = |i: u32| f64::from(maps::hash(i % size, i / size, seed) >> 16) / 65535.0;
    height(size, (0..size * size).map(|i| at(i) as f32).collect())
}

#[must_use]
pub fn constant_height(value: f32) -> LayerSource {
    height(4, vec![value; 16])
}

fn height(size: u32, texels: Vec<f32>) -> LayerSource {
    LayerSource::Height(Arc::new(Map {
        width: size,
        height: size,
        channels: 1,
        texels: texels.into(),
        wrap: [Wrap::Repeat; 2],
        sampling: Sampling::Center,
        source_bits: 16,
    }))
}

/// # Panics
/// When the expression does not parse.
#[must_use]
pub fn expression(source: &str) -> LayerSource {
    LayerSource::Expression(Arc::new(Program::parse(source).expect("a test's expression parses")))
}

/// The plan of a uniform subdivision.
///
/// # Errors
/// When it does not fit.
///
/// # Panics
/// When `geometry` is of another kind.
pub fn plan(mesh: &Mesh, geometry: &Geometry) -> Result<SurfacePlan> {
    let Refinement::Uniform(level) = geometry.refinement else { panic!("{geometry:?} is not uniform") };
    SurfacePlan::uniform(0, mesh, level, geometry)
}

/// The plan of a tolerance, the mesh being the whole scene.
///
/// # Panics
/// When the scene cannot be planned for.
#[must_use]
pub fn tolerance_plan(mesh: &Mesh, tolerance: &Tolerance, geometry: &Geometry) -> SurfacePlan {
    const PLENTY: u64 = 1 << 13;
    let far = |best: fn(f32, f32) -> f32, start: f32| {
        std::array::from_fn(|k| mesh.gv_position.iter().map(|p: &[f32; 3]| p[k]).fold(start, best))
    };
    let bounds: [[f32; 3]; 2] = [far(f32::min, f32::INFINITY), far(f32::max, f32::NEG_INFINITY)];
    let across: f64 = (0..3).map(|k| f64::from(bounds[1][k] - bounds[0][k]).powi(2)).sum();
    let identity = std::array::from_fn(|k| if k % 5 == 0 { 1.0 } else { 0.0 });
    let scene = Scene {
        meshes: vec![SceneMesh { gltf_mesh: 0, mesh: mesh.clone() }],
        instances: vec![Instance { mesh: 0, world_from_mesh: identity }],
        diagonal: across.sqrt(),
        bounds,
        ..Scene::default()
    };
    let most = geometry.max_triangles.unwrap_or(PLENTY);
    SurfacePlan::within_tolerance(0, &scene, tolerance, geometry, most).expect("a test's plan fits").0
}

/// Displaces every primitive of `mesh` by the same detail.
///
/// # Panics
/// When the plan or the execution fails.
#[must_use]
pub fn displace(executor: &dyn Executor, mesh: &Mesh, detail: &Arc<Detail>, geometry: &Geometry) -> Surface {
    let plan = match &geometry.refinement {
        Refinement::Tolerance(tolerance) => tolerance_plan(mesh, tolerance, geometry),
        _ => plan(mesh, geometry).expect("a test's plan fits"),
    };
    let details = vec![Some(Arc::clone(detail)); mesh.primitives.len()];
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let (surface, _) = executor.displace(&job, &plan, mesh, &details).expect("a test's surface can be made");
    surface
}
