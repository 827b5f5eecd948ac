//! The oracle's checks and facts against closed forms: what holds is silent, what is planted is found.

use displace_server::{
    domain::{mesh::Mesh, surface::Surface},
    oracle::{
        facts::{MeshFacts, Strain, self_intersections},
        invariants,
    },
};
use displace_tests::{
    meshes::{self, TestMesh},
    subdivided::subdivided,
};
use glam::{DMat3, DVec3, Vec3};
use proptest::prelude::*;

fn facts(mesh: &TestMesh) -> MeshFacts {
    MeshFacts::of(&mesh.positions, &mesh.triangles)
}

fn max(strain: &Strain) -> f64 {
    strain.stretch().expect("it has triangles with area").max
}

/// The base as it is, subdivided.
fn flat(mesh: &Mesh, level: u32) -> Surface {
    subdivided(mesh, level, |_| 0.0)
}

/// Every vertex of the subdivided base moved.
fn moved(mesh: &Mesh, level: u32, by: impl Fn(Vec3) -> Vec3) -> Surface {
    let mut surface = flat(mesh, level);
    surface.positions.iter_mut().for_each(|p| *p = by(Vec3::from(*p)).to_array());
    surface
}

#[test]
fn boundaries_and_euler_characteristics_are_those_of_the_surfaces() {
    for (mesh, boundary, euler) in [
        (meshes::plane(3), 12, 1),
        (meshes::cube(), 0, 2),
        (meshes::uv_sphere(12, 6), 0, 2),
        (meshes::mirrored_uv_sphere(16, 8), 0, 2),
        (meshes::icosphere(2), 0, 2),
        (meshes::torus(12, 6), 0, 0),
        // One border that runs round twice.
        (meshes::moebius(24, 4), 48, 0),
    ] {
        let facts = facts(&mesh);
        assert_eq!((facts.boundary_edges, facts.euler_characteristic), (boundary, euler), "{}", mesh.name);
        assert_eq!((facts.components, facts.non_manifold_edges, facts.degenerate_triangles), (1, 0, 0));
        assert_eq!(facts.volume.is_some(), boundary == 0, "{}", mesh.name);
        assert_eq!(facts.badly_wound_edges > 0, mesh.name == "moebius", "{}", mesh.name);
        assert_eq!(facts.smallest_angles.iter().sum::<u64>(), facts.triangles);
    }
}

#[test]
fn area_and_volume_of_a_cube_are_exact_and_of_a_sphere_approached_from_within() {
    let cube = facts(&meshes::cube());
    assert!((cube.area - 6.0).abs() < 1e-12 && (cube.volume.unwrap() - 1.0).abs() < 1e-12, "{cube:?}");
    assert_eq!(cube.smallest_angles[9 - 1] + cube.smallest_angles[9], 12, "half squares have 45 degrees");
    let deficit = |level: u32| {
        let sphere = facts(&meshes::icosphere(level));
        let ratio = sphere.volume.unwrap() / (4.0 / 3.0 * std::f64::consts::PI);
        assert!(ratio < 1.0, "{ratio}");
        1.0 - ratio
    };
    // Second order in the edge: a quarter with each level.
    let order = deficit(3) / deficit(4);
    assert!((3.9..4.1).contains(&order) && deficit(4) < 0.004, "{order} {}", deficit(4));
}

#[test]
fn closed_meshes_do_not_meet_themselves_and_two_that_overlap_do() {
    for mesh in [meshes::cube(), meshes::torus(24, 12), meshes::icosphere(2), meshes::uv_sphere(24, 12)] {
        assert_eq!(self_intersections(&mesh.positions, &mesh.triangles, 4).count, 0, "{}", mesh.name);
    }
    let sphere = meshes::icosphere(2);
    let shifted = |by: f32| {
        let mut both = sphere.clone();
        both.positions.extend(sphere.positions.iter().map(|p| [p[0] + by, p[1], p[2]]));
        let first = sphere.positions.len() as u32;
        both.triangles.extend(sphere.triangles.iter().map(|t| t.map(|v| v + first)));
        (self_intersections(&both.positions, &both.triangles, 4), facts(&both).components)
    };
    assert_eq!((shifted(2.5).0.count, shifted(2.5).1), (0, 2));
    let (found, components) = shifted(0.9);
    assert!(found.count > 40 && components == 2, "{found:?}");
    assert_eq!(found.pairs.len(), 4);
}

#[test]
fn a_sheet_folded_onto_itself_is_found() {
    let plane = meshes::plane(4).to_mesh_without_tangents();
    let open = moved(&plane, 1, |p| Vec3::new(p.x, (0.2 - p.x).max(0.0), p.z));
    assert_eq!(self_intersections(&open.positions, &open.triangles, 4).count, 0);
    let folded = moved(&plane, 1, |p| Vec3::new(p.x.abs(), p.y, p.z));
    assert!(self_intersections(&folded.positions, &folded.triangles, 4).count >= folded.triangles.len() as u64 / 2);
}

#[test]
fn what_is_subdivided_without_displacement_keeps_everything() {
    for mesh in meshes::all() {
        let base = mesh.to_mesh_without_tangents();
        for level in 0..=4 {
            assert_eq!(invariants::of_surface(&base, &flat(&base, level)), [], "{} at level {level}", mesh.name);
        }
    }
}

/// Two vertices of one place of `torus(12, 6)`.
fn on_a_seam() -> [usize; 2] {
    let base = meshes::torus(12, 6).to_mesh_without_tangents();
    let mut avs = (0..base.gv_position.len()).map(|gv| base.gv_av.list(gv));
    let pair = avs.find(|avs| avs.len() == 2).expect("a torus has seams");
    [pair[0] as usize, pair[1] as usize]
}

/// The rules that a surface breaks once `plant` has spoilt it.
fn rules_broken(plant: impl Fn(&mut Surface)) -> Vec<&'static str> {
    let base = meshes::torus(12, 6).to_mesh_without_tangents();
    let mut surface = flat(&base, 2);
    plant(&mut surface);
    invariants::of_surface(&base, &surface).iter().map(|broken| broken.rule).collect()
}

#[test]
fn each_planted_fault_breaks_its_rule() {
    assert_eq!(rules_broken(|_| ()), [""; 0]);
    assert!(rules_broken(|s| s.positions[7][1] = f32::NAN).contains(&"positions_finite"));
    assert_eq!(rules_broken(|s| s.normals[7][1] = f32::INFINITY), ["normals_finite"]);
    assert_eq!(rules_broken(|s| s.triangles[3][0] = u32::MAX), ["indices_in_range"]);
    assert_eq!(rules_broken(|s| s.attributes[0][50] += 1e-3), ["attributes"]);
    assert_eq!(rules_broken(|s| s.triangles.swap(0, 16)), ["partition"]);
    assert_eq!(rules_broken(|s| s.triangles[5].swap(0, 1)), ["partition", "badly_wound_edges"]);
    assert!(rules_broken(|s| s.triangles[5] = s.triangles[4]).contains(&"partition"));
    assert_eq!(rules_broken(|s| s.triangles.truncate(9)), ["sizes"]);
    let torn = rules_broken(|s| {
        let [_, other] = on_a_seam();
        s.positions[other][0] = s.positions[other][0].next_up();
    });
    assert!(torn.contains(&"one_position_per_place") && torn.contains(&"boundary_edges"), "{torn:?}");
}

#[test]
fn a_gap_is_as_wide_as_it_is_torn() {
    let base = meshes::torus(12, 6).to_mesh_without_tangents();
    let mut surface = flat(&base, 2);
    assert_eq!(invariants::largest_gap(&base, &surface), 0.0);
    let [_, other] = on_a_seam();
    surface.positions[other][1] += 0.25;
    assert!((invariants::largest_gap(&base, &surface) - 0.25).abs() < 1e-6);
}

#[test]
fn a_doubled_plane_is_stretched_by_two_and_a_moved_one_not_at_all() {
    let plane = meshes::plane(2).to_mesh_without_tangents();
    for level in [0, 1, 5] {
        let doubled = MeshFacts::of_surface(&plane, &moved(&plane, level, |p| 2.0 * p));
        let stretch = doubled.stretch.expect("a plane has area");
        assert!((stretch.max - 2.0).abs() < 1e-5 && (stretch.p99 - 2.0).abs() < 1e-5, "{stretch:?}");
        assert_eq!((doubled.flipped, doubled.seam_gap), (Some(0), Some(0.0)));
        let aside = MeshFacts::of_surface(&plane, &moved(&plane, level, |p| p + Vec3::X));
        assert!((aside.stretch.expect("still").max - 1.0).abs() < 1e-5, "{aside:?}");
    }
}

#[test]
fn a_slope_is_stretched_by_its_secant_where_it_is() {
    let plane = meshes::plane(4).to_mesh_without_tangents();
    // Slope 5 over a tenth of the plane: the rest is flat.
    let strain = Strain::of(&plane, &moved(&plane, 5, |p| Vec3::new(p.x, 5.0 * (p.x - 0.4).max(0.0), p.z)));
    assert!((max(&strain) - 26f64.sqrt()).abs() < 1e-4, "{}", max(&strain));
    assert!(strain.max_at.is_some_and(|at| at.position[0] >= 0.39), "{:?}", strain.max_at);
    let share = strain.long as f64 / strain.triangles as f64;
    assert!((share - 0.1).abs() < 0.01 && strain.flipped == 0, "{share}");
}

#[test]
fn a_planted_fold_turns_triangles_over_and_says_where() {
    let plane = meshes::plane(4).to_mesh_without_tangents();
    // Between x = 0.1 and x = 0.3 the sheet runs back.
    let back = |x: f32| {
        if x < 0.1 {
            x
        } else if x < 0.3 {
            0.2 - x
        } else {
            x - 0.4
        }
    };
    let strain = Strain::of(&plane, &moved(&plane, 5, |p| Vec3::new(back(p.x), p.y, p.z)));
    let share = strain.flipped as f64 / strain.triangles as f64;
    assert!((share - 0.2).abs() < 0.02, "{share}");
    let first = strain.first_flipped.expect("some are flipped").position;
    assert!((-0.11..0.11).contains(&first[0]), "{first:?}");
}

fn matrix() -> impl Strategy<Value = DMat3> {
    prop::array::uniform9(-2.0f64..2.0).prop_map(|m| DMat3::from_cols_array(&m))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn stretch_is_the_greatest_lengthening_of_any_direction(m in matrix(), level in 0u32..4) {
        let plane = meshes::plane(1).to_mesh_without_tangents();
        let by = |p: Vec3| (m * p.as_dvec3()).as_vec3();
        let strain = Strain::of(&plane, &moved(&plane, level, by));
        let along = |k: u32| DVec3::new((f64::from(k) / 500.0).cos(), 0.0, (f64::from(k) / 500.0).sin());
        let greatest = (0..1571).map(|k| (m * along(k)).length()).fold(0.0, f64::max);
        prop_assert!((max(&strain) - greatest).abs() < 1e-4 * greatest + 1e-5, "{} {greatest}", max(&strain));
        // Seen from above, the image of the plane turns over when the minor of x and z does.
        let turned = m.x_axis.x * m.z_axis.z - m.x_axis.z * m.z_axis.x;
        prop_assume!(turned.abs() > 1e-3);
        prop_assert_eq!(strain.flipped, if turned < 0.0 { strain.triangles } else { 0 });
    }

    #[test]
    fn random_heights_break_no_rule_and_random_tears_do(seed in any::<u32>(), vertex in 0usize..400) {
        let base = meshes::icosphere(1).to_mesh_without_tangents();
        let height = |p: Vec3| {
            let bits = p.to_array().map(f32::to_bits);
            (displace_tests::maps::hash(bits[0] ^ bits[1].rotate_left(9), bits[2], seed) >> 8) as f32 * 1e-8
        };
        let mut surface = subdivided(&base, 2, height);
        prop_assert_eq!(invariants::of_surface(&base, &surface), []);
        let facts = MeshFacts::of_surface(&base, &surface);
        let stretch = facts.stretch.expect("it has area");
        prop_assert!(stretch.p99 <= stretch.max && facts.volume.is_some_and(|v| v > 0.0));
        // A NaN in any vertex is told, wherever it is.
        let vertex = vertex % surface.positions.len();
        surface.positions[vertex][vertex % 3] = f32::NAN;
        prop_assert!(invariants::of_surface(&base, &surface).iter().any(|b| b.rule == "positions_finite"));
    }
}
