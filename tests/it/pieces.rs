//! Surfaces whose places are listed: finished, they are the uniform ones where the places are; refined ones keep
//! everything.

mod refined;

use std::sync::Arc;

use displace_glsl::tables::Tables;
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Detail, LayerSource, Map, Sampling, Wrap},
        mesh::Mesh,
        plan::SurfacePlan,
        request::{Geometry, Normals, Refinement, SeamRule},
        surface::{Layout, Pieces, Place, Shape, Surface},
        weld::{PrimitiveInput, VertexAttribute, weld, with_tangents},
    },
    render::{
        JobContext,
        passes::{self, streams::BaseStreams},
        reference,
    },
};
use displace_tests::{
    device::{self, without_gpu},
    maps,
    meshes::{self, TestMesh},
    surfaces::{self, detail, displace, expression, noise_height, uniform},
};
use glam::Vec3;

use crate::raster::device;

/// The places and triangles of a uniform surface, listed.
fn listed(mesh: &Mesh, uniform: &Surface) -> Shape {
    let mut pieces = Pieces { edge_first: vec![0], ..Pieces::default() };
    for ae in 0..mesh.ae_av.len() as u32 {
        let places = uniform.edge_vertices(mesh, ae).map(|vertex| uniform.layout.place(mesh, vertex));
        pieces
            .edge_place
            .extend(places.filter_map(|p| if let Place::Edge { along, .. } = p { Some(along) } else { None }));
        pieces.edge_first.push(pieces.edge_place.len() as u32);
    }
    let [_, _, interiors] = uniform.layout.blocks(mesh);
    let each = interiors.len() / mesh.triangles.len();
    pieces.interior_first = (0..=mesh.triangles.len()).map(|t| (t * each) as u32).collect();
    let places = interiors.map(|vertex| uniform.layout.place(mesh, vertex));
    pieces.interior_place =
        places.filter_map(|p| if let Place::Inside { b, .. } = p { Some(b) } else { None }).collect();
    pieces.triangle_first = (0..=mesh.triangles.len()).map(|t| uniform.triangles_of(t).start as u32).collect();
    Shape { pieces, positions: uniform.positions.clone(), triangles: uniform.triangles.clone() }
}

/// A surface to be made.
struct Case<'a> {
    mesh: &'a Mesh,
    details: Vec<Option<Arc<Detail>>>,
    plan: SurfacePlan,
}

impl<'a> Case<'a> {
    fn new(mesh: &'a Mesh, detail: Option<&Arc<Detail>>, geometry: &Geometry) -> Self {
        let plan = surfaces::plan(mesh, geometry).expect("fits");
        Self { mesh, details: vec![detail.cloned(); mesh.primitives.len()], plan }
    }

    fn tables(&self) -> Tables {
        passes::tables::build(&self.plan, self.mesh, &self.details).expect("tables")
    }

    fn on_device(&self, shape: Shape) -> Surface {
        let (cancel, tables) = (Cancel::default(), self.tables());
        let recorder = device().recorder(&cancel, &NoProgress);
        let base = BaseStreams::new(device(), &tables).expect("fits");
        let made = passes::pieces::finish(device(), recorder, &self.plan, &tables, &base, self.mesh, shape);
        made.unwrap_or_else(|error| panic!("{}: {error}", self.mesh.name)).0
    }

    fn on_reference(&self, shape: Shape) -> Surface {
        let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
        let made = reference::pieces::finish(&job, &self.plan, &self.tables(), self.mesh, shape);
        made.unwrap_or_else(|error| panic!("{}: {error}", self.mesh.name)).0
    }
}

/// How far the pieces' values may be from the uniform surface's.
struct Slack {
    normals: f32,
    attributes: f32,
}

const SAME_BITS: Slack = Slack { normals: 0.0, attributes: 0.0 };

fn assert_same(what: &str, pieces: &Surface, uniform: &Surface, slack: &Slack) {
    let apart = |(a, b): (&[f32; 3], &[f32; 3])| Vec3::from(*a).distance(Vec3::from(*b));
    let normals = pieces.normals.iter().zip(&uniform.normals).map(apart).fold(0.0, f32::max);
    assert!(normals <= slack.normals, "{what}: normals {normals:e}");
    assert_eq!(pieces.normals.len(), uniform.normals.len(), "{what}");
    for (a, b) in pieces.attributes.iter().zip(&uniform.attributes) {
        let largest = b.iter().fold(1f32, |most, x| most.max(x.abs()));
        let attributes = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(attributes <= slack.attributes * largest, "{what}: attributes {attributes:e}");
        assert_eq!(a.len(), b.len(), "{what}");
    }
    assert_eq!(pieces.flipped, uniform.flipped, "{what}");
    assert!(pieces.mismatch_max <= uniform.mismatch_max, "{what}");
}

/// Level 0 in the plan of the pieces shows that levels do not matter there.
fn check(what: &str, mesh: &Mesh, detail: &Arc<Detail>, geometry: &Geometry) {
    let base = Case::new(mesh, Some(detail), &Geometry { refinement: Refinement::Uniform(0), ..geometry.clone() });
    let what = format!("{what} on {}, {geometry:?}", mesh.name);
    let exact = geometry.normals == Normals::Analytic;
    let slack =
        |exact_normals: f32, attributes: f32| Slack { normals: if exact { exact_normals } else { 2e-4 }, attributes };
    let uniform = displace(&*device::reference(), mesh, detail, geometry);
    assert_same(&what, &base.on_reference(listed(mesh, &uniform)), &uniform, &slack(0.0, 0.0));
    if let Some(executor) = device::executor("pieces") {
        let uniform = displace(&*executor, mesh, detail, geometry);
        // Attributes are interpolated in f64 here and in f32 there.
        assert_same(&what, &base.on_device(listed(mesh, &uniform)), &uniform, &slack(0.0, 2.4e-7));
    }
}

fn vectors(tangent: bool) -> LayerSource {
    let texel = |i: u32| (maps::hash(i % 16, i / 16, 4) >> 16) as f32 / 65535.0 - 0.5;
    let map = Arc::new(Map {
        width: 16,
        height: 16,
        channels: 3,
        texels: Arc::new((0..3 * 16 * 16).map(texel).collect()),
        wrap: [Wrap::Mirror, Wrap::Repeat],
        sampling: Sampling::Center,
        source_bits: 32,
    });
    if tangent { LayerSource::VectorTangent(map) } else { LayerSource::VectorObject(map) }
}

#[test]
fn listed_places_of_a_uniform_surface_get_its_normals_and_attributes() {
    for mesh in meshes::all() {
        let mesh = mesh.to_mesh();
        let noise = detail(noise_height(32, 1), 0.07);
        for (seams, feather_texels) in [(SeamRule::Mean, 3.0), (SeamRule::Mean, 0.0), (SeamRule::Dominant, 3.0)] {
            check("noise", &mesh, &noise, &Geometry { seams, feather_texels, ..uniform(3) });
        }
        check("noise", &mesh, &noise, &Geometry { normals: Normals::Geometric, ..uniform(3) });
    }
}

#[test]
fn they_do_for_vectors_and_expressions() {
    let wave = expression("0.1*sin(9*u+x)*cos(7*v)+0.05*noise(3*x,3*y,3*z)*nx");
    for mesh in [meshes::cube(), meshes::torus(8, 5), meshes::mirrored_uv_sphere(8, 5)] {
        let mesh = mesh.to_mesh();
        check("tangent vectors", &mesh, &detail(vectors(true), 0.2), &uniform(2));
        check("object vectors", &mesh, &detail(vectors(false), 0.2), &uniform(2));
        check("expression", &mesh, &detail(wave.clone(), 1.0), &uniform(2));
    }
}

/// A cube in two primitives, with colours, joints and weights.
fn skinned(mesh: &TestMesh) -> Mesh {
    let vertices = mesh.positions.len();
    let attribute = |semantic: &str, components: usize, value: &dyn Fn(usize, usize) -> f32| VertexAttribute {
        semantic: semantic.into(),
        components,
        values: (0..vertices).flat_map(|v| (0..components).map(move |k| value(v, k))).collect(),
    };
    let half = mesh.triangles.len() / 2;
    let primitive = |number: usize, triangles: &[[u32; 3]]| PrimitiveInput {
        gltf_primitive: number,
        positions: mesh.positions.clone(),
        normals: Some(mesh.normals.clone()),
        attributes: vec![
            attribute("TEXCOORD_0", 2, &|v, k| mesh.uvs[v][k]),
            attribute("COLOR_0", 3, &|v, k| maps::hash(v as u32, k as u32, 1) as f32 / u32::MAX as f32),
            attribute("JOINTS_0", 4, &|v, k| ((v + 3 * k) % 7) as f32),
            attribute("WEIGHTS_0", 4, &|_, k| [0.5, 0.25, 0.125, 0.125][k]),
        ],
        triangles: triangles.to_vec(),
        ..PrimitiveInput::default()
    };
    let parts = [primitive(0, &mesh.triangles[..half]), primitive(1, &mesh.triangles[half..])];
    with_tangents(&weld("skinned", &parts).expect("welds"), |_| Some(0)).expect("has tangents")
}

#[test]
fn they_do_for_skins_and_several_primitives() {
    let noise = detail(noise_height(32, 2), 0.07);
    for mesh in [meshes::cube(), meshes::torus(8, 5)] {
        check("skin", &skinned(&mesh), &noise, &uniform(3));
    }
}

#[test]
fn without_detail_normals_stay_as_they_were() {
    if without_gpu("pieces") {
        return;
    }
    let mesh = meshes::torus(8, 5).to_mesh();
    let flat = detail(expression("0"), 1.0);
    let uniform = displace(&*device::reference(), &mesh, &flat, &uniform(2));
    let plain = Case::new(&mesh, None, &crate::pieces::uniform(0));
    let [device, twin] = [plain.on_device(listed(&mesh, &uniform)), plain.on_reference(listed(&mesh, &uniform))];
    assert_same("twin", &twin, &uniform, &SAME_BITS);
    assert_same("device", &device, &uniform, &Slack { normals: 2.4e-7, attributes: 0.0 });
}

#[test]
fn a_shape_that_is_not_of_the_mesh_is_refused() {
    let mesh = meshes::cube().to_mesh();
    let noise = detail(noise_height(8, 3), 0.1);
    let surface = displace(&*device::reference(), &mesh, &noise, &uniform(2));
    let case = Case::new(&mesh, Some(&noise), &uniform(0));
    let refusal = |spoil: &dyn Fn(&mut Shape)| {
        let mut shape = listed(&mesh, &surface);
        spoil(&mut shape);
        let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
        let made = reference::pieces::finish(&job, &case.plan, &case.tables(), &mesh, shape);
        made.expect_err("it is spoilt").to_string()
    };
    assert!(refusal(&|s| s.pieces.edge_place[1] = 0).contains("places of ae 0 do not rise"));
    assert!(refusal(&|s| s.pieces.edge_place[0] += 1).contains("the aes of ge"));
    assert!(refusal(&|s| s.pieces.interior_place.swap(0, 1)).contains("places of base triangle 0"));
    assert!(refusal(&|s| s.pieces.triangle_first[3] = 1 << 30).contains("triangle_first does not rise"));
    assert!(refusal(&|s| s.triangles.truncate(9)).contains("where the lists have"));
    assert!(refusal(&|s| s.triangles[0][0] = 1 << 30).contains("where the lists have"));
    assert!(refusal(&|s| s.positions[0][0] = f32::NAN).contains("not finite"));
}

#[test]
fn listed_and_uniform_layouts_place_every_vertex_alike() {
    for level in 0..5 {
        let mesh = meshes::torus(5, 4).to_mesh_without_tangents();
        let surface = displace(&*device::reference(), &mesh, &detail(expression("0"), 1.0), &uniform(level));
        let pieces = Layout::Pieces(Arc::new(listed(&mesh, &surface).pieces));
        assert_eq!(pieces.fault(&mesh), None);
        assert_eq!(pieces.blocks(&mesh), surface.layout.blocks(&mesh));
        let places = |layout: &Layout| (0..layout.vertices(&mesh)).map(|v| layout.place(&mesh, v)).collect::<Vec<_>>();
        assert_eq!(places(&pieces), places(&surface.layout));
        for primitive in &mesh.primitives {
            assert_eq!(pieces.vertices_of(&mesh, primitive), surface.vertices_of(&mesh, primitive));
        }
    }
}
