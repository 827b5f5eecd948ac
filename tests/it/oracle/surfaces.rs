//! The oracle's surface against the reference executor, which has other code, and against itself.

use std::sync::Arc;

use displace_server::{
    domain::{
        cancel::Cancel,
        detail::{Detail, LayerSource, Map, Sampling, Wrap},
        mesh::Mesh,
        surface::Place,
    },
    oracle::{
        dicing::{Dicing, Limits, dice},
        surface::{SeamChoice, Surface},
    },
    render::reference::ReferenceExecutor,
};
use displace_tests::{
    maps,
    meshes::{self, TestMesh},
    surfaces::{detail, displace, expression, noise_height, uniform},
};
use glam::DVec3;

fn vector_map(size: u32, seed: u32, tangent: bool) -> LayerSource {
    let texel = |i: u32| (maps::hash(i % size, i / size, seed) >> 16) as f32 / 65535.0 - 0.5;
    let map = Arc::new(Map {
        width: size,
        height: size,
        channels: 3,
        texels: Arc::new((0..3 * size * size).map(texel).collect()),
        wrap: [Wrap::Mirror, Wrap::Repeat],
        sampling: Sampling::Center,
        source_bits: 32,
    });
    if tangent { LayerSource::VectorTangent(map) } else { LayerSource::VectorObject(map) }
}

fn cases() -> Vec<(&'static str, TestMesh, Arc<Detail>)> {
    let wave = "0.1*sin(9*u+x)*cos(7*v)+0.05*noise(3*x,3*y,3*z)*nx";
    vec![
        ("plane, height", meshes::plane(2), detail(noise_height(16, 1), 0.1)),
        ("cube, height: every edge is a seam", meshes::cube(), detail(noise_height(11, 2), 0.2)),
        ("torus, height", meshes::torus(8, 5), detail(noise_height(13, 3), 0.1)),
        ("sphere, tangent vectors", meshes::uv_sphere(8, 5), detail(vector_map(8, 4, true), 0.2)),
        ("mirrored sphere, tangent vectors", meshes::mirrored_uv_sphere(8, 5), detail(vector_map(8, 5, true), 0.2)),
        ("cube, object vectors", meshes::cube(), detail(vector_map(11, 6, false), 0.2)),
        ("torus, expression", meshes::torus(8, 5), detail(expression(wave), 1.0)),
        ("moebius strip, height", meshes::moebius(12, 2), detail(noise_height(8, 7), 0.1)),
    ]
}

fn choice(geometry: &displace_server::domain::request::Geometry) -> SeamChoice {
    SeamChoice::from(geometry)
}

fn surface<'m>(mesh: &'m Mesh, detail: &Arc<Detail>) -> Surface<'m> {
    Surface::new(mesh, &vec![Some(Arc::clone(detail)); mesh.primitives.len()], choice(&uniform(0)))
}

fn diced(surface: &Surface<'_>, residual: f64) -> Dicing {
    let limits = Limits { max_triangles: 2_000_000, max_depth: 40 };
    dice(surface, &limits, &Cancel::default(), &|region| region.deviation > residual).unwrap()
}

#[test]
fn places_and_normals_agree_with_the_reference_executor() {
    for (name, mesh, detail) in cases() {
        let mesh = mesh.to_mesh();
        let made = displace(&ReferenceExecutor, &mesh, &detail, &uniform(3));
        let surface = surface(&mesh, &detail);
        let (mut apart, mut turned) = (0f64, 0f64);
        for vertex in made.layout.blocks(&mesh)[2].clone() {
            let Place::Inside { triangle, .. } = made.layout.place(&mesh, vertex) else { panic!("{name}: {vertex}") };
            let (t, b) = (triangle as usize, DVec3::from_array(made.site(&mesh, vertex).1));
            let (place, normal) = surface.position_and_normal(t, b);
            assert!(place.distance(surface.position(t, b)) < 1e-14);
            apart = apart.max(place.distance(DVec3::from_array(made.positions[vertex].map(f64::from))));
            turned = turned.max(normal.distance(DVec3::from_array(made.normals[vertex].map(f64::from))));
        }
        assert!(apart < 1e-6, "{name}: {apart} apart");
        assert!(turned < 2e-4, "{name}: normals {turned} apart");
    }
}

#[test]
fn a_dicing_is_within_its_residual_everywhere() {
    for (name, mesh, detail) in cases() {
        let mesh = mesh.to_mesh();
        let surface = surface(&mesh, &detail);
        let dicing = diced(&surface, 3e-2);
        let mut largest = 0f64;
        for (k, at) in dicing.at.iter().enumerate() {
            let corners = dicing.triangles[k].map(|v| dicing.positions[v as usize]);
            for i in 0..=6u32 {
                for j in 0..=6 - i {
                    let w = [6 - i - j, i, j].map(|x| f64::from(x) / 6.0);
                    let blend = |v: [DVec3; 3]| v[0] * w[0] + v[1] * w[1] + v[2] * w[2];
                    let place = surface.position(dicing.base[k] as usize, blend(*at));
                    let apart = place.distance(blend(corners));
                    let residual = f64::from(dicing.residual[k]);
                    assert!(apart <= residual + 1e-9, "{name}: triangle {k}: {apart} > {residual}");
                    largest = largest.max(apart);
                }
            }
        }
        let residual = dicing.residual.iter().copied().fold(0.0, f32::max);
        eprintln!("{name}: {} triangles, residual {residual:e}, largest {largest:e}", dicing.triangles.len());
        assert!(residual <= 3.1e-2, "{name}: residual {residual}");
    }
}

#[test]
fn a_dicing_has_the_boundary_and_topology_of_its_mesh() {
    for (name, mesh, detail) in cases() {
        let mesh = mesh.to_mesh();
        let dicing = diced(&surface(&mesh, &detail), 5e-2);
        let base: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.av.map(|av| mesh.av_gv[av as usize])).collect();
        let euler = |triangles: &[[u32; 3]]| {
            let mut edges = std::collections::HashMap::new();
            let mut vertices = std::collections::HashSet::new();
            for t in triangles {
                for k in 0..3 {
                    let (a, b) = (t[k], t[(k + 1) % 3]);
                    *edges.entry((a.min(b), a.max(b))).or_insert(0u32) += 1;
                    vertices.insert(a);
                }
            }
            let open = edges.values().filter(|uses| **uses == 1).count();
            let crowded = edges.values().filter(|uses| **uses > 2).count();
            (vertices.len() as i64 - edges.len() as i64 + triangles.len() as i64, open > 0, crowded)
        };
        assert_eq!(euler(&base), euler(&dicing.triangles), "{name}");
    }
}
