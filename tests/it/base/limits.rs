//! The limit of Loop's subdivision against its definition: explicit subdivision, written here.

use std::collections::HashMap;

use displace_glsl::patches::Patches;
use displace_tests::{maps, meshes};
use glam::DVec3;

use super::*;

/// A corner of a subdivided mesh: its vertex, and where it lies in its base triangle.
type Place = (usize, DVec3);

/// A mesh under subdivision.
struct Explicit {
    points: Vec<DVec3>,
    /// Base triangle and corners.
    triangles: Vec<(usize, [Place; 3])>,
}

impl Explicit {
    fn new(mesh: &Mesh) -> Self {
        let corner = |av: u32, b: DVec3| (mesh.av_gv[av as usize] as usize, b);
        let triangle =
            |(t, [a, b, c]): (usize, [u32; 3])| (t, [corner(a, DVec3::X), corner(b, DVec3::Y), corner(c, DVec3::Z)]);
        Self {
            points: mesh.gv_position.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect(),
            triangles: mesh.triangles.iter().map(|t| t.av).enumerate().map(triangle).collect(),
        }
    }

    /// The vertices across from each edge.
    fn edges(&self) -> HashMap<[usize; 2], Vec<usize>> {
        let mut edges: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
        for (_, c) in &self.triangles {
            for k in 0..3 {
                let [a, b, across] = [0, 1, 2].map(|n| c[(k + n) % 3].0);
                edges.entry([a.min(b), a.max(b)]).or_default().push(across);
            }
        }
        edges
    }

    fn subdivided(&self) -> Self {
        let edges = self.edges();
        let mut points = self.moved(&edges);
        let mut middles = HashMap::new();
        let mut keys: Vec<_> = edges.keys().copied().collect();
        keys.sort_unstable();
        for [a, b] in keys {
            let (ends, across) = (self.points[a] + self.points[b], &edges[&[a, b]]);
            let inner = || 0.375 * ends + 0.125 * (self.points[across[0]] + self.points[across[1]]);
            middles.insert([a, b], points.len());
            points.push(if across.len() == 2 { inner() } else { 0.5 * ends });
        }
        let between = |a: Place, b: Place| (middles[&[a.0.min(b.0), a.0.max(b.0)]], 0.5 * (a.1 + b.1));
        let mut triangles = Vec::new();
        for (t, [a, b, c]) in &self.triangles {
            let [ab, bc, ca] = [between(*a, *b), between(*b, *c), between(*c, *a)];
            triangles.extend([[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]].map(|corners| (*t, corners)));
        }
        Self { points, triangles }
    }

    fn moved(&self, edges: &HashMap<[usize; 2], Vec<usize>>) -> Vec<DVec3> {
        let mut around = vec![(Vec::new(), Vec::new()); self.points.len()];
        let mut keys: Vec<_> = edges.iter().collect();
        keys.sort_unstable();
        for ([a, b], across) in keys {
            for (own, other) in [(*a, *b), (*b, *a)] {
                around[own].0.push(self.points[other]);
                around[own].1.extend((across.len() != 2).then_some(self.points[other]));
            }
        }
        let moved = |(p, (ring, creases)): (&DVec3, &(Vec<DVec3>, Vec<DVec3>))| {
            let n = ring.len() as f64;
            let beta = (0.625 - (0.375 + 0.25 * (std::f64::consts::TAU / n).cos()).powi(2)) / n;
            match creases.len() {
                0 => *p * (1.0 - n * beta) + beta * ring.iter().sum::<DVec3>(),
                2 => 0.75 * *p + 0.125 * (creases[0] + creases[1]),
                _ => *p,
            }
        };
        self.points.iter().zip(&around).map(moved).collect()
    }

    /// The greatest distance of its vertices from the limit.
    fn apart(&self, patches: &Patches) -> f64 {
        let corners = self.triangles.iter().flat_map(|(t, corners)| corners.map(|(vertex, b)| (*t, vertex, b)));
        corners.map(|(t, vertex, b)| limit(patches, t, b).distance(self.points[vertex])).fold(0.0, f64::max)
    }
}

fn limit(patches: &Patches, t: usize, b: DVec3) -> DVec3 {
    let leaf = patches.leaf(t as u32, b);
    patches.origin(&leaf.node) + patches.position(&leaf.node).at(leaf.b)
}

fn patches(mesh: &Mesh) -> std::sync::Arc<Patches> {
    mesh.patches.clone().expect("it was bent")
}

#[test]
fn explicit_subdivision_converges_to_the_limit() {
    let mut bumpy = meshes::plane(3);
    for (k, p) in (0..).zip(&mut bumpy.positions) {
        p[1] = (maps::hash(k, 3, 5) >> 16) as f32 / 65535.0 * 0.3;
    }
    for mesh in [meshes::icosphere(0), bumpy, meshes::cube(), meshes::torus(5, 4), meshes::moebius(6, 1)] {
        let limit = patches(&bent(&mesh, Base::Loop));
        let mut explicit = Explicit::new(&mesh.to_mesh());
        let mut apart = Vec::new();
        for _ in 0..6 {
            explicit = explicit.subdivided();
            apart.push(explicit.apart(&limit));
        }
        assert!(apart[5] < 1.2e-3, "{}: {apart:?}", mesh.name);
        // Around vertices on borders the control net shrinks onto the limit by 0.58 a step at worst.
        assert!(apart[5] < apart[3] / 2.0, "{}: {apart:?}", mesh.name);
    }
}

#[test]
fn a_parabola_on_a_regular_grid_is_a_parabola_a_third_of_a_step_squared_above() {
    let mut mesh = meshes::plane(8);
    for p in &mut mesh.positions {
        p[1] = p[0] * p[0];
    }
    let base = mesh.to_mesh();
    let patches = patches(&bent(&mesh, Base::Loop));
    for (t, triangle) in base.triangles.iter().enumerate() {
        let corners = triangle.av.map(|av| base.gv_position[base.av_gv[av as usize] as usize]);
        if corners.iter().any(|p| p[0].abs() > 0.3 || p[2].abs() > 0.3) {
            continue;
        }
        for b in [DVec3::new(0.25, 0.5, 0.25), DVec3::new(0.0, 0.125, 0.875), DVec3::splat(1.0 / 3.0)] {
            let p = limit(&patches, t, b);
            assert!((p.y - p.x * p.x - 1.0 / 192.0).abs() < 1e-7, "{t}: {p}");
        }
    }
}

#[test]
fn two_triangles_have_the_same_place_along_their_edge() {
    for (mesh, base) in meshes::all().iter().flat_map(|mesh| SMOOTH.map(|base| (mesh, base))) {
        let own = bent(mesh, base);
        let patches = patches(&own);
        for ge in 0..own.ge_gv.len() {
            let at = |side: u32, along: f64| {
                let (t, k) = ((side / 3) as usize, side as usize % 3);
                let first = own.av_gv[own.triangles[t].av[k] as usize];
                let along = if first == own.ge_gv[ge][0] { along } else { 1.0 - along };
                let mut b = DVec3::ZERO;
                (b[k], b[(k + 1) % 3]) = (1.0 - along, along);
                limit(&patches, t, b)
            };
            for along in [0.0, 0.25, 0.3125, 0.7] {
                let sides = own.ge_side.list(ge);
                let apart = at(sides[0], along).distance(at(sides[sides.len() - 1], along));
                assert!(apart < 1e-6, "{} {base:?} {ge}: {apart:e}", mesh.name);
            }
        }
    }
}
