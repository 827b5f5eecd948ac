//! Refinement on the device against its twin, and what no round may break.

use std::collections::BTreeMap;

use displace_glsl::{
    layout::refine::{RefineBase, UNIT, kind},
    reference::refine::{Base, Refined, barycentrics, marks},
};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    render::{
        JobContext,
        refine::{self, Refinement, Round},
    },
    vulkan::Stream,
};
use displace_tests::meshes::{self, TestMesh};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use crate::raster::device;

const ROUNDS: usize = 8;

fn base(mesh: &TestMesh) -> Base {
    refine::base(&mesh.to_mesh_without_tangents())
}

fn one_round(refinement: &mut Refinement, wanted: &[u32], most: u64) -> Round {
    let cancel = Cancel::default();
    let job = JobContext { cancel: &cancel, progress: &NoProgress };
    let wanted = Stream::from_slice(device(), "wanted", wanted).expect("fits");
    refinement.round(&job, &wanted, most).expect("runs")
}

/// A tenth of the triangles, more of those with a low number, so that sizes differ widely.
fn some(triangles: usize, seed: u64) -> Vec<u32> {
    let mut random = StdRng::seed_from_u64(seed);
    let share = |t: usize| if t < triangles / 8 { 0.4 } else { 0.03 };
    (0..triangles).map(|t| u32::from(random.random_range(0.0..1.0) < share(t))).collect()
}

#[test]
fn every_round_is_the_twin_s_to_the_bit_and_breaks_nothing() {
    for mesh in meshes::all() {
        let base = base(&mesh);
        let mut device_side = Refinement::new(device(), &base).expect("fits");
        let mut twin = Refined::of(&base);
        check(mesh.name, &base, &twin);
        for round in 0..ROUNDS {
            let wanted = some(twin.triangles.len(), round as u64);
            let found = one_round(&mut device_side, &wanted, u64::MAX);
            let marks = marks(&twin, &wanted);
            if marks.contains(&1) {
                twin = twin.split(&base, &marks);
                assert_eq!(found, Round::Split(twin.triangles.len() as u64), "{} round {round}", mesh.name);
            } else {
                assert_eq!(found, Round::Done, "{} round {round}", mesh.name);
            }
            assert!(device_side.read().expect("reads") == twin, "{} round {round}", mesh.name);
            check(mesh.name, &base, &twin);
        }
    }
}

#[test]
fn a_round_over_the_budget_changes_nothing() {
    let base = base(&meshes::cube());
    let mut refinement = Refinement::new(device(), &base).expect("fits");
    let before = refinement.read().expect("reads");
    assert!(matches!(one_round(&mut refinement, &[1; 12], 13), Round::OverBudget(n) if n > 13));
    assert!(refinement.read().expect("reads") == before);
    assert_eq!(one_round(&mut refinement, &[0; 12], 13), Round::Done);
}

#[test]
fn three_triangles_on_one_edge_are_split_together() {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, 0.9, 0.0], [0.5, -0.8, 0.0], [0.6, 0.0, 0.7]];
    let base = book(positions, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    let mut refinement = Refinement::new(device(), &base).expect("fits");
    for round in 0..ROUNDS {
        let triangles = refinement.triangles() as usize;
        // One page of the book alone is wanted finer.
        let before = refinement.read().expect("reads");
        let wanted: Vec<u32> = before.triangles.iter().map(|t| u32::from(t.base == 2)).collect();
        let found = one_round(&mut refinement, &wanted, u64::MAX);
        assert!(matches!(found, Round::Split(n) if n > triangles as u64), "round {round}: {found:?}");
        check("book", &base, &refinement.read().expect("reads"));
    }
}

fn book(positions: Vec<[f32; 3]>, triangles: &[[u32; 3]]) -> Base {
    let side = |t: &[u32; 3], k: usize| [t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])];
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(|t| (0..3).map(move |k| side(t, k))).collect();
    edges.sort_unstable();
    edges.dedup();
    let number = |ends: [u32; 2]| edges.binary_search(&ends).expect("it is there") as u32;
    let triangle = |t: &[u32; 3]| RefineBase {
        gv: *t,
        ge: [0, 1, 2].map(|k| number(side(t, k))),
        reversed: (0..3).filter(|&k| side(t, k)[0] != t[k]).map(|k| 1 << k).sum(),
    };
    Base::new(triangles.iter().map(triangle).collect(), edges.clone(), positions)
}

#[test]
fn a_corner_is_refined_until_its_edges_cannot_be_told_apart_and_no_further() {
    let base = book(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let mut refinement = Refinement::new(device(), &base).expect("fits");
    // Each round at most halves the sides at the corner.
    for round in 0..80 {
        let before = refinement.read().expect("reads");
        let wanted: Vec<u32> = before.triangles.iter().map(|t| u32::from(t.gv.contains(&0))).collect();
        match one_round(&mut refinement, &wanted, u64::MAX) {
            Round::Split(_) => check("corner", &base, &refinement.read().expect("reads")),
            found => {
                assert_eq!(found, Round::TooFine, "round {round}");
                assert!(round >= 24, "round {round}");
                return assert!(refinement.read().expect("reads") == before);
            }
        }
    }
    panic!("sides of one unit were halved");
}

/// The invariants of a conforming refinement.
fn check(name: &str, base: &Base, refined: &Refined) {
    let mut uses = vec![0u32; refined.edges.len()];
    let mut areas = vec![0i128; base.triangles.len()];
    for triangle in &refined.triangles {
        let owner = &base.triangles[triangle.base as usize];
        let b = triangle.gv.map(|gv| barycentrics(&refined.vertices[gv as usize], owner).map(i128::from));
        assert!(b.iter().all(|b| b.iter().sum::<i128>() == i128::from(UNIT)), "{name}: {triangle:?}");
        let [u, v] = [1, 2].map(|k| [b[k][1] - b[0][1], b[k][2] - b[0][2]]);
        let area = u[0] * v[1] - u[1] * v[0];
        assert!(area > 0, "{name}: {triangle:?} is flat or turned over");
        areas[triangle.base as usize] += area;
        for k in 0..3 {
            let edge = &refined.edges[triangle.ge[k] as usize];
            let mut ends = [triangle.gv[k], triangle.gv[(k + 1) % 3]];
            let mut gv = edge.gv;
            ends.sort_unstable();
            gv.sort_unstable();
            assert_eq!(ends, gv, "{name}: side {k} of {triangle:?}");
            uses[triangle.ge[k] as usize] += 1;
        }
    }
    assert!(areas.iter().all(|area| *area == i128::from(UNIT) * i128::from(UNIT)), "{name}: areas");
    let sheets = |ge: u32| base.triangles.iter().filter(|t| t.ge.contains(&ge)).count() as u32;
    let of_base: Vec<u32> = (0..base.edges.len() as u32).map(sheets).collect();
    for (edge, uses) in refined.edges.iter().zip(uses) {
        let expected = if edge.kind == kind::EDGE { of_base[edge.owner as usize] } else { 2 };
        assert_eq!(uses, expected, "{name}: triangles of {edge:?}");
    }
    no_vertex_hangs(name, base, refined);
    let euler = |v: usize, e: usize, f: usize| v as i64 - e as i64 + f as i64;
    assert_eq!(
        euler(refined.vertices.len(), refined.edges.len(), refined.triangles.len()),
        euler(base.positions.len(), base.edges.len(), base.triangles.len()),
        "{name}: Euler characteristic"
    );
}

/// The pieces of every base edge follow each other from its first gv to its second without overlap.
fn no_vertex_hangs(name: &str, base: &Base, refined: &Refined) {
    let mut pieces: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for edge in refined.edges.iter().filter(|edge| edge.kind == kind::EDGE) {
        let first = base.edges[edge.owner as usize][0];
        let mut along = edge.gv.map(|gv| {
            let vertex = &refined.vertices[gv as usize];
            match vertex.kind {
                kind::CORNER if vertex.owner == first => 0,
                kind::CORNER => UNIT,
                _ => vertex.param[0],
            }
        });
        along.sort_unstable();
        assert!(pieces.insert((edge.owner, along[0]), along[1]).is_none(), "{name}: two pieces at one place");
    }
    for owner in 0..base.edges.len() as u32 {
        let mut at = 0;
        while at < UNIT {
            let next = pieces.remove(&(owner, at));
            at = next.unwrap_or_else(|| panic!("{name}: base edge {owner} has a gap at {at}"));
        }
    }
    assert!(pieces.is_empty(), "{name}: {pieces:?} hang");
}
