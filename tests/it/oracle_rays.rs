//! Rays of the oracle through edges and vertices of closed meshes: none leaks.

use std::collections::HashMap;

use bytes::Bytes;
use displace_server::{
    domain::{
        gltf::{Limits, load},
        mesh::Mesh,
    },
    oracle::{
        bvh::Segment,
        ray::{Hit, Tracer},
    },
};
use displace_tests::{
    data::sample,
    meshes::{self, TestMesh},
};
use glam::DVec3;
use rand::{RngExt as _, SeedableRng, rngs::StdRng};
use rayon::prelude::*;

struct Closed {
    name: String,
    places: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    tracer: Tracer,
}

impl Closed {
    /// Joins every edge that lacks a neighbour to one point far below: whatever it was, the mesh is closed then.
    fn new(name: &str, mut places: Vec<DVec3>, mut triangles: Vec<[u32; 3]>) -> Self {
        let open = open_edges(&triangles);
        let apex = places.len() as u32;
        places.push(DVec3::new(0.25, -8.0, 0.5));
        triangles.extend(open.into_iter().map(|[a, b]| [b, a, apex]));
        assert!(open_edges(&triangles).is_empty(), "{name} is not closed");
        let tracer = Tracer::new(places.clone(), triangles.clone());
        Self { name: name.into(), places, triangles, tracer }
    }

    /// Vertices of the same place become one.
    fn procedural(mesh: &TestMesh) -> Self {
        let mut known = HashMap::new();
        let mut places = Vec::new();
        let mut place = |p: &[f32; 3]| {
            *known.entry(p.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                places.push(DVec3::from_array(p.map(f64::from)));
                places.len() as u32 - 1
            })
        };
        let place_of: Vec<u32> = mesh.positions.iter().map(&mut place).collect();
        Self::new(mesh.name, places, mesh.triangles.iter().map(|t| t.map(|v| place_of[v as usize])).collect())
    }

    fn welded(mesh: &Mesh) -> Self {
        let places = mesh.gv_position.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
        let triangles = mesh.triangles.iter().map(|t| t.av.map(|v| mesh.av_gv[v as usize])).collect();
        Self::new(&mesh.name, places, triangles)
    }

    /// A point of an edge, or a vertex, without any rounding.
    fn target(&self, random: &mut StdRng) -> DVec3 {
        let t = self.triangles[random.random_range(0..self.triangles.len())];
        let k = random.random_range(0..3);
        let [a, b] = [t[k], t[(k + 1) % 3]].map(|v| self.places[v as usize]);
        match random.random_range(0..4) {
            0 => a,
            1 => 0.5 * (a + b),
            2 => 0.25 * a + 0.75 * b,
            _ => 0.625 * a + 0.375 * b,
        }
    }

    /// Rays that a closed surface lets through, of `count`. `inside` is within it; other rays begin outside.
    fn leaks(&self, count: u32, inside: Option<DVec3>) -> usize {
        let lot = |lot: u32| {
            let mut random = StdRng::seed_from_u64(lot.into());
            (0..1000).filter(|_| self.leaks_once(inside, &mut random)).count()
        };
        (0..count / 1000).into_par_iter().map(lot).sum()
    }

    fn leaks_once(&self, inside: Option<DVec3>, random: &mut StdRng) -> bool {
        let mut grid = || f64::from(random.random_range(-(1i32 << 20)..1 << 20)) / f64::from(1 << 20);
        // On a grid, so that directions are exact; just off the place inside, or on the sides of a large box.
        let mut offset = DVec3::new(grid(), grid(), grid());
        let axis = random.random_range(0..3);
        offset[axis] = if inside.is_some() { offset[axis] } else { offset[axis].signum() };
        let origin = inside.map_or(256.0 * offset, |inside| inside + 0.03125 * offset);
        let direction = self.target(random) - origin;
        let hits = self.tracer.hits(&Segment { origin, direction, from: 0.0, to: f64::INFINITY });
        let balance = |hit: &Hit| if hit.front { 1 } else { -1 };
        let left = hits.iter().map(balance).sum::<i32>();
        left != if inside.is_some() { -1 } else { 0 }
    }
}

/// Edges that are run through more often one way than the other, as often as that.
fn open_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for t in triangles {
        for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
            *balance.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    let turned = |([a, b], n): ([u32; 2], i32)| {
        std::iter::repeat_n(if n > 0 { [a, b] } else { [b, a] }, n.unsigned_abs() as usize)
    };
    balance.into_iter().flat_map(turned).collect()
}

fn suzanne() -> Closed {
    let path = sample("models/Suzanne/Suzanne.gltf");
    let beside = |uri: &str| std::fs::read(path.with_file_name(uri)).ok().map(Bytes::from);
    let bytes = std::fs::read(&path).expect("the sample can be read");
    let scene = load(&bytes.into(), &beside, &Limits::default()).expect("the sample loads");
    Closed::welded(&scene.meshes[0].mesh)
}

/// Meshes, and a place well inside.
fn closed_meshes() -> Vec<(Closed, Option<DVec3>)> {
    vec![
        (Closed::procedural(&meshes::icosphere(4)), Some(DVec3::ZERO)),
        (Closed::procedural(&meshes::torus(96, 48)), Some(DVec3::X)),
        (Closed::procedural(&meshes::cube()), Some(DVec3::ZERO)),
        (suzanne(), None),
    ]
}

fn assert_tight(rays: u32) {
    for (mesh, inside) in closed_meshes() {
        for inside in [inside, None] {
            let leaks = mesh.leaks(rays / 8, inside);
            assert_eq!(leaks, 0, "{}, inside: {inside:?}: {leaks} of {} rays leak", mesh.name, rays / 8);
        }
    }
}

#[test]
fn no_ray_through_an_edge_or_a_vertex_leaks() {
    assert_tight(160_000);
}

#[test]
#[ignore = "takes half a minute: cargo test --workspace --test it ten_million -- --ignored"]
fn no_ray_of_ten_million_leaks() {
    assert_tight(10_000_000);
}
