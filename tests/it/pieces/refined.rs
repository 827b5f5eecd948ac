//! Refined meshes as surfaces: every invariant holds, and the order of the input does not show.

use std::sync::Arc;

use displace_glsl::{
    layout::refine::{RefinedVertex, UNIT, kind},
    reference::refine::{Refined, marks},
};
use displace_server::{
    domain::{
        gltf::{Limits, Packing, load, write},
        mesh::Mesh,
        surface::{Arrangement, Layout, Shape, Surface},
    },
    oracle::{
        facts::MeshFacts,
        invariants::{self, boundary_edges, euler_characteristic},
    },
    render::refine,
};
use displace_tests::{glb, meshes, surfaces::uniform};
use glam::{DVec3, Vec3};
use rand::{RngExt as _, SeedableRng, rngs::StdRng, seq::SliceRandom as _};

use super::Case;

/// Refined `rounds` times by random triangles, most of them near the first ones.
fn refined(mesh: &Mesh, rounds: u64) -> Refined {
    let base = refine::base(mesh);
    let mut refined = Refined::of(&base);
    for round in 0..rounds {
        let mut random = StdRng::seed_from_u64(round);
        let share = |base: u32| if base < 3 { 0.5 } else { 0.03 };
        let wanted: Vec<u32> =
            refined.triangles.iter().map(|t| u32::from(random.random_range(0.0..1.0) < share(t.base))).collect();
        refined = refined.split(&base, &marks(&refined, &wanted));
    }
    refined
}

/// Where each refined vertex is, moved by what its place on the flat base says.
fn moved(mesh: &Mesh, vertices: &[RefinedVertex], by: impl Fn(DVec3) -> DVec3) -> Vec<[f32; 3]> {
    let at = |gv: u32| DVec3::from_array(mesh.gv_position[gv as usize].map(f64::from));
    let part = |units: u32| f64::from(units) / f64::from(UNIT);
    let place = |vertex: &RefinedVertex| match vertex.kind {
        kind::CORNER => at(vertex.owner),
        kind::EDGE => {
            let [from, to] = mesh.ge_gv[vertex.owner as usize].map(at);
            from + (to - from) * part(vertex.param[0])
        }
        _ => {
            let [a, b, c] = mesh.triangles[vertex.owner as usize].av.map(|av| at(mesh.av_gv[av as usize]));
            a + (b - a) * part(vertex.param[0]) + (c - a) * part(vertex.param[1])
        }
    };
    vertices.iter().map(|vertex| by(place(vertex)).as_vec3().to_array()).collect()
}

fn finished(mesh: &Mesh, shape: Shape) -> Surface {
    Case::new(mesh, None, &uniform(0)).on_reference(shape)
}

fn arranged(mesh: &Mesh, refined: &Refined) -> Arrangement {
    Arrangement::of(mesh, &refined.vertices, &refined.triangles).expect("it is of the mesh")
}

#[test]
fn refined_meshes_keep_every_invariant() {
    let wave = |p: DVec3| p + 0.02 * (9.0 * p).cos();
    for mesh in meshes::all() {
        let base = mesh.to_mesh_without_tangents();
        for rounds in [0, 1, 9] {
            let refined = refined(&base, rounds);
            let shape = arranged(&base, &refined).placed(&moved(&base, &refined.vertices, wave));
            assert_eq!(shape.triangles.len(), refined.triangles.len());
            let surface = finished(&base, shape);
            assert_eq!(invariants::of_surface(&base, &surface), [], "{} after {rounds} rounds", mesh.name);
            assert_eq!(invariants::largest_gap(&base, &surface), 0.0, "{}", mesh.name);
        }
    }
}

/// The same refinement with its vertices and triangles in another order, and triangles from another corner on.
fn shuffled(refined: &Refined, seed: u64) -> Refined {
    let mut random = StdRng::seed_from_u64(seed);
    let mut old_of_new: Vec<u32> = (0..refined.vertices.len() as u32).collect();
    old_of_new.shuffle(&mut random);
    let mut new_of_old = vec![0; old_of_new.len()];
    (0..).zip(&old_of_new).for_each(|(new, old)| new_of_old[*old as usize] = new);
    let mut triangles = refined.triangles.clone();
    for triangle in &mut triangles {
        triangle.gv = triangle.gv.map(|gv| new_of_old[gv as usize]);
        triangle.gv.rotate_left(random.random_range(0..3));
    }
    triangles.shuffle(&mut random);
    let vertices = old_of_new.iter().map(|old| refined.vertices[*old as usize]).collect();
    Refined { vertices, triangles, ..Refined::default() }
}

#[test]
fn the_order_of_vertices_and_triangles_does_not_show() {
    for mesh in [meshes::cube(), meshes::torus(8, 5), meshes::moebius(8, 2)] {
        let base = mesh.to_mesh_without_tangents();
        let refined = refined(&base, 8);
        let shape = |refined: &Refined| arranged(&base, refined).placed(&moved(&base, &refined.vertices, |p| p));
        for seed in 0..3 {
            assert!(shape(&shuffled(&refined, seed)) == shape(&refined), "{}, seed {seed}", mesh.name);
        }
    }
}

#[test]
fn vertices_without_triangles_are_left_out_and_those_of_the_base_stay() {
    let base = meshes::cube().to_mesh_without_tangents();
    let mut refined = refined(&base, 5);
    let expected = arranged(&base, &refined);
    refined.vertices.push(RefinedVertex { kind: kind::EDGE, owner: 1, param: [UNIT / 8 + 1, 0] });
    refined.vertices.push(RefinedVertex { kind: kind::INTERIOR, owner: 1, param: [UNIT / 8 + 1; 2] });
    assert_eq!(arranged(&base, &refined), expected);
    let none = Arrangement::of(&base, &refined.vertices, &[]).expect("nothing is wrong with it");
    assert_eq!((none.refined_of_fine.len(), none.pieces.triangle_first.last()), (base.av_gv.len(), Some(&0)));
}

#[test]
fn a_triangle_that_is_not_of_its_base_triangle_is_refused() {
    let base = meshes::cube().to_mesh_without_tangents();
    let refusal = |spoil: &dyn Fn(&mut Refined)| {
        let mut refined = refined(&base, 5);
        spoil(&mut refined);
        Arrangement::of(&base, &refined.vertices, &refined.triangles).expect_err("it is spoilt").to_string()
    };
    assert!(refusal(&|r| r.triangles[0].base = 1 << 30).contains("base: 1073741824"));
    assert!(refusal(&|r| r.triangles[0].gv[1] = 1 << 30).contains("1073741824"));
    assert!(refusal(&|r| r.triangles[0].base = (r.triangles[0].base + 6) % 12).contains("not of its base triangle"));
    assert!(refusal(&|r| r.vertices[0].kind = kind::EDGE).contains("base triangle"));
}

#[test]
fn stretch_and_flips_of_pieces_are_those_of_the_map() {
    let plane = meshes::plane(2).to_mesh_without_tangents();
    let refined = refined(&plane, 7);
    let facts = |by: fn(DVec3) -> DVec3| {
        let shape = arranged(&plane, &refined).placed(&moved(&plane, &refined.vertices, by));
        MeshFacts::of_surface(&plane, &finished(&plane, shape))
    };
    let sheared = facts(|p| DVec3::new(2.0 * p.x, p.x, p.z));
    let stretch = sheared.stretch.expect("a plane has area");
    assert!((stretch.max - 5f64.sqrt()).abs() < 1e-4 && (stretch.p99 - 5f64.sqrt()).abs() < 1e-4, "{stretch:?}");
    assert_eq!((sheared.flipped, sheared.seam_gap), (Some(0), Some(0.0)));
    let turned = facts(|p| DVec3::new(-p.x, p.y, p.z));
    assert_eq!(turned.flipped, Some(refined.triangles.len() as u64));
    assert!((turned.stretch.expect("it has area").max - 1.0).abs() < 1e-4);
}

#[test]
fn each_fault_planted_in_pieces_breaks_its_rule() {
    let base = meshes::cube().to_mesh_without_tangents();
    let refined = refined(&base, 6);
    let shape = arranged(&base, &refined).placed(&moved(&base, &refined.vertices, |p| p));
    let surface = finished(&base, shape);
    let broken = |plant: &dyn Fn(&mut Surface)| -> Vec<&'static str> {
        let mut spoilt = surface.clone();
        plant(&mut spoilt);
        invariants::of_surface(&base, &spoilt).iter().map(|broken| broken.rule).collect()
    };
    let spoil = |surface: &mut Surface, what: fn(&mut displace_server::domain::surface::Pieces)| {
        if let Layout::Pieces(pieces) = &mut surface.layout {
            what(Arc::make_mut(pieces));
        }
    };
    assert_eq!(broken(&|_| ()), [""; 0]);
    assert_eq!(broken(&|s| spoil(s, |p| p.edge_place.reverse())), ["lists"]);
    assert_eq!(broken(&|s| spoil(s, |p| p.interior_place.truncate(1))), ["lists"]);
    // The triangles still tile the base: only what was interpolated there tells.
    assert_eq!(broken(&|s| spoil(s, |p| p.interior_place[0][0] += 1 << 12)), ["attributes"]);
    assert!(broken(&|s| s.triangles.swap(0, surface.triangles.len() - 1)).contains(&"partition"));
    assert_eq!(broken(&|s| s.triangles.truncate(3)), ["sizes"]);
}

#[test]
fn a_cube_refined_in_one_corner_is_written_without_cracks() {
    let cube = meshes::cube();
    let mut scene = load(&cube.to_glb().into(), &|_| None, &Limits::default()).expect("loads");
    let mesh = scene.meshes[0].mesh.clone();
    let refined = refined(&mesh, 10);
    // A bump that depends on the place alone.
    let bump = |p: DVec3| p * (1.0 + 0.2 * (-8.0 * p.distance_squared(DVec3::splat(-0.5))).exp());
    let shape = arranged(&mesh, &refined).placed(&moved(&mesh, &refined.vertices, bump));
    let triangles = shape.triangles.len();
    let surface = finished(&mesh, shape);
    assert_eq!(invariants::of_surface(&mesh, &surface), []);
    let written = write(&scene, std::slice::from_ref(&surface), &Packing::default()).expect("writes");
    let whole = glb::joined(&glb::read(&written.bytes));
    assert_eq!(whole.triangles.len(), triangles);
    assert_eq!(whole.positions.len(), surface.positions.len());
    assert_eq!(boundary_edges(&whole.positions, &whole.triangles), 0);
    assert_eq!(euler_characteristic(&whole.positions, &whole.triangles), 2);
    assert!(whole.normals.iter().all(|n| (Vec3::from(*n).length() - 1.0).abs() < 1e-6));
    // It reads back as a mesh, and a surface that is not of the mesh is refused.
    assert!(load(&written.bytes.into(), &|_| None, &Limits::default()).is_ok());
    scene.meshes[0].mesh.triangles.pop();
    let error = write(&scene, &[surface], &Packing::default()).expect_err("it is not of the mesh");
    assert!(error.to_string().contains("does not rise"), "{error}");
}
