//! Welding seen from outside: counts, invariants, and that the order of the triangles does not matter.

//! What welding promises, on small meshes.

use super::*;
use proptest::prelude::*;

/// A unit cube with flat normals: 24 vertices, 12 triangles.
fn cube() -> PrimitiveInput {
    let mut input = PrimitiveInput { normals: Some(Vec::new()), ..PrimitiveInput::default() };
    let normals = input.normals.get_or_insert_default();
    for axis in 0..3 {
        for sign in [-1.0f32, 1.0] {
            let first = input.positions.len() as u32;
            for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = ((sign + 1.0) / 2.0, s, t);
                input.positions.push(p);
                let mut n = [0.0; 3];
                n[axis] = sign;
                normals.push(n);
            }
            let quad = if sign > 0.0 { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
            input.triangles.extend(quad.map(|t| t.map(|v: u32| v + first)));
        }
    }
    input
}

fn check_invariants(mesh: &Mesh) {
    let bits = |p: &[f32; 3]| p.map(f32::to_bits);
    assert!(mesh.gv_position.is_sorted_by(|a, b| bits(a) < bits(b)), "gvs are ranked by position bits");
    for (p, primitive) in mesh.primitives.iter().enumerate() {
        for t in &mesh.triangles[primitive.triangles.start as usize..primitive.triangles.end as usize] {
            assert_eq!(t.primitive as usize, p);
            assert!(
                t.av.iter().all(|av| primitive.avs.contains(av)) && t.ae.iter().all(|ae| primitive.aes.contains(ae))
            );
        }
    }
    for triangle in &mesh.triangles {
        for k in 0..3 {
            let mut ends = mesh.ae_av[triangle.ae[k] as usize];
            let side = [triangle.av[k], triangle.av[(k + 1) % 3]];
            if ends != side {
                ends.reverse();
            }
            assert_eq!(ends, side, "ae[k] joins av[k] and av[k + 1]");
        }
    }
    for (ae, av) in mesh.ae_av.iter().enumerate() {
        assert_eq!(av.map(|v| mesh.av_gv[v as usize]), mesh.ge_gv[mesh.ae_ge[ae] as usize], "an ae runs as its ge");
    }
    for (gv, _) in mesh.gv_position.iter().enumerate() {
        assert!(mesh.gv_av.list(gv).is_sorted() && mesh.gv_corner.list(gv).is_sorted());
        assert!(!mesh.gv_corner.list(gv).is_empty(), "no gv without triangles");
        assert!(mesh.gv_av.list(gv).iter().all(|&av| mesh.av_gv[av as usize] as usize == gv));
    }
    assert!(mesh.av_normal.iter().all(|n| (glam::Vec3::from(*n).length() - 1.0).abs() < 1e-6));
    assert!(mesh.gv_direction.iter().flatten().all(|c| c.is_finite()));
}

#[test]
fn a_hard_edged_cube_has_eight_places_and_exact_mitres() {
    let mesh = weld("cube", &[cube()]).unwrap();
    check_invariants(&mesh);
    assert_eq!((mesh.gv_position.len(), mesh.av_gv.len(), mesh.ge_gv.len(), mesh.ae_av.len()), (8, 24, 18, 30));
    assert_eq!((mesh.health.seam_edges, mesh.health.boundary_edges), (12, 0));
    assert_eq!(mesh.health.opposite_winding_edges, 0);
    for (position, direction) in mesh.gv_position.iter().zip(&mesh.gv_direction) {
        assert_eq!(*direction, position.map(|c| 2.0 * c - 1.0));
    }
}

#[test]
fn minus_zero_is_the_same_place_as_zero() {
    let input = PrimitiveInput {
        positions: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, -0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
        ],
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        ..PrimitiveInput::default()
    };
    let mesh = weld("pair", &[input]).unwrap();
    check_invariants(&mesh);
    assert_eq!((mesh.gv_position.len(), mesh.av_gv.len(), mesh.health.boundary_edges), (4, 4, 4));
    assert!(mesh.health.normals_generated);
}

#[test]
fn degenerate_triangles_are_removed_and_counted() {
    let input = PrimitiveInput {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0], [0.0; 3]],
        triangles: vec![[0, 1, 2], [0, 4, 1], [3, 3, 3]],
        ..PrimitiveInput::default()
    };
    let mesh = weld("sliver", &[input]).unwrap();
    check_invariants(&mesh);
    assert_eq!((mesh.triangles.len(), mesh.health.degenerate_triangles, mesh.gv_position.len()), (1, 2, 3));
}

#[test]
fn three_triangles_on_one_edge_are_reported_and_kept() {
    let input = PrimitiveInput {
        positions: vec![[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]],
        ..PrimitiveInput::default()
    };
    let mesh = weld("fan", &[input]).unwrap();
    check_invariants(&mesh);
    assert_eq!((mesh.health.non_manifold_edges, mesh.health.boundary_edges), (1, 6));
}

#[test]
fn zero_normals_are_mended_from_the_triangles() {
    let mut input = cube();
    input.normals.as_mut().unwrap()[5] = [0.0; 3];
    input.normals.as_mut().unwrap()[6] = [f32::NAN, 0.0, 0.0];
    input.normals.as_mut().unwrap()[7] = [7.0, 0.0, 0.0];
    let mesh = weld("cube", &[input]).unwrap();
    check_invariants(&mesh);
    assert_eq!((mesh.health.normals_repaired, mesh.av_gv.len()), (3, 24));
}

#[test]
fn a_triangle_without_area_borrows_a_normal() {
    let input = PrimitiveInput {
        positions: vec![[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 1, 3]],
        ..PrimitiveInput::default()
    };
    let mesh = weld("flat", &[input]).unwrap();
    check_invariants(&mesh);
    assert!(mesh.av_normal.iter().all(|n| *n == [0.0, 0.0, 1.0]));
}

#[test]
fn attributes_join_over_primitives_and_missing_alpha_is_opaque() {
    let mut a = cube();
    let count = a.positions.len();
    let mut b = cube();
    let color = |components: usize| VertexAttribute {
        semantic: "COLOR_0".into(),
        components,
        values: vec![0.5; components * count],
    };
    a.attributes = vec![color(3)];
    b.attributes =
        vec![color(4), VertexAttribute { semantic: "TEXCOORD_0".into(), components: 2, values: vec![0.25; 2 * count] }];
    let mesh = weld("two", &[a, b]).unwrap();
    check_invariants(&mesh);
    let names: Vec<_> =
        mesh.attributes.iter().map(|a| (a.semantic.as_str(), a.components, a.primitives.clone())).collect();
    assert_eq!(names, [("TEXCOORD_0", 2, vec![false, true]), ("COLOR_0", 4, vec![true, true])]);
    assert_eq!(mesh.attributes[1].values[..4], [0.5, 0.5, 0.5, 1.0]);
    assert_eq!((mesh.gv_position.len(), mesh.av_gv.len(), mesh.health.non_manifold_edges), (8, 48, 18));
}

#[test]
fn mirrored_uvs_split_the_tangents_where_the_sheets_meet() {
    let input = PrimitiveInput {
        positions: vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
            [-1.0, 1.0, 0.0],
        ],
        normals: Some(vec![[0.0, 0.0, 1.0]; 6]),
        attributes: vec![VertexAttribute {
            semantic: "TEXCOORD_0".into(),
            components: 2,
            values: vec![0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0],
        }],
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 5], [0, 5, 4]],
        ..PrimitiveInput::default()
    };
    let plain = weld("mirror", &[input]).unwrap();
    let mesh = with_tangents(&plain, |_| Some(0)).unwrap();
    check_invariants(&mesh);
    assert_eq!((plain.av_gv.len(), mesh.av_gv.len()), (6, 8));
    for (av, tangent) in mesh.av_tangent.iter().enumerate() {
        let x = mesh.gv_position[mesh.av_gv[av] as usize][0];
        let side = if tangent[0] > 0.0 { 1.0 } else { -1.0 };
        assert!(x * side >= 0.0, "u grows away from the mirror line");
        assert!((tangent[0].abs() - 1.0).abs() < 1e-6 && tangent[3] == side, "{tangent:?}");
    }
    assert!(with_tangents(&plain, |_| Some(1)).unwrap_err().to_string().contains("TEXCOORD_1"));
}

#[test]
fn a_large_fan_gets_tangents_and_a_huge_one_a_clear_refusal() {
    let fan = |n: u32| {
        let ring = move |i: u32| (f64::from(i) * std::f64::consts::TAU / f64::from(n)).sin_cos();
        let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let place = move |v: u32| if v == 0 { [0.0, 0.0] } else { [ring(v - 1).1 as f32, ring(v - 1).0 as f32] };
        mikk_tangents(&triangles, move |v| [place(v)[0], place(v)[1], 0.0], |_| [0.0, 0.0, 1.0], place)
    };
    // Here v runs up with y, which glTF counts as mirrored.
    assert!(fan(2000).unwrap().iter().all(|t| (t[0] - 1.0).abs() < 1e-3 && t[3] == -1.0));
    assert_eq!(fan(10_000).unwrap_err().kind, crate::domain::ErrorKind::TooLarge);
}

proptest! {
    /// Permuted triangles give the same tables up to the order of the triangles.
    #[test]
    fn the_order_of_the_triangles_changes_nothing_else(seed in any::<u64>(), faces in prop::collection::vec(prop::array::uniform3(0u32..12), 1..40)) {
        let positions: Vec<[f32; 3]> = (0..12u32).map(|i| [(i % 3) as f32, (i / 3 % 2) as f32 * 0.7, (i / 5) as f32 * 1.3]).collect();
        let normals = (0..12u32).map(|i| glam::Vec3::new(i as f32 - 5.0, 1.0, 2.0).normalize().to_array()).collect();
        let input = PrimitiveInput { positions, normals: Some(normals), triangles: faces.clone(), ..PrimitiveInput::default() };
        let mut permuted = input.clone();
        permuted.triangles.sort_by_key(|t| t.iter().fold(seed, |h, &v| (h ^ u64::from(v)).wrapping_mul(0x9E37_79B9_7F4A_7C15)));
        let (a, b) = (weld("a", &[input]).unwrap(), weld("a", &[permuted]).unwrap());
        check_invariants(&a);
        prop_assert_eq!(&a.gv_position, &b.gv_position);
        prop_assert_eq!(&a.gv_direction, &b.gv_direction);
        prop_assert_eq!(&a.av_normal, &b.av_normal);
        prop_assert_eq!(&a.ge_gv, &b.ge_gv);
        prop_assert_eq!(&a.ae_av, &b.ae_av);
        prop_assert_eq!(a.health, b.health);
    }
}
